//! Checks of formulas at made-up readings: neutral values change nothing, every parameter has an effect, and waves are
//! periodic.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::super::{CableContext, CablePort, Dual, PlatformContext, RowContexts, Scope, Search};
use super::fault::Fault;
use super::formula::{Circumstances, Program};
use super::{Formulas, ParameterDefinition};
use crate::geometry::Twist;

/// Number of rows of readings that are tried, and least number of cables at each.
const ROWS: usize = 12;
const CABLES: usize = 4;
/// Largest relative deviation that rounding can cause.
const ROUNDING: f64 = 1e-9;

/// Readings that nobody took.
pub(super) struct SampleRow {
    cables: Vec<CableContext>,
    platform: PlatformContext,
}

/// A value between two bounds that looks random but is always the same.
fn between(low: f64, high: f64, seed: usize) -> f64 {
    let fraction = (12.9898 * seed as f64 + 0.7).sin() * 43758.5453;
    low + (high - low) * (fraction - fraction.floor())
}

impl SampleRow {
    /// The row with an index, with at least this number of cables.
    pub fn new(row: usize, cables: usize) -> Self {
        let seed = 1000 * row;
        let vector =
            |k: usize, size: f64| [0, 1, 2].map(|i| between(-size, size, seed + 10 * k + i));
        let time_s = between(100.0, 9000.0, seed);
        let temperature_change_k = between(-8.0, 8.0, seed + 1);
        let label = 10 + row as i64;
        let cable = |index: usize| {
            let seed = seed + 100 * (index + 1);
            let value = |k: usize, low: f64, high: f64| between(low, high, seed + k);
            CableContext {
                is_home: false,
                label,
                time_s,
                temperature_change_k,
                revolutions: value(0, -9.0, 9.0),
                drum_per_motor: 0.3,
                direction: if value(1, -1.0, 1.0) < 0.0 { -1.0 } else { 1.0 },
                paid_rates: [value(2, -0.5, 0.5), value(3, -0.5, 0.5)],
                tension_rates: [value(4, -50.0, 50.0), value(5, -50.0, 50.0)],
                tension_n: value(6, 10.0, 200.0),
                mean_tension_n: value(7, 50.0, 100.0),
                tension_gain: value(8, 0.5, 3.0),
                wrap_rad: value(9, 0.2, 2.5),
                pull_horizontal: [10, 11, 12].map(|k| value(k, -0.6, 0.6)),
                entry_point_m: [13, 14, 15].map(|k| value(k, -4.0, 4.0)),
                swivel_axis: [0.0, 0.0, -1.0],
                paid_m: value(16, -2.0, 2.0),
                length_m: value(17, 0.5, 6.0),
                swivel_rad: value(18, -1.5, 1.5),
                radius_m: 0.03,
            }
        };
        let velocity = vector(5, 0.5);
        Self {
            cables: (0..cables.max(CABLES)).map(cable).collect(),
            platform: PlatformContext {
                is_home: false,
                row,
                label,
                time_s,
                temperature_change_k,
                laser_m: between(0.2, 3.0, seed + 2),
                laser_rates: [between(-0.5, 0.5, seed + 3), between(-0.5, 0.5, seed + 4)],
                twists: [
                    Twist::new(velocity[0], velocity[1], velocity[2], 0.1, -0.2, 0.05),
                    Twist::zeros(),
                ],
                inertia: Twist::zeros(),
                inclination_rad: vector(1, 0.4),
                tracked_m: vector(2, 2.0),
                tracked_rotation: [[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]],
                laser_direction: [0.0, 0.0, -1.0],
                target_normal: [0.0, 0.0, 1.0],
                position_m: vector(3, 2.0),
                rotation_rad: vector(4, 0.4),
            },
        }
    }

    pub fn contexts(&self) -> RowContexts<'_> {
        RowContexts {
            cables: &self.cables,
            platform: &self.platform,
        }
    }
}

/// A hypothesis at made-up readings.
struct Trial<'t> {
    formulas: &'t Formulas,
    parameters: &'t [(usize, &'t ParameterDefinition)],
    search: Search,
    rows: Vec<SampleRow>,
}

/// Checks the formulas of a hypothesis with these parameters and the places of their names.
pub(super) fn formulas(
    formulas: &Formulas,
    parameters: &[(usize, &ParameterDefinition)],
    (scope, search): (Scope, Search),
) -> Result<(), Fault> {
    let sizes = parameters.iter().filter(|(_, p)| !p.values.discrete);
    let Some((first, _)) = sizes.copied().next() else {
        let message =
            "found no parameter with a size, expected [parameters.NAME] with unit and typical";
        return Err(Fault::new(0, message));
    };
    let trial = Trial {
        formulas,
        parameters,
        search,
        rows: (0..ROWS)
            .map(|row| SampleRow::new(row, formulas.highest_cable()))
            .collect(),
    };
    trial.check_neutral(first)?;
    trial.check_slopes()?;
    if let Search::Wave { phase, period } = search {
        trial.check_wave(phase, period, scope)?;
    }
    Ok(())
}

