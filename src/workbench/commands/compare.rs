//! Comparing two sessions.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tautline_core::estimation::{Control, Progress};
use tautline_session::{Session, import};

use crate::model::OpenSession;
use crate::model::command::{COMPARING, CompareCommand, CompareOutcome};
use crate::model::comparison::{Compared, Run, Side, Source};
use crate::model::phase::Screen;
use crate::model::tasks::TaskHandle;
use crate::shell::State;
use tautline_workflow::clock;
use tautline_workflow::comparison::{as_session, identify_to_compare};
use tautline_workflow::identification::IdentificationError;

pub(super) fn perform(state: &mut State, command: CompareCommand) {
    match command {
        CompareCommand::Show => show(state),
        CompareCommand::Ask(side) => state.model.tasks.start("File dialog", move |_| {
            let dialog = rfd::FileDialog::new().add_filter("Tautline", &["json"]);
            CompareOutcome::Picked(side, dialog.pick_file()).into()
        }),
        CompareCommand::Choose(side, source) => choose(state, side, source),
        CompareCommand::Drop(path) => {
            let memory = &state.panels.compare;
            let empty = Side::ALL
                .into_iter()
                .find(|side| memory.source(*side).is_none());
            choose(state, empty.unwrap_or(Side::B), Source::File(path));
        }
        CompareCommand::Clear(side) => {
            state.model.tasks.cancel(COMPARING);
            state.panels.compare.clear(side);
        }
        CompareCommand::Swap => {
            state.panels.compare.swap();
            start(state, None);
        }
        CompareCommand::Again => start(state, None),
    }
}

fn show(state: &mut State) {
    state.model.screen = Screen::Compare;
    let memory = &mut state.panels.compare;
    let is_open = state.model.open.is_some();
    for side in Side::ALL {
        if !is_open && memory.source(side) == Some(&Source::Open) {
            memory.clear(side);
        }
    }
    if is_open && Side::ALL.iter().all(|side| memory.source(*side).is_none()) {
        memory.choose(Side::A, Source::Open);
    }
}

fn choose(state: &mut State, side: Side, source: Source) {
    state.panels.compare.choose(side, source);
    start(state, Some(side));
}

/// What has to be done to have one of the two.
enum Job {
    /// It is there already.
    Done(Arc<Run>),
    /// The open session, with the number of its inputs.
    Identify(Box<Session>, u64),
    /// A file.
    Read(PathBuf),
}

impl Job {
    fn of(
        source: &Source,
        before: Option<&Arc<Compared>>,
        open: Option<&OpenSession>,
    ) -> Option<Self> {
        let known = before.and_then(|compared| {
            let mut runs = compared.runs.iter();
            runs.find(|run| run.source == *source)
        });
        match (source, open) {
            (Source::File(path), _) => Some(known.map_or_else(
                || Self::Read(path.clone()),
                |run| Self::Done(Arc::clone(run)),
            )),
            (Source::Open, None) => None,
            (Source::Open, Some(open)) => {
                let inputs = open.inputs();
                let known = known.filter(|run| run.inputs == Some(inputs));
                Some(known.map_or_else(
                    || Self::Identify(Box::new(open.session().clone()), inputs),
                    |run| Self::Done(Arc::clone(run)),
                ))
            }
        }
    }

    fn run(self, side: Side, task: &TaskHandle) -> Result<Arc<Run>, String> {
        let (session, source, inputs) = match self {
            Self::Done(run) => return Ok(run),
            Self::Identify(session, inputs) => (*session, Source::Open, Some(inputs)),
            Self::Read(path) => (read(&path)?, Source::File(path), None),
        };
        let named = |error: IdentificationError| match &source {
            Source::File(path) => format!("{}: {error}.", path.display()),
            Source::Open => format!("{}: {error}.", session.name),
        };
        let fit = identify_to_compare(&session, &mut |progress: &Progress| {
            task.tell(
                None,
                format!("{}, step {}", side.name(), progress.iteration),
            );
            if task.cancelled() {
                Control::Cancel
            } else {
                Control::Continue
            }
        });
        Ok(Arc::new(Run {
            fit: Arc::new(fit.map_err(named)?),
            name: session.name,
            source,
            inputs,
        }))
    }
}

fn read(path: &Path) -> Result<Session, String> {
    let read = import(path, None).map_err(|error| format!("{error}."))?;
    let session = as_session(path, read.value, clock::now());
    session
        .map(|(session, _)| session)
        .map_err(|error| format!("{error}."))
}

/// Compares as soon as both are chosen; `chosen` is read again even if it is known.
fn start(state: &mut State, chosen: Option<Side>) {
    state.model.tasks.cancel(COMPARING);
    let memory = &mut state.panels.compare;
    let number = memory.begin();
    let [Some(a), Some(b)] = Side::ALL.map(|side| {
        let source = memory.source(side)?;
        let known = memory.known().filter(|_| chosen != Some(side));
        Job::of(source, known, state.model.open.as_ref())
    }) else {
        return;
    };
    state.model.tasks.start(COMPARING, move |task| {
        let compared = || {
            let runs = [a.run(Side::A, task)?, b.run(Side::B, task)?];
            Compared::new(runs)
                .map(Box::new)
                .map_err(|error| format!("The two cannot be compared: {error}."))
        };
        let result = match compared() {
            Err(_) if task.cancelled() => Err("The comparison was stopped.".to_owned()),
            result => result,
        };
        CompareOutcome::Compared { number, result }.into()
    });
}

pub(super) fn receive(state: &mut State, outcome: CompareOutcome) {
    match outcome {
        CompareOutcome::Picked(side, Some(path)) => choose(state, side, Source::File(path)),
        CompareOutcome::Picked(_, None) => state.model.messages.info(
            "No file was chosen. If no dialog appeared, type the path or drop the file on the window.",
        ),
        CompareOutcome::Compared { number, result } => {
            if !state.panels.compare.expects(number) {
                return;
            }
            if let Err(error) = &result {
                state.model.messages.error(error.clone());
            }
            let result = result.map(|compared| Arc::new(*compared));
            state.panels.compare.take(result);
            state.views.compared_3d.look_anew();
        }
    }
}
