//! Findings of a diagnosis that are still to be decided.

use tautline_core::diagnosis::Finding;
use tautline_core::effect::EffectSetting;
use tautline_core::geometry::Pose;
use tautline_session::PlannedPose;

use super::OpenSession;
use super::edit::{Edit, same_effect};
use tautline_workflow::diagnosis::Diagnosed;
use tautline_workflow::formulas::PatternDocument;
use tautline_workflow::wording::count;

/// Whether all these effects are part of the model.
pub(crate) fn are_in_model(open: &OpenSession, effects: &[EffectSetting]) -> bool {
    let added = &open.session().settings.identification.effects;
    let is_added = |one: &EffectSetting| added.iter().any(|other| same_effect(one, other));
    effects.iter().all(is_added)
}

/// Whether the model explains the readings, alone or with the findings.
pub(crate) fn explain(diagnosed: &Diagnosed) -> bool {
    let diagnosis = &diagnosed.diagnosis;
    let is_extended = !diagnosis.findings.is_empty();
    diagnosis.base.adequate || is_extended && diagnosis.extended.adequate
}

/// Whether one of these effects belongs to the cause of a finding.
pub(crate) fn has_any(diagnosed: &Diagnosed, finding: &Finding, effects: &[EffectSetting]) -> bool {
    let settings = finding.cause().map(|cause| diagnosed.settings(cause));
    let mut settings = settings.into_iter().flatten();
    settings.any(|one| effects.iter().any(|other| same_effect(&one, other)))
}

/// Findings without a cause in the model.
pub(crate) fn undecided<'d>(open: &OpenSession, diagnosed: &'d Diagnosed) -> Vec<&'d Finding> {
    let is_undecided = |finding: &&Finding| {
        let mut causes = finding.causes();
        !causes.any(|cause| are_in_model(open, &diagnosed.settings(cause)))
    };
    let findings = diagnosed.diagnosis.findings.iter();
    findings.filter(is_undecided).collect()
}

/// Edit that adds the causes of findings to the model.
pub(crate) fn adding(diagnosed: &Diagnosed, findings: &[&Finding]) -> Edit {
    let causes = findings.iter().filter_map(|finding| finding.cause());
    let what = match findings {
        [one] => adding_named(&diagnosed.subject(&one.subject)),
        several => format!("add {} to the model", count(several.len(), "finding")),
    };
    Edit::AddEffects(
        causes.flat_map(|cause| diagnosed.settings(cause)).collect(),
        what,
    )
}

/// Name of the edit that adds a cause.
pub(crate) fn adding_named(name: &str) -> String {
    format!("add {name} to the model")
}

/// Edit that adds a pattern to the model.
pub(crate) fn extending(pattern: &PatternDocument) -> Edit {
    let sizes = pattern.parameters.iter();
    let effect = EffectSetting {
        effect: pattern.effect.clone(),
        targets: pattern.targets.clone(),
        parameters: sizes.map(|p| (p.name.clone(), p.value)).collect(),
    };
    Edit::AddPattern {
        hypothesis: pattern.hypothesis.clone(),
        effect: Box::new(effect),
        name: pattern.title(),
    }
}

/// Whether all these poses are planned.
pub(crate) fn are_planned(open: &OpenSession, poses: &[Pose]) -> bool {
    let plan = &open.session().plan;
    let position = |pose: &Pose| <[f64; 3]>::from(pose.position);
    poses.iter().all(|pose| {
        plan.iter().any(|planned| {
            planned.position_m == position(pose)
                && planned.orientation_wxyz == pose.orientation_wxyz()
        })
    })
}

/// Edit that adds poses to the plan, under new labels.
pub(crate) fn planning(open: &OpenSession, poses: &[Pose]) -> Edit {
    let session = open.session();
    let labels = session.measurements.labels.iter().copied();
    let planned = session.plan.iter().map(|pose| pose.label);
    let first = labels
        .chain(planned)
        .max()
        .map_or(1, |most| most.max(0) + 1);
    let added = (first..)
        .zip(poses)
        .map(|(label, pose)| PlannedPose::new(label, pose));
    let plan = session.plan.iter().copied().chain(added).collect();
    Edit::SetPlan(
        plan,
        format!("add {} to the plan", count(poses.len(), "pose")),
    )
}
