//! `tautline report`.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::Result;
use tautline_core::diagnosis::{DiagnosisOptions, diagnose};
use tautline_core::estimation::Control;
use tautline_session::Session;

use super::diagnose::Shown;
use super::{BadInput, Window, input};
use tautline_workflow::clock;
use tautline_workflow::comparison::identify;
use tautline_workflow::documents::diagnosis::Diagnosed;
use tautline_workflow::identification::Fit;
use tautline_workflow::report::{Part, ReportChoice, ReportFormat, ReportInput, write_report};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Session, robot.json or dataset folder
    #[arg(value_name = "SESSION|DATASET")]
    subject: PathBuf,
    /// File to write; its name ends with .html or .pdf
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Parts that are wanted, separated by commas; all by default
    #[arg(
        long,
        value_name = "PART",
        value_delimiter = ',',
        conflicts_with = "without"
    )]
    sections: Vec<Part>,
    /// Parts that are left out, separated by commas
    #[arg(long, value_name = "PART", value_delimiter = ',')]
    without: Vec<Part>,
    /// Title instead of the name of the session
    #[arg(long, default_value = "")]
    title: String,
    /// A line above the title
    #[arg(long, default_value = "")]
    header: String,
    /// Who made the measurements
    #[arg(long, default_value = "")]
    operator: String,
    /// For whom they were made
    #[arg(long, default_value = "")]
    company: String,
}

impl Arguments {
    fn choice(&self) -> ReportChoice {
        let is_out = |part: &Part| match self.sections.is_empty() {
            true => self.without.contains(part),
            false => !self.sections.contains(part),
        };
        ReportChoice {
            without: Part::all().iter().copied().filter(is_out).collect(),
            title: self.title.clone(),
            header: self.header.clone(),
            operator: self.operator.clone(),
            company: self.company.clone(),
        }
    }
}

pub fn run(arguments: &Arguments, window: &Window) -> Result<()> {
    if ReportFormat::of(&arguments.out).is_none() {
        return Err(BadInput::new(format!(
            "--out: found {}, expected a name that ends with .html or .pdf",
            arguments.out.display()
        )));
    }
    let session = input::session(&arguments.subject)?;
    let (fit, diagnosis) = if session.measurements.is_empty() {
        (None, None)
    } else {
        let fit = identify(&session, &mut |_| Control::Continue)
            .map_err(|error| BadInput::new(format!("{}: {error}", arguments.subject.display())))?;
        let diagnosis = examine(&session, &fit)
            .map_err(|error| error.context(arguments.subject.display().to_string()))?;
        (Some(fit), Some(diagnosis))
    };
    let picture = (window.picture)(&session, fit.as_ref());
    if let Err(error) = &picture {
        eprintln!("the report has no picture of the robot: {error}");
    }
    let input = ReportInput {
        session: &session,
        fit: fit.as_ref(),
        diagnosis: diagnosis.as_ref(),
        outdated: false,
        picture: picture.as_deref().ok(),
        choice: &arguments.choice(),
        now: clock::now(),
    };
    write_report(&arguments.out, &input)?;
    Ok(())
}

/// Diagnoses the model with the effects that the session has added to it, at the values that were identified.
fn examine(session: &Session, fit: &Fit) -> Result<Diagnosed> {
    let alpha = session.settings.diagnosis.alpha;
    let options = DiagnosisOptions {
        alpha,
        ..DiagnosisOptions::default()
    };
    let mut dataset = session.dataset();
    dataset.robot.effects.clone_from(&fit.model.effects);
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
