//! `tautline study`.

mod progress;

use std::path::{Path, PathBuf};

use anyhow::Result;
use tautline_core::threads::available;
use tautline_session::{Loaded, read_versioned_toml};
use tautline_study::plan::PLAN;
use tautline_study::report::{sentences, write_report};
use tautline_study::run::run as run_chunks;
use tautline_study::{RESULT, StudyError, StudyFile, StudyPlan, merge, read_plan, read_result};
use tautline_workflow::clock;
use tautline_workflow::report::{ReportError, ReportFormat};

use crate::BadInput;
use crate::live::interrupt;
use crate::output::{JsonOutput, note, say};
use crate::table;
use progress::Progress;

#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// Read a study file, choose poses, evaluate all cells by their expected covariance, and list the chunks to simulate
    Plan {
        /// Study file (TOML)
        #[arg(value_name = "STUDY.toml")]
        study: PathBuf,
        /// Folder of the study; by default beside the file, with the same name
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Simulate all chunks, or one; finished chunks are not repeated
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
    Merge {
        /// Folder of the study
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        #[command(flatten)]
        json: JsonOutput,
    },
    /// Write the report as HTML or PDF
    Report {
        /// Folder of the study
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// File to write; its name must end with .html or .pdf
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
}

pub fn run(command: &Command) -> Result<()> {
    match command {
        Command::Plan { study, out } => plan(study, out.as_deref()),
        Command::Run {
            folder,
            chunk,
            threads,
        } => simulate(folder, chunk.as_deref(), *threads),
        Command::Merge { folder, json } => join(folder, json),
        Command::Report { folder, out } => report(folder, out),
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

fn plan(path: &Path, out: Option<&Path>) -> Result<()> {
    let Loaded {
        value: study,
        notices,
    } = read_versioned_toml::<StudyFile>(path)?;
    notices.iter().for_each(|notice| note!("{notice}"));
    let beside = path.with_extension("");
    let folder = out.unwrap_or(&beside);
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
    let mut table = table::numbers(&[
        "robot",
        "cell",
        "size m",
        "laser",
        "poses",
        "home mm",
        "position mm",
        "entry points mm",
    ]);
    let mm = |metres: Option<f64>| {
        metres.map_or_else(|| "-".to_owned(), |metres| format!("{:.3}", 1e3 * metres))
    };
    for (index, cell) in plan.cells.iter().enumerate().take(PRINTED) {
        let combination = &cell.combination;
        let cells = [
            plan.robots[combination.robot].name.clone(),
            index.to_string(),
            combination
                .size_m
                .map_or_else(|| "-".to_owned(), |size| format!("{size:.3}")),
            combination.laser.clone(),
            combination.poses.to_string(),
            mm(combination.home_sd_m),
            mm(cell.expected.position_m),
            mm(cell.expected.entry_m),
        ];
        table::push(&mut table, &cells);
    }
    say!("{table}");
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
        // The last calibration is counted once its chunk is written.
        progress.show(done.min(all.saturating_sub(1)), all);
        interrupt::control()
    });
    let summary = ran.map_err(correctable)?;
    progress.show(all, all);
    say!(
        "{}: {} chunks done, {} existed",
        folder.display(),
        summary.done,
        summary.found
    );
    Ok(())
}

fn join(folder: &Path, json: &JsonOutput) -> Result<()> {
    let plan = read_plan(folder).map_err(correctable)?;
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
    if ReportFormat::of(out).is_none() {
        return Err(BadInput::new(ReportError::Extension(out.to_path_buf())));
    }
    let plan = read_plan(folder).map_err(correctable)?;
    let result = read_result(&plan, folder).map_err(correctable)?;
    write_report(out, &plan, &result, clock::now())?;
    Ok(())
}
