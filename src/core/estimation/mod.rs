//! Identification: estimates the geometry of a robot and the size of effects from measurements.
//!
//! [`Problem`] states what is estimated from which data, [`solve`] finds the weighted least-squares estimate, and [`Solution`]
//! holds it with its covariance. [`Analysis`] evaluates the residuals, [`rank_defects`] names what the data leave
//! undetermined; [`Linearisation`] and [`ExpectedInformation`] provide the matrices.

mod analysis;
mod budget;
mod covariance;
mod distances;
mod evaluated;
mod evaluator;
mod expected;
mod globals;
mod home;
mod linearisation;
mod observation;
mod options;
mod parameter;
mod parameterisation;
mod problem;
pub mod published;
mod rank;
mod residuals;
mod solution;
mod solver;
mod start;
mod surface;
mod system;

pub use analysis::{Analysis, SUSPECT_LEVEL};
pub use budget::{
    CovarianceBySource, UncertaintyBudget, UncertaintyContribution, UncertaintySource,
};
pub use covariance::covariance_of;
pub use expected::{ExpectedDistances, ExpectedInformation};
pub use globals::Globals;
pub use linearisation::{LinearRow, Linearisation, PoseBlock, RowKind};
pub use observation::{
    DetectionTest, EntryPointSensitivity, Observation, ObservationKind, Reliability,
};
pub use options::{Control, Division, Options, Progress, Termination};
pub use parameter::{Parameter, ParameterId};
pub use problem::{Geometry, Loss, Method, Poses, Problem};
pub use rank::{RankDefect, rank_defects};
pub(crate) use residuals::residuals_in;
pub use residuals::{RowResidual, residuals_at};
pub use solution::{OutsideSurface, Solution};
pub use solver::solve;

use crate::effect::EffectError;

/// Errors of setting up an estimation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EstimationError {
    /// An effect cannot be attached.
    #[error(transparent)]
    Effect(#[from] EffectError),
    /// Revolutions were measured, but the robot has no home pose.
    #[error("revolutions were measured, but the robot has no home pose from which they count")]
    NoHome,
    /// The home row is missing.
    #[error("the measurements have no row of the home pose (label 0)")]
    NoHomeRow,
    /// A tension at home is missing.
    #[error(
        "the tension of cable \"{0}\" was not read at the home pose, from which its length counts"
    )]
    NoHomeTension(String),
    /// There is no pose to fit.
    #[error("there is no pose to fit besides the home pose")]
    NoPoses,
    /// No cable lengths were measured.
    #[error("neither revolutions nor lengths of the cables were measured")]
    NoLengths,
    /// No reading depends on an effect.
    #[error("effect \"{0}\" cannot be estimated: none of the readings depends on it")]
    Unobservable(String),
}

#[cfg(test)]
mod tests;
