//! Residuals of a quantity along a variable, before and after the findings of a diagnosis.

use std::collections::BTreeSet;

use egui::Ui;
use nalgebra::DVector;
use tautline_core::diagnosis::{Quantity, smooth_functions};
use tautline_core::measurement::Variable;

use super::at_row;
use crate::model::open_session::Diagnosed;
use crate::model::plot_preparation::{Prepared, residuals};
use crate::views::plots::choices::{VariableChoice, combo_within};
use crate::views::plots::kind::{Content, OptionsInput, PlotKind, PlotOptions, Unavailable};
use tautline_workflow::identification::{Identification, RESIDUAL};
use tautline_workflow::plot::figure::{Axis, Band, Curve, Figure, Ink, Marker, Point, Series};
use tautline_workflow::plot::gaps::without_gaps;

pub(crate) static PLOT: PlotKind = PlotKind {
    id: "variable",
    title: "By variable",
    missing: |open| {
        let is_missing = open.fit().is_none() && open.diagnosis().is_none();
        is_missing.then_some(
            "Residuals against length, tension, time and other variables appear here after identification.",
        )
    },
    options: choose,
    content: Content::Figure(|source| {
        let prepared = source.prepared()?;
        let nothing = Unavailable::Empty("No variable changes over these poses.");
        let choice = source.options.choice.ok_or(nothing)?;
        Ok(figure(
            prepared,
            source.diagnosed(),
            choice,
            source.excluded(),
        ))
    }),
};

/// Number of points of a fitted curve.
const PLACES: usize = 120;
/// Number of readings averaged for each point of the effect's curve.
const AVERAGED: usize = 24;

/// Legend of the residuals of the extended model.
const AFTER: &str = "after, with the causes found";

/// Width of a menu button with the space before it (points).
const MENU: f32 = 72.0;

fn choose(ui: &mut Ui, options: &mut PlotOptions, input: &OptionsInput<'_>) {
    if let (Some(prepared), Some(choice)) = (input.prepared, options.choice) {
        let room = ui.available_width() - MENU - ui.spacing().item_spacing.x;
        let width = input.is_narrow.then_some(0.5 * room);
        options.choice = Some(along(ui, prepared, choice, width));
    }
}

/// Two combo boxes of equal width: reading and variable.
fn along(
    ui: &mut Ui,
    prepared: &Prepared,
    mut choice: VariableChoice,
    width: Option<f32>,
) -> VariableChoice {
    let name = |quantity: Quantity, cable: Option<usize>| {
        let cables = &prepared.base.dataset.robot.cables;
        match cable.and_then(|index| cables.get(index)) {
            Some(cable) => format!("{} of {}", capitalised(quantity.name()), cable.name),
            None => capitalised(quantity.name()),
        }
    };
    let before = (choice.quantity, choice.cable);
    let readings = name(choice.quantity, choice.cable);
    combo_within(ui, "Readings", width, &readings, |ui| {
        for group in &prepared.along {
            let is_chosen = (group.quantity, group.cable) == (choice.quantity, choice.cable);
            if ui
                .selectable_label(is_chosen, name(group.quantity, group.cable))
                .clicked()
            {
                (choice.quantity, choice.cable) = (group.quantity, group.cable);
            }
        }
    });
    let group = prepared
        .along
        .iter()
        .find(|g| (g.quantity, g.cable) == (choice.quantity, choice.cable));
    let variables = group.map_or(&[][..], |group| &group.variables);
    if (choice.quantity, choice.cable) != before
        && !variables
            .iter()
            .any(|(variable, _)| *variable == choice.variable)
        && let Some((first, _)) = variables.first()
    {
        choice.variable = *first;
    }
    let variable = capitalised(choice.variable.name());
    combo_within(ui, "Along", width, &variable, |ui| {
        for (variable, _) in variables {
            ui.selectable_value(
                &mut choice.variable,
                *variable,
                capitalised(variable.name()),
            );
        }
    });
    choice
}

/// Display name and unit of a variable, and the factor from its SI unit.
fn axis(variable: Variable) -> (Axis, f64) {
    let (unit, factor) = match variable {
        Variable::CableLength | Variable::Distance | Variable::Position(_) => ("m", 1.0),
        Variable::Tension => ("N", 1.0),
        Variable::WrapAngle | Variable::SwivelAngle | Variable::Rotation(_) => {
            ("degrees", 180.0 / std::f64::consts::PI)
        }
        Variable::Time => ("s", 1.0),
        Variable::Temperature => ("K", 1.0),
        Variable::Revolutions | Variable::DrumFraction => ("", 1.0),
        Variable::Direction => ("1 paid out, \u{2212}1 reeled in", 1.0),
    };
    (Axis::new(capitalised(variable.name()), unit), factor)
}

