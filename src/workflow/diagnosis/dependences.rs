//! Plots of model errors: residuals over the variables they depend on, with curves of the effects
//! that explain them.

use std::collections::{BTreeMap, HashMap};

use tautline_core::diagnosis::{Discrepancy, Finding, Quantity, Subject};
use tautline_core::effect::measurements_as_modelled;
use tautline_core::estimation::{Analysis, Solution};
use tautline_core::measurement::{Dataset, Variable};

use super::evidence::problem_of;
use crate::diagnosis::Diagnosed;
use crate::identification::{RESIDUAL, readings_of};
use crate::plot::figure::{Axis, Band, Curve, Figure, Ink, Marker, Point, Series};
use crate::plot::gaps::without_gaps;
use crate::wording::sentence;

/// Number of readings whose dependences are shown, the worst first.
const SHOWN: usize = 5;
/// Share of the points, and their least number, that determine a smooth line at each place, and its number of pieces.
const NEIGHBOURS: f64 = 0.4;
const LEAST_NEIGHBOURS: usize = 5;
const LINE_STEPS: usize = 80;

/// The groups that are shown.
#[must_use]
pub fn groups(found: &[Discrepancy]) -> Vec<Vec<usize>> {
    let mut groups = all_groups(found);
    groups.truncate(SHOWN);
    groups
}

/// Groups dependences of the same readings, by their indices: their variables vary together, so that they are
/// one discrepancy in several variables.
pub(super) fn all_groups(found: &[Discrepancy]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, one) in found.iter().enumerate() {
        let of = |k: &usize| (found[*k].quantity, found[*k].cable);
        let same =
            |group: &&mut Vec<usize>| group.first().map(of) == Some((one.quantity, one.cable));
        match groups.iter_mut().find(same) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    groups
}

/// The dependence that revealed a finding: of its cables if it concerns some, on its own variable if there is one, otherwise
/// the strongest of the same readings; `None` if there is no dependence of these readings.
#[must_use]
pub fn of_finding(found: &[Discrepancy], finding: &Finding) -> Option<usize> {
    let cables = finding.subject.cables();
    let is_its = |one: &Discrepancy| match &finding.subject {
        Subject::UnmodelledError(error) if one.quantity != error.readings.quantity => false,
        _ => one
            .cable
            .map_or(cables.is_empty(), |cable| cables.contains(&cable)),
    };
    let own = match &finding.subject {
        Subject::Cause(cause) => cause.effect().variable(),
        Subject::UnmodelledError(error) => error.form.variable(),
        Subject::WrongDrawing(_) | Subject::Slack(_) => None,
    };
    let mut all = found.iter();
    let shown = all.position(|one| is_its(one) && Some(one.variable) == own);
    shown.or_else(|| found.iter().position(is_its))
}

/// The plots of the strongest dependences, by their indices.
#[must_use]
pub fn figures(diagnosed: &Diagnosed) -> BTreeMap<usize, Figure> {
    let Some(residuals) = Residuals::of(diagnosed) else {
        return BTreeMap::new();
    };
    let found = &diagnosed.diagnosis.discrepancies;
    let shown = groups(found).concat().into_iter();
    shown
        .map(|index| (index, figure(diagnosed, &found[index], &residuals)))
        .collect()
}

/// The residuals of the diagnosed model, and those with the findings included.
struct Residuals {
    before: Analysis,
    /// `None` if no finding has a size, or channels are exchanged so that the readings differ.
    after: Option<Analysis>,
}

/// The dataset of a diagnosis with the channels as its model states them.
pub(super) fn dataset_as_modelled(diagnosed: &Diagnosed) -> Option<Dataset> {
    let robot = diagnosed.robot();
    let modelled = measurements_as_modelled(robot, &diagnosed.dataset.measurements).ok()?;
    Some(Dataset {
        robot: robot.clone(),
        measurements: modelled.into_owned(),
    })
}

impl Residuals {
    fn of(diagnosed: &Diagnosed) -> Option<Self> {
        let dataset = dataset_as_modelled(diagnosed)?;
        let analysis = |solution: &Solution| {
            let problem = problem_of(diagnosed, &dataset, solution)?;
            Some(Analysis::new(&problem, solution))
        };
        let extended = &diagnosed.diagnosis.extended_solution;
        let has_sizes = extended.globals.effects.len() > diagnosed.diagnosis.held;
        Some(Self {
            before: analysis(&diagnosed.diagnosis.base_solution)?,
            after: analysis(extended).filter(|_| has_sizes),
        })
    }
}

