//! Simulation, prediction, diagnosis, planning, checks and comparisons.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use tautline_core::diagnosis::DiagnosisOptions;
use tautline_core::effect::{BoundEffect, EffectSetting};
use tautline_core::geometry::Pose;
use tautline_core::kinematics::inverse_kinematics;
use tautline_core::planning::{PlanOptions, Volume, plan as plan_poses};
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate as simulate_readings};
use tautline_session::read_poses;
use tautline_workflow::clock;
use tautline_workflow::comparison::ComparisonDocument;
use tautline_workflow::comparison::{compare_identifications, identify_to_compare};
use tautline_workflow::diagnosis::diagnose_dataset;
use tautline_workflow::effects::EffectsDocument;
use tautline_workflow::health::{Baseline, HealthDocument, verdict_sentences};
use tautline_workflow::history::{HistoryDocument, RobotRecord, Tolerance};
use tautline_workflow::identification::identified;
use tautline_workflow::isolability::IsolabilityDocument;
use tautline_workflow::planning::PlanDocument;
use tautline_workflow::readiness::{self, CheckOutcome, readings_readiness};
use tautline_workflow::replay::Replay;

use crate::boundary::{
    DatasetTexts, detached, error, json, parsed_dataset, parsed_robot, poses_text, session_of,
    settings,
};

/// Lengths, wrap and swivel angles of all cables at some poses, row by row.
type Cables = (Vec<Vec<f64>>, Vec<Vec<f64>>, Vec<Vec<Option<f64>>>);

/// The effect that a text of the commands names, as JSON.
#[pyfunction]
pub fn parse_effect(text: &str) -> PyResult<String> {
    let setting = EffectSetting::parse(text);
    let setting = setting.map_err(|e| error(format!("effects, {text}: {e}")))?;
    serde_json::to_string(&setting).map_err(error)
}

/// The effects that a robot can have.
#[pyfunction]
pub fn effects(robot: &str) -> PyResult<String> {
    json(&EffectsDocument::of(&parsed_robot(robot)?))
}

/// Poses of a simulated run, and the true robot.
#[pyfunction]
pub fn simulate(
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
pub fn predict(robot: &str, poses: Vec<[f64; 7]>) -> PyResult<Cables> {
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

/// The result of the command `diagnose`, and the identified robot with the effects found.
#[pyfunction]
pub fn diagnose(
    py: Python<'_>,
    dataset: DatasetTexts,
    alpha: Option<f64>,
    time_limit_s: f64,
) -> PyResult<(String, String)> {
    let alpha = alpha.unwrap_or(DiagnosisOptions::default().alpha);
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
    let dataset = Arc::new(parsed_dataset(&dataset)?);
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
pub fn plan(
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

/// The result of the command `history`, and notices for the operator.
#[pyfunction]
pub fn history(
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
pub fn check_health(
    py: Python<'_>,
    dataset: DatasetTexts,
    baseline: DatasetTexts,
) -> PyResult<(String, Vec<String>)> {
    let (dataset, baseline) = (parsed_dataset(&dataset)?, parsed_dataset(&baseline)?);
    let readings = readings_readiness(&dataset, None);
    if let Some(fault) = readings
        .checks
        .iter()
        .find(|one| one.outcome == CheckOutcome::Fail)
    {
        return Err(error(&fault.sentence));
    }
    let (document, sentences) = detached(py, |_| {
        let session = session_of("the baseline", baseline);
        let baseline = Baseline::new(&session, None).map_err(|e| format!("baseline: {e}"))?;
        let checked = baseline.check(&dataset, None).map_err(|e| e.to_string())?;
        let sentences = verdict_sentences(&baseline, &checked);
        Ok((HealthDocument::of(readings, &baseline, &checked), sentences))
    })?;
    Ok((json(&document)?, sentences))
}

/// The result of the command `check`.
#[pyfunction]
pub fn check(py: Python<'_>, dataset: DatasetTexts) -> PyResult<String> {
    let dataset = parsed_dataset(&dataset)?;
    json(&detached(py, |_| {
        Ok(readiness::check(&dataset, None, true))
    })?)
}

/// The result of the command `compare`, second less first.
#[pyfunction]
pub fn compare(
    py: Python<'_>,
    first: DatasetTexts,
    second: DatasetTexts,
    level: f64,
) -> PyResult<String> {
    if !(level > 0.0 && level < 1.0) {
        return Err(error(format!(
            "level: found {level}, expected a probability between 0 and 1"
        )));
    }
    let sessions = [("first", first), ("second", second)].map(|(name, texts)| {
        let dataset = parsed_dataset(&texts)?;
        Ok((name, session_of(name, dataset)))
    });
    let [first, second]: [PyResult<_>; 2] = sessions;
    let sessions = [first?, second?];
    let compared = detached(py, |interrupt| {
        let mut fits = Vec::new();
        for (name, session) in &sessions {
            let fit = identify_to_compare(session, &mut |_| interrupt.control());
            fits.push(fit.map_err(|e| format!("{name}: {e}"))?);
        }
        compare_identifications([&fits[0], &fits[1]], level)
    })?;
    json(&ComparisonDocument::of(&compared))
}

/// The result of the command `replay` with an identified model.
#[pyfunction]
pub fn replay(
    py: Python<'_>,
    dataset: DatasetTexts,
    model: &str,
    simulated: &str,
) -> PyResult<String> {
    let (dataset, model) = (parsed_dataset(&dataset)?, parsed_robot(model)?);
    let simulated = read_poses(simulated.as_bytes(), "simulated", &dataset.robot);
    let simulated = simulated.map_err(error)?.value;
    let replay = detached(py, |_| {
        Replay::new(&dataset, &model, &simulated).map_err(|e| format!("simulated: {e}"))
    })?;
    json(&replay.document())
}
