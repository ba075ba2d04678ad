//! The readings of the home pose.

use nalgebra::{DMatrix, DVector};

use super::sd_of;
use crate::estimation::evaluator::Evaluator;
use crate::estimation::home::HomeRow;
use crate::estimation::observation::{EntryPointSensitivity, Observation, ObservationKind};
use crate::estimation::parameter::{Parameter, ParameterId};
use crate::estimation::problem::Problem;
use crate::estimation::solution::Solution;
use crate::estimation::system::Priors;

/// Readings at the home pose, which depend on the common parameters only.
pub(super) struct HomeReadings<'a> {
    pub problem: &'a Problem<'a>,
    pub solution: &'a Solution,
    pub covariance: Option<&'a DMatrix<f64>>,
    pub row: usize,
}

impl HomeReadings<'_> {
    pub fn instruments(
        &self,
        evaluator: &mut Evaluator<'_, f64>,
        home: &HomeRow,
    ) -> Vec<Observation> {
        let layout = evaluator.layout.clone();
        let present = evaluator.equations_at(0).present.clone();
        let n = self.solution.parameters.len();
        let measured = (layout.cables..layout.rows).filter(|r| present[*r] > 0.0);
        measured
            .map(|r| {
                let index = r - layout.cables;
                let kind = layout.kinds[r];
                let sd = sd_of(self.problem, evaluator, kind, self.row);
                let gradient = &home.gradients[index * n..(index + 1) * n];
                let gradient = DVector::from_column_slice(gradient);
                self.observation((kind, sd), home.residuals[index], &gradient)
            })
            .collect()
    }

    /// The tension readings, which enter as priors of their errors. Assumed tensions are not readings.
    pub fn tensions(&self) -> Vec<Observation> {
        if self.problem.assumes_tensions() {
            return Vec::new();
        }
        let parameters = &self.solution.parameters;
        let priors = Priors::evaluate(self.problem, &self.solution.globals, parameters);
        let tension = |(k, parameter): (usize, &Parameter)| {
            let ParameterId::HomeTension { cable } = parameter.id else {
                return None;
            };
            let sd = parameter.prior_sd?;
            let mut gradient = DVector::zeros(parameters.len());
            gradient[k] = sd.recip();
            let kind = ObservationKind::Tension(cable);
            Some(self.observation((kind, sd), priors.residuals[k], &gradient))
        };
        parameters.iter().enumerate().filter_map(tension).collect()
    }

    fn observation(
        &self,
        (kind, sd): (ObservationKind, f64),
        standardised: f64,
        gradient: &DVector<f64>,
    ) -> Observation {
        let moved = self.covariance.map(|c| c * gradient);
        Observation {
            row: self.row,
            kind,
            standardised,
            sd,
            redundancy: moved.as_ref().map(|moved| 1.0 - gradient.dot(moved)),
            pull: moved.and_then(|moved| self.pull(&moved)),
        }
    }

    fn pull(&self, moved: &DVector<f64>) -> Option<EntryPointSensitivity> {
        let mut squares = vec![0.0; self.problem.dataset.robot.cable_count()];
        for (parameter, moved) in self.solution.parameters.iter().zip(moved) {
            if let ParameterId::EntryPoint { cable, .. } = parameter.id {
                squares[cable] += moved * moved;
            }
        }
        let squares = squares.into_iter().enumerate();
        let (cable, square) = squares.max_by(|a, b| a.1.total_cmp(&b.1))?;
        (square > 0.0).then(|| EntryPointSensitivity {
            cable,
            per_sd_m: square.sqrt(),
        })
    }
}