/// Name with a capital initial.
fn capitalised(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// Row, variable and residual.
type DataPoint = (usize, f64, f64);

/// Residuals along the variable.
pub(crate) fn figure(
    prepared: &Prepared,
    diagnosed: Option<&Diagnosed>,
    choice: VariableChoice,
    excluded: &BTreeSet<i64>,
) -> Figure {
    let Some(values) = choice.values(prepared) else {
        return Figure::default();
    };
    let (x, factor) = axis(choice.variable);
    let data = &prepared.base.dataset;
    let points = |places: &[DataPoint]| -> Vec<Point> {
        let point = |(row, x, y): &DataPoint| at_row(data, excluded, *row, *x, *y);
        places.iter().map(point).collect()
    };
    let before = places(&prepared.base, choice, values, factor);
    let mut figure = Figure {
        x,
        y: Axis::new(RESIDUAL, "standard deviations"),
        bands: vec![Band::new("3 standard deviations", [-3.0, 3.0])],
        series: vec![series(choice, &prepared.base, points(&before))],
        has_zero_line: true,
        ..Figure::default()
    };
    if let Some(extended) = &prepared.extended {
        let after = places(extended, choice, values, factor);
        let mut series = Series::new(AFTER, Ink::Muted, Marker::Circle, points(&after));
        series.cable = choice.cable;
        figure.series.push(series);
        figure
            .curves
            .extend(pieces(&effect(&before, &after), &before));
    }
    let is_found = diagnosed.is_some_and(|found| choice.is_dependence(found));
    let curve = is_found.then(|| dependence(&before, choice.variable, factor));
    if let Some(curve) = curve.flatten() {
        figure.curves.extend(pieces(&curve, &before));
    }
    figure
}

/// Parts of a curve where there are data; the legend names only the first.
fn pieces(curve: &Curve, places: &[DataPoint]) -> Vec<Curve> {
    let data: Vec<f64> = places.iter().map(|(_, x, _)| *x).collect();
    let pieces = without_gaps(&curve.points, &data).into_iter().enumerate();
    pieces
        .map(|(number, points)| Curve {
            name: match number {
                0 => curve.name.clone(),
                _ => String::new(),
            },
            points,
            ..curve.clone()
        })
        .collect()
}

fn places(
    fit: &Identification,
    choice: VariableChoice,
    values: &[f64],
    factor: f64,
) -> Vec<DataPoint> {
    residuals(fit, choice.quantity, choice.cable)
        .into_iter()
        .filter_map(|(row, value)| Some((row, factor * values.get(row)?, value)))
        .collect()
}

fn series(choice: VariableChoice, fit: &Identification, points: Vec<Point>) -> Series {
    let cables = &fit.dataset.robot.cables;
    match choice
        .cable
        .and_then(|index| Some((index, cables.get(index)?)))
    {
        Some((index, cable)) => Series::of_cable(index, &cable.name, points),
        None => Series::new(choice.quantity.name(), Ink::Accent, Marker::Circle, points),
    }
}

/// Least-squares curve through the residuals of a dependence, in the basis functions of the diagnosis. `factor`
/// converts from the SI unit of the variable.
fn dependence(places: &[DataPoint], variable: Variable, factor: f64) -> Option<Curve> {
    let known = places
        .iter()
        .filter(|(_, x, y)| x.is_finite() && y.is_finite());
    let known = known.map(|(_, x, y)| (x / factor, *y));
    let (mut values, residuals): (Vec<f64>, Vec<f64>) = known.unzip();
    let count = values.len();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if greatest <= least {
        return None;
    }
    let along = (0..=PLACES).map(|k| least + (greatest - least) * k as f64 / PLACES as f64);
    values.extend(along);
    let is_direction = variable == Variable::Direction;
    let functions = smooth_functions(&values, variable, count / 4);
    if functions.is_empty() {
        return None;
    }
    let design = functions.insert_column(0, 1.0);
    let fitted = design.rows(0, count).into_owned();
    let coefficients = fitted
        .svd(true, true)
        .solve(&DVector::from_vec(residuals), 1e-9)
        .ok()?;
    let curve = design.rows(count, PLACES + 1) * coefficients;
    let places = values[count..].iter().zip(&curve);
    Some(Curve {
        name: "dependence found".into(),
        ink: Ink::Text,
        dashed: is_direction,
        points: places.map(|(x, y)| [factor * x, *y]).collect(),
    })
}

/// Part of the residuals explained by the findings: before minus after, averaged over neighbours along the variable.
fn effect(before: &[DataPoint], after: &[DataPoint]) -> Curve {
    let by_row: std::collections::HashMap<usize, f64> =
        after.iter().map(|(row, _, value)| (*row, *value)).collect();
    let mut explained: Vec<[f64; 2]> = before
        .iter()
        .filter_map(|(row, x, value)| Some([*x, value - by_row.get(row)?]))
        .filter(|place| place[0].is_finite())
        .collect();
    explained.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let size = explained.len().div_ceil(AVERAGED).max(1);
    let mean = |part: &[[f64; 2]]| {
        let count = part.len() as f64;
        [0, 1].map(|k| part.iter().map(|place| place[k]).sum::<f64>() / count)
    };
    Curve {
        name: "explained by the causes found".into(),
        ink: Ink::Accent,
        dashed: true,
        points: explained.chunks(size).map(mean).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_of_a_dependence_runs_through_its_points() {
        let value = |k: usize| k as f64 / 40.0;
        let places: Vec<DataPoint> = (0..=40)
            .map(|k| {
                (
                    k,
                    10.0 * value(k),
                    2.0 * (std::f64::consts::PI * value(k)).cos(),
                )
            })
            .chain([(41, f64::NAN, 1.0)])
            .collect();
        let curve = dependence(&places, Variable::CableLength, 10.0).expect("a curve");
        for [x, y] in curve.points {
            assert!((y - 2.0 * (0.1 * std::f64::consts::PI * x).cos()).abs() < 1e-9);
        }
    }

    #[test]
    fn what_is_explained_is_the_difference() {
        let before: Vec<_> = (0..48).map(|k| (k, k as f64, 5.0)).collect();
        let after: Vec<_> = (0..48).map(|k| (k, k as f64, 1.0)).collect();
        let curve = effect(&before, &after);
        assert_eq!(curve.points.len(), AVERAGED);
        assert!(curve.points.iter().all(|place| place[1] == 4.0));
        assert_eq!(capitalised("wrap angle"), "Wrap angle");
    }
}
