//! The readings of the home pose.

use nalgebra::DVector;

use super::ReadingsOfParameters;
use crate::estimation::evaluated::sd_of;
use crate::estimation::evaluator::Evaluator;
use crate::estimation::home::HomeRow;
use crate::estimation::observation::{Observation, ObservationKind};
use crate::estimation::parameter::{Parameter, ParameterId};
use crate::estimation::problem::Problem;
use crate::estimation::solution::Solution;
use crate::estimation::system::Priors;

/// Readings at the home pose, which depend on the common parameters only.
pub(super) struct HomeReadings<'a> {
    pub problem: &'a Problem<'a>,
    pub solution: &'a Solution,
    pub parameters: ReadingsOfParameters<'a>,
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
                self.parameters.observation(
                    (self.row, kind, sd),
                    home.residuals[index],
                    (1.0, &gradient),
                )
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
            let of = (self.row, kind, sd);
            Some((self.parameters).observation(of, priors.residuals[k], (1.0, &gradient)))
        };
        parameters.iter().enumerate().filter_map(tension).collect()
    }
}
