//! The compiled part of the Python package `tautline`.
//!
//! Robots and results cross as the JSON of the commands, measured poses as the text of `poses.csv`: both have one reader, with
//! its checks and sentences. The modules of `tautline/` make arrays and dataclasses of them.

mod study;

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use tautline_core::diagnosis::DiagnosisOptions;
use tautline_core::effect::{BoundEffect, EffectRequest, EffectSetting};
use tautline_core::estimation::{Control, Loss, Method};
use tautline_core::geometry::Pose;
use tautline_core::kinematics::inverse_kinematics;
use tautline_core::measurement::Dataset;
use tautline_core::planning::{PlanOptions, Volume, plan as plan_poses};
use tautline_core::robot::Robot;
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate as simulate_readings};
use tautline_session::{Folders, HypothesisFolder, Session, VersionedFile};
use tautline_workflow::clock;
use tautline_workflow::diagnosis::{TIME_LIMIT_S, diagnose_dataset};
use tautline_workflow::health::{Baseline, HealthDocument, verdict_sentences};
use tautline_workflow::history::{HistoryDocument, RobotRecord, Tolerance};
use tautline_workflow::identification::{
    IdentificationRequest, identified, identify as identify_robot,
};
use tautline_workflow::isolability::IsolabilityDocument;
use tautline_workflow::machines;
use tautline_workflow::planning::PlanDocument;
use tautline_workflow::readiness::{CheckOutcome, readings_readiness};

create_exception!(
    _tautline,
    TautlineError,
    PyValueError,
    "What is wrong with the input, in the sentence that the command would say."
);

/// Lengths, wrap and swivel angles of all cables at some poses, row by row.
type Cables = (Vec<Vec<f64>>, Vec<Vec<f64>>, Vec<Vec<Option<f64>>>);

/// How tensions enter, by its name in the commands.
fn method(name: &str) -> PyResult<Method> {
    match name {
        "joint" => Ok(Method::Joint),
        "simple" => Ok(Method::Simple),
        _ => Err(TautlineError::new_err(format!(
            "method: found \"{name}\", expected \"joint\" or \"simple\""
        ))),
    }
}

fn error(error: impl std::fmt::Display) -> PyErr {
    TautlineError::new_err(error.to_string())
}

fn parsed_robot(text: &str) -> PyResult<Robot> {
    let read = tautline_session::parse_robot(text.as_bytes(), "robot").map_err(error)?;
    Ok(read.value)
}

fn parsed_dataset(robot: &str, poses: &str) -> PyResult<Dataset> {
    let robot = parsed_robot(robot)?;
    let read = tautline_session::read_poses(poses.as_bytes(), "poses", &robot).map_err(error)?;
    Ok(Dataset {
        measurements: read.value,
        robot,
    })
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

/// Names of the robots that come with the program.
#[pyfunction]
fn presets_names() -> Vec<&'static str> {
    machines::names()
}

/// A robot that comes with the program.
#[pyfunction]
fn preset(name: &str) -> PyResult<String> {
    let found = machines::find(name).ok_or_else(|| {
        let names = machines::names().join(", ");
        error(format!("found preset \"{name}\", expected one of {names}"))
    })?;
    json(&found.robot)
}

/// Checks a robot; its canonical form.
#[pyfunction]
fn checked_robot(text: &str) -> PyResult<String> {
    json(&parsed_robot(text)?)
}

#[pyfunction]
fn read_robot(path: PathBuf) -> PyResult<String> {
    json(&tautline_session::read_robot(&path).map_err(error)?.value)
}

#[pyfunction]
fn write_robot(path: PathBuf, robot: &str) -> PyResult<()> {
    tautline_session::write_robot(&path, &parsed_robot(robot)?).map_err(error)
}

