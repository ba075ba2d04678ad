//! Machine form of a plan.

use super::isolability::IsolabilityDocument;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::planning::{Expectation, Plan, Refused};
use tautline_core::robot::Robot;
use tautline_session::VersionedFile;

/// Poses to measure, and what to expect of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlanDocument {
    /// Name of the robot.
    pub robot: String,
    /// The poses in the order in which to measure them.
    pub poses: Vec<PlannedPoseDocument>,
    /// Number of poses that can be measured among which was chosen.
    pub candidates: usize,
    /// Poses drawn, and why some were refused.
    pub refused: Refused,
    /// Travel distance through all poses, rotations counted at the platform's anchors (m).
    pub travel_m: f64,
    /// Largest correlation of a coordinate with the order of measurement, without sign.
    pub largest_time_correlation: f64,
    /// What the plan gives.
    pub expected: ExpectedDocument,
    /// What as many poses at random give.
    pub random: ExpectedDocument,
    /// Root mean square standard deviation of the entry points after the first 0, 1, 2, .. poses (m); null where
    /// they leave something open.
    pub entry_point_sd_after_m: Vec<Option<f64>>,
    /// What measuring the home pose more often gains.
    #[serde(default)]
    pub home: Vec<HomeGainDocument>,
    /// What the poses are for: `geometry`, `faults`, `both` or `accuracy`.
    #[serde(default = "geometry")]
    pub goal: String,
    /// Value of the criterion of that goal, of which only differences mean anything: larger is better; null where
    /// parameters are left open.
    #[serde(default)]
    pub reached: Option<f64>,
    /// Which faults the poses show, where it was asked for.
    #[serde(default)]
    pub isolability: Option<IsolabilityDocument>,
}

/// Position error of the platform to expect if the home pose is measured more often.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HomeGainDocument {
    /// How many times as often as its standard deviations say by now; null: so often that it is known exactly.
    pub times: Option<usize>,
    /// I-index with that: root mean square position error of the platform over the workspace (m).
    pub platform_m: Option<f64>,
}

fn geometry() -> String {
    "geometry".to_owned()
}

/// A pose of the plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlannedPoseDocument {
    /// Label of its row in the measurements.
    pub pose: i64,
    /// Platform origin in the base frame (m).
    pub position_m: [f64; 3],
    /// Orientation, quaternion w first.
    pub orientation_wxyz: [f64; 4],
    /// Tensions that hold the platform (N); zeros where tension is not modelled.
    pub tensions_n: Vec<f64>,
    /// Laser distance to expect (m).
    pub laser_m: Option<f64>,
}

/// What to expect of a set of poses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExpectedDocument {
    /// D-index: logarithm of the determinant of the information; null where parameters are left open.
    pub log_det: Option<f64>,
    /// E-index: standard deviation of the entry points along their worst direction together (m).
    pub worst_m: Option<f64>,
    /// A-index: root mean square standard deviation of the entry points (m).
    pub mean_m: Option<f64>,
    /// I-index: root mean square position error of the platform over the workspace, or over the volume of the goal
    /// `accuracy`, to expect once the values are at the controller (m); null also without a home pose.
    pub platform_m: Option<f64>,
    /// Each parameter.
    pub parameters: Vec<ExpectedParameter>,
}

/// A parameter's expected standard deviation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExpectedParameter {
    /// Name.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Standard deviation before measuring; null if nothing is known.
    pub prior_sd: Option<f64>,
    /// Standard deviation to expect; null where it is left open.
    pub sd: Option<f64>,
}

impl VersionedFile for PlanDocument {
    const FORMAT: &'static str = "tautline-plan";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 64 << 20;
}

impl PlanDocument {
    /// Of a plan for a robot.
    #[must_use]
    pub fn of(robot: &Robot, plan: &Plan) -> Self {
        let expected = |expectation: &Expectation| ExpectedDocument {
            log_det: Some(expectation.criteria.log_det).filter(|value| value.is_finite()),
            worst_m: expectation.criteria.worst_m,
            mean_m: expectation.criteria.mean_m,
            platform_m: expectation.criteria.platform_m,
            parameters: (plan.parameters().iter().zip(&expectation.sd))
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
            goal: plan.goal.name().to_owned(),
            reached: plan.reached,
            isolability: None,
        }
    }
}
