//! Sequential design of a measurement: after every pose, either all goals are reached or the next pose is chosen.
//!
//! [`SequentialDesign::next`] is a function of the measured poses alone, so an interrupted measurement continues with the same
//! decisions. After the first poses, which a plan for the whole geometry provides, the pose is chosen that brings the goals
//! closest per unit of time; `choice.rs` has the criterion. The run ends when all goals are reached, when no pose of the
//! workspace brings one of them closer, or at the largest number of poses.
//!
//! No decision uses a fixed level of a test: the probabilities are posterior ones, which a stopping rule does not change if the
//! prior is right (Berger and Wolpert, The Likelihood Principle, 1988). The calibration of the stated probabilities at the stop
//! is validated by simulation.

mod assessment;
mod choice;
mod goal;
#[cfg(test)]
mod tests;

use crate::diagnosis::{
    Cause, DiagnosisOptions, Finding, ShownFault, Verdict, diagnose, shown_faults,
};
use crate::effect::BoundEffect;
use crate::estimation::{Control, EstimationError, ExpectedInformation};
use crate::geometry::{Pose, Vec3};
use crate::measurement::{Dataset, Measurements};
use crate::planning::{
    Goal as PlanGoal, PlanError, PlanOptions, Prospects, expected_dataset, plan, prospects,
    random_poses,
};
use crate::robot::Robot;
use crate::simulation::Workspace;

pub use assessment::{Assessment, PossibleFault};
pub use goal::{Goal, GoalError, PROBABILITIES};

use choice::{Hypotheses, best, gains_of_accuracy, largest_sd_m, worst_cable};

/// Default of the largest number of poses.
pub const AT_MOST: usize = 60;
/// Number of poses, home not counted, that are measured before the first decision: fewer hardly determine both the geometry of
/// a robot of eight cables and its faults.
pub const FIRST_POSES: usize = 8;
/// Number of poses from which the first ones are selected.
const FIRST_CANDIDATES: usize = 400;
/// Number of poses of the workspace from which the next one is chosen.
const CANDIDATES: usize = 96;
/// Noncentrality at the largest number of poses from which the instruments count as able to show a fault: it is then found with a
/// probability of about 0.99.
const SHOWN: f64 = 40.0;
/// Difference of chi-square that decides between two sets of causes.
const DECISIVE_CHI2: f64 = 9.0;
/// Number of times that all poses are measured for the limit of the accuracy.
const UNLIMITED: f64 = 1e6;
/// Poses closer than this are the same (m and rad).
const SAME: f64 = 1e-9;

/// Options of a sequential design.
#[derive(Debug, Clone)]
pub struct SequentialOptions<'a> {
    /// Goals, all of which have to be reached.
    pub goals: &'a [Goal],
    /// Largest number of poses, the home pose not counted.
    pub at_most: usize,
    /// Poses that may be measured, instead of those of the workspace.
    pub among: Option<&'a [Pose]>,
    /// Seed, effects, method and limits, as those of a plan; goal, numbers and existing measurements are ignored.
    pub plan: PlanOptions<'a>,
}

/// Next step of a sequential design.
#[derive(Debug, Clone)]
pub enum NextStep {
    /// Measure this pose.
    Measure {
        /// Pose to command.
        pose: Pose,
        /// Reason for the choice of the pose.
        reason: Reason,
    },
    /// All goals are reached.
    Reached,
    /// No pose brings the remaining goals closer.
    CannotGetCloser(Vec<Obstacle>),
    /// The largest number of poses is measured.
    AtLimit,
}

/// Reason why a pose was chosen.
#[derive(Debug, Clone)]
pub enum Reason {
    /// One of the first poses, which determine the geometry.
    First,
    /// Makes the entry point of this cable more accurate.
    Narrows(usize),
    /// Tells one set of causes from another.
    Separates(Vec<Cause>, Vec<Cause>),
    /// Shows whether this fault is present.
    Tests(Cause),
}

/// Reason why a goal cannot be reached in this workspace with these instruments.
#[derive(Debug, Clone)]
pub enum Obstacle {
    /// However many poses are measured, the standard deviations stay above the limit.
    Accuracy {
        /// Smallest standard deviation that can be reached (m).
        reachable_m: f64,
        /// The same with a home pose that is known exactly.
        with_home_m: f64,
    },
    /// This cause is present, so that the robot is not free of faults.
    Present(Cause),
    /// No pose tells these sets of causes apart.
    Inseparable(Vec<Cause>, Vec<Cause>),
    /// All poses that may be measured are measured.
    NoPoseLeft,
}

