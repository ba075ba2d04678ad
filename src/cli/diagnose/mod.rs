//! `tautline diagnose`.

mod progress;
mod report;

use std::path::PathBuf;
use std::sync::Arc;

use crate::BadInput;
use anyhow::Result;
use tautline_core::estimation::{Control, EstimationError};
use tautline_core::measurement::Dataset;
use tautline_session::Session;
use tautline_workflow::diagnosis::{Diagnosed, DiagnosisDocument};
use tautline_workflow::diagnosis::{TIME_LIMIT_S, dataset_to_diagnose, diagnose_dataset};
use tautline_workflow::identification::{
    IdentificationError, extrapolation, identified, identify_session,
};

use crate::examples::examples;
use crate::hypothesis_arguments::HypothesisFiles;
use crate::input;
use crate::output::{JsonOutput, line, write_model};
use crate::replace::OutputFile;
use progress::ProgressLine;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("Whether the model explains the readings, and what it lacks", "tautline diagnose bad"),
    ("Whether a suspicion of your own explains them better", "tautline diagnose bad --hypothesis oval_drum.toml"),
    ("With the statistics, and the model with what was found", "tautline diagnose bad --explain --model-out found.json"),
]))]
pub struct Arguments {
    /// Session file or dataset folder; - is a session on standard input
    #[arg(value_name = "SESSION|DATASET")]
    subject: PathBuf,
    /// Probability of a false finding if the model is right; by default that of the session
    #[arg(long, value_name = "PROBABILITY")]
    alpha: Option<f64>,
    /// Time after which it ends with the best answer so far (s)
    #[arg(long, value_name = "SECONDS", default_value_t = TIME_LIMIT_S)]
    time_limit: f64,
    #[command(flatten)]
    hypotheses: HypothesisFiles,
    #[command(flatten)]
    json: JsonOutput<DiagnosisDocument>,
    /// Write the identified robot, with the effects found, as a model file; - is standard output
    #[arg(long, value_name = "FILE")]
    model_out: Option<OutputFile>,
    /// Also print the statistics behind the verdicts
    #[arg(long)]
    explain: bool,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    if let Some(alpha) = arguments.alpha
        && !(alpha > 0.0 && alpha < 0.5)
    {
        let message = format!("--alpha: found {alpha}, expected a number above 0 and below 0.5");
        return Err(BadInput::new(message));
    }
    let limit_s = arguments.time_limit;
    if limit_s.is_nan() || limit_s <= 0.0 {
        let message =
            format!("--time-limit: found {limit_s}, expected a number of seconds above 0");
        return Err(BadInput::new(message));
    }
    let mut session = input::session(&arguments.subject)?;
    arguments.hypotheses.add_to(&mut session.robot)?;
    let place = arguments.subject.display();
    let alpha = arguments.alpha.unwrap_or(session.settings.diagnosis.alpha);
    let diagnosed = model_to_diagnose(&session)
        .and_then(|dataset| Ok(diagnose_with_progress(Arc::new(dataset), (alpha, limit_s))?))
        .map_err(|error| BadInput::new(format!("{place}: {error}")))?;
    // A model that does not fit the readings may need extrapolation; only the extended model counts.
    match extrapolation(&diagnosed.dataset, &diagnosed.diagnosis.extended_solution) {
        Some(place) => Err(BadInput::new(place)),
        None => deliver(arguments, &diagnosed),
    }
}

/// Robot and measurements of a session; effects that were added to its model are identified first.
pub fn model_to_diagnose(session: &Session) -> Result<Dataset, IdentificationError> {
    if session.measurements.is_empty() {
        return Err(IdentificationError::NoPoses);
    }
    if session.settings.identification.effects.is_empty() {
        return Ok(session.dataset());
    }
    let identified = identify_session(session, &mut |_| Control::Continue)?;
    Ok(dataset_to_diagnose(session, &identified))
}

/// Diagnoses at a probability of a false alarm and within a time (s), with a progress line on the terminal.
pub fn diagnose_with_progress(
    dataset: Arc<Dataset>,
    (alpha, limit_s): (f64, f64),
) -> Result<Diagnosed, EstimationError> {
    let mut line = ProgressLine::start();
    diagnose_dataset(dataset, (alpha, limit_s), &mut |progress| {
        line.update(*progress)
    })
}

/// Writes the requested files and prints the text.
fn deliver(arguments: &Arguments, diagnosed: &Diagnosed) -> Result<()> {
    if let Some(path) = &arguments.model_out {
        let solution = &diagnosed.diagnosis.extended_solution;
        write_model(path, &identified(diagnosed.robot(), solution))?;
    }
    arguments.json.deliver(&diagnosed.document(), || {
        line(&report::text(diagnosed, arguments.explain));
    })
}
