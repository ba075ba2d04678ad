//! Opening, saving, closing.

use std::path::{Path, PathBuf};

use egui::ViewportCommand;
use tautline_session::Outcome::Begun;
use tautline_session::{Import, Loaded, Session, find_unsaved_sessions, import, write_session};

use super::tables;
use crate::model::OpenSession;
use crate::model::command::{Answer, FileCommand, FileOutcome, Leaving, Opening, Outcome, Purpose};
use crate::model::phase::{Phase, Screen};
use crate::shell::State;
use tautline_workflow::session_file::recover_unsaved;
use tautline_workflow::{clock, samples};

/// Title of writing a session.
const SAVING: &str = "Saving";

pub(super) fn perform(state: &mut State, command: FileCommand) {
    match command {
        FileCommand::TryDemo => try_demo(state),
        FileCommand::AskOpen => ask(state, Purpose::Open),
        FileCommand::AskSaveAs => ask_save_as(state),
        FileCommand::PickSaveAs => ask(state, Purpose::SaveAs),
        FileCommand::Open(path) => read(state, path),
        FileCommand::Save => match state.model.open.as_ref().and_then(OpenSession::path) {
            Some(path) => save(state, path.to_owned()),
            None => ask_save_as(state),
        },
        FileCommand::SaveAs(path) => save(state, path),
        FileCommand::Close => leave(state, Leaving::Close),
        FileCommand::Quit => leave(state, Leaving::Quit),
        FileCommand::Answer(answer) => answered(state, answer),
        FileCommand::Recover(place) => recover(state, place),
        FileCommand::SetAside(place) => set_aside(state, place),
        FileCommand::Forget(path) => {
            state
                .model
                .change_preferences(|preferences| preferences.forget(&path));
        }
    }
}

fn try_demo(state: &mut State) {
    let now = clock::now();
    let seed = state
        .model
        .options
        .demo_seed
        .unwrap_or(now.unix_seconds().unsigned_abs());
    state
        .model
        .tasks
        .start("Preparing the demo robot", move |_| {
            FileOutcome::Demo(
                samples::demo(seed, now)
                    .map(Box::new)
                    .map_err(|error| error.to_string()),
            )
            .into()
        });
}

fn ask(state: &mut State, purpose: Purpose) {
    state.model.tasks.start("File dialog", move |_| {
        let dialog = rfd::FileDialog::new().add_filter("Tautline", &["json", "csv"]);
        let path = match purpose {
            Purpose::Open => dialog.pick_file(),
            Purpose::SaveAs => dialog.set_file_name("session.json").save_file(),
        };
        FileOutcome::Picked { purpose, path }.into()
    });
}

/// Asks where to save; its own file is suggested, or one beside the session that was open last.
fn ask_save_as(state: &mut State) {
    let Some(open) = &state.model.open else {
        return;
    };
    let recent = state.model.preferences.recent().first();
    let path = open.path().map_or_else(
        || {
            let folder = recent.and_then(|recent| recent.path().parent());
            let name = file_name(&open.session().name);
            folder.map_or_else(|| PathBuf::from(&name), |folder| folder.join(&name))
        },
        Path::to_owned,
    );
    state.model.dialogs.save_as = Some(path.display().to_string());
}

/// "MINI of 2024" as "mini-of-2024.json".
fn file_name(name: &str) -> String {
    let words = name.split(|c: char| !c.is_alphanumeric());
    let words: Vec<String> = words
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect();
    if words.is_empty() {
        "session.json".into()
    } else {
        format!("{}.json", words.join("-"))
    }
}

fn read(state: &mut State, path: PathBuf) {
    let into = state.model.open.as_ref().map(|open| open.session().clone());
    let is_own = state.model.session_lock.holds(&path);
    state.model.tasks.start("Opening", move |_| {
        let told = if is_own {
            Vec::new()
        } else {
            recover_unsaved(&path)
        };
        let mut result = import(&path, into.as_ref()).map_err(|error| error.to_string());
        if let Ok(loaded) = &mut result {
            loaded.notices.extend(told);
        }
        FileOutcome::Read { path, result }.into()
    });
}

