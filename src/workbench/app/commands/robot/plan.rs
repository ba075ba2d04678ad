//! Poses to measure.

use tautline_core::effect::BoundEffect;
use tautline_core::estimation::{Control, Method};
use tautline_core::geometry::Pose;
use tautline_core::measurement::Measurements;
use tautline_core::planning::{Indices, Plan, PlanOptions, PlanProgress, expect, plan};
use tautline_session::{Phase, PlannedPose, Session};

use super::RobotOutcome;
use crate::app::Document;
use crate::app::command::Outcome;
use crate::app::edit::Edit;
use crate::app::state::State;
use crate::app::tasks::TaskHandle;
use crate::controllers::bounds;
use crate::wording;

/// Title of the task that plans.
pub const PLANNING: &str = "Planning poses";
/// Title of the task that computes what to expect of a plan.
pub const EXPECTING: &str = "Looking at the plan";

/// Seed of the poses among which is chosen.
const SEED: u64 = 1;

/// A plan and what to expect of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlook {
    /// The poses in their order, the home pose first where it is to be measured.
    pub poses: Vec<PlannedPose>,
    /// What all poses together tell.
    pub expected: Indices,
    /// What as many poses drawn at random would tell.
    pub random: Indices,
    /// Standard deviation of the entry points after so many of the poses, home not counted (m).
    pub after_m: Vec<Option<f64>>,
    /// Length of the way (m).
    pub way_m: f64,
}

pub(super) fn start(state: &mut State, poses: usize) {
    let Some(document) = &state.document else {
        return;
    };
    if state.link.is_measuring() || state.tasks.runs(PLANNING) {
        return;
    }
    let (identity, session) = (document.identity(), document.session().clone());
    state.tasks.start(PLANNING, move |task| {
        Outcome::Robot(RobotOutcome::Planned {
            document: identity,
            result: outlook(&session, poses, task).map(Box::new),
        })
    });
}

/// What is planned: the options that depend on the session alone.
fn options<'a>(
    session: &Session,
    effects: &'a [BoundEffect],
    existing: &'a Measurements,
    poses: usize,
) -> PlanOptions<'a> {
    let (workspace, tension) = bounds(&session.robot);
    PlanOptions {
        workspace: Some(workspace),
        tension: Some(tension),
        effects,
        // Before more poses than the home pose are measured there is nothing to build on.
        existing: (existing.len() > 1).then_some(existing),
        method: match session.settings.identification.method {
            tautline_session::Method::Simple => Method::Simple,
            _ => Method::Joint,
        },
        ..PlanOptions::new(poses, SEED)
    }
}

fn effects(session: &Session) -> Result<Vec<BoundEffect>, String> {
    let effects: Result<Vec<BoundEffect>, _> = (session.settings.identification.effects.iter())
        .map(|setting| BoundEffect::from_setting(setting, &session.robot))
        .collect();
    effects.map_err(|error| error.to_string())
}

fn outlook(session: &Session, poses: usize, task: &TaskHandle) -> Result<Outlook, String> {
    let effects = effects(session)?;
    let measured = session.dataset().measurements;
    let options = options(session, &effects, &measured, poses);
    let mut observe = |progress: &PlanProgress| tell(task, progress, poses);
    let planned = plan(&session.robot, &options, &mut observe);
    let planned = planned.map_err(|error| error.to_string())?;
    task.tell(None, "what to expect");
    Ok(Outlook::of(with_home(session, &planned), &planned))
}

impl Outlook {
    fn of(poses: Vec<PlannedPose>, planned: &Plan) -> Self {
        Self {
            poses,
            expected: planned.expected.indices,
            random: planned.random.indices,
            after_m: (0..=planned.poses.len())
                .map(|count| planned.after(count).indices.mean_m)
                .collect(),
            way_m: planned.order.travel_m,
        }
    }
}