/// A decision, with the assessment that it is based on.
#[derive(Debug, Clone)]
pub struct Decision {
    /// Next step.
    pub step: NextStep,
    /// Assessment of the measured poses; `None` while the first poses are measured.
    pub assessment: Option<Assessment>,
}

/// Errors of a sequential design.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SequentialError {
    /// The poses cannot be planned.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The measurements cannot be used.
    #[error(transparent)]
    Estimation(#[from] EstimationError),
}

/// A measurement whose poses are decided one by one.
#[derive(Debug)]
pub struct SequentialDesign<'a> {
    options: SequentialOptions<'a>,
    robot: Robot,
    first: Vec<Pose>,
    candidates: Vec<Pose>,
    /// Faults that the instruments can show, if causes are asked for.
    shown: Vec<FaultOfInterest>,
}

/// A fault that the instruments can show.
#[derive(Debug, Clone)]
pub struct FaultOfInterest {
    /// Effect and target, at typical size.
    pub cause: Cause,
    /// Size of interest as a multiple of this one: the smallest typical size, or the smallest that the largest number of poses would
    /// show if that is larger.
    pub factor: f64,
}

impl FaultOfInterest {
    /// Whether an effect is this fault, of at least the size of interest.
    #[must_use]
    pub fn includes(&self, effect: &BoundEffect) -> bool {
        let own = &self.cause.instances[0];
        is_same_target(own, effect) && size(effect) >= self.factor * size(own)
    }
}

impl<'a> SequentialDesign<'a> {
    /// Prepares the decisions for a robot.
    ///
    /// # Errors
    /// If the robot can hold too few poses or has nothing to identify.
    pub fn new(robot: &Robot, options: SequentialOptions<'a>) -> Result<Self, SequentialError> {
        let asks_for_causes = options.goals.iter().any(|goal| asks_for_causes(*goal));
        let (first, candidates) = match options.among {
            Some(poses) => (
                poses.iter().take(FIRST_POSES).copied().collect(),
                poses.to_vec(),
            ),
            None => {
                let quiet = &mut |_: &_| Control::Continue;
                let goal = match asks_for_causes {
                    true => PlanGoal::Both,
                    false => PlanGoal::Geometry,
                };
                let first = PlanOptions {
                    goal,
                    poses: FIRST_POSES.min(options.at_most.max(1)),
                    candidates: FIRST_CANDIDATES,
                    existing: None,
                    ..options.plan.clone()
                };
                let planned = plan(robot, &first, quiet)?;
                let further = PlanOptions {
                    poses: CANDIDATES,
                    ..first
                };
                let first = planned.poses.iter().map(|planned| planned.pose).collect();
                (first, random_poses(robot, &further)?)
            }
        };
        let mut design = Self {
            robot: robot.clone(),
            first,
            candidates,
            shown: Vec::new(),
            options,
        };
        if asks_for_causes {
            design.shown = design.shown_faults()?;
        }
        Ok(design)
    }

    /// Faults that the largest number of poses would show at a typical size.
    fn shown_faults(&self) -> Result<Vec<FaultOfInterest>, SequentialError> {
        let all = self.first.iter().chain(&self.candidates);
        let poses: Vec<Pose> = all.take(self.options.at_most).copied().collect();
        let at = PlanOptions {
            existing: None,
            ..self.options.plan.clone()
        };
        let dataset = expected_dataset(&self.robot, &poses, &at)?;
        let of_interest = |fault: ShownFault| {
            let [smallest, largest] = fault.typical_range;
            let visible = (SHOWN / fault.noncentrality).sqrt();
            (visible <= largest).then(|| FaultOfInterest {
                cause: fault.cause,
                factor: visible.max(smallest),
            })
        };
        let all = shown_faults(&dataset)?.into_iter();
        Ok(all.filter_map(of_interest).collect())
    }

    /// Faults that the instruments can show; empty unless causes are asked for.
    #[must_use]
    pub fn shown(&self) -> &[FaultOfInterest] {
        &self.shown
    }

