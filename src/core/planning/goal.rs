//! Goals of a plan and their criteria of optimal design.
//!
//! With the information `I` on the geometry and the deviations of parts within stated tolerances, and `J` on these and faults
//! together, where the parameters of a fault have the prior of the catalogue, the poses maximise
//!
//! | goal | criterion |
//! |---|---|
//! | geometry | `ln det I - ln det K`, `K` the block of `I` that belongs to the deviations of parts within stated tolerances: that of the geometry with the deviations unknown (D-optimality) |
//! | faults | `ln det J - ln det I`: twice the expected information of the readings on the faults, in nats (Ds-optimality; Lindley, Annals of Mathematical Statistics 27, 1956) |
//! | both | `(ln det I - ln det K) / p + (ln det J - ln det I) / q` with `p` parameters of the geometry and `q` of faults: equal weights, whatever their numbers |
//! | accuracy | `-ln tr(M I^-1)`: minus the logarithm of the mean square position error of a controller over test poses in a volume (Klimchik, Wu, Caro, Furet, Pashkevich, Mechanism and Machine Theory 82, 2014) |
//!
//! Faults that look alike share the information of the readings, so the determinant rewards poses that separate them. Events
//! at one pose, and periodic errors of the laser distance, are left out: every pose reveals its own.

use nalgebra::DMatrix;

use crate::effect::{BoundEffect, CATALOGUE, Effect, Scope, Search};
use crate::estimation::{ExpectedInformation, covariance_of};
use crate::evidence::log_determinant;
use crate::geometry::Vec3;
use crate::robot::Robot;

/// Goal of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Goal {
    /// Determine the parameters of the robot well.
    #[default]
    Geometry,
    /// Detect and separate faults.
    Faults,
    /// Both.
    Both,
    /// Make the robot accurate in a volume once the parameters are written to its controller.
    Accuracy(Volume),
}

/// A box in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    /// Smallest coordinates (m).
    pub low_m: [f64; 3],
    /// Largest coordinates (m).
    pub high_m: [f64; 3],
}

impl Volume {
    /// Its centre (m).
    #[must_use]
    pub fn centre_m(&self) -> [f64; 3] {
        ((Vec3::from(self.low_m) + Vec3::from(self.high_m)) / 2.0).into()
    }

    /// Half its extent along each axis (m).
    #[must_use]
    pub fn half_extent_m(&self) -> [f64; 3] {
        ((Vec3::from(self.high_m) - Vec3::from(self.low_m)) / 2.0).into()
    }
}

impl Goal {
    /// Name in commands and files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Geometry => "geometry",
            Self::Faults => "faults",
            Self::Both => "both",
            Self::Accuracy(_) => "accuracy",
        }
    }

    /// Whether the goal needs the information on faults.
    pub(super) fn needs_faults(self) -> bool {
        matches!(self, Self::Faults | Self::Both)
    }
}

/// The faults that plans consider, at the values at which they are linearised.
pub(super) fn faults(robot: &Robot, known: &[BoundEffect]) -> Vec<BoundEffect> {
    let weighs = robot
        .cables
        .iter()
        .any(|cable| cable.cable.weight_n_per_m != 0.0);
    let is_asked = |effect: &&Effect| {
        // Massless cables have no sag to be computed.
        effect.search() == Search::Direct && effect.is_estimable() && (weighs || !effect.needs_sag)
    };
    let all: Vec<usize> = (0..robot.cable_count()).collect();
    let mut found: Vec<BoundEffect> = Vec::new();
    let hypotheses = robot.hypothesis_effects();
    let at_rest = hypotheses.filter(|effect| !effect.is_in_motion());
    for effect in CATALOGUE.iter().copied().chain(at_rest).filter(is_asked) {
        let bound = |cables: Vec<usize>, targeted: bool| BoundEffect {
            effect,
            cables,
            targeted,
            values: effect.parameters().iter().map(|p| p.start).collect(),
        };
        match effect.scope() {
            Scope::Robot => found.push(bound(all.clone(), false)),
            Scope::Cable | Scope::CableOrAll => {
                found.extend(all.iter().map(|cable| bound(vec![*cable], true)));
            }
            Scope::Pair => {}
        }
    }
    let is_known = |fault: &BoundEffect| known.iter().any(|k| k.effect.id() == fault.effect.id());
    found.retain(|fault| !is_known(fault));
    found
}

