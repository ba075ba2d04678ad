//! The statistics of an identification as tables of observations and of unknown parameters, as in
//! JAG3D.

use tautline_core::diagnosis::Quantity;
use tautline_core::estimation::{DetectionTest, Observation, Parameter, ParameterId};
use tautline_core::geometry::Coordinate;
use tautline_core::statistics::normal_quantile;

use super::{Identification, all_readings, group_of, reading_name};
use crate::exporting::Table;
use crate::wording::units::unit_of;

/// Confidence level of the intervals.
pub const CONFIDENCE: f64 = 0.95;

/// A reading with its residual and its reliability (SI units).
#[derive(Debug, Clone, PartialEq)]
pub struct ReadingStatistics {
    /// Label of the pose.
    pub pose: i64,
    /// Kind of reading.
    pub quantity: Quantity,
    /// Cable of the reading, if it has one.
    pub cable: Option<usize>,
    /// Name of the reading: `length of cable-3`.
    pub name: String,
    /// SI unit.
    pub unit: &'static str,
    /// Prediction minus reading.
    pub residual: f64,
    /// Standard deviation of the reading.
    pub sd: f64,
    /// Redundancy: share of an error of the reading that shows in its residual.
    pub redundancy: Option<f64>,
    /// Normalised residual: the residual in its own standard deviations.
    pub normalised: Option<f64>,
    /// Smallest detectable error: internal reliability.
    pub smallest_error: Option<f64>,
    /// Displacement by that error of the entry point it moves most (m): external reliability.
    pub influence_m: Option<f64>,
    /// Cable of that entry point.
    pub moves: Option<usize>,
    /// Whether the reading fails the test.
    pub is_suspect: bool,
}

/// An estimated value (SI units).
#[derive(Debug, Clone, PartialEq)]
pub struct ValueStatistics {
    /// Name of the parameter: `cable-3 entry point x`.
    pub name: String,
    /// Cable of the parameter, if it is a coordinate of a pulley.
    pub cable: Option<usize>,
    /// SI unit; empty for coefficients.
    pub unit: &'static str,
    /// Nominal value according to the description.
    pub nominal: Option<f64>,
    /// Identified value.
    pub value: f64,
    /// Standard deviation of the value; `None` if the data do not determine it.
    pub sd: Option<f64>,
    /// Prior standard deviation.
    pub prior_sd: Option<f64>,
    /// Confidence interval at the level [`CONFIDENCE`].
    pub interval: Option<[f64; 2]>,
}

/// SI unit of a kind of reading.
#[must_use]
pub fn unit_of_reading(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Length | Quantity::Laser | Quantity::TrackerPosition => "m",
        Quantity::Tension => "N",
        Quantity::Swivel | Quantity::Inclination | Quantity::TrackerOrientation => "rad",
    }
}

/// The statistics of all readings, in the order of the poses, by the test that finds suspect readings.
#[must_use]
pub fn reading_statistics(fit: &Identification) -> Vec<ReadingStatistics> {
    let test = fit.analysis.test();
    all_readings(&fit.analysis)
        .filter_map(|reading| of_reading(fit, reading, test))
        .collect()
}

fn of_reading(
    fit: &Identification,
    reading: &Observation,
    test: DetectionTest,
) -> Option<ReadingStatistics> {
    let (quantity, cable) = group_of(reading.kind)?;
    let reliability = reading.reliability(test);
    let is_same = |one: &Observation| (one.row, one.kind) == (reading.row, reading.kind);
    Some(ReadingStatistics {
        pose: *fit.dataset.measurements.labels.get(reading.row)?,
        quantity,
        cable,
        name: reading_name(&fit.dataset.robot, reading.kind),
        unit: unit_of_reading(quantity),
        residual: reading.residual(),
        sd: reading.sd,
        redundancy: reading.redundancy,
        normalised: reading.normalised(),
        smallest_error: reliability.map(|r| r.smallest_error),
        influence_m: reliability.map(|r| r.influence_m),
        moves: reading.pull.map(|pull| pull.cable),
        is_suspect: fit.analysis.suspects().iter().any(is_same),
    })
}

/// The statistics of all estimated values, in the order of the solution.
#[must_use]
pub fn value_statistics(fit: &Identification) -> Vec<ValueStatistics> {
    let half = normal_quantile(0.5 + 0.5 * CONFIDENCE);
    let parameters = fit.solution.parameters.iter().enumerate();
    parameters
        .filter_map(|(index, parameter)| {
            let (nominal, value) = nominal_and_value(fit, parameter)?;
            let sd = fit.solution.standard_deviation(index);
            Some(ValueStatistics {
                name: parameter.name.clone(),
                cable: match parameter.id {
                    ParameterId::EntryPoint { cable, .. } => Some(cable),
                    _ => None,
                },
                unit: unit_of_value(fit, parameter),
                nominal,
                value,
                sd,
                prior_sd: parameter.prior_sd,
                interval: sd.map(|sd| [value - half * sd, value + half * sd]),
            })
        })
        .collect()
}

