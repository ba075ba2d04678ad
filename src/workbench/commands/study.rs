//! Studies that start from *Which sensor?*.

use std::path::PathBuf;

use tautline_study::simulated_question::simulate;
use tautline_workflow::clock;

use super::file_dialog::pick;
use crate::model::Model;
use crate::model::command::file_choice::FileRequest;
use crate::model::command::{AskedRobot, Outcome, SIMULATING, StudyCommand};

pub(super) fn perform(model: &mut Model, command: StudyCommand) {
    match command {
        StudyCommand::Browse(asked) => {
            let request = FileRequest::folder("Folder of the study");
            pick(model, request, |folder| {
                StudyCommand::Simulate(asked, folder)
            });
        }
        StudyCommand::Simulate(asked, folder) if !model.tasks.runs(SIMULATING) => {
            start(model, *asked, folder);
        }
        StudyCommand::Simulate(..) => model.messages.info("A study is being simulated already."),
    }
}

fn start(model: &mut Model, asked: AskedRobot, folder: PathBuf) {
    model.tasks.start(SIMULATING, move |task| {
        let observer = |done: u64, all: u64| {
            let text = match all {
                0 => "planning".to_owned(),
                _ => format!("{done} of {all} calibrations"),
            };
            task.tell((all > 0).then(|| done as f32 / all as f32), text);
            task.control()
        };
        let written = simulate(
            (&asked.robot, &asked.question),
            &folder,
            clock::now(),
            &observer,
        );
        match written {
            Ok(path) => Outcome::Written(path, Ok(None)),
            Err(error) => Outcome::Written(folder, Err(error.to_string())),
        }
    });
}
