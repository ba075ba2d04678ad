//! Plots in separate windows.

use egui::{CentralPanel, Ui, ViewportBuilder, ViewportClass, ViewportId};
use egui_material_icons::icons;

use super::super::pane;
use super::Panes;
use crate::model::command::{Outbox, RobotCommand, STOP, ViewCommand};
use crate::model::{Model, Selection};
use crate::widgets::{icon_button, panel_frame};

/// Size of the window of a plot (points).
const WINDOW: [f32; 2] = [720.0, 460.0];

/// Draws the plots in separate windows, and stores the arrangement of all plots after a change.
pub(crate) fn show_detached(
    ui: &Ui,
    model: &Model,
    panes: &mut Panes,
    hovered: &mut Selection,
    outbox: &mut Outbox,
) {
    let Some(open) = &model.open else {
        return;
    };
    let is_behind = ui.memory(|memory| memory.top_modal_layer().is_some());
    for id in panes.detached.clone() {
        let Some(plot) = panes.plots.get_mut(&id) else {
            continue;
        };
        plot.settle(open);
        let title = id.title();
        let builder = ViewportBuilder::default()
            .with_title(format!("{title} \u{2013} Tautline"))
            .with_inner_size(WINDOW);
        let viewport = ViewportId::from_hash_of(("plot", id.name()));
        let draw = |ui: &mut Ui, class: ViewportClass| {
            let mut is_docked = false;
            // The Stop key works in every window.
            if ui.input_mut(|input| input.consume_shortcut(&STOP)) {
                outbox.send(RobotCommand::Stop);
            }
            if is_behind {
                ui.disable();
                ui.input_mut(|input| input.events.clear());
            }
            let mut content = |ui: &mut Ui| {
                is_docked = icon_button(ui, icons::ICON_CLOSE_FULLSCREEN, "Dock", true).clicked();
                pane(ui, model, plot, hovered, outbox);
            };
            if class == ViewportClass::EmbeddedWindow {
                content(ui);
                return is_docked;
            }
            CentralPanel::no_frame()
                .frame(panel_frame(ui))
                .show(ui, content);
            is_docked || ui.input(|input| input.viewport().close_requested())
        };
        if ui.ctx().show_viewport_immediate(viewport, builder, draw) {
            panes.dock(id);
        }
    }
    // A change by dragging is stored when the button is released.
    if !ui.input(|input| input.pointer.any_down())
        && let Some(plots) = panes.changed()
    {
        outbox.send(ViewCommand::SetPlots(plots));
    }
}
