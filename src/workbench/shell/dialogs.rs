//! Modal dialogs: unsaved changes, writing of values, internal errors.

use egui::{RichText, TextEdit, Ui};

use super::{AppState, report};
use crate::model::Model;
use crate::model::command::{Answer, FileCommand, HypothesisCommand, RobotCommand, WriteDraft};
use crate::screens::adjustment::{adaptation, lines};
use crate::theme::{self, GRID};
use crate::widgets::{UiExt, entered, modal, primary};
use tautline_workflow::wording::count;

/// Draws the open dialog, if any.
pub fn show(ui: &mut Ui, state: &mut AppState) {
    // The save dialog is drawn above this one.
    if state.model.dialogs.save.is_none() {
        pending_action(ui, state);
        unsaved_hypothesis(ui, state);
    }
    elsewhere(ui, state);
    if let Some(draft) = state.model.dialogs.writing.take() {
        writing(ui, state, draft);
    }
    if let Some(draft) = state.model.dialogs.report.take() {
        report::show(ui, state, draft);
    }
}

/// Question about unsaved changes and about disconnecting an armed robot.
fn pending_action(ui: &mut Ui, state: &mut AppState) {
    let AppState { model, outbox, .. } = state;
    let Some(draft) = &model.dialogs.pending else {
        return;
    };
    let is_unsaved = draft.action.ends_session() && model.is_unsaved();
    let (answer, is_left) = modal(ui, "leaving", 420.0, |ui| {
        ui.heading(match is_unsaved {
            true => "Save the changes?",
            false => "Disconnect the armed robot?",
        });
        if is_unsaved {
            let name = model.open.as_ref().map_or("", |open| &open.session().name);
            ui.label(format!("{name} is not saved."));
        }
        if model.link.can_move() {
            ui.doubtful(&format!(
                "{} is armed: it will be stopped and disconnected.",
                model.link.identity
            ));
        }
        if let Some(why) = &draft.failure {
            ui.bad(why);
        }
        ui.add_space(2.0 * GRID);
        let answers: &[(&str, Answer)] = match is_unsaved {
            true if draft.action.keeps_session() => {
                &[("Save", Answer::Save), ("Cancel", Answer::Cancel)]
            }
            true => &[
                ("Save", Answer::Save),
                ("Do not save", Answer::Discard),
                ("Cancel", Answer::Cancel),
            ],
            false => &[("Disconnect", Answer::Discard), ("Cancel", Answer::Cancel)],
        };
        if !is_unsaved || draft.failure.is_none() {
            return choice_of(ui, answers);
        }
        let row = ui.horizontal(|ui| {
            if primary(ui, "Save as…", true).clicked() {
                outbox.send(FileCommand::AskSaveAs);
            }
            let given = answers
                .iter()
                .map(|(title, answer)| ui.button(*title).clicked().then_some(*answer));
            given.fold(None, Option::or)
        });
        row.inner
    });
    if let Some(answer) = answer.or(is_left.then_some(Answer::Cancel)) {
        outbox.send(FileCommand::Answer(answer));
    }
}

/// Row of answers, the first being the primary one.
fn choice_of<A: Copy>(ui: &mut Ui, answers: &[(&str, A)]) -> Option<A> {
    let row = ui.horizontal(|ui| {
        let mut given = None;
        for (k, (title, answer)) in answers.iter().enumerate() {
            let button = match k {
                0 => primary(ui, title, true),
                _ => ui.button(*title),
            };
            given = given.or(button.clicked().then_some(*answer));
        }
        given
    });
    row.inner
}

/// Question about a session that is open in another window.
fn elsewhere(ui: &mut Ui, state: &mut AppState) {
    let Some((opening, since)) = &state.model.dialogs.elsewhere else {
        return;
    };
    let (answer, is_left) = modal(ui, "elsewhere", 460.0, |ui| {
        ui.heading(format!("Open in another window since {since}"));
        let text = "Two windows must not work with one session and its robot. What the other one has not saved stays there.";
        ui.label(format!("{}: {text}", opening.session.name));
        ui.add_space(2.0 * GRID);
        choice_of(
            ui,
            &[
                ("Look only", Some(false)),
                ("Take over", Some(true)),
                ("Cancel", None),
            ],
        )
    });
    if let Some(answer) = answer.or(is_left.then_some(None)) {
        state.outbox.send(FileCommand::TakeOver(answer));
    }
}

