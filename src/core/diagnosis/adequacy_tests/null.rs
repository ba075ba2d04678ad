//! False alarm rates: without a hidden effect and with the noise as described, no test rejects more often than its
//! level.

use super::super::NoiseStatement;
use super::super::adequacy::adequacy;
use super::super::discrepancy::{DependenceTest, dependence_tests, discrepancies};
use super::super::noise::{noise_of_all, noise_statements};
use super::*;
use crate::robot::{Inclinometer, PerAxis, Tracker};
use std::collections::BTreeMap;

/// Number of datasets per robot.
const RUNS: u64 = 100;
/// Largest deviation of a count from its expectation, in standard deviations. With fewer than 40 counts in this file,
/// one of them would fail by chance with a probability of about 40 * 3e-5 = 1e-3 had the seeds not been fixed.
const LIMIT: f64 = 4.2;

/// Counts p-values below 0.05. Tests within one run depend on each other, so the count of each run is one independent
/// draw.
#[derive(Default)]
struct Counts {
    per_run: Vec<f64>,
    tests_done: f64,
}

impl Counts {
    fn add(&mut self, p_values: impl Iterator<Item = f64>) {
        let (mut small, mut tests_done) = (0.0, 0.0);
        for p in p_values {
            tests_done += 1.0;
            small += f64::from(p < 0.05);
        }
        self.per_run.push(small);
        self.tests_done += tests_done;
    }

    fn check(&self, what: &str) {
        let runs = self.per_run.len() as f64;
        let mean = self.per_run.iter().sum::<f64>() / runs;
        let expected = 0.05 * self.tests_done / runs;
        let spread: f64 = self.per_run.iter().map(|c| (c - mean).powi(2)).sum();
        // Not below the variance of independent tests, because a few counts can agree by chance.
        let variance = (spread / (runs - 1.0)).max(0.95 * expected) / runs;
        let away = (mean - expected) / variance.sqrt();
        assert!(away.abs() < LIMIT, "{what}: {away} sd");
    }
}

#[derive(Default)]
struct Tally {
    global: Counts,
    groups: Counts,
    cables: Counts,
    dependences: Counts,
    false_alarms: usize,
    false_noise: usize,
    squares: [f64; 2],
    coverage: Counts,
}

impl Tally {
    fn add(&mut self, fitted: &Fitted<'_>) {
        let found = adequacy(&fitted.space, &fitted.solution, 0.01);
        assert_eq!(found.adequate, found.global.p_value >= 0.01);
        self.global.add(std::iter::once(found.global.p_value));
        let of = |single: bool| {
            let tests = found.groups.iter();
            tests
                .filter(move |t| t.cable.is_some() == single)
                .map(|t| t.p_value)
        };
        self.groups.add(of(false));
        self.cables.add(of(true));
        let tests: Vec<DependenceTest> = dependence_tests(&fitted.space, &fitted.variables());
        self.dependences.add(tests.iter().map(|t| t.p_value));
        let alarms = discrepancies(&fitted.space, &tests, 0.05);
        self.false_alarms += usize::from(!alarms.is_empty());
        let noise = noise_statements(&fitted.space, &[], 0.05);
        self.false_noise += usize::from(!noise.is_empty());
        let known = noise_of_all(&fitted.space, &BTreeMap::new());
        // A 95 % interval that misses the true ratio of 1 counts like a p-value below 0.05.
        let outside = |n: NoiseStatement| match n.interval {
            [low, high] if low < 1.0 && 1.0 < high => 1.0,
            _ => 0.0,
        };
        self.coverage.add(known.into_iter().map(outside));
        let redundancy = fitted.space.redundancy();
        for (row, id) in fitted.space.readings.iter().enumerate() {
            if id.is_some_and(|id| id.quantity == Quantity::Length) {
                self.squares[0] += fitted.space.residual[row].powi(2);
                self.squares[1] += redundancy[row];
            }
        }
    }

    fn check(&self, name: &str) {
        self.global.check(&format!("{name}, global"));
        self.groups.check(&format!("{name}, quantities"));
        self.cables.check(&format!("{name}, cables"));
        self.dependences.check(&format!("{name}, dependences"));
        self.coverage
            .check(&format!("{name}, outside of the interval"));
        // Bonferroni correction: 5 false alarms are expected in 100 runs, more than 14 have a probability of 4e-4.
        assert!(self.false_alarms <= 14 && self.false_noise <= 14);
        let [squares, expected] = self.squares;
        let away = (squares - expected) / (2.0 * expected).sqrt();
        assert!(away.abs() < LIMIT, "{name}: {away}");
    }
}

fn check(preset: &Preset) {
    let mut tally = Tally::default();
    for seed in 0..RUNS {
        let run = run_of(preset, 30, 40_000 + seed, &[]);
        tally.add(&Fitted::new(&run.dataset));
    }
    tally.check(&preset.robot.name);
}

#[test]
fn probabilities_are_uniform_on_a_spatial_robot() {
    check(&presets::find("mini").unwrap());
}

#[test]
fn probabilities_are_uniform_on_a_planar_robot() {
    check(&presets::find("planar").unwrap());
}

#[test]
fn probabilities_are_uniform_with_every_instrument() {
    let mut preset = presets::find("hall").unwrap();
    let robot = &mut preset.robot;
    robot.name = "instrumented hall".to_owned();
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(5e-4),
        orientation_sd_rad: Some(1e-3),
    });
    robot.inclinometer = Some(Inclinometer { sd_rad: 1e-3 });
    for cable in &mut robot.cables {
        cable.pulley.swivel_zero = Some([1.0, 0.0, 0.0]);
        cable.pulley.swivel_sd_rad = Some(2e-3);
    }
    check(&preset);
}
