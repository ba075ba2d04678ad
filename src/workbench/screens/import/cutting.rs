//! Conversion of rows into poses.

use egui::{Grid, Slider, SliderClamping, Ui, WidgetInfo};
use tautline_import::{Cutting, Rest};

use super::Bench;
use crate::theme::GRID;
use crate::widgets::{UiExt, checkbox, radio};

/// Degrees per radian.
const DEGREES: f64 = 57.295_779_513_082_32;

/// Threshold of standstill.
struct Threshold {
    name: &'static str,
    unit: &'static str,
    /// Units of the slider per unit of the recipe.
    scale: f64,
    /// Smallest and largest value; the scale is logarithmic unless it begins at zero.
    range: [f64; 2],
    of: fn(&mut Rest) -> &mut f64,
}

impl Threshold {
    const fn new(
        name: &'static str,
        unit: &'static str,
        scale: f64,
        range: [f64; 2],
        of: fn(&mut Rest) -> &mut f64,
    ) -> Self {
        Self {
            name,
            unit,
            scale,
            range,
            of,
        }
    }
}

const THRESHOLDS: [Threshold; 4] = [
    Threshold::new("Shortest rest", "s", 1.0, [0.05, 20.0], |rest| {
        &mut rest.minimum_s
    }),
    Threshold::new("Settling time", "s", 1.0, [0.0, 5.0], |rest| {
        &mut rest.settle_s
    }),
    Threshold::new("Fastest motion", "mm/s", 1e3, [0.05, 50.0], |rest| {
        &mut rest.speed_m_s
    }),
    Threshold::new("Fastest rotation", "°/s", DEGREES, [0.01, 10.0], |rest| {
        &mut rest.turn_rad_s
    }),
];

pub fn show(ui: &mut Ui, bench: &mut Bench<'_>) {
    ui.section("Poses");
    let recipe = bench.open.draft.recipe();
    let now = recipe.cutting;
    let rest = match now {
        Cutting::Rest(rest) => rest,
        _ => Rest::default(),
    };
    for (cutting, title) in [
        (Cutting::Rows, "Every row is a pose"),
        (Cutting::Labels, "Rows with one label are a pose"),
        (Cutting::Rest(rest), "Rests are poses"),
        (Cutting::Motion, "A recording in motion"),
    ] {
        if radio(ui, now == cutting, title).clicked() && now != cutting {
            let what = title.to_lowercase();
            bench.change(what, |recipe| recipe.cutting = cutting);
        }
    }
    if let Cutting::Rest(rest) = now {
        thresholds(ui, bench, rest);
    }
    let has_home = bench.robot.home.is_some();
    let has_labels = recipe.channels.iter().any(|entry| entry.quantity == "pose");
    if has_home && !has_labels {
        let mut first = recipe.first_pose_is_home;
        if checkbox(ui, &mut first, "The first pose is the home pose").changed() {
            let what = "choose the home pose";
            bench.change(what, |recipe| recipe.first_pose_is_home = first);
        }
    }
    let Some(cut) = &bench.open.cut else {
        return;
    };
    let (poses, rows) = (cut.poses(), cut.poses().iter().map(|pose| pose.rows));
    if !poses.is_empty() {
        let used: usize = rows.sum();
        let all = bench.open.all_series().map(|series| series.rows).max();
        let all = all.unwrap_or_default();
        ui.muted(&format!(
            "{} poses of {used} rows; the longest series has {all}.",
            poses.len()
        ));
    }
}

fn thresholds(ui: &mut Ui, bench: &mut Bench<'_>, rest: Rest) {
    Grid::new("thresholds of rests")
        .num_columns(2)
        .spacing([3.0 * GRID, GRID])
        .show(ui, |ui| {
            for threshold in &THRESHOLDS {
                ui.label(threshold.name);
                let mut changed = rest;
                let value = (threshold.of)(&mut changed);
                let mut shown = *value * threshold.scale;
                ui.spacing_mut().slider_width = (ui.available_width() - 104.0).clamp(80.0, 200.0);
                let [least, most] = threshold.range;
                let slider = Slider::new(&mut shown, least..=most)
                    .logarithmic(least > 0.0)
                    .clamping(SliderClamping::Never)
                    .custom_formatter(|value, _| format!("{value:.2}"))
                    .suffix(format!(" {}", threshold.unit));
                let response = ui.add(slider);
                response.widget_info(|| WidgetInfo::slider(true, shown, threshold.name));
                if response.changed() {
                    *value = shown / threshold.scale;
                    let what = format!("change {}", threshold.name.to_lowercase());
                    let goes_on = response.dragged();
                    bench.change_on(what, goes_on, |recipe| {
                        recipe.cutting = Cutting::Rest(changed);
                    });
                }
                ui.end_row();
            }
        });
}
