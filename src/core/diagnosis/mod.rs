//! The model doctor: says whether a model explains the data, names what it gets wrong, extends it, and measures
//! what that gains.
//!
//! Everything rests on one linearisation of all readings at a solution
//! ([`crate::estimation::Linearisation`]): the posterior probabilities of sets of causes, errors without a name, the angle
//! between the signatures of two effects, and cross-validation. What is reported is fitted anew with the whole
//! nonlinear problem. docs/DIAGNOSIS.md has the equations.

mod adequacy;
#[cfg(test)]
mod adequacy_tests;
mod approach;
mod background;
mod candidates;
mod catalogue;
mod claims;
mod complete;
mod conditions;
mod confidence;
mod discrepancy;
mod doctor;
mod evidence;
mod exchange;
mod exploration;
mod families;
mod finding;
mod fit;
mod gain;
mod gram;
mod grouping;
mod hyperparameters;
mod inference;
mod isolability;
mod linear_fit;
mod noise;
mod progress;
mod reading_errors;
mod reading_id;
mod remainder;
mod report;
mod residual_space;
mod search;
mod separation;
mod space;
mod structure;
mod variables;

pub use discrepancy::smooth_functions;
pub use doctor::{MOST_SAMPLES, diagnose};
pub use isolability::{
    ExpectedFault, ExpectedPair, Isolability, is_confused, is_seen, isolability, log_odds,
};
pub use report::{
    Adequacy, Alternative, Cause, Diagnosis, Discrepancy, Evidence, Finding, FoundParameter, Gain,
    GlobalTest, GroupTest, Invisible, KindGain, NoiseStatement, PositionChange, Quantity, Rival,
    Separation, Verdict,
};

pub use variables::Variables;

use crate::estimation::Control;
pub use crate::measurement::Variable;

/// How to diagnose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiagnosisOptions {
    /// Probability of any finding in data that the model explains.
    pub alpha: f64,
    /// Most findings that are added one after the other.
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

/// What a running diagnosis is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Fitting the model without further effects.
    BaseFit,
    /// Asking on which readings and along which variables it is wrong.
    Discrepancy,
    /// Asking every effect on every target.
    Scores,
    /// Fitting the best of them completely.
    Refits,
    /// Comparing what they predict for poses held out.
    HeldOut,
    /// Looking for poses that would separate causes.
    Separation,
}

/// State of a running diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DiagnosisProgress {
    /// What it is about.
    pub stage: Stage,
    /// Findings so far.
    pub findings: usize,
}

/// Observer of a running diagnosis.
pub type Observer<'a> = dyn FnMut(&DiagnosisProgress) -> Control + 'a;

#[cfg(test)]
mod tests;
