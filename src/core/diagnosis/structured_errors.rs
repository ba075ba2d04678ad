//! Unmodelled errors: functions of one or two variables in the readings of one kind, of one cable or of all alike.
//!
//! The error of a target's readings is `sum_k c_k phi_k(u)`, where the `c_k` are independent normal variables of one
//! size in standard deviations of the readings as described. The functions are in [`super::error_functions`]. Thousands of
//! functions are scored with the present noise, by [`crate::evidence`]; the best are compared exactly, with the noise estimated
//! again. The odds of an error are those of all functions and sizes together.
//!
//! [`ErrorSearch::find_beside`] looks for errors beside all causes. The part of the functions that effects of the catalogue
//! express is removed there, so that a cause too small to be found is not reported as an error.
//! [`ErrorSearch::find_in_place`] looks for errors that explain the readings without some of the causes; there the functions
//! are complete.

use nalgebra::DMatrix;

use super::Quantity;
use super::budget::{COMPARE_ABOVE, MAX_COMPARED};
use super::calibration::MIN_SHARE_LEFT;
use super::conditions::concatenate_columns;
use super::error_functions::{ErrorTarget, FunctionFamily};
use super::hyperparameters::{Estimate, Hyperparameters, LinearProblem};
use super::priors::{CABLE_VARIANCE_WEIGHT, ERROR_SIZES, EXPECTED_ERRORS};
use super::reading_errors::ReadingErrors;
use super::reading_id::ReadingId;
use super::report::ErrorForm;
use super::variables::Variables;
use crate::estimation::{LinearRow, Linearisation};
use crate::evidence::{of_size, principal};
use crate::statistics::log_sum;

/// An error of a given form in some readings.
#[derive(Debug, Clone)]
pub(super) struct StructuredError {
    /// The readings; no cable if the readings of all cables have the same error.
    pub id: ReadingId,
    pub form: ErrorForm,
    /// Log posterior odds.
    pub log_odds: f64,
    /// Log prior probability.
    pub log_prior: f64,
    /// Root mean square over the readings, about its mean (SI units).
    pub rms: f64,
    /// Columns as conditions, with prior variance 1.
    pub columns: DMatrix<f64>,
}

/// A family of functions with its best size.
#[derive(Debug, Clone, Copy)]
struct ScoredFamily {
    target: usize,
    family: usize,
    size: f64,
    log_odds: f64,
}

/// Families scored with the present noise.
struct RankedFamilies {
    /// The best family of each target, in order of decreasing odds.
    best: Vec<ScoredFamily>,
    /// Log odds that there is any error.
    log_odds: f64,
}

/// The families of functions for all possible targets.
pub(super) struct ErrorSearch<'l> {
    linear: &'l LinearProblem,
    /// Factor of the tolerances, and variance factors at which their estimation starts.
    hyper: &'l Hyperparameters,
    targets: Vec<ErrorTarget>,
}

impl<'l> ErrorSearch<'l> {
    /// Builds all targets of a linearised problem. The estimation of variance factors starts at those of `hyper`.
    pub fn new(
        linear: &'l LinearProblem,
        hyper: &'l Hyperparameters,
        linearisation: &Linearisation,
        variables: &Variables<'_>,
    ) -> Self {
        let classes = &linear.conditions.classes;
        let mut sets: Vec<(ReadingId, Vec<usize>)> = Vec::new();
        for (class, id) in classes.iter().enumerate() {
            sets.push((*id, vec![class]));
            let common = ReadingId { cable: None, ..*id };
            match sets.iter_mut().find(|(id, _)| *id == common) {
                Some((_, set)) if id.cable.is_some() => set.push(class),
                None => sets.push((common, vec![class])),
                _ => {}
            }
        }
        let sd = |id: &ReadingId| {
            let of = |row: &&LinearRow| ReadingId::of(row, linearisation) == Some(*id);
            linearisation.rows.iter().find(of).map_or(1.0, |row| row.sd)
        };
        let sds: Vec<f64> = classes.iter().map(sd).collect();
        let rows: Vec<usize> = linearisation.poses.iter().map(|pose| pose.row).collect();
        let mut targets: Vec<ErrorTarget> = sets
            .into_iter()
            .filter(|(id, classes)| id.cable.is_some() || classes.len() != 1 || is_single(id))
            .filter_map(|(id, classes)| {
                let sd = sds[classes[0]];
                ErrorTarget::new((id, sd), classes, &rows, linear, variables)
            })
            .collect();
        let each = (EXPECTED_ERRORS / targets.len().max(1) as f64).ln();
        for target in &mut targets {
            for family in &mut target.families {
                family.log_prior += each;
            }
        }
        Self {
            linear,
            hyper,
            targets,
        }
    }

