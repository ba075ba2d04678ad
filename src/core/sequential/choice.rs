//! The value of each further pose for the goals that are not reached yet.
//!
//! | goal | cost that is left (nats) | expected after one more pose |
//! |---|---|---|
//! | accuracy | sum over the coordinates of entry points of `ln(sd / limit)`, where positive | the same with the information of the pose added |
//! | cause, fault-free | entropy of the hypotheses: sets of causes, and faults of typical size that are not excluded | less the lower bound of the mutual information with the readings of the pose |
//!
//! For hypotheses with probabilities `p_i` and normal predictions, with `lambda_ij` the expected excess chi-square of `j` if `i` is
//! true, the mutual information is at least `- sum p_i ln sum p_j exp(-lambda_ij / 8)` (Kolchinsky and Tracey, Entropy 19 (2017) 361,
//! with the Bhattacharyya distance `lambda / 8` of normal distributions with the same covariance). It rises from zero to the entropy.
//!
//! The gain for a goal is the share of its cost that a pose is expected to remove; that of a pose is their sum over its time.

use nalgebra::{Cholesky, DMatrix, Dyn};

use super::assessment::Assessment;
use crate::diagnosis::{Cause, CauseSet, expected_separation};
use crate::estimation::{EstimationError, ExpectedInformation, ParameterId, covariance_of};
use crate::geometry::Pose;
use crate::measurement::Dataset;
use crate::planning::Prospects;

/// Number of sets of causes that are compared.
const MOST_SETS: usize = 3;
/// Smallest probability of a set that is compared.
const LEAST_SET: f64 = 0.02;
/// Number of the most probable faults that are not excluded yet and are considered.
const MOST_UNSEEN: usize = 24;

/// Indices of the coordinates of entry points.
fn entry_points(information: &ExpectedInformation) -> Vec<usize> {
    let is_entry = |k: &usize| {
        matches!(
            information.parameters[*k].id,
            ParameterId::EntryPoint { .. }
        )
    };
    (0..information.parameters.len()).filter(is_entry).collect()
}

/// Largest standard deviation of a coordinate of an entry point (m) for this information.
pub(super) fn largest_sd_m(of: &ExpectedInformation, total: &DMatrix<f64>) -> Option<f64> {
    let covariance = covariance_of(total)?;
    let sds = entry_points(of)
        .into_iter()
        .map(|k| covariance[(k, k)].sqrt());
    sds.reduce(f64::max).filter(|sd_m| sd_m.is_finite())
}

/// Cost that is left for an accuracy (nats).
fn excess_over(limit_m: f64, of: &ExpectedInformation, total: &DMatrix<f64>) -> Option<f64> {
    let covariance = covariance_of(total)?;
    let excess = |k: usize| (0.5 * covariance[(k, k)].ln() - limit_m.ln()).max(0.0);
    Some(entry_points(of).into_iter().map(excess).sum())
}

/// The coordinate of an entry point with the largest standard deviation: its cable.
pub(super) fn worst_cable(of: &ExpectedInformation) -> Option<usize> {
    let covariance = covariance_of(&of.common)?;
    let entry = entry_points(of).into_iter();
    let worst = entry.max_by(|a, b| covariance[(*a, *a)].total_cmp(&covariance[(*b, *b)]))?;
    match of.parameters[worst].id {
        ParameterId::EntryPoint { cable, .. } => Some(cable),
        _ => None,
    }
}

/// Share of the cost for an accuracy that each pose removes.
pub(super) fn gains_of_accuracy(limit_m: f64, of: &ExpectedInformation) -> Vec<f64> {
    let Some(now) = excess_over(limit_m, of, &of.common).filter(|now| *now > 0.0) else {
        // Nothing is determined yet, so that the determinant decides.
        return of.poses.iter().map(|rows| rows.norm_squared()).collect();
    };
    let gain = |index: usize| {
        let after = excess_over(limit_m, of, &of.of([index]));
        after.map_or(0.0, |after| (now - after) / now)
    };
    (0..of.poses.len()).map(gain).collect()
}

/// Sets of causes and faults between which the poses have to decide.
#[derive(Debug, Clone)]
pub(super) struct Hypotheses {
    /// Number of poses.
    poses: usize,
    /// Probabilities: sets of causes, then faults that are not excluded beside the first set.
    probabilities: Vec<f64>,
    /// The sets.
    pub sets: Vec<Vec<Cause>>,
    /// The faults.
    pub unseen: Vec<Cause>,
    /// `lambda` of each pair of sets, in the order of [`expected_separation`], at each pose.
    of_sets: Vec<Vec<f64>>,
    /// `lambda` of each fault at each pose.
    of_unseen: Vec<Vec<f64>>,
}

