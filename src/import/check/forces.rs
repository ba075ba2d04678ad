//! Unit, sign and order of the force channels, checked by the equilibrium of the platform.
//!
//! With tensions `T = s (f - bias) / gain` the equilibrium `A^T T + w = 0` holds for one factor `s`: 1 if all is well, 1000
//! if the forces are in kilonewtons.

use nalgebra::{DMatrix, DVector};
use tautline_core::kinematics::{applied_wrench, structure_matrix};
use tautline_core::robot::{Robot, STANDARD_GRAVITY_M_S2};

use super::expected::Expected;
use super::{Change, FEWEST, Readings, Suggestion};
use crate::recipe::{Quantity, QuantityKind as Kind};

/// Factors from other units to newtons.
const UNITS: [(f64, &str); 4] = [
    (1e3, "kilonewtons"),
    (STANDARD_GRAVITY_M_S2, "kilograms"),
    (1e-3, "millinewtons"),
    (1.0 / STANDARD_GRAVITY_M_S2, "newtons multiplied by g"),
];
/// Smallest true mass of a platform as a fraction of the stated one: no guess is further off.
const LIGHTEST: f64 = 0.02;
/// Relative tolerance within which a factor counts as a known one.
const FACTOR: f64 = 0.2;
/// Maximum squared residual of the equilibrium relative to the squared weight.
const UNBALANCED: f64 = 0.05;

struct Balance {
    matrices: Vec<DMatrix<f64>>,
    wrenches: Vec<DVector<f64>>,
    tensions: Vec<Vec<f64>>,
}

pub(super) fn check(
    readings: &Readings,
    expected: &Expected,
    robot: &Robot,
    found: &mut Vec<Suggestion>,
) {
    let columns = readings.of(Kind::Force);
    if columns.is_empty() || found.iter().any(|suggestion| suggestion.is_of(Kind::Force)) {
        return;
    }
    negative(&columns, found);
    if found.iter().any(|suggestion| suggestion.is_of(Kind::Force)) {
        return;
    }
    let Some(balance) = Balance::of(readings, expected, robot) else {
        return;
    };
    let one = balance.left(1.0, None);
    if one < UNBALANCED {
        return;
    }
    let factor = balance.factor();
    let unit = UNITS
        .iter()
        .find(|(known, _)| (factor / known - 1.0).abs() < FACTOR);
    if let Some((known, unit)) = unit
        && balance.left(*known, None) < 0.25 * one.min(1.0)
    {
        let stated_kg = robot.platform.mass_kg.unwrap_or_default();
        // Weight and forces are in balance for this mass as well, which a description may have guessed.
        let by_mass = (LIGHTEST..=1.0 / LIGHTEST).contains(known);
        let sentence = |forces: &str| {
            let said =
                format!("{forces} balance the weight of the platform only as {unit}, not newtons");
            match by_mass {
                true => format!(
                    "{said}, or its mass is {:.3} kg, not {stated_kg}: weigh it and correct mass_kg in robot.json if it was a guess",
                    stated_kg / factor
                ),
                false => said,
            }
        };
        let columns = columns.iter().map(|(quantity, _)| quantity.column());
        found.push(Suggestion {
            by_mass,
            ..Suggestion::multiply(columns.collect(), *known, sentence)
        });
        return;
    }
    let cables = robot.cable_count();
    let pairs = (0..cables).flat_map(|i| (0..i).map(move |j| (j, i)));
    let best = pairs
        .map(|pair| (balance.left(1.0, Some(pair)), pair))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((left, (i, j))) = best
        && left < 0.2 * one
    {
        let column = |index| {
            Quantity {
                kind: Kind::Force,
                index,
            }
            .column()
        };
        let (a, b) = (column(i), column(j));
        let sentence = format!(
            "{a} and {b} balance the weight of the platform only when swapped: their channels are swapped"
        );
        found.push(Suggestion::new(sentence, Change::Exchange { a, b }));
    }
}

