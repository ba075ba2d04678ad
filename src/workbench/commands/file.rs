//! Opening, saving and closing of sessions.

use std::path::{Path, PathBuf};

use egui::ViewportCommand;
use tautline_core::effect::EffectSetting;
use tautline_core::robot::Robot;
use tautline_session::{
    Import, Loaded, LogEntry, Phase as LogPhase, RecentSession, Session, find_unsaved_sessions,
    link_target, write_session,
};

use super::file_dialog::pick;
use super::file_tasks::{ask_save, written};
use super::{hypothesis, recording, robot, tables};
use crate::model::command::file_choice::FileRequest;
use crate::model::command::{
    Answer, Command, FileCommand, FileOutcome, Opening, Origin, Outcome, PendingAction,
    RecordCommand, RobotCommand,
};
use crate::model::dialogs::{PendingActionDraft, SaveContent};
use crate::model::edit::same_effect;
use crate::model::hypothesis::AfterHypothesis;
use crate::model::messages::Cause;
use crate::model::phase::{Phase, Screen};
use crate::model::save_form::SaveForm;
use crate::model::{Model, OpenSession, UiRequest};
use tautline_workflow::controllers::RobotKind;
use tautline_workflow::history::is_record;
use tautline_workflow::importing::{Opened, open as open_any};
use tautline_workflow::planning::missing_labels;
use tautline_workflow::plot::outline::outline;
use tautline_workflow::session_file::recover_unsaved;
use tautline_workflow::wording::{sentence, session_verdict};
use tautline_workflow::{audit, clock, samples};

const SAVING: &str = "Saving";

pub(super) fn perform(model: &mut Model, command: FileCommand) {
    match command {
        FileCommand::TryDemo => try_demo(model),
        FileCommand::New(template) => new_robot(model, template.robot(template.usual_size_m())),
        FileCommand::NewRobot(robot) => new_robot(model, *robot),
        FileCommand::AskOpen => pick(model, FileRequest::file("Open", &[]), FileCommand::Open),
        FileCommand::AskSaveAs => ask_save_as(model),
        FileCommand::BrowseSave => {
            let target = model
                .dialogs
                .save
                .as_ref()
                .and_then(|draft| draft.form.target());
            let request = FileRequest::new_file(&target.unwrap_or_default());
            pick(model, request, FileCommand::SetSavePath);
        }
        FileCommand::SetSavePath(path) => {
            if let Some(draft) = &mut model.dialogs.save {
                draft.form = SaveForm::new(&path);
            }
        }
        FileCommand::Open(path) if is_record(&path) => {
            let open = RecordCommand::Open(path);
            super::perform(model, Command::Record(open));
        }
        // A link and its target are one file, which is opened once and saved in its place.
        FileCommand::Open(path) => read(model, link_target(&path)),
        FileCommand::Save => match model.open.as_ref().and_then(OpenSession::path) {
            Some(path) => save(model, path.to_owned()),
            None => ask_save_as(model),
        },
        FileCommand::SaveAs(path) => save(model, link_target(&path)),
        FileCommand::NewSeries(repaired) => new_series(model, &repaired),
        FileCommand::OpenCorrected => open_corrected(model),
        FileCommand::Close => leave(model, PendingAction::Close),
        FileCommand::Quit if model.hypothesis.is_unsaved() => {
            hypothesis::go_on(model, AfterHypothesis::Quit);
        }
        FileCommand::Quit => leave(model, PendingAction::Quit),
        FileCommand::Answer(answer) => answered(model, answer),
        FileCommand::TakeOver(takes_over) => take_over(model, takes_over),
        FileCommand::Recover(place) => recover(model, place),
        FileCommand::Discard(place) => discard(model, place),
        FileCommand::Forget(path) => {
            model.change_preferences(|preferences| preferences.forget(&path));
        }
    }
}

fn try_demo(model: &mut Model) {
    let now = clock::now();
    let seed = model
        .options
        .demo_seed
        .unwrap_or(now.unix_seconds().unsigned_abs());
    model.tasks.start("Preparing the demo robot", move |_| {
        FileOutcome::Demo(
            samples::demo(seed, now)
                .map(Box::new)
                .map_err(|error| error.to_string()),
        )
        .into()
    });
}

/// Session with a robot that has still to be described.
fn new_robot(model: &mut Model, robot: Robot) {
    let session = Session::new(robot.name.clone(), robot, clock::now());
    go_to(model, session, None, Origin::NewRobot);
}

