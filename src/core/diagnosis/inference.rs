//! Infers the posterior probabilities of sets of causes from the readings.
//!
//! At a fit, all readings are linear in the parameters of all candidates. Sets are compared there at a few points of
//! the hyperparameters, namely noise as described and the estimates for the best sets. The probability of a set is the
//! sum over these points, so that a small cause in small noise competes with no cause in large noise. The most probable
//! sets are then fitted with the full model and compared by the evidence at their own fits. The problem is linearised
//! again at the best of them until it stays the best.

use std::rc::Rc;

use nalgebra::DMatrix;

use super::budget::MOVED_CHI2;
use super::budget::{MAX_LINEARISATIONS, RIDGE};
use super::catalogue::Catalogue;
use super::cause_sets::{RankedSet, is_physically_possible};
use super::conditions::concatenate_columns;
use super::deviation_columns::DeviationColumns;
use super::evidence::Member;
use super::exploration::{Visibility, explore};
use super::fit::Fit;
use super::grouping::merge_common_values;
use super::hyperparameters::{Hyperparameters, LinearProblem, Start};
use super::initial_fit::initial_fit;
use super::linear_fit::LinearFit;
use super::priors::{AMPLITUDES, FACTORS};
use super::progress::Reporter;
use super::reading_id::ReadingId;
use super::relations::is_same_set;
use super::report::{Cause, UnmodelledError};
use super::search::collinear_members;
use super::set_comparison::SetComparison;
use super::{DiagnosisOptions, Stage};
use crate::estimation::{EstimationError, Problem};
use crate::statistics::log_sum;

/// Result of the inference.
pub(super) struct Inference<'a> {
    /// Fit of the most probable set.
    pub fit: Fit<'a>,
    /// Sets in order of decreasing probability, that of the fit first.
    pub ranking: Vec<RankedSet>,
    /// The problem linearised at the fit, with the hyperparameters estimated there.
    pub linear: LinearProblem,
    pub hyper: Hyperparameters,
    /// Columns of the causes of the fit, in units of their prior.
    pub columns: DMatrix<f64>,
    catalogue: Catalogue,
    present: Vec<Member>,
}

