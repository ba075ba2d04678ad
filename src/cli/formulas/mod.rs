//! `tautline formulas`.

mod report;

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Result;
use tautline_core::estimation::Control;
use tautline_workflow::diagnosis::Diagnosed;
use tautline_workflow::diagnosis::TIME_LIMIT_S;
use tautline_workflow::formulas::{FormulasDocument, find_formulas, unexplained_sentences};

use crate::diagnose::{diagnose_with_progress, model_to_diagnose};
use crate::examples::examples;
use crate::failure::BadInput;
use crate::hypothesis_arguments::HypothesisFiles;
use crate::input;
use crate::output::{JsonOutput, confirm, write_file};
use crate::replace::OutputFile;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("What an error looks like that no cause explains", "tautline formulas bad"),
    ("The likeliest pattern as a hypothesis file, to be named and kept", "tautline formulas bad -o pattern.toml"),
]))]
pub struct Arguments {
    /// Session file or dataset folder; - is a session on standard input
    #[arg(value_name = "SESSION|DATASET")]
    subject: PathBuf,
    /// Time after which each round ends with the best answer so far (s)
    #[arg(long, value_name = "SECONDS", default_value_t = TIME_LIMIT_S)]
    time_limit: f64,
    #[command(flatten)]
    hypotheses: HypothesisFiles,
    #[command(flatten)]
    json: JsonOutput<FormulasDocument>,
    /// Write the likeliest pattern as a hypothesis file; - is standard output
    #[arg(short, long, value_name = "FILE.toml")]
    out: Option<OutputFile>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let limit_s = arguments.time_limit;
    if limit_s.is_nan() || limit_s <= 0.0 {
        return Err(BadInput::new(format!(
            "--time-limit: found {limit_s}, expected a number of seconds above 0"
        )));
    }
    let out = arguments.out.as_deref();
    let mut session = input::session(&arguments.subject)?;
    arguments.hypotheses.add_to(&mut session.robot)?;
    let place = arguments.subject.display();
    let alpha = session.settings.diagnosis.alpha;
    let diagnosed = model_to_diagnose(&session)
        .and_then(|dataset| Ok(diagnose_with_progress(Arc::new(dataset), (alpha, limit_s))?))
        .map_err(|error| BadInput::new(format!("{place}: {error}")))?;
    let document = document(diagnosed).map_err(|e| BadInput::new(format!("{place}: {e}")))?;
    let best = document.patterns.first();
    if let Some((path, best)) = out.zip(best) {
        write_file(path, best.hypothesis.as_bytes())?;
    }
    arguments.json.deliver(&document, || {
        report::print(&document);
        if let Some((path, _)) = out.zip(best) {
            confirm!("the likeliest pattern is in {}", path.display());
        }
    })
}

fn document(diagnosed: Diagnosed) -> Result<FormulasDocument> {
    let unexplained = unexplained_sentences(&diagnosed);
    let found = find_formulas(&diagnosed, &mut |_| Control::Continue)?;
    Ok(FormulasDocument::of(unexplained, found.as_ref()))
}
