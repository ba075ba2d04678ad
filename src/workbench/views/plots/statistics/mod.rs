//! Table of statistics of the identification: readings with their reliability, identified values with their intervals.

mod columns;
mod rows;

use std::sync::Arc;

use egui::{
    Align, ComboBox, IntoAtoms, Layout, RichText, Role, Sense, TextEdit, Ui, UiBuilder, WidgetInfo,
};
use egui_extras::{Column, TableBuilder};
use egui_material_icons::icons;
use tautline_workflow::identification::Identification;
use tautline_workflow::wording::count;

use crate::model::command::{Outbox, ViewCommand};
use crate::model::{Memo, Selection};
use crate::theme::{self, GRID};
use crate::views::plots::kind::{Content, PlotKind, no_options};
use crate::widgets::{UiExt, combo_box, icon_button, icon_only};
use columns::VisibleColumns;
use rows::{
    Heading, Listing, ListingKey, Order, StatisticsKind, StatisticsRow, arranged, listing, text,
};

pub(crate) static PLOT: PlotKind = PlotKind {
    id: "statistics",
    title: "Statistics",
    missing: |open| {
        let is_missing = open.fit().is_none();
        is_missing.then_some(
            "Redundancies, smallest detectable errors and intervals appear here after identification.",
        )
    },
    options: no_options,
    content: Content::Statistics,
};

/// Width (points) below which buttons have only icons.
const NARROW: f32 = 480.0;
/// Width (points) beside the filter at which the number of rows fits there.
const COUNTED: f32 = 220.0;

/// State of the table.
#[derive(Debug, Default)]
pub(crate) struct Statistics {
    kind: StatisticsKind,
    orders: [Option<Order>; 2],
    /// First visible paged column of each table.
    from: [usize; 2],
    filter: String,
    all: Memo<ListingKey, Listing>,
    shown: Memo<(ListingKey, Option<Order>, String), Vec<usize>>,
}

/// Draws the table; `hovered` is the selection under the pointer, in all views.
pub(super) fn show(
    ui: &mut Ui,
    fit: &Arc<Identification>,
    state: &mut Statistics,
    selection: Selection,
    hovered: &mut Selection,
    outbox: &mut Outbox,
) {
    let of = ListingKey {
        kind: state.kind,
        fit: Arc::clone(fit),
    };
    let order = state.orders[state.kind as usize];
    let Listing { heads, rows } = state.all.get(of.clone(), || listing(&of));
    let filter = state.filter.trim().to_lowercase();
    let key = (of.clone(), order, filter.clone());
    let shown = state.shown.get(key, || arranged(rows, order, &filter));
    let bar = ui.spacing().scroll.allocated_width();
    let (room, space) = (ui.available_width() - bar, ui.spacing().item_spacing.x);
    let from = &mut state.from[of.kind as usize];
    let seen = VisibleColumns::of(heads, of.kind.names(), *from, room, space);
    let is_narrow = ui.available_width() < NARROW;
    ui.horizontal(|ui| {
        choose_kind(ui, &mut state.kind);
        let field = TextEdit::singleline(&mut state.filter).hint_text("Filter by name");
        let width = if is_narrow { 96.0 } else { 140.0 };
        ui.add(field.desired_width(width))
            .widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Filter the table"));
        leaf(ui, &seen, of.kind.names(), from);
        if ui.available_width() > COUNTED {
            ui.muted(&number_of(shown.len(), rows.len()));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let button = if is_narrow { icon_only } else { icon_button };
            if button(ui, icons::ICON_CONTENT_COPY, "Copy table", true).clicked() {
                ui.ctx().copy_text(text(heads, rows, shown));
            }
        });
    });
    let order = &mut state.orders[of.kind as usize];
    let content = TableContent {
        heads,
        columns: &seen,
        rows,
        shown,
    };
    table(ui, &content, order, selection, hovered, outbox);
}

/// Buttons that page through the columns.
fn leaf(ui: &mut Ui, seen: &VisibleColumns, names: usize, from: &mut usize) {
    let first = seen.others.start - names;
    let [left, right] = seen.more;
    if !(left || right) {
        return;
    }
    if icon_only(ui, icons::ICON_CHEVRON_LEFT, "Columns to the left", left).clicked() {
        *from = first.saturating_sub(seen.others.len());
    }
    if icon_only(ui, icons::ICON_CHEVRON_RIGHT, "Columns to the right", right).clicked() {
        *from = first + seen.others.len();
    }
}

