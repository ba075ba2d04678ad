//! Poses to measure.

use tautline_core::estimation::Control;
use tautline_core::planning::PlanProgress;
use tautline_session::{Phase as LogPhase, PlannedPose};

use crate::model::OpenSession;
use crate::model::command::{EXPECTING, Outcome, PLANNING, RobotOutcome};
use crate::model::edit::Edit;
use crate::model::tasks::TaskHandle;
use crate::shell::State;
use tautline_workflow::planning::{PlanSummary, SEED, evaluate_plan, plan_poses};
use tautline_workflow::wording;

pub(super) fn start(state: &mut State, poses: usize) {
    let Some(open) = &state.model.open else {
        return;
    };
    if state.model.link.is_measuring() || state.model.tasks.runs(PLANNING) {
        return;
    }
    let (identity, session) = (open.id(), open.session().clone());
    state.model.tasks.start(PLANNING, move |task| {
        Outcome::Robot(RobotOutcome::Planned {
            session_id: identity,
            result: plan_poses(&session, (poses, SEED), &mut |p| tell(task, p, poses))
                .map(Box::new),
        })
    });
}

/// Computes what to expect of the plan that the session has.
pub(super) fn expect_stored(state: &mut State) {
    let Some(open) = &state.model.open else {
        return;
    };
    if state.model.link.is_measuring()
        || state.model.tasks.runs(PLANNING)
        || state.model.tasks.runs(EXPECTING)
    {
        return;
    }
    let (identity, session) = (open.id(), open.session().clone());
    state.model.tasks.start(EXPECTING, move |task| {
        Outcome::Robot(RobotOutcome::Expected {
            session_id: identity,
            result: evaluate_plan(&session, &mut |p| tell(task, p, session.plan.len()))
                .map(Box::new),
        })
    });
}

/// Takes what to expect of a stored plan, if it still is the plan.
pub(super) fn expected(state: &mut State, identity: u64, result: Result<Box<PlanSummary>, String>) {
    let Some(open) = of_identity(state.model.open.as_mut(), identity) else {
        return;
    };
    state.panels.measuring.outlook = match result {
        Ok(outlook) if outlook.poses == open.session().plan => Ok(*outlook),
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

pub(super) fn planned(state: &mut State, identity: u64, result: Result<Box<PlanSummary>, String>) {
    let Some(open) = of_identity(state.model.open.as_mut(), identity) else {
        return;
    };
    let outlook = match result {
        Ok(outlook) => outlook,
        Err(error) => {
            state.model.messages.error(format!("No plan: {error}."));
            return;
        }
    };
    // What was measured stays in the plan, so that the plan remains the list of all poses.
    let measured = open.session().measurements.labels.clone();
    let mut plan: Vec<PlannedPose> = open.session().plan.clone();
    plan.retain(|pose| measured.contains(&pose.label));
    plan.extend(&outlook.poses);
    let count = outlook.poses.iter().filter(|pose| pose.label != 0).count();
    let poses = wording::count(count, "pose");
    open.edit(Edit::SetPlan(plan, format!("plan {poses}")));
    open.log(LogPhase::Poses, format!("Planned {poses}."));
    state.model.messages.info(format!("Planned {poses}."));
    state.panels.measuring.outlook = Some(Ok(*outlook));
}

fn of_identity(open: Option<&mut OpenSession>, identity: u64) -> Option<&mut OpenSession> {
    open.filter(|open| open.id() == identity)
}

pub(super) fn remove(state: &mut State, label: i64) {
    let Some(open) = &mut state.model.open else {
        return;
    };
    let mut plan = open.session().plan.clone();
    plan.retain(|pose| pose.label != label);
    let text = format!("remove pose {label} from the plan");
    open.edit(Edit::SetPlan(plan, text));
}

pub(super) fn add_current(state: &mut State) {
    let live = state.model.link.live();
    let commanded = live.sample.and_then(|sample| sample.commanded);
    let (Some(open), Some(pose)) = (&mut state.model.open, commanded) else {
        return;
    };
    let label = open.session().next_label();
    let mut plan = open.session().plan.clone();
    plan.push(PlannedPose::new(label, &pose));
    let text = format!("add pose {label} to the plan");
    open.edit(Edit::SetPlan(plan, text));
}
