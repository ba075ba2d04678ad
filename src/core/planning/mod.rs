//! Planning of the poses to measure, so that they determine the parameters of the robot best.
//!
//! Candidates are drawn that the robot can hold and the laser can measure. Of these, the poses are selected that suit a
//! [`Goal`] best, by default the determinant of the information matrix (D-optimal), and put in an order of short moves in
//! which no coordinate correlates with time. The expected standard deviations are known before any measurement.

mod candidates;
mod design;
mod expectation;
mod goal;
mod information_model;
mod order;
mod pose_set;
mod position_error;
mod prospects;
mod tape;
#[cfg(test)]
mod tests;

pub use candidates::Refused;
pub use expectation::{Accuracy, DesignCriteria, Expectation};
pub use goal::{Goal, Volume};
pub use order::Order;
pub use pose_set::{PoseSet, expect, iso_9283_poses, random_poses};
pub use position_error::{position_jacobians, position_weights};
pub use prospects::{Prospects, expected_dataset, prospects};
pub use tape::{PlannedDistance, TAPE_SD_M};

use nalgebra::DMatrix;

use crate::effect::BoundEffect;
use crate::estimation::{
    Control, EstimationError, ExpectedInformation, Method, Parameter, covariance_of,
};
use crate::geometry::Pose;
use crate::measurement::{Dataset, Measurements};
use crate::robot::Robot;
use crate::simulation::{PlannedRow, SimulationError, TensionRange, Workspace};

use candidates::{Candidate, draw};
use goal::Criterion;
use information_model::InformationModel;

/// Default number of poses to measure, the home pose not counted. Four times as many would roughly halve the errors of MINI, in
/// four times the time at the robot.
pub const USUAL_POSES: usize = 25;

/// Options of a plan.
#[derive(Debug, Clone)]
pub struct PlanOptions<'a> {
    /// Number of poses to measure, the home pose not counted.
    pub poses: usize,
    /// Number of feasible poses from which they are selected.
    pub candidates: usize,
    /// Seed of the random poses.
    pub seed: u64,
    /// Goal of the plan.
    pub goal: Goal,
    /// Workspace of the platform; by default around its home pose.
    pub workspace: Option<Workspace>,
    /// Tension limits of the cables; by default as suits the weight.
    pub tension: Option<TensionRange>,
    /// Fraction of the tension range at each end that poses avoid where enough of them can: the real robot
    /// differs from its description and may not be able to hold poses that the description can barely hold.
    pub tension_margin: f64,
    /// Effects to be estimated in addition.
    pub effects: &'a [BoundEffect],
    /// Existing measurements, counted from the same home pose; the plan complements them.
    pub existing: Option<&'a Measurements>,
    /// Treatment of the tensions in the later identification.
    pub method: Method,
    /// Smallest distance of the platform's anchors from entry points and from the faces of the frame (m).
    pub min_frame_distance_m: f64,
    /// Smallest and largest distance that the laser can measure (m).
    pub laser_range_m: [f64; 2],
}

impl PlanOptions<'_> {
    /// Plans `poses` poses from 3000 candidates, with the joint method.
    #[must_use]
    pub fn new(poses: usize, seed: u64) -> Self {
        Self {
            poses,
            candidates: 3000,
            seed,
            goal: Goal::Geometry,
            workspace: None,
            tension: None,
            tension_margin: 0.1,
            effects: &[],
            existing: None,
            method: Method::Joint,
            min_frame_distance_m: 0.02,
            laser_range_m: [0.02, 100.0],
        }
    }
}

/// Number of measurements of the home pose after which it counts as known exactly: a thousandth of its standard deviation.
const EXACTLY_KNOWN: f64 = 1e6;

/// Progress of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlanProgress {
    /// Drawing feasible poses.
    Candidates {
        /// Number of candidates found.
        found: usize,
        /// Number of candidates wanted.
        wanted: usize,
    },
    /// Poses are selected one by one.
    Chosen {
        /// Number of poses selected so far.
        poses: usize,
    },
    /// Selected poses are exchanged for better ones.
    Exchanged {
        /// Number of exchanges so far.
        exchanges: usize,
    },
}

