//! Plot of the improvement on held-out poses.

use egui::{Align2, FontId, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};
use tautline_core::diagnosis::Gain;

use crate::theme::{self, GRID};
use crate::widgets::UiExt;
use tautline_workflow::diagnosis;
use tautline_workflow::wording::units::fixed;
use tautline_workflow::wording::{count, ratio};

/// Draws the text and, if poses were held out, the two residuals on one scale.
pub fn show(ui: &mut Ui, gain: &Gain) {
    if gain.poses_held_out > 0 && diagnosis::is_improvement(gain) {
        dumbbell(ui, gain);
    }
    ui.wrapped(
        egui::RichText::new(tautline_workflow::wording::sentence(&diagnosis::gain(gain))).small(),
    )
    .on_hover_text(kinds(gain));
}

fn kinds(gain: &Gain) -> String {
    let [low, high] = gain.interval.map(|end| fixed(end, 2));
    let mut text = format!("Difference of the two: 95 % interval {low} to {high}.");
    for kind in &gain.kinds {
        let (name, before, after) = (kind.quantity.name(), kind.before, kind.after);
        text += &format!("\n{name}: {before:.2} before, {after:.2} with it");
    }
    text
}

/// Draws the residual before and after as points on a scale from 0, and the 95 % interval of the gain as a bar.
fn dumbbell(ui: &mut Ui, gain: &Gain) {
    let palette = theme::of(ui);
    let poses = count(gain.poses_held_out, "pose");
    ui.muted(&format!(
        "Residuals at {poses} held out, in multiples of the expected noise:"
    ));
    let size = vec2(ui.available_width(), 9.0 * GRID);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let [low, high] = gain.interval;
    let name = format!(
        "Held-out poses: {} before, {} with it",
        ratio(gain.before),
        ratio(gain.after)
    );
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    let most = gain.before.max(gain.after).max(gain.before - low) * 1.08;
    let inside = rect.shrink2(vec2(2.0 * GRID, 0.0));
    let y = rect.bottom() - 2.5 * GRID;
    let at = |value: f64| {
        let part = (value / most).clamp(0.0, 1.0) as f32;
        pos2(inside.left() + part * inside.width(), y)
    };
    let painter = ui.painter();
    painter.line_segment([at(0.0), at(most)], Stroke::new(1.0, palette.line));
    // Expected normalised residual of an adequate model.
    let one = at(1.0);
    painter.line_segment(
        [one - vec2(0.0, GRID), one + vec2(0.0, GRID)],
        Stroke::new(1.0, palette.muted),
    );
    if low.is_finite() && high.is_finite() {
        let bar = [at(gain.before - high), at(gain.before - low)];
        painter.line_segment(bar, Stroke::new(6.0, palette.good.gamma_multiply(0.35)));
    }
    painter.line_segment(
        [at(gain.after), at(gain.before)],
        Stroke::new(2.0, palette.muted),
    );
    for (value, colour) in [(gain.before, palette.warning), (gain.after, palette.good)] {
        painter.circle_filled(at(value), 4.5, colour);
        let above = at(value) - vec2(0.0, 2.0 * GRID);
        let anchor = if value < most / 6.0 {
            Align2::LEFT_BOTTOM
        } else {
            Align2::CENTER_BOTTOM
        };
        painter.text(
            above,
            anchor,
            ratio(value),
            FontId::proportional(12.0),
            palette.text,
        );
    }
    response.on_hover_text(format!(
        "{name}; the bar is the 95 % interval, the mark is at 1."
    ));
}
