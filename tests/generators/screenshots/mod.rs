//! Screenshots for the README, rendered by the program itself without a window.

mod files;
pub mod looks;
mod stage;
mod tour;

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use egui::ThemePreference;
use tautline_core::effect::{EffectSetting, Hypothesis};
use tautline_core::measurement::Dataset;
use tautline_core::robot::presets;
use tautline_core::sequential::{FIRST_POSES, Goal};
use tautline_core::simulation::{SimulationOptions, simulate};
use tautline_session::{PhaseData, UntilSettings, write_dataset};
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::{
    CompareCommand, FileCommand, HypothesisCommand, IdentificationCommand, RecordCommand,
    RobotCommand, ViewCommand,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::AppState;
use tautline_workflow::history::Tolerance;

use crate::generators::{hypotheses, sessions};
use stage::{LARGE, SMALL, Stage};

/// The folder of the pictures.
#[must_use]
pub fn folder() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../screenshots"))
}

/// A session with one fault, which the diagnosis names.
const SESSION: &str = "mini-winch-scale/session.json";

/// Takes all pictures.
///
/// # Errors
/// If there is no OpenGL, or a file cannot be written.
pub fn write_all(into: &Path) -> Result<()> {
    std::fs::create_dir_all(into)?;
    let into = into.canonicalize()?;
    // The start screen looks for the sample sessions where the program was started.
    std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
    phases(&into)?;
    files::write_still(&into.join("until.png"), &until()?.picture()?)?;
    causes(&into)?;
    comparison(&into)?;
    record(&into)?;
    hypothesis_screens(&into)?;
    small_and_light(&into)?;
    tour::write(&into.join("tour.png"))
}

fn phases(into: &Path) -> Result<()> {
    let mut stage = Stage::new(LARGE)?;
    files::write_still(&into.join("start.png"), &stage.picture()?)?;
    open(&mut stage, "clean-mini/session.json");
    phase(&mut stage, Phase::Precalibration);
    stage.give(ViewCommand::Select(Selection::cable(5)));
    files::write_still(&into.join("phase-1.png"), &stage.picture()?)?;
    phase(&mut stage, Phase::Modeling);
    files::write_still(&into.join("phase-2.png"), &stage.picture()?)?;
    phase(&mut stage, Phase::Measuring);
    stage.give(ViewCommand::Select(Selection::pose(17)));
    files::write_still(&into.join("phase-3.png"), &stage.picture()?)?;
    stage.connect_and_arm();
    phase(&mut stage, Phase::Adjustment);
    files::write_still(&into.join("phase-5.png"), &stage.picture()?)
}

fn phase(stage: &mut Stage, step: Phase) {
    stage.give(ViewCommand::Go(Screen::Phase(step)));
}

/// The demonstration in the middle of a run that measures until the cause is certain.
fn until() -> Result<Stage> {
    let mut stage = Stage::new(LARGE)?;
    stage.press("Try the demo robot");
    phase(&mut stage, Phase::Measuring);
    stage.give(Edit::SetUntil(UntilSettings {
        enabled: true,
        goals: vec![Goal::Cause(0.95), Goal::Accuracy(3e-3)],
        ..UntilSettings::default()
    }));
    stage.connect_and_arm();
    stage.press("Start measuring");
    let chosen = |state: &AppState| {
        let run = state
            .model
            .link
            .run
            .as_ref()
            .filter(|run| run.current.is_some());
        let until = run.and_then(|run| run.until.as_ref());
        until.map_or(0, |until| until.poses().len())
    };
    stage.wait("a decision", |state| chosen(state) > FIRST_POSES + 2);
    // Slow enough to be still on its way.
    stage.give(RobotCommand::Speed(1.0));
    Ok(stage)
}

