//! `tautline identify`.

use std::path::PathBuf;

use anyhow::Result;
use tautline_core::effect::EffectRequest;
use tautline_core::estimation::{Loss, Method, Problem};
use tautline_core::measurement::Dataset;
use tautline_session::write_robot;

use super::BadInput;

use super::fitted::{self, Fitted};
use super::input;
use super::output::{is_readable, write_json};
use tautline_workflow::documents::identification::Identification;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Dataset folder
    #[arg(value_name = "DATASET")]
    dataset: PathBuf,
    /// joint: tensions as unknowns, static equilibrium holds; simple: tensions as exact; published: Jin
    /// et al. 2018
    #[arg(long, value_enum, default_value_t = MethodName::Joint)]
    method: MethodName,
    /// Effects to estimate, each on one cable or on all; what cannot be estimated is given, as the pose of a
    /// slip: cable_slip:cable-3:pose=12
    #[arg(long, value_name = "ID[:CABLE][:K=V],..", value_delimiter = ',')]
    effects: Vec<String>,
    /// Huber's loss beyond this many standard deviations
    #[arg(long, value_name = "LIMIT", num_args = 0..=1, default_missing_value = "1.5")]
    robust: Option<f64>,
    /// Solve N times and report the least time
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub repeat: usize,
    /// Write the machine form; - is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the identified robot
    #[arg(long, value_name = "FILE")]
    model_out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum MethodName {
    Joint,
    Simple,
    Published,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let dataset = input::as_modelled(input::dataset(&arguments.dataset)?)?;
    if arguments.method == MethodName::Published {
        return super::published::run(arguments, &dataset);
    }
    let problem = problem_of(arguments, &dataset)?;
    let fitted = Fitted::solve(&problem, arguments.repeat)?;
    deliver(arguments, &fitted, &fitted.identification())
}

/// Writes and prints what was asked for.
pub fn deliver(
    arguments: &Arguments,
    fitted: &Fitted<'_>,
    identification: &Identification,
) -> Result<()> {
    if let Some(path) = &arguments.model_out {
        write_robot(path, &fitted.model())?;
    }
    if let Some(path) = &arguments.json {
        write_json(path, &tautline_session::document(identification))?;
    }
    if is_readable(arguments.json.as_deref()) {
        fitted::print_report(fitted, identification);
    }
    Ok(())
}

fn problem_of<'a>(arguments: &Arguments, dataset: &'a Dataset) -> Result<Problem<'a>> {
    let method = match arguments.method {
        MethodName::Simple => Method::Simple,
        MethodName::Joint | MethodName::Published => Method::Joint,
    };
    let mut problem = Problem::new(dataset)
        .map_err(BadInput::new)?
        .with_method(method);
    let requests: Vec<_> = arguments
        .effects
        .iter()
        .map(|e| EffectRequest::parse(e))
        .collect();
    problem
        .free(&requests)
        .map_err(|error| BadInput::new(format!("--effects: {error}")))?;
    for effect in &problem.free_effects {
        effect
            .check_poses(&dataset.measurements)
            .map_err(|error| BadInput::new(format!("--effects: {error}")))?;
    }
    if let Some(limit) = arguments.robust {
        if !(limit.is_finite() && limit > 0.0) {
            return Err(BadInput::new(format!(
                "--robust: found {limit}, expected a positive number"
            )));
        }
        problem.loss = Loss::Huber(limit);
    }
    Ok(problem)
}