    /// Decides on the next step from the measured poses. `excluded` are poses that could not be measured.
    ///
    /// # Errors
    /// If the measurements cannot be used.
    pub fn next(
        &self,
        measured: &Measurements,
        excluded: &[Pose],
    ) -> Result<Decision, SequentialError> {
        let home = self.robot.home.and(measured.home_row());
        let poses = measured.len() - usize::from(home.is_some());
        let is_new = |pose: &&Pose| {
            let commanded = measured.commanded.iter().flatten();
            let mut known = commanded.chain(excluded);
            known.all(|known| known.difference(pose).amax() > SAME)
        };
        if poses < FIRST_POSES.min(self.options.at_most)
            && let Some(pose) = self.first.iter().find(is_new)
        {
            return Ok(Decision {
                step: NextStep::Measure {
                    pose: *pose,
                    reason: Reason::First,
                },
                assessment: None,
            });
        }
        let left: Vec<Pose> = self.candidates.iter().filter(is_new).copied().collect();
        // What is known does not depend on the poses that are left.
        let looked_at = match left.is_empty() {
            true => &self.candidates,
            false => &left,
        };
        let (prospects, is_solved) = self.prospects(measured, looked_at)?;
        let dataset = self.dataset_to_diagnose(measured);
        let mut assessment = self.assess(&dataset, poses, &prospects)?;
        assessment.largest_sd_m = assessment.largest_sd_m.filter(|_| is_solved);
        let step = self.step(&dataset, &assessment, &prospects, !left.is_empty())?;
        Ok(Decision {
            step,
            assessment: Some(assessment),
        })
    }

    /// Prospects of each pose, and whether they are in addition to the measured poses: with a large fault, the model without it
    /// may have no solution; then the poses are valued as if nothing were measured.
    fn prospects(
        &self,
        measured: &Measurements,
        poses: &[Pose],
    ) -> Result<(Prospects, bool), PlanError> {
        let mut at = PlanOptions {
            existing: (measured.len() > 1).then_some(measured),
            ..self.options.plan.clone()
        };
        match prospects(&self.robot, poses, &at) {
            Err(PlanError::Existing) => {
                at.existing = None;
                Ok((prospects(&self.robot, poses, &at)?, false))
            }
            found => Ok((found?, true)),
        }
    }

    /// The effects to be estimated are part of the model that is diagnosed.
    fn dataset_to_diagnose(&self, measured: &Measurements) -> Dataset {
        let mut robot = self.robot.clone();
        let effects = self.options.plan.effects.iter();
        robot
            .effects
            .extend(effects.map(|bound| bound.setting(&self.robot)));
        Dataset {
            robot,
            measurements: measured.clone(),
        }
    }

    fn assess(
        &self,
        dataset: &Dataset,
        poses: usize,
        prospects: &Prospects,
    ) -> Result<Assessment, SequentialError> {
        let goals = self.options.goals.iter();
        let diagnosis = match goals.clone().any(|goal| asks_for_causes(*goal)) {
            true => {
                let quiet = &mut |_: &_| Control::Continue;
                Some(diagnose(dataset, &DiagnosisOptions::default(), quiet)?)
            }
            false => None,
        };
        Ok(Assessment::new(poses, prospects, diagnosis, &self.shown))
    }

    fn step(
        &self,
        dataset: &Dataset,
        assessment: &Assessment,
        prospects: &Prospects,
        is_pose_left: bool,
    ) -> Result<NextStep, SequentialError> {
        let goals = self.options.goals.iter().copied();
        let open: Vec<Goal> = goals.filter(|goal| !assessment.reaches(*goal)).collect();
        if open.is_empty() {
            return Ok(NextStep::Reached);
        }
        if assessment.poses >= self.options.at_most {
            return Ok(NextStep::AtLimit);
        }
        if !is_pose_left {
            return Ok(NextStep::CannotGetCloser(vec![Obstacle::NoPoseLeft]));
        }
        let hypotheses = match open.iter().any(|goal| asks_for_causes(*goal)) {
            true => Some(Hypotheses::new(dataset, assessment, prospects)?),
            false => None,
        };
        let mut obstacles = Vec::new();
        let mut gains = Vec::new();
        let mut are_causes_valued = false;
        for goal in open {
            if let Some(obstacle) = self.obstacle(goal, assessment, prospects, hypotheses.as_ref())
            {
                obstacles.push(obstacle);
                continue;
            }
            match (goal, &hypotheses) {
                (Goal::Accuracy(limit_m), _) => {
                    gains.push((goal, gains_of_accuracy(limit_m, &prospects.geometry)));
                }
                // Both goals ask the same of the poses.
                (_, Some(hypotheses)) if !are_causes_valued => {
                    are_causes_valued = true;
                    gains.push((goal, hypotheses.gains()));
                }
                _ => {}
            }
        }
        if gains.is_empty() {
            return Ok(NextStep::CannotGetCloser(obstacles));
        }
        Ok(self.chosen(dataset, &gains, prospects, hypotheses.as_ref()))
    }