/// Residuals of a kind of reading by row; an instrument with several readings per row has several.
pub(super) fn by_row(
    analysis: &Analysis,
    (quantity, cable): (Quantity, Option<usize>),
) -> HashMap<usize, Vec<f64>> {
    let mut rows: HashMap<usize, Vec<f64>> = HashMap::new();
    for one in readings_of(analysis, quantity, cable) {
        if let Some(deviations) = one.normalised() {
            rows.entry(one.row).or_default().push(deviations);
        }
    }
    rows
}

/// A reading that depends on a variable.
pub(super) struct Dependent {
    pub row: usize,
    pub variable: f64,
    pub residual: f64,
    /// The part of the residual that causes explain.
    pub explained: Option<f64>,
}

/// The readings of a dependence, with the residuals shown in all plots.
fn dependents(found: &Discrepancy, residuals: &Residuals) -> Vec<Dependent> {
    let group = (found.quantity, found.cable);
    let before = by_row(&residuals.before, group);
    let after = residuals.after.as_ref();
    let after = after.map(|after| by_row(after, group));
    let mut seen: HashMap<usize, usize> = HashMap::new();
    let mut dependents = Vec::new();
    for (row, variable, _) in &found.points {
        let number = seen.entry(*row).or_default();
        let of = |rows: &HashMap<usize, Vec<f64>>| rows.get(row)?.get(*number).copied();
        if let Some(residual) = of(&before).filter(|_| variable.is_finite()) {
            let left = after.as_ref().and_then(of);
            dependents.push(Dependent {
                row: *row,
                variable: *variable,
                residual,
                explained: left.map(|left| residual - left),
            });
        }
        *number += 1;
    }
    dependents
}

fn figure(diagnosed: &Diagnosed, found: &Discrepancy, residuals: &Residuals) -> Figure {
    let dependents = dependents(found, residuals);
    // What happens at one pose, or from one on, is no function of another variable.
    let mut causes = diagnosed
        .diagnosis
        .findings
        .iter()
        .filter_map(Finding::cause);
    let has_event = causes.any(|cause| cause.effect().pose_parameter().is_some());
    let event = has_event.then_some((0, false));
    let readings = (found.quantity, found.cable, found.variable);
    figure_of(diagnosed, readings, &dependents, event)
}

/// Residuals of readings over a variable, and a line of the contribution of causes. `event` is the row at which a cause acts,
/// and whether it continues from there on: then the line has a step there, otherwise it passes through each point.
pub(super) fn figure_of(
    diagnosed: &Diagnosed,
    (quantity, cable, variable): (Quantity, Option<usize>, Variable),
    dependents: &[Dependent],
    event: Option<(usize, bool)>,
) -> Figure {
    let (factor, unit) = display_unit(variable);
    let labels = &diagnosed.dataset.measurements.labels;
    let point = |one: &Dependent| Point {
        pose: labels.get(one.row).copied(),
        ..Point::new(factor * one.variable, one.residual)
    };
    let points: Vec<Point> = dependents.iter().map(point).collect();
    let series = match cable {
        Some(cable) => {
            Series::of_cable(cable, diagnosed.robot().cables[cable].name.as_str(), points)
        }
        None => Series::new(quantity.name(), Ink::Accent, Marker::Circle, points),
    };
    Figure {
        x: Axis::new(sentence(variable.name()), unit),
        y: Axis::new(RESIDUAL, "standard deviations"),
        bands: vec![Band {
            name: "within 3 standard deviations".to_owned(),
            y: [-3.0, 3.0],
        }],
        series: vec![series],
        curves: explained(dependents, factor, event),
        has_zero_line: true,
        ..Figure::default()
    }
}

/// Value and part of the residual that causes explain, of some readings.
fn explained_points(
    dependents: &[Dependent],
    factor: f64,
    is_part: impl Fn(&Dependent) -> bool,
) -> Vec<[f64; 2]> {
    let known = dependents.iter().filter(|one| is_part(one));
    known
        .filter_map(|one| Some([factor * one.variable, one.explained?]))
        .collect()
}

/// The part of the residuals that causes explain, over the variable, as a smooth line, in two pieces where there is a step.
fn lines(
    dependents: &[Dependent],
    factor: f64,
    event: Option<(usize, bool)>,
) -> Vec<Vec<[f64; 2]>> {
    let points = |from: usize, to: usize| {
        explained_points(dependents, factor, |one| (from..to).contains(&one.row))
    };
    match event {
        None => vec![smooth(&points(0, usize::MAX))],
        Some((row, true)) => vec![smooth(&points(0, row)), smooth(&points(row, usize::MAX))],
        Some((_, false)) => {
            let mut all = points(0, usize::MAX);
            all.sort_by(|a, b| a[0].total_cmp(&b[0]));
            vec![all]
        }
    }
}