/// Errors of planning.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The number of poses is zero.
    #[error("found 0 poses to plan, expected at least 1")]
    NoPoses,
    /// Every parameter is known exactly.
    #[error(
        "nothing to identify: every entry point, the home pose and the target plane count as known exactly"
    )]
    NothingToEstimate,
    /// The robot can hold too few poses.
    #[error(
        "only {found} of the {wanted} poses needed can be held and measured; of {} tried, {} have no cable path, {} no \
         tensions that hold the platform, {} none on the way from home, {} no usable laser distance, {} are too close to the frame",
        refused.tried, refused.kinematics, refused.tension, refused.way, refused.laser, refused.frame
    )]
    TooFewPoses {
        /// Number of poses found.
        found: usize,
        /// Number of poses wanted.
        wanted: usize,
        /// Numbers of rejected candidates by reason.
        refused: Refused,
    },
    /// No tensions within the limits balance the platform at a given pose.
    #[error("no tensions within the limits hold the platform at pose {number} of the plan")]
    NotHeld {
        /// Number of the pose in the plan, from 1.
        number: usize,
    },
    /// The position error in the volume cannot be predicted.
    #[error(
        "the position error in the volume cannot be predicted: the robot has no home pose, or no cable path reaches the \
         volume"
    )]
    NoAccuracy,
    /// The existing measurements cannot be used.
    #[error("the poses already measured do not give a solution that the plan could build on")]
    Existing,
    /// The observer cancelled.
    #[error("the plan was cancelled")]
    Cancelled,
    /// The robot or its measurements cannot be used.
    #[error(transparent)]
    Estimation(#[from] EstimationError),
    /// The robot cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

/// A pose to be measured.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedPose {
    /// Label of the pose in the later measurements.
    pub label: i64,
    /// Pose to command.
    pub pose: Pose,
    /// Tensions that balance the platform there (N); zeros where tension is not modelled.
    pub tensions_n: Vec<f64>,
    /// Expected laser distance (m).
    pub laser_m: Option<f64>,
}

/// Poses to measure, and the standard deviations expected from them.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The poses in order of measurement.
    pub poses: Vec<PlannedPose>,
    /// Number of poses drawn, and of those rejected.
    pub refused: Refused,
    /// Number of candidates from which the poses were selected.
    pub candidates: usize,
    /// Path length, and correlation of the coordinates with time.
    pub order: Order,
    /// Expected standard deviations after the plan, together with the poses already measured.
    pub expected: Expectation,
    /// The same for as many poses drawn at random from the candidates: root mean square over several sets.
    pub random: Expectation,
    /// Largest `ln det` of the information among the random sets.
    pub best_random_log_det: f64,
    /// Goal of the plan.
    pub goal: Goal,
    /// Value of the goal's criterion for all poses together: larger is better, and only differences are meaningful.
    /// `None` if the poses leave parameters undetermined.
    pub reached: Option<f64>,
    /// Robot and expected noise-free readings at all poses, measured and planned, as input of
    /// [`isolability`](crate::diagnosis::isolability).
    pub dataset: Dataset,
    /// Distances that a tape would measure best, in the order of their gain; none where the position error is undetermined.
    pub distances: Vec<PlannedDistance>,
    information: ExpectedInformation,
    platform: Option<DMatrix<f64>>,
}

impl Plan {
    /// The parameters that will be estimated, in the order of the expectations.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.information.parameters
    }

    /// Root mean square position error of the platform after an adjustment (m), see [`DesignCriteria::platform_m`], if the
    /// home pose is measured `times` times with its stated standard deviations; infinitely often if `None`.
    #[must_use]
    pub fn platform_m_with_home(&self, times: Option<usize>) -> Option<f64> {
        let factor = times.map_or(EXACTLY_KNOWN, |times| times as f64);
        let more = &self.information.home * (factor - 1.0);
        let total = self.information.of(0..self.poses.len()) + more;
        let covariance = covariance_of(&total)?;
        Some(self.platform.as_ref()?.dot(&covariance).max(0.0).sqrt())
    }

    /// Expectation after the first `count` poses of the plan: if it suffices, the rest can be left out.
    #[must_use]
    pub fn after(&self, count: usize) -> Expectation {
        let count = count.min(self.poses.len());
        Expectation::of(&self.information, self.platform.as_ref(), 0..count)
    }
}

