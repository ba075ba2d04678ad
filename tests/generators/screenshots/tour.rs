//! The tour: the steps from the start to the cause of a fault, as an animation.

use std::path::Path;

use anyhow::Result;
use image::imageops::{FilterType, resize};
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::ViewCommand;
use tautline_workbench::model::phase::{Phase, Screen};

use super::files::{self, Frame};
use super::stage::{LARGE, Stage};

/// Size of its frames (pixels).
const SIZE: [u32; 2] = [864, 540];
/// Duration of a frame (tenths of a second).
const SHORT: u16 = 12;
/// Duration of a frame with much text (tenths of a second).
const LONG: u16 = 25;

/// The frames so far.
struct Film {
    stage: Stage,
    frames: Vec<Frame>,
}

impl Film {
    fn shot(&mut self, tenths: u16) -> Result<()> {
        let picture = self.stage.picture()?;
        let picture = resize(&picture, SIZE[0], SIZE[1], FilterType::CatmullRom);
        self.frames.push(Frame { picture, tenths });
        Ok(())
    }

    fn go(&mut self, step: Phase) {
        self.stage.give(ViewCommand::Go(Screen::Phase(step)));
    }

    fn select(&mut self, selection: Selection) {
        self.stage.give(ViewCommand::Select(selection));
    }
}

/// Films the tour.
///
/// # Errors
/// If there is no OpenGL, or the file cannot be written.
pub fn write(path: &Path) -> Result<()> {
    let mut film = Film {
        stage: Stage::new(LARGE)?,
        frames: Vec::new(),
    };
    film.shot(LONG)?;
    film.stage.press("Try the demo robot");
    film.shot(LONG)?;
    film.select(Selection::cable(2));
    film.shot(SHORT)?;
    film.go(Phase::Modeling);
    film.shot(LONG)?;
    measured(&mut film)?;
    identified(&mut film)?;
    adjusted(&mut film)?;
    files::write(path, &film.frames)
}

/// Phase 3: a plan, and the robot under way.
fn measured(film: &mut Film) -> Result<()> {
    film.go(Phase::Measuring);
    film.shot(SHORT)?;
    film.stage.press("Plan poses");
    film.shot(LONG)?;
    film.stage.connect_and_arm();
    film.stage.press("Start measuring");
    for poses in [6, 12, 18] {
        film.stage.wait("a measured pose", |state| {
            let document = state.model.open.as_ref();
            document.is_some_and(|document| document.session().measurements.len() >= poses)
        });
        film.shot(SHORT)?;
    }
    film.stage
        .wait("all poses", |state| !state.model.link.is_measuring());
    film.shot(SHORT)
}

/// Phase 4: from measured poses to the cause.
fn identified(film: &mut Film) -> Result<()> {
    film.go(Phase::Identification);
    film.stage.press("Identify");
    film.shot(LONG)?;
    film.stage.press("Model doctor");
    film.stage.press("Diagnose model");
    film.shot(LONG)?;
    film.stage.show("Add to model: ");
    film.shot(LONG)?;
    film.stage.press_first("Add to model: ");
    film.stage.press("Geometry");
    film.shot(LONG)
}

/// Phase 5: the identified values are written to the controller and verified.
fn adjusted(film: &mut Film) -> Result<()> {
    film.go(Phase::Adjustment);
    film.shot(LONG)?;
    film.stage.give_parameters();
    film.stage.show("Read back");
    film.shot(SHORT)?;
    verified(film, "Measure before", 1);
    film.stage.press("Write to the controller");
    film.shot(SHORT)?;
    film.stage.confirm_write("Ada");
    verified(film, "Measure after", 2);
    film.stage.show("Pose accuracy, mean:");
    film.shot(LONG)
}

fn verified(film: &mut Film, button: &str, runs: usize) {
    film.stage.press(button);
    film.stage.wait("a verification", |state| {
        let document = state.model.open.as_ref();
        document.is_some_and(|document| document.session().verifications().len() >= runs)
    });
}