    /// The most significant error beside causes with the given columns, if the posterior odds that there is one exceed
    /// `least`.
    pub fn find_beside(&self, columns: &DMatrix<f64>, least: f64) -> Option<StructuredError> {
        let no_background = vec![0; self.linear.shapes.len()];
        let none = self.with_amplitudes(&no_background, columns);
        let ranked = self.ranked(&none, |_| true, |family| &family.unexpressed, true);
        let log_density =
            |columns: &DMatrix<f64>| self.linear.refined(&none.hyper, columns).log_density;
        let exact = ranked.best.into_iter().filter_map(|scored| {
            let structure = self.columns(&scored, |family| &family.unexpressed);
            let with = log_density(&concatenate_columns(&[columns, &structure]));
            let offset = ranked.log_odds - scored.log_odds + self.log_prior(&scored);
            if with - none.log_density + offset < least {
                return None;
            }
            // A constant error alone is no evidence, because effects of the catalogue express it.
            let constant = concatenate_columns(&[columns, &structure.columns(0, 1).into_owned()]);
            let without = log_density(&constant);
            let log_odds = with - without.max(none.log_density) + offset;
            let rms = || self.rms(&none, &scored, |family| &family.unexpressed);
            (log_odds >= least).then(|| self.structure(&scored, (log_odds, rms()), structure))
        });
        exact.max_by(|a, b| a.log_odds.total_cmp(&b.log_odds))
    }

    /// The error that explains most beside the given columns, with a given background. Its `log_odds` are the log
    /// evidence with the error plus its log prior.
    pub fn find_in_place(
        &self,
        columns: &DMatrix<f64>,
        amplitude: &[usize],
        is_eligible: impl Fn(&ReadingId) -> bool,
    ) -> Option<StructuredError> {
        let none = self.with_amplitudes(amplitude, columns);
        let ranked = self.ranked(&none, is_eligible, |family| &family.functions, false);
        let exact = ranked.best.into_iter().map(|scored| {
            let structure = self.columns(&scored, |family| &family.functions);
            let with_columns = concatenate_columns(&[columns, &structure]);
            let with = self.linear.refined(&none.hyper, &with_columns).log_density;
            let offset = ranked.log_odds - scored.log_odds + self.log_prior(&scored);
            let rms = self.rms(&none, &scored, |family| &family.functions);
            self.structure(&scored, (with + offset, rms), structure)
        });
        exact.max_by(|a, b| a.log_odds.total_cmp(&b.log_odds))
    }

