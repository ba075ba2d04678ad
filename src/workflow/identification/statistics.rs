//! The statistics of an identification as tables of observations and of unknown parameters, as in JAG3D. Each column is
//! defined once, for files and for the window.

use tautline_core::diagnosis::Quantity;
use tautline_core::estimation::{DetectionTest, Observation, Parameter, ParameterId};
use tautline_core::geometry::Coordinate;
use tautline_core::statistics::normal_quantile;

use super::{Identification, all_readings, group_of, reading_name};
use crate::exporting::Table;
use crate::wording::sentence;
use crate::wording::units::{decimals, display_unit, fixed, signed, significant, unit_of};

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
    /// Name of the cable of that entry point.
    pub moves: Option<String>,
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

/// A cell of a table: in SI units for files, and as the window shows it.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A text in files and one in the window.
    Text([String; 2]),
    /// A number, if it is known: in SI units, in the unit shown, and in words.
    Number([Option<f64>; 2], String),
}

/// Name in files, heading in the window, and meaning of the columns of readings; empty where files or the window lack one.
pub const READINGS: [[&str; 3]; 11] = [
    ["pose", "Pose", "Number of the pose"],
    ["reading", "Reading", "What was read"],
    [
        "unit",
        "Unit",
        "Unit of the residual, the standard deviation and the smallest detectable error",
    ],
    ["residual", "Residual", "Prediction minus reading"],
    [
        "sd",
        "Sd",
        "Standard deviation of the reading, as described",
    ],
    [
        "redundancy",
        "Redundancy",
        "Share of an error of this reading that shows in its residual: 0 is not checked by any other reading, 1 completely",
    ],
    [
        "normalised_residual",
        "Standardised",
        "Residual in its own standard deviations: beyond 3 in 3 of 1000 readings if model and noise are right",
    ],
    [
        "smallest_detectable_error",
        "Detectable",
        "Smallest error of this reading that the test for suspicious readings finds with 80 % probability",
    ],
    [
        "influence_m",
        "Influence mm",
        "How far an error of that size moves the pulley that it moves most",
    ],
    [
        "moves",
        "On pulley",
        "The pulley that such an error moves most",
    ],
    ["suspect", "", ""],
];

/// The same of the columns of values.
pub const VALUES: [[&str; 3]; 10] = [
    ["parameter", "Value", "What was identified"],
    ["unit", "Unit", "Unit of all numbers of the row"],
    [
        "nominal",
        "Nominal",
        "As the description of the robot has it",
    ],
    ["value", "Identified", "As identified"],
    ["", "Difference", "Identified minus nominal"],
    ["sd", "Sd", "Standard deviation of the identified value"],
    [
        "prior_sd",
        "Prior sd",
        "Standard deviation before anything was measured",
    ],
    ["from_95", "", ""],
    ["to_95", "", ""],
    [
        "",
        "95 % interval",
        "The true value lies in it with 95 % probability, if the model explains the data",
    ],
];

fn text(in_files: &str, in_window: impl Into<String>) -> Cell {
    Cell::Text([in_files.to_owned(), in_window.into()])
}

/// A number in SI units, shown in a unit `factor` times smaller.
fn number(si: impl Into<Option<f64>>, factor: f64, form: impl FnOnce(f64) -> String) -> Cell {
    let si = si.into();
    let shown = si.map(|si| factor * si).filter(|v| v.is_finite());
    let text = shown.map_or_else(|| "\u{2013}".to_owned(), form);
    Cell::Number([si, shown], text.replace('-', "\u{2212}"))
}

impl ReadingStatistics {
    /// The cells of [`READINGS`].
    #[must_use]
    pub fn cells(&self) -> [Cell; READINGS.len()] {
        let (factor, unit) = display_unit(self.unit);
        let sd = factor * self.sd;
        let digits = if sd > 0.0 { decimals(sd) + 1 } else { 3 };
        let moves = self.moves.as_deref().unwrap_or_default();
        [
            number(self.pose as f64, 1.0, |v| fixed(v, 0)),
            text(&self.name, sentence(&self.name)),
            text(self.unit, unit),
            number(self.residual, factor, |v| signed(v, digits)),
            number(self.sd, factor, |v| significant(v, 3)),
            number(self.redundancy, 1.0, |v| fixed(v, 3)),
            number(self.normalised, 1.0, |v| signed(v, 2)),
            number(self.smallest_error, factor, |v| fixed(v, digits)),
            number(self.influence_m, 1e3, |v| fixed(v, 2)),
            text(moves, moves),
            text(if self.is_suspect { "yes" } else { "" }, ""),
        ]
    }
}

impl ValueStatistics {
    /// The cells of [`VALUES`].
    #[must_use]
    pub fn cells(&self) -> [Cell; VALUES.len()] {
        let (factor, unit) = display_unit(self.unit);
        let sd = self.sd.filter(|sd| *sd > 0.0);
        let digits = sd.map_or(3, |sd| decimals(factor * sd).min(6));
        let in_unit = |si: Option<f64>| number(si, factor, |v| fixed(v, digits));
        let difference = self.nominal.map(|nominal| self.value - nominal);
        let [from, to] = [0, 1].map(|end| in_unit(self.interval.map(|ends| ends[end])));
        let interval = match (&from, &to) {
            (Cell::Number([_, Some(_)], from), Cell::Number(_, to)) => format!("{from} to {to}"),
            _ => "\u{2013}".to_owned(),
        };
        [
            text(&self.name, sentence(&self.name)),
            text(self.unit, unit),
            in_unit(self.nominal),
            in_unit(Some(self.value)),
            number(difference, factor, |v| signed(v, digits)),
            in_unit(self.sd),
            number(self.prior_sd, factor, |v| significant(v, 3)),
            from,
            to,
            text("", interval),
        ]
    }
}

/// SI unit of a kind of reading.
#[must_use]
pub fn unit_of_reading(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Length | Quantity::Laser | Quantity::TrackerPosition | Quantity::Distance => "m",
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
    let cables = &fit.dataset.robot.cables;
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
        moves: reading
            .pull
            .and_then(|pull| Some(cables.get(pull.cable)?.name.clone())),
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
    let all = reading_statistics(fit);
    let rows: Vec<_> = all.iter().map(ReadingStatistics::cells).collect();
    table("readings", &READINGS, &rows)
}

/// The statistics of values as a table in SI units.
#[must_use]
pub fn values_table(fit: &Identification) -> Table {
    let all = value_statistics(fit);
    let rows: Vec<_> = all.iter().map(ValueStatistics::cells).collect();
    table("values", &VALUES, &rows)
}

fn table<const N: usize>(
    name: &'static str,
    columns: &[[&str; 3]; N],
    rows: &[[Cell; N]],
) -> Table {
    let columns = columns.iter().map(|[name, ..]| *name).enumerate();
    let columns = columns.filter(|(_, name)| !name.is_empty());
    columns.fold(Table::new(name), |table, (place, name)| {
        let text = |row: &[Cell; N]| match &row[place] {
            Cell::Text([text, _]) => Some(text.clone()),
            Cell::Number(..) => None,
        };
        let number = |row: &[Cell; N]| match row[place] {
            Cell::Number([si, _], _) => si,
            Cell::Text(_) => None,
        };
        match rows.iter().map(text).collect::<Option<Vec<String>>>() {
            Some(texts) => table.texts(name, texts.into_iter()),
            None => table.known(name, rows.iter().map(number)),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::samples::identified;

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