impl Inference<'_> {
    /// Index of the first column of each cause, and the number of columns at the end.
    fn first_columns(&self) -> Vec<usize> {
        let mut first = vec![0];
        for (index, _) in &self.present {
            first.push(first[first.len() - 1] + self.catalogue.candidates[*index].columns.len());
        }
        first
    }

    /// Columns of all causes except those given.
    pub fn columns_without(&self, causes: &[usize]) -> DMatrix<f64> {
        let first = self.first_columns();
        let kept = (0..self.present.len()).filter(|k| !causes.contains(k));
        let columns: Vec<usize> = kept.flat_map(|k| first[k]..first[k + 1]).collect();
        self.columns.select_columns(&columns)
    }

    /// Scatter of the parts, in units of their tolerances: the posterior mean of the factor.
    pub fn tolerance_factor(&self) -> f64 {
        let base = self.linear.reduced(&self.hyper, &self.columns);
        let evidence = self.linear.factor_evidence(&base, &self.hyper);
        let total = log_sum(evidence.iter().copied());
        let weighted = evidence.iter().zip(FACTORS);
        weighted
            .map(|(log, factor)| factor * (log - total).exp())
            .sum()
    }

    /// Number of parameters of some causes.
    pub fn parameters_of(&self, causes: &[usize]) -> usize {
        let first = self.first_columns();
        causes.iter().map(|k| first[k + 1] - first[*k]).sum()
    }

    /// Log prior odds of some causes, including the priors of their scales and signs.
    pub fn log_prior(&self, causes: &[usize]) -> f64 {
        let log_odds = |k: &usize| {
            let (index, scale) = self.present[*k];
            let candidate = &self.catalogue.candidates[index];
            // A normal prior truncated at zero has twice the density.
            let sign = if candidate.is_positive {
                std::f64::consts::LN_2
            } else {
                0.0
            };
            candidate.log_odds + candidate.scales[scale].1 + sign
        };
        causes.iter().map(log_odds).sum()
    }

    /// Standard deviations of the parameters of each cause with the actual noise and background; `None` where the data do not
    /// determine one.
    pub fn sds(&self) -> Vec<Vec<Option<f64>>> {
        let of_cause = |(cause, ratios): (usize, Vec<f64>)| {
            let parameters = self.fit.parameters_of(cause).into_iter();
            let ratios = ratios.into_iter().chain(std::iter::repeat(1.0));
            let sd =
                |(k, ratio): (usize, f64)| Some(self.fit.solution.standard_deviation(k)? * ratio);
            parameters.zip(ratios).map(sd).collect()
        };
        self.sd_ratios()
            .into_iter()
            .enumerate()
            .map(of_cause)
            .collect()
    }

    /// Log prior odds of a cause, times the prior density of values of some of its columns (in SI units).
    pub fn log_prior_density(&self, cause: usize, values: &[(usize, f64)]) -> f64 {
        let (index, _) = self.present[cause];
        let candidate = &self.catalogue.candidates[index];
        let density = |(scale, log_weight): &(f64, f64)| {
            let of_value = |(column, value): &(usize, f64)| {
                let sd = candidate.prior[(*column, *column)] * scale;
                -0.5 * ((value / sd).powi(2) + std::f64::consts::TAU.ln()) - sd.ln()
            };
            log_weight + values.iter().map(of_value).sum::<f64>()
        };
        candidate.log_odds + log_sum(candidate.scales.iter().map(density))
    }

    /// Excess scatter of the readings that a cause affects most.
    pub fn scatter_like(&self, cause: usize) -> Option<UnmodelledError> {
        self.most_affected_class(cause)
            .map(UnmodelledError::scatter)
    }

    /// The class of readings on which a cause has the largest effect.
    pub fn most_affected_class(&self, cause: usize) -> Option<ReadingId> {
        let squares = self.effect_by_class(cause);
        let classes = self.linear.conditions.classes.iter().zip(squares);
        classes.max_by(|a, b| a.1.total_cmp(&b.1)).map(|c| *c.0)
    }

    /// Sum of squares of a cause's effect on each class of readings, with all else estimated.
    fn effect_by_class(&self, cause: usize) -> Vec<f64> {
        let none = DMatrix::zeros(self.linear.conditions.count, 0);
        let base = self.linear.reduced(&self.hyper, &none);
        let first = self.first_columns();
        let mut whitened = self
            .columns
            .columns(first[cause], first[cause + 1] - first[cause])
            .into_owned();
        base.noise.whiten(&mut whitened);
        whitened -= base.eliminated.tr_mul(&(&base.eliminated * &whitened));
        let mut squares = vec![0.0; self.hyper.variance.len()];
        for column in whitened.column_iter() {
            let sums = base
                .noise
                .class_sums(&column.into_owned(), &base.eliminated);
            for ((sum, [square, _]), variance) in
                squares.iter_mut().zip(sums).zip(&self.hyper.variance)
            {
                *sum += square / variance;
            }
        }
        squares
    }

    /// Standard deviations of the coordinates of each cause with the actual noise and background, relative to those
    /// with the noise as described, which determines the weights of the fit.
    ///
    /// With the derivatives `Z`, the prior information `R`, `N = Z^T Z + R` and the covariance `C` of noise and
    /// background, an estimate in the described weights has the covariance `N^-1 (Z^T C Z + R) N^-1` (White 1980). If
    /// the noise is as described, this is `N^-1`.
    pub fn sd_ratios(&self) -> Vec<Vec<f64>> {
        let conditions = &self.linear.conditions;
        let fixed = self.linear.fixed.ncols();
        let deviations = &self.linear.deviations * FACTORS[self.hyper.factor];
        let mut derivatives =
            concatenate_columns(&[&self.linear.fixed, &deviations, &self.columns]);
        for mut column in derivatives.columns_mut(0, fixed).column_iter_mut() {
            column.try_normalize_mut(f64::MIN_POSITIVE);
        }
        let width = derivatives.ncols();
        let mut normal = derivatives.tr_mul(&derivatives);
        for k in 0..width {
            normal[(k, k)] += if k < fixed { RIDGE } else { 1.0 };
        }
        let first = self.first_columns();
        let Some(inverse) = normal.cholesky().map(|factor| factor.inverse()) else {
            return first.windows(2).map(|w| vec![1.0; w[1] - w[0]]).collect();
        };
        let before = fixed + deviations.ncols();
        let of_causes = inverse.columns(before, width - before).into_owned();
        let weights = &derivatives * &of_causes;
        let mut square = conditions.variances(&self.hyper.variance, &weights);
        let shapes = self.linear.shapes.iter().zip(&self.hyper.amplitude);
        for (shape, amplitude) in shapes.filter(|(_, amplitude)| **amplitude > 0) {
            let columns = conditions.project_class(shape.class, &shape.all_functions());
            let along = columns.tr_mul(&weights) * AMPLITUDES[*amplitude];
            for (square, along) in square.iter_mut().zip(along.column_iter()) {
                *square += along.norm_squared();
            }
        }
        let ratio = |k: usize| {
            let of_prior = of_causes.column(k).rows_range(fixed..).norm_squared();
            ((square[k] + of_prior) / of_causes[(before + k, k)]).sqrt()
        };
        let of_cause = |w: &[usize]| (w[0]..w[1]).map(ratio).collect();
        first.windows(2).map(of_cause).collect()
    }
}

