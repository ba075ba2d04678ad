//! The boundary to Python: errors, interruption, texts of robots and datasets.

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
pub type DatasetTexts = (String, String);

pub fn error(error: impl std::fmt::Display) -> PyErr {
    TautlineError::new_err(error.to_string())
}

pub fn parsed_robot(text: &str) -> PyResult<Robot> {
    let read = tautline_session::parse_robot(text.as_bytes(), "robot").map_err(error)?;
    Ok(read.value)
}

pub fn parsed_dataset((robot, poses): &DatasetTexts) -> PyResult<Dataset> {
    let robot = parsed_robot(robot)?;
    let read = tautline_session::read_poses(poses.as_bytes(), "poses", &robot).map_err(error)?;
    Ok(Dataset {
        measurements: read.value,
        robot,
    })
}

/// A dataset in memory as a session that begins now.
pub fn session_of(name: &str, dataset: Dataset) -> Session {
    let mut session = Session::new(name, dataset.robot, clock::now());
    session.measurements = dataset.measurements;
    session
}

pub fn json<T: VersionedFile>(document: &T) -> PyResult<String> {
    serde_json::to_string(&tautline_session::versioned(document)).map_err(error)
}

/// `poses.csv` of a dataset.
pub fn poses_text(dataset: &Dataset) -> PyResult<String> {
    let mut text = Vec::new();
    tautline_session::write_poses(&mut text, &dataset.measurements).map_err(error)?;
    String::from_utf8(text).map_err(error)
}

pub fn settings(effects: &str) -> PyResult<Vec<EffectSetting>> {
    serde_json::from_str(effects).map_err(|e| error(format!("effects: {e}")))
}

/// Watches for Ctrl+C while work is done without the lock of the interpreter.
#[derive(Default)]
pub struct Interrupt(Option<PyErr>);

impl Interrupt {
    /// Decides whether to continue: not after Ctrl+C.
    pub fn control(&mut self) -> Control {
        if self.0.is_none() {
            self.0 = Python::attach(|py| py.check_signals()).err();
        }
        match self.0 {
            None => Control::Continue,
            Some(_) => Control::Cancel,
        }
    }
}

/// Runs `work` without the lock of the interpreter; an interruption by Ctrl+C is raised as `KeyboardInterrupt`.
pub fn detached<T: Send>(
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
