//! Tests of the diagnosis: its algebra, its search, the names it finds and its behaviour with unusual input. Seeds are
//! fixed. Where noise decides, the test states the probability of a false failure with random seeds.

mod algebra;
mod cancelling;
mod clean;
mod field;
mod held_out;
mod hypotheses;
mod model_effects;
mod names;
mod noise;
mod odd_inputs;
mod separation;
mod sets;
mod tolerances;
mod unmodelled_errors;
mod unread_tensions;

use super::adequacy_tests::{run_of, run_with, setting};
use super::fit::Fit;
use super::{Diagnosis, DiagnosisOptions, Finding, Subject, diagnose};
use crate::estimation::{Control, Problem};
use crate::measurement::Dataset;

/// The problem whose effects are evaluated at the fitted poses, as in the diagnosis.
fn problem_at_fitted_poses(dataset: &Dataset) -> Problem<'_> {
    let problem = Problem::new(dataset).unwrap();
    let first = Fit::new(&problem, &[]).unwrap();
    problem.at_poses_of(&first.solution)
}

fn diagnosed(dataset: &Dataset) -> Diagnosis {
    let options = DiagnosisOptions::default();
    diagnose(dataset, &options, &mut |_| Control::Continue).unwrap()
}

/// Effect, or "unknown", and cables of a finding and then of its alternatives.
fn names(finding: &Finding) -> Vec<(&'static str, Vec<usize>)> {
    let others = finding.alternatives.iter().map(|other| &other.subject);
    let subjects = std::iter::once(&finding.subject).chain(others);
    let name = |subject: &Subject| {
        subject
            .cause()
            .map_or("unknown", |cause| cause.effect().id())
    };
    subjects
        .map(|subject| (name(subject), subject.cables()))
        .collect()
}

/// Effect and cables of each finding.
fn found(diagnosis: &Diagnosis) -> Vec<(&'static str, Vec<usize>)> {
    let findings = diagnosis.findings.iter();
    findings.map(|finding| names(finding).remove(0)).collect()
}
