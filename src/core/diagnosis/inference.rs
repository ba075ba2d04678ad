//! From readings to the posterior probabilities of sets of causes.
//!
//! At a fit, all readings are linear in the parameters of all candidates. Sets are compared there at a few points of the
//! hyperparameters: noise as described, and the estimates for the sets that were best; the probability of a set is the
//! sum over the points, so that a small cause in small noise competes with no cause in large noise. The likeliest sets are
//! then fitted completely and compared by the evidence at their own fits; at the best of them everything is linearised
//! again, until it stays the best.

use nalgebra::DMatrix;

use super::approach::approach;
use super::candidates::is_alike;
use super::catalogue::Catalogue;
use super::complete::Comparison;
use super::conditions::joined;
use super::evidence::{Member, System};
use super::exploration::{Visibility, explore};
use super::fit::Fit;
use super::gram::Gram;
use super::grouping::united;
use super::hyperparameters::{AMPLITUDES, Hyperparameters, Linear, RIDGE};
use super::linear_fit::{EXPECTED_PER_ALPHA, LinearFit};
use super::progress::Reporter;
use super::reading_id::ReadingId;
use super::report::Cause;
use super::search::alike_together;
use super::{DiagnosisOptions, Stage};
use crate::estimation::{EstimationError, Problem};

/// Most linearisations.
const MOST_LINEARISATIONS: usize = 5;
/// Change of chi-square from which effects depend on other poses than those of the fit before.
const MOVED: f64 = 0.5;
/// Sizes over the largest typical one that no cause has.
const ABSURD: f64 = 10.0;

/// A set of causes with its posterior.
#[derive(Debug, Clone)]
pub(super) struct Ranked {
    pub causes: Vec<Cause>,
    pub log_posterior: f64,
}

/// What was inferred.
pub(super) struct Inference<'a> {
    /// The fit of the likeliest set.
    pub fit: Fit<'a>,
    /// Sets, the likeliest first, which is that of the fit.
    pub ranking: Vec<Ranked>,
    /// The problem linearised at the fit, with the hyperparameters estimated there.
    pub linear: Linear,
    pub at: Hyperparameters,
    /// Columns of the causes of the fit in units of their prior.
    pub columns: DMatrix<f64>,
    catalogue: Catalogue,
    present: Vec<Member>,
}

impl Inference<'_> {
    /// First column of each cause, and their number at the end.
    fn first_columns(&self) -> Vec<usize> {
        let mut first = vec![0];
        for (index, _) in &self.present {
            first.push(first[first.len() - 1] + self.catalogue.candidates[*index].columns.len());
        }
        first
    }

    /// The columns of all causes but some.
    pub fn columns_without(&self, causes: &[usize]) -> DMatrix<f64> {
        let first = self.first_columns();
        let kept = (0..self.present.len()).filter(|k| !causes.contains(k));
        let columns: Vec<usize> = kept.flat_map(|k| first[k]..first[k + 1]).collect();
        self.columns.select_columns(&columns)
    }

    /// Number of parameters of some causes.
    pub fn parameters_of(&self, causes: &[usize]) -> usize {
        let first = self.first_columns();
        causes.iter().map(|k| first[k + 1] - first[*k]).sum()
    }

    /// Logarithm of the prior odds of some causes with their sizes and signs.
    pub fn log_prior(&self, causes: &[usize]) -> f64 {
        let of = |k: &usize| {
            let (index, scale) = self.present[*k];
            let candidate = &self.catalogue.candidates[index];
            // A normal prior cut at zero is twice as dense.
            let sign = if candidate.is_positive {
                std::f64::consts::LN_2
            } else {
                0.0
            };
            candidate.log_odds + candidate.scales[scale].1 + sign
        };
        causes.iter().map(of).sum()
    }

    /// Share of what a cause changes, whatever else is estimated, that is in the readings of one kind and cable, or of all
    /// cables.
    pub fn share_in(&self, cause: usize, id: &ReadingId) -> f64 {
        let squares = self.changed(cause);
        let classes = self.linear.conditions.classes.iter().zip(&squares);
        let is_meant = |class: &ReadingId| {
            class.quantity == id.quantity && id.cable.is_none_or(|c| class.cable == Some(c))
        };
        let inside = classes.filter(|(class, _)| is_meant(class));
        let inside: f64 = inside.map(|(_, square)| square).sum();
        inside / squares.iter().sum::<f64>().max(f64::MIN_POSITIVE)
    }

    /// The class of readings that a cause changes most.
    pub fn most_changed(&self, cause: usize) -> Option<ReadingId> {
        let squares = self.changed(cause);
        let classes = self.linear.conditions.classes.iter().zip(squares);
        classes.max_by(|a, b| a.1.total_cmp(&b.1)).map(|c| *c.0)
    }

    /// What a cause changes in each class of readings, whatever else is estimated, as a sum of squares.
    fn changed(&self, cause: usize) -> Vec<f64> {
        let none = DMatrix::zeros(self.linear.conditions.count, 0);
        let base = self.linear.base(&self.at, &none);
        let first = self.first_columns();
        let mut own = self
            .columns
            .columns(first[cause], first[cause + 1] - first[cause])
            .into_owned();
        base.noise.whiten(&mut own);
        own -= base.taken.tr_mul(&(&base.taken * &own));
        let mut all = vec![0.0; self.at.variance.len()];
        for column in own.column_iter() {
            let sums = base.noise.class_sums(&column.into_owned(), &base.taken);
            for ((sum, [square, _]), variance) in all.iter_mut().zip(sums).zip(&self.at.variance) {
                *sum += square / variance;
            }
        }
        all
    }

    /// Standard deviations of the columns' parameters of each cause, in the noise and the background that there is, over
    /// those in the noise as described, whose weights the fit has.
    ///
    /// With the derivatives `Z`, the prior `R`, `N = Z^T Z + R` and the covariance `C` of noise and background, an estimate
    /// in other weights has the covariance `N^-1 (Z^T C Z + R) N^-1` (White 1980), in the noise as described `N^-1`.
    pub fn spread(&self) -> Vec<Vec<f64>> {
        let conditions = &self.linear.conditions;
        let fixed = self.linear.fixed.ncols();
        let mut derivatives = joined(&[&self.linear.fixed, &self.columns]);
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
        let of_causes = inverse.columns(fixed, width - fixed).into_owned();
        let weights = &derivatives * &of_causes;
        let mut square = conditions.variances(&self.at.variance, &weights);
        let shapes = self.linear.shapes.iter().zip(&self.at.amplitude);
        for (shape, amplitude) in shapes.filter(|(_, amplitude)| **amplitude > 0) {
            for functions in [&shape.columns, &shape.simple] {
                let along = functions.tr_mul(&weights) * AMPLITUDES[*amplitude];
                for (square, along) in square.iter_mut().zip(along.column_iter()) {
                    *square += along.norm_squared();
                }
            }
        }
        let ratio = |k: usize| {
            let of_prior = of_causes.column(k).rows_range(fixed..).norm_squared();
            ((square[k] + of_prior) / of_causes[(fixed + k, k)]).sqrt()
        };
        let of_cause = |w: &[usize]| (w[0]..w[1]).map(ratio).collect();
        first.windows(2).map(of_cause).collect()
    }
}

