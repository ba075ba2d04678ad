//! Comparison of two sessions, and of a simulator with the machine.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tautline_core::estimation::Progress;
use tautline_session::{Session, import, read_poses, read_table_file};

use super::file_dialog::pick;
use super::file_tasks::file_label;
use crate::model::command::file_choice::FileRequest;
use crate::model::command::{COMPARING, CompareCommand, CompareOutcome};
use crate::model::comparison::{
    Compared, ComparedSession, SessionSource, Side, SimulatorComparison,
};
use crate::model::messages::Cause;
use crate::model::phase::Screen;
use crate::model::tasks::TaskHandle;
use crate::model::{Model, OpenSession};
use tautline_workflow::clock;
use tautline_workflow::comparison::{as_session, identify_to_compare};
use tautline_workflow::identification::IdentificationError;
use tautline_workflow::replay::Replay;

pub(super) fn perform(model: &mut Model, command: CompareCommand) {
    match command {
        CompareCommand::Show => show(model),
        CompareCommand::Ask(side) => {
            let request = FileRequest::file("Session to compare", &["tautline", "json"]);
            pick(model, request, move |path| {
                CompareCommand::Choose(side, SessionSource::File(path))
            });
        }
        CompareCommand::Choose(side, source) => choose(model, side, source),
        CompareCommand::Drop(path) => {
            let is_empty = |side: &Side| model.comparison.source(*side).is_none();
            let side = Side::ALL.into_iter().find(is_empty).unwrap_or(Side::B);
            choose(model, side, SessionSource::File(path));
        }
        CompareCommand::Clear(side) => {
            model.tasks.cancel(COMPARING);
            model.comparison.clear(side);
        }
        CompareCommand::Swap => {
            model.comparison.swap();
            start(model, None);
        }
        CompareCommand::Again => start(model, None),
        CompareCommand::AskSimulator => {
            let request = FileRequest::file("Readings of a simulator", &["csv"]);
            pick(model, request, CompareCommand::Simulator);
        }
        CompareCommand::Simulator(path) => replay(model, &path),
    }
}

fn show(model: &mut Model) {
    model.screen = Screen::Compare;
    let comparison = &mut model.comparison;
    let is_open = model.open.is_some();
    for side in Side::ALL {
        if !is_open && comparison.source(side) == Some(&SessionSource::Open) {
            comparison.clear(side);
        }
    }
    if is_open
        && Side::ALL
            .iter()
            .all(|side| comparison.source(*side).is_none())
    {
        comparison.choose(Side::A, SessionSource::Open);
    }
}

fn choose(model: &mut Model, side: Side, source: SessionSource) {
    model.comparison.choose(side, source);
    start(model, Some(side));
}

/// Source of one side of a comparison.
enum Preparation {
    Ready(Arc<ComparedSession>),
    /// The open session, with the number of its inputs.
    Identify(Box<Session>, u64),
    Read(PathBuf),
}

impl Preparation {
    fn of(
        source: &SessionSource,
        before: Option<&Arc<Compared>>,
        open: Option<&OpenSession>,
    ) -> Option<Self> {
        let known = before.and_then(|compared| {
            let mut runs = compared.runs.iter();
            runs.find(|run| run.source == *source)
        });
        match (source, open) {
            (SessionSource::File(path), _) => Some(known.map_or_else(
                || Self::Read(path.clone()),
                |run| Self::Ready(Arc::clone(run)),
            )),
            (SessionSource::Open, None) => None,
            (SessionSource::Open, Some(open)) => {
                let inputs = open.inputs();
                let known = known.filter(|run| run.inputs == Some(inputs));
                Some(known.map_or_else(
                    || Self::Identify(Box::new(open.session().clone()), inputs),
                    |run| Self::Ready(Arc::clone(run)),
                ))
            }
        }
    }

    fn run(self, side: Side, task: &TaskHandle) -> Result<Arc<ComparedSession>, String> {
        let (session, source, inputs) = match self {
            Self::Ready(run) => return Ok(run),
            Self::Identify(session, inputs) => (*session, SessionSource::Open, Some(inputs)),
            Self::Read(path) => (read(&path)?, SessionSource::File(path), None),
        };
        let named = |error: IdentificationError| match &source {
            SessionSource::File(path) => format!("{}: {error}.", path.display()),
            SessionSource::Open => format!("{}: {error}.", session.name),
        };
        let fit = identify_to_compare(&session, &mut |progress: &Progress| {
            task.tell(
                None,
                format!("{}, step {}", side.name(), progress.iteration),
            );
            task.control()
        });
        Ok(Arc::new(ComparedSession {
            fit: Arc::new(fit.map_err(named)?),
            measured: session.measured(),
            is_simulated: session.is_simulated(),
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

/// Compares once both sides are chosen; `chosen` is read again even if it is known.
fn start(model: &mut Model, chosen: Option<Side>) {
    model.tasks.cancel(COMPARING);
    model.messages.resolve(Cause::Comparison);
    let comparison = &mut model.comparison;
    let number = comparison.begin();
    let [Some(a), Some(b)] = Side::ALL.map(|side| {
        let source = comparison.source(side)?;
        let known = comparison.known().filter(|_| chosen != Some(side));
        Preparation::of(source, known, model.open.as_ref())
    }) else {
        return;
    };
    model.tasks.start(COMPARING, move |task| {
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
        CompareOutcome { number, result }.into()
    });
}

pub(super) fn receive(model: &mut Model, CompareOutcome { number, result }: CompareOutcome) {
    if !model.comparison.expects(number) {
        return;
    }
    if let Err(error) = &result {
        model.messages.failure(Cause::Comparison, error.clone());
    }
    model.comparison.take(result.map(Arc::from));
}

/// Compares the readings of a simulator with those of the open session, using its identified model.
fn replay(model: &mut Model, path: &Path) {
    let Some((open, fit)) = model
        .open
        .as_ref()
        .and_then(|open| Some((open, open.fit()?)))
    else {
        return;
    };
    model.screen = Screen::Simulator;
    model.comparison.simulator = None;
    let (session, dataset, fit) = (open.id(), open.session().dataset(), Arc::clone(fit));
    let path = path.to_owned();
    model.tasks.start(COMPARING, move |_| {
        let replay = || {
            let simulated = read_table_file(&path, |reader, file| {
                read_poses(reader, file, &dataset.robot)
            });
            let simulated = simulated.map_err(|error| format!("{error}."))?;
            let replay = Replay::new(&dataset, &fit.model, &simulated.value);
            replay
                .map(Box::new)
                .map_err(|error| format!("{}: {error}.", path.display()))
        };
        let result = replay();
        let file = file_label(&path);
        SimulatorComparison {
            session,
            file,
            result,
        }
        .into()
    });
}
