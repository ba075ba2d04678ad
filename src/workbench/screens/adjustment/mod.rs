//! Panel of the phase Adjustment: controller values beside identified ones, writing, verification.

mod checks;
mod firmware;
mod record;
mod reveal;
mod table;
mod typed;
mod verification;

use egui::{Button, Ui};
use egui_material_icons::icons;

use super::measuring::controller;
use crate::model::command::Outbox;
use crate::model::command::{Export, RobotCommand};
use crate::model::link::LinkRequest;
use crate::model::next_step::of_values;
use crate::model::{Memo, Model, OpenSession};
use crate::theme::GRID;
use crate::widgets::{UiExt, icon_button};
use tautline_workflow::accuracy::Figure;
use tautline_workflow::adjusting::{self, Review};
use tautline_workflow::controllers::RobotKind;
use tautline_workflow::plot::figure;
use tautline_workflow::wording::sentence;

pub(crate) use table::lines;

/// Accuracy before and after, the error (m) predicted by the identification, and their plot; or an error of the rows.
type Figures = Result<(Vec<Figure>, Option<f64>, figure::Figure), String>;

/// State of the panel between frames.
#[derive(Debug, Default)]
pub struct PanelState {
    /// Whether unchanged parameters are shown as well.
    all: bool,
    figures: Memo<(u64, u64, bool), Figures>,
    /// Pose typed at a target.
    typed: typed::TargetPoseInput,
}

pub fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    ui.heading("Adjustment");
    if model.link.verifying.is_some() {
        return verification::under_way(ui, model, panel, outbox);
    }
    ui.muted("The identified values are written to the controller; an external instrument verifies the result.");
    let Some(open) = &model.open else {
        return;
    };
    let current = open.fit_is_current();
    match current {
        true => doubt(ui, model, open),
        false => missing(ui, open),
    }
    let review = model.review();
    let is_held = adjusting::written(open.session(), &review.lines).is_some();
    verification::result(ui, open, panel, is_held);
    checks::show(ui, open, &review.lines);
    controller::show(ui, model, outbox);
    if current {
        compare(ui, model, open, panel, outbox, &review);
        write(ui, model, outbox, &review);
        firmware::show(ui, model, outbox);
    }
    record::show(ui, open);
    verification::show(ui, model, panel, outbox);
    reveal::show(ui, open, outbox);
}

/// Warns against values that could make the robot less accurate.
fn doubt(ui: &mut Ui, model: &Model, open: &OpenSession) {
    if let Some(problem) = of_values(model, open) {
        ui.bad(&format!("{} {}", problem.text, problem.then));
    }
}

/// Names the missing poses or identification.
fn missing(ui: &mut Ui, open: &OpenSession) {
    let text = if open.session().measurements.is_empty() {
        "Nothing is identified: no poses are measured yet."
    } else if open.fit().is_some() {
        "The data changed after the last identification. Identify again before anything is written."
    } else {
        "The pulleys are not identified yet: there is nothing to write."
    };
    ui.neutral(text);
}

fn compare(
    ui: &mut Ui,
    model: &Model,
    open: &OpenSession,
    panel: &mut PanelState,
    outbox: &mut Outbox,
    review: &Review,
) {
    ui.section("Controller and identified model");
    if !model.link.is_connected() {
        let is_recorded = review.lines.iter().any(|line| line.controller.is_some());
        ui.muted(match is_recorded {
            true => {
                "Controller: the values that this session recorded. Connect to read them again."
            }
            false => "Connect the controller to compare its values with the identified ones.",
        });
    }
    table::show(ui, model, open, panel, outbox, &review.lines);
    adaptation(ui, review);
    let kind = model.robot_kind();
    let simulated = matches!(kind, Some(RobotKind::OfSession | RobotKind::OfDescription));
    if !review.effects.is_empty() && simulated {
        let free = !model.link.is_busy();
        let text = "Add these parameters to the simulated controller";
        let button = ui.add_enabled(free, Button::new(text));
        if button.on_hover_text("Connects and arms it again").clicked() {
            outbox.send(RobotCommand::ConnectAndArm);
        }
    }
    ui.horizontal_wrapped(|ui| {
        let connected = model.link.is_connected() && !model.link.is_busy();
        if icon_button(ui, icons::ICON_SYNC, "Read back", connected).clicked() {
            outbox.send(LinkRequest::ReadParameters);
        }
        if icon_button(ui, icons::ICON_DOWNLOAD, "Export table…", true).clicked() {
            outbox.send(RobotCommand::AskExport(Export::Differences));
        }
        let text = icon_button(ui, icons::ICON_CODE, "Export for TwinCAT…", true);
        let text = text.on_hover_text("A block of constants in Structured Text (IEC 61131-3)");
        if text.clicked() {
            outbox.send(RobotCommand::AskExport(Export::StructuredText));
        }
    });
}

fn write(ui: &mut Ui, model: &Model, outbox: &mut Outbox, review: &Review) {
    let changes = review.changes().count();
    ui.add_space(GRID);
    let kind = model.robot_kind();
    let writable = kind != Some(RobotKind::Recording);
    let ready = model.link.is_armed() && !model.link.is_busy() && writable;
    ui.horizontal_wrapped(|ui| {
        let text = Button::new("Write to the controller");
        if ui.add_enabled(ready && changes > 0, text).clicked() {
            outbox.send(RobotCommand::Write);
        }
        let back = model.revertible().is_some();
        if icon_button(ui, icons::ICON_UNDO, "Roll back", ready && back).clicked() {
            outbox.send(RobotCommand::RollBack);
        }
    });
    if !model.link.is_connected() {
        return;
    }
    if let Some(why) = adjusting::refusal(&review.lines) {
        ui.bad(&format!("{}.", sentence(&why)));
    } else if changes == 0 {
        ui.good("The controller holds the identified values.");
    } else {
        let note = match kind {
            Some(RobotKind::OfDescription) => {
                " This controller is simulated: a real one does not change."
            }
            Some(RobotKind::Recording) => " This is a recording: nothing can be written to it.",
            _ => "",
        };
        let differ = match changes {
            1 => "1 value differs from that of the controller.".to_owned(),
            several => format!("{several} values differ from those of the controller."),
        };
        ui.muted(&(differ + note));
    }
}

/// Says how the values make up for effects that the controller cannot hold.
pub(crate) fn adaptation(ui: &mut Ui, review: &Review) {
    if let Some(adaptation) = &review.adaptation {
        let text = format!("{}.", adaptation.sentence);
        match adaptation.doubt() {
            Some(_) => ui.doubtful(&text),
            None => ui.neutral(&text),
        }
    }
}
