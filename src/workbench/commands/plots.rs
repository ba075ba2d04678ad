//! Preparing what plots show and saving what they show.

use std::io::Cursor;

use egui::ColorImage;
use image::{ImageFormat, RgbaImage};
use tautline_session::{write_bytes, write_text};

use super::file_tasks::{pick, write};
use crate::model::command::{Format, Outcome, PlotCommand};
use crate::model::plot_preparation::Preparation;
use crate::model::{Model, UiRequest};

/// Title of the task that prepares plots.
const PREPARING: &str = "Preparing plots";
/// Title of the task that saves one.
const SAVING: &str = "Saving plot";
/// Title of the task that saves the 3D view.
const SAVING_VIEW: &str = "Saving picture";

pub(super) fn perform(model: &mut Model, command: PlotCommand) {
    match command {
        PlotCommand::Prepare => prepare(model),
        PlotCommand::Ask(format) => pick(
            model,
            move || {
                let dialog = rfd::FileDialog::new()
                    .add_filter(format.title(), &[format.ending()])
                    .set_file_name(format!("plot.{}", format.ending()));
                dialog.save_file()
            },
            PlotCommand::SetPath,
        ),
        PlotCommand::SetPath(path) => model.request(UiRequest::SetPlotPath(path)),
        PlotCommand::AskPicture(picture) => pick(
            model,
            || {
                let dialog = rfd::FileDialog::new().add_filter(Format::Png.title(), &["png"]);
                dialog.set_file_name("robot.png").save_file()
            },
            move |path| PlotCommand::SaveView(path, picture),
        ),
        PlotCommand::SaveView(path, picture) => write(model, SAVING_VIEW, path, move |path| {
            let written = write_bytes(path, &png(&picture)?);
            written.map(|()| None).map_err(|error| error.to_string())
        }),
        PlotCommand::SaveText(path, text) => write(model, SAVING, path, move |path| {
            write_text(path, &text)
                .map(|()| None)
                .map_err(|error| error.to_string())
        }),
        PlotCommand::SavePicture(path, picture) => write(model, SAVING, path, move |path| {
            let png = (picture.render)(&picture)?;
            write_bytes(path, &png)
                .map(|()| None)
                .map_err(|error| error.to_string())
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