/// Whether all values of a fit are physically possible.
pub(super) fn is_possible(fit: &Fit<'_>) -> bool {
    let bounds = fit.causes.iter().flat_map(|cause| &cause.instances);
    let mut values = bounds.flat_map(|b| b.values.iter().zip(b.effect.parameters()));
    fit.solution.chi2.is_finite()
        && values.all(|(value, p)| {
            let [_, largest] = p.typical_sizes();
            let sized = p.discrete || (value - p.neutral).abs() < ABSURD * largest.max(p.prior_sd);
            sized && *value >= p.bounds[0] && *value <= p.bounds[1]
        })
}

/// The causes of members, estimated at a point of the linear problem.
pub(super) fn causes_of(
    at: &LinearFit<'_, '_>,
    gram: &mut Gram<'_>,
    members: &[Member],
) -> Vec<Cause> {
    let system = System::new(gram, members);
    let candidates = &at.catalogue.candidates;
    let ranges = system.parameters(candidates);
    let mut causes = Vec::new();
    for ((index, _), range) in members.iter().zip(ranges) {
        let estimate: Vec<f64> = system.estimate.rows_range(range).iter().copied().collect();
        // What the fit has already is known better.
        let known = at.present.iter().position(|m| m.0 == *index);
        causes.push(match known {
            Some(k) => at.fit.causes[k].clone(),
            None => candidates[*index].estimated(&estimate),
        });
    }
    causes
}

