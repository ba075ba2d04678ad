//! Hidden fault of a demonstration beside the findings.

use egui::Ui;
use tautline_core::effect::{BoundEffect, EffectSetting};
use tautline_core::robot::Robot;

use crate::model::OpenSession;
use crate::model::command::Outbox;
use crate::model::command::RobotCommand;
use crate::widgets::UiExt;

/// Draws the button, or the revealed faults.
pub(super) fn show(ui: &mut Ui, open: &OpenSession, outbox: &mut Outbox) {
    let session = open.session();
    let Some(simulator) = &session.simulator else {
        return;
    };
    ui.section("The demonstration");
    if !simulator.revealed {
        ui.muted("This robot has a hidden random fault. Reveal it last.");
        if ui.button("Reveal the hidden fault").clicked() {
            outbox.send(RobotCommand::Reveal);
        }
        return;
    }
    let fit = open.current_fit();
    let model = fit.map(|fit| &fit.model);
    for hidden in &simulator.truth.effects {
        effect(ui, &session.robot, hidden, model);
    }
    let added = model.map_or(&[][..], |model| &model.effects);
    for extra in added {
        let mut hidden = simulator.truth.effects.iter();
        let real = hidden.any(|hidden| same(hidden, extra));
        if !real && !session.robot.effects.contains(extra) {
            ui.doubtful(&format!(
                "In the model but not in the robot: {}",
                words(&session.robot, extra)
            ));
        }
    }
    ui.muted("RMS distance of the pulleys from their true positions:");
    let drawn = distance_m(&session.robot, &simulator.truth);
    ui.value("Nominal", &format!("{:.2}", drawn * 1e3), "mm");
    if let Some(model) = model {
        let found = distance_m(model, &simulator.truth);
        ui.value("Identified", &format!("{:.2}", found * 1e3), "mm");
    } else {
        ui.muted("Nothing is identified from the current data.");
    }
}

fn effect(ui: &mut Ui, robot: &Robot, hidden: &EffectSetting, model: Option<&Robot>) {
    ui.label(format!("Hidden: {}", words(robot, hidden)));
    let found = model.and_then(|model| model.effects.iter().find(|known| same(known, hidden)));
    match found {
        Some(found) => {
            ui.good(&format!("Found: {}", words(robot, found)));
        }
        None => ui.doubtful(
            "Not found: the identified model has no such effect. Diagnose the model in phase 4.",
        ),
    }
}

fn same(a: &EffectSetting, b: &EffectSetting) -> bool {
    a.effect == b.effect && a.targets == b.targets
}

/// Cause in words, with its size.
fn words(robot: &Robot, setting: &EffectSetting) -> String {
    BoundEffect::from_setting(setting, robot)
        .map_or_else(|error| error.to_string(), |bound| bound.cause(robot))
}

/// Root mean square distance of the entry points of two robots (m).
fn distance_m(a: &Robot, b: &Robot) -> f64 {
    let pairs = a.cables.iter().zip(&b.cables);
    let squares: Vec<f64> = pairs
        .map(|(a, b)| {
            let (a, b) = (a.pulley.entry_point_m, b.pulley.entry_point_m);
            (0..3).map(|k| (a[k] - b[k]).powi(2)).sum()
        })
        .collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}