/// Contribution of a cause to each reading, averaged over readings with about the same value of the variable.
pub(super) fn averaged(dependents: &[Dependent], event: Option<(usize, bool)>) -> Vec<f64> {
    let lines = lines(dependents, 1.0, event);
    let value = |one: &Dependent| {
        let is_after = matches!(event, Some((row, true)) if one.row >= row);
        let line = &lines[usize::from(is_after)];
        let next = line.partition_point(|[x, _]| *x < one.variable);
        match (line.get(next.wrapping_sub(1)), line.get(next)) {
            (Some([x0, y0]), Some([x1, y1])) if x1 > x0 => {
                y0 + (y1 - y0) * (one.variable - x0) / (x1 - x0)
            }
            (Some([_, y]), None) | (_, Some([_, y])) => *y,
            (None, None) => 0.0,
        }
    };
    dependents.iter().map(value).collect()
}

/// Curves of the contribution of causes; interrupted where there are no data.
fn explained(dependents: &[Dependent], factor: f64, event: Option<(usize, bool)>) -> Vec<Curve> {
    let pieces = lines(dependents, factor, event);
    let data = explained_points(dependents, factor, |_| true);
    let data: Vec<f64> = data.iter().map(|[x, _]| *x).collect();
    let pieces = pieces.iter().flat_map(|piece| without_gaps(piece, &data));
    pieces
        .enumerate()
        .map(|(number, points)| Curve {
            // Only the first piece has an entry in the legend.
            name: match number {
                0 => "explained by the cause".to_owned(),
                _ => String::new(),
            },
            ink: Ink::Text,
            dashed: false,
            points,
        })
        .collect()
}

/// A smooth line through points: locally weighted regression with tricube weights (Cleveland 1979).
fn smooth(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let xs = || points.iter().map(|[x, _]| *x);
    let (from, to) = (
        xs().fold(f64::INFINITY, f64::min),
        xs().fold(f64::NEG_INFINITY, f64::max),
    );
    if points.len() < LEAST_NEIGHBOURS || from >= to {
        let mut points = points.to_vec();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        return points;
    }
    let neighbours = (NEIGHBOURS * points.len() as f64).ceil() as usize;
    let neighbours = neighbours.clamp(LEAST_NEIGHBOURS, points.len());
    let at = |step: usize| from + (to - from) * step as f64 / LINE_STEPS as f64;
    let value = |x: f64| {
        let mut distances: Vec<f64> = xs().map(|other| (other - x).abs()).collect();
        distances.sort_by(f64::total_cmp);
        let reach = distances[neighbours - 1] * (1.0 + 1e-9) + f64::MIN_POSITIVE;
        let mut sums = [0.0; 5];
        for [other, y] in points {
            let off = other - x;
            let weight = (1.0 - (off / reach).abs().min(1.0).powi(3)).powi(3);
            let terms = [1.0, off, off * off, *y, off * y];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += weight * term;
            }
        }
        let [w, wx, wxx, wy, wxy] = sums;
        let spread = w * wxx - wx * wx;
        match spread > 1e-9 * w * w * (to - from).powi(2) {
            true => (wxx * wy - wx * wxy) / spread,
            false => wy / w,
        }
    };
    (0..=LINE_STEPS)
        .map(|step| [at(step), value(at(step))])
        .collect()
}

/// Display factor and display unit of a variable.
pub(crate) fn display_unit(variable: Variable) -> (f64, &'static str) {
    match variable {
        Variable::CableLength | Variable::Distance | Variable::Position(_) => (1.0, "m"),
        Variable::Tension => (1.0, "N"),
        Variable::WrapAngle | Variable::SwivelAngle | Variable::Rotation(_) => {
            (1.0_f64.to_degrees(), "degrees")
        }
        Variable::Time => (1.0 / 60.0, "minutes"),
        Variable::Temperature => (1.0, "K"),
        Variable::Revolutions | Variable::DrumFraction | Variable::Direction => (1.0, ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_line_follows_a_straight_one_and_calms_noise() {
        let line = |noise: f64| -> Vec<[f64; 2]> {
            let point = |k: u32| {
                let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
                [f64::from(k), 2.0 * f64::from(k) + sign * noise]
            };
            (0..40).rev().map(point).collect()
        };
        let off = |points: &[[f64; 2]]| {
            let off = smooth(points).into_iter().map(|[x, y]| (y - 2.0 * x).abs());
            off.fold(0.0, f64::max)
        };
        assert!(off(&line(0.0)) < 1e-9);
        assert!(off(&line(1.0)) < 0.5, "{}", off(&line(1.0)));
        assert!(smooth(&line(0.0)).is_sorted_by(|a, b| a[0] < b[0]));
    }
}
