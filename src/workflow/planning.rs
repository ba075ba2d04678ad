//! Poses to measure and the precision to expect of them, for window and commands.

use std::collections::HashSet;

use tautline_core::estimation::Control;
use tautline_core::geometry::Pose;
use tautline_core::measurement::Measurements;
use tautline_core::planning::{DesignCriteria, Plan, PlanOptions, PlanProgress, evaluate, plan};
use tautline_session::{PlannedPose, Session};

use crate::documents::isolability::{IsolabilityDocument, IsolabilityTable};
use crate::identification::IdentificationRequest;
use crate::wording::{count, units};

/// Seed of the poses among which is chosen.
pub const SEED: u64 = 1;

/// A plan with the precision to expect of it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanSummary {
    /// The poses in their order; the home pose comes first where it is still to be measured.
    pub poses: Vec<PlannedPose>,
    /// Precision to expect from all poses together.
    pub expected: DesignCriteria,
    /// Precision to expect from as many random poses.
    pub random: DesignCriteria,
    /// Standard deviation of the entry points after so many of the poses, home not counted (m).
    pub after_m: Vec<Option<f64>>,
    /// Travel distance (m).
    pub travel_m: f64,
    /// What measuring the home pose more often gains.
    pub home: HomeGain,
    /// Which faults all poses together show; none where that could not be computed.
    pub isolability: Option<IsolabilityTable>,
}

/// How often the home pose might be measured, in multiples of what its standard deviations stand for.
const HOME_TIMES: [usize; 2] = [4, 16];

/// Root mean square position error of the platform after an adjustment (m), by how often the home pose is measured; all
/// lengths refer to that pose.
#[derive(Debug, Clone, PartialEq)]
pub struct HomeGain {
    /// With the home pose as well known as it is.
    pub now_m: Option<f64>,
    /// With so many times as many measurements.
    pub times: Vec<(usize, Option<f64>)>,
    /// With the home pose known exactly: the bound.
    pub bound_m: Option<f64>,
}

impl HomeGain {
    /// Of a plan.
    #[must_use]
    pub fn of(plan: &Plan) -> Self {
        Self {
            now_m: plan.platform_m_with_home(Some(1)),
            times: HOME_TIMES
                .map(|times| (times, plan.platform_m_with_home(Some(times))))
                .to_vec(),
            bound_m: plan.platform_m_with_home(None),
        }
    }

    /// In one sentence; `None` where it gains nothing worth saying.
    #[must_use]
    pub fn sentence(&self) -> Option<String> {
        let (now_m, bound_m) = (self.now_m?, self.bound_m?);
        if now_m - bound_m < WORTH_SAYING * now_m {
            return None;
        }
        let mm = |value_m: f64| units::mm(value_m, 2);
        let times = self.times.iter().filter_map(|(times, value_m)| {
            Some(format!(
                "{} mm if it is measured {times} times as often",
                mm((*value_m)?)
            ))
        });
        let mut parts: Vec<String> = times.collect();
        parts.push(format!("{} mm if it were known exactly", mm(bound_m)));
        Some(format!(
            "The home pose limits the position after an adjustment, {} mm over the workspace: {}.",
            mm(now_m),
            parts.join(", ")
        ))
    }
}

/// Part of the position error below which more measurements of the home pose are not worth a sentence.
const WORTH_SAYING: f64 = 0.05;

/// Options of a plan for what is to be identified, on top of the raw measurements `existing`.
fn options<'a>(
    request: &'a IdentificationRequest,
    existing: &'a Measurements,
    (poses, seed): (usize, u64),
) -> PlanOptions<'a> {
    PlanOptions {
        effects: &request.effects,
        // Before more poses than the home pose are measured there is nothing to build on.
        existing: (existing.len() > 1).then_some(existing),
        method: request.method,
        ..PlanOptions::new(poses, seed)
    }
}

fn request(session: &Session) -> Result<IdentificationRequest, String> {
    IdentificationRequest::of_session(session).map_err(|error| error.to_string())
}

/// Chooses so many poses with a seed, after those that are measured already; what to expect of them takes longer.
///
/// # Errors
/// One sentence, if there is no such plan or the observer cancelled it.
pub fn choose_poses(
    session: &Session,
    wanted: (usize, u64),
    observe: &mut dyn FnMut(&PlanProgress) -> Control,
) -> Result<Vec<PlannedPose>, String> {
    let planned = chosen(session, wanted, observe)?;
    Ok(with_home(session, &planned))
}

