//! Sensitivities of the readings to the deviations of the parts: a tolerance matters only where they are large.

use super::budget::MOST_DIAGNOSED_ROWS;
use super::deviation_columns::linearised;
use super::fit::Fit;
use super::fitted_problem::problem_at_fitted_poses;
use crate::effect::{Effect, every_effect, measurements_as_modelled, part_deviations};
use crate::estimation::{EstimationError, LinearRow, ObservationKind, ParameterId, RowKind};
use crate::measurement::Dataset;
use crate::robot::{PartTolerances, StatedTolerances, Tolerance};

/// Sensitivity of the readings to the deviation of one part.
#[derive(Debug, Clone, Copy)]
pub struct DeviationSensitivity {
    /// The effect that describes the deviation.
    pub effect: &'static Effect,
    /// Index of the cable; `None` for a part of the whole robot.
    pub cable: Option<usize>,
    /// Largest change of a reading, in standard deviations of its noise, per unit of a parameter of the effect. The poses
    /// and tensions follow the deviation, the pulleys do not.
    pub largest: f64,
}

/// Sensitivities of the readings of a dataset to the deviations of all parts that can have a tolerance, with zeros for
/// those on which no reading depends. The values of the readings hardly matter, but where they were taken.
///
/// # Errors
/// If the readings cannot be used with the robot.
pub fn deviation_sensitivities(
    dataset: &Dataset,
) -> Result<Vec<DeviationSensitivity>, EstimationError> {
    let measurements = measurements_as_modelled(&dataset.robot, &dataset.measurements)?;
    let (measurements, _) = measurements.independent(&dataset.robot, MOST_DIAGNOSED_ROWS);
    let mut robot = dataset.robot.clone();
    robot.deviations.clear();
    let dataset = Dataset {
        robot,
        measurements: measurements.into_owned(),
    };
    let deviations = part_deviations(&dataset.robot, &units());
    let problem = problem_at_fitted_poses(&dataset)?;
    let fit = Fit::new(&problem, &[])?;
    let (linear, columns) = linearised(&fit.problem, &fit.solution, &deviations);
    let is_reading: Vec<bool> = linear.rows.iter().map(is_reading).collect();
    let mut sensitivities: Vec<DeviationSensitivity> = Vec::new();
    let of_deviations = linear.parameters.iter().filter_map(|p| match p.id {
        ParameterId::Deviation { deviation, .. } => Some(&deviations[deviation].bound),
        _ => None,
    });
    for (bound, column) in of_deviations.zip(columns.column_iter()) {
        let of_readings = column.iter().zip(&is_reading);
        let changes = of_readings.filter_map(|(change, is_reading)| is_reading.then_some(change));
        let largest = changes.fold(0.0_f64, |most, change| most.max(change.abs()));
        let cable = bound.targeted.then(|| bound.cables[0]);
        let is_known = |other: &&mut DeviationSensitivity| {
            other.effect.id() == bound.effect.id() && other.cable == cable
        };
        match sensitivities.iter_mut().find(is_known) {
            Some(other) => other.largest = other.largest.max(largest),
            None => sensitivities.push(DeviationSensitivity {
                effect: bound.effect,
                cable,
                largest,
            }),
        }
    }
    Ok(sensitivities)
}

/// A tolerance of one unit for every effect.
fn units() -> PartTolerances {
    let effects = every_effect().filter(|effect| effect.has_tolerance());
    PartTolerances::Stated(StatedTolerances {
        factor: 1.0,
        effects: effects
            .map(|effect| (effect.id().to_owned(), Tolerance::Same(1.0)))
            .collect(),
    })
}

fn is_reading(row: &LinearRow) -> bool {
    match row.kind {
        RowKind::Observation(ObservationKind::Equilibrium(_))
        | RowKind::AssumedTension(_)
        | RowKind::Prior(_) => false,
        RowKind::Observation(_) => true,
    }
}
