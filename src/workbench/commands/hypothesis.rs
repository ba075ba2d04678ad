//! Hypotheses of the user, and the gallery of effects.

use std::fs;
use std::path::PathBuf;
use std::sync::Arc;

use tautline_core::effect::Hypothesis;
use tautline_files::Location;
use tautline_session::{HypothesisFolder, Session, read_hypothesis, write_text};
use tautline_workflow::clock;
use tautline_workflow::signature::{Gallery, Signature, try_hypothesis, write_gallery};

use super::file_dialog::pick;
use super::file_tasks::{ask_save, write, written};
use super::perform as perform_any;
use crate::model::command::PreviewResult;
use crate::model::command::file_choice::FileRequest;
use crate::model::command::{
    Answer, DRAWING, FileCommand, HypothesisCommand, HypothesisOutcome, IdentificationCommand,
    TRYING,
};
use crate::model::dialogs::{SaveContent, SaveDraft};
use crate::model::edit::Edit;
use crate::model::hypothesis::{AfterHypothesis, TEMPLATE};
use crate::model::messages::Cause;
use crate::model::phase::{Phase, Screen};
use crate::model::save_form::SaveForm;
use crate::model::{Model, OpenSession};

pub(super) fn perform(model: &mut Model, command: HypothesisCommand) {
    match command {
        HypothesisCommand::Show => {
            if model.hypothesis.draft.is_none() {
                model.hypothesis.begin(TEMPLATE.to_owned(), None);
            }
            model.screen = Screen::Hypothesis;
        }
        HypothesisCommand::New => begin(model, TEMPLATE.to_owned(), None),
        HypothesisCommand::Begin(text) => begin(model, text, None),
        HypothesisCommand::AskOpen => {
            let mut request = FileRequest::file("Open a hypothesis", &["toml"]);
            request.folder = model.folders.effects();
            pick(model, request, HypothesisCommand::Open);
        }
        HypothesisCommand::Open(path) => read(model, path),
        HypothesisCommand::SetText(text) => {
            model.tasks.cancel(TRYING);
            if let Some(draft) = &mut model.hypothesis.draft {
                draft.set_text(text);
            }
        }
        HypothesisCommand::Try => preview(model),
        HypothesisCommand::ChoosePlacement(index) => {
            if let Some(draft) = &mut model.hypothesis.draft {
                draft.placement = index;
            }
        }
        HypothesisCommand::SaveInSession => {
            save_in_session(model);
        }
        HypothesisCommand::Remove(id) => {
            perform_any(model, Edit::RemoveHypothesis(id).into());
        }
        HypothesisCommand::AskSave => ask_save_file(model),
        HypothesisCommand::Save(path) => save(model, path),
        HypothesisCommand::AskDoctor => {
            if save_in_session(model) {
                model.screen = Screen::Phase(Phase::Identification);
                perform_any(model, IdentificationCommand::Diagnose.into());
            }
        }
        HypothesisCommand::Answer(answer) => answered(model, answer),
        HypothesisCommand::DrawGallery => draw_gallery(model),
        HypothesisCommand::AskSaveGallery => {
            ask_save(model, SaveContent::Gallery, "effects.html");
        }
        HypothesisCommand::SaveGallery(path) => save_gallery(model, path),
    }
}

/// Begins with a text; asks first if an unsaved text would be lost.
fn begin(model: &mut Model, text: String, file: Option<PathBuf>) {
    go_on(model, AfterHypothesis::Begin { text, file });
}

/// Carries out an action; asks first if an unsaved text would be lost.
pub(super) fn go_on(model: &mut Model, next: AfterHypothesis) {
    if model.hypothesis.is_unsaved() {
        model.hypothesis.asking = Some(next);
        return;
    }
    match next {
        AfterHypothesis::Begin { text, file } => {
            model.tasks.cancel(TRYING);
            model.hypothesis.begin(text, file);
            model.screen = Screen::Hypothesis;
        }
        AfterHypothesis::Quit => perform_any(model, FileCommand::Quit.into()),
    }
}