/// Opens another session instead of the present one.
fn go_to(model: &mut Model, session: Session, path: Option<PathBuf>, origin: Origin) {
    let opening = Opening {
        session,
        path,
        origin,
    };
    leave(model, PendingAction::Open(Box::new(opening)));
}

/// Saves the open session and begins a new series of it.
fn new_series(model: &mut Model, repaired: &[EffectSetting]) {
    let Some(open) = &model.open else {
        return;
    };
    let (session, now) = (open.session(), clock::now());
    let mut series = session.another_series(format!("{}, another series", session.name), now);
    let effects = &mut series.settings.identification.effects;
    effects.retain(|one| !repaired.iter().any(|other| same_effect(one, other)));
    let text = match repaired {
        [] => format!("Another series of {}.", session.name),
        _ => format!("Another series of {}, after a repair.", session.name),
    };
    series.record(LogEntry {
        time: now,
        phase: LogPhase::Session,
        text,
    });
    go_to(model, series, None, Origin::Series);
}

/// Saves the open session and opens a copy without the mistakes in its readings.
fn open_corrected(model: &mut Model) {
    let now = clock::now();
    let copy = |open: &OpenSession| Some(open.diagnosis()?.corrected_copy(open.session(), now));
    if let Some(copy) = model.open.as_ref().and_then(copy) {
        go_to(model, copy, None, Origin::Series);
    }
}

/// Asks for a path to save to; suggests the present file.
fn ask_save_as(model: &mut Model) {
    let Some(open) = &model.open else {
        return;
    };
    let own = open.path().and_then(Path::file_name).map(PathBuf::from);
    let name = own.unwrap_or_else(|| file_name(&open.session().name).into());
    ask_save(model, SaveContent::Session, name);
}

/// File name of a session: "MINI of 2024" becomes "mini-of-2024.tautline", which desktops open with this program.
fn file_name(name: &str) -> String {
    let words = name.split(|c: char| !c.is_alphanumeric());
    let words: Vec<String> = words
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect();
    if words.is_empty() {
        "session.tautline".into()
    } else {
        format!("{}.tautline", words.join("-"))
    }
}

fn read(model: &mut Model, path: PathBuf) {
    model.messages.resolve(Cause::Opening);
    let into = model.open.as_ref().map(|open| open.session().clone());
    let is_own = model.session_lock.holds(&path);
    model.tasks.start("Opening", move |task| {
        let recovered = if is_own {
            Vec::new()
        } else {
            recover_unsaved(&path)
        };
        let mut result = match open_any(&path, into.as_ref(), &recording::watch(task)) {
            Err(_) if task.cancelled() => Ok(None),
            Err(error) => Err(error.to_string()),
            Ok(loaded) => Ok(Some(loaded)),
        };
        if let Ok(Some(loaded)) = &mut result {
            loaded.notices.extend(recovered);
            loaded.notices.extend(broken_trail(&loaded.value));
        }
        FileOutcome::Read { path, result }.into()
    });
}

/// Problem in the audit trail of a session that was read.
fn broken_trail(opened: &Opened) -> Option<String> {
    match opened {
        Opened::Own(own) => match own.as_ref() {
            Import::Session(session) => audit::notice(session).map(|text| sentence(&text)),
            _ => None,
        },
        _ => None,
    }
}

fn save(model: &mut Model, path: PathBuf) {
    if model.open.is_none() {
        return;
    }
    // While this window writes the file, its stamp differs as well.
    if !model.tasks.runs(SAVING)
        && let Err(text) = model.session_lock.check(&path)
    {
        return written(model, &path, Err(text));
    }
    model.messages.resolve(Cause::Saving);
    seal(model);
    let Some(open) = &model.open else {
        return;
    };
    let session = open.session().clone();
    let (identity, revision) = (open.id(), open.revision());
    model.tasks.start(SAVING, move |_| {
        let result = write_session(&path, &session).map_err(|error| error.to_string());
        Outcome::File(FileOutcome::Saved {
            path,
            identity,
            revision,
            result,
        })
    });
}

/// Seals the new records of the session in an entry of its audit trail.
fn seal(model: &mut Model) {
    let Some(open) = model
        .open
        .as_mut()
        .filter(|open| !open.session().is_sealed())
    else {
        return;
    };
    let operator = &model.preferences.operator;
    open.record(|session| audit::seal(session, operator));
}

