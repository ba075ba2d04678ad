//! Screenshots for the README, rendered by the program itself without a window.

mod files;
pub mod looks;
mod stage;
mod tour;

use std::path::{Path, PathBuf};

use anyhow::Result;
use egui::ThemePreference;
use tautline_core::sequential::{FIRST_POSES, Goal};
use tautline_session::UntilSettings;
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::{
    CompareCommand, FileCommand, RecordCommand, RobotCommand, ViewCommand,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::State;

use crate::generators::sessions;
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

/// The demonstration in the middle of a run that measures until it is known what is wrong.
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
    let chosen = |state: &State| {
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
    // Slow enough to stay on its way.
    stage.give(RobotCommand::Speed(1.0));
    Ok(stage)
}

/// Sessions with something wrong, in the phase that finds it.
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
    open(&mut stage, "suspended-sag/session.json");
    stage.give(ViewCommand::Select(Selection::pose(11)));
    files::write_still(&into.join("suspended.png"), &stage.picture()?)
}

/// The same robot before and after a pulley was moved.
fn comparison(into: &Path) -> Result<()> {
    let mut stage = Stage::new(LARGE)?;
    stage.give(CompareCommand::Show);
    for run in ["before.json", "after.json"] {
        // Named as one would from the folder of the repository.
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
    stage.give(RecordCommand::SetTolerance(0.01));
    stage.give(ViewCommand::Select(Selection::cable(2)));
    files::write_still(&into.join("record.png"), &stage.picture()?)
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
