//! Estimates the actual noise of each kind of reading.
//!
//! If the noise variance of class `a` of the readings is `theta_a` times the described one, the squared residuals have
//! the expectation `E[r_a^T r_a] = sum_b tr(M_ab M_ba) theta_b`. Solving this for `theta`, reweighting all rows and
//! repeating until convergence is restricted maximum likelihood by Fisher scoring (Helmert 1907, Foerstner 1979;
//! Searle, Casella and McCulloch, Variance Components, section 6.6). The covariance of `theta` is `2 F^-1` with
//! `F_ab = tr(M_ab M_ba)` in the final weights, so `theta_a` is as accurate as a variance from `1 / (F^-1)_aa` degrees
//! of freedom; interval and p-value are those of the corresponding chi-square variable. The noise of equilibrium
//! equations and priors is not changed.
//!
//! All of this happens in the linearised problem. Readings whose residuals depend on a variable do not show pure noise.
//! They get a variance of their own, so that they do not affect the others, and no statement is made about it.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Cholesky, DMatrix, DVector};

use super::adequacy::classes;
use super::budget::{
    MAX_VARIANCE_STEPS, MIN_CABLES, MIN_FREEDOM, MIN_VARIANCE_STEP, VARIANCE_CONVERGED,
};
use super::reading_id::ReadingId;
use super::residual_space::{ClassSums, ResidualSpace};
use super::{Discrepancy, NoiseStatement, Quantity};
use crate::statistics::{chi_square_quantile, chi_square_two_sided};

/// Readings with a common variance: a kind of reading, or one cable of it.
pub(super) type Class = (Quantity, Option<usize>);

/// Classes with a variance of their own, with the start values of the estimation.
pub(super) type SeparateVariances = BTreeMap<Class, f64>;

/// Kinds of readings, and single cables that differ clearly from the others, whose noise is larger or smaller than
/// described, at level `alpha` for all tests together. Readings with `discrepancies` are excluded.
pub(crate) fn noise_statements(
    space: &ResidualSpace,
    discrepancies: &[Discrepancy],
    alpha: f64,
) -> Vec<NoiseStatement> {
    let structured: BTreeSet<Class> = discrepancies
        .iter()
        .map(|d| (d.quantity, d.cable))
        .collect();
    let test_count = test_count(space);
    let separate = start_variances(space, &structured);
    let estimate = VarianceEstimate::with_outlying_variances(space, separate, alpha / test_count);
    let statements = (0..estimate.classes.len()).filter_map(|class| estimate.statement(class));
    statements
        .map(|statement| NoiseStatement {
            p_value: (statement.p_value * test_count).min(1.0),
            ..statement
        })
        .filter(|s| s.p_value < alpha && !structured.contains(&(s.quantity, s.cable)))
        .collect()
}

/// Variance of each class of readings over the described one; 1 where it is not significantly larger at level `level`.
pub(super) fn excess_variances(space: &ResidualSpace, level: f64) -> Vec<f64> {
    let mut estimate =
        VarianceEstimate::with_outlying_variances(space, SeparateVariances::new(), level);
    for class in 0..estimate.classes.len() {
        let statement = estimate.statement(class);
        if !statement.is_some_and(|s| s.ratio > 1.0 && s.p_value < level) {
            estimate.variance[class] = 1.0;
        }
    }
    estimate.variances_of_classes()
}

/// Statements on all classes whose variance can be estimated, whatever their significance. The cables in `separate`
/// have a variance of their own, and p-values are not corrected for the number of tests.
#[cfg(test)]
pub(super) fn noise_of_all(
    space: &ResidualSpace,
    separate: &SeparateVariances,
) -> Vec<NoiseStatement> {
    let estimate = VarianceEstimate::new(space, separate, None);
    let classes = 0..estimate.classes.len();
    classes
        .filter_map(|class| estimate.statement(class))
        .collect()
}

/// Mean squared residuals of the chosen classes, at least those of the described noise, as start values. From too small
/// a variance the estimation would attribute their excess to other classes.
fn start_variances(space: &ResidualSpace, chosen: &BTreeSet<Class>) -> SeparateVariances {
    let (classes, of_row) = classes(space, |id| (id.quantity, id.cable));
    let sums = space.class_sums(&of_row, classes.len());
    let mean_square = |k: usize| (sums.squares[k] / sums.traces[k].max(1e-6)).max(1.0);
    let places = classes.into_iter().enumerate();
    places
        .filter(|(_, class)| chosen.contains(class))
        .map(|(k, class)| (class, mean_square(k)))
        .collect()
}

