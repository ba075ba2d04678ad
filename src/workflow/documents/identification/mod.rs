//! What an identification says: as a document, and in words.

mod adequacy;
mod document;
mod model;
mod published;

use tautline_core::estimation::{
    Analysis, Deficiency, Method, ParameterId, Reading, ReadingKind, Solution,
};
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;

pub use adequacy::Explains;
pub use document::{FittedEffect, FittedPose, Identification, Rms};
pub use model::{entry_point_sd, identified};
pub use published::{PublishedFit, fit_published};

/// Level for all readings together at which single readings are called suspect.
pub const SUSPECT_LEVEL: f64 = 0.01;

/// Where a measured elongation had to be extrapolated, in words: the solution does not hold then.
#[must_use]
pub fn extrapolated(dataset: &Dataset, solution: &Solution) -> Option<String> {
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

/// A solution with what it is a solution of.
#[derive(Debug, Clone, Copy)]
pub struct Solved<'a> {
    /// Robot and measurements.
    pub dataset: &'a Dataset,
    /// How tensions entered.
    pub method: Method,
    /// Parameters, poses, covariance.
    pub solution: &'a Solution,
    /// Readings with what the solution predicts for them.
    pub analysis: &'a Analysis,
    /// What the readings leave open.
    pub open: &'a [Deficiency],
    /// Number of effects whose values were held; they come first.
    pub held: usize,
    /// Time of the solve alone (s).
    pub seconds: f64,
}

impl Solved<'_> {
    fn robot(&self) -> &Robot {
        &self.dataset.robot
    }

    /// The parameters of the effects that were estimated.
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
            let bound = &self.solution.globals.effects[self.held + effect];
            let description = bound.effect.parameters()[which];
            effects.push(FittedEffect {
                effect: bound.effect.id().to_owned(),
                targets: bound.setting(self.robot()).targets,
                parameter: description.name.to_owned(),
                value: bound.values[which],
                unit: description.unit.to_owned(),
                sd: self.solution.standard_deviation(index),
            });
        }
        effects
    }

    /// A suspect reading in words: `length of cable-3: off by +5.1 standard deviations`.
    #[must_use]
    pub fn suspect(&self, reading: &Reading) -> String {
        let size = reading.normalised().unwrap_or(f64::NAN);
        let what = reading_name(self.robot(), reading.kind);
        format!("{what}: off by {size:+.1} standard deviations")
    }

    fn suspects(&self) -> Vec<String> {
        let labels = &self.dataset.measurements.labels;
        let suspects = self.analysis.suspects(SUSPECT_LEVEL);
        let words =
            |reading: &Reading| format!("pose {}, {}", labels[reading.row], self.suspect(reading));
        suspects.iter().map(words).collect()
    }

    /// Machine form.
    #[must_use]
    pub fn identification(&self) -> Identification {
        let measurements = &self.dataset.measurements;
        let cables = self.robot().cable_count();
        let length = |kind| matches!(kind, ReadingKind::Length(_));
        let latent = self.method == Method::Joint && !measurements.force_n.is_empty();
        Identification {
            method: match self.method {
                Method::Joint => "joint",
                Method::Simple => "simple",
            }
            .to_owned(),
            converged: self.solution.converged(),
            iterations: self.solution.iterations,
            seconds: self.seconds,
            chi2: self.solution.chi2,
            dof: self.solution.degrees_of_freedom,
            p_value: self.solution.p_value(),
            entry_points_m: self.solution.globals.entry_points.clone(),
            entry_points_sd_m: (0..cables)
                .map(|cable| [0, 1, 2].map(|axis| entry_point_sd(self.solution, cable, axis)))
                .collect(),
            rms: Rms {
                length_m: self.analysis.rms(length),
                laser_m: self.analysis.rms(|kind| kind == ReadingKind::Laser),
                tension_n: self.analysis.tension_rms_n().filter(|_| latent),
            },
            poses: self
                .solution
                .poses
                .iter()
                .map(|(row, pose)| FittedPose {
                    pose: measurements.labels[*row],
                    position_m: pose.position.into(),
                    orientation_wxyz: pose.orientation_wxyz(),
                })
                .collect(),
            effects: self.effects(),
            undetermined: self.open.iter().map(|d| d.sentence.clone()).collect(),
            suspect_readings: self.suspects(),
        }
    }
}

/// What was read: `length of cable-3`.
#[must_use]
pub fn reading_name(robot: &Robot, kind: ReadingKind) -> String {
    let cable = |index: usize| robot.cables[index].name.as_str();
    let axis = |k: usize| ["x", "y", "z"][k];
    match kind {
        ReadingKind::Length(index) => format!("length of {}", cable(index)),
        ReadingKind::Equilibrium(c) => format!("tensions, balance of {}", c.describe()),
        ReadingKind::Laser => "laser distance".to_owned(),
        ReadingKind::Swivel(index) => format!("swivel angle of {}", cable(index)),
        ReadingKind::TrackerPosition(k) => format!("measured position {}", axis(k)),
        ReadingKind::TrackerOrientation(k) => format!("measured rotation about {}", axis(k)),
        ReadingKind::Inclination(k) => ["roll", "pitch", "yaw"][k].to_owned(),
    }
}
