//! Displacement by coordinate: bars with their standard deviation and that of the drawing.

use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2,
};

use crate::theme::{self, GRID, Palette};
use tautline_workflow::identification::PulleyCoordinate;
use tautline_workflow::wording::units::{decimals, fixed, signed, significant};

/// Height of a row (points).
const ROW: f32 = 5.0 * GRID;
/// Widths of the columns beside the bars (points).
const AXIS: f32 = 4.0 * GRID;
const VALUE: f32 = 32.0 * GRID;
const PRIOR: f32 = 30.0 * GRID;
/// Largest reach used for the drawing's standard deviation, as a multiple of the largest bar.
const ROOM: f64 = 3.0;

/// Draws a row for each of x, y, z.
pub fn show(ui: &mut Ui, coordinates: &[PulleyCoordinate; 3]) {
    let palette = theme::of(ui);
    let half = half_m(coordinates);
    ui.spacing_mut().item_spacing.y = 2.0;
    heads(ui, palette);
    for (axis, coordinate) in ["x", "y", "z"].into_iter().zip(coordinates) {
        let size = vec2(ui.available_width(), ROW);
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        response.widget_info(|| {
            let (value, prior) = (value(coordinate), prior(coordinate));
            let text = format!("d{axis}: {value}; drawing {prior}");
            WidgetInfo::labeled(Role::Label, true, text)
        });
        row(ui.painter(), rect, axis, coordinate, half, palette);
    }
}

fn heads(ui: &mut Ui, palette: &Palette) {
    let size = vec2(ui.available_width(), 4.0 * GRID);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let font = FontId::proportional(11.0);
    let text = |x: f32, anchor: Align2, text: &str| {
        let at = pos2(x, rect.center().y);
        ui.painter()
            .text(at, anchor, text, font.clone(), palette.muted);
    };
    let bars = bars(rect);
    text(
        rect.left(),
        Align2::LEFT_CENTER,
        "Displacement ± one standard deviation",
    );
    text(bars.right() + VALUE, Align2::RIGHT_CENTER, "mm");
    text(rect.right(), Align2::RIGHT_CENTER, "Drawing (shaded)");
    response.widget_info(|| {
        let text = "Displacement with one standard deviation, and that of the drawing";
        WidgetInfo::labeled(Role::Label, true, text)
    });
}

fn bars(row: Rect) -> Rect {
    let (left, right) = (row.left() + AXIS, row.right() - VALUE - PRIOR);
    Rect::from_min_max(
        pos2(left, row.top()),
        pos2(right.max(left + 1.0), row.bottom()),
    )
}

/// Half range of the bars, from zero to either end (m).
fn half_m(coordinates: &[PulleyCoordinate; 3]) -> f64 {
    let reach = |c: &PulleyCoordinate| c.change_m.abs() + c.sd_m.unwrap_or(0.0);
    let needed = coordinates.iter().map(reach).fold(1e-5, f64::max);
    let priors = coordinates.iter().filter_map(|c| c.prior_sd_m);
    let shown = priors.filter(|sd| *sd <= ROOM * needed);
    1.1 * shown.fold(needed, f64::max)
}

/// Displacement in millimetres, such as `+0.83 ± 0.05`.
fn value(coordinate: &PulleyCoordinate) -> String {
    let change = 1e3 * coordinate.change_m;
    match coordinate.sd_m.map(|sd| 1e3 * sd) {
        None => format!("{} ± not determined", signed(change, 2)),
        Some(sd) if sd > 0.0 => {
            let decimals = decimals(sd).min(4);
            format!("{} ± {}", signed(change, decimals), fixed(sd, decimals))
        }
        Some(_) => "given".to_owned(),
    }
}

/// Tolerance of the drawing, such as `± 5 mm`, or a text if unknown.
fn prior(coordinate: &PulleyCoordinate) -> String {
    match coordinate.prior_sd_m {
        Some(0.0) => "exact".to_owned(),
        Some(sd) => format!("± {} mm", significant(1e3 * sd, 2)),
        None => "unknown".to_owned(),
    }
}