/// Chooses poses as [`choose_poses`] does, and says what to expect of them.
///
/// # Errors
/// One sentence, if there is no such plan or the observer cancelled it.
pub fn plan_poses(
    session: &Session,
    wanted: (usize, u64),
    observe: &mut dyn FnMut(&PlanProgress) -> Control,
) -> Result<PlanSummary, String> {
    let planned = chosen(session, wanted, observe)?;
    Ok(PlanSummary::of(with_home(session, &planned), &planned))
}

fn chosen(
    session: &Session,
    wanted: (usize, u64),
    observe: &mut dyn FnMut(&PlanProgress) -> Control,
) -> Result<Plan, String> {
    let request = request(session)?;
    let measured = session.dataset().measurements;
    let options = options(&request, &measured, wanted);
    let planned = plan(&request.dataset.robot, &options, observe);
    planned.map_err(|error| error.to_string())
}

impl PlanSummary {
    fn of(poses: Vec<PlannedPose>, planned: &Plan) -> Self {
        Self {
            poses,
            expected: planned.expected.criteria,
            random: planned.random.criteria,
            after_m: (0..=planned.poses.len())
                .map(|count| planned.after(count).criteria.mean_m)
                .collect(),
            travel_m: planned.order.travel_m,
            home: HomeGain::of(planned),
            isolability: IsolabilityDocument::of_dataset(&planned.dataset)
                .ok()
                .map(|document| IsolabilityTable::of(&document)),
        }
    }
}

/// Precision to expect from the plan of a session, on top of what was measured outside of it.
///
/// # Errors
/// One sentence, if nothing can be said or the observer cancelled it.
pub fn evaluate_plan(
    session: &Session,
    observe: &mut dyn FnMut(&PlanProgress) -> Control,
) -> Result<PlanSummary, String> {
    let request = request(session)?;
    let is_planned = |label: i64| session.plan.iter().any(|pose| pose.label == label);
    let measured = session.dataset().measurements;
    let others: Vec<usize> = (0..measured.len())
        .filter(|row| measured.labels[*row] == 0 || !is_planned(measured.labels[*row]))
        .collect();
    let measured = measured.select(&others);
    let poses: Vec<Pose> = (session.plan.iter())
        .filter(|pose| pose.label != 0)
        .map(PlannedPose::pose)
        .collect();
    let options = options(&request, &measured, (poses.len(), SEED));
    let planned = evaluate(&request.dataset.robot, &poses, &options, observe);
    let planned = planned.map_err(|error| error.to_string())?;
    Ok(PlanSummary::of(session.plan.clone(), &planned))
}

/// The poses with labels of their own, after the home pose where that is not measured yet.
fn with_home(session: &Session, planned: &Plan) -> Vec<PlannedPose> {
    let measured = &session.measurements.labels;
    let first = measured.iter().copied().fold(0, i64::max).saturating_add(1);
    let home = session.robot.home.filter(|_| !measured.contains(&0));
    let home = home.map(|home| PlannedPose::new(0, &home.pose()));
    let poses = planned.poses.iter().zip(first..);
    home.into_iter()
        .chain(poses.map(|(planned, label)| PlannedPose::new(label, &planned.pose)))
        .collect()
}

/// Poses in words, the home pose, of label 0, counted apart: `25 poses and the home pose`.
#[must_use]
pub fn poses_in_words(labels: impl IntoIterator<Item = i64>) -> String {
    let (mut poses, mut has_home) = (0, false);
    for label in labels {
        match label {
            0 => has_home = true,
            _ => poses += 1,
        }
    }
    match (poses, has_home) {
        (0, true) => "the home pose".to_owned(),
        (poses, true) => format!("{} and the home pose", count(poses, "pose")),
        (poses, false) => count(poses, "pose"),
    }
}

/// Labels of the plan that are not measured yet.
pub fn missing_labels(session: &Session) -> impl Iterator<Item = i64> + '_ {
    // Plans are short, measurements may be very many.
    let mut planned: Vec<i64> = session.plan.iter().map(|pose| pose.label).collect();
    planned.sort_unstable();
    let measured = session.measurements.labels.iter();
    let measured = measured.filter(|label| planned.binary_search(label).is_ok());
    let measured: HashSet<i64> = measured.copied().collect();
    let planned = session.plan.iter().map(|pose| pose.label);
    planned.filter(move |label| !measured.contains(label))
}
