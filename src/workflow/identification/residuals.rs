//! Residuals of readings as every screen and every document shows them: prediction minus reading.

use tautline_core::diagnosis::Quantity;
use tautline_core::estimation::{Analysis, ObservationKind};
use tautline_core::robot::Robot;

/// What the axis of a plot of residuals says.
pub const RESIDUAL: &str = "Prediction minus reading";

/// The residual of a reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadingResidual {
    /// Row of the measurements.
    pub row: usize,
    /// Prediction minus reading (SI unit of the reading).
    pub value: f64,
    /// The same in standard deviations: of the residual, or of the sensor for tensions, whose residuals are those of all
    /// other readings. `None` where the reading is hardly controlled by others.
    pub deviations: Option<f64>,
}

/// Kind and cable of a reading; none for the balance of forces, which no sensor reads.
#[must_use]
pub fn group_of(kind: ObservationKind) -> Option<(Quantity, Option<usize>)> {
    Some(match kind {
        ObservationKind::Length(cable) => (Quantity::Length, Some(cable)),
        ObservationKind::Swivel(cable) => (Quantity::Swivel, Some(cable)),
        ObservationKind::Laser => (Quantity::Laser, None),
        ObservationKind::TrackerPosition(_) => (Quantity::TrackerPosition, None),
        ObservationKind::TrackerOrientation(_) => (Quantity::TrackerOrientation, None),
        ObservationKind::Inclination(_) => (Quantity::Inclination, None),
        ObservationKind::Equilibrium(_) => return None,
    })
}

/// The residuals of all readings of a kind, of one cable where they belong to cables, in the order of the rows.
#[must_use]
pub fn reading_residuals(
    robot: &Robot,
    analysis: &Analysis,
    quantity: Quantity,
    cable: Option<usize>,
) -> Vec<ReadingResidual> {
    if quantity == Quantity::Tension {
        let errors = analysis.tension_errors_n.iter();
        return errors
            .filter(|(_, of, _)| Some(*of) == cable)
            .filter_map(|(row, of, error)| {
                let sensor = robot.cables.get(*of)?.force_sensor?;
                // An error is what the sensor reads less the tension that is predicted.
                Some(ReadingResidual {
                    row: *row,
                    value: -error,
                    deviations: Some(-error / sensor.tension_sd_n),
                })
            })
            .collect();
    }
    let readings = analysis.observations.iter();
    readings
        .filter(|reading| group_of(reading.kind) == Some((quantity, cable)))
        .map(|reading| ReadingResidual {
            row: reading.row,
            value: reading.residual(),
            deviations: reading.normalised(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use tautline_core::estimation::{Control, Method};
    use tautline_core::measurement::Dataset;
    use tautline_core::robot::presets;
    use tautline_core::simulation::{SimulationOptions, simulate};

    use super::*;
    use crate::identification::{Identification, IdentificationRequest, identify};

    fn fit(dataset: Dataset) -> Identification {
        let request = IdentificationRequest::new(dataset, Method::Joint, &[]);
        let request = request.expect("a request");
        identify(&request, &mut |_| Control::Continue).expect("identified")
    }

    fn residual(fit: &Identification, quantity: Quantity, cable: Option<usize>, row: usize) -> f64 {
        let all = reading_residuals(&fit.dataset.robot, &fit.analysis, quantity, cable);
        let own = all.iter().find(|one| one.row == row).expect("it was read");
        let deviations = own.deviations.expect("it is controlled");
        assert_eq!(own.value > 0.0, deviations > 0.0, "one sign in both units");
        deviations
    }

    /// A reading that is too large makes the prediction less than the reading, whatever is read.
    #[test]
    fn a_reading_that_is_too_large_has_a_residual_below_zero_for_every_kind() {
        let mut kinds = 0;
        for name in presets::NAMES {
            let preset = presets::find(name).expect("a preset");
            let options = SimulationOptions {
                workspace: Some(preset.workspace),
                tension: Some(preset.tension),
                noise: false,
                ..SimulationOptions::new(20, 3)
            };
            let run = simulate(&preset.robot, &options).expect("measurements");
            let row = 8;
            for quantity in Quantity::ALL {
                let mut wrong = run.dataset.clone();
                let data = &mut wrong.measurements;
                // Far beyond the noise.
                let cable = match quantity {
                    Quantity::Length if !data.revolutions.is_empty() => {
                        let winch = preset.robot.cables[1].winch;
                        let circumference = std::f64::consts::PI * winch.drum_diameter_m;
                        let turns = 0.05 * winch.gear_ratio / circumference;
                        add(&mut data.revolutions, (row, 1), turns);
                        Some(1)
                    }
                    Quantity::Length => {
                        add(&mut data.length_m, (row, 1), 0.05);
                        Some(1)
                    }
                    Quantity::Tension if !data.force_n.is_empty() => {
                        add(&mut data.force_n, (row, 1), 200.0);
                        Some(1)
                    }
                    Quantity::Swivel if !data.swivel_rad.is_empty() => {
                        add(&mut data.swivel_rad, (row, 1), 0.3);
                        Some(1)
                    }
                    Quantity::Laser if !data.laser_m.is_empty() => {
                        data.laser_m[row] += 0.05;
                        None
                    }
                    Quantity::TrackerPosition if !data.tracked_position_m.is_empty() => {
                        data.tracked_position_m[row][0] += 0.05;
                        None
                    }
                    Quantity::Inclination if !data.inclination_rad.is_empty() => {
                        data.inclination_rad[row][0] += 0.2;
                        None
                    }
                    _ => continue,
                };
                kinds += 1;
                let residual = residual(&fit(wrong), quantity, cable, row);
                assert!(residual < -2.0, "{name}, {quantity:?}: {residual}");
            }
        }
        assert!(kinds >= 9, "{kinds} kinds of readings of all robots");
    }

    fn add(grid: &mut tautline_core::measurement::Grid, (row, column): (usize, usize), by: f64) {
        let mut changed = tautline_core::measurement::Grid::new(grid.columns());
        for k in 0..grid.rows() {
            let mut values = grid.row(k).to_vec();
            if k == row {
                values[column] += by;
            }
            changed.push_row(&values);
        }
        *grid = changed;
    }
}