impl Hypotheses {
    pub fn new(
        dataset: &Dataset,
        assessment: &Assessment,
        prospects: &Prospects,
    ) -> Result<Self, EstimationError> {
        let is_compared = |set: &&CauseSet| set.probability >= LEAST_SET;
        let sets = assessment.sets.iter().take(MOST_SETS).filter(is_compared);
        let (mut sets, mut probabilities): (Vec<_>, Vec<_>) = sets
            .map(|set| (set.causes.clone(), set.probability))
            .unzip();
        if assessment.has_exchanged_channels() || sets.is_empty() {
            (sets, probabilities) = (vec![Vec::new()], vec![1.0]);
        }
        let views: Vec<&[Cause]> = sets.iter().map(Vec::as_slice).collect();
        let of_sets = match views.len() {
            1 => Vec::new(),
            _ => expected_separation(dataset, &views, &prospects.poses)?,
        };
        let poses = prospects.poses.len();
        let of_sets: Vec<Vec<f64>> = (of_sets.into_iter())
            .map(|pair| pair.unwrap_or_else(|| vec![0.0; poses]))
            .collect();
        let faults = FaultSignatures::new(prospects);
        let mut unseen = Vec::new();
        let mut of_unseen = Vec::new();
        for fault in assessment.unseen.iter().take(MOST_UNSEEN) {
            let Some(lambda) = faults.as_ref().and_then(|all| all.at_poses(&fault.cause)) else {
                continue;
            };
            probabilities.push(probabilities[0] * fault.odds);
            unseen.push(fault.cause.clone());
            of_unseen.push(lambda);
        }
        let total: f64 = probabilities.iter().sum();
        probabilities.iter_mut().for_each(|p| *p /= total);
        Ok(Self {
            poses,
            probabilities,
            sets,
            unseen,
            of_sets,
            of_unseen,
        })
    }

    /// `lambda` of two hypotheses at a pose.
    fn lambda(&self, (one, other): (usize, usize), pose: usize) -> f64 {
        let (low, high) = (one.min(other), one.max(other));
        let count = self.sets.len();
        if low == high {
            return 0.0;
        }
        if high < count {
            let before: usize = (0..low).map(|k| count - 1 - k).sum();
            return self.of_sets[before + high - low - 1][pose];
        }
        let own = self.of_unseen[high - count][pose];
        match low.checked_sub(count) {
            // Different faults are taken to change different readings.
            Some(low) => own + self.of_unseen[low][pose],
            None => own,
        }
    }

    /// Entropy (nats).
    fn entropy(&self) -> f64 {
        let terms = self.probabilities.iter().filter(|p| **p > 0.0);
        terms.map(|p| -p * p.ln()).sum()
    }

    /// Lower bound of the mutual information with the readings of a pose that is measured `times` times (nats).
    fn information(&self, pose: usize, times: f64) -> f64 {
        let count = self.probabilities.len();
        let seen = |one: usize| {
            let alike = (0..count).map(|other| {
                self.probabilities[other] * (-times * self.lambda((one, other), pose) / 8.0).exp()
            });
            -self.probabilities[one] * alike.sum::<f64>().max(f64::MIN_POSITIVE).ln()
        };
        (0..count).map(seen).sum()
    }

    /// Share of the entropy that each pose removes.
    pub fn gains(&self) -> Vec<f64> {
        let entropy = self.entropy();
        if entropy <= 0.0 {
            return vec![0.0; self.poses];
        }
        (0..self.poses)
            .map(|pose| self.information(pose, 1.0) / entropy)
            .collect()
    }

    /// The rival of the first hypothesis that a pose makes least probable: the index of a set, or of a fault after them.
    pub fn rival_at(&self, pose: usize) -> Option<usize> {
        let removed = |other: &usize| {
            let left = (-self.lambda((0, *other), pose) / 8.0).exp();
            self.probabilities[*other] * (1.0 - left)
        };
        let rivals = (1..self.probabilities.len()).filter(|other| removed(other) > 0.0);
        rivals.max_by(|a, b| removed(a).total_cmp(&removed(b)))
    }

    /// The most probable set that no pose, measured `times` times, tells from the first one by `decisive` of chi-square. A set with
    /// causes in addition is none: if they are not there, more readings make them smaller until they are no longer worth their prior.
    pub fn inseparable(&self, times: f64, decisive: f64) -> Option<usize> {
        let [first, ..] = self.sets.as_slice() else {
            return None;
        };
        (1..self.sets.len()).find(|other| {
            let set = &self.sets[*other];
            let most = (0..self.poses).map(|pose| self.lambda((0, *other), pose));
            let is_other = !contains(first, set) && !contains(set, first);
            is_other && most.fold(0.0, f64::max) * times < decisive
        })
    }
}

