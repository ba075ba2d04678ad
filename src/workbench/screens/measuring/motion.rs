//! The moving robot: its pose, and its tensions with their limits.

use egui::{Align2, Rect, Sense, TextStyle, Ui, Vec2};
use tautline_core::simulation::TensionRange;

use super::name_of;
use crate::model::Model;
use crate::theme::{self, GRID};
use crate::widgets::UiExt;
use tautline_workflow::wording::cable_label;
use tautline_workflow::wording::units::fixed;

/// Height of a tension bar and its row (points).
const BAR: f32 = 2.0 * GRID;
const ROW: f32 = 5.0 * GRID;
/// Share of a bar's width for the largest allowed tension; more is an overload.
const FULL: f64 = 0.85;

/// Position of the platform. The progress of the operation is in the footer.
pub(in crate::screens) fn position(ui: &mut Ui, model: &Model) {
    if let Some(pose) = model.link.live().pose {
        let [x, y, z] = [0, 1, 2].map(|axis| fixed(pose.position[axis] * 1e3, 1));
        ui.value("Platform at x, y, z", &format!("{x}, {y}, {z}"), "mm");
    }
}

/// Bar for each cable, with marks at the smallest and largest allowed tension.
pub(in crate::screens) fn tensions(ui: &mut Ui, model: &Model) {
    let (Some(open), Some(sample)) = (&model.open, model.link.live().sample) else {
        return;
    };
    let robot = &open.session().robot;
    let range = TensionRange::of(robot);
    let cables = robot.cables.iter().zip(&sample.force_n).enumerate();
    let read = cables.filter_map(|(k, (cable, force_n))| {
        let tension_n = cable.force_sensor?.tension_n(*force_n);
        tension_n.is_finite().then_some((k, tension_n))
    });
    let read: Vec<(usize, f64)> = read.collect();
    if read.is_empty() {
        return;
    }
    ui.section("Tensions");
    for (k, tension_n) in read {
        bar(ui, k, name_of(model, k), tension_n, range);
    }
    ui.muted(&format!(
        "Allowed: {} to {} N (marks).",
        fixed(range.lower_n, 0),
        fixed(range.upper_n, 0)
    ));
}

fn bar(ui: &mut Ui, cable: usize, name: &str, tension_n: f64, range: TensionRange) {
    let palette = theme::of(ui);
    let size = Vec2::new(ui.available_width(), ROW);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    // From the limits that are drawn: a single sample is noisier than the mean to which a warning refers.
    let state = match tension_n {
        low if low < 0.0 => ", below zero",
        low if low < range.lower_n => ", too low",
        high if high > range.upper_n => ", too high",
        _ => "",
    };
    let (colour, fill) = match state {
        "" => (palette.text, palette.cable(cable)),
        _ => (palette.warning, palette.warning),
    };
    let words = format!("{} N{state}", fixed(tension_n, 1));
    response.widget_info(|| {
        let text = format!("Tension of {name}: {words}");
        egui::WidgetInfo::labeled(egui::Role::Label, true, text)
    });
    let font = TextStyle::Body.resolve(ui.style());
    let painter = ui.painter();
    let label = cable_label(cable, name);
    let middle = rect.center().y;
    let text = |at: egui::Pos2, align: Align2, text: String, colour| {
        painter.text(at, align, text, font.clone(), colour);
    };
    text(rect.left_center(), Align2::LEFT_CENTER, label, palette.text);
    text(rect.right_center(), Align2::RIGHT_CENTER, words, colour);
    let left = rect.left() + 18.0 * GRID;
    let width = (rect.right() - 28.0 * GRID - left).max(8.0 * GRID);
    let x = |tension_n: f64| {
        let part = (FULL * tension_n / range.upper_n).clamp(0.0, 1.0);
        left + width * part as f32
    };
    let of = |to: f32| {
        Rect::from_min_max(
            egui::pos2(left, middle - 0.5 * BAR),
            egui::pos2(to, middle + 0.5 * BAR),
        )
    };
    painter.rect_filled(of(left + width), 2.0, palette.raised);
    painter.rect_filled(of(x(tension_n)), 2.0, fill);
    for limit_n in [range.lower_n, range.upper_n] {
        let reach = middle - 0.9 * BAR..=middle + 0.9 * BAR;
        painter.vline(x(limit_n), reach, egui::Stroke::new(1.5, palette.text));
    }
}