/// Leaves the open session or its controller; asks first if unsaved changes would be lost or a robot disarmed.
pub(super) fn leave(model: &mut Model, draft: impl Into<PendingActionDraft>) {
    let draft = draft.into();
    let loses = draft.action.ends_session() && model.is_unsaved();
    // The simulated robot of the session is armed again at once.
    let is_simulated = model.robot_kind() == Some(RobotKind::OfSession);
    let rearms = is_simulated
        && matches!(
            draft.action,
            PendingAction::Robot(RobotCommand::ConnectAndArm)
        );
    if loses || model.would_disarm() && !rearms && !draft.may_disarm {
        let saves = loses && draft.action.keeps_session();
        model.dialogs.pending = Some(draft);
        if saves {
            perform(model, FileCommand::Save);
        }
        return;
    }
    match draft.action {
        PendingAction::Open(opening) => open(model, *opening),
        PendingAction::Close => {
            model.open = None;
            model.importing.open = None;
            model.messages.dismiss();
            model.screen = Screen::Start;
        }
        PendingAction::Quit => {
            model.open = None;
            model.context.send_viewport_cmd(ViewportCommand::Close);
        }
        PendingAction::Robot(command) => robot::perform(model, command),
    }
}

fn answered(model: &mut Model, answer: Answer) {
    let Some(mut draft) = model.dialogs.pending.take() else {
        return;
    };
    draft.may_disarm = true;
    draft.failure = None;
    match answer {
        Answer::Cancel => {}
        // The action follows once the file is written.
        Answer::Save => {
            model.dialogs.pending = Some(draft);
            perform(model, FileCommand::Save);
        }
        Answer::Discard => {
            if draft.action.ends_session() {
                model.open = None;
            }
            leave(model, draft);
        }
    }
}

fn recover(model: &mut Model, place: usize) {
    if place >= model.unsaved_sessions.len()
        || model.open.as_ref().is_some_and(OpenSession::is_unsaved)
    {
        return;
    }
    let left = model.unsaved_sessions.remove(place);
    match left.recover() {
        Ok(Loaded { value, notices }) => {
            model.messages.warnings(notices);
            open(
                model,
                Opening {
                    session: value.session,
                    path: value.origin,
                    origin: Origin::Recovered,
                },
            );
            // Writes it to the recovery folder again before the old recovered session is discarded.
            model.autosave.follow(model.open.as_ref());
            model.autosave.discard(left);
        }
        Err(error) => {
            model.messages.failure(
                Cause::Opening,
                format!("{} cannot be recovered: {error}.", left.name),
            );
            model.unsaved_sessions.insert(place, left);
        }
    }
}

fn discard(model: &mut Model, place: usize) {
    if place < model.unsaved_sessions.len() {
        let left = model.unsaved_sessions.remove(place);
        model.autosave.discard(left);
    }
}

/// Finds unsaved sessions of programs that ended without saving, in a task, because each is read completely.
pub fn find_unsaved(model: &mut Model) {
    let folder = model.folders.recovery();
    if !folder.is_dir() {
        return;
    }
    model.tasks.start("Looking for unsaved sessions", move |_| {
        let left = find_unsaved_sessions(&folder).map_err(|error| error.to_string());
        FileOutcome::UnsavedSessions(left).into()
    });
}

pub(super) fn receive(model: &mut Model, outcome: FileOutcome) {
    match outcome {
        FileOutcome::Read {
            path,
            result: Ok(Some(loaded)),
        } => imported(model, path, loaded),
        FileOutcome::Read {
            result: Ok(None), ..
        } => model.messages.info("Opening was stopped."),
        FileOutcome::Demo(Ok(session)) => begin(model, *session, None),
        FileOutcome::Read {
            result: Err(error), ..
        }
        | FileOutcome::Demo(Err(error))
        | FileOutcome::UnsavedSessions(Err(error)) => {
            model.messages.failure(Cause::Opening, error);
        }
        FileOutcome::UnsavedSessions(Ok(left)) => model.unsaved_sessions = left,
        FileOutcome::Saved {
            path,
            identity,
            revision,
            result,
        } => saved(model, path, identity, revision, result),
    }
}

fn saved(
    model: &mut Model,
    path: PathBuf,
    identity: u64,
    revision: u64,
    result: Result<(), String>,
) {
    let is_saved = result.is_ok();
    written(model, &path, result);
    if !is_saved {
        return;
    }
    if let Some(open) = model.open.as_mut().filter(|open| open.id() == identity) {
        open.saved_as(path.clone(), revision);
        model.session_lock.written(identity, &path);
        remember(model, &path);
    }
    if let Some(draft) = model.dialogs.pending.take() {
        leave(model, draft);
    }
}