/// Computes what to expect of the plan that the session has.
pub(super) fn expect_stored(state: &mut State) {
    let Some(document) = &state.document else {
        return;
    };
    if state.link.is_measuring() || state.tasks.runs(PLANNING) || state.tasks.runs(EXPECTING) {
        return;
    }
    let (identity, session) = (document.identity(), document.session().clone());
    state.tasks.start(EXPECTING, move |task| {
        Outcome::Robot(RobotOutcome::Expected {
            document: identity,
            result: stored(&session, task).map(Box::new),
        })
    });
}

/// What the plan of a session promises, built on what was measured outside of it.
fn stored(session: &Session, task: &TaskHandle) -> Result<Outlook, String> {
    let effects = effects(session)?;
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
    let options = options(session, &effects, &measured, poses.len());
    let mut observe = |progress: &PlanProgress| tell(task, progress, poses.len());
    let planned = expect(&session.robot, &poses, &options, &mut observe);
    let planned = planned.map_err(|error| error.to_string())?;
    Ok(Outlook::of(session.plan.clone(), &planned))
}

/// Takes what to expect of a stored plan, if it still is the plan.
pub(super) fn expected(state: &mut State, identity: u64, result: Result<Box<Outlook>, String>) {
    let Some(document) = of_identity(state.document.as_mut(), identity) else {
        return;
    };
    state.screens.measuring.outlook = match result {
        Ok(outlook) if outlook.poses == document.session().plan => Ok(*outlook),
        Ok(_) => return,
        Err(error) => Err(error),
    }
    .into();
}

fn tell(task: &TaskHandle, progress: &PlanProgress, poses: usize) -> Control {
    match *progress {
        PlanProgress::Candidates { found, wanted } => task.tell(
            Some(0.5 * found as f32 / wanted.max(1) as f32),
            "looking for poses that can be held",
        ),
        PlanProgress::Chosen { poses: chosen } => task.tell(
            Some(0.5 + 0.4 * chosen as f32 / poses.max(1) as f32),
            format!("pose {chosen} of {poses}"),
        ),
        PlanProgress::Exchanged { .. } => {
            task.tell(Some(0.95), "exchanging poses for better ones");
        }
    }
    if task.cancelled() {
        Control::Cancel
    } else {
        Control::Continue
    }
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

pub(super) fn planned(state: &mut State, identity: u64, result: Result<Box<Outlook>, String>) {
    let Some(document) = of_identity(state.document.as_mut(), identity) else {
        return;
    };
    let outlook = match result {
        Ok(outlook) => outlook,
        Err(error) => {
            state.messages.error(format!("No plan: {error}."));
            return;
        }
    };
    // What was measured stays in the plan, so that the plan remains the list of all poses.
    let measured = document.session().measurements.labels.clone();
    let mut plan: Vec<PlannedPose> = document.session().plan.clone();
    plan.retain(|pose| measured.contains(&pose.label));
    plan.extend(&outlook.poses);
    let count = outlook.poses.iter().filter(|pose| pose.label != 0).count();
    let poses = wording::count(count, "pose");
    document.edit(Edit::SetPlan(plan, format!("plan {poses}")));
    document.log(Phase::Poses, format!("Planned {poses}."));
    state.messages.info(format!("Planned {poses}."));
    state.screens.measuring.outlook = Some(Ok(*outlook));
}

fn of_identity(document: Option<&mut Document>, identity: u64) -> Option<&mut Document> {
    document.filter(|document| document.identity() == identity)
}

pub(super) fn remove(state: &mut State, label: i64) {
    let Some(document) = &mut state.document else {
        return;
    };
    let mut plan = document.session().plan.clone();
    plan.retain(|pose| pose.label != label);
    let text = format!("remove pose {label} from the plan");
    document.edit(Edit::SetPlan(plan, text));
}

pub(super) fn add_current(state: &mut State) {
    let live = state.link.live();
    let commanded = live.sample.and_then(|sample| sample.commanded);
    let (Some(document), Some(pose)) = (&mut state.document, commanded) else {
        return;
    };
    let label = document.session().next_label();
    let mut plan = document.session().plan.clone();
    plan.push(PlannedPose::new(label, &pose));
    let text = format!("add pose {label} to the plan");
    document.edit(Edit::SetPlan(plan, text));
}
