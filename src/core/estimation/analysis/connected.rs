//! The readings of the poses that distances connect, and the distances.
//!
//! With the derivative `Q` of the noise estimates of a pose's readings by its coordinates, in units of their information, the
//! distances change these by `Q u`, see [`super::super::distances`]: the estimates are `e + Q u`, the share of their variance that is
//! left with known parameters grows by the diagonal of `Q S Q^T` with the covariance `S` of `u`.

use super::ReadingsOfParameters;
use crate::estimation::distances::Distances;
use crate::estimation::linearisation::{LinearisedPose, LinearisedProblem, RowKind};
use crate::estimation::observation::{Observation, ObservationKind};
use crate::estimation::problem::Problem;
use crate::estimation::solution::Solution;

/// The poses that distances connect.
pub(super) struct ConnectedPoses<'a> {
    problem: &'a Problem<'a>,
    at: LinearisedProblem<'a>,
    readings: ReadingsOfParameters<'a>,
}

impl<'a> ConnectedPoses<'a> {
    pub fn new(
        problem: &'a Problem<'a>,
        solution: &'a Solution,
        readings: ReadingsOfParameters<'a>,
    ) -> Self {
        Self {
            problem,
            at: LinearisedProblem::new(problem, solution),
            readings,
        }
    }

    /// The distances, then the readings of the poses that they connect.
    pub fn readings(mut self, distances: &Distances) -> Vec<Observation> {
        let stated = &self.problem.dataset.measurements.distances;
        let distance = |(k, standardised, left, gradient): (usize, _, _, _)| {
            let of = (
                stated[k].rows[0],
                ObservationKind::Distance(k),
                stated[k].sd_m,
            );
            self.readings
                .observation(of, standardised, (left, &gradient))
        };
        let mut all: Vec<Observation> = distances.readings().into_iter().map(distance).collect();
        for index in 0..self.at.pose_count() {
            if let Some(pull) = distances.pull_of(index) {
                let pose = self.at.pose(index);
                let changed = pose.block.residual.clone() + &pose.by_pose * pull.estimate;
                let spread = &pose.by_pose * pull.spread;
                let design = &pose.block.design + &pose.by_pose * pull.by_parameter;
                all.extend(pose.observed().map(|(k, kind, sd)| {
                    let left = pose.remainder.row(k).norm_squared()
                        + spread.row(k).dot(&pose.by_pose.row(k));
                    let gradient = design.row(k).transpose();
                    let of = (pose.row, kind, sd);
                    self.readings.observation(of, changed[k], (left, &gradient))
                }));
            }
        }
        all
    }
}

impl LinearisedPose {
    /// Its rows that are readings or equations: index, kind and standard deviation.
    fn observed(&self) -> impl Iterator<Item = (usize, ObservationKind, f64)> {
        let rows = self.block.rows.iter().enumerate();
        rows.filter_map(|(k, row)| match row.kind {
            RowKind::Observation(kind) => Some((k, kind, row.sd)),
            RowKind::AssumedTension(_) | RowKind::Prior(_) => None,
        })
    }
}
