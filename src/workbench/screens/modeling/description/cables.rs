//! Editable table of all cables, and their number.

use egui::{Align, Color32, Event, Grid, Label, Layout, RichText, ScrollArea, Ui, Vec2};
use egui_material_icons::icons;
use tautline_workflow::wording::count;
use tautline_workflow::wording::units::fixed;

use super::field::{change, put};
use crate::screens::bench_panel::Bench;
use crate::screens::modeling::cable_table::{COLUMNS, CableTable, Empty, is_block};
use crate::theme::{self, GRID};
use crate::widgets::{Entered, Number, UiExt, icon_button, number, width_of};

/// Height of a row of the table (points).
const ROW: f32 = 6.5 * GRID;
const LEAST_WIDTH: f32 = 12.0 * GRID;

/// Cell with the keyboard focus, by row and column.
pub(crate) type FocusedCell = Option<(usize, usize)>;

/// Changed table with the name of the change, or an error message.
pub(crate) type Edited = Result<(CableTable, String), String>;

pub(super) fn show(ui: &mut Ui, bench: &mut Bench<'_>, focused: &mut FocusedCell) {
    ui.section("Cables");
    let table = CableTable::of(bench.robot());
    match grid(ui, &table, focused, false) {
        Some(Ok((table, what))) => match table.applied_to(bench.robot()) {
            Ok(robot) => put(bench, robot, &what),
            Err(message) => bench.refuse(message),
        },
        Some(Err(message)) => bench.refuse(message),
        None => {}
    }
    if let Some((row, _)) = *focused
        && bench.selection.cable != Some(row)
    {
        bench.select_cable(row);
    }
    hints(ui);
    add_and_remove(ui, bench);
}

pub(crate) fn hints(ui: &mut Ui) {
    ui.muted("Pulley: where the cable reaches it, and the direction in which it comes from the winch (swivel axis), along x, y and z of the base frame in the 3D view. Anchor: in the frame of the platform. Cells of a spreadsheet are pasted at the selected cell, to the right and below.");
}

/// Draws the table, with a fixed column of names. `may_lack` allows required numbers to be empty.
pub(crate) fn grid(
    ui: &mut Ui,
    table: &CableTable,
    focused: &mut FocusedCell,
    may_lack: bool,
) -> Option<Edited> {
    focused.take_if(|(row, _)| *row >= table.names.len());
    let mut edited = focused.and_then(|cell| paste(ui, table, cell.into(), may_lack));
    *focused = None;
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing = Vec2::new(2.0 * GRID, 0.0);
        Grid::new("names of the cables")
            .min_row_height(ROW)
            .show(ui, |ui| names(ui, table));
        let id = ui.make_persistent_id("columns that are seen");
        let known: Option<ShownColumns> = ui.data(|data| data.get_temp(id));
        let available = ui.available_width();
        let mut right = Vec::new();
        let mut area = ScrollArea::horizontal()
            .id_salt("numbers of the cables")
            .max_width(known.map_or(available, |known| known.width));
        if let Some(jump) = known.and_then(|known| known.jump) {
            area = area.horizontal_scroll_offset(jump);
        }
        let scrolled = area.show(ui, |ui| {
            Grid::new("numbers of the cables")
                .min_row_height(ROW)
                .spacing([GRID, 0.0])
                .show(ui, |ui| {
                    let (cells, edges) = numbers(ui, table, focused, may_lack);
                    right = edges;
                    edited = edited.take().or(cells);
                });
            // Keeps the scroll bar off the last row.
            ui.add_space(3.0 * GRID);
        });
        let offset = scrolled.state.clamped_offset().x;
        let is_moving = |known: &ShownColumns| known.jump.is_none() && known.offset != offset;
        let is_dragged = ui.input(|input| input.pointer.any_down());
        let shown = match known {
            Some(known) if is_dragged || is_moving(&known) => ShownColumns {
                offset,
                jump: None,
                ..known
            },
            _ => ShownColumns::at_rest(offset, known, available, &right),
        };
        if known != Some(shown) {
            ui.data_mut(|data| data.insert_temp(id, shown));
            ui.ctx().request_repaint();
        }
    });
    edited
}

/// Visible part of the numbers (points): whole columns, once scrolling has stopped.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ShownColumns {
    offset: f32,
    /// Offset when scrolling stopped last.
    origin: f32,
    width: f32,
    /// Offset of the next frame.
    jump: Option<f32>,
}

impl ShownColumns {
    /// Visible part after scrolling: the next column in the direction of scrolling and those that fit beside it.
    /// `right` has the right edges of all columns.
    fn at_rest(offset: f32, before: Option<Self>, available: f32, right: &[f32]) -> Self {
        let origin = before.map_or(0.0, |before| before.origin);
        let left = std::iter::once(0.0).chain(right.iter().map(|edge| edge + GRID));
        let mut left = left.take(right.len());
        let first = match offset < origin {
            true => left.filter(|left| *left <= offset + 1.0).last(),
            false => left.find(|left| *left >= offset - 1.0),
        };
        let first = first.unwrap_or(0.0);
        let mut widths = right.iter().rev().map(|edge| edge - first);
        let width = widths.find(|width| *width <= available && *width > 0.0);
        let width = width.unwrap_or(available);
        // The width limits the offset of the next frame, so it changes first.
        if before.is_none_or(|before| before.width != width) {
            return Self {
                offset,
                origin,
                width,
                jump: None,
            };
        }
        Self {
            offset: first,
            origin: first,
            width,
            jump: ((first - offset).abs() > 0.5).then_some(first),
        }
    }
}

