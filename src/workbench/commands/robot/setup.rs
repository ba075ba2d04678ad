//! The window that connects: its files, and looking symbols up.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tautline_link::SystemClock;
use tautline_link::ads::{AdsAddress, AdsOptions, check_symbols};
use tautline_session::{AdsMapping, AdsPlace, read_versioned, write_versioned};

use crate::model::command::{CHECKING, Outcome, RobotOutcome, Setup, SetupOutcome};
use crate::screens::connect::Draft;
use crate::shell::State;

fn start(state: &mut State, title: &str, work: impl FnOnce() -> SetupOutcome + Send + 'static) {
    state
        .model
        .tasks
        .start(title, move |_| Outcome::Robot(RobotOutcome::Setup(work())));
}

pub(super) fn perform(state: &mut State, setup: Setup) {
    match setup {
        Setup::Open => open(state),
        Setup::Close => state.panels.connect = None,
        Setup::PickRecording => start(state, "File dialog", || {
            SetupOutcome::Recording(rfd::FileDialog::new().pick_folder())
        }),
        Setup::Check(what) => check(state, *what),
        Setup::AskImport => start(state, "File dialog", || {
            let dialog = rfd::FileDialog::new().add_filter("Names of symbols", &["json"]);
            let path = dialog.pick_file();
            path.map_or(SetupOutcome::NoFile, |path| {
                SetupOutcome::Imported(read(&path))
            })
        }),
        Setup::Import(path) => start(state, "Reading names of symbols", move || {
            SetupOutcome::Imported(read(&path))
        }),
        Setup::AskExport(mapping) => start(state, "File dialog", move || {
            let dialog = rfd::FileDialog::new().set_file_name("symbols.json");
            let path = dialog.save_file();
            path.map_or(SetupOutcome::NoFile, |path| write(path, &mapping))
        }),
        Setup::Export(path, mapping) => start(state, "Writing names of symbols", move || {
            write(path, &mapping)
        }),
    }
}

fn read(path: &Path) -> Result<Box<AdsMapping>, String> {
    let read = read_versioned::<AdsMapping>(path);
    read.map(|read| Box::new(read.value))
        .map_err(|error| error.to_string())
}

fn write(path: PathBuf, mapping: &AdsMapping) -> SetupOutcome {
    let written = write_versioned(&path, mapping);
    SetupOutcome::Exported(written.map(|()| path).map_err(|error| error.to_string()))
}

fn open(state: &mut State) {
    let Some(open) = &state.model.open else {
        return;
    };
    let reached = &state.model.preferences.last_connection;
    let draft = Draft::of(open.session(), open.id(), reached);
    state.panels.connect = Some(Box::new(draft));
}

fn check(state: &mut State, (place, mapping): (AdsPlace, AdsMapping)) {
    let Some(open) = &state.model.open else {
        return;
    };
    // A controller takes one connection of this program only.
    if state.model.link.is_connected()
        || state.model.link.connecting
        || state.model.tasks.runs(CHECKING)
    {
        return;
    }
    let robot = open.session().robot.clone();
    start(state, CHECKING, move || {
        let address = AdsAddress {
            host: place.host,
            port: place.port,
            net_id: place.net_id,
            ams_port: place.ams_port,
        };
        let options = AdsOptions {
            timeout_s: place.timeout_s,
            ..AdsOptions::default()
        };
        let clock = Arc::new(SystemClock::start());
        let checked = check_symbols(&address, &mapping, &robot, &options, clock);
        SetupOutcome::Checked(checked.map_err(|error| error.to_string()))
    });
}

pub(super) fn receive(state: &mut State, outcome: SetupOutcome) {
    let robot = state.model.open.as_ref().map(|d| &d.session().robot);
    let (Some(draft), Some(robot)) = (&mut state.panels.connect, robot) else {
        return;
    };
    match outcome {
        SetupOutcome::Recording(Some(folder)) => draft.folder = folder.display().to_string(),
        SetupOutcome::Checked(checked) => draft.symbols.checked = Some(checked),
        SetupOutcome::Imported(Ok(mapping)) => match mapping.check(robot) {
            Ok(()) => draft.use_symbols(&mapping, robot),
            Err(error) => {
                let place = error.pointer;
                let text = format!(
                    "The names do not fit this robot: {place}: {}.",
                    error.message
                );
                state.model.messages.error(text);
            }
        },
        SetupOutcome::Exported(Ok(path)) => {
            state
                .model
                .messages
                .info(format!("Wrote {}.", path.display()));
        }
        SetupOutcome::Imported(Err(error)) | SetupOutcome::Exported(Err(error)) => {
            draft.refused = Some(error.clone());
            state.model.messages.error(error);
        }
        SetupOutcome::Recording(None) | SetupOutcome::NoFile => {
            state
                .model
                .messages
                .info("No file was chosen. If no dialog appeared, type the path.");
        }
    }
}
