//! The controller: connected, armed, moving.

use egui::{ComboBox, Ui};
use egui_material_icons::icons;
use tautline_link::Activity;

use super::{Next, step_button};
use crate::app::State;
use crate::app::commands::RobotCommand;
use crate::app::theme;
use crate::controllers::Kind;
use crate::widgets::{Verdict, icon_button, muted, section, verdict};

/// Speeds that are offered for simulated robots.
const SPEEDS: [f64; 4] = [1.0, 2.0, 5.0, 20.0];

/// Draws connection and arming.
pub(in crate::screens) fn show(ui: &mut Ui, state: &mut State, next: Next) {
    section(ui, "Controller");
    let Some(document) = &state.document else {
        return;
    };
    let kind = Kind::offered(document.session());
    let live = state.link.live();
    let Some(controller) = live.state else {
        if kind == Kind::OfDescription {
            muted(
                ui,
                "No controller of a real robot can be connected yet: import poses.csv instead. A robot simulated from \
                 this description can be connected to try the procedure.",
            );
        }
        let pressed = step_button(
            ui,
            "Connect the simulated robot",
            next == Next::Connect,
            true,
        );
        if pressed {
            state.outbox.send(RobotCommand::Connect);
        }
        return;
    };
    if kind == Kind::OfDescription {
        verdict(
            ui,
            Verdict::Doubtful,
            "Simulated from the description: the readings are not of the real robot.",
        );
    }
    let palette = theme::of(ui);
    let (words, colour) = match (&controller.activity, controller.armed) {
        (Activity::Fault(text), _) => (format!("fault: {text}"), palette.bad),
        (Activity::Moving, _) => ("armed, moving".to_owned(), palette.warning),
        (_, true) => ("armed, standing".to_owned(), palette.warning),
        (_, false) => (
            "not armed: it neither moves nor changes".to_owned(),
            palette.muted,
        ),
    };
    ui.horizontal_wrapped(|ui| {
        ui.label(&state.link.identity);
        ui.label(egui::RichText::new(words).color(colour));
    });
    ui.horizontal_wrapped(|ui| {
        if controller.armed {
            let text = "Disarm";
            if icon_button(ui, icons::ICON_LOCK, text, true).clicked() {
                state.outbox.send(RobotCommand::Disarm);
            }
        } else if step_button(ui, "Arm", next == Next::Arm, true) {
            state.outbox.send(RobotCommand::Arm);
        }
        let free = !state.link.is_busy();
        if icon_button(ui, icons::ICON_LINK_OFF, "Disconnect", free).clicked() {
            state.outbox.send(RobotCommand::Disconnect);
        }
        speed(ui, state);
    });
}

/// How fast the time of a simulated robot runs.
fn speed(ui: &mut Ui, state: &mut State) {
    let mut speed = state.link.speed();
    let before = speed;
    let words = |speed: f64| format!("{speed:.0}x speed");
    let chosen = ComboBox::from_id_salt("speed")
        .selected_text(words(speed))
        .width(88.0)
        .show_ui(ui, |ui| {
            for offered in SPEEDS {
                ui.selectable_value(&mut speed, offered, words(offered));
            }
        });
    chosen.response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Speed of the simulation")
    });
    if speed != before {
        state.outbox.send(RobotCommand::Speed(speed));
    }
}
