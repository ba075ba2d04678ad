//! Editor for rows of numbers: type, paste, change, remove.

use egui::{Align, Layout, RichText, Role, ScrollArea, TextEdit, Ui, Vec2, WidgetInfo};
use egui_material_icons::icons;

use super::button::{icon_button, icon_only};
use super::number::{Entered, Number, number, parse};
use super::text::UiExt;
use crate::theme::{self, GRID};

/// Largest number of columns.
pub const COLUMNS: usize = 3;
/// Row with one number for each column, in SI units; `None` if missing.
pub type Numbers = [Option<f64>; COLUMNS];

#[derive(Debug, Clone, Copy)]
pub struct RowField {
    /// Quantity of the column, such as "Length".
    pub title: &'static str,
    /// Unit of the displayed values.
    pub unit: &'static str,
    /// Display units per SI unit.
    pub per_si: f64,
    /// Number of decimals.
    pub decimals: usize,
    /// Whether a cell may be empty.
    pub optional: bool,
    /// Valid range (SI units).
    pub accepts: fn(f64) -> bool,
    /// Valid range in words, such as "a load of 0 or more".
    pub expects: &'static str,
}

impl RowField {
    /// Column of numbers without limits.
    #[must_use]
    pub const fn new(title: &'static str, unit: &'static str, decimals: usize) -> Self {
        Self {
            title,
            unit,
            per_si: 1.0,
            decimals,
            optional: false,
            accepts: f64::is_finite,
            expects: "a number",
        }
    }

    /// Column of lengths in millimetres.
    #[must_use]
    pub const fn millimetres(title: &'static str, decimals: usize) -> Self {
        Self {
            per_si: 1e3,
            ..Self::new(title, "mm", decimals)
        }
    }

    /// Restricts the valid range (SI units), described in words.
    #[must_use]
    pub const fn accepting(self, accepts: fn(f64) -> bool, expects: &'static str) -> Self {
        Self {
            accepts,
            expects,
            ..self
        }
    }

    /// Allows empty cells.
    #[must_use]
    pub const fn optional(self) -> Self {
        Self {
            optional: true,
            ..self
        }
    }
}

/// Edit of the operator.
#[derive(Debug, Clone, PartialEq)]
pub enum RowsEdit {
    /// Changed number: row, column, new value.
    Set(usize, usize, Option<f64>),
    Add(Vec<Numbers>),
    Remove(usize),
    /// Invalid input, with an error message.
    Wrong(String),
}

impl RowsEdit {
    /// Applies the edit to a list, of which the editor shows the items that satisfy `is_shown`. Rows with a missing
    /// number, which make no item, are skipped.
    pub fn apply<T>(
        self,
        list: &mut Vec<T>,
        is_shown: impl Fn(&T) -> bool,
        numbers: impl Fn(&T) -> Numbers,
        item: impl Fn(Numbers) -> Option<T>,
    ) {
        let place = |row: usize| (0..list.len()).filter(|k| is_shown(&list[*k])).nth(row);
        match self {
            Self::Set(row, column, value) => {
                let changed = place(row).and_then(|k| {
                    let mut numbers = numbers(&list[k]);
                    numbers[column] = value;
                    Some((k, item(numbers)?))
                });
                if let Some((k, changed)) = changed {
                    list[k] = changed;
                }
            }
            Self::Add(rows) => list.extend(rows.into_iter().filter_map(item)),
            Self::Remove(row) => {
                if let Some(k) = place(row) {
                    list.remove(k);
                }
            }
            Self::Wrong(_) => {}
        }
    }
}

#[derive(Debug, Clone, Copy)]
pub struct Rows<'a> {
    /// Noun for a row, such as "Pair".
    pub noun: &'a str,
    pub fields: &'a [RowField],
    pub rows: &'a [Numbers],
    /// Title and unit of the remarks; may be empty.
    pub remarks: (&'a str, &'a str),
    /// Remark for each row, such as its residual; may be empty.
    pub remark: &'a [String],
}

/// Width of the columns for number, remark and button, and the gap between columns (points).
const NUMBER: f32 = 5.0 * GRID;
const REMARK: f32 = 13.0 * GRID;
const BUTTON: f32 = 7.0 * GRID;
const SPACE: f32 = GRID;
/// Height of a row (points).
const HEIGHT: f32 = 7.0 * GRID;
/// Number of rows shown without scrolling.
const SHOWN: usize = 10;

