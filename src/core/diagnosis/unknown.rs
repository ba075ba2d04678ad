//! Structure without a name: smooth functions of every variable, on every reading.

use nalgebra::DMatrix;

use super::fit::Fit;
use super::moments::{Moments, PoseMoments};
use super::report::{Cause, Quantity};
use super::scores::{Block, Design, Scan, Scored};
use crate::effect::unknown::{FIRST, FROM, FUNCTIONS, READING, SCALE, TO, VARIABLE, functions};
use crate::effect::{BiasedReading, BoundEffect, Unknown};
use crate::measurement::Variable;

/// Fewest poses at which a function is sought.
const FEWEST: usize = 12;
/// Sizes of the functions that are tried, in standard deviations of a constant seen at one pose.
const SIZES: [f64; 10] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 256.0, 1024.0];

/// A reading, of a cable or of the platform.
fn bound(reading: usize, cable: Option<usize>) -> BoundEffect {
    let mut values = vec![0.0; FIRST + FUNCTIONS];
    values[READING] = reading as f64;
    // Any variable that every reading has: the first function is constant.
    values[VARIABLE] = Variable::Position(0).index() as f64;
    (values[TO], values[SCALE]) = (1.0, 1.0);
    BoundEffect {
        effect: &Unknown,
        cables: cable.into_iter().collect(),
        targeted: cable.is_some(),
        values,
    }
}

/// Structure of size zero on a kind of reading; none for kinds on which it is not sought.
pub(super) fn structure_on(quantity: Quantity, cable: Option<usize>) -> Option<BoundEffect> {
    let reading = match quantity {
        Quantity::Length => BiasedReading::Length,
        Quantity::Tension => BiasedReading::Tension,
        Quantity::Swivel => BiasedReading::Swivel,
        Quantity::Laser => BiasedReading::Laser,
        Quantity::Inclination => BiasedReading::Inclination(0),
        Quantity::TrackerPosition | Quantity::TrackerOrientation => return None,
    };
    let number = BiasedReading::ALL.iter().position(|r| *r == reading)?;
    Some(bound(number, cable))
}

/// Every reading on which structure is sought.
fn readings(cables: usize) -> Vec<BoundEffect> {
    let mut all = Vec::new();
    for (number, reading) in BiasedReading::ALL.iter().enumerate() {
        if reading.is_of_cable() {
            all.extend((0..cables).map(|cable| bound(number, Some(cable))));
        } else {
            all.push(bound(number, None));
        }
    }
    all
}

/// The best function of one variable for every reading.
pub(super) fn unknowns(fit: &Fit<'_>, scan: &Scan) -> Vec<Scored> {
    let bounds = readings(fit.problem.dataset.robot.cable_count());
    let design = Design::new(fit, &bounds, scan.linear.rows.len());
    let mut found = Vec::new();
    for (index, bound) in bounds.iter().enumerate() {
        let column = design.column_of(index, FIRST);
        let moments = Moments::new(&design.columns.select_columns(&[column]), scan);
        for variable in Variable::ALL {
            found.extend(best_function(fit, bound, variable, &moments));
        }
    }
    found
}

/// Values of a variable at the poses.
fn values_of(
    fit: &Fit<'_>,
    bound: &BoundEffect,
    variable: Variable,
    moments: &Moments,
) -> Option<Vec<f64>> {
    let circumstances = fit.problem.circumstances.as_ref()?;
    let at = |pose: &PoseMoments| match bound.cables.first() {
        Some(cable) => circumstances.cable(pose.row, *cable).variables,
        None => circumstances.platform(pose.row).variables,
    };
    let values = moments.poses.iter().map(|pose| at(pose)[variable.index()]);
    Some(values.collect())
}

fn best_function(
    fit: &Fit<'_>,
    bound: &BoundEffect,
    variable: Variable,
    moments: &Moments,
) -> Option<Scored> {
    let values = values_of(fit, bound, variable, moments)?;
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let from = finite().fold(f64::INFINITY, f64::min);
    let to = finite().fold(f64::NEG_INFINITY, f64::max);
    if finite().count() < FEWEST || to - from <= 1e-9 * to.abs().max(from.abs()) {
        return None;
    }
    let weights = DMatrix::from_fn(values.len(), FUNCTIONS, |j, k| {
        functions(variable, values[j], [from, to])[k]
    });
    let (score, information) = moments.weighted(&weights);
    let constant = information[(0, 0)] / finite().count() as f64;
    if constant <= 0.0 {
        return None;
    }
    let parameters = bound.effect.parameters();
    let prior: Vec<f64> = parameters[FIRST..].iter().map(|p| p.prior_sd).collect();
    let best = SIZES
        .iter()
        .filter_map(|size| {
            let scale = size / constant.sqrt();
            let scaled: Vec<f64> = prior.iter().map(|sd| sd * scale).collect();
            Some((Block::new(&score, &information, &scaled)?, scale))
        })
        .max_by(|(a, _), (b, _)| a.score().total_cmp(&b.score()));
    let (block, scale) = best?;
    let mut bound = bound.clone();
    bound.values[VARIABLE] = variable.index() as f64;
    (bound.values[FROM], bound.values[TO]) = (from, to);
    bound.values[SCALE] = scale;
    for (value, estimate) in bound.values[FIRST..].iter_mut().zip(&block.estimate) {
        *value = estimate / scale;
    }
    let cause = Cause {
        instances: vec![bound],
    };
    // It could have been any variable.
    let places = 2.0 * (Variable::COUNT as f64).ln();
    Some(block.scored(cause, block.freedom, places))
}
