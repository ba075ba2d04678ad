//! Rows above a plot: options, cursor readings, saving.

use std::sync::Arc;

use egui::{Align, Layout, Popup, Ui};
use egui_material_icons::icons;

use super::PlotState;
use super::kind::OptionsInput;
use super::sources::variable;
use super::view::CursorColumn;
use crate::model::command::{Format, Outbox, PlotCommand};
use crate::model::{Model, OpenSession};
use crate::widgets::{Cell, TableColumn, icon_only, table};
use tautline_workflow::plot::Figure;

/// Width (points) below which choices are menus.
const NARROW: f32 = 420.0;

/// Draws options, cursor readings and buttons.
pub(crate) fn options(
    ui: &mut Ui,
    model: &Model,
    open: &OpenSession,
    plots: &mut PlotState,
    figure: &Arc<Figure>,
    outbox: &mut Outbox,
) {
    let is_narrow = ui.available_width() < NARROW;
    ui.horizontal(|ui| {
        // Two combo boxes leave no room for buttons.
        let has_menu = is_narrow && plots.kind == &variable::PLOT;
        let prepared = plots.prepared().cloned();
        let input = OptionsInput {
            open,
            prepared: prepared.as_deref(),
            is_narrow,
        };
        (plots.kind.options)(ui, &mut plots.options, &input);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if has_menu {
                menu(ui, plots, figure);
            } else {
                buttons(ui, plots, figure);
            }
        });
    });
    if let Some(format) = plots.saving.take()
        && let Some(file) = plots
            .view
            .file(ui, plots.kind.title, figure, model.selection, format)
    {
        let title = plots.kind.title.to_lowercase().replace(' ', "-");
        let name = format!("{title}.{}", format.ending());
        outbox.send(PlotCommand::AskSave(name, file));
    }
    if let Some(columns) = plots.view.readings(figure) {
        cursors(ui, &columns);
    }
}

/// Height of a row of the table of cursors (points).
const CURSOR_ROW: f32 = 16.0;

/// Table of the cursor readings.
fn cursors(ui: &mut Ui, columns: &[CursorColumn]) {
    let heads = columns
        .iter()
        .map(|column| TableColumn::number(&column.title, &column.unit));
    let heads: Vec<TableColumn<'_>> = [TableColumn::words("")].into_iter().chain(heads).collect();
    let names = ["A", "B", "B \u{2212} A"].into_iter().enumerate();
    let row = |(k, name): (usize, &str)| {
        let values = columns.iter().map(|column| Cell::new(&column.values[k]));
        [Cell::new(name)].into_iter().chain(values).collect()
    };
    let rows: Vec<Vec<Cell>> = names.map(row).collect();
    ui.scope(|ui| {
        ui.spacing_mut().interact_size.y = CURSOR_ROW;
        table(ui, &heads, &rows, None);
    });
}

fn buttons(ui: &mut Ui, plots: &mut PlotState, figure: &Figure) {
    let save = icon_only(ui, icons::ICON_DOWNLOAD, "Save plot", true);
    Popup::menu(&save).show(|ui| formats(ui, plots));
    if icon_only(ui, icons::ICON_FIT_SCREEN, "Reset view", true).clicked() {
        plots.view.reset();
    }
    let name = cursors_name(plots);
    if icon_only(ui, icons::ICON_ARROW_RANGE, name, true).clicked() {
        plots.view.switch_cursors(figure);
    }
}

/// Menu with the buttons, for a narrow plot.
fn menu(ui: &mut Ui, plots: &mut PlotState, figure: &Figure) {
    let more = icon_only(ui, icons::ICON_MORE_VERT, "This plot", true);
    Popup::menu(&more).show(|ui| {
        if ui.button(cursors_name(plots)).clicked() {
            plots.view.switch_cursors(figure);
            ui.close();
        }
        if ui.button("Reset view").clicked() {
            plots.view.reset();
            ui.close();
        }
        ui.separator();
        formats(ui, plots);
    });
}

fn formats(ui: &mut Ui, plots: &mut PlotState) {
    for format in Format::ALL {
        if ui.button(format.title()).clicked() {
            plots.saving = Some(format);
            ui.close();
        }
    }
}

fn cursors_name(plots: &PlotState) -> &'static str {
    match plots.view.cursors.is_some() {
        true => "Hide cursors",
        false => "Show cursors",
    }
}
