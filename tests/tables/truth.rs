//! Estimates from simulated data compared with the truth: distribution of chi-square, stated standard deviations,
//! efficiency of the estimator.

use anyhow::{Result, anyhow};
use tautline_core::estimation::{Control, Options, ParameterId, Problem, Solution, solve};
use tautline_core::measurement::Dataset;
use tautline_core::robot::presets::{self, Preset};
use tautline_core::simulation::{Simulated, SimulationOptions, simulate};

/// Poses per data set.
pub const POSES: usize = 25;

/// Figures of one robot over many simulated data sets, the truth drawn from the stated priors.
#[derive(Debug, Clone)]
pub struct TruthRow {
    /// Preset.
    pub robot: String,
    /// Number of data sets.
    pub data_sets: usize,
    /// Degrees of freedom.
    pub dof: f64,
    /// Mean chi-square.
    pub chi2_mean: f64,
    /// Standard error of that mean if chi-square has its theoretical distribution.
    pub chi2_standard_error: f64,
    /// Root mean square of entry point errors over their standard deviations.
    pub standardised_rms: f64,
    /// Share of 95 % intervals of entry point coordinates that cover the truth.
    pub coverage: f64,
    /// Root mean square entry point error (m).
    pub rms_error_m: f64,
    /// The same over the Cramer-Rao bound at the truth.
    pub over_bound: f64,
    /// Data sets in which the solver did not converge.
    pub failures: usize,
}

/// Options that simulate a preset as it is meant to be used.
#[must_use]
pub fn preset_options(preset: &Preset, poses: usize, seed: u64) -> SimulationOptions {
    SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(poses, seed)
    }
}

/// Solves the joint problem of a dataset.
///
/// # Errors
/// If the dataset cannot be used.
pub fn solve_joint(dataset: &Dataset) -> Result<Solution> {
    let problem = Problem::new(dataset)?;
    Ok(solve(&problem, &Options::default(), &mut |_| {
        Control::Continue
    })?)
}

/// Runs the study for one preset.
///
/// # Errors
/// If the preset is unknown or cannot be simulated.
pub fn study(name: &str, data_sets: usize, first_seed: u64) -> Result<TruthRow> {
    let preset = presets::find(name).ok_or_else(|| anyhow!("no preset {name}"))?;
    let mut tally = Tally::default();
    for seed in first_seed..first_seed + data_sets as u64 {
        let options = preset_options(&preset, POSES, seed);
        let run = simulate(&preset.robot, &options)?;
        let exact = simulate(
            &preset.robot,
            &SimulationOptions {
                noise: false,
                ..options
            },
        )?;
        let at_truth = solve_joint(&Dataset {
            robot: exact.truth,
            measurements: exact.dataset.measurements,
        })?;
        tally.add(&run, &solve_joint(&run.dataset)?, &at_truth)?;
    }
    let sets = data_sets as f64;
    let dof = tally.dof / sets;
    let count = tally.coordinates;
    Ok(TruthRow {
        robot: name.to_owned(),
        data_sets,
        dof,
        chi2_mean: tally.chi2 / sets,
        chi2_standard_error: (2.0 * dof / sets).sqrt(),
        standardised_rms: (tally.standardised / count).sqrt(),
        coverage: tally.covered / count,
        rms_error_m: (tally.error / count).sqrt(),
        over_bound: (tally.error / tally.bound).sqrt(),
        failures: tally.failures,
    })
}

#[derive(Default)]
struct Tally {
    chi2: f64,
    dof: f64,
    coordinates: f64,
    standardised: f64,
    covered: f64,
    error: f64,
    bound: f64,
    failures: usize,
}

impl Tally {
    fn add(&mut self, run: &Simulated, solution: &Solution, at_truth: &Solution) -> Result<()> {
        self.failures += usize::from(!solution.converged());
        self.chi2 += solution.chi2;
        self.dof += solution.degrees_of_freedom;
        for (index, parameter) in solution.parameters.iter().enumerate() {
            let ParameterId::EntryPoint { cable, axis } = parameter.id else {
                continue;
            };
            let undetermined = || anyhow!("{} is not determined", parameter.name);
            let truth = run.truth.cables[cable].pulley.entry_point_m[axis];
            let error = solution.globals.entry_points[cable][axis] - truth;
            let sd = solution
                .standard_deviation(index)
                .ok_or_else(undetermined)?;
            let bound = at_truth
                .standard_deviation(index)
                .ok_or_else(undetermined)?;
            self.coordinates += 1.0;
            self.standardised += (error / sd).powi(2);
            self.covered += f64::from(u8::from((error / sd).abs() < 1.959_964));
            self.error += error * error;
            self.bound += bound * bound;
        }
        Ok(())
    }
}

/// The table as Markdown.
#[must_use]
pub fn markdown(rows: &[TruthRow]) -> String {
    let mut text = String::from(
        "| robot | data sets | dof | mean chi-square | standard errors off | standardised error rms | 95 % intervals cover | rms error mm | over Cramer-Rao bound | not converged |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        text.push_str(&format!(
            "| {} | {} | {:.0} | {:.1} | {:+.2} | {:.3} | {:.2} % | {:.2} | {:.3} | {} |\n",
            row.robot,
            row.data_sets,
            row.dof,
            row.chi2_mean,
            (row.chi2_mean - row.dof) / row.chi2_standard_error,
            row.standardised_rms,
            row.coverage * 100.0,
            row.rms_error_m * 1e3,
            row.over_bound,
            row.failures,
        ));
    }
    text
}
