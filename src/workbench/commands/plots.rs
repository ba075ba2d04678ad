//! Preparing what plots show and saving what they show.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::{Arc, mpsc};
use std::time::Duration;

use egui::{ColorImage, Rect};
use tautline_session::{write_bytes, write_text};

use super::file_tasks::{pick, write};
use crate::model::command::{Outcome, PlotCommand};
use crate::model::plot_preparation::Preparation;
use crate::model::{Model, UiRequest};

/// Title of the task that prepares plots.
const PREPARING: &str = "Preparing plots";
/// Title of the task that saves one.
const SAVING: &str = "Saving plot";
/// Longest time that a picture of the window may take.
const PICTURE: Duration = Duration::from_secs(10);

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
        PlotCommand::SaveText(path, text) => write(model, SAVING, path, move |path| {
            write_text(path, &text)
                .map(|()| None)
                .map_err(|error| error.to_string())
        }),
        PlotCommand::SavePicture(path, part) => picture(model, path, part),
    }
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

fn picture(model: &mut Model, path: PathBuf, part: Rect) {
    let (sender, receiver) = mpsc::channel::<Arc<ColorImage>>();
    let scale = model.context.pixels_per_point();
    model.context.request_screenshot(move |image| {
        // The task may have given up.
        let _ = sender.send(image);
    });
    write(model, SAVING, path, move |path| {
        let image = receiver
            .recv_timeout(PICTURE)
            .map_err(|_| "The window could not be captured; save as SVG instead.".to_owned())?;
        save_part(path, &image, part, scale).map(|()| None)
    });
}

/// Writes the part of a picture of the window as PNG.
fn save_part(path: &Path, image: &ColorImage, part: Rect, scale: f32) -> Result<(), String> {
    let part = image.region(&part, Some(scale));
    let [width, height] = part.size.map(|size| size as u32);
    let bytes = part
        .pixels
        .iter()
        .flat_map(|pixel| pixel.to_array())
        .collect();
    let picture = image::RgbaImage::from_raw(width, height, bytes)
        .ok_or_else(|| "The picture of the window is empty.".to_owned())?;
    let mut png = Cursor::new(Vec::new());
    picture
        .write_to(&mut png, image::ImageFormat::Png)
        .map_err(|error| error.to_string())?;
    write_bytes(path, png.get_ref()).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_the_part_at_the_scale_of_the_window() {
        let mut image = ColorImage::filled([40, 20], egui::Color32::BLACK);
        image.pixels[10 * 40 + 20] = egui::Color32::RED;
        let folder = std::env::temp_dir().join(format!("tautline-plot-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let path = folder.join("plot.png");
        let part = Rect::from_min_max(egui::pos2(10.0, 5.0), egui::pos2(15.0, 10.0));
        save_part(&path, &image, part, 2.0).expect("a picture");
        let read = image::open(&path).expect("a PNG").to_rgba8();
        assert_eq!(read.dimensions(), (10, 10));
        assert_eq!(read.get_pixel(0, 0).0, [255, 0, 0, 255]);
        std::fs::remove_dir_all(&folder).expect("removed");
    }
}
