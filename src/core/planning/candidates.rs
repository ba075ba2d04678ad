//! Candidate poses that the robot can hold and its instruments can measure.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::information_model::InformationModel;
use super::{PlanError, PlanOptions, PlanProgress};
use crate::estimation::Control;
use crate::geometry::{Pose, Vec3};
use crate::kinematics::inverse_kinematics;
use crate::robot::{Laser, Robot};
use crate::simulation::{PlannedRow, bounds};

/// Number of poses drawn for each one wanted before giving up.
const TRIES_PER_POSE: usize = 20;
/// Probability with which a coordinate is drawn at its limit: poses far apart carry more information.
const AT_LIMIT: f64 = 0.4;
/// Smallest cosine of the angle of incidence at which the beam meets the target.
const LEAST_INCIDENCE: f64 = 0.5;
/// Number of poses drawn between two progress reports.
const REPORT_INTERVAL: usize = 500;

/// Number of poses drawn, and of those rejected by reason.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Refused {
    /// Number of poses drawn.
    pub tried: usize,
    /// A cable has no path.
    pub kinematics: usize,
    /// No tensions within the limits balance the platform.
    pub tension: usize,
    /// Tensions balance the platform at the pose, but not everywhere on the straight path from the home pose.
    #[serde(default)]
    pub way: usize,
    /// The beam misses the target, meets it beyond 60 degrees or at a distance outside the range.
    pub laser: usize,
    /// The platform would be too close to a pulley or a side of the frame.
    pub frame: usize,
}

/// A pose that can be held and measured.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub pose: Pose,
    pub tensions_n: Vec<f64>,
    pub laser_m: Option<f64>,
}

impl Candidate {
    /// A pose chosen by the user; `None` if no tensions balance the platform there.
    pub fn chosen(model: &InformationModel<'_>, pose: Pose) -> Option<Self> {
        let laser = model.robot.laser.as_ref();
        Some(Self {
            pose,
            tensions_n: model.tensions(&pose)?,
            laser_m: laser.and_then(|laser| laser_distance(laser, &pose)),
        })
    }

    /// The pose as a row of the measurements with this label.
    pub fn row(&self, label: i64) -> PlannedRow {
        PlannedRow {
            label,
            pose: self.pose,
            tensions_n: self.tensions_n.clone(),
        }
    }
}

/// Draws candidates until there are enough, or too many were rejected.
pub(super) fn draw(
    model: &InformationModel<'_>,
    options: &PlanOptions<'_>,
    observer: &mut dyn FnMut(&PlanProgress) -> Control,
) -> Result<(Vec<Candidate>, Refused), PlanError> {
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let wanted = options.candidates.max(options.poses);
    let frame = Frame::of(model, options.min_frame_distance_m);
    let mut refused = Refused::default();
    let mut found = Vec::with_capacity(wanted);
    while found.len() < wanted && refused.tried < TRIES_PER_POSE * wanted {
        if refused.tried % REPORT_INTERVAL == 0 {
            let progress = PlanProgress::Candidates {
                found: found.len(),
                wanted,
            };
            if observer(&progress) == Control::Cancel {
                return Err(PlanError::Cancelled);
            }
        }
        refused.tried += 1;
        let pose = draw_pose(model, &mut rng);
        found.extend(accept(model, options, &frame, pose, &mut refused));
    }
    if found.len() < options.poses {
        return Err(PlanError::TooFewPoses {
            found: found.len(),
            wanted: options.poses,
            refused,
        });
    }
    Ok((found, refused))
}

pub(super) fn draw_pose(model: &InformationModel<'_>, rng: &mut ChaCha8Rng) -> Pose {
    let workspace = &model.workspace;
    let twist = model.robot.platform.freedom().twist(|k| {
        let place: f64 = rng.random_range(-1.0..=1.0);
        let at_limit = rng.random_range(0.0..1.0) < AT_LIMIT;
        workspace.half_range(k) * if at_limit { place.signum() } else { place }
    });
    model.resting_pose(workspace.centre.perturbed(&twist))
}

pub(super) fn accept(
    model: &InformationModel<'_>,
    options: &PlanOptions<'_>,
    frame: &Frame,
    pose: Pose,
    refused: &mut Refused,
) -> Option<Candidate> {
    let robot = &model.robot;
    if inverse_kinematics(robot, &pose).is_err() {
        refused.kinematics += 1;
        return None;
    }
    if !frame.is_clear_of(robot, &pose) {
        refused.frame += 1;
        return None;
    }
    let laser_m = match &robot.laser {
        Some(laser) => {
            let distance = laser_distance(laser, &pose);
            let [near, far] = options.laser_range_m;
            let Some(usable) = distance.filter(|d| (near..=far).contains(d)) else {
                refused.laser += 1;
                return None;
            };
            Some(usable)
        }
        None => None,
    };
    let Some(tensions_n) = model.tensions(&pose) else {
        refused.tension += 1;
        return None;
    };
    if !model.is_held_between(&model.start(), &pose) {
        refused.way += 1;
        return None;
    }
    Some(Candidate {
        pose,
        tensions_n,
        laser_m,
    })
}

/// Distance from the sensor to the target plane along the beam (m); `None` where the beam misses it or grazes.
fn laser_distance(laser: &Laser, pose: &Pose) -> Option<f64> {
    let normal = Vec3::from(laser.target_plane.normal);
    let origin = pose.transform(&laser.origin_m.into());
    let towards = normal.dot(&(pose.orientation * Vec3::from(laser.direction)));
    let distance = (laser.target_plane.offset_m - normal.dot(&origin)) / towards;
    (towards.abs() >= LEAST_INCIDENCE && distance > 0.0).then_some(distance)
}

/// Entry points, and the faces of their bounding box that enclose the workspace.
pub(super) struct Frame {
    distance_m: f64,
    low: Vec3,
    high: Vec3,
}

impl Frame {
    pub fn of(model: &InformationModel<'_>, distance_m: f64) -> Self {
        let (mut low, mut high) = bounds(&model.robot);
        let centre = model.workspace.centre.position;
        for k in 0..3 {
            // A robot that hangs below its pulleys, or moves in their plane, has no face of the frame on that side.
            if centre[k] < low[k] + distance_m {
                low[k] = f64::NEG_INFINITY;
            }
            if centre[k] > high[k] - distance_m {
                high[k] = f64::INFINITY;
            }
        }
        Self {
            distance_m,
            low,
            high,
        }
    }

    fn is_clear_of(&self, robot: &Robot, pose: &Pose) -> bool {
        let margin = Vec3::repeat(self.distance_m);
        robot.cables.iter().all(|cable| {
            let anchor = pose.transform(&cable.platform_anchor_m.into());
            let inside = anchor >= self.low + margin && anchor <= self.high - margin;
            inside
                && robot.cables.iter().all(|other| {
                    let entry = Vec3::from(other.pulley.entry_point_m);
                    (anchor - entry).norm() >= self.distance_m
                })
        })
    }
}
