//! `tautline diagnose`.

mod progress;
mod report;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::Result;
use tautline_core::diagnosis::{DiagnosisOptions, diagnose};
use tautline_session::write_robot;

use super::BadInput;
use super::fitted::refuse_extrapolation;
use super::input;
use super::output::{is_readable, line, write_json};
pub use progress::Shown;
use tautline_workflow::documents::diagnosis::Diagnosed;
use tautline_workflow::documents::identification::identified;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Dataset folder
    #[arg(value_name = "DATASET")]
    dataset: PathBuf,
    /// Probability of a finding in data that the model explains
    #[arg(long, value_name = "PROBABILITY", default_value_t = DiagnosisOptions::default().alpha)]
    alpha: f64,
    /// Write the machine form; - is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the robot with the geometry and the effects of the extended model
    #[arg(long, value_name = "FILE")]
    model_out: Option<PathBuf>,
    /// Print the numbers behind the verdicts, too
    #[arg(long)]
    explain: bool,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let alpha = arguments.alpha;
    if !(alpha > 0.0 && alpha < 0.5) {
        let message = format!("--alpha: found {alpha}, expected a number above 0 and below 0.5");
        return Err(BadInput::new(message));
    }
    let dataset = input::dataset(&arguments.dataset)?;
    let options = DiagnosisOptions {
        alpha,
        ..DiagnosisOptions::default()
    };
    let started = Instant::now();
    let mut shown = Shown::start();
    let diagnosis = diagnose(&dataset, &options, &mut |progress| shown.tell(*progress))
        .map_err(|error| BadInput::new(format!("{}: {error}", arguments.dataset.display())))?;
    drop(shown);
    let seconds = started.elapsed().as_secs_f64();
    // A model that misses the readings may well lead out of the range: what counts is the last one.
    refuse_extrapolation(&dataset, &diagnosis.extended_solution)?;
    let diagnosed = Diagnosed {
        dataset: Arc::new(dataset),
        diagnosis,
        alpha,
        seconds,
    };
    deliver(arguments, &diagnosed)
}

/// Writes and prints what was asked for.
fn deliver(arguments: &Arguments, diagnosed: &Diagnosed) -> Result<()> {
    if let Some(path) = &arguments.model_out {
        let solution = &diagnosed.diagnosis.extended_solution;
        write_robot(path, &identified(diagnosed.robot(), solution))?;
    }
    if let Some(path) = &arguments.json {
        write_json(path, &tautline_session::document(&diagnosed.document()))?;
    }
    if is_readable(arguments.json.as_deref()) {
        line(&report::text(diagnosed, arguments.explain));
    }
    Ok(())
}
