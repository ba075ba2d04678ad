//! `tautline report`.

use crate::output::{note, write_file};
use std::path::PathBuf;
use std::sync::Arc;

use crate::BadInput;
use anyhow::Result;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use tautline_core::estimation::Control;
use tautline_study::monte_carlo as monte_carlo_of;
use tautline_workflow::clock;
use tautline_workflow::diagnosis::{TIME_LIMIT_S, dataset_to_diagnose};
use tautline_workflow::history::{RobotRecord, next_calibration_after};
use tautline_workflow::identification::identify_session;
use tautline_workflow::report::{
    Part, ReportChoice, ReportError, ReportFormat, ReportInput, missing_details, render_report,
};
use tautline_workflow::wording::list;

use crate::diagnose::diagnose_with_progress;
use crate::examples::examples;
use crate::hypothesis_arguments::HypothesisFiles;
use crate::position_tolerance::{PositionTolerance, metres};
use crate::replace::OutputFile;
use crate::report_format::session_report_format;
use crate::{Window, input, standard_input};

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("A dataset, with a decision on each pulley, as PDF", "tautline report mini --tolerance 20 -o mini.pdf"),
    ("With the date of the next calibration", "tautline report mini-2026/08 --record mini-2026 -o mini.html"),
    ("Without budget and log, as HTML", "tautline report mini --without budget,log -o mini.html"),
    ("A certificate with number, instruments and conditions", "tautline report mini --details certificate.toml -o certificate.pdf"),
    ("The same as a Digital Calibration Certificate", "tautline report mini --details certificate.toml -o certificate.xml"),
]))]
pub struct Arguments {
    /// Session, robot.json or dataset folder; - is a session on standard input
    #[arg(value_name = "SESSION|DATASET")]
    subject: PathBuf,
    /// File to write; its name must end with .html, .pdf or .xml (Digital Calibration Certificate); - is HTML on standard output
    #[arg(short, long, value_name = "FILE")]
    out: OutputFile,
    /// Parts to include, separated by commas; all by default
    #[arg(
        long,
        value_name = "PART",
        value_delimiter = ',',
        value_parser = part(),
        conflicts_with = "without"
    )]
    sections: Vec<Part>,
    /// Parts to leave out, separated by commas
    #[arg(long, value_name = "PART", value_delimiter = ',', value_parser = part())]
    without: Vec<Part>,
    /// Title instead of the name of the session
    #[arg(long, default_value = "")]
    title: String,
    /// Line above the title
    #[arg(long, default_value = "")]
    header: String,
    /// Who made the measurements
    #[arg(long, default_value = "")]
    operator: String,
    /// Largest acceptable deviation of a pulley from the drawing (mm), by which the report judges
    #[arg(long, value_name = "MM")]
    tolerance: Option<f64>,
    /// Company for which the report is made
    #[arg(long, default_value = "")]
    company: String,
    /// What the certificate states beside the results, instead of what the session has
    #[arg(long, value_name = "FILE.toml")]
    details: Option<PathBuf>,
    /// Number of draws for a Monte Carlo of the uncertainties (JCGM 101), beside the linear ones
    #[arg(long, value_name = "DRAWS", value_parser = clap::value_parser!(u32).range(100..=100_000))]
    monte_carlo: Option<u32>,
    /// Folder with the sessions of the robot, this one the last: the report has the date of the next calibration then
    #[arg(long, value_name = "FOLDER")]
    record: Option<PathBuf>,
    #[command(flatten)]
    position: PositionTolerance,
}

/// Parses the name of a part.
fn part() -> impl TypedValueParser<Value = Part> {
    let parts = Part::ALL.map(|part| PossibleValue::new(part.name()).help(part.title()));
    // The parser accepts only these names.
    PossibleValuesParser::new(parts).map(|name| Part::named(&name).unwrap_or(Part::Result))
}

impl Arguments {
    fn choice(&self) -> ReportChoice {
        let is_out = |part: &Part| match self.sections.is_empty() {
            true => self.without.contains(part),
            false => !self.sections.contains(part),
        };
        ReportChoice {
            without: Part::ALL.into_iter().filter(is_out).collect(),
            title: self.title.clone(),
            header: self.header.clone(),
            operator: self.operator.clone(),
            company: self.company.clone(),
            tolerance_m: self.tolerance.map(|mm| 1e-3 * mm),
        }
    }
}