/// Sessions with a fault, in the phase that finds it.
fn causes(into: &Path) -> Result<()> {
    let mut stage = Stage::new(LARGE)?;
    open(&mut stage, SESSION);
    stage.give(ViewCommand::Select(Selection {
        cable: Some(2),
        pose: Some(17),
    }));
    files::write_still(&into.join("phase-4.png"), &stage.picture()?)?;
    stage.press("Model doctor");
    stage.show("Add to model: ");
    files::write_still(&into.join("doctor.png"), &stage.picture()?)?;
    open(&mut stage, "hall-creep-and-slip/session.json");
    stage.press("Model doctor");
    stage.give(ViewCommand::Select(Selection::cable(5)));
    stage.show("Cable 6 slipped");
    files::write_still(&into.join("doctor-hall.png"), &stage.picture()?)?;
    open(&mut stage, "tracker-touched/session.json");
    stage.press("Model doctor");
    stage.give(ViewCommand::Select(Selection::pose(24)));
    stage.show("The external instrument was moved");
    files::write_still(&into.join("doctor-tracker.png"), &stage.picture()?)?;
    open(&mut stage, "suspended-sag/session.json");
    stage.give(ViewCommand::Select(Selection::pose(11)));
    files::write_still(&into.join("suspended.png"), &stage.picture()?)
}

/// The same robot before and after a pulley was moved.
fn comparison(into: &Path) -> Result<()> {
    let mut stage = Stage::new(LARGE)?;
    stage.give(CompareCommand::Show);
    for run in ["before.json", "after.json"] {
        // Path relative to the folder of the repository.
        let path = Path::new("sessions/before-after").join(run);
        stage.give(CompareCommand::Drop(path));
    }
    stage.give(ViewCommand::Select(Selection::cable(5)));
    files::write_still(&into.join("compare.png"), &stage.picture()?)
}

/// The sessions of a robot over a year.
fn record(into: &Path) -> Result<()> {
    let mut stage = Stage::new(LARGE)?;
    stage.give(RecordCommand::Open(PathBuf::from("sessions/year-of-mini")));
    stage.give(RecordCommand::SetTolerance(Tolerance::Pulley(0.01)));
    stage.give(ViewCommand::Select(Selection::cable(2)));
    files::write_still(&into.join("record.png"), &stage.picture()?)
}

/// A hypothesis with its residuals, and the gallery of effects.
fn hypothesis_screens(into: &Path) -> Result<()> {
    let mut stage = Stage::new(LARGE)?;
    written(&mut stage)?;
    files::write_still(&into.join("hypothesis.png"), &stage.picture()?)?;
    stage.give(ViewCommand::Go(Screen::Gallery));
    stage.settle();
    stage.press_first("Effect: Drum out of round");
    files::write_still(&into.join("gallery.png"), &stage.picture()?)
}

/// The hypothesis of the documentation, typed for data that have its effect.
pub(crate) fn written(stage: &mut Stage) -> Result<()> {
    let page = std::fs::read_to_string(hypotheses::page())?;
    let Some((_, text)) = hypotheses::files(&page).into_iter().next() else {
        bail!("the page has no hypothesis");
    };
    let hypothesis = Hypothesis::parse(&text)?;
    let Some(preset) = presets::find("mini") else {
        bail!("there is no robot");
    };
    let mut truth = preset.robot.clone();
    truth.add_hypothesis(&hypothesis)?;
    truth.effects.push(EffectSetting {
        effect: hypothesis.id().to_owned(),
        targets: vec!["cable-3".into()],
        parameters: [("share".to_owned(), 0.01)].into(),
    });
    let run = simulate(&truth, &SimulationOptions::new(40, 4))?;
    let dataset = Dataset {
        robot: preset.robot,
        measurements: run.dataset.measurements,
    };
    let folder = tempfile::tempdir()?;
    let data = folder.path().join("mini");
    write_dataset(&data, &dataset, &PhaseData::default())?;
    stage.give(FileCommand::Open(data));
    stage.give(IdentificationCommand::Identify);
    stage.give(HypothesisCommand::Show);
    stage.give(HypothesisCommand::SetText(text));
    stage.settle();
    Ok(())
}

fn small_and_light(into: &Path) -> Result<()> {
    let mut stage = Stage::new(LARGE)?;
    stage.give(ViewCommand::Theme(ThemePreference::Light));
    open(&mut stage, SESSION);
    files::write_still(&into.join("light.png"), &stage.picture()?)?;
    let mut stage = Stage::new(SMALL)?;
    open(&mut stage, SESSION);
    stage.press("Model doctor");
    files::write_still(&into.join("small.png"), &stage.picture()?)
}

fn open(stage: &mut Stage, session: &str) {
    stage.give(FileCommand::Open(sessions::folder().join(session)));
}
