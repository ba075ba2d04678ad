//! Candidate causes: every effect of the catalogue on every target, with its columns and its prior.
//!
//! A candidate is an effect on one cable, on all cables with common parameters, or on each cable with parameters of its
//! own. An event that may have happened at any of `N` poses, or a wave of any of `N` periods, makes `N` candidates that
//! share one prior probability. Columns are derivatives of the readings at the value without effect; the columns of
//! events and waves are one derivative, the generator, multiplied by a weight for each pose.

use nalgebra::DMatrix;

use super::priors::{ATYPICAL_SHARE, RELATIVE_SD, SCALE_RATIO};
use super::relations::{
    is_same_effect_and_targets, is_same_kind, is_same_place, place_of, place_parameter,
};
use super::report::Cause;
use crate::effect::{Effect, EffectParameter, Scope, Search, amplitude_of};
use crate::robot::Robot;

/// Dependence of the effect of a generator on the pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum PoseWeights {
    /// The same at all poses.
    Everywhere,
    /// Only at the pose with this index among those fitted.
    At(usize),
    /// From the pose with this index on.
    From(usize),
    /// Multiplied by the sine or cosine of an angle that turns once per period (m).
    Wave { period: f64, cosine: bool },
}

/// A column of the linearised problem: a generator with its weights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CandidateColumn {
    pub generator: usize,
    pub pose_weights: PoseWeights,
}

/// A candidate cause.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    /// Effect and targets, with the parameters at their start values.
    pub cause: Cause,
    /// Bit mask of the targeted cables; 0 for an effect of the whole robot.
    pub cables: u64,
    /// Label of the pose of an event, or period of a wave; NaN for other effects.
    pub place: f64,
    pub columns: Vec<CandidateColumn>,
    /// Factor `F` of the prior covariance `F F^T` of the coordinates at scale 1.
    pub prior: DMatrix<f64>,
    /// Factors of `prior`, the scales of the size prior, each with its log probability.
    pub scales: Vec<(f64, f64)>,
    /// Whether the parameter cannot be negative.
    pub is_positive: bool,
    /// Log prior odds.
    pub log_odds: f64,
    /// Logarithm of the number of poses or periods that share the prior probability of the cause.
    pub log_places: f64,
}

impl Candidate {
    pub fn effect(&self) -> &'static Effect {
        self.cause.effect()
    }

    /// Generator of each column.
    pub fn generators(&self) -> Vec<usize> {
        self.columns.iter().map(|c| c.generator).collect()
    }

    pub fn is_event(&self) -> bool {
        self.effect().pose_parameter().is_some()
    }

    /// Whether this is an effect on several cables with one value for each.
    pub fn is_family(&self) -> bool {
        self.cause.instances.len() > 1
    }

    /// Whether this is a permanent effect on a single cable.
    pub fn is_single(&self) -> bool {
        let bound = &self.cause.instances[0];
        !self.is_family()
            && bound.targeted
            && bound.cables.len() == 1
            && bound.effect.search() == Search::Direct
    }

    /// Whether this is an effect on all cables with one common value.
    fn is_common(&self) -> bool {
        self.effect().scope() == Scope::CableOrAll && !self.cause.instances[0].targeted
    }

    /// Whether this candidate represents a cause, whatever its values: the same effect and targets, and the same pose
    /// or period.
    pub fn represents(&self, cause: &Cause) -> bool {
        let place = place_of(&cause.instances[0]);
        is_same_effect_and_targets(&self.cause, cause) && (place.is_nan() || place == self.place)
    }

    /// Whether this candidate and another cannot be in one set because they describe the same property of a cable.
    pub fn excludes(&self, other: &Self) -> bool {
        let overlap = self.cables & other.cables != 0 || self.cables == other.cables;
        if std::ptr::eq(self.effect(), other.effect()) {
            // A single cable may deviate from a value that all cables share.
            let is_more =
                self.is_common() != other.is_common() && !self.is_family() && !other.is_family();
            let is_here = is_same_place(self.effect(), self.place, other.place, 0.0);
            return overlap && !is_more && is_here;
        }
        is_same_kind(self.effect(), other.effect()) && (self.is_family() || other.is_family())
    }

    /// The cause with the parameter values that correspond to an estimate of its coordinates.
    pub fn estimated(&self, estimate: &[f64]) -> Cause {
        let mut cause = self.cause.clone();
        let mut numbers = estimate.iter().copied();
        let mut next = || numbers.next().unwrap_or(0.0);
        for bound in &mut cause.instances {
            match bound.effect.search() {
                Search::Wave { phase, period } => {
                    let (a, b) = (next(), next());
                    bound.values[amplitude_of(phase, period)] = a.hypot(b);
                    bound.values[phase] = b.atan2(a);
                    if let Some(period) = period {
                        bound.values[period] = self.place;
                    }
                }
                _ => {
                    for k in bound.effect.estimable() {
                        let parameter = &bound.effect.parameters()[k];
                        bound.values[k] = parameter.neutral + distance(parameter, next());
                    }
                    if let Some(k) = place_parameter(bound.effect) {
                        bound.values[k] = self.place;
                    }
                }
            }
        }
        cause
    }

    /// The cause with its pose or period set and the other parameters at their start values.
    pub fn placed(&self) -> Cause {
        let mut cause = self.cause.clone();
        for bound in &mut cause.instances {
            if let Some(k) = place_parameter(bound.effect) {
                bound.values[k] = self.place;
            }
        }
        cause
    }

    /// The cause at typical size.
    pub fn typical(&self) -> Cause {
        let mut cause = self.placed();
        for bound in &mut cause.instances {
            *bound = bound.at_typical_size();
        }
        cause
    }

    /// The scale of the prior nearest to the size of some coordinates.
    pub fn nearest_scale(&self, coordinates: &[f64]) -> usize {
        let size = |k: usize| coordinates[k].abs() / self.prior.row(k).norm();
        let largest = (0..coordinates.len()).map(size).fold(1e-9, f64::max);
        let off = |k: &usize| (self.scales[*k].0 / largest).ln().abs();
        let places = 0..self.scales.len();
        places.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
    }

    /// Coordinates of a cause in this candidate's columns: the inverse of [`Self::estimated`].
    pub fn coordinates(&self, cause: &Cause) -> Vec<f64> {
        let mut numbers = Vec::new();
        for bound in &cause.instances {
            if let Search::Wave { phase, period } = bound.effect.search() {
                let amplitude = bound.values[amplitude_of(phase, period)];
                let (sine, cosine) = bound.values[phase].sin_cos();
                numbers.extend([amplitude * cosine, amplitude * sine]);
                continue;
            }
            for k in bound.effect.estimable() {
                let parameter = &bound.effect.parameters()[k];
                let value = bound.values[k] - parameter.neutral;
                let probe = probe_offset(parameter);
                numbers.push(if probe == 0.0 {
                    value
                } else {
                    // The effect is quadratic here, so the square is expressed in steps of the derivative at the probe.
                    value * value / (2.0 * (value + probe))
                });
            }
        }
        numbers
    }
}

