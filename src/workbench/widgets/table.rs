//! Tables: numbers right-aligned, one row for each item; a click selects it.

use std::sync::Arc;

use egui::{Color32, Galley, Pos2, Rect, RichText, Role, ScrollArea, Sense, Ui, Vec2, WidgetInfo};
use egui_material_icons::MaterialIcon;

use super::row_ground;
use super::text::Verdict;
use crate::theme::{self, GRID};

#[derive(Debug, Clone, Copy)]
pub struct TableColumn<'a> {
    title: &'a str,
    unit: &'a str,
    numeric: bool,
}

impl<'a> TableColumn<'a> {
    #[must_use]
    pub const fn words(title: &'a str) -> Self {
        Self {
            title,
            unit: "",
            numeric: false,
        }
    }

    /// Column of numbers with a unit, which may be empty.
    #[must_use]
    pub const fn number(title: &'a str, unit: &'a str) -> Self {
        Self {
            title,
            unit,
            numeric: true,
        }
    }
}

#[derive(Debug, Clone, Default)]
pub struct Cell {
    pub(crate) text: String,
    icon: Option<MaterialIcon>,
    pub(crate) colour: Option<Color32>,
    dot: Option<Color32>,
}

impl Cell {
    #[must_use]
    pub fn new(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            ..Self::default()
        }
    }

    /// Verdict in words, with its icon and colour.
    #[must_use]
    pub fn verdict(ui: &Ui, verdict: Verdict, text: &str) -> Self {
        Self {
            icon: Some(verdict.icon()),
            colour: Some(verdict.colour(theme::of(ui))),
            ..Self::new(text)
        }
    }

    /// Sets a colour.
    #[must_use]
    pub fn coloured(self, colour: Color32) -> Self {
        Self {
            colour: Some(colour),
            ..self
        }
    }

    /// Adds a dot in a colour, such as that of a cable.
    #[must_use]
    pub fn with_dot(self, colour: Color32) -> Self {
        Self {
            dot: Some(colour),
            ..self
        }
    }
}

/// Interaction of the operator with a table.
#[derive(Debug, Clone, Copy, Default)]
pub struct TableResponse {
    pub clicked: Option<usize>,
    pub double_clicked: Option<usize>,
    pub hovered: Option<usize>,
}

/// Height of a header line (points).
const LINE: f32 = 4.0 * GRID;
/// Smallest gap between columns (points).
const GAP: f32 = 2.5 * GRID;
/// Smallest width to which a column of names is wrapped (points).
const NAME: f32 = 18.0 * GRID;
/// Diameter of a dot (points).
const DOT: f32 = 2.0 * GRID;
/// Space between the edge of a row and its text (points).
const MARGIN: f32 = GRID;

/// Draws a table; each row has a cell for each column; the row `selected` is highlighted.
pub fn table(
    ui: &mut Ui,
    columns: &[TableColumn<'_>],
    rows: &[Vec<Cell>],
    selected: Option<usize>,
) -> TableResponse {
    let mut galleys: Vec<Vec<Galleys>> = rows
        .iter()
        .map(|cells| cells.iter().map(|cell| Galleys::of(ui, cell)).collect())
        .collect();
    let heads: Vec<[Arc<Galley>; 2]> = columns
        .iter()
        .map(|column| [column.title, column.unit].map(|text| small(ui, text)))
        .collect();
    let mut widths: Vec<f32> = heads
        .iter()
        .enumerate()
        .map(|(k, head)| {
            let cells = galleys.iter().filter_map(|row| row.get(k));
            let widest = cells.map(Galleys::width).fold(0.0, f32::max);
            head.iter().fold(widest, |width, g| width.max(g.size().x))
        })
        .collect();
    let gaps = GAP * (widths.len().max(1) - 1) as f32 + 2.0 * MARGIN;
    let excess = widths.iter().sum::<f32>() + gaps - ui.available_width();
    if let (true, Some(first)) = (excess > 0.0, widths.first_mut()) {
        // Numbers are not wrapped; names take two lines.
        *first = first.min((*first - excess).max(NAME));
        for (cells, galleys) in rows.iter().zip(&mut galleys) {
            if let (Some(cell), Some(galley)) = (cells.first(), galleys.first_mut()) {
                galley.wrap(ui, cell, *first);
            }
        }
    }
    let needed = widths.iter().sum::<f32>() + gaps;
    let width = ui.available_width().max(needed);
    let extra = (width - needed) / (widths.len().max(2) - 1) as f32;
    let places = Places {
        widths,
        gap: GAP + extra,
        width,
    };
    let draw = |ui: &mut Ui| {
        header(ui, columns, &heads, &places);
        body(ui, columns, rows, &galleys, &places, selected)
    };
    let scope = ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        if needed <= ui.available_width() {
            return draw(ui);
        }
        let area = ScrollArea::horizontal().id_salt(ui.next_auto_id());
        area.max_width(ui.available_width()).show(ui, draw).inner
    });
    scope.inner
}

struct Places {
    widths: Vec<f32>,
    gap: f32,
    width: f32,
}