/// Whether one set has every effect of another on the same cables.
fn contains(all: &[Cause], some: &[Cause]) -> bool {
    let of = |set: &[Cause]| -> Vec<(&str, Vec<usize>)> {
        let instances = set.iter().flat_map(|cause| &cause.instances);
        instances
            .map(|bound| (bound.effect.id(), bound.cables.clone()))
            .collect()
    };
    let all = of(all);
    of(some).iter().all(|one| all.contains(one))
}

/// Signatures of faults of typical size at the poses, with the geometry estimated anew for each fault.
struct FaultSignatures<'p> {
    prospects: &'p Prospects,
    /// Indices of the parameters of the geometry.
    geometry: Vec<usize>,
    of_geometry: Cholesky<f64, Dyn>,
    /// For each pose, the rows of the geometry and the factor of `1 + R C R^T`, with the covariance `C` of the geometry.
    poses: Vec<(DMatrix<f64>, Cholesky<f64, Dyn>)>,
}

impl<'p> FaultSignatures<'p> {
    fn new(prospects: &'p Prospects) -> Option<Self> {
        let all = &prospects.with_faults;
        let is_fault = |k: &usize| match all.parameters[*k].id {
            ParameterId::Effect { effect, .. } => effect >= prospects.first_fault,
            _ => false,
        };
        let geometry: Vec<usize> = (0..all.parameters.len()).filter(|k| !is_fault(k)).collect();
        let information = all.common.select_rows(&geometry).select_columns(&geometry);
        let of_geometry = information.cholesky()?;
        let of_pose = |rows: &DMatrix<f64>| {
            let own = rows.select_columns(&geometry);
            let mut covariance = &own * of_geometry.solve(&own.transpose());
            for k in 0..covariance.nrows() {
                covariance[(k, k)] += 1.0;
            }
            Some((own, covariance.cholesky()?))
        };
        Some(Self {
            poses: all.poses.iter().map(of_pose).collect::<Option<_>>()?,
            prospects,
            geometry,
            of_geometry,
        })
    }

    /// `lambda` of a fault at each pose; `None` for one that is not part of a plan, such as an event.
    fn at_poses(&self, fault: &Cause) -> Option<Vec<f64>> {
        let [bound] = fault.instances.as_slice() else {
            return None;
        };
        let known = self.prospects.faults.iter().position(|known| {
            known.effect.id() == bound.effect.id()
                && known.targeted == bound.targeted
                && known.cables == bound.cables
        })?;
        let all = &self.prospects.with_faults;
        let own = self.prospects.first_fault + known;
        let mut size = DMatrix::zeros(all.parameters.len(), 1);
        for (k, parameter) in all.parameters.iter().enumerate() {
            if let ParameterId::Effect {
                effect,
                parameter: index,
            } = parameter.id
                && effect == own
            {
                size[k] = bound.values[index] - bound.effect.parameters()[index].neutral;
            }
        }
        let pull = (&all.common * &size).select_rows(&self.geometry);
        let adapted = self.of_geometry.solve(&pull);
        let mut at_poses = Vec::with_capacity(self.poses.len());
        for ((own, factor), rows) in self.poses.iter().zip(&all.poses) {
            let left = rows * &size - own * &adapted;
            at_poses.push(left.dot(&factor.solve(&left)));
        }
        Some(at_poses)
    }
}

/// Index of the best pose, and its gain: the gains of all goals over the time of the pose, where a move across the whole workspace takes
/// as long as a measurement.
pub(super) fn best(
    gains: &[Vec<f64>],
    poses: &[Pose],
    from: &Pose,
    across_m: f64,
) -> Option<(usize, f64)> {
    let gain = |pose: usize| gains.iter().map(|of| of[pose]).sum::<f64>();
    let time = |pose: usize| {
        1.0 + (poses[pose].position - from.position).norm() / across_m.max(f64::MIN_POSITIVE)
    };
    let value = |pose: &usize| gain(*pose) / time(*pose);
    let best = (0..poses.len()).max_by(|a, b| value(a).total_cmp(&value(b)).then(b.cmp(a)))?;
    Some((best, gain(best)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_hypothesis_gives_poses_no_gain() {
        let alone = Hypotheses {
            poses: 3,
            probabilities: vec![1.0],
            sets: vec![Vec::new()],
            unseen: Vec::new(),
            of_sets: Vec::new(),
            of_unseen: Vec::new(),
        };
        assert_eq!(alone.gains(), [0.0; 3]);
        assert_eq!(alone.rival_at(2), None);
        assert_eq!(alone.inseparable(10.0, 9.0), None);
    }
}