/// Finds forces that are negative throughout: cables cannot push.
fn negative(columns: &[(Quantity, &[f64])], found: &mut Vec<Suggestion>) {
    let is_negative = |values: &[f64]| {
        let there = values.iter().filter(|value| !value.is_nan()).count();
        let below = values.iter().filter(|value| **value < 0.0).count();
        there >= FEWEST && below * 10 >= there * 9
    };
    let negative: Vec<String> = columns
        .iter()
        .filter(|(_, values)| is_negative(values))
        .map(|(quantity, _)| quantity.column())
        .collect();
    let groups = match negative.len() == columns.len() {
        true => vec![negative],
        false => negative.into_iter().map(|column| vec![column]).collect(),
    };
    for columns in groups {
        let sentence = format!(
            "{}: negative at nearly all poses, but cables cannot push: the sign is reversed",
            columns.join(", ")
        );
        found.push(Suggestion::new(sentence, Change::Reverse { columns }));
    }
}

impl Balance {
    /// Equilibrium at the poses with all data; `None` if they are too few, or the mass or a sensor is not stated.
    fn of(readings: &Readings, expected: &Expected, robot: &Robot) -> Option<Self> {
        if !robot.has_force_sensors() {
            return None;
        }
        let lever = robot
            .cables
            .iter()
            .map(|cable| {
                cable
                    .platform_anchor_m
                    .iter()
                    .map(|value| value * value)
                    .sum::<f64>()
                    .sqrt()
            })
            .fold(0.05, f64::max);
        let mut balance = Self {
            matrices: Vec::new(),
            wrenches: Vec::new(),
            tensions: Vec::new(),
        };
        for (row, pose) in expected.poses.iter().enumerate() {
            let Some(pose) = pose else { continue };
            let tension = |index: usize| -> Option<f64> {
                let reading = readings.columns.get(&Quantity {
                    kind: Kind::Force,
                    index,
                })?[row];
                let tension = robot.cables[index].force_sensor?.tension_n(reading);
                tension.is_finite().then_some(tension)
            };
            let Some(tensions) = (0..robot.cable_count())
                .map(tension)
                .collect::<Option<Vec<f64>>>()
            else {
                continue;
            };
            let (mut matrix, mut wrench) = (
                structure_matrix(robot, pose).ok()?.transpose(),
                applied_wrench(robot, pose).ok()?,
            );
            // Torques are converted to forces at the anchors, so that they have the same weight.
            for (k, coordinate) in robot.platform.freedom().coordinates().iter().enumerate() {
                if coordinate.index() >= 3 {
                    matrix.row_mut(k).scale_mut(1.0 / lever);
                    wrench[k] /= lever;
                }
            }
            balance.matrices.push(matrix);
            balance.wrenches.push(wrench);
            balance.tensions.push(tensions);
        }
        let weight: f64 = balance
            .wrenches
            .iter()
            .map(|wrench| wrench.norm_squared())
            .sum();
        (balance.tensions.len() >= FEWEST && weight > 0.0).then_some(balance)
    }

    /// Squared residual of the equilibrium, with tensions scaled by a factor and optionally two cables swapped.
    fn left(&self, factor: f64, exchanged: Option<(usize, usize)>) -> f64 {
        let mut left = 0.0;
        let mut weight = 0.0;
        for ((matrix, wrench), tensions) in
            self.matrices.iter().zip(&self.wrenches).zip(&self.tensions)
        {
            let mut tensions = DVector::from_column_slice(tensions);
            if let Some((i, j)) = exchanged {
                tensions.swap_rows(i, j);
            }
            left += (matrix * tensions * factor + wrench).norm_squared();
            weight += wrench.norm_squared();
        }
        left / weight
    }

    /// The factor on the tensions that best balances the weight.
    fn factor(&self) -> f64 {
        let (mut across, mut along) = (0.0, 0.0);
        for ((matrix, wrench), tensions) in
            self.matrices.iter().zip(&self.wrenches).zip(&self.tensions)
        {
            let pull = matrix * DVector::from_column_slice(tensions);
            across -= pull.dot(wrench);
            along += pull.norm_squared();
        }
        across / along
    }
}
