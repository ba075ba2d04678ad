//! A diagnosis that is cancelled stops, and what it says fits together.

use std::time::{Duration, Instant};

use super::super::{Diagnosis, DiagnosisOptions, diagnose};
use super::{run_with, setting};
use crate::estimation::Control;
use crate::measurement::Dataset;

fn dataset() -> Dataset {
    let scale = setting("winch_scale", &["cable-3"], &[("scale", 0.02)]);
    let bias = setting("force_bias", &["cable-6"], &[("bias", 12.0)]);
    run_with("mini", 40, 91, &[scale, bias]).dataset
}

/// Cancels at the call with this number; the diagnosis, the number of calls and the time from there to the end.
fn cancelled_at(dataset: &Dataset, call: usize) -> (Diagnosis, usize, Duration) {
    let (mut calls, mut since) = (0, Instant::now());
    let options = DiagnosisOptions::default();
    let diagnosis = diagnose(dataset, &options, &mut |_| {
        calls += 1;
        if calls > call {
            since = Instant::now();
            return Control::Cancel;
        }
        Control::Continue
    });
    (diagnosis.unwrap(), calls, since.elapsed())
}

fn calls_and_time(dataset: &Dataset) -> (usize, Duration) {
    let start = Instant::now();
    let (diagnosis, calls, _) = cancelled_at(dataset, usize::MAX);
    assert!(!diagnosis.cancelled);
    (calls, start.elapsed())
}

#[test]
fn the_observer_is_not_asked_again() {
    let dataset = dataset();
    let (calls, _) = calls_and_time(&dataset);
    for call in 0..calls {
        let (diagnosis, asked, _) = cancelled_at(&dataset, call);
        assert!(diagnosis.cancelled);
        assert_eq!(asked, call + 1);
    }
}

/// What is reported and the model that is returned name the same causes.
#[test]
fn findings_are_those_of_the_model() {
    let dataset = dataset();
    let (calls, _) = calls_and_time(&dataset);
    for call in 0..calls {
        let (diagnosis, ..) = cancelled_at(&dataset, call);
        let found = diagnosis.findings.iter().flat_map(|f| &f.cause.instances);
        let found: Vec<_> = found.map(|b| (b.effect.id(), b.cables.clone())).collect();
        let effects = diagnosis.extended_solution.globals.effects.iter();
        let model: Vec<_> = effects.map(|b| (b.effect.id(), b.cables.clone())).collect();
        assert_eq!(found, model, "cancelled at call {call} of {calls}");
    }
}

/// After the answer nothing is begun anew: less than half of the time of a whole diagnosis passes (a third of it does, so
/// that a busy machine does not matter; the least of two).
#[test]
fn cancelling_is_quick() {
    let dataset = dataset();
    let (calls, whole) = calls_and_time(&dataset);
    for call in 0..calls {
        let [one, other] = [0, 1].map(|_| cancelled_at(&dataset, call).2);
        let least = one.min(other);
        assert!(
            least < whole / 2,
            "{least:?} of {whole:?} at call {call} of {calls}"
        );
    }
}
