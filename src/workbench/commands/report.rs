//! The report.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::file_dialog::pick;
use super::file_tasks::{write, write_with_warning};
use crate::model::command::file_choice::FileRequest;
use crate::model::command::{ReportCommand, ReportDraft, WorkshopInstrument};
use crate::model::comparison::{Compared, SessionSource};
use crate::model::phase::Screen;
use crate::model::record::OpenRecord;
use crate::model::save_form::SaveForm;
use crate::model::{Model, OpenSession};
use tautline_session::{CertificateDetails, Session};
use tautline_workflow::clock;
use tautline_workflow::history::{date, next_calibration_after};
use tautline_workflow::report::{
    ComparisonInput, HistoryInput, ReportChoice, ReportFormat, ReportInput, completed,
    write_comparison, write_history, write_report,
};

pub(super) fn perform(model: &mut Model, command: ReportCommand) {
    match command {
        ReportCommand::AskSave(format) => ask(model, format),
        ReportCommand::Browse(format) => browse(model, format),
        ReportCommand::SetPath(path) => {
            if let Some(draft) = &mut model.dialogs.report {
                draft.form = SaveForm::new(&path);
            }
        }
        ReportCommand::Cancel => model.dialogs.report = None,
        ReportCommand::Save(path) => {
            let (path, choice, pinned) = match &mut model.dialogs.report {
                Some(draft) => {
                    let path = with_extension(path, draft.format);
                    draft.form.begin(path.clone());
                    let draft = draft.clone();
                    keep_details(model, &draft);
                    (path, draft.choice, draft.pinned)
                }
                None => (path, choice(model), BTreeSet::new()),
            };
            model.change_preferences(|preferences| choice.save(preferences));
            let tolerance_m = choice.tolerance_m;
            let open = model.open.as_mut();
            if let Some(open) = open.filter(|open| open.tolerance_m() != tolerance_m) {
                open.record(|session| session.settings.tolerance_m = tolerance_m);
            }
            save(model, path, choice, pinned);
        }
    }
}

/// Suggested path of the report, in the folder of the session.
fn place(model: &Model, format: ReportFormat) -> Option<PathBuf> {
    if let Some(of) = record(model) {
        let name = of.folder.file_name().unwrap_or_default().to_string_lossy();
        let name = format!("{name}-history.{}", format.extension());
        return Some(of.folder.with_file_name(name));
    }
    if let Some(of) = compared(model) {
        let name = format!("comparison-report.{}", format.extension());
        let first = match &of.runs[0].source {
            SessionSource::File(path) => Some(path.as_path()),
            SessionSource::Open => model.open.as_ref()?.path(),
        };
        return Some(first.map_or_else(|| name.clone().into(), |path| path.with_file_name(&name)));
    }
    let path = model.open.as_ref()?.path();
    let stem = path.and_then(Path::file_stem);
    let stem = stem.map_or_else(|| "session".into(), |stem| stem.to_string_lossy());
    let name = format!("{stem}-report.{}", format.extension());
    Some(path.map_or_else(|| name.clone().into(), |path| path.with_file_name(&name)))
}

fn ask(model: &mut Model, format: ReportFormat) {
    let (details, instruments) = details(model);
    model.dialogs.report = place(model, format).map(|path| ReportDraft {
        format,
        form: SaveForm::new(&path),
        choice: choice(model),
        pinned: BTreeSet::new(),
        details,
        instruments,
    });
}

/// Statements of the certificate of the open session with those of the workshop, and the instruments to choose from.
fn details(model: &Model) -> (CertificateDetails, Vec<WorkshopInstrument>) {
    let kept = &model.preferences.report;
    let session = model.open.as_ref().map(OpenSession::session);
    let mut details = session.map_or_else(CertificateDetails::default, |session| {
        session.settings.certificate.clone()
    });
    let measured = session.and_then(Session::measured).map(date);
    for (field, known) in [
        (&mut details.laboratory, Some(&kept.laboratory)),
        (&mut details.country, Some(&kept.country)),
        (&mut details.measured_to, measured.as_ref()),
    ] {
        if let Some(known) = known.filter(|_| field.is_empty()) {
            field.clone_from(known);
        }
    }
    let used = details.instruments.iter().map(|one| (one, true));
    let others = kept.instruments.iter().map(|one| (one, false));
    let others = others.filter(|(one, _)| !details.instruments.contains(one));
    let choice = used
        .chain(others)
        .map(|(instrument, is_used)| WorkshopInstrument {
            instrument: instrument.clone(),
            is_used,
            is_edited: false,
        });
    let choice = choice.collect();
    (details, choice)
}