fn answered(model: &mut Model, answer: Answer) {
    let Some(next) = model.hypothesis.asking.take() else {
        return;
    };
    match answer {
        Answer::Cancel => {}
        Answer::Discard => {
            keep_text(model);
            go_on(model, next);
        }
        // A session accepts only a valid text, a file any; in that case the action follows once the file is written.
        Answer::Save if save_in_session(model) => go_on(model, next),
        Answer::Save => {
            model.hypothesis.asking = Some(next);
            ask_save_file(model);
        }
    }
}

/// Marks the text as saved.
fn keep_text(model: &mut Model) {
    if let Some(draft) = &mut model.hypothesis.draft {
        let text = draft.text().to_owned();
        draft.keep(&text);
    }
}

/// Adds the hypothesis to the open session, if it is valid; returns whether it was added.
fn save_in_session(model: &mut Model) -> bool {
    let draft = model.hypothesis.draft.as_ref();
    let hypothesis = draft.and_then(|draft| draft.checked().ok()).cloned();
    let (Some(hypothesis), Some(open)) = (hypothesis, &model.open) else {
        return false;
    };
    let text = hypothesis.text().to_owned();
    let is_known = |session: &Session| session.robot.hypotheses.contains(&text);
    if !is_known(open.session()) {
        perform_any(model, Edit::SetHypothesis(Box::new(hypothesis)).into());
    }
    let is_taken = model
        .open
        .as_ref()
        .is_some_and(|open| is_known(open.session()));
    if is_taken {
        keep_text(model);
    } else {
        let text = "The session cannot have more hypotheses: remove one first.";
        model.messages.failure(Cause::Entry, text);
    }
    is_taken
}

/// Asks for a file; files in the folder of the user are found by every later session.
fn ask_save_file(model: &mut Model) {
    let Some(draft) = &model.hypothesis.draft else {
        return;
    };
    let id = draft.checked().map_or("hypothesis", Hypothesis::id);
    let usual = model.folders.effects().join(format!("{id}.toml"));
    let path = draft.file.clone().unwrap_or(usual);
    model.dialogs.save = Some(SaveDraft {
        form: SaveForm::new(&path),
        content: SaveContent::Hypothesis,
    });
}

fn save(model: &mut Model, path: PathBuf) {
    let Some(draft) = &model.hypothesis.draft else {
        return;
    };
    let text = draft.text().to_owned();
    model.messages.resolve(Cause::Saving);
    model.tasks.start("Saving the hypothesis", move |_| {
        let made = path.parent().map_or(Ok(()), fs::create_dir_all);
        let made = made.map_err(|error| format!("{}: {error}", path.display()));
        let saved = || write_text(&path, &text).map_err(|error| error.to_string());
        let result = made.and_then(|()| saved());
        HypothesisOutcome::Saved { path, text, result }.into()
    });
}

fn read(model: &mut Model, path: PathBuf) {
    model.messages.resolve(Cause::Opening);
    model.tasks.start("Opening", move |_| {
        // A text with errors is opened to be corrected, unless it is too large.
        let result = match read_hypothesis(&path) {
            Ok(hypothesis) => Ok(hypothesis.text().to_owned()),
            Err(error) if error.place == Location::File => Err(error.to_string()),
            Err(_) => fs::read_to_string(&path).map_err(|error| error.to_string()),
        };
        HypothesisOutcome::Read(path, result).into()
    });
}