/// Selects poses to measure on `robot`.
///
/// # Errors
/// If the robot can hold too few poses, there is nothing to identify, the existing measurements cannot be
/// used, or the observer cancelled.
pub fn plan(
    robot: &Robot,
    options: &PlanOptions<'_>,
    observer: &mut dyn FnMut(&PlanProgress) -> Control,
) -> Result<Plan, PlanError> {
    with_tension_margin(robot, options, |options, range| {
        let set = CandidateSet::draw(robot, options, range, observer)?;
        let labels = set.model.candidate_labels(set.candidates.len());
        let criterion = set.criterion(&set.information, labels, &set.candidates)?;
        let chosen = design::choose(&criterion, set.candidates.len(), options.poses, observer)?;
        let poses: Vec<Pose> = (chosen.iter())
            .map(|index| set.candidates[*index].pose)
            .collect();
        let is_held = |from: &Pose, to: &Pose| set.model.is_held_between(from, to);
        let order = Order::of(&set.model.robot, set.model.start(), &poses, &is_held);
        let ordered: Vec<Candidate> = (order.sequence.iter())
            .map(|place| set.candidates[chosen[*place]].clone())
            .collect();
        set.plan(&ordered, order)
    })
}

/// Evaluates `poses` in the given order as [`plan`] evaluates the poses that it selects; `options.poses` is ignored.
///
/// # Errors
/// As [`plan`], and if the platform cannot be held at one of the poses.
pub fn evaluate(
    robot: &Robot,
    poses: &[Pose],
    options: &PlanOptions<'_>,
    observer: &mut dyn FnMut(&PlanProgress) -> Control,
) -> Result<Plan, PlanError> {
    let options = PlanOptions {
        poses: poses.len(),
        ..options.clone()
    };
    with_tension_margin(robot, &options, |options, range| {
        let set = CandidateSet::draw(robot, options, range, observer)?;
        let given: Result<Vec<Candidate>, PlanError> = (1..)
            .zip(poses)
            .map(|(number, pose)| {
                Candidate::chosen(&set.model, *pose).ok_or(PlanError::NotHeld { number })
            })
            .collect();
        let is_held = |from: &Pose, to: &Pose| set.model.is_held_between(from, to);
        let order = Order::given(&set.model.robot, set.model.start(), poses, &is_held);
        set.plan(&given?, order)
    })
}

/// Plans with tensions that keep the margin from their limits, or within the limits if that is impossible.
fn with_tension_margin<T>(
    robot: &Robot,
    options: &PlanOptions<'_>,
    mut plan: impl FnMut(&PlanOptions<'_>, TensionRange) -> Result<T, PlanError>,
) -> Result<T, PlanError> {
    let range = options.tension.unwrap_or_else(|| TensionRange::of(robot));
    match plan(options, range.inner(options.tension_margin)) {
        Err(
            PlanError::TooFewPoses { .. } | PlanError::NotHeld { .. } | PlanError::Simulation(_),
        ) => plan(options, range),
        planned => planned,
    }
}

/// Candidate poses, with the information that each would add.
struct CandidateSet<'a> {
    model: InformationModel<'a>,
    options: &'a PlanOptions<'a>,
    candidates: Vec<Candidate>,
    refused: Refused,
    information: ExpectedInformation,
}

impl<'a> CandidateSet<'a> {
    fn draw(
        robot: &Robot,
        options: &'a PlanOptions<'a>,
        range: TensionRange,
        observer: &mut dyn FnMut(&PlanProgress) -> Control,
    ) -> Result<Self, PlanError> {
        if options.poses == 0 {
            return Err(PlanError::NoPoses);
        }
        let model = InformationModel::new(robot, options, range)?;
        let (candidates, refused) = draw(&model, options, observer)?;
        let labels = model.candidate_labels(candidates.len());
        let information =
            model.information(labels.zip(&candidates).map(|(label, c)| c.row(label)))?;
        if information.parameters.is_empty() {
            return Err(PlanError::NothingToEstimate);
        }
        Ok(Self {
            model,
            options,
            candidates,
            refused,
            information,
        })
    }

