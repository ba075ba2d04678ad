//! The report.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::app::clock;
use crate::app::command::Outcome;
use crate::app::state::State;
use crate::report::{ReportFormat, ReportInput, write_report};

/// Saves the report of the session.
#[derive(Debug, Clone)]
pub enum ReportCommand {
    /// Asks for a place to save at.
    AskSave(ReportFormat),
    /// Saves at a place; the end of its name says in which format.
    Save(PathBuf),
}

/// What a task with the report came to.
#[derive(Debug)]
pub enum ReportOutcome {
    /// The dialog was closed.
    Picked(Option<PathBuf>),
    /// The report was written.
    Saved {
        /// Its file.
        path: PathBuf,
        /// Nothing, or one sentence.
        result: Result<(), String>,
    },
}

pub(super) fn perform(state: &mut State, command: ReportCommand) {
    match command {
        ReportCommand::AskSave(format) => ask(state, format),
        ReportCommand::Save(path) => save(state, path),
    }
}

fn ask(state: &mut State, format: ReportFormat) {
    let Some(document) = &state.document else {
        return;
    };
    let extension = format.extension();
    let beside = document.path().and_then(Path::file_stem);
    let stem = beside.map_or_else(|| "session".into(), |stem| stem.to_string_lossy());
    let name = format!("{stem}-report.{extension}");
    state.tasks.start("File dialog", move |_| {
        let dialog = rfd::FileDialog::new().add_filter(extension.to_uppercase(), &[extension]);
        let picked = dialog.set_file_name(name).save_file();
        // A name that is typed without its end gets it.
        let whole = |path: PathBuf| match ReportFormat::of(&path) {
            Some(_) => path,
            None => {
                let mut name = path.into_os_string();
                name.push(format!(".{extension}"));
                name.into()
            }
        };
        ReportOutcome::Picked(picked.map(whole)).into()
    });
}

fn save(state: &mut State, path: PathBuf) {
    let Some(document) = &state.document else {
        return;
    };
    let session = document.session().clone();
    let fit = document.fit().map(Arc::clone);
    let diagnosis = document.diagnosis().map(Arc::clone);
    let is_current = (fit.is_none() || document.fit_is_current())
        && (diagnosis.is_none() || document.diagnosis_is_current());
    state.tasks.start("Writing the report", move |_| {
        let input = ReportInput {
            session: &session,
            fit: fit.as_deref(),
            diagnosis: diagnosis.as_deref(),
            outdated: !is_current,
            picture: None,
            now: clock::now(),
        };
        let result = write_report(&path, &input).map_err(|error| error.to_string());
        Outcome::Report(ReportOutcome::Saved { path, result })
    });
}

pub(super) fn receive(state: &mut State, outcome: ReportOutcome) {
    match outcome {
        ReportOutcome::Picked(Some(path)) => save(state, path),
        ReportOutcome::Picked(None) => state
            .messages
            .info("The report was not saved: no file was chosen."),
        ReportOutcome::Saved {
            path,
            result: Ok(()),
        } => state
            .messages
            .info(format!("Saved the report {}.", path.display())),
        ReportOutcome::Saved {
            result: Err(error), ..
        } => state.messages.error(error),
    }
}
