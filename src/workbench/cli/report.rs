//! `tautline report`.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use anyhow::Result;
use tautline_core::diagnosis::{DiagnosisOptions, diagnose};
use tautline_core::effect::{BoundEffect, EffectError};
use tautline_core::estimation::{Control, Method};
use tautline_session::{Import, Session, import};

use super::BadInput;
use super::diagnose::Shown;
use super::fitted::refuse_extrapolation;
use super::input::as_modelled;
use crate::app::clock;
use crate::app::fit::{Fit, FitOrder, fit};
use crate::documents::diagnosis::Diagnosed;
use crate::report::{ReportFormat, ReportInput, write_report};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Session, robot.json or dataset folder
    #[arg(value_name = "SESSION|DATASET")]
    subject: PathBuf,
    /// File to write; its name ends with .html or .pdf
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    if ReportFormat::of(&arguments.out).is_none() {
        return Err(BadInput::new(format!(
            "--out: found {}, expected a name that ends with .html or .pdf",
            arguments.out.display()
        )));
    }
    let session = session(&arguments.subject)?;
    let (fit, diagnosis) = if session.measurements.is_empty() {
        (None, None)
    } else {
        let fit = identify(&session)
            .map_err(|error| error.context(arguments.subject.display().to_string()))?;
        let diagnosis = examine(&session)
            .map_err(|error| error.context(arguments.subject.display().to_string()))?;
        (Some(fit), Some(diagnosis))
    };
    let input = ReportInput {
        session: &session,
        fit: fit.as_ref(),
        diagnosis: diagnosis.as_ref(),
        outdated: false,
        picture: None,
        now: clock::now(),
    };
    write_report(&arguments.out, &input)?;
    Ok(())
}

/// Reads the session, or begins one with a robot or a dataset.
fn session(path: &Path) -> Result<Session> {
    let read = import(path, None)?;
    for notice in &read.notices {
        eprintln!("{notice}");
    }
    match read.value {
        Import::Session(session) => Ok(*session),
        Import::Robot(robot) => Ok(Session::new(robot.name.clone(), *robot, clock::now())),
        Import::Dataset(folder) => {
            for notice in &folder.notices {
                eprintln!("{notice}");
            }
            let name = folder.dataset.robot.name.clone();
            Ok(Session::of_dataset(name, *folder, clock::now()))
        }
        _ => Err(BadInput::new(format!(
            "{}: found a table, expected a session, a robot or a dataset folder",
            path.display()
        ))),
    }
}

/// What the settings of the session ask for.
fn order(session: &Session) -> Result<FitOrder> {
    let settings = session.settings.identification.effects.iter();
    let effects: Result<Vec<_>, EffectError> = settings
        .map(|setting| BoundEffect::to_estimate(setting, &session.robot))
        .collect();
    Ok(FitOrder {
        dataset: Arc::new(as_modelled(session.dataset())?),
        method: match session.settings.identification.method {
            tautline_session::Method::Simple => Method::Simple,
            _ => Method::Joint,
        },
        effects: effects.map_err(BadInput::new)?,
    })
}

fn identify(session: &Session) -> Result<Fit> {
    let found = fit(order(session)?, &mut |_| Control::Continue).map_err(BadInput::new)?;
    refuse_extrapolation(&found.dataset, &found.solution)?;
    Ok(found)
}

fn examine(session: &Session) -> Result<Diagnosed> {
    let alpha = session.settings.diagnosis.alpha;
    let options = DiagnosisOptions {
        alpha,
        ..DiagnosisOptions::default()
    };
    let dataset = session.dataset();
    let started = Instant::now();
    let mut shown = Shown::start();
    let diagnosis = diagnose(&dataset, &options, &mut |progress| shown.tell(*progress))
        .map_err(BadInput::new)?;
    drop(shown);
    Ok(Diagnosed {
        dataset: Arc::new(dataset),
        diagnosis,
        alpha,
        seconds: started.elapsed().as_secs_f64(),
    })
}
