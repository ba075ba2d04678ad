//! Estimates from simulated data compared with the truth: distribution of chi-square, stated standard deviations,
//! efficiency of the estimator.

use std::ops::Range;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use tautline_core::estimation::Problem;
use tautline_core::measurement::Dataset;
use tautline_core::simulation::{SimulationOptions, simulate};

use super::counting::{Share, by_name, total};
use super::markdown::table;
use super::simulated::{EntryError, NORMAL_95, PRESETS, preset, preset_options, solved};
use super::study::Study;

/// Poses per data set.
const POSES: usize = 25;
/// Seed of the first data set.
pub const FIRST_SEED: u64 = 1000;

/// Data sets of each preset with these seeds, the truth drawn from the stated priors.
#[derive(Debug)]
pub struct Truth(pub Range<u64>);

/// Preset and seed.
pub type Case = (usize, u64);

/// What one data set shows.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Outcome {
    has_converged: bool,
    chi2: f64,
    dof: f64,
    /// 95 % intervals of entry point coordinates that cover the truth.
    covered: Share,
    /// Sums of squares of the errors over their standard deviations, of the errors (m), and of the Cramer-Rao bounds at the truth (m).
    standardised: f64,
    error: f64,
    bound: f64,
}

impl Study for Truth {
    type Case = Case;
    type Outcome = Outcome;

    fn cases(&self) -> Result<Vec<Case>> {
        let of = |robot| self.0.clone().map(move |seed| (robot, seed));
        Ok((0..PRESETS.len()).flat_map(of).collect())
    }

    fn run(&self, (robot, seed): &Case) -> Result<Option<Outcome>> {
        let preset = preset(PRESETS[*robot])?;
        let options = preset_options(&preset, POSES, *seed);
        let run = simulate(&preset.robot, &options)?;
        let without_noise = SimulationOptions {
            noise: false,
            ..options
        };
        let exact = simulate(&preset.robot, &without_noise)?;
        let exact = Dataset {
            robot: exact.truth,
            measurements: exact.dataset.measurements,
        };
        let at_truth = solved(&Problem::new(&exact)?)?;
        let solution = solved(&Problem::new(&run.dataset)?)?;
        let mut outcome = Outcome {
            has_converged: solution.converged(),
            chi2: solution.chi2,
            dof: solution.degrees_of_freedom,
            covered: Share::default(),
            standardised: 0.0,
            error: 0.0,
            bound: 0.0,
        };
        for one in EntryError::all(&solution, &run.truth) {
            let bound = at_truth.standard_deviation(one.parameter);
            let (sd, bound) = one.sd_m.zip(bound).context("undetermined")?;
            outcome.covered.count((one.error_m / sd).abs() < NORMAL_95);
            outcome.standardised += (one.error_m / sd).powi(2);
            outcome.error += one.error_m.powi(2);
            outcome.bound += bound.powi(2);
        }
        Ok(Some(outcome))
    }

    fn table(&self, outcomes: &[(Case, Outcome)]) -> Result<String> {
        let rows = by_robot(outcomes).into_iter().map(|(robot, all)| {
            let figures = Figures::of(&all);
            format!(
                "{robot} | {} | {:.0} | {:.1} | {:+.2} | {:.3} | {:.2} % | {:.2} | {:.3} | {}",
                all.len(),
                figures.dof,
                figures.chi2,
                figures.chi2_off,
                figures.standardised_rms,
                100.0 * figures.coverage,
                1e3 * figures.rms_error_m,
                figures.over_bound,
                figures.failures,
            )
        });
        Ok(table(
            "robot | data sets | dof | mean chi-square | standard errors off | standardised error rms | 95 % intervals cover | rms error mm | over Cramer-Rao bound | not converged",
            rows,
        ))
    }
}

/// Outcomes of each robot.
#[must_use]
pub fn by_robot(outcomes: &[(Case, Outcome)]) -> Vec<(&'static str, Vec<&Outcome>)> {
    let mut robots = by_name(&PRESETS, outcomes, |(robot, _)| PRESETS[*robot]);
    // There is no row of all robots.
    robots.pop();
    robots
}

/// Figures of one robot over many simulated data sets.
#[derive(Debug, Clone)]
pub struct Figures {
    /// Degrees of freedom.
    dof: f64,
    /// Mean chi-square.
    chi2: f64,
    /// By how many of its standard errors that mean is off, if chi-square has its theoretical distribution.
    pub chi2_off: f64,
    /// Root mean square of entry point errors over their standard deviations.
    pub standardised_rms: f64,
    /// Share of 95 % intervals of entry point coordinates that cover the truth.
    pub coverage: f64,
    /// Root mean square entry point error (m).
    rms_error_m: f64,
    /// The same over the Cramer-Rao bound at the truth.
    pub over_bound: f64,
    /// Data sets in which the solver did not converge.
    pub failures: usize,
}

impl Figures {
    /// Those of the data sets of a robot.
    #[must_use]
    pub fn of(all: &[&Outcome]) -> Self {
        let sets = all.len() as f64;
        let sum = |value: fn(&Outcome) -> f64| -> f64 { total(all, value) };
        let covered: Share = total(all, |one| one.covered);
        let count = covered.whole as f64;
        let [dof, chi2] = [sum(|one| one.dof), sum(|one| one.chi2)].map(|sum| sum / sets);
        let error = sum(|one| one.error);
        Self {
            dof,
            chi2,
            chi2_off: (chi2 - dof) / (2.0 * dof / sets).sqrt(),
            standardised_rms: (sum(|one| one.standardised) / count).sqrt(),
            coverage: covered.ratio(),
            rms_error_m: (error / count).sqrt(),
            over_bound: (error / sum(|one| one.bound)).sqrt(),
            failures: all.iter().filter(|one| !one.has_converged).count(),
        }
    }
}
