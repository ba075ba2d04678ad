//! Elongation of the cables as a function of length and tension.

use egui::Ui;
use tautline_core::cable::ElongationSurface;
use tautline_session::{ElongationPoint, PhaseData};

use crate::screens::bench_panel::{Bench, TableInput, or_dash};
use crate::theme;
use crate::views::plots::small;
use crate::widgets::{Cell, Numbers, RowField, Rows, RowsEdit, TableColumn, UiExt, table};
use tautline_workflow::plot::figure::{Axis, Band, Curve, Figure, Ink, Marker, Point, Series};
use tautline_workflow::precalibration::{ElongationFit, Table};
use tautline_workflow::wording::units::signed;

const FIELDS: [RowField; 3] = [
    RowField::millimetres("Length", 1).accepting(
        |value| value > 0.0 && value <= 1e3,
        "more than 0 and at most 1 km",
    ),
    RowField::new("Tension", "N", 2).accepting(|value| value >= 0.0, "a tension of 0 or more"),
    RowField::millimetres("Elongation", 4).accepting(
        |value| value.abs() < 1e3,
        "less than the length of the cable",
    ),
];

/// Colours of the slices, one for each length of a drawn slice.
const INKS: [Ink; 4] = [Ink::Muted, Ink::Text, Ink::Accent, Ink::Warning];
/// Distance from a slice within which points are drawn with it, in halves of the measured range.
const NEAR: f64 = 0.02;
/// Number of points of a drawn slice.
const STEPS: usize = 32;

pub fn show(ui: &mut Ui, bench: &mut Bench<'_>, input: &mut TableInput) {
    bench.import(ui, Table::Elongation, &mut input.path);
    let calibration = bench.calibration;
    match &calibration.elongation {
        None => {
            let now = now(bench);
            ui.muted(&format!(
                    "The measured elongation appears here. Until then {now}. Load cables of several lengths with several tensions, and import the table or type it below."
                ));
        }
        Some(Err(message)) => ui.bad(&format!("{message}.")),
        Some(Ok(fit)) => {
            judge(ui, fit);
            degrees(ui, fit);
            let now = now(bench);
            ui.muted(&format!("At present {now}."));
            let proposal = &calibration.with_elongation;
            bench.propose(ui, proposal, "Apply surface", "apply measured elongation");
            slices(ui, bench, &fit.choice.surface);
            residuals(ui, bench, fit);
        }
    }
    points(ui, bench, input);
}

/// Present elongation of the robot, in words.
fn now(bench: &Bench<'_>) -> String {
    let cables = bench.robot().cables.iter().map(|cable| &cable.cable);
    let surfaces = cables.clone().filter_map(|c| c.elongation_surface.as_ref());
    if let Some(surface) = surfaces.clone().next() {
        let (degree, count) = (surface.degree, surfaces.count());
        return format!("{count} cables have a measured surface of degree {degree}");
    }
    let stiffness: Vec<f64> = cables.filter_map(|c| c.axial_stiffness_n).collect();
    let low = stiffness.iter().copied().fold(f64::INFINITY, f64::min);
    let high = stiffness.iter().copied().fold(0.0, f64::max);
    match stiffness.len() {
        0 => "cables do not stretch in the model".to_owned(),
        _ if low == high => format!("the model has a constant stiffness of {low:.0} N"),
        _ => format!("the model has constant stiffnesses from {low:.0} to {high:.0} N"),
    }
}

fn judge(ui: &mut Ui, fit: &ElongationFit) {
    let surface = &fit.choice.surface;
    let worst = fit.largest_residual_m * 1e3;
    ui.good(&format!(
        "A surface of degree {} fits all {} points within {worst:.3} mm.",
        surface.degree,
        fit.residuals_m.len()
    ));
    let span = |centre: f64, scale: f64, decimals: usize| {
        let (low, high) = (centre - scale, centre + scale);
        format!("{low:.decimals$} to {high:.decimals$}")
    };
    let lengths = span(
        surface.length_center_m * 1e3,
        surface.length_scale_m * 1e3,
        0,
    );
    let tensions = span(surface.tension_center_n, surface.tension_scale_n, 1);
    ui.value("Valid for lengths", &lengths, "mm");
    ui.value("Valid for tensions", &tensions, "N");
    let spread = format!("{:.4}", surface.residual_sd_m * 1e3);
    ui.value("Standard deviation of residuals", &spread, "mm");
}

