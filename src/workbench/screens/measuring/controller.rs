//! The controller: connection, arming, speed.

use std::time::Instant;

use egui::{Button, ComboBox, Ui};
use egui_material_icons::icons;
use tautline_link::Activity;

use crate::model::Model;
use crate::model::command::{Outbox, RobotCommand, Setup};
use crate::model::link::{LinkRequest, LostConnection};
use crate::theme;
use crate::widgets::{UiExt, combo_box, icon_button};
use tautline_workflow::controllers::RobotKind;

/// Time factors offered for simulated robots.
const SPEEDS: [f64; 4] = [1.0, 2.0, 5.0, 20.0];

/// Draws connection and arming.
pub(in crate::screens) fn show(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    ui.section("Controller");
    let Some(open) = &model.open else {
        return;
    };
    let live = model.link.live();
    if let Some(lost) = &live.lost {
        return gone(ui, outbox, lost);
    }
    let offered = RobotKind::offered(open.session());
    let Some(controller) = live.state else {
        return connect(ui, model, outbox, offered);
    };
    let connected = model.link.connected.as_ref();
    let kind = connected.map_or(offered, |connected| connected.rig.kind);
    let note = match kind {
        RobotKind::OfDescription => {
            Some("Simulated from the description: the readings are not of the real robot.")
        }
        RobotKind::Recording => {
            Some("This is a recording: nothing moves and nothing can be written.")
        }
        RobotKind::OfSession | RobotKind::Real => open.session().robot.unchecked_tensions(),
    };
    if let Some(note) = note {
        ui.doubtful(note);
    }
    let palette = theme::of(ui);
    let (words, colour) = match (&controller.activity, controller.armed) {
        (Activity::Fault(text), _) => (format!("fault: {text}"), palette.bad),
        (Activity::Moving, _) => ("armed, moving".to_owned(), palette.warning),
        (_, true) => ("armed, idle".to_owned(), palette.warning),
        (_, false) => ("not armed: no motion, no writing".to_owned(), palette.muted),
    };
    ui.horizontal_wrapped(|ui| {
        ui.label(&model.link.identity);
        ui.label(egui::RichText::new(words).color(colour));
    });
    ui.horizontal_wrapped(|ui| {
        if controller.armed {
            let text = "Disarm";
            if icon_button(ui, icons::ICON_LOCK, text, true).clicked() {
                outbox.send(LinkRequest::Disarm);
            }
        } else if ui.button("Arm").clicked() {
            outbox.send(RobotCommand::Arm);
        }
        let free = !model.link.is_busy();
        if icon_button(ui, icons::ICON_LINK_OFF, "Disconnect", free).clicked() {
            outbox.send(LinkRequest::Disconnect);
        }
        if kind != RobotKind::Real {
            speed(ui, model, outbox);
        }
    });
    if kind == RobotKind::Real && !controller.armed && model.link.is_measuring() {
        ui.muted("The run is paused. Arming does not move the robot; press Resume to continue.");
    }
}

/// Without a connection.
fn connect(ui: &mut Ui, model: &Model, outbox: &mut Outbox, offered: RobotKind) {
    let text = match offered {
        RobotKind::OfSession | RobotKind::OfDescription => "Connect the simulated robot",
        RobotKind::Recording => "Connect the recording",
        RobotKind::Real => "Connect the controller",
    };
    if offered == RobotKind::OfDescription {
        ui.muted("Choose the controller of the real robot, or try the procedure on a robot that is simulated from this \
             description.");
    }
    let free = !model.link.connecting;
    ui.horizontal_wrapped(|ui| {
        if ui.add_enabled(free, Button::new(text)).clicked() {
            outbox.send(RobotCommand::Connect);
        }
        let choose = Button::new("Choose controller…");
        if ui.add_enabled(free, choose).clicked() {
            outbox.send(RobotCommand::Setup(Setup::Open));
        }
        if !free {
            ui.spinner();
            ui.muted("Connecting…");
        }
    });
}

/// While a lost connection is being re-established.
fn gone(ui: &mut Ui, outbox: &mut Outbox, lost: &LostConnection) {
    ui.bad(&format!("{} The robot is disarmed.", lost_words(lost)));
    let why = tautline_workflow::wording::sentence(lost.why.trim_end_matches('.'));
    let why = egui::RichText::new(format!("{why}.")).color(theme::of(ui).muted);
    ui.wrapped(why);
    ui.horizontal_wrapped(|ui| {
        if icon_button(ui, icons::ICON_SYNC, "Reconnect now", true).clicked() {
            outbox.send(LinkRequest::TryNow);
        }
        if icon_button(ui, icons::ICON_LINK_OFF, "Stop reconnecting", true).clicked() {
            outbox.send(LinkRequest::Disconnect);
        }
    });
}

/// Text on a lost connection and the time of the next attempt.
#[must_use]
pub fn lost_words(lost: &LostConnection) -> String {
    let left = lost.due.saturating_duration_since(Instant::now());
    match left.as_secs_f64().ceil() {
        seconds if seconds > 0.0 => {
            format!("Connection lost, reconnecting in {seconds:.0} s.")
        }
        _ => "Connection lost, reconnecting.".to_owned(),
    }
}

/// Choice of the time factor of a simulated robot.
fn speed(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let mut speed = model.link.speed();
    let before = speed;
    let words = |speed: f64| format!("{speed:.0}x speed");
    let list = ComboBox::from_id_salt("speed").width(88.0);
    let selected = words(speed);
    combo_box(ui, list, "Speed of the simulation", &selected, |ui| {
        for offered in SPEEDS {
            ui.selectable_value(&mut speed, offered, words(offered));
        }
    });
    if speed != before {
        outbox.send(RobotCommand::Speed(speed));
    }
}
