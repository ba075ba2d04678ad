//! Identification: the pipeline from measured poses to an identified robot, shared by all commands and the window.
//!
//! A request states what is identified from which data; [`identify`] solves it and analyses the residuals.

mod adequacy;
mod budget;
mod document;
mod effects;
mod model;
mod pose_context;
mod published;
mod pulley;
mod request;
mod residuals;
mod statistics;
mod wording;

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

use tautline_core::effect::{BoundEffect, EffectError};
use tautline_core::estimation::{
    Analysis, Control, EstimationError, Method, Observation, ObservationKind, ParameterId, Problem,
    Progress, RankDefect, Solution, rank_defects,
};
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_session::Session;

pub use adequacy::FitVerdict;
pub use budget::{
    BudgetDocument, COVERAGE_PROBABILITY, EvaluatedSource, PulleyBudget, SourceShare,
    SourceSummary, VarianceBudget, source_title,
};
pub use document::{FittedEffect, FittedPose, IdentificationDocument, Rms};
pub use effects::{effect_sizes, effects_title, same_effect, without_each_effect};
pub use model::{entry_point_sd, identified};
pub use published::{PublishedIdentification, PublishedIdentificationError, identify_published};
pub use pulley::{
    CLEAR, CoordinateCorrelation, IdentifiedPulley, NOISE, PulleyCoordinate, PulleyInspection,
    chance_of_noise, entry_point_covariance, entry_points_covariance,
};
pub use request::{IdentificationOptions, IdentificationRequest, TolerancesUsed, solved_method};
pub use residuals::{RESIDUAL, all_readings, group_of, readings_of};
pub use statistics::{
    CONFIDENCE, Cell, READINGS, ReadingStatistics, VALUES, ValueStatistics, nominal_and_value,
    reading_statistics, readings_table, unit_of_reading, unit_of_value, value_statistics,
    values_table,
};
pub use wording::reading_name;

