//! Camera: position, view and projection of points. Base frame, metres, radians.

mod flight;
mod moves;

pub use flight::Flight;

use nalgebra::Matrix3;
use tautline_core::geometry::Vec3;

/// Tangent of half the vertical field of view.
const HALF_OPENING: f64 = 0.315;

/// View directions in the base frame: columns to the right, away from the viewer, up.
pub type Directions = Matrix3<f64>;

/// View directions for a robot under `gravity`: up is the axis of the base frame that is most opposite to gravity.
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

/// Named view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StandardView {
    /// From the front.
    Front,
    /// From the right.
    Side,
    /// From above.
    Top,
    /// From the front right, above.
    Isometric,
}

impl StandardView {
    /// All standard views, in the order of their keys.
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

/// Projection of the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Projection {
    Perspective,
    Orthographic,
}

impl Projection {
    /// Label in the window.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Perspective => "Perspective",
            Self::Orthographic => "Orthographic",
        }
    }

    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Perspective => Self::Orthographic,
            Self::Orthographic => Self::Perspective,
        }
    }
}

/// Line of sight.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    /// Origin (m).
    pub origin: Vec3,
    /// Direction, unit vector.
    pub direction: Vec3,
}

/// Projection of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProjectedPoint {
    /// Share of the width from the left, 0 to 1 within the picture.
    pub u: f64,
    /// Share of the height from the top.
    pub v: f64,
    /// Distance along the direction of view (m).
    pub depth_m: f64,
}

/// Camera that looks at a target point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    directions: Directions,
    target: Vec3,
    yaw: f64,
    pitch: f64,
    /// Distance to the target point; an orthographic view shows the same height as a perspective one at this distance.
    distance_m: f64,
    /// Smallest distance from the eye to a surface, and largest.
    nearest_m: f64,
    farthest_m: f64,
    projection: Projection,
    /// Projection of views that are not along an axis.
    oblique: Projection,
}

impl Camera {
    /// Standard view `view` of all `points` (m), for a picture with this width over height.
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
            projection: Projection::Perspective,
            oblique: Projection::Perspective,
        };
        camera.turn_to(view);
        camera.fit(points, aspect);
        camera
    }

    /// Axes of the picture in the base frame: right, up, forward.
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

    #[must_use]
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// Sets the projection, also for later views.
    pub fn set_projection(&mut self, projection: Projection) {
        (self.projection, self.oblique) = (projection, projection);
    }

    /// Position of the eye (m); in an orthographic view, in front of everything.
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        self.target - self.axes()[2] * self.away_m()
    }

    /// Distance from the eye to the target point (m).
    fn away_m(&self) -> f64 {
        match self.projection {
            Projection::Perspective => self.distance_m,
            Projection::Orthographic => self.farthest_m,
        }
    }

    /// Height of the picture at the depth of the target point (m).
    #[must_use]
    pub fn height_m(&self) -> f64 {
        2.0 * HALF_OPENING * self.distance_m
    }

    /// Height of the picture at a depth (m).
    #[must_use]
    pub fn height_at(&self, depth_m: f64) -> f64 {
        match self.projection {
            Projection::Perspective => 2.0 * HALF_OPENING * depth_m,
            Projection::Orthographic => self.height_m(),
        }
    }

    /// Line of sight through `(u, v)`, shares of width and height from the upper left corner.
    #[must_use]
    pub fn ray(&self, u: f64, v: f64, aspect: f64) -> Ray {
        let [right, up, forward] = self.axes();
        let across = right * ((2.0 * u - 1.0) * aspect) + up * (1.0 - 2.0 * v);
        match self.projection {
            Projection::Perspective => Ray {
                origin: self.eye(),
                direction: (forward + across * HALF_OPENING).normalize(),
            },
            Projection::Orthographic => Ray {
                origin: self.eye() + across * (0.5 * self.height_m()),
                direction: forward,
            },
        }
    }

    /// Projection of `point` (m); `None` behind the eye.
    #[must_use]
    pub fn project(&self, point: &Vec3, aspect: f64) -> Option<ProjectedPoint> {
        let [right, up, forward] = self.axes();
        let d = point - self.eye();
        let depth_m = d.dot(&forward);
        let scale = self.height_at(depth_m).recip();
        (depth_m > 0.01 * self.nearest_m).then(|| ProjectedPoint {
            u: 0.5 + d.dot(&right) * scale / aspect,
            v: 0.5 - d.dot(&up) * scale,
            depth_m,
        })
    }

    /// Camera for the graphics card; `radius_m` and `centre` bound the whole drawing.
    #[must_use]
    pub fn on_card(
        &self,
        centre: &Vec3,
        radius_m: f64,
        viewport: three_d::Viewport,
    ) -> three_d::Camera {
        let [_, up, forward] = self.axes();
        let middle = (centre - self.eye()).dot(&forward);
        let single = |v: Vec3| three_d::vec3(v.x as f32, v.y as f32, v.z as f32);
        let looking = |eye: Vec3| [eye, eye + forward, up].map(single);
        match self.projection {
            Projection::Perspective => {
                let [eye, ahead, up] = looking(self.eye());
                let opening = three_d::radians(2.0 * HALF_OPENING.atan() as f32);
                let far = (middle + radius_m).max(2.0 * self.nearest_m);
                // The near plane never cuts off anything that the eye may approach.
                let least = (2e-3 * far).min(0.2 * self.distance_m);
                let [near, far] = [(middle - radius_m).max(least), far].map(|m| m as f32);
                three_d::Camera::new_perspective(viewport, eye, ahead, up, opening, near, far)
            }
            Projection::Orthographic => {
                // In front of everything but as close as possible, for the sake of single precision.
                let [eye, ahead, up] = looking(self.eye() + forward * (middle - radius_m));
                let deep = 2.0 * radius_m.max(f64::MIN_POSITIVE) as f32;
                let height = self.height_m() as f32;
                three_d::Camera::new_orthographic(viewport, eye, ahead, up, height, 0.0, deep)
            }
        }
    }
}

#[cfg(test)]
mod tests;
