//! Tests of the doctor: its score tests, its algebra, what it names and what it makes of odd inputs. Seeds are fixed; where
//! noise decides, the probability of a false failure, had they not been, is said.

mod algebra;
mod cancelling;
mod held_out;
mod names;
mod noise;
mod odd_inputs;
mod separation;
mod sets;
mod structure;
mod unread_tensions;

use super::adequacy_tests::{run_of, run_with, setting};
use super::fit::Fit;
use super::{Diagnosis, DiagnosisOptions, Finding, diagnose};
use crate::estimation::{Control, Problem};
use crate::measurement::Dataset;

/// The problem of a dataset with what effects depend on taken at the fitted poses, as the doctor poses it.
fn based(dataset: &Dataset) -> Problem<'_> {
    let problem = Problem::new(dataset).unwrap();
    let first = Fit::new(&problem, &[]).unwrap();
    problem.at_poses_of(&first.solution)
}

fn diagnosed(dataset: &Dataset) -> Diagnosis {
    let options = DiagnosisOptions::default();
    diagnose(dataset, &options, &mut |_| Control::Continue).unwrap()
}

/// Effect and cables of a finding, its alternatives after it.
fn names(finding: &Finding) -> Vec<(&'static str, Vec<usize>)> {
    let others = finding.alternatives.iter().map(|other| &other.cause);
    let causes = std::iter::once(&finding.cause).chain(others);
    causes
        .map(|cause| (cause.effect().id(), cause.cables()))
        .collect()
}

/// Effect and cables of every finding.
fn found(diagnosis: &Diagnosis) -> Vec<(&'static str, Vec<usize>)> {
    let findings = diagnosis.findings.iter();
    findings.map(|finding| names(finding).remove(0)).collect()
}