/// Number of variances that are tested.
fn test_count(space: &ResidualSpace) -> f64 {
    let ids = space.readings.iter().flatten();
    let tested = ids.flat_map(|id| [(id.quantity, None), (id.quantity, id.cable)]);
    tested.collect::<BTreeSet<Class>>().len() as f64
}

/// Class of a reading when the cables in `separate` have a variance of their own.
fn class_of(id: &ReadingId, separate: &SeparateVariances) -> Class {
    let class = (id.quantity, id.cable);
    (
        id.quantity,
        id.cable.filter(|_| separate.contains_key(&class)),
    )
}

/// Estimated variances of classes of readings.
struct VarianceEstimate {
    classes: Vec<Class>,
    /// Variance over the described one.
    variance: Vec<f64>,
    /// Degrees of freedom of each variance; `None` if it was not estimated.
    freedom: Vec<Option<f64>>,
    /// Class of each row.
    of_row: Vec<Option<usize>>,
    /// The residuals weighted with these variances.
    space: ResidualSpace,
}

impl VarianceEstimate {
    /// Estimates the variances, starting from those in `separate`, else from those of an estimate with fewer classes,
    /// else from the described ones.
    fn new(space: &ResidualSpace, separate: &SeparateVariances, from: Option<&Self>) -> Self {
        let (classes, of_row) = classes(space, |id| class_of(id, separate));
        let start = |class: &Class| {
            let before = || from.and_then(|from| from.variance_of(class));
            separate.get(class).copied().or_else(before).unwrap_or(1.0)
        };
        let mut estimate = Self {
            variance: classes.iter().map(start).collect(),
            freedom: vec![None; classes.len()],
            classes,
            of_row,
            space: space.clone(),
        };
        if estimate.variance.iter().any(|variance| *variance != 1.0) {
            estimate.space = space.with_variances(&estimate.variances_of_classes());
        }
        for _ in 0..MAX_VARIANCE_STEPS {
            let sums = estimate
                .space
                .class_sums(&estimate.of_row, estimate.classes.len());
            let step = VarianceStep::new(&sums);
            estimate.freedom.clone_from(&step.freedom);
            let change = step.factors.iter().map(|factor| (factor - 1.0).abs());
            if change.fold(0.0, f64::max) < VARIANCE_CONVERGED {
                break;
            }
            for (variance, factor) in estimate.variance.iter_mut().zip(&step.factors) {
                *variance *= factor;
            }
            estimate.space = space.with_variances(&estimate.variances_of_classes());
        }
        estimate
    }

    /// Estimates variances with a separate one for each cable that differs from the others of its kind at level
    /// `level`, in addition to those in `separate`.
    fn with_outlying_variances(
        space: &ResidualSpace,
        mut separate: SeparateVariances,
        level: f64,
    ) -> Self {
        let mut estimate = Self::new(space, &separate, None);
        while let Some((class, variance)) = estimate.outlying_variance(&separate, level) {
            for (class, start) in &mut separate {
                *start = estimate.variance_of(class).unwrap_or(*start);
            }
            separate.insert(class, variance);
            estimate = Self::new(space, &separate, Some(&estimate));
        }
        estimate
    }

    /// Variance of a class over the described one, if it has one of its own.
    fn variance_of(&self, class: &Class) -> Option<f64> {
        let index = self.classes.iter().position(|c| c == class)?;
        Some(self.variance[index])
    }

    /// Variance of each class of readings of the residual space over the described one.
    fn variances_of_classes(&self) -> Vec<f64> {
        let variance_of_id = |id: &ReadingId| {
            let separate = self.variance_of(&(id.quantity, id.cable));
            let variance = separate.or_else(|| self.variance_of(&(id.quantity, None)));
            variance.unwrap_or(1.0)
        };
        self.space.classes().iter().map(variance_of_id).collect()
    }

