//! A cable over a swivelling pulley: length, exit point, wrap angle and exact derivatives.
//!
//! The cable reaches the pulley at its entry point `a`, travelling along the swivel axis `z`
//! (both in the base frame), wraps around the pulley of radius `rp`, which swivels about `z` to face
//! the platform, leaves it at `c` and runs straight to the anchor `B`. With `d = B - a`:
//!
//! - `b_z = d.z`, `d_xy = |d - b_z z|`, `e = (d - b_z z)/d_xy`, pulley centre `M = a + rp e`;
//! - free length `l_f = sqrt((d_xy - rp)^2 + b_z^2 - rp^2)`;
//! - wrap angle `theta = acos(l_f/|MB|) + acos(b_z/|MB|)`;
//! - exit point `c = M - rp cos(theta) e + rp sin(theta) z`, length `l = l_f + rp theta`
//!
//! (Jin et al. 2018, equations 3 and 4). `u = (c - B)/l_f`, `n = cos(theta) e - sin(theta) z` and
//! `o = z x e` are an orthonormal frame of the free cable. Then
//!
//! - `dl/dB = -u`, `dl/da = u`, `dl/drp = theta - sin(theta)`;
//! - `du/dB = -(n n^T / l_f + sin(theta)/d_xy o o^T)`, `du/da = -du/dB`;
//! - `dl_f/dB = -u - (rp/l_f) n`, `dtheta/drp = (1 - cos(theta))/l_f`.
//!
//! All lengths in metres, angles in radians. Assumptions: the pulley faces the anchor exactly,
//! the cable is thin and the free part straight.

use crate::real::{Real, add_scaled, cross, difference, dot, scaled};

/// Position, direction and size of a swivelling pulley, in the base frame.
#[derive(Debug, Clone, Copy)]
pub struct PulleyGeometry<T> {
    /// Entry point `a` (m).
    pub entry: [T; 3],
    /// Swivel axis `z`, unit vector in the direction of travel.
    pub axis: [T; 3],
    /// Radius `rp` (m); 0 for an eyelet.
    pub radius: T,
}

/// The path of a cable from the entry point to an anchor, with the quantities of its derivatives.
#[derive(Debug, Clone, Copy)]
pub struct CablePath<T> {
    /// Length from entry point to anchor (m).
    pub length: T,
    /// Straight part (m).
    pub free_length: T,
    /// Reciprocal of the straight part (1/m).
    pub inverse_free_length: T,
    /// Wrap angle (rad).
    pub wrap: T,
    /// Sine of the wrap angle.
    pub sin_wrap: T,
    /// Cosine of the wrap angle.
    pub cos_wrap: T,
    /// Unit vector `u` from the anchor to the exit point.
    pub toward_exit: [T; 3],
    /// Unit vector `e` from the swivel axis to the pulley centre.
    pub facing: [T; 3],
    /// Unit vector `n`, normal to the free cable in the plane of the pulley.
    pub normal: [T; 3],
    /// Unit vector `o`, normal to the plane of the pulley.
    pub lateral: [T; 3],
    /// Reciprocal of the distance from the anchor to the swivel axis (1/m).
    pub inverse_axis_distance: T,
    /// `|MB|^2 - rp^2` (m^2); the anchor is inside the pulley where this is not positive.
    pub clearance: T,
}

impl<T: Real> PulleyGeometry<T> {
    /// Path to an anchor at `anchor` in the base frame.
    ///
    /// Outside the domain (anchor inside the pulley or on the swivel axis) the result is finite
    /// but meaningless; [`CablePath::clearance`] and [`CablePath::inverse_axis_distance`] tell where.
    #[inline(always)]
    #[must_use]
    pub fn path_to(&self, anchor: [T; 3]) -> CablePath<T> {
        let d = difference(anchor, self.entry);
        let along = dot(d, self.axis);
        let across = add_scaled(d, -along, self.axis);
        let tiny = along.lift(1e-200);
        let axis_distance = dot(across, across).max(tiny).sqrt();
        let inverse_axis_distance = along.lift(1.0) / axis_distance;
        let facing = scaled(across, inverse_axis_distance);
        let offset = axis_distance - self.radius;
        let clearance = offset.mul_add(offset, along * along) - self.radius * self.radius;
        let free_length = clearance.max(tiny).sqrt();
        let inverse_free_length = along.lift(1.0) / free_length;
        // The two angles of the wrap add up as one point (cos, sin), scaled by |MB|^2.
        let y = self.radius.mul_add(along, free_length * offset);
        let x = free_length * along - self.radius * offset;
        let scale = along.lift(1.0) / (clearance + self.radius * self.radius).max(tiny);
        let (sin_wrap, cos_wrap) = (y * scale, x * scale);
        let wrap = y.atan2(x);
        let exit_direction = add_scaled(scaled(self.axis, cos_wrap), sin_wrap, facing);
        CablePath {
            length: self.radius.mul_add(wrap, free_length),
            free_length,
            inverse_free_length,
            wrap,
            sin_wrap,
            cos_wrap,
            toward_exit: scaled(exit_direction, along.lift(-1.0)),
            facing,
            normal: add_scaled(scaled(facing, cos_wrap), -sin_wrap, self.axis),
            lateral: cross(self.axis, facing),
            inverse_axis_distance,
            clearance,
        }
    }

