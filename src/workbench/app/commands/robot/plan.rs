//! Poses to measure.

use tautline_core::estimation::Control;
use tautline_core::planning::PlanProgress;
use tautline_session::{Phase, PlannedPose};

use super::RobotOutcome;
use crate::app::Document;
use crate::app::command::Outcome;
use crate::app::edit::Edit;
use crate::app::state::State;
use crate::app::tasks::TaskHandle;
use tautline_workflow::planning::{Outlook, SEED, outlook, stored};
use tautline_workflow::wording;

/// Title of the task that plans.
pub const PLANNING: &str = "Planning poses";
/// Title of the task that computes what to expect of a plan.
pub const EXPECTING: &str = "Looking at the plan";

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
            result: outlook(&session, (poses, SEED), &mut |p| tell(task, p, poses)).map(Box::new),
        })
    });
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
            result: stored(&session, &mut |p| tell(task, p, session.plan.len())).map(Box::new),
        })
    });
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
