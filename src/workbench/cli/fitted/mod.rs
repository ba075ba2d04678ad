//! A solved problem in the forms in which it is shown: JSON, model file, report.

mod document;
mod model;
mod report;
mod solving;

use tautline_core::estimation::{
    Analysis, Deficiency, Method, ParameterId, Problem, ReadingKind, Solution,
};
use tautline_core::robot::Robot;

pub use document::{FittedEffect, FittedPose, Identification, Rms};
use model::entry_point_sd;
pub use model::identified;
pub use report::print_report;
pub use solving::{refuse_extrapolation, timed};

/// A solved problem.
pub struct Fitted<'a> {
    problem: Problem<'a>,
    solution: Solution,
    analysis: Analysis,
    open: Vec<Deficiency>,
    seconds: f64,
    /// Where the drawing has the entry points (m).
    drawn_m: Vec<[f64; 3]>,
}

/// Level for all readings together at which single readings are called suspect.
const SUSPECT_LEVEL: f64 = 0.01;

impl Fitted<'_> {
    fn robot(&self) -> &Robot {
        &self.problem.dataset.robot
    }

    fn effects(&self) -> Vec<FittedEffect> {
        let held = self.problem.held_effects.len();
        let mut effects = Vec::new();
        for (index, parameter) in self.solution.parameters.iter().enumerate() {
            let ParameterId::Effect {
                effect,
                parameter: which,
            } = parameter.id
            else {
                continue;
            };
            let bound = &self.solution.globals.effects[held + effect];
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

    /// Suspect readings in words.
    fn suspects(&self) -> Vec<String> {
        let labels = &self.problem.dataset.measurements.labels;
        let suspects = self.analysis.suspects(SUSPECT_LEVEL);
        let words = |reading: &tautline_core::estimation::Reading| {
            let size = reading.normalised().unwrap_or(f64::NAN);
            let what = self.reading_name(reading.kind);
            format!(
                "pose {}, {what}: off by {size:+.1} standard deviations",
                labels[reading.row]
            )
        };
        suspects.iter().map(words).collect()
    }

    fn reading_name(&self, kind: ReadingKind) -> String {
        let cable = |index: usize| self.robot().cables[index].name.as_str();
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

    /// Machine form.
    pub fn identification(&self) -> Identification {
        let labels = &self.problem.dataset.measurements.labels;
        let cables = self.robot().cable_count();
        let length = |kind| matches!(kind, ReadingKind::Length(_));
        let latent = self.problem.has_latent_tension();
        Identification {
            method: match self.problem.method {
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
                .map(|cable| [0, 1, 2].map(|axis| entry_point_sd(&self.solution, cable, axis)))
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
                    pose: labels[*row],
                    position_m: pose.position.into(),
                    orientation_wxyz: pose.orientation_wxyz(),
                })
                .collect(),
            effects: self.effects(),
            undetermined: self.open.iter().map(|d| d.sentence.clone()).collect(),
            suspect_readings: self.suspects(),
        }
    }

    /// The robot with the identified values; standard deviations become those of the solution.
    pub fn model(&self) -> Robot {
        identified(self.robot(), &self.solution)
    }
}
