//! Identification as the screens use it.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

use tautline_core::effect::{BoundEffect, EffectError, measurements_as_modelled};
use tautline_core::estimation::{
    Analysis, Control, Deficiency, EstimationError, Geometry, Method, Options, Problem, Progress,
    Reading, Solution, deficiencies, solve,
};
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_session::Session;

use crate::documents::identification::{
    Identification, PublishedFit, SUSPECT_LEVEL, Solved, fit_published, identified,
};

/// A solution with what it is a solution of.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Robot and measurements, excluded poses left out.
    pub dataset: Arc<Dataset>,
    /// How tensions entered.
    pub method: Method,
    /// Number of effects whose values were held; they come first in the solution.
    pub held: usize,
    /// Parameters, poses, covariance.
    pub solution: Solution,
    /// Readings with what the solution predicts for them.
    pub analysis: Analysis,
    /// Readings that do not fit, together by pose, the worst pose first.
    pub suspects: Vec<Vec<Reading>>,
    /// What the readings leave open.
    pub open: Vec<Deficiency>,
    /// The robot with the values identified; standard deviations are those of the solution.
    pub model: Robot,
    /// Chi-square after each step, for the plot of convergence.
    pub steps: Vec<f64>,
    /// Time of the solve (s).
    pub seconds: f64,
    /// What the published method finds, where it was asked for; else one sentence on why it cannot be applied.
    pub published: Option<Result<Compared, String>>,
}

/// What the published method finds, with the poses fitted to it so that its residuals compare.
#[derive(Debug, Clone)]
pub struct Compared {
    /// The method's own result.
    pub fit: PublishedFit,
    /// The document of it.
    pub identification: Identification,
}

impl Fit {
    /// The same for documents and words.
    #[must_use]
    pub fn solved(&self) -> Solved<'_> {
        Solved {
            dataset: &self.dataset,
            method: self.method,
            solution: &self.solution,
            analysis: &self.analysis,
            open: &self.open,
            held: self.held,
            seconds: self.seconds,
        }
    }

    /// By how many times their noise the readings are missed; `None` if nothing is redundant.
    #[must_use]
    pub fn missed(&self) -> Option<f64> {
        let freedom = self.solution.degrees_of_freedom;
        (freedom > 0.0).then(|| (self.solution.chi2 / freedom).sqrt())
    }
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

impl FitOrder {
    /// What a session asks for. Effects without a parameter to estimate, as exchanged channels, are held; those of a
    /// pose that is left out act on nothing and are passed over.
    ///
    /// # Errors
    /// If an effect does not fit the robot.
    pub fn of(session: &Session) -> Result<Self, EffectError> {
        let mut dataset = session.dataset();
        let mut effects = Vec::new();
        for setting in &session.settings.identification.effects {
            let bound = BoundEffect::to_estimate(setting, &dataset.robot)?;
            if !bound.effect.is_estimable() {
                dataset.robot.effects.push(setting.clone());
            } else if bound.check_poses(&dataset.measurements).is_ok() {
                effects.push(bound);
            }
        }
        let modelled = measurements_as_modelled(&dataset.robot, &dataset.measurements)?;
        dataset.measurements = modelled.into_owned();
        Ok(Self {
            dataset: Arc::new(dataset),
            method: match session.settings.identification.method {
                tautline_session::Method::Simple => Method::Simple,
                _ => Method::Joint,
            },
            effects,
        })
    }
}

/// Identifies; `observe` sees every step and can end it.
///
/// Where effects are in the model, a first solve without the free ones says better than the commanded poses do where the
/// platform was, on which they depend: the same way as a diagnosis fits its causes.
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
    let started = Instant::now();
    let mut problem = Problem::new(&dataset)?.with_method(method);
    let held = problem.held_effects.len();
    if held > 0 || !effects.is_empty() {
        let first = solve(&problem, &Options::default(), observe)?;
        problem = problem.at_poses_of(&first);
    }
    problem.free_effects = effects;
    let mut steps = Vec::new();
    let solution = solve(&problem, &Options::default(), &mut |progress| {
        steps.push(progress.loss);
        observe(progress)
    })?;
    let seconds = started.elapsed().as_secs_f64();
    let analysis = Analysis::new(&problem, &solution);
    let open = deficiencies(&problem, &solution);
    Ok(Fit {
        model: identified(&dataset.robot, &solution),
        method,
        held,
        solution,
        suspects: by_pose(analysis.suspects(SUSPECT_LEVEL)),
        analysis,
        open,
        steps,
        seconds,
        published: None,
        dataset: Arc::clone(&dataset),
    })
}

/// Readings together by pose, in the order of the first of each.
fn by_pose(readings: Vec<Reading>) -> Vec<Vec<Reading>> {
    let mut places: HashMap<usize, usize> = HashMap::new();
    let mut poses: Vec<Vec<Reading>> = Vec::new();
    for reading in readings {
        let place = *places.entry(reading.row).or_insert_with(|| {
            poses.push(Vec::new());
            poses.len() - 1
        });
        poses[place].push(reading);
    }
    poses
}

/// The published method on the same data, in one sentence where it cannot be applied.
///
/// # Errors
/// If the dataset lacks what the method rests on.
pub fn compare_published(dataset: &Dataset) -> Result<Compared, String> {
    let started = Instant::now();
    let result = fit_published(dataset).map_err(|error| error.to_string())?;
    let fit = PublishedFit {
        result,
        seconds: started.elapsed().as_secs_f64(),
    };
    let applied = fit.applied_to(dataset);
    let words = |error: EstimationError| error.to_string();
    let mut problem = Problem::new(&applied)
        .map_err(words)?
        .with_method(Method::Simple);
    problem.geometry = Geometry::Held;
    let options = Options::default();
    let solution = solve(&problem, &options, &mut |_| Control::Continue).map_err(words)?;
    let solved = Solved {
        dataset: &applied,
        method: Method::Simple,
        analysis: &Analysis::new(&problem, &solution),
        open: &deficiencies(&problem, &solution),
        held: problem.held_effects.len(),
        seconds: fit.seconds,
        solution: &solution,
    };
    let identification = fit.identification(solved.identification());
    Ok(Compared {
        fit,
        identification,
    })
}
