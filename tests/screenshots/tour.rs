//! The tour: what one does from the start to the cause of a fault, as an animation.

use std::path::Path;

use anyhow::Result;
use image::imageops::{FilterType, resize};
use tautline_workbench::app::Selection;
use tautline_workbench::app::commands::{FileCommand, ViewCommand};
use tautline_workbench::app::screen::{Screen, Step};

use super::files::{self, Frame};
use super::stage::{LARGE, Stage};
use crate::sessions;

/// Size of its frames (pixels).
const SIZE: [u32; 2] = [864, 540];
/// How long a frame is shown (tenths of a second).
const SHORT: u16 = 12;
/// How long one is shown on which there is much to read.
const LONG: u16 = 25;

/// What was filmed so far.
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

    fn go(&mut self, step: Step) {
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
    film.go(Step::Modeling);
    film.shot(LONG)?;
    identified(&mut film)?;
    files::write(path, &film.frames)
}

/// The phase that everything is about: from measured poses to the cause.
fn identified(film: &mut Film) -> Result<()> {
    let session = sessions::folder().join(super::SESSION);
    film.stage.give(FileCommand::Open(session));
    film.stage.press("Do not save");
    film.shot(LONG)?;
    film.select(Selection {
        cable: Some(2),
        pose: Some(17),
    });
    film.shot(SHORT)?;
    film.stage.press("Model doctor");
    film.shot(LONG)?;
    film.stage.press("Add to model: Winch scale (cable-3)");
    film.shot(LONG)?;
    film.stage.press("Geometry");
    film.shot(LONG)
}
