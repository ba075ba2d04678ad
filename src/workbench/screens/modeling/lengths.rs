//! Composition of each cable's length at the shown pose.

use egui::{Color32, Rect, RichText, Role, Sense, Ui, Vec2, WidgetInfo};
use tautline_core::geometry::Pose;
use tautline_core::kinematics::{
    LengthBreakdown, LengthBreakdownError, inverse_kinematics, length_breakdown,
};
use tautline_core::robot::Robot;

use super::pose;
use crate::screens::bench_panel::{Bench, or_dash};
use crate::theme::{self, GRID, Palette};
use crate::widgets::{Cell, TableColumn, UiExt, table};

/// Height of a bar (points).
const BAR: f32 = 3.0 * GRID;
/// Smallest width of a non-zero part (points).
const LEAST: f32 = 3.0;

pub fn show(ui: &mut Ui, bench: &mut Bench<'_>) {
    let Some(shown) = pose::shown(bench) else {
        ui.muted("Select a pose to see its cable lengths: this robot has no home pose.");
        return;
    };
    let shares = match shares(bench.robot(), &shown.pose, shown.tensions_n.as_deref()) {
        Ok(shares) => shares,
        Err(error) => return ui.bad(&format!("{error}.")),
    };
    ui.muted(&format!(
        "Cable length beyond the pulley's entry point, at {}. Select a pose to see others.",
        shown.name
    ));
    legend(ui);
    let longest = shares.iter().map(total).fold(1e-9, f64::max);
    for (cable, share) in shares.iter().enumerate() {
        bar(ui, bench, cable, share, longest);
    }
    ui.muted(
        "Bars are at least 3 pixels wide. Elongation is that of the whole cable from the drum on.",
    );
    for reason in reasons(&shares) {
        ui.neutral(&format!("{reason}."));
    }
    numbers(ui, bench, &shares);
}

/// Length of a cable by parts.
#[derive(Debug)]
struct Share {
    /// Straight length from the pulley to the platform (m).
    free_m: f64,
    /// Length around the pulley (m).
    wrapped_m: f64,
    /// Effect of the tension, or a sentence if it is unknown.
    under_load: Result<UnderLoad, String>,
}

/// Effect of the tension on a cable.
#[derive(Debug)]
struct UnderLoad {
    tension_n: f64,
    elastic_m: f64,
    sag_m: f64,
}

/// Length of each cable at `pose`, with the effect of `tensions_n` if known.
fn shares(
    robot: &Robot,
    pose: &Pose,
    tensions_n: Option<&[f64]>,
) -> Result<Vec<Share>, LengthBreakdownError> {
    let unloaded = |reason: &str| -> Result<Vec<Share>, LengthBreakdownError> {
        let states = inverse_kinematics(robot, pose)?.into_iter();
        let share = states.map(|state| Share {
            free_m: state.free_length_m,
            wrapped_m: state.length_m - state.free_length_m,
            under_load: Err(format!("Elongation and sag are not known, {reason}")),
        });
        Ok(share.collect())
    };
    let Some(tensions_n) = tensions_n else {
        return unloaded("no tension was measured here");
    };
    match length_breakdown(robot, pose, tensions_n, None) {
        Err(slack @ LengthBreakdownError::Slack { .. }) => unloaded(&slack.to_string()),
        Err(error) => Err(error),
        Ok(budgets) => {
            let loaded = budgets.iter().zip(tensions_n);
            Ok(loaded
                .map(|(cable, tension_n)| share(cable, *tension_n))
                .collect())
        }
    }
}

fn share(cable: &LengthBreakdown, tension_n: f64) -> Share {
    let load = UnderLoad {
        tension_n,
        elastic_m: cable.elastic_m,
        sag_m: cable.sag_m,
    };
    let outside = cable.outside_surface.as_ref();
    Share {
        free_m: cable.free_m,
        wrapped_m: cable.wrapped_m,
        under_load: outside.map_or(Ok(load), |outside| {
            Err(format!("Elongation is not known, {outside}"))
        }),
    }
}

/// Distinct reasons for unknown parts.
fn reasons(shares: &[Share]) -> Vec<&str> {
    let mut reasons: Vec<&str> = Vec::new();
    for share in shares {
        if let Err(reason) = &share.under_load
            && !reasons.contains(&reason.as_str())
        {
            reasons.push(reason);
        }
    }
    reasons
}

/// Total length of a bar (m).
fn total(share: &Share) -> f64 {
    parts(share).iter().map(|(_, metres)| metres).sum()
}

