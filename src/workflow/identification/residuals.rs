//! Residuals of readings as shown on every screen and in every document: prediction minus reading, see
//! [`tautline_core::estimation::Observation`].

use tautline_core::diagnosis::Quantity;
use tautline_core::estimation::{Analysis, Observation, ObservationKind};

/// Axis label of plots of residuals.
pub const RESIDUAL: &str = "Prediction minus reading";

/// Quantity and cable of a reading; `None` for the equilibrium of forces, which no sensor reads.
#[must_use]
pub fn group_of(kind: ObservationKind) -> Option<(Quantity, Option<usize>)> {
    Some((Quantity::of(kind)?, kind.cable()))
}

/// All readings, without the equations of equilibrium, which no sensor reads.
pub fn all_readings(analysis: &Analysis) -> impl Iterator<Item = &Observation> {
    let readings = analysis.observations.iter();
    readings.filter(|reading| group_of(reading.kind).is_some())
}

/// The readings of a quantity, of one cable if they belong to cables, in the order of the rows.
pub fn readings_of(
    analysis: &Analysis,
    quantity: Quantity,
    cable: Option<usize>,
) -> impl Iterator<Item = &Observation> {
    let readings = analysis.observations.iter();
    readings.filter(move |reading| group_of(reading.kind) == Some((quantity, cable)))
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
        let mut all = readings_of(&fit.analysis, quantity, cable);
        let own = all.find(|one| one.row == row).expect("it was read");
        let deviations = own.normalised().expect("it is controlled");
        assert_eq!(
            own.residual() > 0.0,
            deviations > 0.0,
            "one sign in both units"
        );
        deviations
    }

    /// A reading that is too large exceeds the prediction, for every kind of reading.
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
