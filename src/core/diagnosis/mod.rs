//! Model diagnosis: tests whether a model explains the data, names the effects that it lacks, extends it by them and
//! quantifies the gain.
//!
//! All computations use one linearisation of the readings at a solution ([`crate::estimation::Linearisation`]):
//! posterior probabilities of sets of causes, unmodelled errors, and cross-validation. Reported values come from a new
//! fit of the full nonlinear problem. The equations are in docs/DIAGNOSIS.md.

mod adequacy;
#[cfg(test)]
mod adequacy_tests;
mod background;
mod budget;
mod calibration;
mod candidates;
mod catalogue;
mod cause_posteriors;
mod cause_sets;
mod conditions;
mod confidence;
mod dense;
mod deviation_columns;
mod deviation_sensitivity;
mod discrepancy;
mod doctor;
mod drawing;
mod error_functions;
mod evidence;
mod exchange;
mod exploration;
mod finding;
mod fit;
mod fitted_problem;
mod gain;
mod gram;
mod grouping;
mod heavy_tails;
mod hyperparameters;
mod inference;
mod initial_fit;
mod isolability;
mod linear_fit;
mod noise;
mod normal_points;
mod priors;
mod progress;
mod projector;
mod reading_errors;
mod reading_id;
mod reduced_problem;
mod relations;
mod report;
mod residual_space;
mod search;
mod separation;
mod set_comparison;
mod single_cause;
mod size_posterior;
mod slack;
mod structured_errors;
mod unmodelled_errors;
mod unseen;
mod variables;

pub use budget::MOST_DIAGNOSED_ROWS;
pub use calibration::{NAMING_PROBABILITY, stated_probability};
pub use deviation_sensitivity::{DeviationSensitivity, deviation_sensitivities};
pub use discrepancy::smooth_functions;
pub use doctor::diagnose;
pub use drawing::{DrawingPattern, WrongDrawing};
pub use isolability::{
    ExpectedFault, ExpectedPair, Isolability, ShownFault, is_confused, is_seen, isolability,
    log_odds, shown_faults,
};
pub use priors::EXPECTED_CAUSES;
pub use reading_id::ReadingId;
pub use report::{
    Adequacy, Alternative, Cause, CauseSet, Diagnosis, Discrepancy, ErrorForm, Evidence, Finding,
    FoundParameter, Gain, GlobalTest, GroupTest, Invisible, KindGain, NoiseStatement,
    PositionChange, PossibleCause, Quantity, Rival, Separation, SlackCable, Subject,
    ToleranceFactor, UnmodelledError, UnseenFault, Verdict,
};

pub use separation::expected_separation;
pub use single_cause::{SingleCause, single_causes};
pub use variables::Variables;

use crate::estimation::Control;
pub use crate::measurement::Variable;

/// Options of a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiagnosisOptions {
    /// Significance level of the tests of the residuals: probability that they reject a model that explains the data, or
    /// find an error in it. The posterior probabilities of causes do not depend on it.
    pub alpha: f64,
    /// Maximum number of findings.
    pub most_findings: usize,
}

impl Default for DiagnosisOptions {
    fn default() -> Self {
        Self {
            alpha: 0.01,
            most_findings: 12,
        }
    }
}

/// Stage of a running diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Fits the model without additional effects.
    BaseFit,
    /// Tests on which variables the residuals depend.
    Discrepancy,
    /// Scores every effect on every target.
    Scores,
    /// Fits the most probable sets with the full model.
    Refits,
    /// Compares predictions of held-out poses.
    HeldOut,
    /// Looks for poses that would tell causes apart.
    Separation,
}

/// Progress of a running diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DiagnosisProgress {
    /// Current stage.
    pub stage: Stage,
    /// Number of findings so far.
    pub findings: usize,
}

/// Callback that observes a running diagnosis and may cancel it.
pub type Observer<'a> = dyn FnMut(&DiagnosisProgress) -> Control + 'a;

#[cfg(test)]
mod tests;
