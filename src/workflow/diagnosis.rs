//! Diagnosing the model: the one way for commands, reports and the window.

use std::sync::Arc;
use std::time::Instant;

use tautline_core::diagnosis::{DiagnosisOptions, DiagnosisProgress, diagnose};
use tautline_core::estimation::{Control, EstimationError};
use tautline_core::measurement::Dataset;
use tautline_session::Session;

use crate::documents::diagnosis::Diagnosed;
use crate::identification::Identification;

/// Diagnoses the model of a dataset, with its raw measurements, at a probability of a false alarm.
///
/// # Errors
/// If the data do not make a problem.
pub fn diagnose_dataset(
    dataset: Arc<Dataset>,
    alpha: f64,
    observe: &mut dyn FnMut(&DiagnosisProgress) -> Control,
) -> Result<Diagnosed, EstimationError> {
    let options = DiagnosisOptions {
        alpha,
        ..DiagnosisOptions::default()
    };
    let started = Instant::now();
    let diagnosis = diagnose(&dataset, &options, observe)?;
    Ok(Diagnosed {
        diagnosis,
        alpha,
        seconds: started.elapsed().as_secs_f64(),
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
