//! Planning of poses.

use tautline_core::estimation::Control;
use tautline_core::planning::PlanProgress;
use tautline_session::{Phase as LogPhase, PlannedPose};

use crate::model::command::{EXPECTING, PLANNING, PlanOutcome, PlanOutlook};
use crate::model::edit::Edit;
use crate::model::messages::Cause;
use crate::model::tasks::TaskHandle;
use crate::model::{Model, OpenSession};
use tautline_workflow::planning::{SEED, evaluate_plan, plan_poses};
use tautline_workflow::wording;

pub(super) fn start(model: &mut Model, poses: usize) {
    let Some(open) = &model.open else {
        return;
    };
    if model.link.is_measuring() || model.tasks.runs(PLANNING) {
        return;
    }
    let (session_id, session) = (open.id(), open.session().clone());
    model.messages.resolve(Cause::Planning);
    model.tasks.start(PLANNING, move |task| {
        let result = plan_poses(&session, (poses, SEED), &mut |p| tell(task, p, poses));
        let plan = result
            .as_ref()
            .map_or_else(|_| Vec::new(), |o| o.poses.clone());
        PlanOutcome::Planned(Box::new(PlanOutlook {
            session_id,
            plan,
            result,
        }))
        .into()
    });
}

/// Predicts the accuracy of the session's plan.
pub(super) fn expect_stored(model: &mut Model) {
    let Some(open) = &model.open else {
        return;
    };
    if model.link.is_measuring() || model.tasks.runs(PLANNING) || model.tasks.runs(EXPECTING) {
        return;
    }
    let (session_id, session) = (open.id(), open.session().clone());
    model.tasks.start(EXPECTING, move |task| {
        let result = evaluate_plan(&session, &mut |p| tell(task, p, session.plan.len()));
        PlanOutcome::Expected(Box::new(PlanOutlook {
            session_id,
            plan: session.plan,
            result,
        }))
        .into()
    });
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
    task.control()
}

pub fn planned(model: &mut Model, outcome: PlanOutcome) {
    let planned = match outcome {
        PlanOutcome::Planned(planned) => planned,
        PlanOutcome::Expected(expected) => {
            // The plan may have changed meanwhile.
            let open = model.open.as_ref();
            if open
                .is_some_and(|o| o.id() == expected.session_id && o.session().plan == expected.plan)
            {
                model.outlook = Some(*expected);
            }
            return;
        }
    };
    let is_same = |open: &&mut OpenSession| open.id() == planned.session_id;
    let Some(open) = model.open.as_mut().filter(is_same) else {
        return;
    };
    if let Err(error) = &planned.result {
        let text = format!("No plan: {error}.");
        model.messages.failure(Cause::Planning, text);
        return;
    }
    // Measured poses stay in the plan, so that it remains the list of all poses.
    let measured = open.session().measurements.labels.clone();
    let mut plan: Vec<PlannedPose> = open.session().plan.clone();
    plan.retain(|pose| measured.contains(&pose.label));
    plan.extend(&planned.plan);
    let count = planned.plan.iter().filter(|pose| pose.label != 0).count();
    let poses = wording::count(count, "pose");
    open.edit(Edit::SetPlan(plan, format!("plan {poses}")));
    open.log(LogPhase::Poses, format!("Planned {poses}."));
    model.messages.info(format!("Planned {poses}."));
    model.outlook = Some(*planned);
}

pub(super) fn remove(model: &mut Model, label: i64) {
    let Some(open) = &mut model.open else {
        return;
    };
    let mut plan = open.session().plan.clone();
    plan.retain(|pose| pose.label != label);
    let text = format!("remove pose {label} from the plan");
    open.edit(Edit::SetPlan(plan, text));
}

pub(super) fn add_current(model: &mut Model) {
    let live = model.link.live();
    let commanded = live.sample.and_then(|sample| sample.commanded);
    let (Some(open), Some(pose)) = (&mut model.open, commanded) else {
        return;
    };
    let label = open.session().next_label();
    let mut plan = open.session().plan.clone();
    plan.push(PlannedPose::new(label, &pose));
    let text = format!("add pose {label} to the plan");
    open.edit(Edit::SetPlan(plan, text));
}
