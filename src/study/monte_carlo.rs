//! Propagation of distributions for one identification (JCGM 101:2008).

use rand_distr::{Distribution, StandardNormal};
use tautline_core::estimation::{Control, Options, solve};
use tautline_core::measurement::Dataset;
use tautline_core::simulation::drawn_inputs;
use tautline_core::threads::{available, map};
use tautline_workflow::identification::{COVERAGE_PROBABILITY, Identification};
use tautline_workflow::report::{CoverageInterval, MonteCarlo};

use crate::design::stream;

/// Identifies the values anew from `trials` sets of inputs, each drawn from its distribution about the measured or stated value.
/// Trials that do not converge are counted, not used.
#[must_use]
pub fn monte_carlo(fit: &Identification, trials: usize) -> MonteCarlo {
    let found = drawn_entry_points(fit, trials, &|_| ());
    let places = fit.solution.globals.entry_points.len();
    let interval = |cable: usize, axis: usize| {
        let mut values: Vec<f64> = found.iter().map(|places| places[cable][axis]).collect();
        values.sort_by(f64::total_cmp);
        let at = |probability: f64| {
            let last = values.len().saturating_sub(1);
            let place = (probability * last as f64).round() as usize;
            values.get(place).copied().unwrap_or(f64::NAN)
        };
        let tail = 0.5 * (1.0 - COVERAGE_PROBABILITY);
        CoverageInterval {
            from_m: at(tail),
            to_m: at(1.0 - tail),
        }
    };
    MonteCarlo {
        trials,
        converged: found.len(),
        entry_points: (0..places)
            .map(|cable| [0, 1, 2].map(|axis| interval(cable, axis)))
            .collect(),
    }
}

/// Entry points identified from drawn inputs (m), of each trial that converges. `change` may put inputs back to their values; the
/// others stay as drawn.
pub fn drawn_entry_points(
    fit: &Identification,
    trials: usize,
    change: &(dyn Fn(&mut Dataset) + Sync),
) -> Vec<Vec<[f64; 3]>> {
    let found = map(trials, available(), |trial| {
        entry_points(fit, trial as u64, change)
    });
    found.into_iter().flatten().collect()
}

/// The entry points of one trial; `None` if it does not converge.
fn entry_points(
    fit: &Identification,
    trial: u64,
    change: &dyn Fn(&mut Dataset),
) -> Option<Vec<[f64; 3]>> {
    let mut rng = stream(0, trial);
    let mut dataset = drawn_inputs(&fit.dataset, &mut rng);
    change(&mut dataset);
    let problem = fit.options.problem(&dataset, fit.method).ok()?;
    let mut problem = problem.with_effects(fit.free_effects().to_vec());
    // Deviations are estimated about drawn ones, like the positions of the pulleys about drawn positions.
    for deviation in &problem.deviations {
        let mut drawn = deviation.bound.clone();
        for (value, sd) in drawn.values.iter_mut().zip(&deviation.prior_sd) {
            let standard: f64 = StandardNormal.sample(&mut rng);
            *value += sd * standard;
        }
        problem.held_deviations.push(drawn);
    }
    let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue).ok()?;
    solution
        .converged()
        .then_some(solution.globals.entry_points)
}
