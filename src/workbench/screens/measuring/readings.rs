//! Live readings and standstill.

use egui::{Align, Layout, Sense, Ui, Vec2};
use tautline_link::measuring::Rates;

use super::name_of;
use crate::model::Model;
use crate::model::command::Outbox;
use crate::model::command::{RobotCommand, ViewCommand};
use crate::theme::{self, GRID};
use crate::widgets::{Cell, TableColumn, UiExt, checkbox, table};
use tautline_workflow::wording::cable_label;
use tautline_workflow::wording::units::fixed;

/// Colour and number of a cable.
pub(super) fn cable_mark(ui: &mut Ui, index: usize, name: &str) {
    ui.horizontal(|ui| {
        dot(ui, index);
        ui.label(cable_label(index, name)).on_hover_text(name);
    });
}

fn dot(ui: &mut Ui, cable: usize) {
    ui.spacing_mut().item_spacing.x = GRID;
    let (rect, _) = ui.allocate_exact_size(Vec2::splat(2.5 * GRID), Sense::hover());
    let colour = theme::of(ui).cable(cable);
    ui.painter()
        .circle_filled(rect.center(), 1.125 * GRID, colour);
}

/// Colour and name of a cable as a link; returns whether it was clicked.
pub(super) fn cable_link(ui: &mut Ui, index: usize, name: &str) -> bool {
    ui.horizontal(|ui| {
        dot(ui, index);
        let link = ui.link(cable_label(index, name));
        let text = format!("Select {name}");
        link.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Link, true, &text));
        link.on_hover_text(text).clicked()
    })
    .inner
}

/// Columns of the live readings.
const COLUMNS: [TableColumn<'static>; 3] = [
    TableColumn::words("Cable"),
    TableColumn::number("Revolutions", "since home"),
    TableColumn::number("Force reading", "N"),
];

pub(super) fn show(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    if !model.link.is_connected() || model.link.is_measuring() {
        return;
    }
    let mut polls_when_idle = model.link.polls_when_idle;
    if checkbox(ui, &mut polls_when_idle, "Show live readings").changed() {
        outbox.send(RobotCommand::PollWhenIdle(polls_when_idle));
    }
    if !polls_when_idle {
        return;
    }
    let Some(sample) = model.link.live().sample else {
        ui.muted("No readings yet.");
        return;
    };
    let palette = theme::of(ui);
    let cables = sample.revolutions.iter().enumerate();
    let rows: Vec<Vec<Cell>> = cables
        .map(|(index, revolutions)| {
            let force = sample.force_n.get(index);
            vec![
                Cell::new(cable_label(index, name_of(model, index))).with_dot(palette.cable(index)),
                Cell::new(fixed(*revolutions, 4)),
                Cell::new(force.map_or_else(String::new, |force| fixed(*force, 1))),
            ]
        })
        .collect();
    let selected = model.selection.cable;
    if let Some(cable) = table(ui, &COLUMNS, &rows, selected).clicked {
        outbox.send(ViewCommand::Select(model.selection.with_cable(cable)));
    }
    ui.horizontal(|ui| {
        ui.muted("Laser");
        match sample.laser_m {
            Some(laser_m) => {
                ui.label(format!("{:.2}", laser_m * 1e3));
                ui.muted("mm");
            }
            None => {
                ui.colored_label(theme::of(ui).warning, "no distance");
            }
        }
    });
}

/// Rates of change compared with their limits.
pub(super) fn settling(ui: &mut Ui, rates: Option<Rates>, limits: Rates) {
    type ReadRate = fn(&Rates) -> f64;
    let Some(rates) = rates else {
        return;
    };
    let channels: [(&str, &str, f64, ReadRate); 3] = [
        ("Lengths", "mm/s", 1e3, |rates| rates.length_m_per_s),
        ("Tensions", "N/s", 1.0, |rates| rates.tension_n_per_s),
        ("Laser", "mm/s", 1e3, |rates| rates.laser_m_per_s),
    ];
    for (name, unit, per_si, of) in channels {
        let [rate, limit] = [rates, limits].map(|rates| of(&rates) * per_si);
        if limit <= 0.0 {
            continue;
        }
        let still = rate <= limit;
        ui.horizontal(|ui| {
            ui.label(name);
            let palette = theme::of(ui);
            let (words, colour) = if still {
                ("still", palette.good)
            } else {
                ("moving", palette.warning)
            };
            ui.colored_label(colour, words);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.muted(&format!("of {limit:.2} {unit}"));
                ui.label(format!("{rate:.2}"));
            });
        });
    }
}
