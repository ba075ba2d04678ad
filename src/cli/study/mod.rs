//! `tautline study`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Result;
use tautline_core::threads::available;
use tautline_session::{Loaded, VersionedFile};
use tautline_study::plan::PLAN;
use tautline_study::report::{render_report, sentences};
use tautline_study::run::run as run_chunks;
use tautline_study::{
    RESULT, StudyError, StudyFile, StudyPlan, StudyResult, merge, read_plan, read_result,
};
use tautline_workflow::clock;

use crate::examples::examples;
use crate::hypothesis_arguments::HypothesisFiles;
use crate::live::interrupt;
use crate::output::{JsonOutput, confirm, is_standard, note, say, write_file};
use crate::progress::ProgressLine;
use crate::replace::{OutputFile, permit};
use crate::report_format::report_format;
use crate::{BadInput, standard_input, table};

#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// Read a study file, choose poses, evaluate all cells by their expected covariance, and list the chunks to simulate
    #[command(after_help = examples(&[
        ("A study, and the commands that run its chunks", "tautline study plan docs/studies/mini.toml -o mini-study"),
    ]))]
    Plan {
        /// Study file (TOML); - is standard input, with --out
        #[arg(value_name = "STUDY.toml")]
        study: PathBuf,
        #[command(flatten)]
        hypotheses: HypothesisFiles,
        /// Folder of the study; by default beside the file, with the same name
        #[arg(short, long, value_name = "DIR")]
        out: Option<OutputFile>,
    },
    /// Simulate all chunks, or one; finished chunks are not repeated
    #[command(after_help = examples(&[
        ("All that is not done yet", "tautline study run mini-study"),
        ("One chunk of seven, on one of several machines", "tautline study run mini-study --chunk 3/7"),
    ]))]
    Run {
        /// Folder of the study
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// One chunk as NUMBER/COUNT, such as 3/7; by default all, as divided by the study file
        #[arg(long, value_name = "I/N", allow_hyphen_values = true)]
        chunk: Option<String>,
        /// Number of threads; by default as many as the machine has cores
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
        threads: Option<u16>,
    },
    /// Merge the chunks into the result
    #[command(after_help = examples(&[
        ("What the chunks amount to", "tautline study merge mini-study"),
    ]))]
    Merge {
        /// Folder of the study
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        #[command(flatten)]
        json: JsonOutput<StudyResult>,
    },
    /// Write the report as HTML or PDF
    #[command(after_help = examples(&[
        ("The merged result with its figures", "tautline study report mini-study -o mini-study.pdf"),
    ]))]
    Report {
        /// Folder of the study
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// File to write; its name must end with .html or .pdf; - is HTML on standard output
        #[arg(short, long, value_name = "FILE")]
        out: OutputFile,
    },
}

pub fn run(command: &Command) -> Result<()> {
    match command {
        Command::Plan {
            study,
            hypotheses,
            out,
        } => plan(study, hypotheses, out.as_deref()),
        Command::Run {
            folder,
            chunk,
            threads,
        } => simulate(folder, chunk.as_deref(), *threads),
        Command::Merge { folder, json } => join(folder, json),
        Command::Report { folder, out } => report(folder, out),
    }
}

/// Progress of a study on the terminal.
struct Progress {
    what: &'static str,
    began: Instant,
    line: ProgressLine,
}

impl Progress {
    /// Progress in units of `what`.
    fn new(what: &'static str) -> Self {
        Self {
            what,
            began: Instant::now(),
            line: ProgressLine::new(),
        }
    }

    /// Shows how many are done.
    fn show(&mut self, done: u64, all: u64) {
        let (what, began) = (self.what, self.began);
        self.line.show(|| {
            let rate = done as f64 / began.elapsed().as_secs_f64().max(1e-9);
            format!("{done} of {all} {what}, {rate:.0} per second")
        });
    }
}

/// Converts errors: those in the input are the user's to correct, those of writing are not.
fn correctable(error: StudyError) -> anyhow::Error {
    match error {
        StudyError::Read(error) => error.into(),
        StudyError::Input(message) => BadInput::new(message),
        StudyError::Write(_) | StudyError::Cancelled => error.into(),
    }
}

