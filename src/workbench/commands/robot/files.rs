//! Files of phases 3 and 5.

use std::path::{Path, PathBuf};

use tautline_import::{Dialect, read_description_text};
use tautline_link::export::{differences_csv, identified_constants};
use tautline_session::{write_check, write_plan, write_text};
use tautline_workflow::exporting::dialect_text;

use crate::commands::file_dialog::pick;
use crate::commands::file_tasks::{ask_save, file_label, write as write_file, written};
use crate::model::Model;
use crate::model::command::file_choice::FileRequest;
use crate::model::command::{CorrectedFile, Export, FileCorrection, RobotCommand};
use crate::model::dialogs::SaveContent;

pub(super) fn ask(model: &mut Model, export: Export) {
    ask_save(model, SaveContent::Export(export), export.file_name());
}

pub(super) fn write(model: &mut Model, export: Export, path: PathBuf) {
    let Some(text) = content(model, export) else {
        let text = "There is nothing to write yet.".to_owned();
        return written(model, &path, Err(text));
    };
    write_file(model, "Writing a file", path, move |path| {
        write_text(path, &text)
    });
}

fn content(model: &Model, export: Export) -> Option<String> {
    let open = model.open.as_ref()?;
    let session = open.session();
    let mut bytes = Vec::new();
    match export {
        Export::Plan if session.plan.is_empty() => return None,
        Export::Plan => write_plan(&mut bytes, &session.plan).ok()?,
        Export::Check => {
            let last = session.verifications().last()?;
            write_check(&mut bytes, &last.rows).ok()?;
        }
        Export::Differences => {
            let lines = &model.review().lines;
            return (!lines.is_empty()).then(|| differences_csv(lines));
        }
        Export::StructuredText => {
            let fit = open.current_fit()?;
            return Some(identified_constants(&fit.model));
        }
    }
    String::from_utf8(bytes).ok()
}

pub(super) fn ask_firmware(model: &mut Model) {
    let request = FileRequest::file("File of a firmware or simulator", &[]);
    pick(model, request, RobotCommand::Firmware);
}

/// Replaces the values in the text of a file; the file itself stays unchanged.
pub(super) fn correct(model: &mut Model, path: &Path) {
    let open = model.open.as_ref();
    let fit = open.and_then(|open| Some((open.inputs(), open.current_fit()?.clone())));
    let Some((inputs, fit)) = fit else {
        return;
    };
    let path = path.to_owned();
    model.tasks.start("Correcting a file", move |_| {
        let file = file_label(&path);
        let corrected = || -> Result<_, String> {
            let text = read_description_text(&path).map_err(|error| error.to_string())?;
            let dialect = Dialect::of(&text).ok_or_else(|| {
                format!("{file}: found a text of another kind, expected config.g, printer.cfg, maslow.yaml, MJCF, SDF, URDF, cables of CASPR or WireX")
            })?;
            let written = dialect_text(&fit.model, Some(&fit), dialect, Some((&file, &text)));
            let written = written.map_err(|error| error.to_string())?;
            let lines = written.changed_lines(&text);
            Ok(Box::new(CorrectedFile { written, lines }))
        };
        let result = corrected();
        FileCorrection { inputs, file, result }.into()
    });
}
