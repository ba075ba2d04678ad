//! Preparation and saving of plots.

use std::io::Cursor;

use egui::ColorImage;
use image::{ImageFormat, RgbaImage};
use tautline_session::{write_bytes, write_text};

use super::file_tasks::{ask_save, write};
use crate::model::Model;
use crate::model::command::{Outcome, PlotCommand, PlotFile};
use crate::model::dialogs::SaveContent;
use crate::model::plot_preparation::Preparation;

/// Title of the task that prepares plots.
const PREPARING: &str = "Preparing plots";
/// Title of the task that saves a plot.
const SAVING: &str = "Saving plot";

pub(super) fn perform(model: &mut Model, command: PlotCommand) {
    match command {
        PlotCommand::Prepare => prepare(model),
        PlotCommand::AskSave(name, file) => ask_save(model, SaveContent::Plot(file), name),
        PlotCommand::Save(path, file) => write(model, SAVING, path, move |path| {
            let written = match file {
                PlotFile::Text(text) => write_text(path, &text),
                PlotFile::Screenshot(picture) => write_bytes(path, &png(&picture)?),
                PlotFile::Picture(picture) => write_bytes(path, &(picture.render)(&picture)?),
            };
            written.map_err(|error| error.to_string())
        }),
    }
}

fn png(picture: &ColorImage) -> Result<Vec<u8>, String> {
    let [width, height] = picture.size.map(|side| side as u32);
    let pixels = picture.as_raw().to_vec();
    let picture = RgbaImage::from_raw(width, height, pixels)
        .ok_or("the picture has another size than its pixels")?;
    let mut png = Cursor::new(Vec::new());
    let written = picture.write_to(&mut png, ImageFormat::Png);
    written.map_err(|error| error.to_string())?;
    Ok(png.into_inner())
}

fn prepare(model: &mut Model) {
    if model.tasks.runs(PREPARING) {
        return;
    }
    let Some(open) = &model.open else {
        return;
    };
    let (fit, diagnosed) = (open.fit().cloned(), open.diagnosis().cloned());
    model.tasks.start(PREPARING, move |task| {
        let prepared = Preparation::new(fit, diagnosed, &|| task.cancelled());
        Outcome::Prepared(Box::new(prepared))
    });
}