    /// Exit point `c` of a path over this pulley, in the base frame (m).
    #[inline(always)]
    #[must_use]
    pub fn exit_point(&self, path: &CablePath<T>) -> [T; 3] {
        let one = self.radius.lift(1.0);
        let c = add_scaled(self.entry, self.radius * (one - path.cos_wrap), path.facing);
        add_scaled(c, self.radius * path.sin_wrap, self.axis)
    }
}

/// First-order change of a path.
#[derive(Debug, Clone, Copy)]
pub struct PathChange<T> {
    /// Change of the length (m).
    pub length: T,
    /// Change of the free length (m).
    pub free_length: T,
    /// Change of the unit vector from the anchor to the exit point.
    pub toward_exit: [T; 3],
}

impl<T: Real> CablePath<T> {
    /// Change of `u` when the anchor moves by `step`: `du/dB step`.
    #[inline(always)]
    #[must_use]
    pub fn turn(&self, step: [T; 3]) -> [T; 3] {
        let in_plane = dot(self.normal, step) * self.inverse_free_length;
        let sideways = dot(self.lateral, step) * self.sin_wrap * self.inverse_axis_distance;
        add_scaled(scaled(self.normal, -in_plane), -sideways, self.lateral)
    }

    /// `scale du/dB` along one axis of the base frame.
    #[inline(always)]
    #[must_use]
    pub fn turn_along(&self, axis: usize, scale: T) -> [T; 3] {
        let in_plane = self.normal[axis] * self.inverse_free_length * scale;
        let sideways = self.lateral[axis] * self.sin_wrap * self.inverse_axis_distance * scale;
        add_scaled(scaled(self.normal, -in_plane), -sideways, self.lateral)
    }

    /// `dl_f/dB = -u - (rp/l_f) n` for a pulley of radius `radius`.
    #[inline(always)]
    #[must_use]
    pub fn free_length_gradient(&self, radius: T) -> [T; 3] {
        let minus_u = scaled(self.toward_exit, radius.lift(-1.0));
        add_scaled(minus_u, -(radius * self.inverse_free_length), self.normal)
    }

    /// Change of the path when the anchor moves by `step` (m); for an entry point that moves by
    /// `step` it is the negative.
    #[inline(always)]
    #[must_use]
    pub fn change_by_anchor(&self, radius: T, step: [T; 3]) -> PathChange<T> {
        PathChange {
            length: -dot(self.toward_exit, step),
            free_length: dot(self.free_length_gradient(radius), step),
            toward_exit: self.turn(step),
        }
    }

    /// Change of the path per metre of pulley radius.
    #[inline(always)]
    #[must_use]
    pub fn change_by_radius(&self, radius: T) -> PathChange<T> {
        let turn = (radius.lift(1.0) - self.cos_wrap) * self.inverse_free_length;
        PathChange {
            length: self.wrap - self.sin_wrap,
            free_length: -(radius.mul_add(turn, self.sin_wrap)),
            toward_exit: scaled(self.normal, -turn),
        }
    }

