//! The camera: it orbits a point, and everything the pointer does to it. Base frame, metres, radians.

use nalgebra::{Matrix3, Matrix4, Vector4};
use tautline_core::geometry::Vec3;

/// Half the vertical opening angle, as its tangent.
const HALF_OPENING: f64 = 0.315;
/// Radians per point of dragging.
const ORBIT_RATE: f64 = 0.008;
/// Share of the picture that stays free around what is fitted.
const MARGIN: f64 = 0.88;

/// Directions of the view's own frame in the base frame: columns to the right, away from the viewer, up.
pub type Directions = Matrix3<f64>;

/// Directions for a robot under `gravity`: up is the axis of the base frame that is most opposite to it.
#[must_use]
pub fn directions(gravity: Vec3) -> Directions {
    let axis = gravity.iamax();
    if gravity.norm() == 0.0 || axis == 2 {
        return Matrix3::identity();
    }
    let up = Vec3::ith(axis, -gravity[axis].signum());
    let right = Vec3::ith(usize::from(axis == 0), 1.0);
    Matrix3::from_columns(&[right, up.cross(&right), up])
}

/// A view from a side that has a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StandardView {
    /// Looking away from the viewer, up is up.
    Front,
    /// From the right.
    Side,
    /// From above.
    Top,
    /// From the front right, above.
    Isometric,
}

impl StandardView {
    /// All, in the order of their keys.
    pub const ALL: [Self; 4] = [Self::Front, Self::Side, Self::Top, Self::Isometric];

    /// Label in the window.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Front => "Front",
            Self::Side => "Side",
            Self::Top => "Top",
            Self::Isometric => "Isometric",
        }
    }

    /// Yaw and pitch (rad).
    fn angles(self) -> (f64, f64) {
        use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
        match self {
            Self::Front => (0.0, 0.0),
            Self::Side => (FRAC_PI_2, 0.0),
            Self::Top => (0.0, FRAC_PI_2),
            Self::Isometric => (0.8 * FRAC_PI_4, 0.45),
        }
    }
}

/// A line of sight.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    /// Where it begins (m).
    pub origin: Vec3,
    /// Its direction, unit vector.
    pub direction: Vec3,
}

/// Where a point is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Share of the width from the left, 0 to 1 within the picture.
    pub u: f64,
    /// Share of the height from the top.
    pub v: f64,
    /// Distance along the direction of view (m).
    pub depth_m: f64,
}

/// A camera that orbits a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    directions: Directions,
    target: Vec3,
    yaw: f64,
    pitch: f64,
    distance_m: f64,
    nearest_m: f64,
    farthest_m: f64,
}

impl Camera {
    /// The standard view `view` of everything in `points` (m), in a picture of the given width over height.
    #[must_use]
    pub fn new(directions: Directions, view: StandardView, points: &[Vec3], aspect: f64) -> Self {
        let mut camera = Self {
            directions,
            target: Vec3::zeros(),
            yaw: 0.0,
            pitch: 0.0,
            distance_m: 1.0,
            nearest_m: 1e-3,
            farthest_m: 1e3,
        };
        camera.turn_to(view);
        camera.fit(points, aspect);
        camera
    }

    /// Right, up and forward of the picture in the base frame.
    #[must_use]
    pub fn axes(&self) -> [Vec3; 3] {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.sin_cos();
        let right = Vec3::new(cos_yaw, sin_yaw, 0.0);
        let level = Vec3::new(-sin_yaw, cos_yaw, 0.0);
        let forward = level * cos_pitch - Vec3::z() * sin_pitch;
        let up = level * sin_pitch + Vec3::z() * cos_pitch;
        [right, up, forward].map(|axis| self.directions * axis)
    }