/// Infers the causes of a problem. What effects depend on is taken at the poses of each fit, which a large cause moves: so
/// it is in the problem without causes that comes back.
pub(super) fn infer<'a>(
    mut base: Problem<'a>,
    options: &DiagnosisOptions,
    report: &mut Reporter<'_, '_>,
) -> Result<(Problem<'a>, Inference<'a>, Vec<Visibility>), EstimationError> {
    let expected = EXPECTED_PER_ALPHA * options.alpha;
    let none = Fit::new(&base, &[])?;
    let mut seen: Option<Vec<Visibility>> = None;
    let mut fit = approach(none, &mut seen, options, report)?;
    let mut tried: Vec<Vec<Cause>> = vec![fit.causes.clone()];
    // Evidence of sets at their own fits.
    let mut fitted: Vec<(Vec<Cause>, f64)> = Vec::new();
    // Variance factors of the quietest noise that any fit left.
    let mut quietest: Vec<f64> = Vec::new();
    for round in 1.. {
        if !fit.causes.is_empty() {
            let nearer = base.clone().with_contexts_of(&fit.solution);
            let moved = Fit::new(&nearer, &fit.causes)?;
            if (moved.solution.chi2 - fit.solution.chi2).abs() > MOVED {
                (base, fit) = (nearer, moved);
                fitted.clear();
            }
        }
        let at = LinearFit::new(&fit, expected, true).starting_at(&quietest);
        let (own, hyper) = at.own_evidence();
        quieten(&mut quietest, &hyper);
        let at = at.starting_at(&quietest);
        let explored = explore(&at, hyper, (options.most_findings, round == 1), report);
        let visible = seen.get_or_insert(explored.visibility);
        report.stage(Stage::Refits, at.present.len());
        fitted.push((fit.causes.clone(), own));
        let mut compared = Comparison::new(&at, explored.ranking, &fitted);
        let mut gram = at.gram(&explored.at);
        let mut best: Option<(f64, Fit<'a>)> = None;
        while let Some(place) = compared.next() {
            if report.cancelled && best.is_some() {
                break;
            }
            let start = causes_of(&at, &mut gram, compared.members(place));
            let refit = Fit::new(&base, &start)?;
            let value = if is_possible(&refit) {
                let refit = LinearFit::new(&refit, expected, false).starting_at(&quietest);
                let (value, hyper) = refit.own_evidence();
                quieten(&mut quietest, &hyper);
                value
            } else {
                f64::NEG_INFINITY
            };
            compared.fitted(place, value);
            if value == f64::NEG_INFINITY {
                let alike = alike_together(&mut gram, compared.members(place));
                if alike.len() > 1 {
                    compared.exclude(&alike);
                }
            }
            fitted.push((compared.causes(place).to_vec(), value));
            if value > best.as_ref().map_or(own, |b| b.0) {
                best = Some((value, refit));
                if compared.is_best(place) && round < MOST_LINEARISATIONS {
                    // Everything is compared anew from there.
                    break;
                }
            }
        }
        let ranking = compared.ranking();
        let better = best.filter(|(_, fit)| {
            let seen = tried.iter().any(|t| is_same(t, &fit.causes));
            !seen && round < MOST_LINEARISATIONS
        });
        match better {
            Some((_, next)) if !report.cancelled || fit.causes.is_empty() => {
                tried.push(next.causes.clone());
                fit = next;
            }
            _ => {
                let united = united(&fit).filter(|_| round < MOST_LINEARISATIONS);
                let united = united.map(|causes| Fit::new(&base, &causes)).transpose()?;
                let better = united.filter(|fit| {
                    let at = LinearFit::new(fit, expected, false).starting_at(&quietest);
                    is_possible(fit) && at.own_evidence().0 > own
                });
                match better {
                    Some(next) => fit = next,
                    None => {
                        let inference = at_fit(fit, options, ranking, &quietest);
                        return Ok((base, inference, std::mem::take(visible)));
                    }
                }
            }
        }
    }
    unreachable!("the last round returns")
}

/// The smaller variance factors of both.
fn quieten(quietest: &mut Vec<f64>, at: &Hyperparameters) {
    if quietest.is_empty() {
        quietest.clone_from(&at.variance);
    }
    for (least, variance) in quietest.iter_mut().zip(&at.variance) {
        *least = least.min(*variance);
    }
}

/// What is known at a fit, the variance factors of the noise estimated from some.
pub(super) fn at_fit<'a>(
    fit: Fit<'a>,
    options: &DiagnosisOptions,
    mut ranking: Vec<Ranked>,
    start: &[f64],
) -> Inference<'a> {
    let expected = EXPECTED_PER_ALPHA * options.alpha;
    let at = LinearFit::new(&fit, expected, false).starting_at(start);
    let (_, hyper) = at.own_evidence();
    let at = at.starting_at(&hyper.variance);
    let columns = at.columns(&at.present);
    // The fit is of the likeliest set, but for rounding of the linear comparison.
    if let Some(own) = ranking.iter().position(|r| is_same(&r.causes, &fit.causes)) {
        let own = ranking.remove(own);
        ranking.insert(
            0,
            Ranked {
                causes: fit.causes.clone(),
                ..own
            },
        );
    }
    let LinearFit {
        linear,
        catalogue,
        present,
        ..
    } = at;
    Inference {
        ranking,
        linear,
        at: hyper,
        columns,
        catalogue,
        present,
        fit,
    }
}

/// The same causes, in whatever order.
pub(super) fn is_same(one: &[Cause], other: &[Cause]) -> bool {
    let contains = |all: &[Cause], cause: &Cause| all.iter().any(|c| is_same_cause(c, cause));
    one.len() == other.len() && one.iter().all(|cause| contains(other, cause))
}

/// Same effect and targets; an event at the same pose.
pub(super) fn is_same_cause(one: &Cause, other: &Cause) -> bool {
    let pose = one.effect().pose_parameter();
    is_alike(one, other)
        && pose.is_none_or(|k| one.instances[0].values[k] == other.instances[0].values[k])
}
