//! The report.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::model::command::{Outcome, ReportCommand, ReportDraft, ReportOutcome};
use crate::shell::State;
use crate::views::report_picture::report_picture;
use tautline_workflow::clock;
use tautline_workflow::report::{ReportChoice, ReportFormat, ReportInput, write_report};

pub(super) fn perform(state: &mut State, command: ReportCommand) {
    match command {
        ReportCommand::AskSave(format) => ask(state, format),
        ReportCommand::Browse(format) => browse(state, format),
        ReportCommand::Cancel => state.model.dialogs.report = None,
        ReportCommand::Save(path) => {
            let saving = state.model.dialogs.report.take();
            let (path, choice) = match saving {
                Some(saving) => (whole(path, saving.format), saving.choice),
                None => (path, ReportChoice::of(&state.model.preferences)),
            };
            state
                .model
                .change_preferences(|preferences| choice.save(preferences));
            save(state, path, choice);
        }
    }
}

/// Where the report belongs: beside the session.
fn place(state: &State, format: ReportFormat) -> Option<PathBuf> {
    let path = state.model.open.as_ref()?.path();
    let stem = path.and_then(Path::file_stem);
    let stem = stem.map_or_else(|| "session".into(), |stem| stem.to_string_lossy());
    let name = format!("{stem}-report.{}", format.extension());
    Some(path.map_or_else(|| name.clone().into(), |path| path.with_file_name(&name)))
}

fn ask(state: &mut State, format: ReportFormat) {
    state.model.dialogs.report = place(state, format).map(|path| ReportDraft {
        format,
        path: path.display().to_string(),
        choice: ReportChoice::of(&state.model.preferences),
    });
}

fn browse(state: &mut State, format: ReportFormat) {
    let Some(place) = place(state, format) else {
        return;
    };
    let name = place
        .file_name()
        .map(|name| name.to_string_lossy().into_owned());
    let extension = format.extension();
    state.model.tasks.start("File dialog", move |_| {
        let dialog = rfd::FileDialog::new().add_filter(extension.to_uppercase(), &[extension]);
        let picked = dialog.set_file_name(name.unwrap_or_default()).save_file();
        ReportOutcome::Picked(picked.map(|path| whole(path, format))).into()
    });
}

/// A name that is typed without its end gets it.
fn whole(path: PathBuf, format: ReportFormat) -> PathBuf {
    if ReportFormat::of(&path).is_some() {
        return path;
    }
    let mut name = path.into_os_string();
    name.push(format!(".{}", format.extension()));
    name.into()
}

fn save(state: &mut State, path: PathBuf, choice: ReportChoice) {
    let Some(open) = &state.model.open else {
        return;
    };
    let session = open.session().clone();
    let fit = open.fit().map(Arc::clone);
    let diagnosis = open.diagnosis().map(Arc::clone);
    let is_current = (fit.is_none() || open.fit_is_current())
        && (diagnosis.is_none() || open.diagnosis_is_current());
    let options = &state.views.robot_3d.options;
    let pinned = if options.callouts {
        options.pinned.clone()
    } else {
        Default::default()
    };
    state.model.tasks.start("Writing the report", move |_| {
        let picture = report_picture(&session, fit.as_deref(), &pinned);
        let input = ReportInput {
            session: &session,
            fit: fit.as_deref(),
            diagnosis: diagnosis.as_deref(),
            outdated: !is_current,
            picture: picture.as_deref().ok(),
            choice: &choice,
            now: clock::now(),
        };
        let result = write_report(&path, &input).map_err(|error| error.to_string());
        Outcome::Report(ReportOutcome::Saved {
            path,
            result,
            lack: picture.err(),
        })
    });
}

pub(super) fn receive(state: &mut State, outcome: ReportOutcome) {
    match outcome {
        ReportOutcome::Picked(Some(path)) => match &mut state.model.dialogs.report {
            Some(saving) => saving.path = path.display().to_string(),
            None => save(state, path, ReportChoice::of(&state.model.preferences)),
        },
        ReportOutcome::Picked(None) => state
            .model
            .messages
            .info("No file was chosen. If no dialog appeared, type the path."),
        ReportOutcome::Saved {
            result: Err(error), ..
        } => state.model.messages.error(error),
        ReportOutcome::Saved { path, lack, .. } => {
            if let Some(lack) = lack {
                state
                    .model
                    .messages
                    .warning(format!("The report has no picture of the robot: {lack}."));
            }
            state
                .model
                .messages
                .info(format!("Saved the report {}.", path.display()));
        }
    }
}
