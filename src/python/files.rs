//! Files: robots, datasets and sessions in and out, calibration tables, exports and reports.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyo3::prelude::*;
use tautline_core::diagnosis::DiagnosisOptions;
use tautline_session::{Folders, HypothesisFolder, read_calibration_tables, write_bytes};
use tautline_workflow::clock;
use tautline_workflow::diagnosis::{dataset_to_diagnose, diagnose_dataset};
use tautline_workflow::exporting::{TableFormat, encode, poses_table};
use tautline_workflow::identification::{identify_session, readings_table, values_table};
use tautline_workflow::machines;
use tautline_workflow::precalibration::Calibration;
use tautline_workflow::precalibration::Precalibration;
use tautline_workflow::report::{Part, ReportChoice, ReportFormat, ReportInput, render_report};

use crate::boundary::{
    DatasetTexts, detached, error, json, parsed_dataset, parsed_robot, poses_text, session_of,
};
use crate::fitting::{FitOptions, solved};

/// Names of the robots that come with the program.
#[pyfunction]
pub fn presets_names() -> Vec<&'static str> {
    machines::names()
}

/// A robot that comes with the program.
#[pyfunction]
pub fn preset(name: &str) -> PyResult<String> {
    let found = machines::find(name).ok_or_else(|| {
        let names = machines::names().join(", ");
        error(format!("found preset \"{name}\", expected one of {names}"))
    })?;
    json(&found.robot)
}

/// Checks a robot; its canonical form.
#[pyfunction]
pub fn checked_robot(text: &str) -> PyResult<String> {
    json(&parsed_robot(text)?)
}

#[pyfunction]
pub fn read_robot(path: PathBuf) -> PyResult<String> {
    json(&tautline_session::read_robot(&path).map_err(error)?.value)
}

#[pyfunction]
pub fn write_robot(path: PathBuf, robot: &str) -> PyResult<()> {
    tautline_session::write_robot(&path, &parsed_robot(robot)?).map_err(error)
}

/// Robot and poses of a dataset folder, and what the operator should know.
#[pyfunction]
pub fn read_dataset(folder: PathBuf) -> PyResult<(String, String, Vec<String>)> {
    let mut read = tautline_session::read_dataset(&folder).map_err(error)?;
    if let Ok(folders) = Folders::of_user() {
        let own = HypothesisFolder::read(&folders.effects());
        read.notices.extend(own.add_to(&mut read.dataset.robot));
        read.notices.extend(own.notices);
    }
    Ok((
        json(&read.dataset.robot)?,
        poses_text(&read.dataset)?,
        read.notices,
    ))
}

#[pyfunction]
pub fn write_dataset(folder: PathBuf, robot: String, poses: String) -> PyResult<()> {
    let dataset = parsed_dataset(&(robot, poses))?;
    tautline_session::write_dataset(&folder, &dataset, &Default::default()).map_err(error)
}

/// Reads the text of a `poses.csv`; what the operator should know.
#[pyfunction]
pub fn check_poses(robot: &str, poses: &str) -> PyResult<Vec<String>> {
    let robot = parsed_robot(robot)?;
    let read = tautline_session::read_poses(poses.as_bytes(), "poses", &robot);
    Ok(read.map_err(error)?.notices)
}

/// Robot and poses of a session, without those that were excluded.
#[pyfunction]
pub fn read_session(path: PathBuf) -> PyResult<(String, String)> {
    let read = tautline_session::read_session(&path).map_err(error)?;
    let dataset = read.value.dataset();
    Ok((json(&dataset.robot)?, poses_text(&dataset)?))
}

/// The result of the command `precalibrate`, the robot with the fitted values, and what the operator should know.
#[pyfunction]
pub fn precalibrate(folder: PathBuf) -> PyResult<(String, String, Vec<String>)> {
    let tables = read_calibration_tables(&folder).map_err(error)?;
    let (robot, phases) = &tables.value;
    let fits = Calibration::new(robot, phases);
    let document = Precalibration::of(robot, phases, &fits);
    let document = document.map_err(|failure| error(failure.sentence(&folder)))?;
    let proposal = fits.with_all();
    let robot = proposal
        .robot
        .map_err(|why| error(format!("{}: {why}", folder.display())))?;
    let notices = [tables.notices, proposal.left_out].concat();
    Ok((json(&document)?, json(&robot)?, notices))
}

