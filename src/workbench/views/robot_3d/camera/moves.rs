//! Camera movements: orbit, pan, zoom, framing.

use std::f64::consts::{FRAC_PI_2, TAU};

use tautline_core::geometry::Vec3;

use super::{Camera, HALF_OPENING, ProjectedPoint, Projection, StandardView};

/// Rotation per point of dragging (rad).
const ORBIT_RATE: f64 = 0.008;
/// Share of the picture filled by framed points.
const MARGIN: f64 = 0.88;
/// Smallest distance of the eye from a surface, as a share of the size of everything.
const CLOSEST: f64 = 2e-3;
/// Largest distance of the eye, as a multiple of the size of everything.
const FARTHEST: f64 = 20.0;

impl Camera {
    /// Turns to a standard view about the target point. Views along an axis are orthographic, so that near and far
    /// parts have the same scale.
    pub fn turn_to(&mut self, view: StandardView) {
        (self.yaw, self.pitch) = view.angles();
        self.projection = match view {
            StandardView::Isometric => self.oblique,
            StandardView::Front | StandardView::Side | StandardView::Top => {
                Projection::Orthographic
            }
        };
    }

    /// Turns the view along `direction` (base frame), in perspective; the target point stays.
    pub fn look_along(&mut self, direction: &Vec3) {
        let Some(forward) = (self.directions.transpose() * direction).try_normalize(0.0) else {
            return;
        };
        self.pitch = (-forward.z).clamp(-1.0, 1.0).asin();
        if forward.x.hypot(forward.y) > 1e-9 {
            self.yaw = (-forward.x).atan2(forward.y).rem_euclid(TAU);
        }
        self.projection = Projection::Perspective;
    }

    /// Frames all of `points` (m) and takes them as the whole scene: their size sets the range of distances of the eye.
    pub fn fit(&mut self, points: &[Vec3], aspect: f64) {
        let Some((_, size)) = self.middle_and_size(points) else {
            return;
        };
        (self.nearest_m, self.farthest_m) = (CLOSEST * size, FARTHEST * size);
        self.frame(points, aspect);
    }

    /// Frames `points` (m), a part of the scene.
    pub fn frame(&mut self, points: &[Vec3], aspect: f64) {
        let Some((middle, _)) = self.middle_and_size(points) else {
            return;
        };
        self.target = middle;
        // Perspective shifts the apparent centre; a few iterations converge.
        for _ in 0..6 {
            self.distance_m = self.distance_to_see(points, aspect);
            self.centre(points, aspect);
        }
        self.distance_m = self.distance_to_see(points, aspect);
    }

    /// Centre of the box around `points` along the axes of the picture, and its longest side (m); `None` without
    /// points.
    fn middle_and_size(&self, points: &[Vec3]) -> Option<(Vec3, f64)> {
        let axes = self.axes();
        let mut low = Vec3::repeat(f64::INFINITY);
        let mut high = -low;
        for point in points {
            let along = Vec3::from_fn(|k, _| axes[k].dot(point));
            (low, high) = (low.inf(&along), high.sup(&along));
        }
        if !(low[0].is_finite() && high[0].is_finite()) {
            return None;
        }
        let middle = (low + high) / 2.0;
        let middle = axes[0] * middle.x + axes[1] * middle.y + axes[2] * middle.z;
        Some((middle, (high - low).max().max(1e-3)))
    }

    fn distance_to_see(&self, points: &[Vec3], aspect: f64) -> f64 {
        let [right, up, forward] = self.axes();
        let across = HALF_OPENING * MARGIN;
        let needed = points.iter().map(|point| {
            let d = point - self.target;
            let wide = d.dot(&right).abs() / (across * aspect);
            let tall = d.dot(&up).abs() / across;
            let deep = match self.projection {
                Projection::Perspective => d.dot(&forward),
                Projection::Orthographic => 0.0,
            };
            wide.max(tall) - deep
        });
        needed.fold(self.nearest_m, f64::max)
    }

    fn centre(&mut self, points: &[Vec3], aspect: f64) {
        let seen: Vec<ProjectedPoint> = points
            .iter()
            .filter_map(|p| self.project(p, aspect))
            .collect();
        let range = |value: fn(&ProjectedPoint) -> f64| {
            let (low, high) = seen
                .iter()
                .map(value)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                    (low.min(v), high.max(v))
                });
            (low + high) / 2.0 - 0.5
        };
        if seen.is_empty() {
            return;
        }
        let [right, up, _] = self.axes();
        let height = self.height_m();
        let (u, v) = (range(|s| s.u), range(|s| s.v));
        self.target += right * (u * height * aspect) - up * (v * height);
    }

    /// Orbits by a drag to the right and down (points) about `pivot` (m), which stays in place, or about the centre of
    /// the picture. A view along an axis returns to the projection of oblique views.
    pub fn orbit(&mut self, right: f64, down: f64, pivot: Option<Vec3>) {
        self.projection = self.oblique;
        let pivot = pivot.unwrap_or(self.target);
        let before = self.axes();
        let away = pivot - self.eye();
        let seen = before.map(|axis| axis.dot(&away));
        self.yaw = (self.yaw - right * ORBIT_RATE).rem_euclid(TAU);
        self.pitch = (self.pitch + down * ORBIT_RATE).clamp(-FRAC_PI_2, FRAC_PI_2);
        let after = self.axes();
        let eye = pivot - (after[0] * seen[0] + after[1] * seen[1] + after[2] * seen[2]);
        self.target = eye + after[2] * self.away_m();
    }

    /// Pans by shares of the height of the picture; the depth of the target point follows the pointer.
    pub fn pan(&mut self, right: f64, down: f64) {
        let [x, y, _] = self.axes();
        let height = self.height_m();
        self.target += (y * down - x * right) * height;
    }

    /// Zooms by `factor` towards `under`, the nearest surface at `(u, v)` (m), or towards the depth of the target
    /// point. It stays under the pointer, and the eye never reaches it.
    pub fn zoom(&mut self, factor: f64, (u, v): (f64, f64), aspect: f64, under: Option<Vec3>) {
        let [right, up, forward] = self.axes();
        if self.projection == Projection::Orthographic {
            let wanted = self.distance_m / factor;
            let distance = wanted.clamp(self.nearest_m, self.farthest_m);
            let height = self.height_m();
            let under = right * ((u - 0.5) * height * aspect) - up * ((v - 0.5) * height);
            self.target += under * (1.0 - distance / self.distance_m);
            self.distance_m = distance;
            return;
        }
        let eye = self.eye();
        let ray = self.ray(u, v, aspect);
        let steepness = ray.direction.dot(&forward);
        let depth = under.map_or(self.distance_m, |point| (point - eye).dot(&forward));
        let away = depth.max(f64::MIN_POSITIVE) / steepness;
        // An eye that is closer already does not jump back.
        let closest = self.nearest_m.min(away);
        let wanted = (away / factor).clamp(closest, self.farthest_m.max(away));
        let eye = eye + ray.direction * (away - wanted);
        self.distance_m = wanted * steepness;
        self.target = eye + forward * self.distance_m;
    }
}
