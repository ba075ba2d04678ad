//! `tautline identify`.

mod report;

use std::path::PathBuf;

use crate::BadInput;
use anyhow::Result;
use tautline_core::estimation::published::PublishedStop;
use tautline_core::estimation::{Control, Loss};
use tautline_core::measurement::Truth;
use tautline_session::Method;
use tautline_workflow::identification::{
    Identification, IdentificationDocument, IdentificationRequest, PublishedIdentification,
    identify, identify_published, readings_table, solved_method, values_table,
};
use tautline_workflow::wording::sampling_sentence;

use crate::effect_arguments::EstimatedEffects;
use crate::examples::examples;
use crate::failure::Reservation;
use crate::hypothesis_arguments::HypothesisFiles;
use crate::input::{self, Measured};
use crate::method::MethodName;
use crate::output::{JsonOutput, say, write_file, write_model};
use crate::replace::OutputFile;
use crate::tolerances::TolerancesName;
pub use report::print;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("The pulleys of a dataset", "tautline identify mini"),
    ("With the scale of every winch, as a model file, too", "tautline identify mini --effect winch_scale --model-out model.json"),
    ("For another program", "tautline identify mini --json -"),
    ("Every reading with its residual and its redundancy", "tautline identify mini --statistics readings.csv"),
]))]
pub struct Arguments {
    /// Session file or dataset folder; - is a session on standard input
    #[arg(value_name = "SESSION|DATASET")]
    dataset: PathBuf,
    /// joint: tensions are unknowns constrained by static equilibrium; simple: measured tensions are taken as exact;
    /// published: the method of Jin et al. 2018; by default that of the session, or joint
    #[arg(long, value_enum)]
    method: Option<MethodName>,
    #[command(flatten)]
    effects: EstimatedEffects,
    #[command(flatten)]
    hypotheses: HypothesisFiles,
    /// Use a Huber loss, which downweights residuals beyond this many standard deviations; 1.5 without a number
    #[arg(long, value_name = "SD", num_args = 0..=1, default_missing_value = "1.5")]
    robust: Option<f64>,
    /// Tolerances of the parts: those that robot.json states, those of the catalogue, or none
    #[arg(long, value_enum, default_value_t = TolerancesName::Stated)]
    tolerances: TolerancesName,
    /// Solve N times and report the shortest time
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub repeat: usize,
    #[command(flatten)]
    json: JsonOutput<IdentificationDocument>,
    /// Write every reading with its residual, redundancy, smallest detectable error and the influence of that error (CSV); - is standard output
    #[arg(long, value_name = "FILE")]
    statistics: Option<OutputFile>,
    /// Write every identified value with its standard deviation, prior and 95 % interval (CSV); - is standard output
    #[arg(long, value_name = "FILE")]
    values: Option<OutputFile>,
    /// Write the identified robot as a model file; - is standard output
    #[arg(long, value_name = "FILE")]
    model_out: Option<OutputFile>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let mut measured = input::identifiable(&arguments.dataset)?;
    let method = &mut measured.identification.method;
    *method = arguments.method.map_or(*method, Method::from);
    let method = *method;
    let request = request(arguments, measured)?;
    let (model, document, is_usable) = match method {
        Method::Published => {
            refuse_with_published(arguments)?;
            let published = fastest(
                arguments.repeat,
                |p: &PublishedIdentification| p.seconds,
                || identify_published(&request.dataset).map_err(BadInput::new),
            )?;
            // The published method ends after a given number of steps, converged or not.
            let is_usable = published.result.stop != PublishedStop::Diverged;
            (
                published.poses.model.clone(),
                published.document(),
                is_usable,
            )
        }
        Method::Joint | Method::Simple => {
            let identified = fastest(
                arguments.repeat,
                |i: &Identification| i.seconds,
                || identify(&request, &mut |_| Control::Continue).map_err(BadInput::new),
            )?;
            let identified = identified.refuse_extrapolation().map_err(BadInput::new)?;
            if let Some(path) = &arguments.statistics {
                write_file(path, readings_table(&identified).csv().as_bytes())?;
            }
            if let Some(path) = &arguments.values {
                write_file(path, values_table(&identified).csv().as_bytes())?;
            }
            let converged = identified.solution.converged();
            let document = IdentificationDocument {
                budget: identified.budget(),
                ..identified.document()
            };
            (identified.model.clone(), document, converged)
        }
    };
    if let Some(path) = &arguments.model_out {
        write_model(path, &model)?;
    }
    arguments.json.deliver(&document, || {
        if let Some(sentence) = sampling_sentence(&request.dataset.measurements) {
            say!("{sentence}");
        }
        print(&document, &request.dataset.robot);
        if method != Method::Published {
            say!("{}", request.tolerances_sentence());
        }
    })?;
    Reservation::NotConverged.unless(is_usable)
}

/// The published method has neither effects nor weights nor standard deviations.
fn refuse_with_published(arguments: &Arguments) -> Result<()> {
    let tables = arguments.statistics.is_some() || arguments.values.is_some();
    let (given, lacks) = match () {
        () if tables => ("--statistics, --values", "standard deviations"),
        () if !arguments.effects.is_empty() => ("--effect", "effects"),
        () if arguments.robust.is_some() => ("--robust", "weights"),
        () => return Ok(()),
    };
    Err(BadInput::new(format!(
        "{given}: found with --method published, which has no {lacks}; expected --method joint or simple"
    )))
}

/// Runs `work` `repeat` times, at least once, and returns the result with the smallest `seconds`.
fn fastest<T>(
    repeat: usize,
    seconds: impl Fn(&T) -> f64,
    mut work: impl FnMut() -> Result<T>,
) -> Result<T> {
    let mut best = work()?;
    for _ in 1..repeat {
        let again = work()?;
        if seconds(&again) < seconds(&best) {
            best = again;
        }
    }
    Ok(best)
}

fn request(arguments: &Arguments, measured: Measured) -> Result<IdentificationRequest> {
    let (mut dataset, settings) = (measured.dataset, measured.identification);
    // Identification never uses the true values of simulated data, which take a third of the memory.
    dataset.measurements.truth = Truth::default();
    arguments.hypotheses.add_to(&mut dataset.robot)?;
    let effects = arguments.effects.settings(&dataset, &settings)?;
    let request = IdentificationRequest::new(dataset, solved_method(settings.method), &effects);
    let mut request = request.map_err(BadInput::new)?;
    request.lists_readings = arguments.statistics.is_some();
    request.options.tolerances = arguments.tolerances.into();
    if let Some(limit) = arguments.robust {
        if !(limit.is_finite() && limit > 0.0) {
            return Err(BadInput::new(format!(
                "--robust: found {limit}, expected a positive number"
            )));
        }
        request.options.loss = Loss::Huber(limit);
    }
    Ok(request)
}
