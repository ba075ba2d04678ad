//! Platform, its laser, and the home platform's sensors.

use tautline_core::geometry::{Pose, Vec3};
use tautline_core::robot::{Home, Robot};

use super::{LaserView, bounds, corners};

/// Box around the anchors, in the platform frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlatformBox {
    /// Lower corner (m).
    pub low: Vec3,
    /// Upper corner (m).
    pub high: Vec3,
}

impl PlatformBox {
    /// Box around the anchors of `robot` in a frame of diagonal `size_m`; a thin box gets a visible thickness.
    #[must_use]
    pub fn of(robot: &Robot, size_m: f64) -> Self {
        let cables = robot.cables.iter();
        let anchors: Vec<Vec3> = cables.map(|c| c.platform_anchor_m.into()).collect();
        let [low, high] = bounds(anchors.iter());
        if !low.iter().chain(&high).all(|v| v.is_finite()) {
            let half = Vec3::repeat(0.01 * size_m);
            return Self {
                low: -half,
                high: half,
            };
        }
        let least = (0.12 * (high - low).max()).max(0.008 * size_m) / 2.0;
        let middle = (low + high) / 2.0;
        let half = ((high - low) / 2.0).map(|h| h.max(least));
        Self {
            low: middle - half,
            high: middle + half,
        }
    }

    /// Corners in the base frame (m); bit k of the index selects the upper end along axis k.
    #[must_use]
    pub fn corners(&self, pose: &Pose) -> [Vec3; 8] {
        corners(&self.low, &self.high).map(|corner| pose.transform(&corner))
    }
}

pub fn laser(robot: &Robot, pose: &Pose) -> Option<LaserView> {
    let laser = robot.laser?;
    let from = pose.transform(&laser.origin_m.into());
    let direction = pose.orientation * Vec3::from(laser.direction);
    let normal = Vec3::from(laser.target_plane.normal);
    let distance = (laser.target_plane.offset_m - normal.dot(&from)) / normal.dot(&direction);
    let meets = distance.is_finite() && distance > 0.0;
    Some(LaserView {
        from,
        spot: meets.then(|| from + direction * distance),
        direction,
        normal,
    })
}

/// Largest distance from the home pose at which the sensors of the home platform see the platform (m).
const AT_HOME_M: f64 = 0.02;

/// Beams of the home platform's sensors for the platform at `pose`; none if it is elsewhere.
pub fn home_beams(robot: &Robot, pose: &Pose) -> Vec<[Vec3; 2]> {
    let is_elsewhere = |home: &Home| (pose.position - home.pose().position).norm() > AT_HOME_M;
    let Some(home) = &robot.home_platform else {
        return Vec::new();
    };
    if robot.home.as_ref().is_some_and(is_elsewhere) {
        return Vec::new();
    }
    let reference = home.base_from_reference.pose();
    let beam = |sensor: &tautline_core::robot::HomeSensor| {
        let plane = home.planes.get(sensor.plane)?;
        let from = reference.transform(&sensor.origin_m.into());
        let direction = reference.orientation * Vec3::from(sensor.direction);
        let normal = pose.orientation * Vec3::from(plane.normal);
        let to_plane = plane.offset_m + normal.dot(&(pose.position - from));
        let distance = to_plane / normal.dot(&direction);
        let meets = distance.is_finite() && distance > 0.0;
        meets.then(|| [from, from + direction * distance])
    };
    home.sensors.iter().filter_map(beam).collect()
}
