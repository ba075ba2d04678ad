//! What studies of simulated robots share: random numbers, settings of effects, fits, and errors against the truth.

use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use tautline_core::diagnosis::{Diagnosis, DiagnosisOptions, diagnose};
use tautline_core::effect::{EffectParameter, EffectSetting, PartDeviation};
use tautline_core::estimation::{Control, Options, ParameterId, Problem, Solution, solve};
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_core::robot::presets::{self, Preset};
use tautline_core::simulation::SimulationOptions;
use tautline_workflow::diagnosis::{Diagnosed, TIME_LIMIT_S, diagnose_dataset};

use crate::support::process::thread_s;

/// Half-width of a 95 % interval in standard deviations.
pub const NORMAL_95: f64 = 1.959_964;
/// The presets.
pub const PRESETS: [&str; 4] = ["mini", "hall", "suspended", "planar"];

/// A preset.
///
/// # Errors
/// If there is none of this name.
pub fn preset(name: &str) -> Result<Preset> {
    presets::find(name).with_context(|| format!("no preset {name}"))
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

/// A stream of the random numbers of a seed. The simulation uses stream 0.
#[must_use]
pub fn stream(seed: u64, number: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    rng
}

/// A number from a range, uniform in its logarithm.
pub fn log_uniform([low, high]: [f64; 2], rng: &mut impl Rng) -> f64 {
    low * (high / low).powf(rng.random::<f64>())
}

/// The same distribution. Published studies have one or the other, and would have other data with the other.
pub fn exp_uniform([low, high]: [f64; 2], rng: &mut impl Rng) -> f64 {
    rng.random_range(low.ln()..high.ln()).exp()
}

/// 1 or -1.
pub fn random_sign(rng: &mut impl Rng) -> f64 {
    if rng.random_bool(0.5) { 1.0 } else { -1.0 }
}

/// Whether a parameter has no values below its neutral one.
#[must_use]
pub fn is_one_sided(parameter: &EffectParameter) -> bool {
    parameter.bounds[0] == parameter.neutral
}

/// Lets a part deviate by a normal number of standard deviations of its tolerance times a factor.
pub fn scatter_part(part: &mut PartDeviation, factor: f64, rng: &mut impl Rng) {
    let parameters = part.bound.effect.parameters().iter();
    let of_parameters = parameters.zip(&part.prior_sd);
    for (value, (parameter, sd)) in part.bound.values.iter_mut().zip(of_parameters) {
        let normal: f64 = StandardNormal.sample(rng);
        let off = factor * sd * normal;
        *value += if is_one_sided(parameter) {
            off.abs()
        } else {
            off
        };
    }
}

/// An effect with one parameter.
#[must_use]
pub fn setting(effect: &str, targets: &[&str], parameter: &str, value: f64) -> EffectSetting {
    EffectSetting {
        effect: effect.to_owned(),
        targets: targets.iter().map(|&name| name.to_owned()).collect(),
        parameters: [(parameter.to_owned(), value)].into(),
    }
}

/// Solves a problem.
///
/// # Errors
/// If the fit breaks down.
pub fn solved(problem: &Problem<'_>) -> Result<Solution> {
    let found = solve(problem, &Options::default(), &mut |_| Control::Continue)?;
    ensure!(found.chi2.is_finite(), "the fit broke down");
    Ok(found)
}

/// Error of a coordinate of an entry point.
#[derive(Debug, Clone, Copy)]
pub struct EntryError {
    /// Which parameter of the solution it is.
    pub parameter: usize,
    /// Estimate minus truth (m).
    pub error_m: f64,
    /// Stated standard deviation (m); `None` if the readings do not determine it.
    pub sd_m: Option<f64>,
}

impl EntryError {
    /// All those of a solution.
    pub fn all<'s>(solution: &'s Solution, truth: &'s Robot) -> impl Iterator<Item = Self> + 's {
        let parameters = solution.parameters.iter().enumerate();
        parameters.filter_map(|(parameter, of)| {
            let ParameterId::EntryPoint { cable, axis } = of.id else {
                return None;
            };
            let truth = truth.cables[cable].pulley.entry_point_m[axis];
            Some(Self {
                parameter,
                error_m: solution.globals.entry_points[cable][axis] - truth,
                sd_m: solution.standard_deviation(parameter),
            })
        })
    }
}

/// The diagnosis of a dataset with usual options, and the processor time that it takes (s).
///
/// # Errors
/// If the data cannot be used.
pub fn diagnosed(dataset: &Dataset) -> Result<(Diagnosis, f64)> {
    let options = DiagnosisOptions::default();
    let job = || diagnose(dataset, &options, &mut |_| Control::Continue);
    let (diagnosis, seconds) = timed(job);
    Ok((diagnosis?, seconds))
}

/// The diagnosis of a dataset as the program makes it.
///
/// # Errors
/// If the data cannot be used.
pub fn asked(dataset: impl Into<Arc<Dataset>>) -> Result<Diagnosed> {
    let limits = (DiagnosisOptions::default().alpha, TIME_LIMIT_S);
    Ok(diagnose_dataset(dataset.into(), limits, &mut |_| {
        Control::Continue
    })?)
}

/// What a job results in, and the processor time of this thread for it (s), or the elapsed time if the system does not tell.
pub fn timed<T>(job: impl FnOnce() -> T) -> (T, f64) {
    let processor_s = || thread_s("thread-self");
    let (started, before) = (Instant::now(), processor_s());
    let result = job();
    let spent = processor_s().and_then(|now| Ok(now - before?));
    let spent = spent.unwrap_or_else(|_| started.elapsed().as_secs_f64());
    (result, spent)
}