/// Robot and poses of a dataset folder, and what the operator should know.
#[pyfunction]
fn read_dataset(folder: PathBuf) -> PyResult<(String, String, Vec<String>)> {
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
fn write_dataset(folder: PathBuf, robot: &str, poses: &str) -> PyResult<()> {
    let dataset = parsed_dataset(robot, poses)?;
    tautline_session::write_dataset(&folder, &dataset, &Default::default()).map_err(error)
}

/// Robot and poses of a session, without those that were excluded.
#[pyfunction]
fn read_session(path: PathBuf) -> PyResult<(String, String)> {
    let read = tautline_session::read_session(&path).map_err(error)?;
    let dataset = read.value.dataset();
    Ok((json(&dataset.robot)?, poses_text(&dataset)?))
}

/// Poses of a simulated run, and the true robot.
#[pyfunction]
fn simulate(
    py: Python<'_>,
    robot: &str,
    drawn: (usize, u64),
    effects: &str,
    how: (bool, bool),
) -> PyResult<(String, String)> {
    let ((poses, seed), (noise, nominal)) = (drawn, how);
    let robot = parsed_robot(robot)?;
    let mut bound = Vec::new();
    for setting in settings(effects)? {
        let effect = BoundEffect::from_setting(&setting, &robot).map_err(error)?;
        bound.push(effect.setting(&robot));
    }
    let options = SimulationOptions {
        geometry: if nominal {
            TrueGeometry::Nominal
        } else {
            TrueGeometry::Drawn
        },
        effects: bound,
        noise,
        ..SimulationOptions::new(poses, seed)
    };
    let run = detached(py, |_| {
        simulate_readings(&robot, &options).map_err(|e| e.to_string())
    })?;
    Ok((poses_text(&run.dataset)?, json(&run.truth)?))
}

/// Length, wrap and swivel angle of every cable at each pose.
#[pyfunction]
fn predict(robot: &str, poses: Vec<[f64; 7]>) -> PyResult<Cables> {
    let robot = parsed_robot(robot)?;
    let (mut lengths, mut wraps, mut swivels) = (Vec::new(), Vec::new(), Vec::new());
    for (row, [x, y, z, quaternion @ ..]) in poses.into_iter().enumerate() {
        let pose = Pose::from_parts([x, y, z], quaternion);
        let cables = inverse_kinematics(&robot, &pose)
            .map_err(|e| error(format!("poses, row {row}: {e}")))?;
        lengths.push(cables.iter().map(|cable| cable.length_m).collect());
        wraps.push(cables.iter().map(|cable| cable.wrap_rad).collect());
        swivels.push(cables.iter().map(|cable| cable.swivel_rad).collect());
    }
    Ok((lengths, wraps, swivels))
}

/// The result of the command `identify`, and the identified robot.
#[pyfunction]
fn identify(
    py: Python<'_>,
    dataset: (String, String),
    method_name: &str,
    effects: Vec<String>,
    huber: Option<f64>,
) -> PyResult<(String, String)> {
    let dataset = parsed_dataset(&dataset.0, &dataset.1)?;
    let method = method(method_name)?;
    let mut freed = Vec::new();
    for text in effects {
        let bound = EffectRequest::parse(&text).bind(&dataset.robot);
        let bound = bound.map_err(|e| error(format!("effects, {text}: {e}")))?;
        for effect in &bound {
            effect.check_poses(&dataset.measurements).map_err(error)?;
            freed.push(effect.setting(&dataset.robot));
        }
    }
    let mut request = IdentificationRequest::new(dataset, method, &freed).map_err(error)?;
    request.lists_readings = false;
    if let Some(limit) = huber {
        if !(limit.is_finite() && limit > 0.0) {
            return Err(error(format!(
                "huber: found {limit}, expected a positive number"
            )));
        }
        request.options.loss = Loss::Huber(limit);
    }
    let identified = detached(py, |interrupt| {
        let found = identify_robot(&request, &mut |_| interrupt.control());
        let found = found.map_err(|e| e.to_string())?;
        found.refuse_extrapolation().map_err(|e| e.to_string())
    })?;
    Ok((json(&identified.document())?, json(&identified.model)?))
}

/// The result of the command `diagnose`, and the identified robot with the effects found.
#[pyfunction]
fn diagnose(
    py: Python<'_>,
    dataset: (String, String),
    alpha: Option<f64>,
    time_limit_s: Option<f64>,
) -> PyResult<(String, String)> {
    let alpha = alpha.unwrap_or(DiagnosisOptions::default().alpha);
    let time_limit_s = time_limit_s.unwrap_or(TIME_LIMIT_S);
    if !(alpha > 0.0 && alpha < 0.5) {
        return Err(error(format!(
            "alpha: found {alpha}, expected a number above 0 and below 0.5"
        )));
    }
    if time_limit_s.is_nan() || time_limit_s <= 0.0 {
        return Err(error(format!(
            "time_limit_s: found {time_limit_s}, expected a number of seconds above 0"
        )));
    }
    let dataset = Arc::new(parsed_dataset(&dataset.0, &dataset.1)?);
    let diagnosed = detached(py, |interrupt| {
        let asked = (alpha, time_limit_s);
        let observe = &mut |_: &_| interrupt.control();
        diagnose_dataset(dataset, asked, observe).map_err(|e| e.to_string())
    })?;
    let model = identified(diagnosed.robot(), &diagnosed.diagnosis.extended_solution);
    Ok((json(&diagnosed.document())?, json(&model)?))
}

/// The result of the command `plan`.
#[pyfunction]
fn plan(
    py: Python<'_>,
    robot: &str,
    drawn: (usize, usize, u64),
    explain: bool,
) -> PyResult<String> {
    let (poses, candidates, seed) = drawn;
    let robot = parsed_robot(robot)?;
    let options = PlanOptions {
        candidates,
        ..PlanOptions::new(poses, seed)
    };
    let document = detached(py, |interrupt| {
        let planned = plan_poses(&robot, &options, &mut |_| interrupt.control());
        let planned = planned.map_err(|e| e.to_string())?;
        let mut document = PlanDocument::of(&robot, &planned);
        if explain {
            let explained = IsolabilityDocument::of_dataset(&planned.dataset);
            document.isolability = Some(explained.map_err(|e| e.to_string())?);
        }
        Ok(document)
    })?;
    json(&document)
}

/// A box from its smallest and largest coordinates.
fn volume([low_m, high_m]: [[f64; 3]; 2]) -> PyResult<Volume> {
    let is_box = |(low, high): (&f64, &f64)| low.is_finite() && high.is_finite() && low <= high;
    match low_m.iter().zip(&high_m).all(is_box) {
        true => Ok(Volume { low_m, high_m }),
        false => Err(error(format!(
            "volume_m: found {low_m:?} and {high_m:?}, expected the smallest and the largest coordinates"
        ))),
    }
}

/// The result of the command `history`, and what the operator should know.
#[pyfunction]
fn history(
    py: Python<'_>,
    folder: PathBuf,
    tolerance_m: f64,
    position_tolerance_m: Option<f64>,
    volume_m: Option<[[f64; 3]; 2]>,
) -> PyResult<(String, Vec<String>)> {
    let checked = |name: &str, value: f64| match value > 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(error(format!(
            "{name}: found {value}, expected a positive number"
        ))),
    };
    let tolerance = match position_tolerance_m {
        None if volume_m.is_some() => {
            return Err(error("volume_m: expected only with position_tolerance_m"));
        }
        None => Tolerance::Pulley(checked("tolerance_m", tolerance_m)?),
        Some(limit_m) => Tolerance::Position {
            limit_m: checked("position_tolerance_m", limit_m)?,
            volume: volume_m.map(volume).transpose()?,
        },
    };
    let (document, notices) = detached(py, |interrupt| {
        let mut observe = |_: usize, _: usize| interrupt.control();
        let record = RobotRecord::open(&folder, clock::now(), &mut observe);
        let record = record.map_err(|e| e.to_string())?;
        let found = record
            .history(&folder, tolerance)
            .map_err(|e| e.to_string())?;
        Ok((HistoryDocument::of(&record, &found), record.notices))
    })?;
    Ok((json(&document)?, notices))
}