/// Writes tables as the command `export` does.
#[pyfunction]
pub fn export(
    py: Python<'_>,
    out: PathBuf,
    dataset: DatasetTexts,
    tables: Vec<String>,
    options: FitOptions,
) -> PyResult<()> {
    let place = out.display();
    let format = TableFormat::of(&out).ok_or_else(|| {
        error(format!(
            "found {place}, expected a file that ends in .csv, .parquet or .mat"
        ))
    })?;
    if tables.is_empty() || tables.len() > 1 && !format.holds_several() {
        return Err(error(format!(
            "tables: found {} for {place}, expected one, or several for a .mat file",
            tables.len()
        )));
    }
    let names = ["poses", "values", "readings"];
    if let Some(wrong) = tables.iter().find(|name| !names.contains(&name.as_str())) {
        return Err(error(format!(
            "tables: found \"{wrong}\", expected one of {}",
            names.join(", ")
        )));
    }
    let is_identified = tables.iter().any(|name| name != "poses");
    let measured = parsed_dataset(&dataset)?;
    let fit = match is_identified {
        true => Some(solved(py, &dataset, options, true)?),
        false => None,
    };
    let tables = tables.iter().map(|name| match (name.as_str(), &fit) {
        ("values", Some(fit)) => values_table(fit),
        ("readings", Some(fit)) => readings_table(fit),
        _ => poses_table(&measured.measurements),
    });
    let bytes = encode(format, &tables.collect::<Vec<_>>());
    let bytes = bytes.map_err(|why| error(format!("{place}: cannot be created ({why})")))?;
    write_bytes(&out, &bytes).map_err(error)
}

/// What a report says besides its results.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ReportOptions {
    sections: Vec<String>,
    title: String,
    header: String,
    operator: String,
    company: String,
    tolerance_m: Option<f64>,
    time_limit_s: f64,
}

impl ReportOptions {
    fn choice(&self) -> PyResult<ReportChoice> {
        if let Some(tolerance_m) = self.tolerance_m
            && !(tolerance_m.is_finite() && tolerance_m > 0.0)
        {
            return Err(error(format!(
                "tolerance_m: found {tolerance_m}, expected a positive number"
            )));
        }
        let unknown = self
            .sections
            .iter()
            .find(|name| Part::named(name).is_none());
        if let Some(unknown) = unknown {
            let names = Part::ALL.map(Part::name).join(", ");
            return Err(error(format!(
                "sections: found \"{unknown}\", expected some of {names}"
            )));
        }
        let is_out = |part: &Part| {
            !self.sections.is_empty() && !self.sections.iter().any(|name| name == part.name())
        };
        Ok(ReportChoice {
            without: Part::ALL.into_iter().filter(is_out).collect(),
            title: self.title.clone(),
            header: self.header.clone(),
            operator: self.operator.clone(),
            company: self.company.clone(),
            tolerance_m: self.tolerance_m,
        })
    }
}

/// Identifies, diagnoses, and writes the report of the command `report`, without a picture of the robot.
#[pyfunction]
pub fn report(
    py: Python<'_>,
    out: PathBuf,
    dataset: DatasetTexts,
    options: ReportOptions,
) -> PyResult<()> {
    let format = report_format(&out)?;
    let choice = options.choice()?;
    let dataset = parsed_dataset(&dataset)?;
    let session = session_of(&dataset.robot.name.clone(), dataset);
    let bytes = detached(py, |interrupt| {
        let fit = identify_session(&session, &mut |_| interrupt.control());
        let fit = fit.map_err(|e| e.to_string())?;
        let asked = (DiagnosisOptions::default().alpha, options.time_limit_s);
        let dataset = Arc::new(dataset_to_diagnose(&session, &fit));
        let diagnosis = diagnose_dataset(dataset, asked, &mut |_| interrupt.control());
        let diagnosis = diagnosis.map_err(|e| e.to_string())?;
        let input = ReportInput {
            session: &session,
            fit: Some(&fit),
            outdated: false,
            diagnosis: Some(&diagnosis),
            diagnosis_outdated: false,
            picture: None,
            choice: &choice,
            next_calibration: None,
            monte_carlo: None,
            now: clock::now(),
        };
        render_report(&input, format).map_err(|e| e.to_string())
    })?;
    write_bytes(&out, &bytes).map_err(error)
}

fn report_format(out: &Path) -> PyResult<ReportFormat> {
    // What a Digital Calibration Certificate states beside the results comes from the command.
    let format = ReportFormat::of(out).filter(|format| *format != ReportFormat::Dcc);
    format.ok_or_else(|| {
        error(format!(
            "found {}, expected a name that ends with .html or .pdf",
            out.display()
        ))
    })
}