/// Nominal and identified value of a parameter (SI units); the nominal one only if it is a single number.
#[must_use]
pub fn nominal_and_value(
    fit: &Identification,
    parameter: &Parameter,
) -> Option<(Option<f64>, f64)> {
    let globals = &fit.solution.globals;
    let robot = &fit.dataset.robot;
    match parameter.id {
        ParameterId::EntryPoint { cable, axis } => {
            let nominal = robot.cables.get(cable)?.pulley.entry_point_m[axis];
            Some((Some(nominal), globals.entry_points.get(cable)?[axis]))
        }
        ParameterId::PlaneOffset => {
            let nominal = robot.laser.map(|laser| laser.target_plane.offset_m);
            Some((nominal, globals.plane_offset_m))
        }
        ParameterId::Home(coordinate) => {
            let nominal = robot.home.as_ref()?.pose();
            let k = coordinate.index();
            let is_position = matches!(coordinate, Coordinate::X | Coordinate::Y | Coordinate::Z);
            if is_position {
                Some((Some(nominal.position[k]), globals.home.position[k]))
            } else {
                Some((Some(0.0), globals.home.difference(&nominal)[k]))
            }
        }
        ParameterId::HomeTension { cable } => {
            Some((Some(0.0), *globals.home_tension_error_n.get(cable)?))
        }
        ParameterId::Effect { effect, parameter } => {
            let bound = fit.free_effects().get(effect)?;
            let neutral = bound.effect.parameters().get(parameter)?.neutral;
            Some((Some(neutral), *bound.values.get(parameter)?))
        }
        ParameterId::Deviation {
            deviation,
            parameter,
        } => {
            // Estimated deviations replace those that a model states.
            let bound = globals.deviations.get(deviation)?;
            let neutral = bound.effect.parameters().get(parameter)?.neutral;
            Some((Some(neutral), *bound.values.get(parameter)?))
        }
    }
}

/// SI unit of a parameter; empty for coefficients.
#[must_use]
pub fn unit_of_value(fit: &Identification, parameter: &Parameter) -> &'static str {
    let name = match parameter.id {
        ParameterId::Effect { effect, parameter } => {
            let bound = fit.free_effects().get(effect);
            let all = bound.map(|bound| bound.effect.parameters());
            all.and_then(|all| all.get(parameter)).map(|p| p.name)
        }
        ParameterId::Deviation {
            deviation,
            parameter,
        } => {
            let bound = fit.solution.globals.deviations.get(deviation);
            let all = bound.map(|bound| bound.effect.parameters());
            all.and_then(|all| all.get(parameter)).map(|p| p.name)
        }
        _ => None,
    };
    unit_of(name.unwrap_or_default(), parameter.unit)
}

/// The statistics of readings as a table in SI units.
#[must_use]
pub fn readings_table(fit: &Identification) -> Table {
    let cables = &fit.dataset.robot.cables;
    let all = reading_statistics(fit);
    let moves = |one: &ReadingStatistics| Some(cables.get(one.moves?)?.name.clone());
    let suspect = |one: &ReadingStatistics| if one.is_suspect { "yes" } else { "" }.to_owned();
    let all = || all.iter();
    Table::new("readings")
        .numbers("pose", all().map(|one| one.pose as f64))
        .texts("reading", all().map(|one| one.name.clone()))
        .texts("unit", all().map(|one| one.unit.to_owned()))
        .numbers("residual", all().map(|one| one.residual))
        .numbers("sd", all().map(|one| one.sd))
        .known("redundancy", all().map(|one| one.redundancy))
        .known("normalised_residual", all().map(|one| one.normalised))
        .known(
            "smallest_detectable_error",
            all().map(|one| one.smallest_error),
        )
        .known("influence_m", all().map(|one| one.influence_m))
        .texts("moves", all().map(|one| moves(one).unwrap_or_default()))
        .texts("suspect", all().map(suspect))
}

/// The statistics of values as a table in SI units.
#[must_use]
pub fn values_table(fit: &Identification) -> Table {
    let all = value_statistics(fit);
    let all = || all.iter();
    let end = |end: usize| all().map(move |one| one.interval.map(|ends| ends[end]));
    Table::new("values")
        .texts("parameter", all().map(|one| one.name.clone()))
        .texts("unit", all().map(|one| one.unit.to_owned()))
        .known("nominal", all().map(|one| one.nominal))
        .numbers("value", all().map(|one| one.value))
        .known("sd", all().map(|one| one.sd))
        .known("prior_sd", all().map(|one| one.prior_sd))
        .known("from_95", end(0))
        .known("to_95", end(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::documents::diagnosis::samples::identified;

    #[test]
    fn every_reading_and_every_value_has_a_line() {
        let fit = identified();
        let readings = reading_statistics(&fit);
        assert_eq!(readings.len(), all_readings(&fit.analysis).count());
        assert!(readings.len() > 80);
        for one in &readings {
            let (redundancy, smallest) = (one.redundancy, one.smallest_error);
            let [redundancy, smallest] = [redundancy, smallest].map(|v| v.expect("determined"));
            assert!((0.0..=1.0).contains(&redundancy), "{one:?}");
            // Four standard deviations are found at once; less redundancy needs more.
            assert!(smallest > 4.0 * one.sd, "{one:?}");
            assert!(one.influence_m.is_some_and(|by| by > 0.0) && one.moves.is_some());
        }
        let values = value_statistics(&fit);
        assert_eq!(values.len(), fit.solution.parameters.len());
        for one in &values {
            let [from, to] = one.interval.expect("determined");
            assert!(from < one.value && one.value < to);
            assert!(((to - from) / one.sd.expect("determined") - 3.92).abs() < 1e-3);
        }
    }

    #[test]
    fn tables_have_a_row_each_and_as_many_cells_as_headings() {
        let fit = identified();
        for (text, rows) in [
            (readings_table(&fit).csv(), reading_statistics(&fit).len()),
            (values_table(&fit).csv(), value_statistics(&fit).len()),
        ] {
            let mut lines = text.lines();
            let heads = lines.next().expect("headings").split(',').count();
            assert_eq!(text.lines().count(), 1 + rows);
            // A name with a comma stands in quotes.
            let plain = lines.filter(|line| !line.contains('"'));
            assert!(plain.clone().count() > 5);
            for line in plain {
                assert_eq!(line.split(',').count(), heads, "{line}");
            }
        }
    }
}
