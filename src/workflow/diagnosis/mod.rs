//! Diagnosing the model: the one way for commands, reports and the window.

pub mod dependences;

use std::borrow::Cow;
use std::sync::Arc;
use std::time::Instant;

use tautline_core::diagnosis::{DiagnosisOptions, DiagnosisProgress, MOST_SAMPLES, diagnose};
use tautline_core::estimation::{Control, EstimationError};
use tautline_core::measurement::Dataset;
use tautline_session::Session;

use crate::documents::diagnosis::Diagnosed;
use crate::identification::Identification;

/// Time (s) after which a diagnosis ends with the best answer so far, unless another limit is given.
pub const TIME_LIMIT_S: f64 = 60.0;

/// Diagnoses the model of a dataset, with its raw measurements, rows of one standstill averaged
/// and recordings in motion thinned, at a probability of a false alarm and within a time (s).
///
/// # Errors
/// If the data do not make a problem.
pub fn diagnose_dataset(
    dataset: Arc<Dataset>,
    (alpha, limit_s): (f64, f64),
    observe: &mut dyn FnMut(&DiagnosisProgress) -> Control,
) -> Result<Diagnosed, EstimationError> {
    let options = DiagnosisOptions {
        alpha,
        ..DiagnosisOptions::default()
    };
    // Plots of the result are of the same rows.
    let dataset = match dataset
        .measurements
        .independent(&dataset.robot, MOST_SAMPLES)
    {
        (Cow::Owned(measurements), _) => Arc::new(Dataset {
            robot: dataset.robot.clone(),
            measurements,
        }),
        (Cow::Borrowed(_), _) => Arc::clone(&dataset),
    };
    let started = Instant::now();
    let diagnosis = diagnose(&dataset, &options, &mut |progress| {
        let in_time = started.elapsed().as_secs_f64() < limit_s;
        if in_time {
            observe(progress)
        } else {
            Control::Cancel
        }
    })?;
    Ok(Diagnosed {
        diagnosis,
        alpha,
        seconds: started.elapsed().as_secs_f64(),
        limit_s,
        dataset,
    })
}

/// The dataset of a session with the effects of its model at the values that were identified.
///
/// A diagnosis holds them there: what they explain is gone from the residuals, so the gain of any further cause is
/// understated rather than overstated and there are no more false alarms than asked for; the standard deviations of new
/// causes are a little too small until they are added and all is identified together.
#[must_use]
pub fn dataset_to_diagnose(session: &Session, identified: &Identification) -> Dataset {
    let mut dataset = session.dataset();
    dataset.robot.effects.clone_from(&identified.model.effects);
    dataset
}