/// Reasons why there is no reliable identification.
#[derive(Debug, thiserror::Error)]
pub enum IdentificationError {
    /// There are no measured poses.
    #[error("there are no measured poses, so nothing can be identified")]
    NoPoses,
    /// An effect does not fit the robot or the measurements.
    #[error(transparent)]
    Effect(#[from] EffectError),
    /// The data cannot be used for an identification.
    #[error(transparent)]
    Estimation(#[from] EstimationError),
    /// A measured elongation surface would have to be extrapolated; states where, and its range.
    #[error("{0}")]
    OutsideSurface(String),
    /// The solver did not converge.
    #[error("the identification did not converge")]
    NotConverged,
}

/// An identified robot with the data that it was identified from.
#[derive(Debug, Clone)]
pub struct Identification {
    /// Robot and measurements, without the excluded poses.
    pub dataset: Arc<Dataset>,
    /// Treatment of the tensions.
    pub method: Method,
    /// Other options of the request.
    pub options: IdentificationOptions,
    /// Number of effects with held values; they come first in the solution.
    pub held: usize,
    /// Parameters, poses, covariance.
    pub solution: Solution,
    /// Residual analysis of the readings.
    pub analysis: Analysis,
    /// Suspect readings grouped by pose, the worst pose first.
    pub suspects: Vec<Vec<Observation>>,
    /// Rank defects: parameters that the readings leave undetermined.
    pub open: Vec<RankDefect>,
    /// The robot with the identified values and their standard deviations.
    pub model: Robot,
    /// Chi-square after each step, for the convergence plot.
    pub steps: Vec<f64>,
    /// Time of the solve alone (s).
    pub seconds: f64,
    /// Result of the published method on the same data, if requested; or one sentence why it cannot be applied.
    pub published: Option<Result<PublishedIdentification, String>>,
}

/// Identifies a robot; `observe` sees every step and can cancel.
///
/// Quantities that effects depend on, such as wrap angles, are evaluated at the poses of the solution itself.
///
/// # Errors
/// If the data cannot be used. Non-convergence is a field of the solution, not an error.
pub fn identify(
    request: &IdentificationRequest,
    observe: &mut dyn FnMut(&Progress) -> Control,
) -> Result<Identification, EstimationError> {
    let started = Instant::now();
    let mut steps = Vec::new();
    let (problem, solution) = pose_context::solve(request, &mut |progress| {
        steps.push(progress.loss);
        observe(progress)
    })?;
    let seconds = started.elapsed().as_secs_f64();
    let analysis = match request.lists_readings {
        true => Analysis::new(&problem, &solution),
        false => Analysis::summary(&problem, &solution),
    };
    Ok(Identification {
        model: identified(&request.dataset.robot, &solution),
        method: request.method,
        options: request.options,
        held: problem.held_effects.len(),
        suspects: by_pose(analysis.suspects()),
        open: rank_defects(&problem, &solution),
        analysis,
        solution,
        steps,
        seconds,
        published: None,
        dataset: Arc::clone(&request.dataset),
    })
}

/// Identifies a session according to its settings, for a result to rely on. If they state the published
/// method, the joint one is used, because the published one has no standard deviations.
///
/// # Errors
/// If nothing was measured, the data cannot be used, or the solution needs an extrapolated elongation.
pub fn identify_session(
    session: &Session,
    observe: &mut dyn FnMut(&Progress) -> Control,
) -> Result<Identification, IdentificationError> {
    if session.measurements.is_empty() {
        return Err(IdentificationError::NoPoses);
    }
    let request = IdentificationRequest::of_session(session)?;
    identify(&request, observe)?.refuse_extrapolation()
}

impl Identification {
    /// The problem whose solution this is.
    ///
    /// # Errors
    /// Only those that setting up the problem had before.
    pub fn problem(&self) -> Result<Problem<'_>, EstimationError> {
        let problem = self.options.problem(&self.dataset, self.method)?;
        let problem = problem.with_effects(self.free_effects().to_vec());
        Ok(pose_context::at_poses_of(problem, &self.solution))
    }

    /// The effects that were identified, with their values.
    #[must_use]
    pub fn free_effects(&self) -> &[BoundEffect] {
        let effects = &self.solution.globals.effects;
        effects.get(self.held..).unwrap_or_default()
    }

    /// Root mean square of the residuals over that of noise alone; `None` without redundancy.
    #[must_use]
    pub fn residual_ratio(&self) -> Option<f64> {
        let freedom = self.solution.degrees_of_freedom;
        (freedom > 0.0).then(|| (self.solution.chi2 / freedom).sqrt())
    }

    /// Distance of each identified entry point from that of `drawing` (m).
    #[must_use]
    pub fn displacements_m(&self, drawing: &Robot) -> Vec<f64> {
        let drawn = drawing
            .cables
            .iter()
            .map(|cable| cable.pulley.entry_point_m);
        let found = self.solution.globals.entry_points.iter();
        let distance = |(found, drawn): (&[f64; 3], [f64; 3])| {
            let square: f64 = (0..3).map(|k| (found[k] - drawn[k]).powi(2)).sum();
            square.sqrt()
        };
        found.zip(drawn).map(distance).collect()
    }

    /// Sentence on a measured elongation that had to be extrapolated; the solution is not valid then.
    #[must_use]
    pub fn extrapolation(&self) -> Option<String> {
        extrapolation(&self.dataset, &self.solution)
    }

    /// Rejects the identification if a measured elongation had to be extrapolated.
    ///
    /// # Errors
    /// If a measured elongation had to be extrapolated.
    pub fn refuse_extrapolation(self) -> Result<Self, IdentificationError> {
        match self.extrapolation() {
            None => Ok(self),
            Some(place) => Err(IdentificationError::OutsideSurface(place)),
        }
    }

    /// The identified parameters of the effects.
    #[must_use]
    pub fn effects(&self) -> Vec<FittedEffect> {
        let mut effects = Vec::new();
        for (index, parameter) in self.solution.parameters.iter().enumerate() {
            let ParameterId::Effect {
                effect,
                parameter: which,
            } = parameter.id
            else {
                continue;
            };
            let bound = &self.free_effects()[effect];
            let description = bound.effect.parameters()[which];
            effects.push(FittedEffect {
                effect: bound.effect.id().to_owned(),
                targets: bound.setting(&self.dataset.robot).targets,
                parameter: description.name.to_owned(),
                value: bound.values[which],
                unit: description.unit.to_owned(),
                sd: self.solution.standard_deviation(index),
            });
        }
        effects
    }

    /// Machine-readable form, without the budget of uncertainty, which takes longer than the solve.
    #[must_use]
    pub fn document(&self) -> IdentificationDocument {
        let measurements = &self.dataset.measurements;
        let solution = &self.solution;
        let cables = self.dataset.robot.cable_count();
        let poses = solution.poses.iter().map(|(row, pose)| FittedPose {
            pose: measurements.labels[*row],
            position_m: pose.position.into(),
            orientation_wxyz: pose.orientation_wxyz(),
        });
        IdentificationDocument {
            method: match self.method {
                Method::Joint => "joint",
                Method::Simple => "simple",
            }
            .to_owned(),
            converged: solution.converged(),
            iterations: solution.iterations,
            seconds: self.seconds,
            chi2: solution.chi2,
            dof: solution.degrees_of_freedom,
            p_value: solution.p_value(),
            entry_points_m: solution.globals.entry_points.clone(),
            entry_points_sd_m: (0..cables)
                .map(|cable| [0, 1, 2].map(|axis| entry_point_sd(solution, cable, axis)))
                .collect(),
            rms: Rms {
                length_m: (self.analysis).rms(|kind| matches!(kind, ObservationKind::Length(_))),
                laser_m: self.analysis.rms(|kind| kind == ObservationKind::Laser),
                tension_n: (self.analysis).rms(|kind| matches!(kind, ObservationKind::Tension(_))),
                distance_m: (self.analysis)
                    .rms(|kind| matches!(kind, ObservationKind::Distance(_))),
            },
            poses: poses.collect(),
            effects: self.effects(),
            undetermined: self.open.iter().map(|d| d.sentence.clone()).collect(),
            suspect_readings: self.suspect_lines(),
            budget: None,
        }
    }
}

/// Sentence on a measured elongation that had to be extrapolated; the solution is not valid then.
#[must_use]
pub fn extrapolation(dataset: &Dataset, solution: &Solution) -> Option<String> {
    let first = solution.outside_surface.first()?;
    let label = dataset.measurements.labels[first.row];
    let cable = &dataset.robot.cables[first.cable].name;
    let more = match solution.outside_surface.len() - 1 {
        0 => String::new(),
        count => format!(" (and {count} more)"),
    };
    let range = first.range;
    Some(format!(
        "pose {label}, {cable}: {range} of its elongation surface{more}"
    ))
}

/// Groups readings by pose, in the order of the first reading of each.
fn by_pose(readings: &[Observation]) -> Vec<Vec<Observation>> {
    let mut places: HashMap<usize, usize> = HashMap::new();
    let mut poses: Vec<Vec<Observation>> = Vec::new();
    for reading in readings {
        let place = *places.entry(reading.row).or_insert_with(|| {
            poses.push(Vec::new());
            poses.len() - 1
        });
        poses[place].push(*reading);
    }
    poses
}

#[cfg(test)]
mod tests;
