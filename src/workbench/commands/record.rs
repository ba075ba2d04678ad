//! The record of a robot.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tautline_core::planning::PlanOptions;
use tautline_session::{LogEntry, Phase, Session, Timestamp};
use tautline_workflow::clock;
use tautline_workflow::health::{Baseline, HealthError, POSES, verdict_sentences};
use tautline_workflow::history::{RobotRecord, dated_session, pulleys_csv};
use tautline_workflow::planning::{SEED, with_home};

use super::file::begin;
use super::file_dialog::pick;
use super::file_tasks::ask_save;
use super::perform as perform_any;
use crate::model::Model;
use crate::model::command::file_choice::FileRequest;
use crate::model::command::{
    CHECKING_HEALTH, Command, CompareCommand, FileCommand, PLANNING, PlotFile, READING_RECORD,
    RecordCommand, RecordOutcome,
};
use crate::model::comparison::{SessionSource, Side};
use crate::model::dialogs::SaveContent;
use crate::model::messages::Cause;
use crate::model::phase::Screen;
use crate::model::record::{CheckedPair, OpenRecord};

pub(super) fn perform(model: &mut Model, command: RecordCommand) {
    match command {
        RecordCommand::Show => model.screen = Screen::Record,
        RecordCommand::Ask => {
            let request = FileRequest::folder("Folder with the sessions of one robot");
            pick(model, request, RecordCommand::Open);
        }
        RecordCommand::Open(folder) => open(model, folder),
        RecordCommand::Close => {
            model.tasks.cancel(READING_RECORD);
            model.record.clear();
        }
        RecordCommand::SetTolerance(tolerance) => {
            model.messages.resolve(Cause::Opening);
            if let Err(error) = model.record.set_tolerance(tolerance) {
                model.messages.failure(Cause::Opening, format!("{error}."));
            }
        }
        RecordCommand::Compare(sessions) => compare(model, sessions),
        RecordCommand::Check(sessions) => check(model, sessions),
        RecordCommand::PlanCheck(index) => plan_check(model, index),
        RecordCommand::OpenSession(index) => {
            if let Some(path) = path_of(model, index) {
                perform_any(model, Command::File(FileCommand::Open(path)));
            }
        }
        RecordCommand::AskSaveTable => {
            if let Some(open) = model.record.open() {
                let table = pulleys_csv(&open.record, &open.found);
                let content = SaveContent::Plot(PlotFile::Text(table));
                ask_save(model, content, "history.csv");
            }
        }
    }
}

fn path_of(model: &Model, index: usize) -> Option<PathBuf> {
    let session = model.record.open()?.record.sessions.get(index)?;
    Some(session.path.clone())
}

fn compare(model: &mut Model, sessions: [usize; 2]) {
    let [Some(a), Some(b)] = sessions.map(|index| path_of(model, index)) else {
        return;
    };
    for (side, path) in Side::ALL.into_iter().zip([a, b]) {
        let choose = CompareCommand::Choose(side, SessionSource::File(path));
        perform_any(model, Command::Compare(choose));
    }
    perform_any(model, Command::Compare(CompareCommand::Show));
}

fn open(model: &mut Model, folder: PathBuf) {
    model.tasks.cancel(READING_RECORD);
    model.messages.resolve(Cause::Opening);
    model.screen = Screen::Record;
    let number = model.record.begin(folder.clone());
    let tolerance = model.record.tolerance;
    model.tasks.start(READING_RECORD, move |task| {
        let mut observe = |done: usize, all: usize| {
            task.tell(
                Some(done as f32 / all.max(1) as f32),
                format!("{done} of {all} sessions"),
            );
            task.control()
        };
        let read = RobotRecord::open(&folder, clock::now(), &mut observe);
        let opened = read.and_then(|record| {
            let found = record.history(&folder, tolerance)?;
            Ok(Box::new(OpenRecord {
                folder,
                record,
                found,
            }))
        });
        let result = match opened {
            Err(_) if task.cancelled() => Err("Reading the record was stopped.".to_owned()),
            result => result.map_err(|error| format!("{error}.")),
        };
        RecordOutcome::Read { number, result }.into()
    });
}

/// Session of a file or folder, with the time of its measurement, if known.
fn read(path: &Path) -> Result<(Session, Option<Timestamp>), String> {
    let read = dated_session(path, clock::now());
    read.map(|read| read.value)
        .map_err(|error| format!("{error}."))
}

fn check(model: &mut Model, sessions: [usize; 2]) {
    let [Some(before), Some(now)] = sessions.map(|index| path_of(model, index)) else {
        return;
    };
    model.tasks.cancel(CHECKING_HEALTH);
    let number = model.record.number();
    model.tasks.start(CHECKING_HEALTH, move |_| {
        let told = || {
            let named = |path: &Path| {
                let path = path.display().to_string();
                move |error: HealthError| format!("{path}: {error}.")
            };
            let (session, time) = read(&before)?;
            let baseline = Baseline::new(&session, time).map_err(named(&before))?;
            let (session, time) = read(&now)?;
            let checked = baseline.check(&session.dataset(), time);
            let checked = checked.map_err(named(&now))?;
            Ok((checked.verdict, verdict_sentences(&baseline, &checked)))
        };
        let checked = CheckedPair {
            sessions,
            result: told(),
        };
        RecordOutcome::Checked {
            number,
            checked: Box::new(checked),
        }
        .into()
    });
}

/// Plans the health check of a session in the record, or of the open session.
fn plan_check(model: &mut Model, index: Option<usize>) {
    let open = model.open.as_ref().map(|open| open.session().clone());
    let path = index.and_then(|index| path_of(model, index));
    model.messages.resolve(Cause::Planning);
    model.tasks.start(PLANNING, move |_| {
        let planned = || {
            let (session, time) = match (path, open) {
                (Some(path), _) => read(&path)?,
                (None, Some(open)) => {
                    let time = open.measured();
                    (open, time)
                }
                (None, None) => return Err("There is no session to check against.".to_owned()),
            };
            let baseline = Baseline::new(&session, time).map_err(|error| format!("{error}."))?;
            let plan = baseline.plan(&PlanOptions::new(POSES, SEED));
            let plan = plan.map_err(|error| format!("No plan: {error}."))?;
            let now = clock::now();
            let name = format!("{}, health check", session.name);
            let mut series = session.another_series(name, now);
            series.plan = with_home(&series, &plan);
            series.record(LogEntry {
                time: now,
                phase: Phase::Poses,
                text: format!("Planned the poses of a health check of {}.", session.name),
            });
            Ok(Box::new(series))
        };
        RecordOutcome::Planned(planned()).into()
    });
}

pub(super) fn receive(model: &mut Model, outcome: RecordOutcome) {
    match outcome {
        RecordOutcome::Read { number, result } if model.record.expects(number) => {
            match &result {
                Err(error) => model.messages.failure(Cause::Opening, error.clone()),
                Ok(open) => {
                    let notices = open.record.notices.iter();
                    model
                        .messages
                        .warnings(notices.map(|notice| format!("{notice}.")));
                }
            }
            model.record.take(result.map(Arc::from));
        }
        RecordOutcome::Checked { number, checked } if model.record.expects(number) => {
            model.record.checked = Some(*checked);
        }
        RecordOutcome::Read { .. } | RecordOutcome::Checked { .. } => {}
        RecordOutcome::Planned(Ok(series)) => begin(model, *series, None),
        RecordOutcome::Planned(Err(error)) => model.messages.failure(Cause::Planning, error),
    }
}