    /// Where the eye is (m).
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        self.target - self.axes()[2] * self.distance_m
    }

    /// Length of one share of the picture's height at the point that is orbited (m).
    #[must_use]
    pub fn height_m(&self) -> f64 {
        2.0 * HALF_OPENING * self.distance_m
    }

    /// Height of what is seen per distance from the eye.
    #[must_use]
    pub fn opening() -> f64 {
        2.0 * HALF_OPENING
    }

    /// Turns to a standard view; the point in the middle stays.
    pub fn turn_to(&mut self, view: StandardView) {
        (self.yaw, self.pitch) = view.angles();
    }

    /// Moves back or closer until all of `points` (m) are seen as large as possible.
    pub fn fit(&mut self, points: &[Vec3], aspect: f64) {
        let axes = self.axes();
        let coordinates = |p: &Vec3| axes.map(|axis| axis.dot(p));
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for point in points {
            for (k, value) in coordinates(point).into_iter().enumerate() {
                low[k] = low[k].min(value);
                high[k] = high[k].max(value);
            }
        }
        if !(low[0].is_finite() && high[0].is_finite()) {
            return;
        }
        let middle: [f64; 3] = std::array::from_fn(|k| (low[k] + high[k]) / 2.0);
        self.target = axes[0] * middle[0] + axes[1] * middle[1] + axes[2] * middle[2];
        let size = (0..3)
            .fold(0.0_f64, |most, k| most.max(high[k] - low[k]))
            .max(1e-3);
        (self.nearest_m, self.farthest_m) = (0.01 * size, 20.0 * size);
        // Perspective moves the middle of what is seen; a few rounds settle it.
        for _ in 0..6 {
            self.distance_m = self.distance_to_see(points, aspect);
            self.centre(points, aspect);
        }
        self.distance_m = self.distance_to_see(points, aspect);
    }

    fn distance_to_see(&self, points: &[Vec3], aspect: f64) -> f64 {
        let [right, up, forward] = self.axes();
        let across = HALF_OPENING * MARGIN;
        let needed = points.iter().map(|point| {
            let d = point - self.target;
            let wide = d.dot(&right).abs() / (across * aspect);
            let tall = d.dot(&up).abs() / across;
            wide.max(tall) - d.dot(&forward)
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

    /// Orbits by a drag of so many points to the right and down.
    pub fn orbit(&mut self, right: f64, down: f64) {
        use std::f64::consts::{FRAC_PI_2, TAU};
        self.yaw = (self.yaw - right * ORBIT_RATE).rem_euclid(TAU);
        self.pitch = (self.pitch + down * ORBIT_RATE).clamp(-FRAC_PI_2, FRAC_PI_2);
    }

    /// Moves the picture by shares of its height; the point that is orbited stays under the pointer.
    pub fn pan(&mut self, right: f64, down: f64) {
        let [x, y, _] = self.axes();
        let height = self.height_m();
        self.target += (y * down - x * right) * height;
    }

    /// Comes closer by `factor`; what is under `(u, v)` at the depth of the middle stays there.
    pub fn zoom(&mut self, factor: f64, (u, v): (f64, f64), aspect: f64) {
        let wanted = self.distance_m / factor;
        let distance = wanted.clamp(self.nearest_m, self.farthest_m);
        let [right, up, _] = self.axes();
        let height = self.height_m();
        let under = right * ((u - 0.5) * height * aspect) - up * ((v - 0.5) * height);
        self.target += under * (1.0 - distance / self.distance_m);
        self.distance_m = distance;
    }

    /// The line of sight through `(u, v)`, shares of width and height from the upper left corner.
    #[must_use]
    pub fn ray(&self, (u, v): (f64, f64), aspect: f64) -> Ray {
        let [right, up, forward] = self.axes();
        let across = right * ((2.0 * u - 1.0) * HALF_OPENING * aspect);
        let direction = forward + across + up * ((1.0 - 2.0 * v) * HALF_OPENING);
        Ray {
            origin: self.eye(),
            direction: direction.normalize(),
        }
    }

    /// Where `point` (m) is seen; `None` behind the eye.
    #[must_use]
    pub fn project(&self, point: &Vec3, aspect: f64) -> Option<Seen> {
        let [right, up, forward] = self.axes();
        let d = point - self.eye();
        let depth_m = d.dot(&forward);
        let scale = 0.5 / (depth_m * HALF_OPENING);
        (depth_m > 0.01 * self.nearest_m).then(|| Seen {
            u: 0.5 + d.dot(&right) * scale / aspect,
            v: 0.5 - d.dot(&up) * scale,
            depth_m,
        })
    }

    /// Takes homogeneous coordinates in the base frame to clip coordinates of OpenGL. `radius_m` and
    /// `centre` bound everything that is drawn.
    #[must_use]
    pub fn clip_from_base(&self, centre: &Vec3, radius_m: f64, aspect: f64) -> Matrix4<f64> {
        let [right, up, forward] = self.axes();
        let eye = self.eye();
        let middle = (centre - eye).dot(&forward);
        let far = (middle + radius_m).max(2.0 * self.nearest_m);
        let near = (middle - radius_m).max(2e-3 * far);
        let row =
            |axis: Vec3, scale: f64| Vector4::new(axis.x, axis.y, axis.z, -axis.dot(&eye)) * scale;
        let x = row(right, 1.0 / (HALF_OPENING * aspect));
        let y = row(up, 1.0 / HALF_OPENING);
        let depth = row(forward, 1.0);
        let z = depth * ((far + near) / (far - near))
            - Vector4::w() * (2.0 * far * near / (far - near));
        Matrix4::from_rows(&[
            x.transpose(),
            y.transpose(),
            z.transpose(),
            depth.transpose(),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners() -> Vec<Vec3> {
        let signs = [-1.0, 1.0];
        let mut corners = Vec::new();
        for x in signs {
            for y in signs {
                corners.extend(signs.map(|z| Vec3::new(2.0 * x, y, 0.5 * z + 1.0)));
            }
        }
        corners
    }

    fn camera(view: StandardView) -> Camera {
        Camera::new(Directions::identity(), view, &corners(), 1.6)
    }

    #[test]
    fn everything_fits_and_fills_the_picture() {
        for view in StandardView::ALL {
            for aspect in [0.5, 1.6] {
                let camera = Camera::new(Directions::identity(), view, &corners(), aspect);
                let mut extent = 0.0_f64;
                for corner in corners() {
                    let seen = camera.project(&corner, aspect).unwrap();
                    extent = extent.max((seen.u - 0.5).abs()).max((seen.v - 0.5).abs());
                }
                assert!(extent <= 0.5 * MARGIN + 1e-9, "{view:?} {aspect}: {extent}");
                assert!(extent > 0.4, "{view:?} {aspect}: {extent}");
            }
        }
    }

    #[test]
    fn a_line_of_sight_meets_the_point_it_was_made_from() {
        let mut camera = camera(StandardView::Isometric);
        camera.orbit(120.0, -30.0);
        for point in corners() {
            let seen = camera.project(&point, 1.6).unwrap();
            let ray = camera.ray((seen.u, seen.v), 1.6);
            let off = (point - ray.origin).cross(&ray.direction).norm();
            assert!(off < 1e-12, "{off}");
        }
    }

    #[test]
    fn the_card_sees_what_the_pointer_sees() {
        let camera = camera(StandardView::Isometric);
        let clip = camera.clip_from_base(&Vec3::new(0.0, 0.0, 1.0), 3.0, 1.6);
        for point in corners() {
            let c = clip * point.push(1.0);
            let seen = camera.project(&point, 1.6).unwrap();
            assert!((c.x / c.w - (2.0 * seen.u - 1.0)).abs() < 1e-12);
            assert!((c.y / c.w - (1.0 - 2.0 * seen.v)).abs() < 1e-12);
            assert!((-1.0..=1.0).contains(&(c.z / c.w)));
        }
    }

    #[test]
    fn zoom_keeps_what_is_under_the_pointer() {
        let mut camera = camera(StandardView::Front);
        let at = (0.8, 0.3);
        let before = camera.ray(at, 1.6);
        // The point under the pointer at the depth of the middle.
        let forward = camera.axes()[2];
        let reach = camera.distance_m / before.direction.dot(&forward);
        let point = before.origin + before.direction * reach;
        camera.zoom(3.0, at, 1.6);
        let seen = camera.project(&point, 1.6).unwrap();
        assert!((seen.u - at.0).abs() < 1e-12 && (seen.v - at.1).abs() < 1e-12);
    }

    #[test]
    fn pan_moves_the_middle_with_the_pointer() {
        let mut camera = camera(StandardView::Top);
        let middle = camera.target;
        camera.pan(0.25, 0.1);
        let seen = camera.project(&middle, 1.6).unwrap();
        assert!((seen.u - 0.5 - 0.25 / 1.6).abs() < 1e-12);
        assert!((seen.v - 0.6).abs() < 1e-12);
    }

    #[test]
    fn standard_views_look_along_the_axes_and_up_is_against_gravity() {
        let base = directions(Vec3::new(0.0, 0.0, -9.8));
        assert_eq!(base, Directions::identity());
        assert_eq!(camera(StandardView::Front).axes()[2], Vec3::y());
        let top = camera(StandardView::Top).axes();
        assert!((top[2] + Vec3::z()).norm() < 1e-15 && (top[1] - Vec3::y()).norm() < 1e-15);
        let side = camera(StandardView::Side).axes();
        assert!((side[0] - Vec3::y()).norm() < 1e-15 && (side[2] + Vec3::x()).norm() < 1e-15);
        for axis in 0..3 {
            let frame = directions(Vec3::ith(axis, -9.8));
            assert_eq!(frame.column(2), Vec3::ith(axis, 1.0));
            assert!((frame.determinant() - 1.0).abs() < 1e-15);
        }
        let planar = directions(Vec3::new(0.0, -9.8, 0.0));
        assert_eq!(planar.column(0), Vec3::x());
        assert_eq!(planar.column(1), -Vec3::z());
    }
}
