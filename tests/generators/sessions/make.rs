//! Makes a sample session: a virtual robot is measured, identified and diagnosed as the workbench would.

use anyhow::{Context, Result};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tautline_core::diagnosis::{DiagnosisOptions, diagnose};
use tautline_core::effect::EffectSetting;
use tautline_core::estimation::Control;
use tautline_core::robot::{PartTolerances, PerAxis, Robot, Tracker, presets};
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_session::{
    LogEntry, Phase, ResultDocument, Session, Simulator, Timestamp, VersionedFile,
};
use tautline_workbench::model::open_session::Diagnosed;
use tautline_workflow::diagnosis::TIME_LIMIT_S;
use tautline_workflow::identification::{Identification, IdentificationRequest, identify};
use tautline_workflow::results;
use tautline_workflow::samples::tables::{bench, home_platform};

use super::recipes::{Hidden, Recipe};
use super::rounding;

/// Time from the beginning of a session to its poses, its identification and its diagnosis (s).
const POSES_AFTER_S: i64 = 5400;
const IDENTIFIED_AFTER_S: i64 = 6000;
const DIAGNOSED_AFTER_S: i64 = 6060;

/// A sample session with its results.
pub struct Made {
    /// The session.
    pub session: Session,
    /// Its identification.
    pub fit: Identification,
    /// Its diagnosis, where its recipe has one.
    pub diagnosed: Option<Diagnosed>,
}

/// Makes a sample session; the same one every time.
///
/// # Errors
/// If the robot of the recipe is impossible.
pub fn make(recipe: &Recipe) -> Result<Made> {
    let mut session = measured(recipe)?;
    let request = IdentificationRequest::of_session(&session)?;
    let mut fit = identify(&request, &mut |_| Control::Continue)?;
    // Zero, because a measured time would change the file each time.
    fit.seconds = 0.0;
    let document = fit.document();
    let poses = session.measurements.len();
    let said = format!("Identified from {poses} poses.");
    let time = after(&session, IDENTIFIED_AFTER_S);
    keep(&mut session, "Identification", &document, time);
    log(&mut session, time, Phase::Identification, said);
    let diagnosed = match recipe.is_diagnosed {
        true => Some(diagnosed(&mut session)?),
        false => None,
    };
    Ok(Made {
        session,
        fit,
        diagnosed,
    })
}

fn measured(recipe: &Recipe) -> Result<Session> {
    let begun: Timestamp = recipe.begun.parse()?;
    let preset = presets::find(recipe.preset).context("a preset of this name")?;
    let mut drawing = preset.robot.clone();
    drawing.tolerances = Some(PartTolerances::typical());
    drawing.tracker = recipe.is_tracked.then_some(Tracker {
        position_sd_m: PerAxis::Same(2e-4),
        orientation_sd_rad: Some(1e-3),
    });
    if !recipe.cable_weight_is_stated {
        for cable in &mut drawing.cables {
            cable.cable.weight_n_per_m = 0.0;
        }
    }
    let options = SimulationOptions {
        geometry: (preset.measured_entry_points_m.clone())
            .map_or(TrueGeometry::Drawn, TrueGeometry::EntryPoints),
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(1, recipe.robot_seed)
    };
    let mut truth = rounding::truth(&simulate(&drawing, &options)?.truth);
    if let Some(moved) = recipe.moved {
        let entry = &mut truth.cables[moved.cable].pulley.entry_point_m;
        *entry = [0, 1, 2].map(|axis| entry[axis] + moved.by_m[axis]);
    }
    let options = SimulationOptions {
        poses: recipe.poses,
        seed: recipe.seed,
        geometry: TrueGeometry::Nominal,
        effects: recipe.hidden.iter().map(setting).collect(),
        ..options
    };
    let run = simulate(&truth, &options)?;
    let truth = run.truth;
    let mut rng = ChaCha8Rng::seed_from_u64(recipe.seed);
    if recipe.has_bench {
        drawing.home_platform = Some(home_platform());
    }
    let mut session = Session::new(recipe.name, drawing, begun);
    if recipe.knows_hidden {
        session.settings.identification.effects = recipe.hidden.iter().map(setting).collect();
    }
    session.measurements = rounding::readings(&run.dataset.measurements);
    // The home pose was commanded according to the drawing, too.
    if let (Some(home), Some(commanded)) = (
        &session.robot.home,
        session.measurements.commanded.first_mut(),
    ) {
        *commanded = Some(home.pose());
    }
    measure_on_bench(&mut session, recipe, &truth, &mut rng);
    session.simulator = Some(Simulator {
        truth,
        seed: recipe.seed,
        revealed: false,
    });
    let poses = session.measurements.len();
    let time = after(&session, POSES_AFTER_S);
    let said = format!("Measured {poses} poses, the home pose included.");
    log(&mut session, time, Phase::Poses, said);
    Ok(session)
}

fn measure_on_bench(session: &mut Session, recipe: &Recipe, truth: &Robot, rng: &mut ChaCha8Rng) {
    let Some(home) = truth.home.as_ref().filter(|_| recipe.has_bench) else {
        return;
    };
    let mut phases = rounding::tables(bench(
        &session.robot,
        (&truth.deviations, &home.pose()),
        rng,
    ));
    if !recipe.has_winch_bench {
        phases.winch.clear();
    }
    session.phases = phases;
    let time = session.created;
    let said = match recipe.has_winch_bench {
        true => {
            "Measured winches, force sensors, the home platform and the elongation of the cable."
        }
        false => {
            "Measured force sensors, the home platform and the elongation of the cable; the winches were left out."
        }
    };
    log(session, time, Phase::Instruments, said.to_owned());
}

fn diagnosed(session: &mut Session) -> Result<Diagnosed> {
    let alpha = session.settings.diagnosis.alpha;
    let options = DiagnosisOptions {
        alpha,
        ..DiagnosisOptions::default()
    };
    let dataset = session.dataset();
    let diagnosis = diagnose(&dataset, &options, &mut |_| Control::Continue)?;
    let diagnosed = Diagnosed {
        mistakes: Vec::new(),
        measured: dataset.measurements.len(),
        dataset: dataset.into(),
        diagnosis,
        alpha,
        seconds: 0.0,
        limit_s: TIME_LIMIT_S,
        ended_at_limit: false,
    };
    let time = after(session, DIAGNOSED_AFTER_S);
    keep(session, "Diagnosis", &diagnosed.document(), time);
    let said = match diagnosed.diagnosis.findings.len() {
        1 => "Diagnosed: 1 finding.".to_owned(),
        findings => format!("Diagnosed: {findings} findings."),
    };
    log(session, time, Phase::Diagnosis, said);
    Ok(diagnosed)
}

fn keep<D: VersionedFile>(session: &mut Session, title: &str, document: &D, time: Timestamp) {
    let mut record = results::record(session, title, document, time);
    let mut value = record.document.value();
    rounding::result(&mut value);
    // The value was made from the document.
    record.document = ResultDocument::of(&value).unwrap_or_default();
    session.add_result(record);
}

fn setting((effect, cable, values): &Hidden) -> EffectSetting {
    EffectSetting {
        effect: (*effect).to_owned(),
        targets: cable.iter().map(|name| (*name).to_owned()).collect(),
        parameters: values.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect(),
    }
}

fn after(session: &Session, seconds: i64) -> Timestamp {
    Timestamp::from_unix_seconds(session.created.unix_seconds() + seconds)
}

fn log(session: &mut Session, time: Timestamp, phase: Phase, text: String) {
    session.record(LogEntry { time, phase, text });
}
