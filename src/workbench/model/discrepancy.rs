//! Where the model is wrong, and along what, as plots: residuals over the variable on which they depend, with the effects
//! that explain them drawn through.

use std::collections::BTreeMap;

use tautline_core::diagnosis::{Discrepancy, Quantity};
use tautline_core::effect::{Search, measurements_as_modelled};
use tautline_core::estimation::{Analysis, ObservationKind, Problem};
use tautline_core::measurement::{Dataset, Variable};

use tautline_workflow::documents::diagnosis::Diagnosed;
use tautline_workflow::plot::figure::{Axis, Band, Curve, Figure, Ink, Marker, Point, Series};
use tautline_workflow::wording::sentence;

/// Readings of which dependences are shown, the worst.
const SHOWN: usize = 5;
/// Part of the points over which the drawn curve is averaged, one of this many.
const WINDOWS: usize = 10;

/// Dependences of the same readings, by their places among all: what they depend on varies together, so that they are
/// one discrepancy seen from several sides.
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

/// The plots of the strongest dependences, by their places among all.
#[must_use]
pub fn figures(diagnosed: &Diagnosed) -> BTreeMap<usize, Figure> {
    let after = after(diagnosed);
    let found = &diagnosed.diagnosis.discrepancies;
    let shown = groups(found).concat().into_iter();
    shown
        .map(|index| (index, figure(diagnosed, &found[index], after.as_ref())))
        .collect()
}

/// The residuals of the extended model; `None` where it has no effects, or exchanges channels so that readings are not the
/// same ones.
fn after(diagnosed: &Diagnosed) -> Option<Analysis> {
    let diagnosis = &diagnosed.diagnosis;
    let robot = diagnosed.robot();
    let modelled = measurements_as_modelled(robot, &diagnosed.dataset.measurements).ok()?;
    let dataset = Dataset {
        robot: robot.clone(),
        measurements: modelled.into_owned(),
    };
    let problem = Problem::new(&dataset).ok()?;
    let mut problem = problem.at_poses_of(&diagnosis.base_solution);
    let effects = &diagnosis.extended_solution.globals.effects;
    let free = effects.get(problem.held_effects.len()..)?;
    if free.is_empty() || free.iter().any(|bound| !bound.effect.is_estimable()) {
        return None;
    }
    problem.free_effects = free.to_vec();
    Some(Analysis::new(&problem, &diagnosis.extended_solution))
}

fn figure(diagnosed: &Diagnosed, found: &Discrepancy, after: Option<&Analysis>) -> Figure {
    let (factor, unit) = unit(found.variable);
    let x = |value: f64| factor * value;
    let labels = &diagnosed.dataset.measurements.labels;
    let point = |(row, variable, residual): &(usize, f64, f64)| Point {
        pose: labels.get(*row).copied(),
        ..Point::new(x(*variable), *residual)
    };
    let points: Vec<Point> = found.points.iter().map(point).collect();
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
    let explained = after.and_then(|after| explained(found, after));
    let curve = explained.map(|points| Curve {
        name: "explained by the causes found".to_owned(),
        ink: Ink::Text,
        dashed: false,
        points: smooth(points.into_iter().map(|[v, y]| [x(v), y]).collect(), window),
    });
    Figure {
        x: Axis::new(sentence(found.variable.name()), unit),
        y: Axis::new("Residual", "standard deviations"),
        bands: vec![Band {
            name: "within 3 standard deviations".to_owned(),
            y: [-3.0, 3.0],
        }],
        series: vec![series],
        curves: curve.into_iter().collect(),
        has_zero_line: true,
        ..Figure::default()
    }
}

/// What the extended model takes off the residuals, over the variable: residual before less residual after, both in their
/// own standard deviations.
fn explained(found: &Discrepancy, after: &Analysis) -> Option<Vec<[f64; 2]>> {
    let kind = match (found.quantity, found.cable) {
        (Quantity::Length, Some(cable)) => ObservationKind::Length(cable),
        (Quantity::Swivel, Some(cable)) => ObservationKind::Swivel(cable),
        (Quantity::Laser, _) => ObservationKind::Laser,
        _ => return None,
    };
    let left = |row: usize| {
        let mut readings = after.observations.iter();
        readings
            .find(|r| r.kind == kind && r.row == row)?
            .normalised()
    };
    let points = found
        .points
        .iter()
        .filter(|(_, variable, _)| variable.is_finite());
    let points: Vec<_> = points
        .filter_map(|(row, variable, residual)| Some([*variable, residual - left(*row)?]))
        .collect();
    (points.len() > 2).then_some(points)
}

/// Whether something that was found acts at one pose, or from one on: then neighbours along a variable have nothing to do
/// with each other.
fn has_event(diagnosed: &Diagnosed) -> bool {
    diagnosed.diagnosis.findings.iter().any(|finding| {
        let search = finding.cause.effect().search();
        matches!(search, Search::AtPose(_) | Search::FromPose(_))
    })
}

/// The running mean over this many neighbours along x.
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

/// Factor and unit in which people read a variable.
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