/// Draws the rows, and below them a field for typing or pasting more.
pub fn rows(ui: &mut Ui, rows: &Rows<'_>, draft: &mut String) -> Option<RowsEdit> {
    let mut answer = None;
    let width = field_width(ui, rows);
    let count = rows.rows.len();
    if count > 0 {
        header(ui, rows, width);
    }
    let mut draw = |ui: &mut Ui, shown: std::ops::Range<usize>| {
        for index in shown {
            let size = Vec2::new(ui.available_width(), HEIGHT);
            let layout = Layout::left_to_right(Align::Center);
            ui.allocate_ui_with_layout(size, layout, |ui| {
                if let Some(edit) = row(ui, rows, index, width) {
                    answer = Some(edit);
                }
            });
        }
    };
    if count > SHOWN {
        let height = (HEIGHT + ui.spacing().item_spacing.y) * SHOWN as f32;
        ScrollArea::vertical()
            .id_salt(rows.noun)
            .max_height(height)
            .min_scrolled_height(height)
            .auto_shrink([false, true])
            .show_rows(ui, HEIGHT, count, |ui, shown| draw(ui, shown));
    } else {
        draw(ui, 0..count);
    }
    add(ui, rows, draft).or(answer)
}

/// Width of a field at which the rows fill the panel.
fn field_width(ui: &Ui, rows: &Rows<'_>) -> f32 {
    let count = rows.fields.len() as f32;
    let fixed = NUMBER + REMARK + BUTTON + SPACE * (count + 2.0);
    // The scroll bar needs some of the width.
    ((ui.available_width() - fixed - 4.0 * GRID) / count).clamp(16.0 * GRID, 28.0 * GRID)
}

fn cell(ui: &mut Ui, width: f32, text: &str) {
    let layout = Layout::right_to_left(Align::Center);
    let size = Vec2::new(width, ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.set_min_width(width);
        let colour = theme::of(ui).muted;
        ui.label(RichText::new(text).small().color(colour));
    });
}

fn header(ui: &mut Ui, rows: &Rows<'_>, width: f32) {
    let (title, unit) = rows.remarks;
    let titles = rows.fields.iter().map(|field| [field.title, field.unit]);
    let cells: Vec<([&str; 2], f32)> = [(["", ""], NUMBER)]
        .into_iter()
        .chain(titles.map(|texts| (texts, width)))
        .chain([([title, unit], REMARK)])
        .collect();
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing = Vec2::new(SPACE, 0.0);
        ui.spacing_mut().interact_size.y = 4.0 * GRID;
        for line in 0..2 {
            ui.horizontal(|ui| {
                for (texts, width) in &cells {
                    cell(ui, *width, texts[line]);
                }
            });
        }
    });
}

fn titled(field: &RowField) -> String {
    let mut words = field.unit.to_owned();
    if field.optional {
        words.push_str(", optional");
    }
    match words.as_str() {
        "" => field.title.to_owned(),
        words => format!("{} ({words})", field.title),
    }
}

fn row(ui: &mut Ui, rows: &Rows<'_>, index: usize, width: f32) -> Option<RowsEdit> {
    let mut answer = None;
    ui.spacing_mut().item_spacing.x = SPACE;
    let noun = rows.noun;
    cell(ui, NUMBER, &(index + 1).to_string());
    for (column, (field, value)) in rows.fields.iter().zip(rows.rows[index]).enumerate() {
        let name = format!("{} of {} {}", field.title, noun.to_lowercase(), index + 1);
        let value = value.map(|value| value * field.per_si);
        let shown = Number::of(&name, value, field.decimals, "", width);
        answer = match number(ui, &shown.optional(field.optional)) {
            None => answer,
            Some(Entered::Nothing) => Some(RowsEdit::Set(index, column, None)),
            Some(Entered::Wrong(message)) => Some(RowsEdit::Wrong(message)),
            Some(Entered::Value(value)) => Some(match in_si(field, value) {
                Ok(value) => RowsEdit::Set(index, column, Some(value)),
                Err(message) => RowsEdit::Wrong(format!("{name}: {message}.")),
            }),
        };
    }
    let remark = rows.remark.get(index).map_or("", String::as_str);
    cell(ui, REMARK, remark);
    let name = format!("Remove {} {}", noun.to_lowercase(), index + 1);
    if icon_only(ui, icons::ICON_DELETE, &name, true).clicked() {
        answer = Some(RowsEdit::Remove(index));
    }
    answer
}

fn in_si(field: &RowField, value: f64) -> Result<f64, String> {
    let si = value / field.per_si;
    if (field.accepts)(si) {
        Ok(si)
    } else {
        Err(format!(
            "found {value} {}, expected {}",
            field.unit, field.expects
        ))
    }
}

