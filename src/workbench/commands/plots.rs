//! Preparing what plots show and saving what they show.

use tautline_session::{write_bytes, write_text};

use super::file_tasks::{pick, write};
use crate::model::command::{Outcome, PlotCommand};
use crate::model::plot_preparation::Preparation;
use crate::model::{Model, UiRequest};

/// Title of the task that prepares plots.
const PREPARING: &str = "Preparing plots";
/// Title of the task that saves one.
const SAVING: &str = "Saving plot";

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
        PlotCommand::SavePicture(path, picture) => write(model, SAVING, path, move |path| {
            let png = (picture.render)(&picture)?;
            write_bytes(path, &png)
                .map(|()| None)
                .map_err(|error| error.to_string())
        }),
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
