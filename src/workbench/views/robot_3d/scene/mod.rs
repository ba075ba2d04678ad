//! Scene as plain data (base frame, metres), without colours, camera or graphics card.

mod beside;
mod build;
mod cable;
mod displacement;
pub mod errors;
mod frame;
mod measured;
mod path;
mod platform;
mod residuals;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use tautline_core::geometry::{Pose, Vec3};
use tautline_session::DecisionRule;

pub use build::SceneInputs;
pub use displacement::{Displacement, PlacedCable, Significance};
pub use errors::PositionError;
pub use frame::{Floor, FrameBox};
pub use measured::{MeasuredPose, MeasuredPoses};
pub use path::PulleyPaths;
pub use platform::PlatformBox;

use super::camera::Directions;

/// Share of the robot's size for the largest displacement as drawn, by default.
const WELL_SEEN: f64 = 0.1;
/// Default exaggeration factors.
const EXAGGERATIONS: [f64; 8] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];

/// Smallest and largest coordinates of points (m); infinite and reversed if there are none.
fn bounds<'a>(points: impl Iterator<Item = &'a Vec3>) -> [Vec3; 2] {
    let infinite = Vec3::repeat(f64::INFINITY);
    points.fold([infinite, -infinite], |[low, high], p| {
        [low.inf(p), high.sup(p)]
    })
}

/// Coordinate axis that is most perpendicular to a unit vector.
pub(super) fn unlike(axis: &Vec3) -> Vec3 {
    Vec3::ith(axis.iamin(), 1.0)
}

/// Corners of a box; bit k of the index selects the upper end along axis k.
fn corners(low: &Vec3, high: &Vec3) -> [Vec3; 8] {
    std::array::from_fn(|k| Vec3::from_fn(|axis, _| [low, high][k >> axis & 1][axis]))
}

/// Pulley at a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheel {
    /// Entry point of the cable (m).
    pub entry: Vec3,
    /// Centre (m).
    pub centre: Vec3,
    /// Unit vector perpendicular to its plane.
    pub normal: Vec3,
    /// Radius at the cable's centre line (m); 0 for an eyelet.
    pub radius_m: f64,
}

/// Second set of pulleys, beside the identified ones.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Reference {
    /// None, because nothing is identified.
    #[default]
    Nothing,
    /// Pulleys of the drawing.
    Drawing,
    /// Pulleys of another session.
    Other(SideNames),
}

/// Names of two sets of pulleys in one picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SideNames {
    /// Set drawn solid.
    pub first: &'static str,
    /// Set drawn transparent.
    pub second: &'static str,
}

/// Residual of the readings, in standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Residual {
    /// Single residual with its sign.
    One(f64),
    /// Root mean square of a number of residuals.
    Rms(f64, usize),
}

impl Residual {
    /// Value in standard deviations.
    #[must_use]
    pub fn value(self) -> f64 {
        match self {
            Self::One(value) | Self::Rms(value, _) => value,
        }
    }
}

/// Cable at the shown pose.
#[derive(Debug, Clone, PartialEq)]
pub struct CableView {
    /// Name.
    pub label: String,
    /// Points from the winch's side over the pulley to the platform (m).
    pub path: Vec<Vec3>,
    /// Pulley, identified if there is an identification.
    pub wheel: Wheel,
    /// Second pulley, of the drawing or another session.
    pub nominal: Option<Wheel>,
    /// Displacement between the two pulleys.
    pub moved: Option<Displacement>,
    /// Standard deviations of the coordinates of the drawing (m), if known.
    pub prior_sd_m: [Option<f64>; 3],
    /// Straight length (m); `None` if there is no path at this pose.
    pub free_m: Option<f64>,
    /// Tension (N), if known.
    pub tension_n: Option<f64>,
    /// Residual of its lengths: at the selected pose, otherwise over all poses.
    pub residual: Option<Residual>,
}