impl Arguments {
    /// When the next calibration is due, from the record.
    fn next_calibration(&self) -> Result<Option<String>> {
        let tolerance = self.position.given()?;
        let Some(folder) = &self.record else {
            return match tolerance {
                Some(_) => Err(BadInput::new(
                    "--tolerance-position: expected only with --record",
                )),
                None => Ok(None),
            };
        };
        let record = RobotRecord::open(folder, clock::now(), &mut |_, _| Control::Continue)
            .map_err(|error| BadInput::new(error.to_string()))?;
        let found = record
            .history(folder, tolerance.unwrap_or_default())
            .map_err(|error| BadInput::new(error.to_string()))?;
        match next_calibration_after(&record, &found, &self.subject) {
            Some(sentence) => Ok(Some(sentence)),
            None => Err(BadInput::new(format!(
                "--record: found no {} among the sessions in {}, expected that it is one of them",
                self.subject.display(),
                folder.display()
            ))),
        }
    }
}

pub fn run(arguments: &Arguments, window: &Window) -> Result<()> {
    let format = session_report_format("--out", &arguments.out)?;
    if arguments.monte_carlo.is_some() && format == ReportFormat::Dcc {
        return Err(BadInput::new(
            "--monte-carlo: expected only with .html or .pdf; a Digital Calibration Certificate has the linear uncertainties",
        ));
    }
    if let Some(mm) = arguments.tolerance {
        metres("--tolerance", mm)?;
    }
    let mut session = input::session(&arguments.subject)?;
    HypothesisFiles::default().add_to(&mut session.robot)?;
    if let Some(path) = &arguments.details {
        session.settings.certificate = input::noticed(standard_input::versioned_toml(path)?);
    }
    let next_calibration = arguments.next_calibration()?;
    let choice = arguments.choice();
    let place = arguments.subject.display();
    let fit = match choice.shows_fit() && !session.measurements.is_empty() {
        true => Some(
            identify_session(&session, &mut |_| Control::Continue)
                .map_err(|error| BadInput::new(format!("{place}: {error}")))?,
        ),
        false => None,
    };
    let diagnosis = match fit.as_ref().filter(|_| choice.shows_diagnosis()) {
        Some(fit) => {
            let dataset = Arc::new(dataset_to_diagnose(&session, fit));
            let limits = (session.settings.diagnosis.alpha, TIME_LIMIT_S);
            let diagnosis = diagnose_with_progress(dataset, limits);
            Some(diagnosis.map_err(|error| BadInput::new(format!("{place}: {error}")))?)
        }
        None => None,
    };
    let draws = arguments.monte_carlo.map(|draws| draws as usize);
    let monte_carlo = fit.as_ref().zip(draws);
    let monte_carlo = monte_carlo.map(|(fit, draws)| monte_carlo_of(fit, draws));
    let picture = choice
        .has(Part::Result)
        .then(|| (window.picture)(&session, fit.as_ref()));
    if let Some(Err(error)) = &picture {
        note!("the report has no picture of the robot: {error}");
    }
    let input = ReportInput {
        session: &session,
        fit: fit.as_ref(),
        outdated: false,
        diagnosis: diagnosis.as_ref(),
        diagnosis_outdated: false,
        picture: picture.as_ref().and_then(|png| png.as_deref().ok()),
        next_calibration: next_calibration.as_deref(),
        monte_carlo: monte_carlo.as_ref(),
        choice: &choice,
        now: clock::now(),
    };
    let bytes = render_report(&input, format).map_err(|error| match error {
        ReportError::Dcc(reason) => BadInput::new(format!("{place}: {reason}")),
        other => other.into(),
    })?;
    let details = &session.settings.certificate;
    let missing = missing_details(details, &session.robot);
    if !missing.is_empty() && !details.number.is_empty() {
        note!("the certificate does not state: {}", list(&missing));
    }
    write_file(&arguments.out, &bytes)
}
