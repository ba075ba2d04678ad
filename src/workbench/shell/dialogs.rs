//! Modal dialogs: unsaved changes, writing, report.

use std::collections::BTreeSet;

use egui::{Grid, RichText, TextEdit, Ui};

use super::{State, save};
use crate::model::command::{
    Answer, DIAGNOSING, FileCommand, HypothesisCommand, IDENTIFYING, Outbox, ReportCommand,
    ReportDraft, RobotCommand, WriteDraft,
};
use crate::model::phase::Screen;
use crate::model::{self, Model};
use crate::screens::adjustment::{identify_without, lines};
use crate::theme::{self, GRID};
use crate::widgets::{
    Entered, Number, Verdict, checkbox, entered, heading, modal, muted, number, primary, section,
    verdict,
};
use tautline_workflow::report::{Part, ReportChoice};
use tautline_workflow::wording::count;

/// Draws the question that is open, if one is.
pub fn show(ui: &mut Ui, state: &mut State) {
    // Where to save is asked above it.
    if state.model.dialogs.save.is_none() {
        leaving(ui, state);
        unsaved_hypothesis(ui, state);
    }
    elsewhere(ui, state);
    if let Some(draft) = state.model.dialogs.writing.take() {
        writing(ui, state, draft);
    }
    if let Some(draft) = state.model.dialogs.report.take() {
        report(ui, state, draft);
    }
}

/// Where is the report to be saved?
fn report(ui: &mut Ui, state: &mut State, mut draft: ReportDraft) {
    let format = draft.format;
    let ((), is_left) = modal(ui, ("save report", 520.0), |ui| {
        heading(ui, &format!("Save the report as {}", format.title()));
        let is_of_session = matches!(state.model.screen, Screen::Phase(_));
        if is_of_session {
            out_of_date(ui, &state.model, &mut state.outbox);
        }
        let asked = save::form(ui, &mut draft.form, None);
        if asked.browse {
            state.outbox.send(ReportCommand::Browse(format));
        }
        let height = (ui.ctx().content_rect().height() - 180.0).max(80.0);
        egui::ScrollArea::vertical()
            .max_height(height)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                head(ui, &mut draft.choice);
                if is_of_session {
                    parts(ui, &mut draft.choice);
                }
            });
        ui.add_space(2.0 * GRID);
        ui.horizontal(|ui| {
            let can_save = draft.form.can_save();
            let is_saved = primary(ui, "Save report", can_save).clicked();
            if let Some(path) = draft
                .form
                .target()
                .filter(|_| is_saved || asked.entered && can_save)
            {
                state.outbox.send(ReportCommand::Save(path));
            }
            if ui.button("Cancel").clicked() {
                state.outbox.send(ReportCommand::Cancel);
            }
        });
    });
    if is_left {
        state.outbox.send(ReportCommand::Cancel);
    }
    let options = &state.views.robot_3d.options;
    draft.pinned = match options.callouts {
        true => options.pinned.clone(),
        false => BTreeSet::new(),
    };
    state.model.dialogs.report = Some(draft);
}

/// What is out of date, with buttons that compute it again.
fn out_of_date(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let mut computing = [IDENTIFYING, DIAGNOSING].into_iter();
    if let Some(title) = computing.find(|title| model.tasks.runs(title)) {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(format!("{title}…"));
        });
        return;
    }
    for part in model::out_of_date(model) {
        verdict(ui, Verdict::Doubtful, part.sentence);
        if let Some((name, command)) = part.remedy
            && ui.button(name).clicked()
        {
            outbox.send(command);
        }
    }
}

fn head(ui: &mut Ui, choice: &mut ReportChoice) {
    section(ui, "Heading");
    Grid::new("head of the report")
        .num_columns(2)
        .spacing([3.0 * GRID, 1.5 * GRID])
        .show(ui, |ui| {
            for (name, text, hint) in [
                ("Title", &mut choice.title, "Name of the session"),
                ("Header line", &mut choice.header, "None"),
                ("Company", &mut choice.company, "None"),
                ("Operator", &mut choice.operator, "None"),
            ] {
                let label = ui.label(name);
                let field = TextEdit::singleline(text)
                    .hint_text(hint)
                    .desired_width(320.0);
                ui.add(field).labelled_by(label.id);
                ui.end_row();
            }
        });
}