/// Offset from the neutral value at which a parameter is differentiated. It is not zero for parameters on which nothing
/// depends at first order.
pub(super) fn probe_offset(parameter: &EffectParameter) -> f64 {
    0.1 * (parameter.start - parameter.neutral)
}

/// Distance from the neutral value for a linear step from the probe. A parameter without a first-order effect acts by
/// its square.
fn distance(parameter: &EffectParameter, step: f64) -> f64 {
    let probe = probe_offset(parameter);
    if probe == 0.0 {
        return step;
    }
    let square = (probe * probe + 2.0 * probe * step).max(0.0);
    square.sqrt().max(parameter.start - parameter.neutral)
}

/// The parameter that measures the size of an effect.
pub(super) fn size_parameter(effect: &'static Effect) -> Option<&'static EffectParameter> {
    let index = match effect.search() {
        Search::Wave { phase, period } => Some(amplitude_of(phase, period)),
        _ => effect.estimable().next(),
    };
    index.map(|k| &effect.parameters()[k])
}

/// Scales of the size prior relative to the largest typical size, with their log probabilities: uniform over the orders
/// of magnitude of typical sizes, with a small share beyond.
pub(super) fn scales(parameter: &EffectParameter) -> Vec<(f64, f64)> {
    let [least, largest] = parameter.typical_sizes();
    let mut sizes = vec![1.0];
    while sizes[sizes.len() - 1] * largest > 2.0 * least.max(1e-3 * largest) {
        sizes.push(sizes[sizes.len() - 1] / SCALE_RATIO);
    }
    let each = ((1.0 - ATYPICAL_SHARE) / sizes.len() as f64).ln();
    let mut scales: Vec<_> = sizes.into_iter().map(|size| (size, each)).collect();
    if parameter.bounds == [f64::NEG_INFINITY, f64::INFINITY] || parameter.bounds[0] == 0.0 {
        scales.push((SCALE_RATIO, ATYPICAL_SHARE.ln()));
    }
    scales
}

/// Log ratio of the prior densities at the largest typical size and at a size, given as a multiple of that.
pub(super) fn log_rarity(parameter: &EffectParameter, size: f64) -> f64 {
    let density = |size: f64| {
        let weighted = |(scale, log_amplitude_prior): (f64, f64)| {
            log_amplitude_prior.exp() / scale
                * (-0.5 * (size / (RELATIVE_SD * scale)).powi(2)).exp()
        };
        scales(parameter).into_iter().map(weighted).sum::<f64>()
    };
    density(1.0).ln() - density(size.max(1.0)).max(f64::MIN_POSITIVE).ln()
}

/// Prior standard deviation of a linear step of a parameter of a robot whose present distance from its neutral value is `present`.
pub(super) fn prior_sd(parameter: &EffectParameter, robot: &Robot, present: f64) -> f64 {
    let largest = parameter.largest_in(robot);
    let probe = probe_offset(parameter);
    let sd = RELATIVE_SD * largest;
    if probe == 0.0 {
        sd
    } else {
        largest * sd / (2.0 * (present + probe))
    }
}