/// Stores the session's statements of the certificate in the session, and the workshop's in the preferences.
fn keep_details(model: &mut Model, draft: &ReportDraft) {
    let details = draft.chosen_details();
    let is_named = |one: &&WorkshopInstrument| !one.instrument.name.trim().is_empty();
    let workshop = draft.instruments.iter().filter(is_named);
    let workshop = workshop.map(|one| one.instrument.clone()).collect();
    model.change_preferences(|preferences| {
        preferences
            .report
            .laboratory
            .clone_from(&details.laboratory);
        preferences.report.country.clone_from(&details.country);
        preferences.report.instruments = workshop;
    });
    if let Some(open) = &mut model.open
        && open.session().settings.certificate != details
    {
        open.record(|session| session.settings.certificate = details);
    }
}

/// Choices of the last report, with the tolerance of the open session.
fn choice(model: &Model) -> ReportChoice {
    ReportChoice {
        tolerance_m: model.open.as_ref().and_then(OpenSession::tolerance_m),
        ..ReportChoice::of(&model.preferences)
    }
}

fn browse(model: &mut Model, format: ReportFormat) {
    let draft = model.dialogs.report.as_ref();
    let target = draft.and_then(|draft| draft.form.target());
    let request = FileRequest::new_file(&target.unwrap_or_default());
    pick(model, request, move |path| {
        ReportCommand::SetPath(with_extension(path, format))
    });
}

/// Adds the extension to a path typed without one.
fn with_extension(path: PathBuf, format: ReportFormat) -> PathBuf {
    if ReportFormat::of(&path).is_some() {
        return path;
    }
    let mut name = path.into_os_string();
    name.push(format!(".{}", format.extension()));
    name.into()
}

/// Comparison on the screen, if the report is about it.
fn compared(model: &Model) -> Option<&Arc<Compared>> {
    let result = model.comparison.result()?;
    result
        .as_ref()
        .ok()
        .filter(|_| model.screen == Screen::Compare)
}

/// Record on the screen, if the report is about it.
fn record(model: &Model) -> Option<&Arc<OpenRecord>> {
    model
        .record
        .open()
        .filter(|_| model.screen == Screen::Record)
}

fn save_history(model: &mut Model, path: PathBuf, choice: ReportChoice, of: Arc<OpenRecord>) {
    write(model, "Writing the report", path, move |path| {
        let input = HistoryInput {
            record: &of.record,
            found: &of.found,
            choice: &choice,
            now: clock::now(),
        };
        write_history(path, &input)
    });
}

fn save_comparison(model: &mut Model, path: PathBuf, choice: ReportChoice, of: Arc<Compared>) {
    write(model, "Writing the report", path, move |path| {
        let input = ComparisonInput {
            names: of.runs.each_ref().map(|run| run.name.as_str()),
            fits: of.runs.each_ref().map(|run| run.fit.as_ref()),
            is_simulated: of.runs.iter().any(|run| run.is_simulated),
            comparison: &of.comparison,
            choice: &choice,
            now: clock::now(),
        };
        write_comparison(path, &input)
    });
}

/// Date of the next calibration, if the open session belongs to the open record.
fn next_calibration(model: &Model) -> Option<String> {
    let record = model.record.open()?;
    let path = model.open.as_ref()?.path()?;
    next_calibration_after(&record.record, &record.found, path)
}

fn save(model: &mut Model, path: PathBuf, choice: ReportChoice, pinned: BTreeSet<usize>) {
    if let Some(of) = record(model).cloned() {
        return save_history(model, path, choice, of);
    }
    if let Some(of) = compared(model).cloned() {
        return save_comparison(model, path, choice, of);
    }
    let Some(open) = &model.open else {
        return;
    };
    let session = open.session().clone();
    let fit = open.fit().map(Arc::clone);
    let diagnosis = open.diagnosis().map(Arc::clone);
    let outdated = fit.is_some() && !open.fit_is_current();
    // Results that are not in memory are computed from the present data.
    let diagnosis_outdated = diagnosis.is_some() && (outdated || !open.is_model_diagnosed());
    let report_picture = model.report_picture;
    let next_calibration = next_calibration(model);
    write_with_warning(model, "Writing the report", path, move |path| {
        let (fit, diagnosis) = completed(&session, (fit, diagnosis));
        let picture = report_picture(&session, fit.as_deref(), &pinned);
        let input = ReportInput {
            session: &session,
            fit: fit.as_deref(),
            outdated,
            diagnosis: diagnosis.as_deref(),
            diagnosis_outdated,
            picture: picture.as_deref().ok(),
            next_calibration: next_calibration.as_deref(),
            monte_carlo: None,
            choice: &choice,
            now: clock::now(),
        };
        write_report(path, &input).map_err(|error| error.to_string())?;
        let without = |why| format!("The report has no picture of the robot: {why}.");
        Ok(picture.err().map(without))
    });
}
