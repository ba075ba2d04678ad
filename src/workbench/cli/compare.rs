//! `tautline compare`.

mod document;
mod report;

use std::path::{Path, PathBuf};

use anyhow::Result;
use tautline_core::comparison::{Identified, compare};
use tautline_core::estimation::{Control, Method, Options, Problem, Solution, solve};
use tautline_core::measurement::Dataset;
use tautline_session::read_session;

use super::output::{is_readable, write_json};
use super::{BadInput, input};
use crate::cli::fitted::refuse_extrapolation;
pub use document::ComparisonDocument;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Session file or dataset folder of the first run
    #[arg(value_name = "SESSION_A")]
    first: PathBuf,
    /// Session file or dataset folder of the second run
    #[arg(value_name = "SESSION_B")]
    second: PathBuf,
    /// Probability with which two runs of the same robot are called different
    #[arg(long, value_name = "P", default_value_t = 0.05)]
    level: f64,
    /// Write the machine form; - is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let level = arguments.level;
    if !(level > 0.0 && level < 1.0) {
        return Err(BadInput::new(format!(
            "--level: found {level}, expected a probability between 0 and 1"
        )));
    }
    let (first, second) = (read(&arguments.first)?, read(&arguments.second)?);
    let (problem_a, solution_a) = identify(&arguments.first, &first)?;
    let (problem_b, solution_b) = identify(&arguments.second, &second)?;
    let runs = [
        Identified {
            problem: &problem_a,
            solution: &solution_a,
        },
        Identified {
            problem: &problem_b,
            solution: &solution_b,
        },
    ];
    let compared = compare(&runs[0], &runs[1], level).map_err(BadInput::new)?;
    let document = ComparisonDocument::of(&compared);
    if let Some(path) = &arguments.json {
        write_json(path, &tautline_session::document(&document))?;
    }
    if is_readable(arguments.json.as_deref()) {
        report::print(&document);
    }
    Ok(())
}

/// A run and how it is to be identified.
struct Run {
    dataset: Dataset,
    method: Method,
}

fn read(path: &Path) -> Result<Run> {
    if path.is_dir() {
        return Ok(Run {
            dataset: input::as_modelled(input::dataset(path)?)?,
            method: Method::Joint,
        });
    }
    let read = read_session(path)?;
    for notice in &read.notices {
        eprintln!("{notice}");
    }
    let settings = &read.value.settings.identification;
    let method = match settings.method {
        tautline_session::Method::Joint => Method::Joint,
        tautline_session::Method::Simple => Method::Simple,
        tautline_session::Method::Published => {
            return Err(BadInput::new(format!(
                "{}: found the published method, which has no standard deviations to compare with, expected joint or \
                 simple",
                path.display()
            )));
        }
    };
    if !settings.effects.is_empty() {
        eprintln!(
            "{}: the effects of its settings are not estimated here",
            path.display()
        );
    }
    Ok(Run {
        dataset: input::as_modelled(read.value.dataset())?,
        method,
    })
}

fn identify<'a>(path: &Path, run: &'a Run) -> Result<(Problem<'a>, Solution)> {
    let at_file =
        |error: &dyn std::fmt::Display| BadInput::new(format!("{}: {error}", path.display()));
    let problem = Problem::new(&run.dataset)
        .map_err(|e| at_file(&e))?
        .with_method(run.method);
    let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue)
        .map_err(|e| at_file(&e))?;
    if !solution.converged() {
        return Err(at_file(&"the identification did not converge"));
    }
    refuse_extrapolation(&run.dataset, &solution)?;
    Ok((problem, solution))
}
