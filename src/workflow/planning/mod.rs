//! Planning of poses and their expected precision, for window and commands.

mod document;

use std::collections::HashSet;

use tautline_core::estimation::Control;
use tautline_core::geometry::Pose;
use tautline_core::measurement::Measurements;
use tautline_core::planning::{
    DesignCriteria, Plan, PlanOptions, PlanProgress, TAPE_SD_M, evaluate, plan,
};
use tautline_session::{PlannedPose, Session};

use crate::identification::IdentificationRequest;
use crate::isolability::{IsolabilityDocument, IsolabilityTable};
use crate::wording::{count, units};

pub use document::{
    DetectionDocument, ExpectedDocument, ExpectedParameter, HomeGainDocument, PlanDocument,
    PlannedDistanceDocument, PlannedPoseDocument,
};

/// Seed of the candidate poses.
pub const SEED: u64 = 1;

/// A plan with its expected precision.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanSummary {
    /// The poses in order; the home pose comes first if it is still to be measured.
    pub poses: Vec<PlannedPose>,
    /// Expected precision of all poses together.
    pub expected: DesignCriteria,
    /// Expected precision of as many random poses.
    pub random: DesignCriteria,
    /// Standard deviation of the entry points after 0, 1, 2, .. of the poses, home not counted (m).
    pub after_m: Vec<Option<f64>>,
    /// Travel distance (m).
    pub travel_m: f64,
    /// Gain by more measurements of the home pose.
    pub home: HomeGain,
    /// Gain by distances that a tape measures, in one sentence; `None` if they are not worth it.
    pub tape: Option<String>,
    /// Faults that all poses together reveal; `None` if that could not be computed.
    pub isolability: Option<IsolabilityTable>,
}

/// Numbers of home pose measurements to evaluate, as multiples of the present ones.
const HOME_TIMES: [usize; 2] = [4, 16];

/// Root mean square position error of the platform after an adjustment (m), by the number of home pose measurements, as all
/// lengths refer to that pose.
#[derive(Debug, Clone, PartialEq)]
pub struct HomeGain {
    /// With the present uncertainty of the home pose.
    pub now_m: Option<f64>,
    /// With these multiples of the present number of measurements.
    pub times: Vec<(usize, Option<f64>)>,
    /// With an exactly known home pose: the lower bound.
    pub bound_m: Option<f64>,
}

impl HomeGain {
    /// The gain for a plan.
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

    /// The gain in one sentence; `None` if it is insignificant.
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

/// Fraction of the position error below which the gain is insignificant.
const WORTH_SAYING: f64 = 0.05;

/// What distances of a plan gain that a tape measures, in one sentence; `None` if they are not worth it. `label` is that of the pose at a
/// place of the plan.
#[must_use]
pub fn tape_gain(plan: &Plan, label: impl Fn(usize) -> i64) -> Option<String> {
    let last = plan.distances.last()?;
    let now_m = plan.expected.criteria.platform_m?;
    if now_m - last.platform_m < WORTH_SAYING * now_m {
        return None;
    }
    let name = |place: Option<usize>| {
        place.map_or("home".to_owned(), |place| format!("pose {}", label(place)))
    };
    let each = plan.distances.iter().map(|distance| {
        let [a, b] = distance.between.map(name);
        let metres = units::significant(distance.distance_m, 3);
        format!("from {a} to {b} ({metres} m)")
    });
    let each: Vec<String> = each.collect();
    Some(format!(
        "With a steel tape, the position error after an adjustment would be {} mm instead of {}: measure to {} mm how far the \
         platform moves {}.",
        units::mm(last.platform_m, 2),
        units::mm(now_m, 2),
        units::mm(TAPE_SD_M, 0),
        each.join(", ")
    ))
}

/// Options of a plan for a request, in addition to the raw measurements `existing`.
fn options<'a>(
    request: &'a IdentificationRequest,
    existing: &'a Measurements,
    (poses, seed): (usize, u64),
) -> PlanOptions<'a> {
    PlanOptions {
        effects: &request.effects,
        // With only the home pose measured there is nothing to build on.
        existing: (existing.len() > 1).then_some(existing),
        method: request.method,
        ..PlanOptions::new(poses, seed)
    }
}

fn request(session: &Session) -> Result<IdentificationRequest, String> {
    IdentificationRequest::of_session(session).map_err(|error| error.to_string())
}

/// Selects poses in addition to those already measured, without their expected precision, which takes longer.
///
/// # Errors
/// One sentence, if no such plan exists or the observer cancelled it.
pub fn choose_poses(
    session: &Session,
    wanted: (usize, u64),
    observe: &mut dyn FnMut(&PlanProgress) -> Control,
) -> Result<Vec<PlannedPose>, String> {
    let planned = chosen(session, wanted, observe)?;
    Ok(with_home(session, &planned))
}

/// Selects poses as [`choose_poses`] does, with their expected precision.
///
/// # Errors
/// One sentence, if no such plan exists or the observer cancelled it.
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
        let labels = poses.iter().map(|pose| pose.label);
        let labels: Vec<i64> = labels.filter(|label| *label != 0).collect();
        Self {
            poses,
            expected: planned.expected.criteria,
            random: planned.random.criteria,
            after_m: (0..=planned.poses.len())
                .map(|count| planned.after(count).criteria.mean_m)
                .collect(),
            travel_m: planned.order.travel_m,
            home: HomeGain::of(planned),
            tape: tape_gain(planned, |place| labels[place]),
            isolability: IsolabilityDocument::of_dataset(&planned.dataset)
                .ok()
                .map(|document| IsolabilityTable::of(&document)),
        }
    }
}

/// Expected precision of the plan of a session, in addition to measurements outside the plan.
///
/// # Errors
/// One sentence, if it cannot be evaluated or the observer cancelled it.
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

/// The poses with new labels, preceded by the home pose if that is not measured yet.
#[must_use]
pub fn with_home(session: &Session, planned: &Plan) -> Vec<PlannedPose> {
    let measured = &session.measurements.labels;
    let first = measured.iter().copied().fold(0, i64::max).saturating_add(1);
    let home = session.robot.home.filter(|_| !measured.contains(&0));
    let home = home.map(|home| PlannedPose::new(0, &home.pose()));
    let poses = planned.poses.iter().zip(first..);
    home.into_iter()
        .chain(poses.map(|(planned, label)| PlannedPose::new(label, &planned.pose)))
        .collect()
}

/// A number of poses in words, with the home pose (label 0) counted separately: `25 poses and the home pose`.
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
    // Plans are short, but there may be very many measurements.
    let mut planned: Vec<i64> = session.plan.iter().map(|pose| pose.label).collect();
    planned.sort_unstable();
    let measured = session.measurements.labels.iter();
    let measured = measured.filter(|label| planned.binary_search(label).is_ok());
    let measured: HashSet<i64> = measured.copied().collect();
    let planned = session.plan.iter().map(|pose| pose.label);
    planned.filter(move |label| !measured.contains(label))
}