fn row(
    painter: &Painter,
    rect: Rect,
    axis: &str,
    coordinate: &PulleyCoordinate,
    half_m: f64,
    palette: &Palette,
) {
    let font = FontId::proportional(13.0);
    let text = |x: f32, anchor: Align2, text: &str, colour: Color32| {
        painter.text(pos2(x, rect.center().y), anchor, text, font.clone(), colour);
    };
    let bars = bars(rect);
    let name = format!("d{axis}");
    text(rect.left(), Align2::LEFT_CENTER, &name, palette.muted);
    let right = Align2::RIGHT_CENTER;
    text(
        bars.right() + VALUE,
        right,
        &value(coordinate),
        palette.text,
    );
    text(rect.right(), right, &prior(coordinate), palette.muted);
    let painter = painter.with_clip_rect(bars.intersect(painter.clip_rect()));
    let x = |metres: f64| {
        let share = (metres / half_m).clamp(-1.0, 1.0) as f32;
        bars.center().x + 0.5 * bars.width() * share
    };
    let band = |from: f64, to: f64, height: f32| {
        let middle = bars.center().y;
        Rect::from_two_pos(
            pos2(x(from), middle - 0.5 * height),
            pos2(x(to), middle + 0.5 * height),
        )
    };
    if let Some(sd) = coordinate.prior_sd_m {
        painter.rect_filled(
            band(-sd, sd, ROW - 3.0),
            2.0,
            palette.ghost.gamma_multiply(0.25),
        );
    }
    let colour = palette.axes[["x", "y", "z"].iter().position(|a| *a == axis).unwrap_or(0)];
    painter.rect_filled(band(0.0, coordinate.change_m, 8.0), 1.0, colour);
    let zero = [pos2(x(0.0), bars.top()), pos2(x(0.0), bars.bottom())];
    painter.line_segment(zero, Stroke::new(1.0, palette.ghost));
    if let Some(sd) = coordinate.sd_m.filter(|sd| *sd > 0.0) {
        let (low, high) = (x(coordinate.change_m - sd), x(coordinate.change_m + sd));
        let middle = bars.center().y;
        let stroke = Stroke::new(1.5, palette.text);
        let line = |a: Pos2, b: Pos2| painter.line_segment([a, b], stroke);
        line(pos2(low, middle), pos2(high, middle));
        for end in [low, high] {
            line(pos2(end, middle - 4.0), pos2(end, middle + 4.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coordinate(change_m: f64, sd_m: Option<f64>, prior_sd_m: Option<f64>) -> PulleyCoordinate {
        PulleyCoordinate {
            change_m,
            sd_m,
            prior_sd_m,
        }
    }

    #[test]
    fn numbers_have_their_sign_and_as_many_decimals_as_they_deserve() {
        for (change, sd, expected) in [
            (8.34e-4, Some(5.2e-5), "+0.83 ± 0.05"),
            (-1.234e-3, Some(1.2e-5), "-1.234 ± 0.012"),
            (0.0, Some(0.0), "given"),
            (1e-3, None, "+1.00 ± not determined"),
        ] {
            assert_eq!(value(&coordinate(change, sd, None)), expected);
        }
        assert_eq!(prior(&coordinate(0.0, None, Some(5e-3))), "± 5 mm");
        assert_eq!(prior(&coordinate(0.0, None, None)), "unknown");
    }

    #[test]
    fn the_bars_have_one_scale_that_a_vague_drawing_does_not_spoil() {
        let own = coordinate(1e-3, Some(1e-4), Some(2e-3));
        let vague = coordinate(1e-4, Some(1e-4), Some(0.1));
        assert!((half_m(&[own, own, vague]) - 1.1 * 2e-3).abs() < 1e-12);
    }
}
