//! Horizontal bars of shares.

use emath::{Align2, Pos2, Rect, pos2, vec2};

use super::colours::{ACCENT, DARK, FAINT, MUTED};
use super::plots::SIZE;
use crate::plot::Drawing;

/// Width of the drawing (pt), that of the page.
const WIDTH: f32 = 2.0 * SIZE[0] as f32 + 12.0;
/// Height of the titles and of a bar with the space below it (pt).
const ROW: f32 = 12.0;
/// Thickness of a bar (pt).
const THICKNESS: f32 = 7.0;
/// Space for the names, and for the number beside a bar (pt).
const NAMES: f32 = 182.0;
const NUMBER: f32 = 28.0;
/// Space between columns (pt).
const GAP: f32 = 12.0;
/// Size of the text (pt).
const TEXT: f32 = 7.0;

/// A row for each name, with a bar for its share, 0 to 1, in each column; full bars are 1.
pub fn shares(titles: &[&str], rows: &[(String, Vec<f64>)]) -> Drawing {
    let height = ROW * (1.0 + rows.len() as f32);
    let whole = Rect::from_min_size(Pos2::ZERO, vec2(WIDTH, height));
    let column = (WIDTH - NAMES) / titles.len().max(1) as f32;
    let room = column - GAP - NUMBER;
    let left = |index: usize| NAMES + GAP + column * index as f32;
    let label = format!("Shares: {}", titles.join(", "));
    Drawing::record(label, whole, 1.0, |canvas| {
        for (index, title) in titles.iter().enumerate() {
            let at = pos2(left(index), 0.0);
            canvas.text(at, Align2::LEFT_TOP, title, TEXT, MUTED);
        }
        for (row, (name, shares)) in rows.iter().enumerate() {
            let middle = ROW * (1.5 + row as f32);
            let at = pos2(NAMES, middle);
            canvas.text(at, Align2::RIGHT_CENTER, name, TEXT, DARK);
            for (index, share) in shares.iter().enumerate() {
                let from = pos2(left(index), middle - 0.5 * THICKNESS);
                let bar = |share: f32| Rect::from_min_size(from, vec2(room * share, THICKNESS));
                canvas.fill(bar(1.0), FAINT);
                canvas.fill(bar(*share as f32), ACCENT);
                let percent = format!("{:.0} %", 100.0 * share);
                let at = pos2(left(index) + room + NUMBER, middle);
                canvas.text(at, Align2::RIGHT_CENTER, &percent, TEXT, DARK);
            }
        }
    })
}