/// Infers the causes of a problem. Effects are evaluated at the poses of each fit, which a large cause moves.
pub(super) fn infer<'a>(
    problem: &Problem<'a>,
    options: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<(Inference<'a>, Vec<Visibility>), EstimationError> {
    let none = Fit::new(problem, &[])?;
    let none = none.within_tolerances()?.unwrap_or(none);
    let mut base = none.base().clone();
    let mut seen: Option<Vec<Visibility>> = None;
    let mut fit = initial_fit(none, &mut seen, options, report)?;
    let mut tried: Vec<Vec<Cause>> = vec![fit.causes.clone()];
    // Evidence of sets at their own fits.
    let mut fitted: Vec<(Vec<Cause>, f64)> = Vec::new();
    // Smallest variance factors found at any fit.
    let mut smallest_variances: Option<Vec<f64>> = None;
    let mut columns = Rc::new(DeviationColumns::none());
    for round in 1.. {
        let mut has_moved = false;
        if !fit.causes.is_empty() {
            let nearer = base.clone().with_contexts_of(&fit.solution);
            let moved = Fit::new(&nearer, &fit.causes)?;
            if (moved.solution.chi2 - fit.solution.chi2).abs() > MOVED_CHI2 {
                (base, fit) = (nearer, moved);
                has_moved = true;
            }
            if let Some(nearer) = fit.within_tolerances()? {
                (base, fit) = (nearer.base().clone(), nearer);
                has_moved = true;
            }
            if has_moved {
                fitted.clear();
            }
        }
        if round == 1 || has_moved {
            columns = Rc::new(fit.own_deviation_columns());
        }
        fit = fit.with_deviation_columns(&columns);
        let linear_fit = LinearFit::new(&fit, true);
        let own_evidence = linear_fit.own_evidence(smallest_variances.as_deref());
        let log_evidence = own_evidence.value;
        lower_variances(&mut smallest_variances, &own_evidence.hyper);
        let exploration = explore(
            &linear_fit,
            own_evidence,
            smallest_variances.as_deref(),
            (options.most_findings, round == 1),
            report,
        );
        let visible = seen.get_or_insert(exploration.visibility);
        fitted.push((fit.causes.clone(), log_evidence));
        let mut compared = SetComparison::new(&linear_fit, exploration.ranking, &fitted);
        let mut gram = exploration.gram;
        let mut best: Option<(f64, Fit<'a>)> = None;
        while let Some(place) = compared.next() {
            if !report.stage(Stage::Refits, linear_fit.present.len()) {
                break;
            }
            let start = linear_fit.causes_of(&mut gram, compared.members(place));
            let refit = Fit::new(&base, &start)?.with_deviation_columns(&columns);
            let value = if is_physically_possible(&refit) {
                let refit = LinearFit::new(&refit, false);
                let evidence = refit.own_evidence(smallest_variances.as_deref());
                lower_variances(&mut smallest_variances, &evidence.hyper);
                evidence.value
            } else {
                f64::NEG_INFINITY
            };
            compared.record_fit(place, value, &refit.causes);
            if value == f64::NEG_INFINITY {
                let alike = collinear_members(&mut gram, compared.members(place));
                if alike.len() > 1 {
                    compared.exclude(&alike);
                }
            }
            fitted.push((compared.causes(place).to_vec(), value));
            if value > best.as_ref().map_or(log_evidence, |b| b.0) {
                best = Some((value, refit));
                if compared.is_best(place) && round < MAX_LINEARISATIONS {
                    // Start over with a linearisation at the better fit.
                    break;
                }
            }
        }
        let ranking = compared.ranking();
        let is_new = |next: &Fit<'_>| !tried.iter().any(|t| is_same_set(t, &next.causes));
        let may_go_on = round < MAX_LINEARISATIONS && !report.cancelled;
        match best {
            Some((_, next)) if may_go_on && is_new(&next) => {
                tried.push(next.causes.clone());
                fit = next;
            }
            best => {
                let (log_evidence, last) = best.unwrap_or((log_evidence, fit));
                let merged = merge_common_values(&last).filter(|_| may_go_on);
                let merged = merged.map(|causes| Fit::new(&base, &causes)).transpose()?;
                let merged = merged.map(|fit| fit.with_deviation_columns(&columns));
                let better = merged.filter(|fit| {
                    let linear_fit = LinearFit::new(fit, false);
                    let evidence = linear_fit.own_evidence(smallest_variances.as_deref());
                    is_physically_possible(fit) && evidence.value > log_evidence
                });
                match better {
                    Some(next) => fit = next,
                    None => {
                        let start = smallest_variances.as_deref();
                        let inference = inference_at_fit(last, ranking, start);
                        return Ok((inference, std::mem::take(visible)));
                    }
                }
            }
        }
    }
    unreachable!("the last round returns")
}

/// Replaces each variance factor by the smaller of the two.
fn lower_variances(smallest_variances: &mut Option<Vec<f64>>, hyper: &Hyperparameters) {
    let smallest = smallest_variances.get_or_insert_with(|| hyper.variance.clone());
    for (least, variance) in smallest.iter_mut().zip(&hyper.variance) {
        *least = least.min(*variance);
    }
}

/// The inference result at a fit. The estimation of its variance factors starts at `start`.
pub(super) fn inference_at_fit<'a>(
    fit: Fit<'a>,
    mut ranking: Vec<RankedSet>,
    start: Start<'_>,
) -> Inference<'a> {
    let linear_fit = LinearFit::new(&fit, false);
    let hyper = linear_fit.estimate(start, &linear_fit.present).hyper;
    let columns = linear_fit.columns(&linear_fit.present);
    // The linear comparison may rank the set of the fit slightly lower than another one.
    if let Some(index) = ranking
        .iter()
        .position(|r| is_same_set(&r.causes, &fit.causes))
    {
        let ranked = ranking.remove(index);
        ranking.insert(
            0,
            RankedSet {
                causes: fit.causes.clone(),
                ..ranked
            },
        );
    }
    let LinearFit {
        linear,
        catalogue,
        present,
        ..
    } = linear_fit;
    Inference {
        ranking,
        linear,
        hyper,
        columns,
        catalogue,
        present,
        fit,
    }
}