fn save(state: &mut State, path: PathBuf) {
    let Some(open) = &state.model.open else {
        return;
    };
    // A file that is being written by this window looks otherwise as well.
    if !state.model.tasks.runs(SAVING)
        && let Err(text) = state.model.session_lock.check(&path)
    {
        state.model.dialogs.leaving = None;
        state.model.messages.error(text);
        return;
    }
    let session = open.session().clone();
    let written = (open.id(), open.revision());
    state.model.tasks.start(SAVING, move |_| {
        let result = write_session(&path, &session).map_err(|error| error.to_string());
        Outcome::File(FileOutcome::Saved {
            path,
            state: written,
            result,
        })
    });
}

/// Leaves the open session, after a question if it has unsaved changes.
fn leave(state: &mut State, leaving: Leaving) {
    if state
        .model
        .open
        .as_ref()
        .is_some_and(OpenSession::is_unsaved)
    {
        state.model.dialogs.leaving = Some(leaving);
        return;
    }
    state.model.dialogs.leaving = None;
    match leaving {
        Leaving::Open(opening) => open(state, *opening),
        Leaving::Close => {
            state.model.open = None;
            state.model.screen = Screen::Start;
        }
        Leaving::Quit => {
            state.model.open = None;
            state
                .model
                .context
                .send_viewport_cmd(ViewportCommand::Close);
        }
    }
}

fn answered(state: &mut State, answer: Answer) {
    match answer {
        // What was to be done is done once the file is written.
        Answer::Save => perform(state, FileCommand::Save),
        Answer::Cancel => state.model.dialogs.leaving = None,
        Answer::Discard => {
            state.model.open = None;
            go_on(state);
        }
    }
}

/// Does what had to wait for an answer.
fn go_on(state: &mut State) {
    if let Some(leaving) = state.model.dialogs.leaving.take() {
        leave(state, leaving);
    }
}

fn recover(state: &mut State, place: usize) {
    if place >= state.model.unsaved_sessions.len()
        || state
            .model
            .open
            .as_ref()
            .is_some_and(OpenSession::is_unsaved)
    {
        return;
    }
    let left = state.model.unsaved_sessions.remove(place);
    match left.recover() {
        Ok(Loaded { value, notices }) => {
            tell(state, notices);
            open(
                state,
                Opening {
                    session: value.session,
                    path: value.origin,
                    is_recovered: true,
                },
            );
            // AutosaveEvent again before what was left behind is set aside.
            state.model.autosave.follow(state.model.open.as_ref());
            state.model.autosave.set_aside(left);
        }
        Err(error) => {
            state
                .model
                .messages
                .error(format!("{} cannot be recovered: {error}.", left.name));
            state.model.unsaved_sessions.insert(place, left);
        }
    }
}

fn set_aside(state: &mut State, place: usize) {
    if place < state.model.unsaved_sessions.len() {
        let left = state.model.unsaved_sessions.remove(place);
        state.model.autosave.set_aside(left);
    }
}

/// Looks for what programs that ended without saving have left behind; each is read whole, which may take a while.
pub fn search(state: &mut State) {
    let folder = state.model.folders.recovery();
    if !folder.is_dir() {
        return;
    }
    state
        .model
        .tasks
        .start("Looking for unsaved sessions", move |_| {
            let left = find_unsaved_sessions(&folder).map_err(|error| error.to_string());
            FileOutcome::UnsavedSessions(left).into()
        });
}

fn tell(state: &mut State, notices: Vec<String>) {
    for notice in notices {
        state.model.messages.warning(notice);
    }
}

