//! Opening, saving, closing.

use std::path::{Path, PathBuf};

use egui::ViewportCommand;
use tautline_session::Outcome::Begun;
use tautline_session::{Import, LeftBehind, Loaded, Session, import, left_behind, write_session};

use super::tables;
use crate::app::Document;
use crate::app::command::Outcome;
use crate::app::frame::Answer;
use crate::app::screen::{Screen, Step};
use crate::app::state::State;
use tautline_workflow::clock;
use tautline_workflow::samples;
use tautline_workflow::session_file::settle;

/// Title of writing a session.
const SAVING: &str = "Saving";

/// Opens, saves, closes.
#[derive(Debug, Clone)]
pub enum FileCommand {
    /// Opens a session with a simulated robot.
    TryDemo,
    /// Asks for a file to open.
    AskOpen,
    /// Opens a session, begins one with a robot or a dataset folder, or imports a table.
    Open(PathBuf),
    /// Saves; asks for a place if the session has none.
    Save,
    /// Asks for a place to save at.
    AskSaveAs,
    /// Picks that place in a dialog.
    PickSaveAs,
    /// Saves at a place.
    SaveAs(PathBuf),
    /// Closes the session.
    Close,
    /// Ends the program.
    Quit,
    /// Answers what to do about unsaved changes.
    Answer(Answer),
    /// Opens what a crash has left behind, by its place in the list.
    Recover(usize),
    /// Sets aside what a crash has left behind, by its place in the list.
    SetAside(usize),
    /// Takes a session from the list of recent ones.
    Forget(PathBuf),
}

/// What takes the open session away, and so may have to wait for an answer.
#[derive(Debug)]
pub enum Leaving {
    /// Another session is opened.
    Open(Box<Opening>),
    /// The session is closed.
    Close,
    /// The program ends.
    Quit,
}

/// A session that is to be opened.
#[derive(Debug)]
pub struct Opening {
    session: Session,
    path: Option<PathBuf>,
    is_recovered: bool,
}

/// What a file dialog is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// To open what was picked.
    Open,
    /// To save at what was picked.
    SaveAs,
}

/// What a task with files came to.
#[derive(Debug)]
pub enum FileOutcome {
    /// A file or folder was read.
    Read {
        /// Its path.
        path: PathBuf,
        /// What it is, or one sentence.
        result: Result<Loaded<Import>, String>,
    },
    /// The demonstration is ready, or one sentence.
    Demo(Result<Box<Session>, String>),
    /// What programs that ended without saving have left behind, or one sentence.
    LeftBehind(Result<Vec<LeftBehind>, String>),
    /// A session was written.
    Saved {
        /// Its file.
        path: PathBuf,
        /// Identity of the document and revision that was written.
        state: (u64, u64),
        /// Nothing, or one sentence.
        result: Result<(), String>,
    },
    /// A file dialog was closed.
    Picked {
        /// What it was for.
        purpose: Purpose,
        /// What was picked; `None` if the dialog was cancelled or is not available.
        path: Option<PathBuf>,
    },
}

pub(super) fn perform(state: &mut State, command: FileCommand) {
    match command {
        FileCommand::TryDemo => try_demo(state),
        FileCommand::AskOpen => ask(state, Purpose::Open),
        FileCommand::AskSaveAs => ask_save_as(state),
        FileCommand::PickSaveAs => ask(state, Purpose::SaveAs),
        FileCommand::Open(path) => read(state, path),
        FileCommand::Save => match state.document.as_ref().and_then(Document::path) {
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
            state.change_preferences(|preferences| preferences.forget(&path));
        }
    }
}

fn try_demo(state: &mut State) {
    let now = clock::now();
    let seed = state
        .options
        .demo_seed
        .unwrap_or(now.unix_seconds().unsigned_abs());
    state.tasks.start("Preparing the demo robot", move |_| {
        FileOutcome::Demo(
            samples::demo(seed, now)
                .map(Box::new)
                .map_err(|error| error.to_string()),
        )
        .into()
    });
}

