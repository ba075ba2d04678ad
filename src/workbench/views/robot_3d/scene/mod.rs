//! The scene as plain data (base frame, metres), without colours, camera or graphics card.

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

pub use build::Subject;
pub use displacement::{Displacement, Placed, Significance};
pub use errors::PositionError;
pub use frame::{Floor, FrameBox};
pub use measured::{MeasuredPose, MeasuredPoses};
pub use path::PulleyPaths;
pub use platform::PlatformBox;

use super::camera::Directions;

/// Part of the robot's size that the largest displacement spans as it is drawn, if nobody chose otherwise.
const WELL_SEEN: f64 = 0.1;
/// Exaggerations that are chosen by themselves.
const EXAGGERATIONS: [f64; 8] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];

/// Least and greatest coordinates of points (m); infinite and reversed if there are none.
fn bounds<'a>(points: impl Iterator<Item = &'a Vec3>) -> [Vec3; 2] {
    let infinite = Vec3::repeat(f64::INFINITY);
    points.fold([infinite, -infinite], |[low, high], p| {
        [low.inf(p), high.sup(p)]
    })
}

/// The axis that is least along a unit vector.
pub(super) fn unlike(axis: &Vec3) -> Vec3 {
    Vec3::ith(axis.iamin(), 1.0)
}

/// Corners of a box; bit k of the index chooses the upper end along axis k.
fn corners(low: &Vec3, high: &Vec3) -> [Vec3; 8] {
    std::array::from_fn(|k| Vec3::from_fn(|axis, _| [low, high][k >> axis & 1][axis]))
}

/// A pulley at a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheel {
    /// Where the cable reaches it (m).
    pub entry: Vec3,
    /// Its centre (m).
    pub centre: Vec3,
    /// Unit vector across its plane.
    pub normal: Vec3,
    /// Radius at the cable's centre line (m); 0 for an eyelet.
    pub radius_m: f64,
}

/// What the pulleys are that are shown besides the identified ones.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Besides {
    /// There are none, because nothing is identified.
    #[default]
    Nothing,
    /// Those of the drawing.
    Drawing,
    /// Those of another session.
    Other(SideNames),
}

/// What two sets of pulleys in one picture are called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SideNames {
    /// The solid ones.
    pub first: &'static str,
    /// The transparent ones.
    pub second: &'static str,
}

/// How well the model predicts what was measured, in standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Residual {
    /// One residual with its sign.
    One(f64),
    /// Root mean square of so many.
    Rms(f64, usize),
}

impl Residual {
    /// The number, in standard deviations.
    #[must_use]
    pub fn value(self) -> f64 {
        match self {
            Self::One(value) | Self::Rms(value, _) => value,
        }
    }
}

/// A cable at the pose shown.
#[derive(Debug, Clone, PartialEq)]
pub struct CableView {
    /// What it is called.
    pub label: String,
    /// From the winch's side over the pulley to the platform (m).
    pub path: Vec<Vec3>,
    /// Its pulley, identified if there is an identification.
    pub wheel: Wheel,
    /// The pulley that is shown besides.
    pub nominal: Option<Wheel>,
    /// How the two differ.
    pub moved: Option<Displacement>,
    /// Standard deviations of the coordinates of the drawing (m), where they are known.
    pub prior_sd_m: [Option<f64>; 3],
    /// Straight part (m); `None` where it has no path at this pose.
    pub free_m: Option<f64>,
    /// Tension (N), if known.
    pub tension_n: Option<f64>,
    /// How well its lengths are predicted: at the selected pose, else over all.
    pub residual: Option<Residual>,
}

/// The laser at the pose shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaserView {
    /// Where the beam leaves the platform (m).
    pub from: Vec3,
    /// Where it meets the target plane (m); `None` if it does not.
    pub spot: Option<Vec3>,
    /// Direction of the beam, unit vector.
    pub direction: Vec3,
    /// Normal of the target plane, unit vector.
    pub normal: Vec3,
}

/// Which pose is shown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Shown {
    /// The home pose, or the middle of the pulleys for a robot without.
    #[default]
    Home,
    /// A measured pose as it was fitted.
    Fitted(i64),
    /// A measured pose as it was commanded or tracked.
    Given(i64),
    /// Where the platform is now.
    Live,
    /// Where the platform rests after it was stopped.
    Stopped,
}

/// Everything there is to see.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Right, away from the viewer, up.
    pub directions: Directions,
    /// Which pose is shown.
    pub shown: Shown,
    /// Pose of the platform.
    pub pose: Pose,
    /// Members of the frame and the floor.
    pub frame: FrameBox,
    /// The cables with their pulleys.
    pub cables: Vec<CableView>,
    pub platform: PlatformBox,
    /// The laser, if the robot has one.
    pub laser: Option<LaserView>,
    /// Beams of the home platform's sensors, from the sensor to its plane (m).
    pub home_beams: Vec<[Vec3; 2]>,
    pub measured: Arc<MeasuredPoses>,
    /// Planned poses (m).
    pub planned: Vec<Vec3>,
    /// Where the platform has been since what goes on began (m), the oldest first.
    pub trail: Arc<Vec<Vec3>>,
    /// How far the platform was from where it was sent, where that is shown.
    pub errors: Vec<PositionError>,
    /// What pulleys are shown besides the identified ones.
    pub besides: Besides,
    /// Where the pulleys were at several dates, if that is known.
    pub paths: Option<PulleyPaths>,
    /// How far a pulley may be from the drawing, if that is known (m).
    pub tolerance_m: Option<f64>,
    /// By which rule it is decided whether a displacement is within the tolerance.
    pub decision_rule: DecisionRule,
}

impl Scene {
    /// What a view of everything must contain (m).
    #[must_use]
    pub fn extent(&self) -> Vec<Vec3> {
        let mut points = self.frame.corners.clone();
        points.extend(self.cables.iter().flat_map(|cable| {
            let nominal = cable.nominal.iter();
            nominal.chain([&cable.wheel]).map(|wheel| wheel.centre)
        }));
        points
    }

    /// The exaggeration at which the largest displacement, with its ellipsoid, spans a part of the robot that is
    /// well seen and does not hide it: 1, 2, 5, 10 and so on up to 200.
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

    /// Centre and radius of a sphere around everything that is drawn and `others` (m).
    #[must_use]
    pub fn bounds(&self, others: &[Vec3]) -> (Vec3, f64) {
        let frame = &self.frame;
        let points = frame.corners.iter().chain(&frame.floor.corners);
        let points = points.chain(&self.planned).chain(others);
        let [low, high] = points.fold(self.measured.bounds, |[low, high], p| {
            [low.inf(p), high.sup(p)]
        });
        let radius = (high - low).norm() / 2.0;
        // Ellipsoids may reach out of it.
        ((low + high) / 2.0, 2.0 * radius + 1e-3)
    }
}
