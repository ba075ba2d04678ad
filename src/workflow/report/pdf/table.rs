//! Tables on pages: as wide as needed, text wrapped where there is no room, the heading repeated on every page.

use super::layout::{LEFT, Layout, SMALL, Style, WIDTH};
use super::wrap::wrap;
use crate::plot::drawing::{Anchor, Shape};
use crate::report::colours;
use crate::report::document::{Align, Table};

/// Space beside the text of a cell (pt).
const PADDING: f64 = 5.0;
/// Space above and below the text of a row (pt).
const ROW_SPACE: f64 = 1.5;
/// Smallest width of a column of wrapped text (pt).
const NARROWEST: f64 = 56.0;
/// Steps by which such columns become narrower (pt).
const STEP: f64 = 4.0;
/// Height below which a table is kept on one page (pt).
const KEPT_WHOLE: f64 = 180.0;
/// Number of rows that stay with the heading.
const WITH_HEADING: usize = 2;

const CELL: Style = Style {
    size: 8.5,
    leading: 11.5,
    bold: false,
    colour: colours::DARK,
};
const HEAD: Style = Style {
    size: 8.0,
    leading: 11.0,
    bold: true,
    colour: colours::MUTED,
};

/// Cells of a row, as lines.
type Lines = Vec<Vec<String>>;

impl Layout<'_> {
    /// Lays out a table.
    pub fn table(&mut self, table: &Table) {
        let (widths, scale) = self.widths(table);
        let style = |style: Style| Style {
            size: scale * style.size,
            leading: scale * style.leading,
            ..style
        };
        let (cell, head) = (style(CELL), style(HEAD));
        let headings: Vec<&str> = table
            .columns
            .iter()
            .map(|(text, _)| text.as_str())
            .collect();
        let headings = self.lines(&headings, &widths, head);
        let rows: Vec<Lines> = table
            .rows
            .iter()
            .map(|row| {
                let cells: Vec<&str> = row.iter().map(String::as_str).collect();
                self.lines(&cells, &widths, cell)
            })
            .collect();
        let caption = wrap(self.faces, &table.caption, SMALL.size, SMALL.bold, WIDTH);
        let of_rows = |count: usize| -> f64 {
            let rows = rows.iter().take(count);
            rows.map(|row| height(row, cell)).sum()
        };
        let above = caption.len() as f64 * SMALL.leading + height(&headings, head);
        let whole = above + of_rows(rows.len());
        self.reserve(if whole < KEPT_WHOLE {
            whole
        } else {
            above + of_rows(WITH_HEADING)
        });
        for line in caption {
            self.line(line, SMALL, LEFT, Anchor::Start);
            self.y += SMALL.leading;
        }
        self.y += 1.0;
        self.row(table, &widths, &headings, head);
        for (k, row) in rows.iter().enumerate() {
            let page = self.pages.len();
            // The last row must not be alone on its page.
            let together = rows[k..]
                .iter()
                .take(if k + 2 == rows.len() { 2 } else { 1 });
            self.reserve(together.map(|r| height(r, cell)).sum());
            if self.pages.len() > page {
                self.row(table, &widths, &headings, head);
            }
            self.row(table, &widths, row, cell);
        }
        self.y += 2.0;
    }

    /// Width of each column, and the factor by which the font shrinks.
    fn widths(&self, table: &Table) -> (Vec<f64>, f64) {
        let head_width = |text: &str| self.faces.width(text, HEAD.size, HEAD.bold);
        let natural = |k: usize, breaks: bool| {
            let (text, align) = &table.columns[k];
            let head = if breaks && *align == Align::Right {
                text.split(' ').map(head_width).fold(0.0, f64::max)
            } else {
                head_width(text)
            };
            let cells = table.rows.iter().filter_map(|row| row.get(k));
            let cells = cells.map(|text| self.faces.width(text, CELL.size, CELL.bold));
            cells.fold(head, f64::max) + 2.0 * PADDING + 0.1
        };
        let all = |breaks| -> Vec<f64> {
            let columns = 0..table.columns.len();
            columns.map(|k| natural(k, breaks)).collect()
        };
        let mut widths = all(false);
        if widths.iter().sum::<f64>() > WIDTH {
            widths = all(true);
        }
        let cell_width = |text: &String| self.faces.width(text, CELL.size, CELL.bold);
        let of_row = |row: &Vec<String>| row.iter().map(cell_width).collect();
        let cells: Vec<Vec<f64>> = table.rows.iter().map(of_row).collect();
        let line_count = |widths: &[f64]| -> usize {
            let lines = |(cell, width): (&f64, &f64)| (cell / (width - 2.0 * PADDING)).ceil();
            let rows = cells.iter().map(|row| row.iter().zip(widths).map(lines));
            rows.map(|row| row.fold(1.0, f64::max) as usize).sum()
        };
        let mut excess = widths.iter().sum::<f64>() - WIDTH;
        // Headings of number columns wrap first, then the text column is narrowed that leaves the table shortest.
        while excess > 0.0 {
            let texts = (0..widths.len()).filter(|k| table.columns[*k].1 == Align::Left);
            let narrowed = texts.filter(|k| widths[*k] > NARROWEST).map(|k| {
                let step = excess.min(STEP).min(widths[k] - NARROWEST);
                let mut narrowed = widths.clone();
                narrowed[k] -= step;
                (line_count(&narrowed), -widths[k], step, narrowed)
            });
            let shortest = narrowed.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
            let Some((.., step, shortest)) = shortest else {
                break;
            };
            widths = shortest;
            // Rounding of the sum could leave an excess that no step removes.
            excess -= step;
        }
        let total: f64 = widths.iter().sum();
        let scale = (WIDTH / total).min(1.0);
        (widths.iter().map(|w| w * scale).collect(), scale)
    }

    fn lines(&self, cells: &[&str], widths: &[f64], style: Style) -> Lines {
        let cells = cells.iter().zip(widths);
        cells
            .map(|(text, width)| {
                let room = width - 2.0 * PADDING * (style.size / CELL.size).min(1.0);
                wrap(self.faces, text, style.size, style.bold, room)
            })
            .collect()
    }

    fn row(&mut self, table: &Table, widths: &[f64], cells: &Lines, style: Style) {
        let (top, bottom) = (self.y, self.y + height(cells, style));
        let mut x = LEFT;
        for ((lines, width), (_, align)) in cells.iter().zip(widths).zip(&table.columns) {
            self.y = top + ROW_SPACE;
            for line in lines {
                let (at, anchor) = match align {
                    Align::Left => (x + if x > LEFT { PADDING } else { 0.0 }, Anchor::Start),
                    Align::Right => (x + width - PADDING, Anchor::End),
                };
                self.line(line.clone(), style, at, anchor);
                self.y += style.leading;
            }
            x += width;
        }
        let colour = if style.bold {
            colours::MUTED
        } else {
            colours::FAINT
        };
        let rule = Shape::segment([LEFT, bottom], [x, bottom], 0.5, colour);
        self.page().shapes.push(rule);
        self.y = bottom;
    }
}

fn height(cells: &Lines, style: Style) -> f64 {
    let most = cells.iter().map(Vec::len).max().unwrap_or(1);
    most as f64 * style.leading + 2.0 * ROW_SPACE
}