fn imported(model: &mut Model, path: PathBuf, loaded: Loaded<Opened>) {
    model.messages.warnings(loaded.notices);
    let named = |path: &Path| {
        path.file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    };
    let own = match loaded.value {
        Opened::Own(own) => *own,
        Opened::Robot(robot) => Import::Robot(robot),
        Opened::Recipe(recipe) => return recording::use_recipe(model, &named(&path), *recipe),
        Opened::Sources(sources) => return recording::take(model, sources),
    };
    match own {
        Import::Session(session) => begin(model, *session, Some(path)),
        Import::Robot(robot) => begin(
            model,
            Session::new(robot.name.clone(), *robot, clock::now()),
            None,
        ),
        Import::Dataset(folder) => {
            model.messages.warnings(folder.notices.clone());
            let session = Session::of_dataset(named(&path), *folder, clock::now());
            begin(model, session, None);
        }
        table => tables::take(model, &named(&path), table),
    }
}

pub(super) fn begin(model: &mut Model, session: Session, path: Option<PathBuf>) {
    go_to(model, session, path, Origin::Complete);
}

fn open(model: &mut Model, opening: Opening) {
    if let Some(path) = &opening.path
        && let Err(since) = model.session_lock.enter(path, false)
    {
        model.dialogs.elsewhere = Some((Box::new(opening), since));
        return;
    }
    opened(model, opening);
}

/// Takes over a session that is open in another window (`true`), opens it read-only (`false`) or not at all (`None`).
fn take_over(model: &mut Model, takes_over: Option<bool>) {
    let asked = model.dialogs.elsewhere.take();
    let Some(((opening, since), takes_over)) = asked.zip(takes_over) else {
        return;
    };
    let path = opening.path.clone().unwrap_or_default();
    match takes_over && model.session_lock.enter(&path, true).is_ok() {
        // The other window may have saved it since it was read.
        true if opening.origin != Origin::Recovered => return read(model, path),
        true => {}
        false => model.session_lock.look_only(path, since),
    }
    opened(model, *opening);
}

fn opened(model: &mut Model, opening: Opening) {
    let Opening {
        mut session,
        path,
        origin,
    } = opening;
    let is_new = origin == Origin::NewRobot;
    if path.is_none() && origin != Origin::Recovered {
        hypothesis::add_those_of_user(model, &mut session);
    }
    let first = first_phase(&session);
    // Errors of another session no longer apply.
    model.messages.dismiss();
    model.messages.info(format!("Opened {}.", session.name));
    let file = path.clone();
    let open = match origin {
        Origin::Recovered => OpenSession::recovered,
        _ => OpenSession::new,
    };
    model.open = Some(open(session, path));
    if let Some(path) = file {
        remember(model, &path);
    }
    model.selection = Default::default();
    model.inspected = None;
    model.screen = Screen::Phase(if is_new && first == Phase::Precalibration {
        Phase::Modeling
    } else {
        first
    });
    if is_new {
        model.request(UiRequest::ShowDescription);
    }
    if let Some(text) = model.unsettled() {
        model.messages.warning(text);
    }
    super::identification::reopened(model);
    recording::opened(model);
}

/// Puts the open session first in the list of recent ones.
fn remember(model: &mut Model, path: &Path) {
    let open = model.open.as_ref();
    let recent = open.and_then(|open| {
        let session = open.session();
        let mut recent = RecentSession::of(path, session, clock::now())?;
        recent.verdict = session_verdict(session);
        recent.outline = outline(&session.robot);
        Some(recent)
    });
    if let Some(recent) = recent {
        model.change_preferences(|preferences| preferences.remember(recent));
    }
}

/// First phase of a session: of the interrupted measuring run, of the identification of measured poses, or the first.
fn first_phase(session: &Session) -> Phase {
    match (
        session.measurements.is_empty(),
        missing_labels(session).next(),
    ) {
        (_, Some(_)) => Phase::Measuring,
        (true, None) => Phase::Precalibration,
        (false, None) => Phase::Identification,
    }
}

#[cfg(test)]
mod tests {
    use super::file_name;

    #[test]
    fn a_session_suggests_the_name_of_its_file() {
        assert_eq!(file_name("Demo robot"), "demo-robot.tautline");
        assert_eq!(file_name("MINI/2024: b"), "mini-2024-b.tautline");
        assert_eq!(file_name(" / "), "session.tautline");
    }
}
