//! Expected standard deviations of a set of poses, and criteria of optimal design.

use nalgebra::{DMatrix, SymmetricEigen};
use rand::SeedableRng;
use rand::seq::index::sample;
use rand_chacha::ChaCha8Rng;

use crate::estimation::{ExpectedInformation, Parameter, ParameterId, covariance_of};

/// Number of random sets for comparison.
const SETS: usize = 20;

/// Criteria of optimal design of a set of poses (Atkinson, Donev, Tobias, Optimum Experimental Designs, 2007).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesignCriteria {
    /// D: `ln det` of the information on all parameters (SI units); only differences are meaningful. An increase of one per
    /// parameter reduces the variance by a factor `e` on average.
    pub log_det: f64,
    /// E: standard deviation of the entry points along their worst common direction (m).
    pub worst_m: Option<f64>,
    /// A: root mean square standard deviation of the entry points' coordinates (m).
    pub mean_m: Option<f64>,
    /// I: root mean square position error of the platform over the workspace, or over the volume of the plan's goal, that
    /// results from the standard deviations once the values are written to a controller (m), at the orientation of its centre,
    /// neglecting changes of the tensions. `None` also for robots without a home pose.
    pub platform_m: Option<f64>,
}

/// Expected standard deviations after a set of poses has been measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Expectation {
    /// Standard deviation of each parameter (SI units), in the order of [`super::Plan::parameters`]; `None` where the
    /// poses do not determine the parameters.
    pub sd: Vec<Option<f64>>,
    /// Criteria of optimal design.
    pub criteria: DesignCriteria,
}

/// The criteria that are cheap to compute, without eigenvalues or determinants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// As [`DesignCriteria::mean_m`] (m).
    pub mean_m: Option<f64>,
    /// As [`DesignCriteria::platform_m`] (m).
    pub platform_m: Option<f64>,
}

impl Accuracy {
    /// Accuracy for a covariance of all parameters.
    pub(super) fn of(
        parameters: &[Parameter],
        platform: Option<&DMatrix<f64>>,
        covariance: Option<&DMatrix<f64>>,
    ) -> Self {
        let mean = |covariance: &DMatrix<f64>| {
            let picked = entry_points(parameters);
            let trace: f64 = picked.iter().map(|k| covariance[(*k, *k)]).sum();
            (!picked.is_empty()).then(|| (trace / picked.len() as f64).sqrt())
        };
        Self {
            mean_m: covariance.and_then(mean),
            platform_m: (platform.zip(covariance))
                .map(|(weights, covariance)| weights.dot(covariance).max(0.0).sqrt()),
        }
    }
}

impl Expectation {
    /// Expectation for the picked poses together with all prior information.
    pub(super) fn of(
        information: &ExpectedInformation,
        platform: Option<&DMatrix<f64>>,
        picked: impl IntoIterator<Item = usize>,
    ) -> Self {
        let total = information.of(picked);
        let covariance = covariance_of(&total);
        let sd = |k: usize| covariance.as_ref().map(|c| c[(k, k)].sqrt());
        let entry = covariance
            .as_ref()
            .and_then(|c| of_entry_points(&information.parameters, c));
        let accuracy = Accuracy::of(&information.parameters, platform, covariance.as_ref());
        Self {
            sd: (0..information.parameters.len()).map(sd).collect(),
            criteria: DesignCriteria {
                log_det: log_det(&total) - log_det(&block(&total, &information.deviations())),
                worst_m: entry.as_ref().map(|c| {
                    let eigen = SymmetricEigen::new(c.clone());
                    eigen.eigenvalues.max().max(0.0).sqrt()
                }),
                mean_m: accuracy.mean_m,
                platform_m: accuracy.platform_m,
            },
        }
    }

    /// Standard deviations of a cable's entry point (m); `None` along an axis that is not estimated or not determined.
    #[must_use]
    pub fn entry_point_sd_m(&self, parameters: &[Parameter], cable: usize) -> [Option<f64>; 3] {
        [0, 1, 2].map(|axis| {
            let id = ParameterId::EntryPoint { cable, axis };
            let index = parameters.iter().position(|p| p.id == id)?;
            self.sd.get(index).copied().flatten()
        })
    }
}

fn log_det(information: &DMatrix<f64>) -> f64 {
    let factor = information.clone().cholesky();
    factor.map_or(f64::NEG_INFINITY, |factor| {
        let pivots = factor.l_dirty().diagonal();
        2.0 * pivots.iter().map(|pivot| pivot.ln()).sum::<f64>()
    })
}

fn block(matrix: &DMatrix<f64>, picked: &[usize]) -> DMatrix<f64> {
    matrix.select_rows(picked).select_columns(picked)
}

/// Block of a covariance that belongs to the entry points.
fn of_entry_points(parameters: &[Parameter], covariance: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let picked = entry_points(parameters);
    (!picked.is_empty()).then(|| block(covariance, &picked))
}

/// Indices of the entry points' coordinates.
fn entry_points(parameters: &[Parameter]) -> Vec<usize> {
    let is_entry = |k: &usize| matches!(parameters[*k].id, ParameterId::EntryPoint { .. });
    (0..parameters.len()).filter(is_entry).collect()
}

/// Expectations for poses drawn at random.
pub(super) struct RandomSets {
    /// Root mean square of the standard deviations, and means of the criteria.
    pub typical: Expectation,
    pub best_log_det: f64,
}

/// Expectations for sets of `count` poses drawn from all candidates.
pub(super) fn random_sets(
    (information, platform): (&ExpectedInformation, Option<&DMatrix<f64>>),
    count: usize,
    seed: u64,
) -> RandomSets {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let sets: Vec<Expectation> = (0..SETS)
        .map(|_| {
            let picked = sample(&mut rng, information.poses.len(), count);
            Expectation::of(information, platform, picked)
        })
        .collect();
    let mean_square = |values: &mut dyn Iterator<Item = Option<f64>>| {
        let squares: Option<f64> = values.map(|v| v.map(|v| v * v)).sum();
        squares.map(|sum| (sum / SETS as f64).sqrt())
    };
    let log_dets = || sets.iter().map(|set| set.criteria.log_det);
    RandomSets {
        typical: Expectation {
            sd: (0..information.parameters.len())
                .map(|k| mean_square(&mut sets.iter().map(|set| set.sd[k])))
                .collect(),
            criteria: DesignCriteria {
                log_det: log_dets().sum::<f64>() / SETS as f64,
                worst_m: mean_square(&mut sets.iter().map(|set| set.criteria.worst_m)),
                mean_m: mean_square(&mut sets.iter().map(|set| set.criteria.mean_m)),
                platform_m: mean_square(&mut sets.iter().map(|set| set.criteria.platform_m)),
            },
        },
        best_log_det: log_dets().fold(f64::NEG_INFINITY, f64::max),
    }
}