    /// Change of the path when the swivel axis rotates by the rotation vector `rotation` (rad) about
    /// the entry point; `offset` is the anchor relative to the entry point (m).
    #[inline(always)]
    #[must_use]
    pub fn change_by_axis(&self, radius: T, offset: [T; 3], rotation: [T; 3]) -> PathChange<T> {
        // Rotating the pulley equals rotating the anchor backwards, then everything together.
        let step = cross(offset, rotation);
        let mut change = self.change_by_anchor(radius, step);
        let turned = cross(rotation, self.toward_exit);
        change.toward_exit = add_scaled(turned, radius.lift(1.0), change.toward_exit);
        change
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    type Case = (PulleyGeometry<f64>, [f64; 3]);

    fn random_cases(count: usize) -> Vec<Case> {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut vector =
            |scale: f64| -> [f64; 3] { std::array::from_fn(|_| rng.random_range(-scale..scale)) };
        let mut cases = Vec::new();
        while cases.len() < count {
            let (entry, raw, anchor, size) = (vector(2.0), vector(1.0), vector(2.0), vector(0.2));
            let norm = dot(raw, raw).sqrt();
            if norm < 0.1 {
                continue;
            }
            let pulley = PulleyGeometry {
                entry,
                axis: scaled(raw, 1.0 / norm),
                radius: size[0].abs(),
            };
            let path = pulley.path_to(anchor);
            if path.clearance > 0.01 && path.inverse_axis_distance < 10.0 {
                cases.push((pulley, anchor));
            }
        }
        cases
    }

    /// The length measured along the path itself: points on the arc, then the straight part.
    fn integrated_length(pulley: &PulleyGeometry<f64>, anchor: [f64; 3]) -> f64 {
        let path = pulley.path_to(anchor);
        let centre = add_scaled(pulley.entry, pulley.radius, path.facing);
        let on_arc = |angle: f64| {
            let p = add_scaled(centre, -pulley.radius * angle.cos(), path.facing);
            add_scaled(p, pulley.radius * angle.sin(), pulley.axis)
        };
        let steps = 4000;
        let distance = |a: [f64; 3], b: [f64; 3]| {
            let d = difference(a, b);
            dot(d, d).sqrt()
        };
        let arc: f64 = (0..steps)
            .map(|k| {
                let angle = |k: i32| path.wrap * f64::from(k) / f64::from(steps);
                distance(on_arc(angle(k)), on_arc(angle(k + 1)))
            })
            .sum();
        arc + distance(on_arc(path.wrap), anchor)
    }

    #[test]
    fn length_is_that_of_the_integrated_path() {
        for (pulley, anchor) in random_cases(200) {
            let length = pulley.path_to(anchor).length;
            let integrated = integrated_length(&pulley, anchor);
            // A chord of angle h is shorter than its arc by h^2/24: below 3e-8 of the arc here.
            assert!((length - integrated).abs() < 3e-8, "{length} {integrated}");
        }
    }

    #[test]
    fn cable_leaves_the_pulley_along_its_tangent() {
        for (pulley, anchor) in random_cases(200) {
            let path = pulley.path_to(anchor);
            let exit = pulley.exit_point(&path);
            let free = difference(exit, anchor);
            assert!((dot(free, free).sqrt() - path.free_length).abs() < 1e-12);
            let along = difference(free, scaled(path.toward_exit, path.free_length));
            assert!(dot(along, along).sqrt() < 1e-12);
            let spoke = difference(exit, add_scaled(pulley.entry, pulley.radius, path.facing));
            assert!(dot(spoke, path.toward_exit).abs() < 1e-12);
        }
    }

    fn check_change(
        change: &PathChange<f64>,
        plus: &CablePath<f64>,
        minus: &CablePath<f64>,
        step: f64,
    ) {
        let slope = |a: f64, b: f64| (a - b) / (2.0 * step);
        assert!((slope(plus.length, minus.length) - change.length).abs() < 2e-8);
        assert!((slope(plus.free_length, minus.free_length) - change.free_length).abs() < 2e-8);
        for k in 0..3 {
            let numeric = slope(plus.toward_exit[k], minus.toward_exit[k]);
            assert!((numeric - change.toward_exit[k]).abs() < 1e-7);
        }
    }

    #[test]
    fn derivatives_match_finite_differences() {
        let h = 1e-6;
        for (pulley, anchor) in random_cases(300) {
            let path = pulley.path_to(anchor);
            let with_radius = |radius| PulleyGeometry { radius, ..pulley }.path_to(anchor);
            check_change(
                &path.change_by_radius(pulley.radius),
                &with_radius(pulley.radius + h),
                &with_radius(pulley.radius - h),
                h,
            );
            for k in 0..3 {
                let unit: [f64; 3] = std::array::from_fn(|q| f64::from(u8::from(q == k)));
                let moved = |s: f64| pulley.path_to(add_scaled(anchor, s, unit));
                let change = path.change_by_anchor(pulley.radius, unit);
                check_change(&change, &moved(h), &moved(-h), h);
                let shifted = |s: f64| {
                    let entry = add_scaled(pulley.entry, s, unit);
                    PulleyGeometry { entry, ..pulley }.path_to(anchor)
                };
                check_change(&change, &shifted(-h), &shifted(h), h);
                let tilted = |s: f64| {
                    let rotation = nalgebra::Rotation3::new(nalgebra::Vector3::from(unit) * s);
                    let axis = (rotation * nalgebra::Vector3::from(pulley.axis)).into();
                    PulleyGeometry { axis, ..pulley }.path_to(anchor)
                };
                let offset = difference(anchor, pulley.entry);
                let change = path.change_by_axis(pulley.radius, offset, unit);
                check_change(&change, &tilted(h), &tilted(-h), h);
            }
        }
    }
}