fn add(ui: &mut Ui, rows: &Rows<'_>, draft: &mut String) -> Option<RowsEdit> {
    let titles: Vec<String> = rows.fields.iter().map(titled).collect();
    let name = format!("{}s to add", rows.noun);
    ui.muted(&format!(
        "Type or paste one row per line: {}",
        titles.join(", ")
    ));
    let field = TextEdit::multiline(draft)
        .desired_rows(2)
        .desired_width(f32::INFINITY);
    ui.add(field)
        .widget_info(|| WidgetInfo::labeled(Role::MultilineTextInput, true, &name));
    let typed = !draft.trim().is_empty();
    let button = format!("Add {}s", rows.noun.to_lowercase());
    if !icon_button(ui, icons::ICON_ADD, &button, typed).clicked() {
        return None;
    }
    Some(match parse_rows(draft, rows.fields) {
        Ok(rows) => {
            draft.clear();
            RowsEdit::Add(rows)
        }
        Err(message) => RowsEdit::Wrong(format!("{name}, {message}.")),
    })
}

/// Parses rows: one per line, with numbers separated by tabs, semicolons or blanks, or by commas that are not decimal
/// commas.
///
/// # Errors
/// The first invalid line, with what was found and expected.
pub fn parse_rows(text: &str, fields: &[RowField]) -> Result<Vec<Numbers>, String> {
    let lines = text.lines().enumerate();
    let lines = lines.filter(|(_, line)| !line.trim().is_empty());
    lines
        .map(|(index, line)| {
            let row = parse_row(line, fields);
            row.map_err(|message| format!("line {}: {message}", index + 1))
        })
        .collect()
}

fn split(line: &str) -> Vec<&str> {
    let line = line.trim_end();
    for separator in ['\t', ';'] {
        if line.contains(separator) {
            return line.split(separator).map(str::trim).collect();
        }
    }
    let words: Vec<&str> = line.split_whitespace().collect();
    // In "1, 2" the comma separates, in "1,5 2,5" it is decimal.
    if words.len() < 2 || words.iter().rev().skip(1).all(|word| word.ends_with(',')) {
        return line.split(',').map(str::trim).collect();
    }
    words
}

fn parse_row(line: &str, fields: &[RowField]) -> Result<Numbers, String> {
    let cells = split(line);
    let needed = fields.iter().filter(|field| !field.optional).count();
    if cells.len() < needed || cells.len() > fields.len() {
        let titles: Vec<&str> = fields.iter().map(|field| field.title).collect();
        let (found, expected) = (cells.len(), titles.join(", ").to_lowercase());
        return Err(format!("found {found} numbers, expected {expected}"));
    }
    let mut row = [None; COLUMNS];
    for ((value, field), cell) in row.iter_mut().zip(fields).zip(cells) {
        if cell.is_empty() && field.optional {
            continue;
        }
        let parsed = parse(cell).and_then(|number| in_si(field, number));
        *value =
            Some(parsed.map_err(|message| format!("{}: {message}", field.title.to_lowercase()))?);
    }
    Ok(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELDS: [RowField; 3] = [
        RowField::new("Revolutions", "", 3),
        RowField::millimetres("Length", 3).accepting(|value| value.abs() <= 1e3, "at most 1 km"),
        RowField::new("Tension", "N", 1)
            .accepting(|value| value >= 0.0, "0 or more")
            .optional(),
    ];

    #[test]
    fn pasted_rows_are_understood() {
        let two = [Some(1.0), Some(0.1255), None];
        let three = [Some(1.0), Some(0.1255), Some(20.0)];
        for (text, row) in [
            ("1 125.5", two),
            ("1, 125.5", two),
            ("1,125.5", two),
            ("1\t125,5", two),
            ("1;125,5;20", three),
            ("1,0 125,5 20", three),
            ("1\t125.5\t", two),
        ] {
            assert_eq!(parse_rows(text, &FIELDS), Ok(vec![row]), "{text}");
        }
        let rows = parse_rows("1 125.5\n\n1 125.5 20\n", &FIELDS);
        assert_eq!(rows, Ok(vec![two, three]));
    }

    #[test]
    fn a_wrong_line_is_named() {
        for (text, expected) in [
            (
                "1 2\n1",
                "line 2: found 1 numbers, expected revolutions, length, tension",
            ),
            ("1 abc", "line 1: length: found \"abc\", expected a number"),
            ("1 2 -5", "line 1: tension: found -5 N, expected 0 or more"),
        ] {
            let message = parse_rows(text, &FIELDS).expect_err(text);
            assert!(message.contains(expected), "{message}");
        }
    }
}
