//! The record of a robot.

use std::path::PathBuf;
use std::sync::Arc;

use tautline_workflow::clock;
use tautline_workflow::history::{RobotRecord, pulleys_csv};

use super::file_dialog::pick;
use super::file_tasks::ask_save;
use super::perform as perform_any;
use crate::model::Model;
use crate::model::command::file_choice::FileRequest;
use crate::model::command::{
    Command, CompareCommand, FileCommand, PlotFile, READING_RECORD, RecordCommand, RecordOutcome,
};
use crate::model::comparison::{Side, Source};
use crate::model::dialogs::SaveContent;
use crate::model::messages::Cause;
use crate::model::phase::Screen;
use crate::model::record::OpenRecord;

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
        RecordCommand::SetTolerance(tolerance_m) => model.record.set_tolerance(tolerance_m),
        RecordCommand::Compare(sessions) => compare(model, sessions),
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
        let choose = CompareCommand::Choose(side, Source::File(path));
        perform_any(model, Command::Compare(choose));
    }
    perform_any(model, Command::Compare(CompareCommand::Show));
}

fn open(model: &mut Model, folder: PathBuf) {
    model.tasks.cancel(READING_RECORD);
    model.messages.resolve(Cause::Opening);
    model.screen = Screen::Record;
    let number = model.record.begin(folder.clone());
    let tolerance_m = model.record.tolerance_m;
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
            let found = record.history(&folder, tolerance_m)?;
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
        RecordOutcome { number, result }.into()
    });
}

pub(super) fn receive(model: &mut Model, RecordOutcome { number, result }: RecordOutcome) {
    if !model.record.expects(number) {
        return;
    }
    match &result {
        Err(error) => model.messages.failure(Cause::Opening, error.clone()),
        Ok(open) => {
            for notice in &open.record.notices {
                model.messages.warning(format!("{notice}."));
            }
        }
    }
    model.record.take(result.map(Arc::from));
}