fn ask(state: &mut State, purpose: Purpose) {
    state.tasks.start("File dialog", move |_| {
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
    let Some(document) = &state.document else {
        return;
    };
    let recent = state.preferences.recent().first();
    let path = document.path().map_or_else(
        || {
            let folder = recent.and_then(|recent| recent.path().parent());
            let name = file_name(&document.session().name);
            folder.map_or_else(|| PathBuf::from(&name), |folder| folder.join(&name))
        },
        Path::to_owned,
    );
    state.windows.save_as = Some(path.display().to_string());
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
    let into = state
        .document
        .as_ref()
        .map(|document| document.session().clone());
    let is_own = state.own_file.holds(&path);
    state.tasks.start("Opening", move |_| {
        let told = if is_own { Vec::new() } else { settle(&path) };
        let mut result = import(&path, into.as_ref()).map_err(|error| error.to_string());
        if let Ok(loaded) = &mut result {
            loaded.notices.extend(told);
        }
        FileOutcome::Read { path, result }.into()
    });
}

fn save(state: &mut State, path: PathBuf) {
    let Some(document) = &state.document else {
        return;
    };
    // A file that is being written by this window looks otherwise as well.
    if !state.tasks.runs(SAVING)
        && let Err(text) = state.own_file.check(&path)
    {
        state.windows.leaving = None;
        state.messages.error(text);
        return;
    }
    let session = document.session().clone();
    let written = (document.identity(), document.revision());
    state.tasks.start(SAVING, move |_| {
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
    if state.document.as_ref().is_some_and(Document::is_unsaved) {
        state.windows.leaving = Some(leaving);
        return;
    }
    state.windows.leaving = None;
    match leaving {
        Leaving::Open(opening) => open(state, *opening),
        Leaving::Close => {
            state.document = None;
            state.screen = Screen::Start;
        }
        Leaving::Quit => {
            state.document = None;
            state.context.send_viewport_cmd(ViewportCommand::Close);
        }
    }
}

fn answered(state: &mut State, answer: Answer) {
    match answer {
        // What was to be done is done once the file is written.
        Answer::Save => perform(state, FileCommand::Save),
        Answer::Cancel => state.windows.leaving = None,
        Answer::Discard => {
            state.document = None;
            go_on(state);
        }
    }
}

/// Does what had to wait for an answer.
fn go_on(state: &mut State) {
    if let Some(leaving) = state.windows.leaving.take() {
        leave(state, leaving);
    }
}

fn recover(state: &mut State, place: usize) {
    if place >= state.left_behind.len() || state.document.as_ref().is_some_and(Document::is_unsaved)
    {
        return;
    }
    let left = state.left_behind.remove(place);
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
            // Kept again before what was left behind is set aside.
            state.keeping.follow(state.document.as_ref());
            state.keeping.set_aside(left);
        }
        Err(error) => {
            state
                .messages
                .error(format!("{} cannot be recovered: {error}.", left.name));
            state.left_behind.insert(place, left);
        }
    }
}

fn set_aside(state: &mut State, place: usize) {
    if place < state.left_behind.len() {
        let left = state.left_behind.remove(place);
        state.keeping.set_aside(left);
    }
}

/// Looks for what programs that ended without saving have left behind; each is read whole, which may take a while.
pub fn search(state: &mut State) {
    let folder = state.folders.recovery();
    if !folder.is_dir() {
        return;
    }
    state.tasks.start("Looking for unsaved sessions", move |_| {
        let left = left_behind(&folder).map_err(|error| error.to_string());
        FileOutcome::LeftBehind(left).into()
    });
}

fn tell(state: &mut State, notices: Vec<String>) {
    for notice in notices {
        state.messages.warning(notice);
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
        | FileOutcome::LeftBehind(Err(error)) => state.messages.error(error),
        FileOutcome::LeftBehind(Ok(left)) => state.left_behind = left,
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
            state.windows.save_as = None;
            save(state, path);
        }
        FileOutcome::Picked { path: None, .. } => {
            state.messages.info("No file was chosen. If no dialog appeared, type the path or drop the file on the window.");
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
        state.windows.leaving = None;
        state.messages.error(error);
        return;
    }
    state.messages.info(format!("Saved {}.", path.display()));
    if let Some(document) = state
        .document
        .as_mut()
        .filter(|document| document.identity() == identity)
    {
        let (name, when) = (document.session().name.clone(), clock::now());
        document.saved_as(path.clone(), revision);
        state.own_file.written(identity, &path);
        state.change_preferences(|preferences| preferences.remember(&path, &name, when));
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
    state.messages.info(format!("Opened {name}."));
    let adjusted = session.adjustments().last();
    if adjusted.is_some_and(|last| last.outcome == Begun) {
        let text =
            "An adjustment of the controller was interrupted: the command adjust settles it.";
        state.messages.warning(text);
    }
    if let Some(path) = &path {
        let when = clock::now();
        state.change_preferences(|preferences| preferences.remember(path, &name, when));
    }
    let document = if is_recovered {
        Document::recovered
    } else {
        Document::new
    };
    state.document = Some(document(session, path));
    state.selection = Default::default();
    state.screen = Screen::Phase(if measured {
        Step::Identification
    } else {
        Step::Precalibration
    });
    super::model::reopened(state);
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