/// Question about the unsaved text of a hypothesis.
fn unsaved_hypothesis(ui: &mut Ui, state: &mut AppState) {
    let AppState { model, outbox, .. } = state;
    let draft = model.hypothesis.draft.as_ref();
    let Some(draft) = draft.filter(|_| model.hypothesis.asking.is_some()) else {
        return;
    };
    let into_session = draft.checked().is_ok() && model.open.is_some();
    let (answer, is_left) = modal(ui, "unsaved hypothesis", 420.0, |ui| {
        ui.heading("Save the hypothesis?");
        ui.label(match into_session {
            true => "Its text is in no file and not in the session.",
            false => "Its text is in no file.",
        });
        ui.add_space(2.0 * GRID);
        let save = if into_session {
            "Save into the session"
        } else {
            "Save as…"
        };
        choice_of(
            ui,
            &[
                (save, Answer::Save),
                ("Do not save", Answer::Discard),
                ("Cancel", Answer::Cancel),
            ],
        )
    });
    if let Some(answer) = answer.or(is_left.then_some(Answer::Cancel)) {
        outbox.send(HypothesisCommand::Answer(answer));
    }
}

/// Question before values are written, with the name of the operator.
fn writing(ui: &mut Ui, state: &mut AppState, mut draft: WriteDraft) {
    let review = &draft.review;
    let open = state.model.open.as_ref();
    let cables = open.map_or(&[][..], |open| &open.session().robot.cables);
    let (answer, is_left) = modal(ui, "write values", 600.0, |ui| {
        ui.heading("Write these values?");
        let values = count(review.changes().count(), "value");
        let controller = &state.model.link.identity;
        ui.label(format!(
            "{values} in {controller} are replaced by the identified ones. They can be rolled back."
        ));
        let height = (ui.ctx().content_rect().height() - 360.0).max(100.0);
        egui::ScrollArea::vertical()
            .max_height(height)
            .show(ui, |ui| lines(ui, review.changes(), cables));
        for doubt in &draft.doubts {
            ui.doubtful(&format!("{}.", doubt.sentence));
        }
        if review.doubt().is_none() {
            adaptation(ui, review);
        }
        let is_sound = draft.doubts.is_empty();
        if !is_sound {
            ui.label("Such values can make the robot less accurate.");
        }
        ui.add_space(GRID);
        let field = ui.horizontal(|ui| {
            let label = ui.label("Operator");
            let field =
                TextEdit::singleline(&mut draft.operator).hint_text("Your name, for the record");
            ui.add(field.desired_width(240.0)).labelled_by(label.id)
        });
        let field = field.inner;
        let entered = entered(&field);
        if ui.memory(|memory| memory.focused().is_none()) {
            field.request_focus();
        }
        ui.add_space(2.0 * GRID);
        let is_named = !draft.operator.trim().is_empty();
        let hint = "Enter your name: it is kept in the record";
        ui.horizontal(|ui| {
            let (wanted, cancelled) = match is_sound {
                true => (
                    primary(ui, "Write", is_named),
                    ui.button("Cancel").clicked(),
                ),
                false => {
                    let cancelled = primary(ui, "Do not write", true).clicked();
                    let button = egui::Button::new("Write anyway");
                    (ui.add_enabled(is_named, button), cancelled)
                }
            };
            let wanted = wanted.on_disabled_hover_text(hint).clicked();
            match wanted || entered && is_sound && is_named {
                true => Some(true),
                false => cancelled.then_some(false),
            }
        })
        .inner
    });
    if let Some(answer) = answer.or(is_left.then_some(false)) {
        state.outbox.send(RobotCommand::ConfirmWrite(answer));
    }
    state.model.dialogs.writing = Some(draft);
}

/// Draws the window after an internal error.
pub fn internal_error(ui: &mut Ui, model: &mut Model) {
    let Some(caught_panic) = model.caught_panic.clone() else {
        return;
    };
    let folder = model.folders.recovery();
    ui.painter()
        .rect_filled(ui.ctx().content_rect(), 0.0, theme::of(ui).panel);
    ui.vertical_centered(|ui| {
        ui.set_width(640.0_f32.min(ui.available_width() - 8.0 * GRID));
        ui.add_space(ui.available_height() * 0.2);
        ui.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| {
            ui.heading("Internal error");
            ui.label("The session is unchanged and nothing that was measured is lost. A copy is in the folder");
            ui.label(RichText::new(folder.display().to_string()).font(theme::strong(13.0)));
            ui.label("and is offered for recovery at the next start.");
            ui.add_space(2.0 * GRID);
            ui.muted("Please report this:");
            ui.add(egui::Label::new(RichText::new(&caught_panic.message).small()).wrap().selectable(true));
            ui.add_space(2.0 * GRID);
            ui.horizontal(|ui| {
                if primary(ui, "Quit", true).clicked() {
                    ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
                }
                if ui.button("Continue").clicked() {
                    model.caught_panic = None;
                }
                if ui.button("Copy the message").clicked() {
                    ui.ctx().copy_text(caught_panic.message.clone());
                }
            });
        });
    });
}
