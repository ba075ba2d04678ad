//! Studies: the command `study` without a command line.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use tautline_core::threads::available;
use tautline_session::{parse_versioned, read_versioned_toml};
use tautline_study::report::write_report;
use tautline_study::run::run;
use tautline_study::{StudyFile, StudyPlan, calibrations, merge, read_plan, read_result};
use tautline_workflow::clock;
use tautline_workflow::exporting::ParquetCells;

use crate::boundary::{detached, error, json};

/// The study of a TOML file.
#[pyfunction]
pub fn study_from_toml(path: PathBuf) -> PyResult<String> {
    json(
        &read_versioned_toml::<StudyFile>(&path)
            .map_err(error)?
            .value,
    )
}

/// Plans a study and writes its folder; files of robots are looked for in `robots`.
#[pyfunction]
pub fn plan_study(
    py: Python<'_>,
    study: &str,
    robots: PathBuf,
    folder: PathBuf,
) -> PyResult<String> {
    let study = parse_versioned::<StudyFile>(study.as_bytes(), "study").map_err(error)?;
    let plan = detached(py, |interrupt| {
        let plan = StudyPlan::new(study.value, &robots, &mut |_, _| interrupt.control());
        plan.map_err(|e| e.to_string())
    })?;
    plan.write(&folder).map_err(error)?;
    json(&plan)
}

/// The plan in the folder of a study.
#[pyfunction]
pub fn read_study(folder: PathBuf) -> PyResult<String> {
    json(&plan_of(&folder)?)
}

/// Runs one chunk of a study, or all; returns the numbers of computed chunks and of those that existed.
#[pyfunction]
pub fn run_study(
    py: Python<'_>,
    folder: PathBuf,
    chunk: Option<&str>,
    threads: Option<usize>,
) -> PyResult<(u64, u64)> {
    let plan = plan_of(&folder)?;
    let parts = plan
        .parts(chunk)
        .map_err(|e| error(format!("chunk: {e}")))?;
    let threads = threads.unwrap_or_else(available);
    let summary = detached(py, |interrupt| {
        let ran = run(&plan, &folder, &parts, threads, &mut |_| {
            interrupt.control()
        });
        ran.map_err(|e| e.to_string())
    })?;
    Ok((summary.done, summary.found))
}

/// Name, NumPy type and bytes of a column.
type NumpyColumn<'py> = (&'static str, &'static str, Bound<'py, PyBytes>);

/// The calibrations of all existing chunks.
#[pyfunction]
pub fn study_calibrations(py: Python<'_>, folder: PathBuf) -> PyResult<Vec<NumpyColumn<'_>>> {
    let rows = detached(py, |_| calibrations(&folder).map_err(|e| e.to_string()))?;
    let column = |(name, cells): (&'static str, ParquetCells<'_>)| -> NumpyColumn<'_> {
        let (kind, bytes) = match cells {
            ParquetCells::F64(all) => (
                "<f8",
                all.iter().flat_map(|one| one.to_le_bytes()).collect(),
            ),
            ParquetCells::F32(all) => (
                "<f4",
                all.iter().flat_map(|one| one.to_le_bytes()).collect(),
            ),
            ParquetCells::U32(all) => (
                "<u4",
                all.iter().flat_map(|one| one.to_le_bytes()).collect(),
            ),
            ParquetCells::U8(all) => ("|u1", all.to_vec()),
            ParquetCells::Texts(_) => ("|u1", Vec::new()),
        };
        let bytes: Vec<u8> = bytes;
        (name, kind, PyBytes::new(py, &bytes))
    };
    Ok(rows.columns().map(column).into())
}

/// Joins the chunks of a study to its result.
#[pyfunction]
pub fn merge_study(py: Python<'_>, folder: PathBuf) -> PyResult<String> {
    let plan = plan_of(&folder)?;
    let result = detached(py, |_| merge(&plan, &folder).map_err(|e| e.to_string()))?;
    json(&result)
}

/// Writes the report of a merged study, as HTML or PDF by its name.
#[pyfunction]
pub fn report_study(folder: PathBuf, out: PathBuf) -> PyResult<()> {
    let plan = plan_of(&folder)?;
    let result = read_result(&plan, &folder).map_err(error)?;
    write_report(&out, &plan, &result, clock::now()).map_err(error)
}

fn plan_of(folder: &Path) -> PyResult<StudyPlan> {
    read_plan(folder).map_err(error)
}