/// The result of the command `check --against`, for a baseline in memory, and its sentences.
#[pyfunction]
fn check_health(
    py: Python<'_>,
    dataset: (String, String),
    baseline: (String, String),
) -> PyResult<(String, Vec<String>)> {
    let [dataset, baseline] =
        [dataset, baseline].map(|(robot, poses)| parsed_dataset(&robot, &poses));
    let (dataset, baseline) = (dataset?, baseline?);
    let readings = readings_readiness(&dataset, None);
    if let Some(fault) = readings
        .checks
        .iter()
        .find(|one| one.outcome == CheckOutcome::Fail)
    {
        return Err(error(&fault.sentence));
    }
    let (document, sentences) = detached(py, |_| {
        let mut session = Session::new("the baseline", baseline.robot, clock::now());
        session.measurements = baseline.measurements;
        let baseline = Baseline::new(&session, None).map_err(|e| format!("baseline: {e}"))?;
        let checked = baseline.check(&dataset, None).map_err(|e| e.to_string())?;
        let sentences = verdict_sentences(&baseline, &checked);
        Ok((HealthDocument::of(readings, &baseline, &checked), sentences))
    })?;
    Ok((json(&document)?, sentences))
}

#[pymodule]
mod _tautline {
    #[pymodule_export]
    use super::study::{
        merge_study, plan_study, read_study, report_study, run_study, study_calibrations,
        study_from_toml,
    };
    #[pymodule_export]
    use super::{
        TautlineError, check_health, checked_robot, diagnose, history, identify, plan, predict,
        preset, presets_names, read_dataset, read_robot, read_session, simulate, write_dataset,
        write_robot,
    };
    #[pymodule_export]
    const USUAL_POSES: usize = tautline_core::planning::USUAL_POSES;
    #[pymodule_export]
    #[allow(non_upper_case_globals)] // as Python calls it
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
