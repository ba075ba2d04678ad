//! Machine-readable form of a plan.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::estimation::ParameterId;
use tautline_core::planning::{Expectation, Plan, Refused};
use tautline_core::robot::Robot;
use tautline_session::VersionedFile;

use crate::isolability::IsolabilityDocument;

/// Poses to measure and the expected results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlanDocument {
    /// Name of the robot.
    pub robot: String,
    /// The poses in order of measurement.
    pub poses: Vec<PlannedPoseDocument>,
    /// Number of feasible poses from which they were selected.
    pub candidates: usize,
    /// Number of poses drawn, and of those rejected.
    pub refused: Refused,
    /// Reason why it cannot be checked whether the cables can hold the platform, in one sentence; null if it is checked.
    #[serde(default)]
    pub unchecked_tensions: Option<String>,
    /// Travel distance through all poses, rotations counted at the platform's anchors (m).
    pub travel_m: f64,
    /// Largest absolute correlation of a coordinate with the order of measurement.
    pub largest_time_correlation: f64,
    /// Expected results of the plan.
    pub expected: ExpectedDocument,
    /// Expected results of as many random poses.
    pub random: ExpectedDocument,
    /// Root mean square standard deviation of the entry points after the first 0, 1, 2, .. poses (m); null if
    /// they leave something undetermined.
    pub entry_point_sd_after_m: Vec<Option<f64>>,
    /// Gain by more measurements of the home pose.
    #[serde(default)]
    pub home: Vec<HomeGainDocument>,
    /// Distances between poses that a tape would measure best, in the order of their gain.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub distances: Vec<PlannedDistanceDocument>,
    /// Goal of the plan: `geometry`, `faults`, `both` or `accuracy`.
    #[serde(default = "geometry")]
    pub goal: String,
    /// Value of the goal's criterion: larger is better, and only differences are meaningful; null if
    /// parameters are undetermined.
    #[serde(default)]
    pub reached: Option<f64>,
    /// Faults that the poses reveal, if requested.
    #[serde(default)]
    pub isolability: Option<IsolabilityDocument>,
    /// Move of each pulley that the poses detect as a check of a calibration; empty for other plans.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub detection: Vec<DetectionDocument>,
}

/// The move of a pulley that a check finds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DetectionDocument {
    /// Name of its cable.
    pub cable: String,
    /// Move in a random direction that is detected with 95 % probability (m); null if no move is.
    pub move_m: Option<f64>,
    /// Probability of detecting the requested move; null without one.
    pub probability: Option<f64>,
}

/// Expected position error of the platform if the home pose is measured more often.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HomeGainDocument {
    /// Number of measurements as a multiple of the present ones; null if the home pose is known exactly.
    pub times: Option<usize>,
    /// I-criterion: root mean square position error of the platform over the workspace (m).
    pub platform_m: Option<f64>,
}

/// A distance to measure with a tape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlannedDistanceDocument {
    /// The two poses; 0 is home.
    pub poses: [i64; 2],
    /// Distance of the platform's origin between them (m).
    pub distance_m: f64,
    /// I-criterion with this distance and those before it (m).
    pub platform_m: f64,
}

fn geometry() -> String {
    "geometry".to_owned()
}

/// A pose of the plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlannedPoseDocument {
    /// Label of the row in the measurements.
    pub pose: i64,
    /// Platform origin in the base frame (m).
    pub position_m: [f64; 3],
    /// Orientation, quaternion w first.
    pub orientation_wxyz: [f64; 4],
    /// Tensions that balance the platform (N); zeros where tension is not modelled.
    pub tensions_n: Vec<f64>,
    /// Expected laser distance (m).
    pub laser_m: Option<f64>,
}

/// Expected results of a set of poses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExpectedDocument {
    /// D-criterion: logarithm of the determinant of the information; null if parameters are undetermined.
    pub log_det: Option<f64>,
    /// E-criterion: standard deviation of the entry points along their worst common direction (m).
    pub worst_m: Option<f64>,
    /// A-criterion: root mean square standard deviation of the entry points (m).
    pub mean_m: Option<f64>,
    /// I-criterion: expected root mean square position error of the platform over the workspace, or over the volume of the
    /// goal `accuracy`, once the values are in the controller (m); null also without a home pose.
    pub platform_m: Option<f64>,
    /// Expected standard deviation of each parameter.
    pub parameters: Vec<ExpectedParameter>,
}

/// A parameter's expected standard deviation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExpectedParameter {
    /// Name of the parameter.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Standard deviation before measuring; null if it has no prior.
    pub prior_sd: Option<f64>,
    /// Expected standard deviation; null if undetermined.
    pub sd: Option<f64>,
}

impl VersionedFile for PlanDocument {
    const FORMAT: &'static str = "tautline-plan";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 64 << 20;
}

impl PlanDocument {
    /// The document of a plan for a robot.
    #[must_use]
    pub fn of(robot: &Robot, plan: &Plan) -> Self {
        let expected = |expectation: &Expectation| ExpectedDocument {
            log_det: Some(expectation.criteria.log_det).filter(|value| value.is_finite()),
            worst_m: expectation.criteria.worst_m,
            mean_m: expectation.criteria.mean_m,
            platform_m: expectation.criteria.platform_m,
            parameters: (plan.parameters().iter().zip(&expectation.sd))
                .filter(|(parameter, _)| !matches!(parameter.id, ParameterId::Deviation { .. }))
                .map(|(parameter, sd)| ExpectedParameter {
                    name: parameter.name.clone(),
                    unit: parameter.unit.to_owned(),
                    prior_sd: parameter.prior_sd,
                    sd: *sd,
                })
                .collect(),
        };
        Self {
            robot: robot.name.clone(),
            poses: (plan.poses.iter())
                .map(|planned| PlannedPoseDocument {
                    pose: planned.label,
                    position_m: planned.pose.position.into(),
                    orientation_wxyz: planned.pose.orientation_wxyz(),
                    tensions_n: planned.tensions_n.clone(),
                    laser_m: planned.laser_m,
                })
                .collect(),
            candidates: plan.candidates,
            refused: plan.refused,
            unchecked_tensions: robot.unchecked_tensions().map(str::to_owned),
            travel_m: plan.order.travel_m,
            largest_time_correlation: plan.order.worst_correlation(),
            expected: expected(&plan.expected),
            random: expected(&plan.random),
            entry_point_sd_after_m: (0..=plan.poses.len())
                .map(|count| plan.after(count).criteria.mean_m)
                .collect(),
            home: [Some(1), Some(4), Some(16), None]
                .map(|times| HomeGainDocument {
                    times,
                    platform_m: plan.platform_m_with_home(times),
                })
                .to_vec(),
            distances: (plan.distances.iter())
                .map(|distance| PlannedDistanceDocument {
                    poses: (distance.between)
                        .map(|place| place.map_or(0, |place| plan.poses[place].label)),
                    distance_m: distance.distance_m,
                    platform_m: distance.platform_m,
                })
                .collect(),
            goal: plan.goal.name().to_owned(),
            reached: plan.reached,
            isolability: None,
            detection: Vec::new(),
        }
    }
}