    fn with_amplitudes(&self, amplitude: &[usize], columns: &DMatrix<f64>) -> Estimate<'_> {
        let start = Some(&*self.hyper.variance);
        let levels = (amplitude, self.hyper.factor);
        self.linear.with_amplitudes(start, levels, columns)
    }

    fn family(&self, scored: &ScoredFamily) -> &FunctionFamily {
        &self.targets[scored.target].families[scored.family]
    }

    /// Log prior probability of a family at one of the sizes.
    fn log_prior(&self, scored: &ScoredFamily) -> f64 {
        self.family(scored).log_prior - (ERROR_SIZES.len() as f64).ln()
    }

    fn structure(
        &self,
        scored: &ScoredFamily,
        (log_odds, rms): (f64, f64),
        columns: DMatrix<f64>,
    ) -> StructuredError {
        StructuredError {
            id: self.targets[scored.target].id,
            form: self.family(scored).form,
            log_odds,
            log_prior: self.log_prior(scored),
            rms,
            columns,
        }
    }

    /// Standard deviation over the readings (SI units) of the posterior mean of an error, `(K + 1/s^2)^-1 b` in terms of its
    /// functions. Its mean is left out, as parameters of the model express a constant as well.
    fn rms(
        &self,
        fit: &Estimate<'_>,
        scored: &ScoredFamily,
        functions: impl Fn(&FunctionFamily) -> &DMatrix<f64>,
    ) -> f64 {
        let target = &self.targets[scored.target];
        let functions = with_constant(functions(self.family(scored)), &target.poses);
        let (score, mut information) =
            ReadingErrors::new(&fit.base, &target.classes).of(&functions);
        for k in 0..score.len() {
            information[(k, k)] += scored.size.powi(-2);
        }
        let mean = information.cholesky().map(|factor| factor.solve(&score));
        let values = mean.map(|mean| functions.select_rows(&target.poses) * mean);
        target.sd * values.map_or(0.0, |values| values.variance().sqrt())
    }

    /// A constant and the functions of a family as conditions.
    fn columns(
        &self,
        scored: &ScoredFamily,
        functions: impl Fn(&FunctionFamily) -> &DMatrix<f64>,
    ) -> DMatrix<f64> {
        let target = &self.targets[scored.target];
        let functions = with_constant(functions(self.family(scored)), &target.poses);
        let mut columns = DMatrix::zeros(self.linear.conditions.count, functions.ncols());
        for class in &target.classes {
            columns += self.linear.conditions.project_class(*class, &functions) * scored.size;
        }
        columns
    }

    /// Scores the families of the eligible targets and keeps the best of each target. With `beyond`, the part that a constant
    /// alone explains does not count.
    fn ranked(
        &self,
        fit: &Estimate<'_>,
        is_eligible: impl Fn(&ReadingId) -> bool,
        functions: impl Fn(&FunctionFamily) -> &DMatrix<f64>,
        beyond: bool,
    ) -> RankedFamilies {
        let (base, variance) = (&fit.base, &fit.hyper.variance);
        let sums = base.noise.class_sums(&base.residual, &base.eliminated);
        let size_prior = -(ERROR_SIZES.len() as f64).ln();
        let mut best: Vec<ScoredFamily> = Vec::new();
        let mut scores: Vec<f64> = Vec::new();
        for (number, target) in self.targets.iter().enumerate() {
            if !is_eligible(&target.id) {
                continue;
            }
            let errors = ReadingErrors::new(base, &target.classes);
            let squares = target.classes.iter().map(|k| sums[*k][0] / variance[*k]);
            let squares = squares.sum::<f64>() + CABLE_VARIANCE_WEIGHT;
            let freedom =
                target.classes.iter().map(|k| sums[*k][1]).sum::<f64>() + CABLE_VARIANCE_WEIGHT;
            let mut strongest: Option<(f64, ScoredFamily)> = None;
            for (index, family) in target.families.iter().enumerate() {
                let functions = with_constant(functions(family), &target.poses);
                for (size, gain, price) in evidence(&errors, &functions, beyond) {
                    // The noise will be estimated again, so the logarithm of the remaining squares counts, not the
                    // gain.
                    let rest = (1.0 - gain / squares).max(f64::MIN_POSITIVE);
                    let weigh = |rest: f64| {
                        -0.5 * (freedom * rest.ln() + price) + family.log_prior + size_prior
                    };
                    let (value, log_odds) = (weigh(rest), weigh(rest.max(MIN_SHARE_LEFT)));
                    scores.push(log_odds);
                    if strongest.is_none_or(|(best, _)| value > best) {
                        let scored = ScoredFamily {
                            target: number,
                            family: index,
                            size,
                            log_odds,
                        };
                        strongest = Some((value, scored));
                    }
                }
            }
            best.extend(strongest.map(|(_, scored)| scored));
        }
        best.sort_by(|a, b| b.log_odds.total_cmp(&a.log_odds));
        let log_odds = log_sum(scores.into_iter());
        best.truncate(if log_odds > COMPARE_ABOVE {
            MAX_COMPARED
        } else {
            0
        });
        RankedFamilies { best, log_odds }
    }
}

/// Whether the reading belongs to the robot or an instrument rather than to one of its cables.
fn is_single(id: &ReadingId) -> bool {
    !matches!(
        id.quantity,
        Quantity::Length | Quantity::Tension | Quantity::Swivel
    )
}

/// Prepends a constant at some poses to functions.
fn with_constant(functions: &DMatrix<f64>, poses: &[usize]) -> DMatrix<f64> {
    let mut extended = functions.clone().insert_column(0, 0.0);
    for pose in poses {
        extended[(*pose, 0)] = 1.0;
    }
    extended
}

/// Chi-square explained by functions, with the log determinant that penalises it, for each size; with `beyond`, the
/// contributions of the first function alone are subtracted.
fn evidence(
    errors: &ReadingErrors,
    functions: &DMatrix<f64>,
    beyond: bool,
) -> Vec<(f64, f64, f64)> {
    if functions.ncols() < 2 {
        return Vec::new();
    }
    let (score, information) = errors.of(functions);
    let first = [[information[(0, 0)].max(0.0), score[0]]];
    let all = principal(&score, information);
    let at_size = |size: &f64| {
        let [gain, price] = of_size(&all, *size);
        let [own, its_price] = match beyond {
            true => of_size(&first, *size),
            false => [0.0, 0.0],
        };
        (*size, gain - own, price - its_price)
    };
    ERROR_SIZES.iter().map(at_size).collect()
}
