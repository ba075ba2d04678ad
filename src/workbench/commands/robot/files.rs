//! Files of phases 3 and 5.

use std::path::PathBuf;

use tautline_link::export::{differences_csv, structured_text};
use tautline_session::{write_check, write_plan, write_text};

use crate::commands::file_tasks::{ask_save, write as write_file, written};
use crate::model::Model;
use crate::model::command::Export;
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
            .map(|()| None)
            .map_err(|error| error.to_string())
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
            let fit = open.fit().filter(|_| open.fit_is_current())?;
            let parameters = tautline_link::parameters::parameters_and_home_lengths(&fit.model);
            let title = format!("Identified parameters of {}", session.robot.name);
            return Some(structured_text(&title, &parameters));
        }
    }
    String::from_utf8(bytes).ok()
}
