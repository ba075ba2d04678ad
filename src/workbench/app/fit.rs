//! Identification as the screens use it.

use std::sync::Arc;

use tautline_core::effect::BoundEffect;
use tautline_core::estimation::{
    Analysis, Control, Deficiency, EstimationError, Method, Options, Problem, Progress, Solution,
    deficiencies, solve,
};
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;

/// A solution with what it is a solution of.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Robot and measurements, excluded poses left out.
    pub dataset: Arc<Dataset>,
    /// Parameters, poses, covariance.
    pub solution: Solution,
    /// Readings with what the solution predicts for them.
    pub analysis: Analysis,
    /// What the readings leave open.
    pub open: Vec<Deficiency>,
    /// The robot with the values identified.
    pub model: Robot,
    /// Chi-square after each step, for the plot of convergence.
    pub steps: Vec<f64>,
}

/// What to identify.
#[derive(Debug, Clone)]
pub struct FitOrder {
    /// Robot and measurements, excluded poses left out.
    pub dataset: Arc<Dataset>,
    /// How tensions enter.
    pub method: Method,
    /// Effects whose parameters are identified.
    pub effects: Vec<BoundEffect>,
}

/// Identifies; `observe` sees every step and can end it.
///
/// # Errors
/// If the data are not enough to identify anything.
pub fn fit(
    order: FitOrder,
    observe: &mut dyn FnMut(&Progress) -> Control,
) -> Result<Fit, EstimationError> {
    let FitOrder {
        dataset,
        method,
        effects,
    } = order;
    let mut problem = Problem::new(&dataset)?.with_method(method);
    problem.free_effects = effects;
    let mut steps = Vec::new();
    let solution = solve(&problem, &Options::default(), &mut |progress| {
        steps.push(progress.loss);
        observe(progress)
    })?;
    let analysis = Analysis::new(&problem, &solution);
    let open = deficiencies(&problem, &solution);
    let model = solution.globals.model(&dataset.robot);
    Ok(Fit {
        solution,
        analysis,
        open,
        model,
        steps,
        dataset: Arc::clone(&dataset),
    })
}
