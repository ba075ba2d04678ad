//! A cancelled diagnosis stops at once, and its result is consistent.

use super::super::{Diagnosis, DiagnosisOptions, PossibleCause, diagnose};
use super::{run_with, setting};
use crate::estimation::Control;
use crate::measurement::Dataset;

fn dataset() -> Dataset {
    let scale = setting("winch_scale", &["cable-3"], &[("scale", 0.02)]);
    let bias = setting("force_bias", &["cable-6"], &[("bias", 12.0)]);
    run_with("mini", 40, 91, &[scale, bias]).dataset
}

/// Cancels at the call with this number. Returns the diagnosis and the number of calls.
fn cancelled_at(dataset: &Dataset, call: usize) -> (Diagnosis, usize) {
    let mut calls = 0;
    let options = DiagnosisOptions::default();
    let diagnosis = diagnose(dataset, &options, &mut |_| {
        calls += 1;
        if calls > call {
            Control::Cancel
        } else {
            Control::Continue
        }
    });
    (diagnosis.unwrap(), calls)
}

/// Number of interruptions that are tried, from the first call to the last.
const INTERRUPTIONS: usize = 8;

/// It names nothing, but towards the end it lists the causes that are there.
#[test]
fn a_cancelled_diagnosis_stops_at_once_and_names_nothing() {
    let dataset = dataset();
    let (whole, calls) = cancelled_at(&dataset, usize::MAX);
    assert!(!whole.cancelled);
    for k in 0..INTERRUPTIONS {
        let call = k * (calls - 1) / (INTERRUPTIONS - 1);
        let (diagnosis, asked) = cancelled_at(&dataset, call);
        assert!(diagnosis.cancelled);
        assert_eq!(asked, call + 1);
        assert!(
            diagnosis.findings.is_empty(),
            "cancelled at call {call} of {calls}"
        );
        assert!(diagnosis.extended_solution.globals.effects.is_empty());
    }
    let (last, _) = cancelled_at(&dataset, calls - 1);
    for (id, cable) in [("winch_scale", 2), ("force_bias", 5)] {
        let is_hidden = |other: &PossibleCause| {
            other.cause.effect().id() == id && other.cause.cables() == [cable]
        };
        let listed = last.possible.iter().find(|other| is_hidden(other));
        assert!(
            listed.is_some_and(|cause| cause.probability > 0.9),
            "{:?}",
            last.possible
        );
    }
}
