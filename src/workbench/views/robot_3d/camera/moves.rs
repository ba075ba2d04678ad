//! How the camera moves: orbit, pan, zoom, framing.

use std::f64::consts::{FRAC_PI_2, TAU};

use tautline_core::geometry::Vec3;

use super::{Camera, HALF_OPENING, Projection, Seen, StandardView};

/// Radians per point of dragging.
const ORBIT_RATE: f64 = 0.008;
/// Share of the picture that stays free around what is framed.
const MARGIN: f64 = 0.88;
/// Share of the size of everything to which the eye may come close to a surface.
const CLOSEST: f64 = 2e-3;
/// How many times the size of everything the eye may be away.
const FARTHEST: f64 = 20.0;

impl Camera {
    /// Turns to a standard view; the point in the middle stays. Views along an axis are orthographic, so that what is
    /// behind each other is seen at the same scale.
    pub fn turn_to(&mut self, view: StandardView) {
        (self.yaw, self.pitch) = view.angles();
        self.projection = match view {
            StandardView::Isometric => self.oblique,
            StandardView::Front | StandardView::Side | StandardView::Top => {
                Projection::Orthographic
            }
        };
    }

    /// Turns so that the eye looks along `direction` (base frame), in perspective; the point in the middle stays.
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

    /// Shows all of `points` (m) as large as possible and takes them for everything there is: their size says how close
    /// and how far the eye may go.
    pub fn fit(&mut self, points: &[Vec3], aspect: f64) {
        let Some((_, size)) = self.middle_and_size(points) else {
            return;
        };
        (self.nearest_m, self.farthest_m) = (CLOSEST * size, FARTHEST * size);
        self.frame(points, aspect);
    }

    /// Shows all of `points` (m), a part of everything, as large as possible.
    pub fn frame(&mut self, points: &[Vec3], aspect: f64) {
        let Some((middle, _)) = self.middle_and_size(points) else {
            return;
        };
        self.target = middle;
        // Perspective moves the middle of what is seen; a few rounds settle it.
        for _ in 0..6 {
            self.distance_m = self.distance_to_see(points, aspect);
            self.centre(points, aspect);
        }
        self.distance_m = self.distance_to_see(points, aspect);
    }

    /// Middle of the box around `points` along the axes of the picture, and its longest side (m); `None` without points.
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
        let seen: Vec<Seen> = points
            .iter()
            .filter_map(|p| self.project(p, aspect))
            .collect();
        let range = |value: fn(&Seen) -> f64| {
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

    /// Orbits by a drag of so many points to the right and down, about `pivot` (m), which stays where it is in the picture,
    /// or about the middle of the picture. A view along an axis becomes one as it was chosen for others.
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

    /// Moves the picture by shares of its height; the point in the middle's depth stays under the pointer.
    pub fn pan(&mut self, right: f64, down: f64) {
        let [x, y, _] = self.axes();
        let height = self.height_m();
        self.target += (y * down - x * right) * height;
    }

    /// Comes closer by `factor` to `under`, the nearest thing seen at `(u, v)` (m), or to the depth of the middle where
    /// nothing is seen. It stays under the pointer, and the eye never reaches it.
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
        let ray = self.ray((u, v), aspect);
        let steepness = ray.direction.dot(&forward);
        let depth = under.map_or(self.distance_m, |point| (point - eye).dot(&forward));
        let away = depth.max(f64::MIN_POSITIVE) / steepness;
        // Who is closer already does not jump back.
        let closest = self.nearest_m.min(away);
        let wanted = (away / factor).clamp(closest, self.farthest_m.max(away));
        let eye = eye + ray.direction * (away - wanted);
        self.distance_m = wanted * steepness;
        self.target = eye + forward * self.distance_m;
    }
}
