//! Diagnosis of the model, as a document and in words, for commands, reports and the window.

mod cause;
mod convert;
pub mod dependences;
mod diagnosed;
mod document;
pub mod evidence;
mod finding;
mod gross;
mod invisible;
mod mistakes;
mod proposal;
#[cfg(any(test, feature = "test-samples"))]
pub mod samples;
mod stage;
mod verdict;

use std::borrow::Cow;
use std::sync::Arc;
use std::time::Instant;

use tautline_core::diagnosis::{
    DiagnosisOptions, DiagnosisProgress, MOST_DIAGNOSED_ROWS, diagnose,
};
use tautline_core::estimation::{Control, EstimationError};
use tautline_core::measurement::Dataset;
use tautline_session::Session;

use crate::identification::Identification;
use mistakes::without_mistakes;

pub use cause::cause_title;
pub use diagnosed::Diagnosed;
pub use document::{DiagnosisDocument, FindingDocument, GainDocument, ParameterDocument};
pub use finding::{gain, is_improvement};
pub use invisible::{HIDDEN, Undetectable};
pub use proposal::{Proposal, proposal};
pub use stage::stage;
pub use verdict::{adequacy, residual_ratio};

/// Default time limit of a diagnosis (s), after which it ends with the best answer so far.
pub const TIME_LIMIT_S: f64 = 60.0;

/// Time that the end of an interrupted diagnosis takes, in multiples of its longest step so far: the model is tested without a cause.
const END_STEPS: f64 = 2.0;

/// Diagnoses the model of a dataset with its raw measurements, after undoing mistakes that the check finds, averaging the rows of
/// each standstill and thinning recordings in motion, at a false-alarm probability and within a time limit (s).
///
/// # Errors
/// If the data cannot be used for an identification.
pub fn diagnose_dataset(
    dataset: Arc<Dataset>,
    (alpha, limit_s): (f64, f64),
    observe: &mut dyn FnMut(&DiagnosisProgress) -> Control,
) -> Result<Diagnosed, EstimationError> {
    let options = DiagnosisOptions {
        alpha,
        ..DiagnosisOptions::default()
    };
    let measured = dataset.measurements.len();
    // Plots of the result use the same rows.
    let dataset = match dataset
        .measurements
        .independent(&dataset.robot, MOST_DIAGNOSED_ROWS)
    {
        (Cow::Owned(measurements), _) => Arc::new(Dataset {
            robot: dataset.robot.clone(),
            measurements,
        }),
        (Cow::Borrowed(_), _) => Arc::clone(&dataset),
    };
    let started = Instant::now();
    let (dataset, mistakes) = match without_mistakes(&dataset) {
        Some((corrected, mistakes)) => (Arc::new(corrected), mistakes),
        None => (dataset, Vec::new()),
    };
    let (mut before_s, mut longest_s, mut ended_at_limit) = (0.0, 0.0_f64, false);
    let diagnosis = diagnose(&dataset, &options, &mut |progress| {
        let now_s = started.elapsed().as_secs_f64();
        longest_s = longest_s.max(now_s - before_s);
        before_s = now_s;
        ended_at_limit = now_s + END_STEPS * longest_s >= limit_s;
        match ended_at_limit {
            true => Control::Cancel,
            false => observe(progress),
        }
    })?;
    Ok(Diagnosed {
        diagnosis,
        mistakes,
        alpha,
        seconds: started.elapsed().as_secs_f64(),
        limit_s,
        ended_at_limit,
        measured,
        dataset,
    })
}

/// The dataset of a session, with the effects of its model at the identified values, from which a diagnosis starts. It
/// estimates them again with every cause: what was identified without a cause is biased by it.
#[must_use]
pub fn dataset_to_diagnose(session: &Session, identified: &Identification) -> Dataset {
    let mut dataset = session.dataset();
    dataset.robot.effects.clone_from(&identified.model.effects);
    dataset
}
