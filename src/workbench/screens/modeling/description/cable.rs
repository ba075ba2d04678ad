//! One cable: its pulley, its anchor on the platform; more cables and fewer.

use egui::Ui;
use egui_material_icons::icons;
use tautline_core::robot::{Cable, PerAxis, Robot};

use super::field::{Field, change, grid, one, optional, three};
use crate::screens::bench_panel::Bench;
use crate::widgets::{icon_button, muted, section};

/// Draws the part.
pub fn show(ui: &mut Ui, bench: &mut Bench<'_>) {
    section(ui, "Cables");
    let count = bench.robot().cable_count();
    let chosen = bench.selection.cable.filter(|cable| *cable < count);
    let chosen = chosen.unwrap_or(0);
    bench.choose_cable(ui, chosen);
    let Some(cable) = bench.robot().cables.get(chosen) else {
        return;
    };
    let set = |change: fn(&mut Cable, [f64; 3])| {
        move |robot: &mut Robot, value: [f64; 3]| {
            if let Some(cable) = robot.cables.get_mut(chosen) {
                change(cable, value);
            }
        }
    };
    grid(ui, "fields of a cable", |ui| {
        three(
            ui,
            bench,
            &Field::millimetres("Entry point", 1),
            cable.pulley.entry_point_m,
            set(|cable, value| cable.pulley.entry_point_m = value),
        );
        three(
            ui,
            bench,
            &Field::millimetres("Platform anchor", 1),
            cable.platform_anchor_m,
            set(|cable, value| cable.platform_anchor_m = value),
        );
        one(
            ui,
            bench,
            &Field::millimetres("Radius of the pulley", 2),
            cable.pulley.radius_m,
            |robot, value| {
                if let Some(cable) = robot.cables.get_mut(chosen) {
                    cable.pulley.radius_m = value;
                }
            },
        );
        let sd = match cable.pulley.entry_point_sd_m {
            PerAxis::Same(sd) => Some(sd),
            PerAxis::Each(_) => None,
        };
        if let Some(sd) = sd {
            let field = Field::millimetres("Entry point known to", 1);
            optional(ui, bench, &field, (sd, true), |robot, value| {
                if let Some(cable) = robot.cables.get_mut(chosen) {
                    cable.pulley.entry_point_sd_m = PerAxis::Same(value);
                }
            });
        }
    });
    muted(
        ui,
        "The entry point is where the cable reaches the pulley, in the base frame. The direction in which it comes from the winch is that of the swivel axis, under Pulleys.",
    );
    number(ui, bench, chosen);
}

/// More cables, or fewer, as long as nothing was measured.
fn number(ui: &mut Ui, bench: &mut Bench<'_>, chosen: usize) {
    let count = bench.robot().cable_count();
    let is_free = bench.session().measurements.is_empty();
    ui.horizontal(|ui| {
        if icon_button(ui, icons::ICON_ADD, "Add a cable", is_free).clicked() {
            change(bench, "add a cable", |robot| {
                let mut cable = robot.cables[chosen].clone();
                cable.name = format!("cable-{}", robot.cables.len() + 1);
                // Beside the one that it is like, so that both can be seen.
                cable.pulley.entry_point_m[0] += 0.1;
                robot.cables.push(cable);
            });
        }
        let name = format!("Remove {}", bench.cable_name(chosen));
        if icon_button(ui, icons::ICON_DELETE, &name, is_free && count > 1).clicked() {
            change(bench, "remove a cable", |robot| {
                robot.cables.remove(chosen);
            });
        }
    });
    if !is_free {
        muted(
            ui,
            "The session has measured poses: the number of cables is theirs.",
        );
    }
}
