//! Preparing what plots show and saving what they show.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::{Arc, mpsc};
use std::time::Duration;

use egui::{ColorImage, Rect};
use tautline_session::{write_bytes, write_text};

use crate::model::command::{Outcome, PlotCommand, PlotOutcome};
use crate::model::plot_preparation::Preparation;
use crate::shell::State;

/// Title of the task that prepares plots.
const PREPARING: &str = "Preparing plots";
/// Longest time that a picture of the window may take.
const PICTURE: Duration = Duration::from_secs(10);

pub(super) fn perform(state: &mut State, command: PlotCommand) {
    match command {
        PlotCommand::Prepare => prepare(state),
        PlotCommand::Ask(format) => state.model.tasks.start("File dialog", move |_| {
            let dialog = rfd::FileDialog::new()
                .add_filter(format.title(), &[format.ending()])
                .set_file_name(format!("plot.{}", format.ending()));
            PlotOutcome::Picked(dialog.save_file()).into()
        }),
        PlotCommand::SaveText(path, text) => {
            state.model.tasks.start("Saving plot", move |_| {
                let result = write_text(&path, &text).map_err(|error| error.to_string());
                PlotOutcome::Saved(result.map(|()| path)).into()
            });
        }
        PlotCommand::SavePicture(path, part) => picture(state, path, part),
    }
}

fn prepare(state: &mut State) {
    if state.model.tasks.runs(PREPARING) {
        return;
    }
    let Some(open) = &state.model.open else {
        return;
    };
    let (fit, diagnosed) = (open.fit().cloned(), open.diagnosis().cloned());
    state.model.tasks.start(PREPARING, move |task| {
        let prepared = Preparation::new(fit, diagnosed, &|| task.cancelled());
        PlotOutcome::Prepared(Box::new(prepared)).into()
    });
}

fn picture(state: &mut State, path: PathBuf, part: Rect) {
    let (sender, receiver) = mpsc::channel::<Arc<ColorImage>>();
    let scale = state.model.context.pixels_per_point();
    state.model.context.request_screenshot(move |image| {
        // The task may have given up.
        let _ = sender.send(image);
    });
    state.model.tasks.start("Saving plot", move |_| {
        let result = match receiver.recv_timeout(PICTURE) {
            Ok(image) => save_part(&path, &image, part, scale),
            Err(_) => Err("The window gave no picture of itself; save as SVG instead.".to_owned()),
        };
        Outcome::Plot(PlotOutcome::Saved(result.map(|()| path)))
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

pub(super) fn receive(state: &mut State, outcome: PlotOutcome) {
    match outcome {
        PlotOutcome::Prepared(preparation) => state.views.plots.prepared(&preparation),
        PlotOutcome::Picked(Some(path)) => state.views.plots.picked(&path),
        PlotOutcome::Picked(None) => {
            state
                .model
                .messages
                .info("No file was chosen. If no dialog appeared, type the path.");
        }
        PlotOutcome::Saved(Ok(path)) => state
            .model
            .messages
            .info(format!("Saved {}.", path.display())),
        PlotOutcome::Saved(Err(error)) => state.model.messages.error(error),
    }
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
