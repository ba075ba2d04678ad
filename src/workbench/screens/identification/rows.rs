//! Selectable rows of numbers.

use egui::{Align2, FontId, Response, Role, Sense, Ui, Vec2, WidgetInfo, pos2};

use crate::screens::bench_panel::decimals_for;
use crate::theme::{self, GRID};
use crate::widgets::Cell;
use tautline_workflow::wording::units::mm;

const HEIGHT: f32 = 5.5 * GRID;

/// Draws a row: the first cell left-aligned, the others right-aligned in their shares of the width. A row that can be selected
/// begins with its name; `selected` is `None` for others. `name` is the accessible name.
pub fn row(
    ui: &mut Ui,
    shares: &[f32],
    cells: &[Cell],
    selected: Option<bool>,
    name: &str,
) -> Response {
    let palette = theme::of(ui);
    let size = Vec2::new(ui.available_width(), HEIGHT);
    let sense = if selected.is_some() {
        Sense::click()
    } else {
        Sense::hover()
    };
    let (rect, response) = ui.allocate_exact_size(size, sense);
    response.widget_info(|| match selected {
        Some(selected) => WidgetInfo::selected(Role::Button, true, selected, name),
        None => WidgetInfo::labeled(Role::Label, true, name),
    });
    if !ui.is_rect_visible(rect) {
        return response;
    }
    if selected == Some(true) {
        ui.painter()
            .rect_filled(rect, 4.0, palette.accent.gamma_multiply(0.25));
    } else if selected.is_some() && (response.hovered() || response.has_focus()) {
        ui.painter()
            .rect_filled(rect, 4.0, palette.hovered.gamma_multiply(0.6));
    }
    let inside = rect.shrink2(Vec2::new(GRID, 0.0));
    let total: f32 = shares.iter().sum();
    let mut right = inside.left();
    for (k, (cell, share)) in cells.iter().zip(shares).enumerate() {
        right += inside.width() * share / total;
        let font = if k == 0 && selected.is_some() {
            theme::strong(13.0)
        } else {
            FontId::proportional(13.0)
        };
        let (anchor, x) = if k == 0 {
            (Align2::LEFT_CENTER, inside.left())
        } else {
            (Align2::RIGHT_CENTER, right)
        };
        let colour = cell.colour.unwrap_or(palette.text);
        let at = pos2(x, inside.center().y);
        ui.painter().text(at, anchor, &cell.text, font, colour);
    }
    response
}

/// Draws column headings.
pub fn heads(ui: &mut Ui, shares: &[f32], heads: &[&str]) {
    let muted = theme::of(ui).muted;
    let cells: Vec<_> = heads
        .iter()
        .map(|head| Cell::new(*head).coloured(muted))
        .collect();
    row(ui, shares, &cells, None, &heads.join(", "));
}

/// Millimetres, rounded according to a standard deviation (m); two decimals without one.
pub fn millimetres(value_m: f64, sd_m: Option<f64>) -> String {
    let decimals = sd_m.filter(|sd| *sd > 0.0).map_or(2, decimals);
    mm(value_m, decimals)
}

/// Standard deviation (m) in millimetres; a dash if not determined.
pub fn deviation(sd_m: Option<f64>) -> String {
    match sd_m {
        Some(0.0) => "given".to_owned(),
        Some(sd) if sd.is_finite() => format!("{:.*}", decimals(sd), 1e3 * sd),
        _ => "–".to_owned(),
    }
}

/// Decimals of millimetres that show two digits of a standard deviation (m), at most three.
fn decimals(sd_m: f64) -> usize {
    decimals_for(1e3 * sd_m, 0, 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_follow_the_standard_deviation() {
        for (sd_m, value, sd) in [
            (Some(0.000_12), "12.35", "0.12"),
            (Some(0.0034), "12.3", "3.4"),
            (Some(0.05), "12", "50"),
            (Some(0.0), "12.35", "given"),
            (None, "12.35", "–"),
        ] {
            assert_eq!(millimetres(0.012_345_6, sd_m), value);
            assert_eq!(deviation(sd_m), sd);
        }
    }
}