/// By what a report judges, and which sections it has.
fn parts(ui: &mut Ui, choice: &mut ReportChoice) {
    ui.horizontal(|ui| {
        ui.label("Tolerance of the pulleys");
        let shown = Number {
            name: "Tolerance of the pulleys (mm)",
            value: choice.tolerance_m.map(|m| 1e3 * m),
            decimals: 2,
            unit: "mm",
            optional: true,
            width: 90.0,
        };
        match number(ui, &shown) {
            Some(Entered::Nothing) => choice.tolerance_m = None,
            Some(Entered::Value(mm)) if mm > 0.0 => choice.tolerance_m = Some(1e-3 * mm),
            Some(Entered::Value(_) | Entered::Wrong(_)) | None => {}
        }
        muted(ui, "Without one, no verdict is given.");
    });
    section(ui, "Sections");
    Grid::new("parts of the report")
        .num_columns(2)
        .spacing([6.0 * GRID, GRID])
        .show(ui, |ui| {
            for (k, part) in Part::ALL.iter().enumerate() {
                let mut wanted = !choice.without.contains(part);
                if checkbox(ui, &mut wanted, part.title()).changed() {
                    if wanted {
                        choice.without.remove(part);
                    } else {
                        choice.without.insert(*part);
                    }
                }
                if k % 2 == 1 {
                    ui.end_row();
                }
            }
        });
}

/// Save the changes first, and may an armed robot be disconnected?
fn leaving(ui: &mut Ui, state: &mut State) {
    let State { model, outbox, .. } = state;
    let Some(draft) = &model.dialogs.leaving else {
        return;
    };
    let is_unsaved = draft.leaving.ends_session() && model.is_unsaved();
    let (answer, is_left) = modal(ui, ("leaving", 420.0), |ui| {
        heading(
            ui,
            match is_unsaved {
                true => "Save the changes?",
                false => "Disconnect the armed robot?",
            },
        );
        if is_unsaved {
            let name = model.open.as_ref().map_or("", |open| &open.session().name);
            ui.label(format!("{name} has changes that no file has yet."));
        }
        if model.link.can_move() {
            let text = format!(
                "{} is armed: it will be stopped and disconnected.",
                model.link.identity
            );
            verdict(ui, Verdict::Doubtful, &text);
        }
        if let Some(why) = &draft.failure {
            verdict(ui, Verdict::Bad, why);
        }
        ui.add_space(2.0 * GRID);
        let answers: &[(&str, Answer)] = match is_unsaved {
            true if draft.leaving.keeps_session() => {
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

/// Answers side by side, of which the first is the primary one.
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

/// Is a session taken over from another window?
fn elsewhere(ui: &mut Ui, state: &mut State) {
    let Some((opening, since)) = &state.model.dialogs.elsewhere else {
        return;
    };
    let (answer, is_left) = modal(ui, ("elsewhere", 460.0), |ui| {
        heading(ui, &format!("Open in another window since {since}"));
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

/// What becomes of the text of a hypothesis that is in no file?
fn unsaved_hypothesis(ui: &mut Ui, state: &mut State) {
    let State { model, outbox, .. } = state;
    let Some(draft) = model
        .hypothesis
        .draft
        .as_ref()
        .filter(|_| model.hypothesis.asking.is_some())
    else {
        return;
    };
    let into_session = draft.checked().is_ok() && model.open.is_some();
    let (answer, is_left) = modal(ui, ("unsaved hypothesis", 420.0), |ui| {
        heading(ui, "Save the hypothesis?");
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

/// Write these values, and in whose name?
fn writing(ui: &mut Ui, state: &mut State, mut draft: WriteDraft) {
    let review = &draft.review;
    let open = state.model.open.as_ref();
    let cables = open.map_or(&[][..], |open| &open.session().robot.cables);
    let (answer, is_left) = modal(ui, ("write values", 600.0), |ui| {
        heading(ui, "Write these values?");
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
            verdict(ui, Verdict::Doubtful, &format!("{}.", doubt.sentence));
        }
        let is_sound = draft.doubts.is_empty();
        if !is_sound {
            ui.label("Such values can make the robot less accurate.");
        }
        let is_left =
            review.unsupported.is_some() && identify_without(ui, review, &mut state.outbox);
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
        let hint = "Enter your name: who writes is kept in the record";
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
                false => (cancelled || is_left).then_some(false),
            }
        })
        .inner
    });
    if let Some(answer) = answer.or(is_left.then_some(false)) {
        state.outbox.send(RobotCommand::ConfirmWrite(answer));
    }
    state.model.dialogs.writing = Some(draft);
}

/// Draws what is left of the window after an internal error.
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
            heading(ui, "Internal error");
            ui.label("The session is unchanged and nothing that was measured is lost. A copy is in the folder");
            ui.label(RichText::new(folder.display().to_string()).font(theme::strong(13.0)));
            ui.label("and is offered for recovery at the next start.");
            ui.add_space(2.0 * GRID);
            muted(ui, "Please report this:");
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