pub(super) fn receive(state: &mut State, outcome: FileOutcome) {
    match outcome {
        FileOutcome::Read {
            path,
            result: Ok(loaded),
        } => imported(state, path, loaded),
        FileOutcome::Demo(Ok(session)) => begin(state, *session, None),
        FileOutcome::Read {
            result: Err(error), ..
        }
        | FileOutcome::Demo(Err(error))
        | FileOutcome::UnsavedSessions(Err(error)) => state.model.messages.error(error),
        FileOutcome::UnsavedSessions(Ok(left)) => state.model.unsaved_sessions = left,
        FileOutcome::Saved {
            path,
            state: written,
            result,
        } => saved(state, path, written, result),
        FileOutcome::Picked {
            purpose: Purpose::Open,
            path: Some(path),
        } => read(state, path),
        FileOutcome::Picked {
            purpose: Purpose::SaveAs,
            path: Some(path),
        } => {
            state.model.dialogs.save_as = None;
            save(state, path);
        }
        FileOutcome::Picked { path: None, .. } => {
            state.model.messages.info("No file was chosen. If no dialog appeared, type the path or drop the file on the window.");
        }
    }
}

fn saved(
    state: &mut State,
    path: PathBuf,
    (identity, revision): (u64, u64),
    result: Result<(), String>,
) {
    if let Err(error) = result {
        state.model.dialogs.leaving = None;
        state.model.messages.error(error);
        return;
    }
    state
        .model
        .messages
        .info(format!("Saved {}.", path.display()));
    if let Some(open) = state
        .model
        .open
        .as_mut()
        .filter(|open| open.id() == identity)
    {
        let (name, when) = (open.session().name.clone(), clock::now());
        open.saved_as(path.clone(), revision);
        state.model.session_lock.written(identity, &path);
        state
            .model
            .change_preferences(|preferences| preferences.remember(&path, &name, when));
    }
    go_on(state);
}

fn imported(state: &mut State, path: PathBuf, loaded: Loaded<Import>) {
    tell(state, loaded.notices);
    let named = |path: &Path| {
        path.file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    };
    match loaded.value {
        Import::Session(session) => begin(state, *session, Some(path)),
        Import::Robot(robot) => begin(
            state,
            Session::new(robot.name.clone(), *robot, clock::now()),
            None,
        ),
        Import::Dataset(folder) => {
            tell(state, folder.notices.clone());
            let session = Session::of_dataset(named(&path), *folder, clock::now());
            begin(state, session, None);
        }
        table => tables::take(state, &named(&path), table),
    }
}

fn begin(state: &mut State, session: Session, path: Option<PathBuf>) {
    leave(
        state,
        Leaving::Open(Box::new(Opening {
            session,
            path,
            is_recovered: false,
        })),
    );
}

fn open(state: &mut State, opening: Opening) {
    let Opening {
        session,
        path,
        is_recovered,
    } = opening;
    let (name, measured) = (session.name.clone(), !session.measurements.is_empty());
    state.model.messages.info(format!("Opened {name}."));
    let adjusted = session.adjustments().last();
    if adjusted.is_some_and(|last| last.outcome == Begun) {
        let text =
            "An adjustment of the controller was interrupted: the command adjust settles it.";
        state.model.messages.warning(text);
    }
    if let Some(path) = &path {
        let when = clock::now();
        state
            .model
            .change_preferences(|preferences| preferences.remember(path, &name, when));
    }
    let open = if is_recovered {
        OpenSession::recovered
    } else {
        OpenSession::new
    };
    state.model.open = Some(open(session, path));
    state.model.selection = Default::default();
    state.model.screen = Screen::Phase(if measured {
        Phase::Identification
    } else {
        Phase::Precalibration
    });
    super::identification::reopened(state);
}

#[cfg(test)]
mod tests {
    use super::file_name;

    #[test]
    fn a_session_suggests_the_name_of_its_file() {
        assert_eq!(file_name("Demo robot"), "demo-robot.json");
        assert_eq!(file_name("MINI/2024: b"), "mini-2024-b.json");
        assert_eq!(file_name(" / "), "session.json");
    }
}