fn degrees(ui: &mut Ui, fit: &ElongationFit) {
    ui.section("Degree, by cross-validation");
    let columns = [
        TableColumn::words("Degree"),
        TableColumn::number("Coefficients", ""),
        TableColumn::number("Cross-validation error", "mm"),
        TableColumn::words("Choice"),
    ];
    let chosen = fit.choice.surface.degree;
    let good = theme::of(ui).good;
    let rows: Vec<Vec<Cell>> = fit
        .choice
        .scores
        .iter()
        .map(|score| {
            let terms = (score.degree + 1) * (score.degree + 2) / 2;
            let choice = match score.error_m {
                _ if score.degree == chosen => Cell::new("chosen").coloured(good),
                None => Cell::new("too few points"),
                Some(_) => Cell::default(),
            };
            vec![
                Cell::new(score.degree.to_string()),
                Cell::new(terms.to_string()),
                or_dash(score.error_m.map(|error| error * 1e3), 4),
                choice,
            ]
        })
        .collect();
    let selected = rows.len().min(chosen).checked_sub(1);
    table(ui, &columns, &rows, selected);
    ui.muted("The lowest degree whose error is not significantly above the minimum is chosen.");
}

fn slices(ui: &mut Ui, bench: &Bench<'_>, surface: &ElongationSurface) {
    ui.section("Slices at four measured lengths");
    let spread = |k: usize, count: usize, centre: f64, scale: f64| {
        centre + scale * (2.0 * k as f64 / (count - 1) as f64 - 1.0)
    };
    let points = &bench.session().phases.elongation;
    let (mut series, mut curves) = (Vec::new(), Vec::new());
    for (slice, ink) in INKS.into_iter().enumerate() {
        let wanted = spread(
            slice,
            INKS.len(),
            surface.length_center_m,
            surface.length_scale_m,
        );
        let away = |p: &&ElongationPoint| (p.length_m - wanted).abs();
        let nearest = points.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        let length = nearest.map_or(wanted, |point| point.length_m);
        let name = format!("{:.0} mm", length * 1e3);
        let line = (0..STEPS).map(|k| {
            let tension = spread(k, STEPS, surface.tension_center_n, surface.tension_scale_n);
            let value = surface.evaluate_unchecked(length, tension);
            [tension, value.elongation_m * 1e3]
        });
        curves.push(Curve {
            name: String::new(),
            ink,
            dashed: false,
            points: line.collect(),
        });
        let near = points
            .iter()
            .filter(|p| (p.length_m - length).abs() <= NEAR * surface.length_scale_m);
        let near = near.map(|p| Point::new(p.tension_n, p.elongation_m * 1e3));
        series.push(Series::new(name, ink, Marker::cable(slice), near.collect()));
    }
    let figure = Figure {
        x: Axis::new("Tension", "N"),
        y: Axis::new("Elongation", "mm"),
        series,
        curves,
        ..Figure::default()
    };
    let name = "Slices of the elongation surface";
    small::show(ui, name, &figure, 200.0, bench.selection);
}

fn residuals(ui: &mut Ui, bench: &Bench<'_>, fit: &ElongationFit) {
    ui.section("Residuals");
    let surface = &fit.choice.surface;
    let points = bench.session().phases.elongation.iter();
    let points = points
        .zip(&fit.residuals_m)
        .map(|(point, residual)| Point::new(point.tension_n, residual * 1e3));
    let name = "Measured minus surface";
    let limit = Some(3.0 * surface.residual_sd_m * 1e3).filter(|limit| *limit > 0.0);
    let band = |limit: f64| Band {
        name: "3 standard deviations".to_owned(),
        y: [-limit, limit],
    };
    let figure = Figure {
        x: Axis::new("Tension", "N"),
        y: Axis::new("Residual", "mm"),
        bands: limit.map(band).into_iter().collect(),
        series: vec![Series::new(
            name,
            Ink::Accent,
            Marker::Circle,
            points.collect(),
        )],
        has_zero_line: true,
        ..Figure::default()
    };
    small::show(
        ui,
        "Residuals of the elongation",
        &figure,
        152.0,
        bench.selection,
    );
    ui.muted("The band is three standard deviations about the surface.");
}

fn points(ui: &mut Ui, bench: &mut Bench<'_>, input: &mut TableInput) {
    ui.section("Measured points");
    let points = &bench.session().phases.elongation;
    let numbers: Vec<Numbers> = points.iter().map(numbers).collect();
    let fit = bench.calibration.elongation.as_ref();
    let fit = fit.and_then(|fit| fit.as_ref().ok());
    let remarks: Vec<String> = fit
        .iter()
        .flat_map(|fit| &fit.residuals_m)
        .map(|residual| signed(residual * 1e3, 4))
        .collect();
    let editor = Rows {
        noun: "Point",
        fields: &FIELDS,
        rows: &numbers,
        remarks: ("Residual", "mm"),
        remark: &remarks,
    };
    bench.edit_rows(ui, &editor, &mut input.rows, change);
}

fn numbers(point: &ElongationPoint) -> Numbers {
    [point.length_m, point.tension_n, point.elongation_m].map(Some)
}

fn change(phases: &mut PhaseData, edit: RowsEdit) {
    let point = |[length_m, tension_n, elongation_m]: Numbers| {
        Some(ElongationPoint {
            length_m: length_m?,
            tension_n: tension_n?,
            elongation_m: elongation_m?,
        })
    };
    edit.apply(&mut phases.elongation, |_| true, numbers, point);
}
