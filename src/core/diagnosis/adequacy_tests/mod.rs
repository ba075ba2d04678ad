//! Tests of the residual analysis that does not depend on any candidate cause. Seeds are fixed; each statistical test
//! states how improbable a failure of a correct program would be.

mod null;
mod power;
mod space;

use super::residual_space::ResidualSpace;
use super::variables::Variables;
use super::{Discrepancy, Quantity, Variable, discrepancy};
use crate::effect::EffectSetting;
use crate::estimation::{Control, Linearisation, Options, Problem, Progress, Solution, solve};
use crate::measurement::Dataset;
use crate::robot::presets::{self, Preset};
use crate::simulation::{Simulated, SimulationOptions, simulate};

/// Simulates a run of a preset with hidden effects.
pub(super) fn run_with(
    name: &str,
    poses: usize,
    seed: u64,
    effects: &[EffectSetting],
) -> Simulated {
    run_of(&presets::find(name).unwrap(), poses, seed, effects)
}

pub(super) fn run_of(
    preset: &Preset,
    poses: usize,
    seed: u64,
    effects: &[EffectSetting],
) -> Simulated {
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        effects: effects.to_vec(),
        ..SimulationOptions::new(poses, seed)
    };
    simulate(&preset.robot, &options).unwrap()
}

/// An effect with its targets and parameters.
pub(super) fn setting(effect: &str, targets: &[&str], parameters: &[(&str, f64)]) -> EffectSetting {
    EffectSetting {
        effect: effect.to_owned(),
        targets: targets.iter().map(|t| (*t).to_owned()).collect(),
        parameters: parameters
            .iter()
            .map(|(name, value)| ((*name).to_owned(), *value))
            .collect(),
    }
}

/// A dataset, its solution and the linearisation there.
struct Fitted<'a> {
    problem: Problem<'a>,
    solution: Solution,
    linear: Linearisation,
    space: ResidualSpace,
}

impl<'a> Fitted<'a> {
    fn new(dataset: &'a Dataset) -> Self {
        let problem = Problem::new(dataset).unwrap();
        let mut quiet = |_: &Progress| Control::Continue;
        // Converge to rounding error, because the comparison with dense algebra must not depend on the stopping rule.
        let options = Options {
            negligible: 0.0,
            ..Options::default()
        };
        let solution = solve(&problem, &options, &mut quiet).unwrap();
        assert!(solution.converged());
        let linear = Linearisation::new(&problem, &solution);
        Self {
            space: ResidualSpace::new(&linear),
            problem,
            solution,
            linear,
        }
    }

    fn variables(&self) -> Variables<'_> {
        Variables::new(&self.problem, &self.solution, &self.linear)
    }

    fn discrepancies(&self, alpha: f64) -> Vec<Discrepancy> {
        let tests = discrepancy::dependence_tests(&self.space, &self.variables());
        discrepancy::discrepancies(&self.space, &tests, alpha)
    }
}