/// Laser at the shown pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaserView {
    /// Origin of the beam on the platform (m).
    pub from: Vec3,
    /// Intersection with the target plane (m); `None` if there is none.
    pub spot: Option<Vec3>,
    /// Direction of the beam, unit vector.
    pub direction: Vec3,
    /// Normal of the target plane, unit vector.
    pub normal: Vec3,
}

/// Source of the shown pose.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ShownPose {
    /// Home pose, or the middle of the pulleys for a robot without one.
    #[default]
    Home,
    /// Measured pose as fitted.
    Fitted(i64),
    /// Measured pose as commanded or tracked.
    Given(i64),
    /// Live pose of the platform.
    Live,
    /// Live pose of the platform after a stop.
    Stopped,
}

/// Geometry of the 3D view.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// View directions: right, away from the viewer, up.
    pub directions: Directions,
    /// Source of the shown pose.
    pub shown: ShownPose,
    /// Pose of the platform.
    pub pose: Pose,
    /// Members of the frame and the floor.
    pub frame: FrameBox,
    /// Cables with their pulleys.
    pub cables: Vec<CableView>,
    pub platform: PlatformBox,
    /// Laser, if the robot has one.
    pub laser: Option<LaserView>,
    /// Beams of the home platform's sensors, from the sensor to its plane (m).
    pub home_beams: Vec<[Vec3; 2]>,
    pub measured: Arc<MeasuredPoses>,
    /// Positions of the planned poses (m).
    pub planned: Vec<Vec3>,
    /// Trail of the platform since the operation began (m), oldest first.
    pub trail: Arc<Vec<Vec3>>,
    /// Errors of position of the platform, if shown.
    pub errors: Vec<PositionError>,
    /// Second set of pulleys, beside the identified ones.
    pub reference: Reference,
    /// Positions of the pulleys at several dates, if known.
    pub paths: Option<PulleyPaths>,
    /// Largest acceptable displacement of a pulley from the drawing (m), if known.
    pub tolerance_m: Option<f64>,
    /// Decision rule for the conformity of a displacement with the tolerance.
    pub decision_rule: DecisionRule,
}

impl Scene {
    /// Points that a view of everything must contain (m).
    #[must_use]
    pub fn extent(&self) -> Vec<Vec3> {
        let mut points = self.frame.corners.clone();
        points.extend(self.cables.iter().flat_map(|cable| {
            let nominal = cable.nominal.iter();
            nominal.chain([&cable.wheel]).map(|wheel| wheel.centre)
        }));
        points
    }

    /// Exaggeration at which the largest displacement, with its ellipsoid, is well visible but does not hide the robot:
    /// 1, 2, 5, 10 and so on up to 200.
    #[must_use]
    pub fn fitting_exaggeration(&self) -> f64 {
        let moved = self.cables.iter().filter_map(|cable| cable.moved.as_ref());
        let errors = self.errors.iter().map(|error| error.by.norm());
        let paths = self.paths.iter().map(PulleyPaths::reach_m);
        let largest_m = moved
            .map(Displacement::reach_m)
            .chain(errors)
            .chain(paths)
            .fold(0.0, f64::max);
        let most = WELL_SEEN * self.frame.size_m / largest_m;
        EXAGGERATIONS
            .into_iter()
            .rev()
            .find(|one| *one <= most)
            .unwrap_or(1.0)
    }

    /// Centre and radius of a sphere around the scene and `others` (m).
    #[must_use]
    pub fn bounds(&self, others: &[Vec3]) -> (Vec3, f64) {
        let frame = &self.frame;
        let points = frame.corners.iter().chain(&frame.floor.corners);
        let points = points.chain(&self.planned).chain(others);
        let [low, high] = points.fold(self.measured.bounds, |[low, high], p| {
            [low.inf(p), high.sup(p)]
        });
        let radius = (high - low).norm() / 2.0;
        // With room for ellipsoids that extend beyond the frame.
        ((low + high) / 2.0, 2.0 * radius + 1e-3)
    }
}