impl Trial<'_> {
    /// Values at which the effect is neutral; the poses of events are all poses.
    fn neutral(&self) -> Vec<f64> {
        let of = |(k, (_, p)): (usize, &(usize, &ParameterDefinition))| match self.search {
            Search::Wave { phase, period } if k == phase || Some(k) == period => {
                0.4 * p.values.typical[0] + 0.6 * p.values.typical[1]
            }
            _ if p.values.discrete => f64::NAN,
            _ => p.values.neutral,
        };
        self.parameters.iter().enumerate().map(of).collect()
    }

    /// Every formula at every row, with these values and one as the variable; without a finite value: `None`.
    fn results(&self, values: &[f64], variable: Option<usize>) -> Vec<(Dual, Option<Dual>)> {
        let seed = |(k, value): (usize, &f64)| match Some(k) == variable {
            true => Dual::variable(*value),
            false => Dual::constant(*value),
        };
        let values: Vec<Dual> = values.iter().enumerate().map(seed).collect();
        let mut results = Vec::new();
        for (row, sample) in self.rows.iter().enumerate() {
            let RowContexts { cables, platform } = sample.contexts();
            let mut evaluate = |program: &Program, cable: Option<usize>, own: Dual| {
                let at = Circumstances {
                    cables,
                    platform,
                    cable,
                    targets: &[row % CABLES, (row + 1) % CABLES],
                };
                results.push((own, program.evaluate(&values, own, &at)));
            };
            let made_up = |seed: usize| Dual::constant(between(0.5, 2.0, 7 * row + seed));
            for (seed, (port, program)) in self.formulas.cable.iter().enumerate() {
                // Where it was read, too, the value is about what was read: a formula may compare the two.
                let own = match port {
                    CablePort::Paid => Dual::constant(cables[row % CABLES].paid_m),
                    CablePort::Tension => Dual::constant(cables[row % CABLES].tension_n),
                    _ => made_up(seed),
                };
                evaluate(program, Some(row % CABLES), own);
            }
            for (seed, (_, program)) in self.formulas.platform.iter().enumerate() {
                evaluate(program, None, made_up(seed));
            }
        }
        results
    }

    fn check_neutral(&self, first: usize) -> Result<(), Fault> {
        for (own, result) in self.results(&self.neutral(), None) {
            let Some(result) = result else { continue };
            if (result.value - own.value).abs() > ROUNDING * own.value.abs() {
                let message = "found a formula that changes its quantity although all parameters are neutral; expected it unchanged then";
                return Err(Fault::new(first, message));
            }
        }
        Ok(())
    }

    /// Slopes by a parameter at every result; 0 without a finite value.
    fn slopes(&self, values: &[f64], parameter: usize) -> Vec<f64> {
        let results = self.results(values, Some(parameter)).into_iter();
        results
            .map(|(_, result)| result.map_or(0.0, |result| result.slope))
            .collect()
    }

    fn check_slopes(&self) -> Result<(), Fault> {
        let mut values = self.neutral();
        for ((value, (_, p)), k) in values.iter_mut().zip(self.parameters).zip(0..) {
            let is_of_wave = matches!(self.search, Search::Wave { phase, period } if k == phase || Some(k) == period);
            if !p.values.discrete && !is_of_wave {
                *value = p.values.start;
            }
        }
        for (k, (at, p)) in self.parameters.iter().enumerate() {
            let is_of_wave = matches!(self.search, Search::Wave { phase, period } if k == phase || Some(k) == period);
            let is_searched = !p.values.discrete && !is_of_wave;
            if is_searched && self.slopes(&values, k).iter().all(|slope| *slope == 0.0) {
                let message = format!(
                    "found nothing that changes with \"{}\" at its start value {}, expected start = NUMBER where something does",
                    p.name, p.values.start
                );
                return Err(Fault::new(*at, message));
            }
        }
        Ok(())
    }

    /// The search adds a sine and a cosine, so the slope by the amplitude must be a sum of both.
    fn check_wave(&self, phase: usize, period: Option<usize>, scope: Scope) -> Result<(), Fault> {
        let amplitude = (0..self.parameters.len()).find(|k| *k != phase && Some(*k) != period);
        let amplitude = amplitude.unwrap_or_default();
        let (at, definition) = self.parameters[phase];
        let mut is_wave = self.parameters[amplitude].1.values.neutral == 0.0;
        let slopes = |angle: f64, of_period: Option<f64>| {
            let mut values = self.neutral();
            values[phase] = angle;
            if let (Some(index), Some(value)) = (period, of_period) {
                values[index] = value;
            }
            self.slopes(&values, amplitude)
        };
        let angle = 0.8;
        let is_near = |found: f64, expected: f64| {
            (found - expected).abs() <= ROUNDING * (1.0 + expected.abs())
        };
        if let Some(index) = period {
            let [low, high] = self.parameters[index].1.values.typical;
            let period = 0.5 * (low + high);
            let crest = slopes(FRAC_PI_2, Some(f64::INFINITY));
            let per_row = crest.len() / ROWS;
            is_wave &= scope == Scope::Robot && self.formulas.cable.is_empty();
            for (k, found) in slopes(angle, Some(period)).into_iter().enumerate() {
                let distance = self.rows[k / per_row].platform.laser_m;
                is_wave &= is_near(found, crest[k] * (TAU * distance / period + angle).sin());
            }
        } else {
            let [sine, cosine] = [0.0, FRAC_PI_2].map(|angle| slopes(angle, None));
            for (k, found) in slopes(angle, None).into_iter().enumerate() {
                is_wave &= is_near(found, angle.cos() * sine[k] + angle.sin() * cosine[k]);
            }
        }
        if is_wave {
            return Ok(());
        }
        let form = match period {
            Some(_) => "amplitude * sin(2 * pi * laser / period + phase)",
            None => "amplitude * sin(.. + phase)",
        };
        let message = format!(
            "found the phase \"{}\" of something that is no wave, expected {form} with a neutral amplitude of 0",
            definition.name
        );
        Err(Fault::new(at, message))
    }
}