    /// The best pose, and the goal that it serves most.
    fn chosen(
        &self,
        dataset: &Dataset,
        gains: &[(Goal, Vec<f64>)],
        prospects: &Prospects,
        hypotheses: Option<&Hypotheses>,
    ) -> NextStep {
        let workspace = self
            .options
            .plan
            .workspace
            .unwrap_or_else(|| Workspace::of(&self.robot));
        let across_m = 2.0 * Vec3::from(workspace.half_extent_m).norm();
        let last = dataset.measurements.commanded.iter().rev().flatten().next();
        let from = last.copied().unwrap_or(workspace.centre);
        let values: Vec<Vec<f64>> = gains.iter().map(|(_, gain)| gain.clone()).collect();
        let Some((index, _)) = best(&values, &prospects.poses, &from, across_m) else {
            return NextStep::CannotGetCloser(vec![Obstacle::NoPoseLeft]);
        };
        let most = gains
            .iter()
            .max_by(|a, b| a.1[index].total_cmp(&b.1[index]))
            .map(|(goal, _)| *goal);
        let about_causes = || {
            let hypotheses = hypotheses.filter(|_| !matches!(most, Some(Goal::Accuracy(_))))?;
            let rival = hypotheses.rival_at(index)?;
            let sets = &hypotheses.sets;
            Some(match rival.checked_sub(sets.len()) {
                None => Reason::Separates(sets[0].clone(), sets[rival].clone()),
                Some(fault) => Reason::Tests(hypotheses.unseen[fault].clone()),
            })
        };
        let narrows = || worst_cable(&prospects.geometry).map(Reason::Narrows);
        NextStep::Measure {
            pose: prospects.poses[index],
            reason: about_causes().or_else(narrows).unwrap_or(Reason::First),
        }
    }

    fn obstacle(
        &self,
        goal: Goal,
        assessment: &Assessment,
        prospects: &Prospects,
        hypotheses: Option<&Hypotheses>,
    ) -> Option<Obstacle> {
        if let Goal::Accuracy(limit_m) = goal {
            return accuracy_obstacle(limit_m, &prospects.geometry);
        }
        if let (Goal::FaultFree(_), Some(cause)) = (goal, named(assessment)) {
            return Some(Obstacle::Present(cause.clone()));
        }
        let hypotheses = hypotheses?;
        let times = self.options.at_most.saturating_sub(assessment.poses) as f64;
        let rival = hypotheses.inseparable(times, DECISIVE_CHI2)?;
        let (Goal::Cause(wanted) | Goal::FaultFree(wanted)) = goal else {
            return None;
        };
        let [own, other] = [0, rival].map(|set| assessment.sets[set].probability);
        let sets = &hypotheses.sets;
        // Rivals that are improbable anyway do not matter.
        (other > (1.0 - wanted) * (own + other))
            .then(|| Obstacle::Inseparable(sets[0].clone(), sets[rival].clone()))
    }
}

fn asks_for_causes(goal: Goal) -> bool {
    !matches!(goal, Goal::Accuracy(_))
}

/// A cause with all sizes multiplied by a factor.
fn scaled(cause: &Cause, factor: f64) -> Cause {
    let mut cause = cause.clone();
    for bound in &mut cause.instances {
        for (value, parameter) in bound.values.iter_mut().zip(bound.effect.parameters()) {
            if !parameter.discrete {
                *value = parameter.neutral + factor * (*value - parameter.neutral);
            }
        }
    }
    cause
}

/// Length of the deviations of the parameters from their neutral values.
fn size(bound: &BoundEffect) -> f64 {
    let parameters = bound.effect.parameters().iter();
    let deviations = parameters
        .zip(&bound.values)
        .filter(|(parameter, _)| !parameter.discrete)
        .map(|(parameter, value)| value - parameter.neutral);
    deviations.map(|by| by * by).sum::<f64>().sqrt()
}

fn is_same_target(one: &BoundEffect, other: &BoundEffect) -> bool {
    one.effect.id() == other.effect.id()
        && one.targeted == other.targeted
        && one.cables == other.cables
}

/// The cause that a finding names.
fn named(assessment: &Assessment) -> Option<&Cause> {
    let named = assessment
        .findings
        .iter()
        .find(|finding| finding.verdict() == Verdict::Named);
    named.and_then(Finding::cause)
}

/// The obstacle if an accuracy is out of reach even with very many poses.
fn accuracy_obstacle(limit_m: f64, of: &ExpectedInformation) -> Option<Obstacle> {
    let measured = of.of(0..of.poses.len()) - &of.common;
    let total = &of.common + measured * UNLIMITED;
    let reachable_m = largest_sd_m(of, &total)?;
    (reachable_m > limit_m).then(|| Obstacle::Accuracy {
        reachable_m,
        with_home_m: largest_sd_m(of, &(total + &of.home * UNLIMITED)).unwrap_or(reachable_m),
    })
}