impl Places {
    /// Left edge of an item of this width in column `k` of a row that begins at `left`.
    fn x(&self, left: f32, k: usize, numeric: bool, width: f32) -> f32 {
        let before: f32 = self.widths[..k].iter().map(|w| w + self.gap).sum();
        let slack = if numeric { self.widths[k] - width } else { 0.0 };
        left + MARGIN + before + slack
    }
}

struct Galleys {
    icon: Option<Arc<Galley>>,
    text: Arc<Galley>,
    colour: Color32,
    dot: Option<Color32>,
}

fn layout(ui: &Ui, text: RichText, width: f32) -> Arc<Galley> {
    let mode = Some(egui::TextWrapMode::Wrap);
    egui::WidgetText::from(text).into_galley(ui, mode, width, egui::TextStyle::Body)
}

impl Galleys {
    fn of(ui: &Ui, cell: &Cell) -> Self {
        let colour = cell.colour.unwrap_or(theme::of(ui).text);
        let layout = |text: RichText| layout(ui, text, f32::INFINITY);
        Self {
            icon: cell.icon.map(|icon| layout(icon.rich_text().size(16.0))),
            text: layout(RichText::new(&cell.text)),
            colour,
            dot: cell.dot,
        }
    }

    /// Wraps the text of the cell.
    fn wrap(&mut self, ui: &Ui, cell: &Cell, width: f32) {
        let excess = self.width() - width;
        if excess > 0.0 {
            let room = self.text.size().x - excess;
            self.text = layout(ui, RichText::new(&cell.text), room);
        }
    }

    fn width(&self) -> f32 {
        let icon = self.icon.as_ref().map_or(0.0, |icon| icon.size().x + GRID);
        let dot = self.dot.map_or(0.0, |_| DOT + GRID);
        dot + icon + self.text.size().x
    }

    fn paint(&self, ui: &Ui, left: f32, middle: f32) {
        let mut x = left;
        if let Some(colour) = self.dot {
            let centre = Pos2::new(x + 0.5 * DOT, middle);
            ui.painter().circle_filled(centre, 0.5 * DOT, colour);
            x += DOT + GRID;
        }
        for galley in self.icon.iter().chain([&self.text]) {
            let place = Pos2::new(x, middle - 0.5 * galley.size().y);
            ui.painter()
                .galley_with_override_text_color(place, Arc::clone(galley), self.colour);
            x += galley.size().x + GRID;
        }
    }
}

fn small(ui: &Ui, text: &str) -> Arc<Galley> {
    let (font, colour) = (
        egui::TextStyle::Small.resolve(ui.style()),
        theme::of(ui).muted,
    );
    ui.painter().layout_no_wrap(text.to_owned(), font, colour)
}

fn body(
    ui: &mut Ui,
    columns: &[TableColumn<'_>],
    rows: &[Vec<Cell>],
    galleys: &[Vec<Galleys>],
    places: &Places,
    selected: Option<usize>,
) -> TableResponse {
    let mut touched = TableResponse::default();
    for (index, (cells, galleys)) in rows.iter().zip(galleys).enumerate() {
        let tallest = galleys.iter().map(|galley| galley.text.size().y + 2.0);
        let least = ui.spacing().interact_size.y;
        let size = Vec2::new(places.width, tallest.fold(least, f32::max));
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        response.widget_info(|| {
            let texts: Vec<&str> = cells.iter().map(|cell| cell.text.as_str()).collect();
            WidgetInfo::selected(
                Role::Button,
                true,
                selected == Some(index),
                texts.join(", "),
            )
        });
        row_ground(ui, &response, 2.0, selected == Some(index));
        for (k, (galley, column)) in galleys.iter().zip(columns).enumerate() {
            let x = places.x(rect.left(), k, column.numeric, galley.width());
            galley.paint(ui, x, rect.center().y);
        }
        if response.clicked() {
            touched.clicked = Some(index);
        }
        if response.double_clicked() {
            touched.double_clicked = Some(index);
        }
        if response.hovered() {
            touched.hovered = Some(index);
        }
    }
    touched
}

fn header(ui: &mut Ui, columns: &[TableColumn<'_>], heads: &[[Arc<Galley>; 2]], places: &Places) {
    let lines = if columns.iter().any(|column| !column.unit.is_empty()) {
        2.0
    } else {
        1.0
    };
    let size = Vec2::new(places.width, lines * LINE + GRID);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let palette = theme::of(ui);
    for (k, (head, column)) in heads.iter().zip(columns).enumerate() {
        for (galley, y) in head.iter().zip([0.0, LINE]) {
            let x = places.x(rect.left(), k, column.numeric, galley.size().x);
            let place = Pos2::new(x, rect.top() + y);
            ui.painter()
                .galley(place, Arc::clone(galley), palette.muted);
        }
    }
    let line = Rect::from_min_max(Pos2::new(rect.left(), rect.bottom() - 1.0), rect.max);
    ui.painter().rect_filled(line, 0.0, palette.line);
}
