//! The compiled part of the Python package `tautline`.
//!
//! Robots and results cross as the JSON of the commands, measured poses as the text of `poses.csv`: both have one reader, with
//! its checks and sentences. The modules of `tautline/` make arrays and dataclasses of them.

mod computing;
mod files;
mod fitting;
mod importing;
mod study;
mod table;

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use tautline_core::effect::EffectSetting;
use tautline_core::estimation::Control;
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_session::{Session, VersionedFile};
use tautline_workflow::clock;

create_exception!(
    tautline,
    TautlineError,
    PyValueError,
    "What is wrong with the input, in the sentence that the command would say."
);

/// Texts of `robot.json` and `poses.csv`.
type DatasetTexts = (String, String);

fn error(error: impl std::fmt::Display) -> PyErr {
    TautlineError::new_err(error.to_string())
}

fn parsed_robot(text: &str) -> PyResult<Robot> {
    let read = tautline_session::parse_robot(text.as_bytes(), "robot").map_err(error)?;
    Ok(read.value)
}

fn parsed_dataset((robot, poses): &DatasetTexts) -> PyResult<Dataset> {
    let robot = parsed_robot(robot)?;
    let read = tautline_session::read_poses(poses.as_bytes(), "poses", &robot).map_err(error)?;
    Ok(Dataset {
        measurements: read.value,
        robot,
    })
}

/// A dataset in memory as a session that begins now.
fn session_of(name: &str, dataset: Dataset) -> Session {
    let mut session = Session::new(name, dataset.robot, clock::now());
    session.measurements = dataset.measurements;
    session
}

fn json<T: VersionedFile>(document: &T) -> PyResult<String> {
    serde_json::to_string(&tautline_session::versioned(document)).map_err(error)
}

/// `poses.csv` of a dataset.
fn poses_text(dataset: &Dataset) -> PyResult<String> {
    let mut text = Vec::new();
    tautline_session::write_poses(&mut text, &dataset.measurements).map_err(error)?;
    String::from_utf8(text).map_err(error)
}

fn settings(effects: &str) -> PyResult<Vec<EffectSetting>> {
    serde_json::from_str(effects).map_err(|e| error(format!("effects: {e}")))
}

/// Watches for Ctrl+C while work is done without the lock of the interpreter.
#[derive(Default)]
struct Interrupt(Option<PyErr>);

impl Interrupt {
    /// Whether to go on.
    fn control(&mut self) -> Control {
        if self.0.is_none() {
            self.0 = Python::attach(|py| py.check_signals()).err();
        }
        match self.0 {
            None => Control::Continue,
            Some(_) => Control::Cancel,
        }
    }
}

/// Runs `work` without the lock of the interpreter; what was interrupted by Ctrl+C is raised as that.
fn detached<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&mut Interrupt) -> Result<T, String> + Send,
) -> PyResult<T> {
    let (done, interrupt) = py.detach(|| {
        let mut interrupt = Interrupt::default();
        (work(&mut interrupt), interrupt)
    });
    match interrupt.0 {
        Some(interrupted) => Err(interrupted),
        None => done.map_err(error),
    }
}

#[pymodule]
mod _tautline {
    #[pymodule_export]
    use super::TautlineError;
    #[pymodule_export]
    use super::computing::{
        check, check_health, compare, diagnose, effects, history, parse_effect, plan, predict,
        simulate,
    };
    #[pymodule_export]
    use super::files::{
        check_poses, checked_robot, export, precalibrate, preset, presets_names, read_dataset,
        read_robot, read_session, report, write_dataset, write_robot,
    };
    #[pymodule_export]
    use super::fitting::{fit_tables, identify};
    #[pymodule_export]
    use super::importing::{channels, import_readings, import_robot};
    #[pymodule_export]
    use super::study::{
        merge_study, plan_study, read_study, report_study, run_study, study_calibrations,
        study_from_toml,
    };
    #[pymodule_export]
    const USUAL_POSES: usize = tautline_core::planning::USUAL_POSES;
    #[pymodule_export]
    const LEVEL: f64 = tautline_workflow::comparison::LEVEL;
    #[pymodule_export]
    const TIME_LIMIT_S: f64 = tautline_workflow::diagnosis::TIME_LIMIT_S;
    #[pymodule_export]
    #[allow(non_upper_case_globals)] // as Python calls it
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