fn plan(path: &Path, hypotheses: &HypothesisFiles, out: Option<&Path>) -> Result<()> {
    let Loaded {
        value: mut study,
        notices,
    } = standard_input::versioned_toml::<StudyFile>(path)?;
    study.hypotheses.extend(hypotheses.read()?);
    notices.iter().for_each(|notice| note!("{notice}"));
    let beside = path.with_extension("");
    let folder = match out {
        Some(folder) => folder,
        None if is_standard(path) => {
            return Err(BadInput::new(
                "--out: not given, expected the folder of the study that comes from standard input",
            ));
        }
        None => &beside,
    };
    permit(&folder.join(PLAN), &[StudyPlan::FORMAT])?;
    interrupt::listen()?;
    let mut progress = Progress::new("cells");
    let mut observe = |done: usize, all: usize| {
        progress.show(done as u64, all as u64);
        interrupt::control()
    };
    let of_file = path
        .parent()
        .filter(|parent| !parent.as_os_str().is_empty());
    let planned = StudyPlan::new(study, of_file.unwrap_or(Path::new(".")), &mut observe);
    drop(progress);
    let planned = planned.map_err(|error| match error {
        StudyError::Input(message) => BadInput::new(format!("{}: {message}", path.display())),
        error => correctable(error),
    })?;
    let written = planned.write(folder).map_err(correctable)?;
    print_cells(&planned);
    say!(
        "{}: {} cells, of which {} are simulated: {} calibrations in {} chunks",
        written.display(),
        planned.cells.len(),
        planned.simulated().len(),
        planned.calibrations(),
        planned.chunks()
    );
    for number in 1..=planned.chunks() {
        say!(
            "tautline study run {} --chunk {number}/{}",
            folder.display(),
            planned.chunks()
        );
    }
    Ok(())
}

/// Largest number of cells printed.
const PRINTED: usize = 60;

fn print_cells(plan: &StudyPlan) {
    let or_none = |cell: Option<String>| cell.unwrap_or_else(|| "-".to_owned());
    let mm = |metres: Option<f64>| or_none(metres.map(|metres| format!("{:.3}", 1e3 * metres)));
    let cells = plan.cells.iter().enumerate().take(PRINTED);
    table::rows(cells).print(&[
        ("robot", &|(_, cell)| {
            plan.robots[cell.combination.robot].name.clone()
        }),
        ("cell", &|(index, _)| index.to_string()),
        ("size m", &|(_, cell)| {
            or_none(cell.combination.size_m.map(|size| format!("{size:.3}")))
        }),
        ("laser", &|(_, cell)| cell.combination.laser.clone()),
        ("poses", &|(_, cell)| cell.combination.poses.to_string()),
        ("home mm", &|(_, cell)| mm(cell.combination.home_sd_m)),
        ("position mm", &|(_, cell)| mm(cell.expected.position_m)),
        ("entry points mm", &|(_, cell)| mm(cell.expected.entry_m)),
    ]);
    if plan.cells.len() > PRINTED {
        say!("{} more cells are in {PLAN}", plan.cells.len() - PRINTED);
    }
}

fn simulate(folder: &Path, chunk: Option<&str>, threads: Option<u16>) -> Result<()> {
    let plan = read_plan(folder).map_err(correctable)?;
    let parts = plan.parts(chunk);
    let parts = parts.map_err(|message| BadInput::new(format!("--chunk: {message}")))?;
    let threads = threads.map_or_else(available, usize::from);
    interrupt::listen()?;
    let all: u64 = parts
        .iter()
        .map(|part| part.range(plan.calibrations()))
        .map(|[from, to]| to - from)
        .sum();
    let mut progress = Progress::new("calibrations");
    let ran = run_chunks(&plan, folder, &parts, threads, &mut |done| {
        progress.show(done, all);
        interrupt::control()
    });
    let summary = ran.map_err(correctable)?;
    drop(progress);
    confirm!(
        "{}: {} chunks done, {} existed",
        folder.display(),
        summary.done,
        summary.found
    );
    Ok(())
}

fn join(folder: &Path, json: &JsonOutput<StudyResult>) -> Result<()> {
    let plan = read_plan(folder).map_err(correctable)?;
    permit(&folder.join(RESULT), &[StudyResult::FORMAT])?;
    let result = merge(&plan, folder).map_err(correctable)?;
    json.deliver(&result, || {
        sentences(&plan, &result)
            .iter()
            .for_each(|sentence| say!("{sentence}"));
        say!(
            "{} calibrations are merged in {}",
            result.calibrations,
            folder.join(RESULT).display()
        );
    })
}

fn report(folder: &Path, out: &Path) -> Result<()> {
    let format = report_format("--out", out)?;
    let plan = read_plan(folder).map_err(correctable)?;
    let result = read_result(&plan, folder).map_err(correctable)?;
    write_file(out, &render_report(&plan, &result, clock::now(), format)?)
}
