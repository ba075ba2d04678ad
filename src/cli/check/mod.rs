//! `tautline check`.

mod against;

use std::path::PathBuf;

use anyhow::Result;
use tautline_workflow::health::HealthDocument;
use tautline_workflow::readiness::{CheckItem, CheckOutcome, ReadinessDocument, check};

use crate::examples::examples;
use crate::failure::Reservation;
use crate::hypothesis_arguments::HypothesisFiles;
use crate::output::{JsonOutput, say};
use crate::{input, isolability};

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("Whether the readings are complete and plausible", "tautline check mini"),
    ("Whether the robot is still as it was in March", "tautline check bad --against mini"),
    ("And which faults they would reveal", "tautline check mini --explain"),
]))]
pub struct Arguments {
    /// Session file or dataset folder; - is a session on standard input
    #[arg(value_name = "SESSION|DATASET")]
    dataset: PathBuf,
    #[command(flatten)]
    hypotheses: HypothesisFiles,
    #[command(flatten)]
    json: JsonOutput<ReadinessDocument, HealthDocument>,
    /// Session or dataset folder of the calibration: is the robot still as it was then?
    #[arg(long, value_name = "SESSION|DATASET")]
    against: Option<PathBuf>,
    /// Also evaluate which faults the poses would reveal and which of them could be confused, which takes seconds
    #[arg(long)]
    explain: bool,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let mut read = input::measured(&arguments.dataset)?;
    arguments.hypotheses.add_to(&mut read.dataset.robot)?;
    if let Some(baseline) = &arguments.against {
        return against::run(arguments, &read, baseline);
    }
    let document = check(&read.dataset, read.lines.as_ref(), arguments.explain);
    arguments.json.deliver(&document, || print(&document))?;
    Reservation::NotReady.unless(document.ready)
}

fn print(document: &ReadinessDocument) {
    print_items(&document.checks);
    if let Some(document) = &document.isolability {
        isolability::print(document);
    }
}

fn print_items(items: &[CheckItem]) {
    for item in items {
        let outcome = match item.outcome {
            CheckOutcome::Pass => "pass",
            CheckOutcome::Notice => "notice",
            CheckOutcome::Fail => "FAIL",
            CheckOutcome::NotEvaluated => "not evaluated",
        };
        say!("{}: {outcome}. {}", item.title(), item.sentence);
        if let Some(action) = &item.action {
            say!("   {action}");
        }
    }
}
