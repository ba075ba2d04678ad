//! Readings as they come, and what still moves.

use egui::{Align, Grid, Layout, Sense, Ui, Vec2};
use tautline_link::measuring::Rates;

use super::run::name_of;
use crate::app::State;
use crate::app::commands::RobotCommand;
use crate::app::theme::{self, GRID};
use crate::widgets::muted;

/// A cable by colour and number.
pub(in crate::screens) fn cable_mark(ui: &mut Ui, index: usize, name: &str) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = GRID;
        let (rect, _) = ui.allocate_exact_size(Vec2::splat(2.5 * GRID), Sense::hover());
        let colour = theme::of(ui).cable(index);
        ui.painter()
            .circle_filled(rect.center(), 1.125 * GRID, colour);
        ui.label((index + 1).to_string()).on_hover_text(name);
    });
}

/// A number at the right of its cell.
fn number(ui: &mut Ui, text: &str) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.label(text);
    });
}

/// Draws the live readings.
pub(super) fn show(ui: &mut Ui, state: &mut State) {
    if !state.link.is_connected() {
        return;
    }
    let mut watches = state.link.watches;
    if !state.link.is_measuring() && ui.checkbox(&mut watches, "Show live readings").changed() {
        state.outbox.send(RobotCommand::Watch(watches));
    }
    if !watches && !state.link.is_measuring() {
        return;
    }
    let Some(sample) = state.link.live().sample else {
        muted(ui, "No readings yet.");
        return;
    };
    let grid = Grid::new("readings")
        .num_columns(3)
        .min_col_width(24.0 * GRID);
    grid.show(ui, |ui| {
        muted(ui, "Cable");
        for head in ["Revolutions", "Force reading, N"] {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| muted(ui, head));
        }
        ui.end_row();
        for (index, revolutions) in sample.revolutions.iter().enumerate() {
            cable_mark(ui, index, name_of(state, index));
            number(ui, &format!("{revolutions:.4}"));
            let force = sample.force_n.get(index);
            number(ui, &force.map_or_else(String::new, |f| format!("{f:.1}")));
            ui.end_row();
        }
    });
    ui.horizontal(|ui| {
        muted(ui, "Laser");
        match sample.laser_m {
            Some(laser_m) => {
                ui.label(format!("{:.2}", laser_m * 1e3));
                muted(ui, "mm");
            }
            None => {
                ui.colored_label(theme::of(ui).warning, "no distance");
            }
        }
    });
}

/// What still moves, against its limit.
pub(super) fn settling(ui: &mut Ui, place: &str, rates: Option<Rates>, limits: Rates) {
    muted(ui, &format!("At {place}, until it stands still."));
    let Some(rates) = rates else {
        return;
    };
    let channels = [
        (
            "Lengths",
            rates.length_m_per_s * 1e3,
            limits.length_m_per_s * 1e3,
            "mm/s",
        ),
        (
            "Tensions",
            rates.tension_n_per_s,
            limits.tension_n_per_s,
            "N/s",
        ),
        (
            "Laser",
            rates.laser_m_per_s * 1e3,
            limits.laser_m_per_s * 1e3,
            "mm/s",
        ),
    ];
    for (name, rate, limit, unit) in channels {
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
                muted(ui, &format!("of {limit:.2} {unit}"));
                ui.label(format!("{rate:.2}"));
            });
        });
    }
}