/// Criterion of a goal: larger for better poses.
pub(super) struct Criterion {
    pub terms: Vec<Term>,
}

/// A term of a criterion.
pub(super) struct Term {
    pub information: ExpectedInformation,
    pub kind: TermKind,
}

/// Kind of a term.
pub(super) enum TermKind {
    /// Weighted logarithm of the determinant of the information.
    Determinant(f64),
    /// Minus the logarithm of `tr(S^T I^-1 S)`, where `S S^T` are the weights of the parameters.
    Error(DMatrix<f64>),
}

impl Criterion {
    /// `faults` is the information on geometry and faults if the goal needs it, `weights` those of the volume.
    pub fn new(
        goal: Goal,
        geometry: &ExpectedInformation,
        faults: Option<ExpectedInformation>,
        weights: Option<&DMatrix<f64>>,
    ) -> Self {
        let term = |information: &ExpectedInformation, kind| Term {
            information: information.clone(),
            kind,
        };
        let determinant = TermKind::Determinant;
        let deviations = geometry.deviations();
        let of_deviations = |weight: f64| {
            (!deviations.is_empty()).then(|| Term {
                information: geometry.on(&deviations),
                kind: determinant(-weight),
            })
        };
        let terms = match (goal, faults, weights) {
            (Goal::Faults, Some(both), _) => {
                vec![
                    term(&both, determinant(1.0)),
                    term(geometry, determinant(-1.0)),
                ]
            }
            (Goal::Both, Some(both), _) => {
                let all = geometry.parameters.len();
                let own = all - deviations.len();
                let others = both.parameters.len() - all;
                let [own, others] = [own, others].map(|count| (count.max(1) as f64).recip());
                let mut terms = vec![
                    term(&both, determinant(others)),
                    term(geometry, determinant(own - others)),
                ];
                terms.extend(of_deviations(own));
                terms
            }
            (Goal::Accuracy(_), _, Some(weights)) => {
                vec![term(geometry, TermKind::Error(root(weights)))]
            }
            _ => {
                let mut terms = vec![term(geometry, determinant(1.0))];
                terms.extend(of_deviations(1.0));
                terms
            }
        };
        Self { terms }
    }

    /// Value for the picked poses; `None` if they leave parameters undetermined.
    pub fn value(&self, picked: &[usize]) -> Option<f64> {
        let mut sum = 0.0;
        for Term { information, kind } in &self.terms {
            let total = information.of(picked.iter().copied());
            sum += match kind {
                TermKind::Determinant(weight) => {
                    let factor = total.cholesky()?;
                    weight * log_determinant(&factor)
                }
                TermKind::Error(root) => {
                    let covariance = covariance_of(&total)?;
                    -(root.transpose() * covariance * root).trace().ln()
                }
            };
        }
        Some(sum)
    }
}

/// `S` with `S S^T` equal to the weights, without directions of zero weight.
fn root(weights: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = weights.clone().symmetric_eigen();
    let most = eigen.eigenvalues.max();
    let kept: Vec<_> = (eigen
        .eigenvectors
        .column_iter()
        .zip(eigen.eigenvalues.iter()))
    .filter(|(_, value)| **value > 1e-12 * most)
    .map(|(column, value)| column * value.sqrt())
    .collect();
    if kept.is_empty() {
        return DMatrix::zeros(weights.nrows(), 1);
    }
    DMatrix::from_columns(&kept)
}
