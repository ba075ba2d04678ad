//! Plots of model errors: residuals over the variables they depend on, with curves of the effects
//! that explain them.

use std::collections::{BTreeMap, HashMap};

use tautline_core::diagnosis::{Discrepancy, Finding};
use tautline_core::effect::{Search, measurements_as_modelled};
use tautline_core::estimation::{Analysis, Problem};
use tautline_core::measurement::{Dataset, Variable};

use crate::documents::diagnosis::Diagnosed;
use crate::identification::{RESIDUAL, readings_of};
use crate::plot::figure::{Axis, Band, Curve, Figure, Ink, Marker, Point, Series};
use crate::plot::gaps::without_gaps;
use crate::wording::sentence;

/// Number of readings whose dependences are shown, the worst first.
const SHOWN: usize = 5;
/// The drawn curve is a moving average over one of this many parts of the points.
const WINDOWS: usize = 10;

/// Groups dependences of the same readings, by their indices: their variables vary together, so that they are
/// one discrepancy in several variables.
#[must_use]
pub fn groups(found: &[Discrepancy]) -> Vec<Vec<usize>> {
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
    groups.truncate(SHOWN);
    groups
}

/// The dependence that revealed a finding: of its cables if it names some, the strongest first.
#[must_use]
pub fn of_finding(found: &[Discrepancy], finding: &Finding) -> Option<usize> {
    let instances = finding.cause.instances.iter();
    let cables: Vec<usize> = instances
        .filter(|bound| bound.targeted)
        .flat_map(|bound| bound.cables.iter().copied())
        .collect();
    let is_its = |one: &Discrepancy| match one.cable {
        Some(cable) => cables.contains(&cable),
        None => cables.is_empty(),
    };
    let shown = found.iter().position(is_its);
    shown.or_else(|| (cables.is_empty() && !found.is_empty()).then_some(0))
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

impl Residuals {
    fn of(diagnosed: &Diagnosed) -> Option<Self> {
        let diagnosis = &diagnosed.diagnosis;
        let robot = diagnosed.robot();
        let modelled = measurements_as_modelled(robot, &diagnosed.dataset.measurements).ok()?;
        let dataset = Dataset {
            robot: robot.clone(),
            measurements: modelled.into_owned(),
        };
        let problem = || {
            let problem = Problem::new(&dataset).ok()?;
            Some(problem.at_poses_of(&diagnosis.base_solution))
        };
        let before = Analysis::new(&problem()?, &diagnosis.base_solution);
        let after = || {
            let mut problem = problem()?;
            let effects = &diagnosis.extended_solution.globals.effects;
            let free = effects.get(problem.held_effects.len()..)?;
            if free.is_empty() || free.iter().any(|bound| !bound.effect.is_estimable()) {
                return None;
            }
            problem.free_effects = free.to_vec();
            Some(Analysis::new(&problem, &diagnosis.extended_solution))
        };
        Some(Self {
            before,
            after: after(),
        })
    }
}

/// Residuals of a kind of reading by row; an instrument with several readings per row has several.
fn by_row(analysis: &Analysis, found: &Discrepancy) -> HashMap<usize, Vec<f64>> {
    let mut rows: HashMap<usize, Vec<f64>> = HashMap::new();
    for one in readings_of(analysis, found.quantity, found.cable) {
        if let Some(deviations) = one.normalised() {
            rows.entry(one.row).or_default().push(deviations);
        }
    }
    rows
}

/// A reading that depends on a variable.
struct Dependent {
    row: usize,
    variable: f64,
    residual: f64,
    /// The part of the residual that the findings explain.
    explained: Option<f64>,
}

/// The readings of a dependence, with the residuals shown in all plots.
fn dependents(found: &Discrepancy, residuals: &Residuals) -> Vec<Dependent> {
    let before = by_row(&residuals.before, found);
    let after = residuals.after.as_ref();
    let after = after.map(|after| by_row(after, found));
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
    let (factor, unit) = unit(found.variable);
    let labels = &diagnosed.dataset.measurements.labels;
    let dependents = dependents(found, residuals);
    let point = |one: &Dependent| Point {
        pose: labels.get(one.row).copied(),
        ..Point::new(factor * one.variable, one.residual)
    };
    let points: Vec<Point> = dependents.iter().map(point).collect();
    let window = if has_event(diagnosed) {
        1
    } else {
        (points.len() / WINDOWS).max(3)
    };
    let series = match found.cable {
        Some(cable) => {
            Series::of_cable(cable, diagnosed.robot().cables[cable].name.as_str(), points)
        }
        None => Series::new(found.quantity.name(), Ink::Accent, Marker::Circle, points),
    };
    Figure {
        x: Axis::new(sentence(found.variable.name()), unit),
        y: Axis::new(RESIDUAL, "standard deviations"),
        bands: vec![Band {
            name: "within 3 standard deviations".to_owned(),
            y: [-3.0, 3.0],
        }],
        series: vec![series],
        curves: explained(&dependents, factor, window),
        has_zero_line: true,
        ..Figure::default()
    }
}

/// The part of the residuals that the findings explain, over the variable: before less after, both in their own standard
/// deviations; interrupted where there are no data.
fn explained(dependents: &[Dependent], factor: f64, window: usize) -> Vec<Curve> {
    let known = dependents.iter();
    let points: Vec<[f64; 2]> = known
        .filter_map(|one| Some([factor * one.variable, one.explained?]))
        .collect();
    if points.len() < 3 {
        return Vec::new();
    }
    let data: Vec<f64> = points.iter().map(|[x, _]| *x).collect();
    let pieces = without_gaps(&smooth(points, window), &data);
    let pieces = pieces.into_iter().enumerate();
    pieces
        .map(|(number, points)| Curve {
            // Only the first piece has an entry in the legend.
            name: match number {
                0 => "explained by the causes found".to_owned(),
                _ => String::new(),
            },
            ink: Ink::Text,
            dashed: false,
            points,
        })
        .collect()
}

/// Whether a finding acts at one pose, or from one pose on: then neighbours along a variable are
/// unrelated.
fn has_event(diagnosed: &Diagnosed) -> bool {
    diagnosed.diagnosis.findings.iter().any(|finding| {
        let search = finding.cause.effect().search();
        matches!(search, Search::AtPose(_) | Search::FromPose(_))
    })
}

/// The moving average over `window` neighbours along x.
fn smooth(mut points: Vec<[f64; 2]>, window: usize) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let half = window / 2;
    let mean = |k: usize| {
        let around = &points[k.saturating_sub(half)..(k + half + 1).min(points.len())];
        let count = around.len() as f64;
        let sum = around
            .iter()
            .fold([0.0; 2], |[x, y], p| [x + p[0], y + p[1]]);
        sum.map(|v| v / count)
    };
    (0..points.len()).map(mean).collect()
}

/// Display factor and display unit of a variable.
fn unit(variable: Variable) -> (f64, &'static str) {
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
    fn a_straight_line_stays_one() {
        let line: Vec<_> = (0..40)
            .rev()
            .map(|k| [f64::from(k), 2.0 * f64::from(k)])
            .collect();
        let smoothed = smooth(line, 5);
        assert_eq!(smoothed.len(), 40);
        assert!(smoothed.is_sorted_by(|a, b| a[0] < b[0]));
        assert!(smoothed.iter().all(|[x, y]| (y - 2.0 * x).abs() < 1e-12));
    }
}