    /// Statement on one variance, with an uncorrected p-value; `None` if it was not estimated.
    fn statement(&self, class: usize) -> Option<NoiseStatement> {
        let (quantity, cable) = self.classes[class];
        let freedom = self.freedom[class]?;
        let variance = self.variance[class];
        let bound = |p: f64| {
            let quantile = chi_square_quantile(p, freedom)?;
            Some((variance * freedom / quantile).sqrt())
        };
        Some(NoiseStatement {
            quantity,
            cable,
            ratio: variance.sqrt(),
            interval: [bound(0.975)?, bound(0.025)?],
            p_value: chi_square_two_sided(variance * freedom, freedom)?,
        })
    }

    /// The cable that differs most from the others of its kind, if significantly at level `level`, with its mean
    /// square. This is the score test of a separate variance.
    fn outlying_variance(&self, separate: &SeparateVariances, level: f64) -> Option<(Class, f64)> {
        let (cables, of_row) = classes(&self.space, |id| (id.quantity, id.cable));
        let sums = self.space.class_sums(&of_row, cables.len());
        let common = |class: &&Class| class.1.is_some() && !separate.contains_key(*class);
        let enough = |quantity: Quantity| {
            let same = cables.iter().filter(common).filter(|c| c.0 == quantity);
            same.count() >= MIN_CABLES
        };
        let probability = |(k, class): (usize, &Class)| {
            let (factor, freedom) = sums.scaled_chi_square(k)?;
            let p = chi_square_two_sided(sums.squares[k] / factor, freedom)?;
            Some((*class, p, sums.squares[k] / sums.traces[k]))
        };
        let (class, _, ratio) = cables
            .iter()
            .enumerate()
            .filter(|(_, class)| common(class) && enough(class.0))
            .filter_map(probability)
            .filter(|(_, p, _)| *p < level)
            // The ratio decides where p-values underflow.
            .min_by(|a, b| a.1.total_cmp(&b.1).then(b.2.total_cmp(&a.2)))?;
        let kind = self.classes.iter().position(|c| *c == (class.0, None));
        let others = kind.map_or(1.0, |k| self.variance[k]);
        Some((class, others * ratio))
    }
}

/// One Fisher scoring step.
struct VarianceStep {
    /// Factor by which each variance changes.
    factors: Vec<f64>,
    freedom: Vec<Option<f64>>,
}

impl VarianceStep {
    fn new(sums: &ClassSums) -> Self {
        let count = sums.traces.len();
        let mut step = Self {
            factors: vec![1.0; count],
            freedom: vec![None; count],
        };
        let (estimated, inverse) = estimable(sums);
        let excess = DVector::from_iterator(
            estimated.len(),
            estimated.iter().map(|k| sums.squares[*k] - sums.traces[*k]),
        );
        let change = &inverse * excess;
        for (k, class) in estimated.iter().enumerate() {
            let scored = 1.0 + change[k];
            // The ratio to the expectation is always positive and has the same fixed point.
            let mean_square = sums.squares[*class] / sums.traces[*class];
            step.factors[*class] = if scored > MIN_VARIANCE_STEP {
                scored
            } else {
                mean_square.max(MIN_VARIANCE_STEP)
            };
            step.freedom[*class] = Some(inverse[(k, k)].recip());
        }
        step
    }
}

/// The classes whose variances can be separated, with the inverse of their information. The least determined class is
/// removed until all have enough degrees of freedom.
fn estimable(sums: &ClassSums) -> (Vec<usize>, DMatrix<f64>) {
    let seen = |class: &usize| sums.information[(*class, *class)] > MIN_FREEDOM;
    let mut kept: Vec<usize> = (0..sums.traces.len()).filter(seen).collect();
    while !kept.is_empty() {
        let information = sums.information.select_rows(&kept).select_columns(&kept);
        let alone = information.diagonal();
        let inverse = Cholesky::new(information).map(|c| c.inverse());
        // If the information is singular, the class with the least redundancy is removed.
        let freedom = |k: &usize| inverse.as_ref().map_or(alone[*k], |i| i[(*k, *k)].recip());
        let worst = (0..kept.len()).min_by(|a, b| freedom(a).total_cmp(&freedom(b)));
        match (worst, inverse) {
            (Some(worst), Some(inverse)) if inverse[(worst, worst)].recip() >= MIN_FREEDOM => {
                return (kept, inverse);
            }
            (Some(worst), _) => drop(kept.remove(worst)),
            (None, _) => break,
        }
    }
    (kept, DMatrix::zeros(0, 0))
}