    /// The goal's criterion, where `information` is that on the geometry.
    fn criterion(
        &self,
        information: &ExpectedInformation,
        labels: impl Iterator<Item = i64>,
        poses: &[Candidate],
    ) -> Result<Criterion, PlanError> {
        let goal = self.options.goal;
        let faults = if goal.needs_faults() {
            let visits = labels
                .zip(poses)
                .map(|(label, candidate)| candidate.row(label));
            Some(self.model.information_with_faults(visits)?)
        } else {
            None
        };
        let weights = match goal {
            Goal::Accuracy(volume) => {
                let InformationModel {
                    robot, workspace, ..
                } = &self.model;
                let workspace = workspace.of_volume(volume.centre_m(), volume.half_extent_m());
                let weights = position_weights(robot, &workspace, &information.parameters);
                Some(weights.ok_or(PlanError::NoAccuracy)?)
            }
            _ => None,
        };
        Ok(Criterion::new(goal, information, faults, weights.as_ref()))
    }

    /// Distances to measure between home and the poses of a plan with this information.
    fn distances(
        &self,
        visits: impl Iterator<Item = PlannedRow>,
        information: &ExpectedInformation,
        weights: &DMatrix<f64>,
    ) -> Result<Vec<PlannedDistance>, PlanError> {
        let covariance = covariance_of(&information.of(0..information.poses.len()));
        let Some((covariance, (readings, expected))) =
            covariance.zip(self.model.distances(visits)?)
        else {
            return Ok(Vec::new());
        };
        let first = usize::from(self.model.robot.home.is_some());
        let chosen = tape::choose(expected, covariance, weights).into_iter();
        let planned = chosen.map(|(index, platform_m)| PlannedDistance {
            between: readings[index].rows.map(|row| row.checked_sub(first)),
            distance_m: readings[index].distance_m,
            platform_m,
        });
        Ok(planned.collect())
    }

    /// The plan that visits these poses one after the other.
    fn plan(&self, ordered: &[Candidate], order: Order) -> Result<Plan, PlanError> {
        let options = self.options;
        let InformationModel {
            robot, workspace, ..
        } = &self.model;
        let parameters = &self.information.parameters;
        let within = match options.goal {
            Goal::Accuracy(volume) => {
                workspace.of_volume(volume.centre_m(), volume.half_extent_m())
            }
            _ => *workspace,
        };
        let platform = position_weights(robot, &within, parameters);
        let known = (&self.information, platform.as_ref());
        let random = expectation::random_sets(known, options.poses, options.seed);
        // Evaluated again, now that time and direction of travel are known.
        let labels = self.model.labels();
        let visits = labels
            .clone()
            .zip(ordered)
            .map(|(label, candidate)| candidate.row(label));
        let information = self.model.information(visits.clone())?;
        let criterion = self.criterion(&information, labels.clone(), ordered)?;
        let all: Vec<usize> = (0..ordered.len()).collect();
        let distances = match &platform {
            Some(weights) => self.distances(visits.clone(), &information, weights)?,
            None => Vec::new(),
        };
        Ok(Plan {
            distances,
            goal: options.goal,
            reached: criterion.value(&all),
            dataset: self.model.dataset(visits)?,
            poses: labels
                .zip(ordered)
                .map(|(label, candidate)| PlannedPose {
                    label,
                    pose: candidate.pose,
                    tensions_n: candidate.tensions_n.clone(),
                    laser_m: candidate.laser_m,
                })
                .collect(),
            refused: self.refused,
            candidates: self.candidates.len(),
            order,
            expected: Expectation::of(&information, platform.as_ref(), 0..ordered.len()),
            random: random.typical,
            best_random_log_det: random.best_log_det,
            information,
            platform,
        })
    }
}