/// Name and length of the parts (m).
fn parts(share: &Share) -> [(&'static str, f64); 4] {
    let load = share.under_load.as_ref().ok();
    [
        ("Free span", share.free_m),
        ("Wrap", share.wrapped_m),
        ("Elongation", load.map_or(0.0, |load| load.elastic_m)),
        ("Sag", load.map_or(0.0, |load| load.sag_m)),
    ]
}

fn colours(palette: &Palette) -> [Color32; 4] {
    [palette.ghost, palette.accent, palette.warning, palette.good]
}

fn legend(ui: &mut Ui) {
    let colours = colours(theme::of(ui));
    ui.horizontal_wrapped(|ui| {
        for (name, colour) in ["Free span", "Wrap", "Elongation", "Sag"]
            .iter()
            .zip(colours)
        {
            let (rect, _) = ui.allocate_exact_size(Vec2::splat(2.0 * GRID), Sense::hover());
            ui.painter().rect_filled(rect, 2.0, colour);
            ui.label(RichText::new(*name).small());
        }
    });
}

fn bar(ui: &mut Ui, bench: &mut Bench<'_>, cable: usize, share: &Share, longest: f64) {
    let palette = theme::of(ui);
    let size = Vec2::new(ui.available_width(), BAR + 2.0 * GRID);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let title = bench.cable_name(cable);
    let words: Vec<String> = parts(share)
        .iter()
        .map(|(name, metres)| format!("{} {:.3} mm", name.to_lowercase(), metres * 1e3))
        .collect();
    let text = format!("{title}: {}", words.join(", "));
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &text));
    let selected = bench.selection.cable == Some(cable);
    if selected || response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, 2.0, palette.raised);
    }
    let font = egui::TextStyle::Small.resolve(ui.style());
    let left = rect.left() + GRID;
    let dot = egui::pos2(left + GRID, rect.center().y);
    ui.painter().circle_filled(dot, GRID, palette.cable(cable));
    let place = egui::pos2(left + 3.0 * GRID, rect.center().y);
    let align = egui::Align2::LEFT_CENTER;
    ui.painter()
        .text(place, align, (cable + 1).to_string(), font, palette.text);
    let start = left + 8.0 * GRID;
    let width = rect.right() - start - 5.0 * LEAST;
    let mut x = start;
    for ((_, metres), colour) in parts(share).iter().zip(colours(palette)) {
        let wide = (metres / longest) as f32 * width;
        let wide = if *metres > 0.0 { wide.max(LEAST) } else { 0.0 };
        let top = rect.center().y - 0.5 * BAR;
        let part = Rect::from_min_size(egui::pos2(x, top), Vec2::new(wide, BAR));
        ui.painter().rect_filled(part, 0.0, colour);
        x += wide;
    }
    if response.on_hover_text(words.join("\n")).clicked() {
        bench.select_cable(cable);
    }
}

fn numbers(ui: &mut Ui, bench: &mut Bench<'_>, shares: &[Share]) {
    let columns = [
        TableColumn::words("Cable"),
        TableColumn::number("Free span", "mm"),
        TableColumn::number("Wrap", "mm"),
        TableColumn::number("Elongation", "mm"),
        TableColumn::number("Sag", "mm"),
        TableColumn::number("Tension", "N"),
    ];
    let rows: Vec<Vec<Cell>> = shares
        .iter()
        .enumerate()
        .map(|(cable, share)| {
            let load = share.under_load.as_ref().ok();
            vec![
                bench.cable_cell(ui, cable),
                Cell::new(format!("{:.1}", share.free_m * 1e3)),
                Cell::new(format!("{:.2}", share.wrapped_m * 1e3)),
                or_dash(load.map(|load| load.elastic_m * 1e3), 3),
                or_dash(load.map(|load| load.sag_m * 1e3), 3),
                or_dash(load.map(|load| load.tension_n), 1),
            ]
        })
        .collect();
    let chosen = bench.selection.cable;
    if let Some(cable) = table(ui, &columns, &rows, chosen).clicked {
        bench.select_cable(cable);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tautline_core::robot::presets::find;

    #[test]
    fn parts_are_the_same_with_and_without_a_tension() {
        let robot = find("mini").expect("the preset").robot;
        let pose = robot.home.expect("home").pose();
        let tensions = vec![50.0; robot.cable_count()];
        let loaded = shares(&robot, &pose, Some(&tensions)).expect("paths");
        let unloaded = shares(&robot, &pose, None).expect("paths");
        for (a, b) in loaded.iter().zip(&unloaded) {
            assert!((a.free_m - b.free_m).abs() < 1e-12);
            assert!((a.wrapped_m - b.wrapped_m).abs() < 1e-12);
            assert!(a.under_load.as_ref().is_ok_and(|load| load.elastic_m > 0.0));
        }
        assert_eq!(
            reasons(&unloaded),
            ["Elongation and sag are not known, no tension was measured here"]
        );
    }
}