/// Computes the effect of the hypothesis on the residuals, unless that is already running.
fn preview(model: &mut Model) {
    let draft = model.hypothesis.draft.as_ref();
    let hypothesis = draft.and_then(|draft| draft.checked().ok()).cloned();
    let Some(hypothesis) = hypothesis.filter(|_| !model.tasks.runs(TRYING)) else {
        return;
    };
    let of = (
        hypothesis.text().to_owned(),
        model.open.as_ref().map(OpenSession::inputs),
    );
    if let Some(open) = model.measured() {
        let session = open.session().clone();
        let fit = open.current_fit().map(Arc::clone);
        model.tasks.start(TRYING, move |task| {
            let tried = try_hypothesis(&session, fit, &hypothesis, &|| task.control());
            let result = tried.map(|tried| tried.map(PreviewResult::Measured));
            HypothesisOutcome::Tried { of, result }.into()
        });
        return;
    }
    let Some((mut robot, poses)) = model.robot_of_effects() else {
        return;
    };
    model.tasks.start(TRYING, move |_| {
        let known = tautline_workflow::signature::replace_hypothesis(&mut robot, &hypothesis);
        let signature = known.map_err(|error| format!("{error}.")).and_then(|()| {
            let signature = Signature::of(&robot, &poses, hypothesis.effect());
            signature.map_err(|error| format!("{}: {error}.", robot.name))
        });
        let result = signature.map(|signature| Some(PreviewResult::Simulated(Box::new(signature))));
        HypothesisOutcome::Tried { of, result }.into()
    });
}

fn draw_gallery(model: &mut Model) {
    if model.tasks.runs(DRAWING) {
        return;
    }
    let Some((robot, poses)) = model.robot_of_effects() else {
        return;
    };
    model.tasks.start(DRAWING, move |task| {
        let gallery = Gallery::new(&robot, &poses, &mut |done, all| {
            let fraction = done as f32 / all.max(1) as f32;
            task.tell(Some(fraction), format!("{done} of {all} effects"));
            task.control()
        });
        let gallery = gallery.map(|gallery| gallery.map(Box::new));
        let result = gallery.map_err(|error| format!("{}: {error}.", robot.name));
        HypothesisOutcome::Gallery(Box::new(robot), result).into()
    });
}

fn save_gallery(model: &mut Model, path: PathBuf) {
    let Some((_, Ok(gallery))) = &model.hypothesis.gallery else {
        return;
    };
    let gallery = Arc::clone(gallery);
    write(model, "Writing the gallery", path, move |path| {
        write_gallery(path, &gallery, clock::now())
    });
}

/// Adds the hypotheses in the settings folder to the robot of a new session.
pub(super) fn add_those_of_user(model: &mut Model, session: &mut Session) {
    let folder = HypothesisFolder::read(&model.folders.effects());
    let added = folder.add_to(&mut session.robot);
    let notices = folder.notices.into_iter().chain(added);
    model
        .messages
        .warnings(notices.map(|notice| format!("{notice}.")));
}

pub(super) fn receive(model: &mut Model, outcome: HypothesisOutcome) {
    match outcome {
        HypothesisOutcome::Tried { of, result } => {
            if let (Some(draft), Some(result)) = (&mut model.hypothesis.draft, result.transpose()) {
                let (text, inputs) = of;
                draft.take_preview(text, inputs, result);
            }
        }
        HypothesisOutcome::Read(path, Ok(text)) => begin(model, text, Some(path)),
        HypothesisOutcome::Read(_, Err(error)) => model.messages.failure(Cause::Opening, error),
        HypothesisOutcome::Saved { path, text, result } => {
            let is_saved = result.is_ok();
            written(model, &path, result);
            if let Some(draft) = model.hypothesis.draft.as_mut().filter(|_| is_saved) {
                draft.keep(&text);
                draft.file = Some(path);
                if let Some(next) = model.hypothesis.asking.take() {
                    go_on(model, next);
                }
            }
        }
        HypothesisOutcome::Gallery(robot, result) => {
            if let Some(result) = result.transpose() {
                let result = result.map(Arc::from);
                model.hypothesis.gallery = Some((*robot, result));
            } else {
                model.messages.info("Simulating effects was stopped.");
                model.screen = model.previous_screen();
            }
        }
    }
}