fn choose_kind(ui: &mut Ui, chosen: &mut StatisticsKind) {
    let title = |kind: StatisticsKind| StatisticsKind::ALL.iter().find(|(k, _)| *k == kind);
    let title = title(*chosen).map_or("", |(_, title)| title);
    let list = ComboBox::from_id_salt("statistics of");
    combo_box(ui, list, &format!("Statistics of: {title}"), title, |ui| {
        for (value, title) in StatisticsKind::ALL {
            ui.selectable_value(chosen, value, title);
        }
    });
}

fn number_of(shown: usize, all: usize) -> String {
    match shown == all {
        true => count(all, "row"),
        false => format!("{shown} of {}", count(all, "row")),
    }
}

/// What the table shows: its visible columns, and the rows that are left by the filter, in their order.
struct TableContent<'a> {
    heads: &'a [Heading],
    columns: &'a VisibleColumns,
    rows: &'a [StatisticsRow],
    shown: &'a [usize],
}

fn table(
    ui: &mut Ui,
    content: &TableContent<'_>,
    order: &mut Option<Order>,
    selection: Selection,
    hovered: &mut Selection,
    outbox: &mut Outbox,
) {
    let TableContent {
        heads,
        columns: seen,
        rows,
        shown,
    } = *content;
    let palette = theme::of(ui);
    let id = ui.scope_id().with(("statistics", heads.len()));
    let mut table = TableBuilder::new(ui)
        .id_salt(id)
        .sense(Sense::click())
        .cell_layout(Layout::left_to_right(Align::Center));
    let others = heads[seen.others.clone()].iter().map(|head| head.width);
    for width in seen.names.iter().copied().chain(others) {
        table = table.column(Column::exact(width).clip(true));
    }
    let header = |mut row: egui_extras::TableRow<'_, '_>| {
        for column in seen.places() {
            row.col(|ui| heading(ui, &heads[column], column, order));
        }
    };
    table.header(6.0 * GRID, header).body(|body| {
        body.rows(5.5 * GRID, shown.len(), |mut line| {
            let row = &rows[shown[line.index()]];
            let is_selected = row.selects != Selection::default() && row.selects == selection;
            line.set_selected(is_selected);
            for (head, cell) in seen.places().map(|k| (&heads[k], &row.cells[k])) {
                line.col(|ui| {
                    let colour = if row.is_suspect && head.title == "Standardised" {
                        palette.warning
                    } else {
                        palette.text
                    };
                    let label = egui::Label::new(RichText::new(cell).color(colour))
                        .selectable(false)
                        .truncate();
                    aligned(ui, head, |ui| {
                        ui.add(label);
                    });
                });
            }
            let response = line.response();
            let name = row.cells.join(", ");
            response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_selected, &name));
            if response.hovered() {
                *hovered = row.selects;
            }
            if response.clicked() {
                let chosen = match is_selected {
                    true => Selection::default(),
                    false => row.selects,
                };
                outbox.send(ViewCommand::Select(chosen));
            }
        });
    });
}

/// Adds content to a cell on the side of its text; it takes no space, so that the cell does not grow.
fn aligned(ui: &mut Ui, head: &Heading, add: impl FnOnce(&mut Ui)) {
    let layout = match head.is_number {
        true => Layout::right_to_left(Align::Center),
        false => Layout::left_to_right(Align::Center),
    };
    let cell = UiBuilder::new().max_rect(ui.max_rect()).layout(layout);
    add(&mut ui.new_child(cell));
}

/// Heading that sorts by its column: ascending, then descending, then in the original order.
fn heading(ui: &mut Ui, head: &Heading, column: usize, order: &mut Option<Order>) {
    let own = order.filter(|order| order.column == column);
    let icon = own.map(|order| match order.descending {
        true => icons::ICON_ARROW_DOWNWARD,
        false => icons::ICON_ARROW_UPWARD,
    });
    let state = match own {
        None => "",
        Some(order) if order.descending => ", sorted, largest first",
        Some(_) => ", sorted, smallest first",
    };
    aligned(ui, head, |ui| {
        let text = RichText::new(head.title).small();
        let content = match icon {
            Some(icon) => (text, icon.rich_text().size(12.0)).into_atoms(),
            None => text.into_atoms(),
        };
        let button = egui::Button::new(content).frame(false);
        let response = ui.add(button).on_hover_text(head.help);
        let name = format!("Sort by {}{state}", head.title.to_lowercase());
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
        if response.clicked() {
            *order = match own {
                None => Some(Order {
                    column,
                    descending: false,
                }),
                Some(order) if !order.descending => Some(Order {
                    descending: true,
                    ..order
                }),
                Some(_) => None,
            };
        }
    });
}
