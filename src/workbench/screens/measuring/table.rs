//! Table of poses, with actions for the selected one.

use egui::{Align, Layout, RichText, Role, Sense, Ui, WidgetInfo};
use egui_extras::{Column, TableBuilder};
use egui_material_icons::icons;

use super::PanelState;
use super::poses::{PoseRow, PoseStatus, rows};
use crate::model::Model;
use crate::model::command::Outbox;
use crate::model::command::{RobotCommand, ViewCommand};
use crate::model::edit::Edit;
use crate::theme::{self, GRID, Palette};
use crate::widgets::{UiExt, icon_button};
use tautline_workflow::wording::units::fixed;

pub(super) fn show(ui: &mut Ui, model: &Model, panel: &mut PanelState, outbox: &mut Outbox) {
    let Some(open) = &model.open else {
        return;
    };
    let session = open.session();
    let key = (open.id(), open.revision());
    let rows = panel.rows.get(key, || rows(session));
    if rows.is_empty() {
        return;
    }
    ui.section("Poses");
    let run = model.link.run.as_ref();
    let shown = TableState {
        selected: model.selection.pose,
        current: run.and_then(|run| run.current),
        skipped: &|label| run.is_some_and(|run| run.skipped.contains(&label)),
        is_new: panel.scrolled_to != model.selection.pose,
    };
    let clicked = table(ui, rows, &shown);
    panel.scrolled_to = model.selection.pose;
    let selected = rows
        .iter()
        .find(|row| Some(row.label) == model.selection.pose)
        .copied();
    if let Some(label) = clicked {
        outbox.send(ViewCommand::Select(model.selection.with_pose(label)));
    }
    match selected {
        Some(row) => actions(ui, model, outbox, row),
        None => {
            ui.muted("Select a pose to exclude, repeat or remove it.");
        }
    }
}

/// Present state for the table.
struct TableState<'a> {
    selected: Option<i64>,
    current: Option<i64>,
    skipped: &'a dyn Fn(i64) -> bool,
    /// Whether the selection changed since the last frame.
    is_new: bool,
}

fn table(ui: &mut Ui, rows: &[PoseRow], shown: &TableState<'_>) -> Option<i64> {
    let mut clicked = None;
    let height = 6.0 * GRID;
    ui.spacing_mut().item_spacing.y = 0.0;
    let place = rows
        .iter()
        .position(|row| Some(row.label) == shown.selected);
    // From all rows, so that the column width does not change while scrolling.
    let axis = |k: usize| width(ui, rows.iter().filter_map(|row| Some(row.position_mm?[k])));
    let axes = [0, 1, 2].map(axis);
    let turn = width(ui, rows.iter().filter_map(|row| row.rotation_deg));
    let mut table = TableBuilder::new(ui);
    if let Some(place) = place.filter(|_| shown.is_new) {
        table = table.scroll_to_row(place, None);
    }
    table
        .id_salt("poses")
        .sense(Sense::click())
        .cell_layout(Layout::right_to_left(Align::Center))
        .auto_shrink([false, true])
        // Whole rows, so that none is cut off.
        .max_scroll_height(10.0 * height)
        .column(Column::exact(14.0 * GRID))
        .column(Column::exact(axes[0]))
        .column(Column::exact(axes[1]))
        .column(Column::exact(axes[2]))
        .column(Column::exact(turn.max(18.0 * GRID)))
        .column(Column::remainder().at_least(20.0 * GRID).clip(true))
        .header(height, |mut header| {
            for head in [
                "Pose",
                "x (mm)",
                "y (mm)",
                "z (mm)",
                "Rotation (°)",
                "State",
            ] {
                header.col(|ui| {
                    ui.muted(head);
                });
            }
        })
        .body(|body| {
            body.rows(height, rows.len(), |mut line| {
                let Some(row) = rows.get(line.index()) else {
                    return;
                };
                let selected = shown.selected == Some(row.label);
                line.set_selected(selected);
                line.col(|ui| {
                    if name(ui, row.label, selected) {
                        clicked = Some(row.label);
                    }
                });
                for k in 0..3 {
                    line.col(|ui| {
                        let at = row.position_mm.map(|position| position[k]);
                        ui.label(at.map_or_else(String::new, |mm| fixed(mm, 1)));
                    });
                }
                line.col(|ui| {
                    let turn = row.rotation_deg;
                    ui.label(turn.map_or_else(String::new, |deg| fixed(deg, 1)));
                });
                line.col(|ui| {
                    let (words, colour) = words(row, shown, theme::of(ui));
                    ui.label(RichText::new(words).color(colour));
                });
                if line.response().clicked() {
                    clicked = Some(row.label);
                }
            });
        });
    clicked
}

/// Width of a column for numbers with one decimal.
fn width(ui: &Ui, values: impl Iterator<Item = f64>) -> f32 {
    let most = values.fold(0.0, |most: f64, value| most.max(value.abs()));
    let font = egui::TextStyle::Body.resolve(ui.style());
    let longest = fixed(-most.max(100.0), 1);
    let galley = ui
        .painter()
        .layout_no_wrap(longest, font, theme::of(ui).text);
    galley.size().x + GRID
}

/// Label of a pose, as a link; returns whether it was clicked.
fn name(ui: &mut Ui, label: i64, selected: bool) -> bool {
    let (text, name) = match label {
        0 => ("Home".to_owned(), "Home pose".to_owned()),
        _ => (label.to_string(), format!("Pose {label}")),
    };
    let response = ui.add(egui::Button::selectable(selected, text));
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, selected, &name));
    response.clicked()
}

fn words(
    row: &PoseRow,
    shown: &TableState<'_>,
    palette: &Palette,
) -> (&'static str, egui::Color32) {
    if shown.current == Some(row.label) {
        return ("in progress", palette.accent);
    }
    match row.standing {
        PoseStatus::Planned if (shown.skipped)(row.label) => ("skipped", palette.warning),
        PoseStatus::Planned => ("planned", palette.muted),
        PoseStatus::Measured => ("measured", palette.good),
        PoseStatus::Repeat => ("added", palette.good),
        PoseStatus::Excluded => ("excluded", palette.warning),
    }
}

fn actions(ui: &mut Ui, model: &Model, outbox: &mut Outbox, row: PoseRow) {
    let label = row.label;
    ui.add_space(GRID);
    ui.horizontal_wrapped(|ui| match row.standing {
        PoseStatus::Planned => {
            let free = !model.link.is_measuring();
            let remove = icon_button(ui, icons::ICON_DELETE, "Remove from plan", free);
            if remove.clicked() {
                outbox.send(RobotCommand::RemovePlanned(label));
            }
        }
        PoseStatus::Excluded => {
            if icon_button(ui, icons::ICON_VISIBILITY, "Include pose", true).clicked() {
                outbox.send(Edit::Include(label));
            }
        }
        PoseStatus::Measured | PoseStatus::Repeat if label == 0 => {
            ui.muted("The home pose cannot be excluded: revolutions are counted from it.");
        }
        PoseStatus::Measured | PoseStatus::Repeat => {
            let out = icon_button(ui, icons::ICON_VISIBILITY_OFF, "Exclude pose", true);
            if out.clicked() {
                outbox.send(Edit::Exclude(label));
            }
            let ready = model.link.is_armed();
            let repeat = icon_button(ui, icons::ICON_REPLAY, "Repeat pose", ready);
            let repeat = repeat.on_disabled_hover_text("Connect and arm the controller first");
            if repeat.clicked() {
                outbox.send(RobotCommand::Repeat(label));
            }
        }
    });
}
