//! Opening, saving, closing.

use std::path::{Path, PathBuf};

use egui::ViewportCommand;
use tautline_session::{Loaded, Session, read_dataset, read_robot, read_session, write_session};

use crate::app::Document;
use crate::app::clock;
use crate::app::command::Outcome;
use crate::app::screen::{Screen, Step};
use crate::app::state::State;
use crate::samples;

/// Opens, saves, closes.
#[derive(Debug, Clone)]
pub enum FileCommand {
    /// Opens a session with a simulated robot.
    TryDemo,
    /// Asks for a file to open.
    AskOpen,
    /// Opens a session, or begins one with a robot or a dataset folder.
    Open(PathBuf),
    /// Saves; asks for a place if the session has none.
    Save,
    /// Asks for a place to save at.
    AskSaveAs,
    /// Saves at a place.
    SaveAs(PathBuf),
    /// Closes the session.
    Close,
    /// Ends the program.
    Quit,
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
    /// A session was read.
    Opened {
        /// Its file; none if it was made from a robot or a dataset.
        path: Option<PathBuf>,
        /// The session with notices, or one sentence.
        result: Result<Box<Loaded<Session>>, String>,
    },
    /// A session was written.
    Saved {
        /// Its file.
        path: PathBuf,
        /// Revision that was written.
        revision: u64,
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
        FileCommand::AskSaveAs => ask(state, Purpose::SaveAs),
        FileCommand::Open(path) => {
            state.tasks.start("Opening", move |_| read(&path).into());
        }
        FileCommand::Save => match state.document.as_ref().and_then(Document::path) {
            Some(path) => save(state, path.to_owned()),
            None => ask(state, Purpose::SaveAs),
        },
        FileCommand::SaveAs(path) => save(state, path),
        FileCommand::Close => {
            state.document = None;
            state.screen = Screen::Start;
        }
        FileCommand::Quit => state.context.send_viewport_cmd(ViewportCommand::Close),
    }
}

fn try_demo(state: &mut State) {
    let now = clock::now();
    let seed = state
        .options
        .demo_seed
        .unwrap_or(now.unix_seconds().unsigned_abs());
    state.tasks.start("Preparing the demo robot", move |_| {
        let session = samples::demo(seed, now).map(|value| Loaded {
            value,
            notices: Vec::new(),
        });
        let result = session.map(Box::new).map_err(|error| error.to_string());
        FileOutcome::Opened { path: None, result }.into()
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

fn read(path: &Path) -> FileOutcome {
    let named = |name: Option<&std::ffi::OsStr>| {
        name.map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    };
    if path.is_dir() {
        let result = read_dataset(path).map(|loaded| {
            let mut session =
                Session::new(named(path.file_name()), loaded.dataset.robot, clock::now());
            session.measurements = loaded.dataset.measurements;
            session.phases = loaded.phases;
            Box::new(Loaded {
                value: session,
                notices: loaded.notices,
            })
        });
        return FileOutcome::Opened {
            path: None,
            result: result.map_err(|error| error.to_string()),
        };
    }
    let session = read_session(path);
    if session.is_err()
        && let Ok(robot) = read_robot(path)
    {
        let session = Session::new(robot.value.name.clone(), robot.value, clock::now());
        return FileOutcome::Opened {
            path: None,
            result: Ok(Box::new(Loaded {
                value: session,
                notices: robot.notices,
            })),
        };
    }
    FileOutcome::Opened {
        path: Some(path.to_owned()),
        result: session.map(Box::new).map_err(|error| error.to_string()),
    }
}

fn save(state: &mut State, path: PathBuf) {
    let Some(document) = &state.document else {
        return;
    };
    let (session, revision) = (document.session().clone(), document.revision());
    state.tasks.start("Saving", move |_| {
        let result = write_session(&path, &session).map_err(|error| error.to_string());
        Outcome::File(FileOutcome::Saved {
            path,
            revision,
            result,
        })
    });
}

pub(super) fn receive(state: &mut State, outcome: FileOutcome) {
    match outcome {
        FileOutcome::Opened {
            path,
            result: Ok(loaded),
        } => open(state, *loaded, path),
        FileOutcome::Opened {
            result: Err(error), ..
        } => state.messages.error(error),
        FileOutcome::Saved {
            path,
            revision,
            result: Ok(()),
        } => {
            state.messages.info(format!("Saved {}.", path.display()));
            if let Some(document) = &mut state.document {
                document.saved_as(path, revision);
            }
        }
        FileOutcome::Saved {
            result: Err(error), ..
        } => state.messages.error(error),
        FileOutcome::Picked {
            purpose: Purpose::Open,
            path: Some(path),
        } => perform(state, FileCommand::Open(path)),
        FileOutcome::Picked {
            purpose: Purpose::SaveAs,
            path: Some(path),
        } => save(state, path),
        FileOutcome::Picked { path: None, .. } => {
            state.messages.info("No file was chosen. If no dialog appeared, type the path or drop the file on the window.");
        }
    }
}

fn open(state: &mut State, loaded: Loaded<Session>, path: Option<PathBuf>) {
    for notice in loaded.notices {
        state.messages.warning(notice);
    }
    state
        .messages
        .info(format!("Opened {}.", loaded.value.name));
    let measured = !loaded.value.measurements.is_empty();
    state.document = Some(Document::new(loaded.value, path));
    state.selection = Default::default();
    state.screen = Screen::Phase(if measured {
        Step::Identification
    } else {
        Step::Precalibration
    });
}
