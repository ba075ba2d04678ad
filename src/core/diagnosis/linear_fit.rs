//! A fit with all candidates linearised at its solution.

use nalgebra::{DMatrix, DVector};

use super::background::shapes;
use super::catalogue::Catalogue;
use super::conditions::{Conditions, columns_of, concatenate_columns, is_fixed};
use super::deviation_columns::explained_by_deviations;
use super::evidence::{Member, System};
use super::fit::Fit;
use super::gram::Gram;
use super::hyperparameters::{Estimate, Hyperparameters, LinearProblem, Start};
use super::reduced_problem::ReducedProblem;
use super::report::Cause;
use super::search::Search;
use super::variables::Variables;
use crate::estimation::ParameterId;

/// A fit with its linear problem.
pub(super) struct LinearFit<'f, 'a> {
    pub fit: &'f Fit<'a>,
    pub linear: LinearProblem,
    pub catalogue: Catalogue,
    /// Generators as conditions.
    pub generators: DMatrix<f64>,
    /// The causes of the fit as members.
    pub present: Vec<Member>,
}

/// Log evidence and prior of the causes of a fit.
pub(super) struct OwnEvidence<'l> {
    pub value: f64,
    pub hyper: Hyperparameters,
    /// All candidates at these hyperparameters.
    pub gram: Gram<'l>,
}

impl<'f, 'a> LinearFit<'f, 'a> {
    pub fn new(fit: &'f Fit<'a>, include_all: bool) -> Self {
        let linear = fit.linearisation();
        let catalogue = Catalogue::new(fit, &linear, include_all);
        let model_effects = fit.model_effects();
        let is_common = |id: &ParameterId| is_fixed(id, model_effects);
        let conditions = Conditions::new(&linear, is_common);
        let variables = Variables::new(&fit.problem, &fit.solution, &linear);
        let shapes = shapes(&conditions, &linear, &variables);
        let fixed = columns_of(&linear, is_common);
        let fixed = conditions.project_rows(&fixed);
        let deviations = fit.deviation_columns().conditions(&linear, &conditions);
        let generators = conditions.project_rows(&catalogue.generators);
        let residual =
            &linear.residual - explained_by_deviations(&fit.problem, &fit.solution, &linear);
        let residual = DMatrix::from_column_slice(residual.len(), 1, residual.as_slice());
        let mut residual: DVector<f64> = conditions.project_rows(&residual).column(0).into_owned();
        let mut present = Vec::new();
        let poses = conditions.poses;
        for cause in &fit.causes {
            let Some(index) = catalogue
                .candidates
                .iter()
                .position(|c| c.represents(cause))
            else {
                continue;
            };
            let candidate = &catalogue.candidates[index];
            let coordinates = candidate.coordinates(cause);
            for (k, value) in coordinates.iter().enumerate() {
                let column = catalogue.column(candidate.columns[k], &generators, &conditions);
                residual.axpy(-value, &column, 1.0);
            }
            present.push((index, candidate.nearest_scale(&coordinates)));
        }
        debug_assert!(poses == linear.poses.len());
        Self {
            fit,
            linear: LinearProblem {
                conditions,
                residual,
                fixed,
                deviations,
                shapes,
            },
            catalogue,
            generators,
            present,
        }
    }

    /// Columns of some members as conditions, in units of their prior.
    pub fn columns(&self, members: &[Member]) -> DMatrix<f64> {
        // `concatenate_columns` needs a first part with the right number of rows even if there are no members.
        let mut parts = vec![DMatrix::zeros(self.linear.conditions.count, 0)];
        for (index, scale) in members {
            let candidate = &self.catalogue.candidates[*index];
            let mut columns = DMatrix::zeros(self.linear.conditions.count, candidate.columns.len());
            for (k, column) in candidate.columns.iter().enumerate() {
                let column =
                    self.catalogue
                        .column(*column, &self.generators, &self.linear.conditions);
                columns.set_column(k, &column);
            }
            parts.push(columns * &candidate.prior * candidate.scales[*scale].0);
        }
        concatenate_columns(&parts.iter().collect::<Vec<_>>())
    }

    /// Estimates the hyperparameters for a set.
    pub fn estimate(&self, start: Start<'_>, members: &[Member]) -> Estimate<'_> {
        self.linear.estimate(start, &self.columns(members))
    }

    pub fn gram(&self, hyper: &Hyperparameters) -> Gram<'_> {
        let none = DMatrix::zeros(self.linear.conditions.count, 0);
        self.gram_of(self.linear.reduced(hyper, &none))
    }

    /// All candidates beside the causes of the fit, which are estimated with each.
    pub fn gram_beside_present(&self, hyper: &Hyperparameters) -> Gram<'_> {
        self.gram_of(self.linear.reduced(hyper, &self.columns(&self.present)))
    }

    fn gram_of<'l>(&'l self, base: ReducedProblem<'l>) -> Gram<'l> {
        Gram::new(&self.linear, base, &self.catalogue, &self.generators)
    }

    /// Log evidence and prior of the fit's own causes, with the hyperparameters estimated for them.
    pub fn own_evidence(&self, start: Start<'_>) -> OwnEvidence<'_> {
        let Estimate { hyper, base, .. } = self.estimate(start, &self.present);
        let mut gram = if self.present.is_empty() {
            self.gram_of(base)
        } else {
            self.gram(&hyper)
        };
        let log_evidence_of_none = gram.base.log_evidence + hyper.log_prior;
        let value = Search::new(&mut gram, self.present.len()).settle(&self.present);
        OwnEvidence {
            value: log_evidence_of_none + value,
            hyper,
            gram,
        }
    }

    /// The causes of some members, with the values estimated in the linear problem.
    pub fn causes_of(&self, gram: &mut Gram<'_>, members: &[Member]) -> Vec<Cause> {
        let system = System::new(gram, members);
        let candidates = &self.catalogue.candidates;
        let ranges = system.parameters(candidates);
        let mut causes = Vec::new();
        for ((index, _), range) in members.iter().zip(ranges) {
            let estimate: Vec<f64> = system.estimate.rows_range(range).iter().copied().collect();
            // Values from the nonlinear fit are more accurate than linear estimates.
            let present = self.present.iter().position(|m| m.0 == *index);
            causes.push(match present {
                Some(k) => self.fit.causes[k].clone(),
                None => candidates[*index].estimated(&estimate),
            });
        }
        causes
    }
}