fn names(ui: &mut Ui, table: &CableTable) {
    head(ui, "Cable", "");
    ui.end_row();
    ui.add(Label::new("All").extend());
    ui.end_row();
    for (k, name) in table.names.iter().enumerate() {
        ui.horizontal(|ui| {
            let colour: Color32 = theme::of(ui).cable(k);
            ui.label(RichText::new("●").color(colour).small());
            ui.add_space(GRID);
            ui.add(Label::new(name).extend());
        });
        ui.end_row();
    }
}

/// Title and unit in two lines.
fn head(ui: &mut Ui, title: &str, unit: &str) {
    let text = RichText::new(format!("{title}\n{unit}"));
    let text = text.small().color(theme::of(ui).muted);
    ui.add(Label::new(text).extend().halign(Align::RIGHT));
}

/// Draws headings and numbers; returns an edit and the right edges of the columns.
fn numbers(
    ui: &mut Ui,
    table: &CableTable,
    focused: &mut FocusedCell,
    may_lack: bool,
) -> (Option<Edited>, Vec<f32>) {
    let mut edited = None;
    let left = ui.min_rect().left();
    let heads = COLUMNS.iter().map(|column| {
        let layout = Layout::right_to_left(Align::Min);
        let cell = ui.with_layout(layout, |ui| head(ui, column.title, column.unit));
        cell.response.rect.right() - left
    });
    let edges = heads.collect();
    ui.end_row();
    let widths: Vec<f32> = (0..COLUMNS.len()).map(|k| width(ui, table, k)).collect();
    for (k, column) in COLUMNS.iter().enumerate() {
        if !column.is_common() {
            ui.label("");
            continue;
        }
        let name = format!("{} of all cables", column.title);
        if let Some(entered) = cell(ui, &name, k, widths[k], table.common(k), may_lack).0 {
            edited = Some(entered.map(|value| {
                let mut table = table.clone();
                table.set_all(k, value);
                (table, format!("change {}", name.to_lowercase()))
            }));
        }
    }
    ui.end_row();
    for (row, values) in table.cells.iter().enumerate() {
        for (k, value) in values.iter().enumerate() {
            let name = table.cell_name(row, k);
            let (entered, has_focus) = cell(ui, &name, k, widths[k], *value, may_lack);
            if has_focus {
                *focused = Some((row, k));
            }
            if let Some(entered) = entered {
                edited = Some(entered.map(|value| {
                    let mut table = table.clone();
                    table.cells[row][k] = value;
                    (table, format!("change {}", name.to_lowercase()))
                }));
            }
        }
        ui.end_row();
    }
    (edited, edges)
}

/// Width of the cells of a column (points), for its longest number.
fn width(ui: &Ui, table: &CableTable, column: usize) -> f32 {
    let values = table.cells.iter().filter_map(|row| row[column]);
    let texts = values.map(|value| fixed(value, COLUMNS[column].decimals));
    texts
        .map(|text| width_of(ui, &text))
        .fold(LEAST_WIDTH, f32::max)
}

/// Draws a cell; returns its input and whether it has the focus.
fn cell(
    ui: &mut Ui,
    name: &str,
    column: usize,
    width: f32,
    value: Option<f64>,
    may_lack: bool,
) -> (Option<Result<Option<f64>, String>>, bool) {
    let column = &COLUMNS[column];
    let field = Number::of(name, value, column.decimals, "", width)
        .optional(may_lack || column.empty != Empty::Missing);
    let entered = number(ui, &field).map(|entered| match entered {
        Entered::Value(value) => Ok(Some(value)),
        Entered::Nothing => Ok(None),
        Entered::Wrong(message) => Err(message),
    });
    (entered, ui.memory(|m| m.has_focus(field.text_id(ui))))
}

/// Handles a pasted block of cells before the text field of the focused cell receives it.
fn paste(ui: &Ui, table: &CableTable, [row, column]: [usize; 2], may_lack: bool) -> Option<Edited> {
    let mut pasted = None;
    ui.input_mut(|input| {
        input.events.retain_mut(|event| match event {
            Event::Paste(text) if is_block(text) => {
                pasted = Some(std::mem::take(text));
                false
            }
            _ => true,
        });
    });
    let mut table = table.clone();
    let done = table.paste(row, column, &pasted?, may_lack);
    Some(done.map(|cells| (table, format!("paste {}", count(cells, "cell")))))
}

/// Buttons to add and remove cables, as long as nothing was measured.
fn add_and_remove(ui: &mut Ui, bench: &mut Bench<'_>) {
    let count = bench.robot().cable_count();
    let chosen = bench.selection.cable.filter(|cable| *cable < count);
    let chosen = chosen.unwrap_or(count - 1);
    let is_free = bench.session().measurements.is_empty();
    ui.horizontal(|ui| {
        if icon_button(ui, icons::ICON_ADD, "Add a cable", is_free).clicked() {
            change(bench, "add a cable", |robot| {
                let mut cable = robot.cables[chosen].clone();
                cable.name = format!("cable-{}", robot.cables.len() + 1);
                // Moved from the cable it copies, so that both are visible.
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
        ui.muted("The session has measured poses: the number of cables is fixed.");
    }
}
