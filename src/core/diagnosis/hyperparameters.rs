//! Estimates the sizes of noise and of mild model error, given a set of causes.
//!
//! Each class of readings has a variance factor and an amplitude of its [`super::background`]. The variance factors are
//! estimated by restricted maximum likelihood with inverse gamma priors, which are centred on 1 for a kind of reading
//! and on the factor of the kind for a cable. In each step a variance becomes the mean of the squared estimated errors
//! over their redundancy (Helmert 1907, Foerstner 1979). Amplitudes are chosen on a grid by their evidence, which the
//! eigenvalues of the functions' information give for all amplitudes at once.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::Quantity;
use super::background::{Group, Shape};
use super::budget::{HYPER_CONVERGED, MAX_HYPER_STEPS, RIDGE, TOLERATED_DECREASE};
use super::conditions::{Conditions, Noise, concatenate_columns};
use super::dense::{divide_by_lower, transposed_times};
use super::priors::{
    AMPLITUDES, CABLE_VARIANCE_WEIGHT, FACTORS, FIRST_FACTOR, KIND_VARIANCE_WEIGHT, NO_BACKGROUND,
    SAME_AS_KIND, VARIANCES,
};
use super::reading_errors::ReadingErrors;
use super::reduced_problem::ReducedProblem;
use crate::evidence::{self, of_size, principal};

/// Variance factor of each class of readings, and amplitude of each background shape.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hyperparameters {
    pub variance: Vec<f64>,
    /// Indices into [`AMPLITUDES`].
    pub amplitude: Vec<usize>,
    /// Index of the factor of the tolerances in [`FACTORS`].
    pub factor: usize,
    /// Log prior density.
    pub log_prior: f64,
}

impl Hyperparameters {
    /// Whether two points are so far apart that their probabilities differ notably.
    pub fn is_far_from(&self, other: &Self) -> bool {
        let far = |(a, b): (&f64, &f64)| (a / b).ln().abs() > 0.3;
        self.amplitude != other.amplitude
            || self.factor.abs_diff(other.factor) > 1
            || self.variance.iter().zip(&other.variance).any(far)
    }

    /// Whether a variance exceeds twice the described one, or the background is large: much of the readings is unexplained.
    pub fn is_noisy(&self) -> bool {
        self.variance.iter().any(|v| *v > 2.0) || self.amplitude.iter().any(|a| *a > 2)
    }
}

/// The linear problem without candidate causes.
pub(super) struct LinearProblem {
    pub conditions: Conditions,
    /// Residuals as conditions, minus the contributions of the causes of the fit.
    pub residual: DVector<f64>,
    /// Derivatives with respect to the parameters that are always estimated.
    pub fixed: DMatrix<f64>,
    /// Derivatives with respect to the combinations of the deviations of parts.
    pub deviations: DMatrix<f64>,
    pub shapes: Vec<Shape>,
}

/// Variance factors at which their estimation starts; `None` for the noise as described. From louder noise than there
/// is, the estimation would not find a background; from quieter noise it would try one in every class.
pub(super) type Start<'s> = Option<&'s [f64]>;

/// Estimated hyperparameters.
pub(super) struct Estimate<'l> {
    pub hyper: Hyperparameters,
    /// Log posterior density at the hyperparameters.
    pub log_density: f64,
    /// The problem reduced at the hyperparameters.
    pub base: ReducedProblem<'l>,
}

/// Next points of the iteration.
struct Step {
    /// All amplitudes that raise the density are changed.
    all: Hyperparameters,
    /// Only the amplitude or factor with the largest gain is changed.
    strongest: Hyperparameters,
    /// Whether the change is so small that the iteration has converged.
    is_small: bool,
}

impl LinearProblem {
    /// Hyperparameters with the same variance factor for all classes, no background and exact parts.
    pub fn with_variance_factor(&self, factor: f64) -> Hyperparameters {
        let classes = self.conditions.classes.len();
        self.with_prior(vec![factor; classes], vec![0; self.shapes.len()], 0)
    }

    /// Hyperparameters with noise as described, no background and a factor of the tolerances.
    pub fn described(&self, factor: usize) -> Hyperparameters {
        let classes = self.conditions.classes.len();
        self.with_prior(vec![1.0; classes], vec![0; self.shapes.len()], factor)
    }

    /// Groups the indices of shapes by kind of reading and group of functions.
    fn kinds_of_shapes(&self) -> Vec<Vec<usize>> {
        let kind = |shape: &Shape| (self.conditions.classes[shape.class].quantity, shape.group);
        let mut kinds: BTreeMap<(Quantity, Group), Vec<usize>> = BTreeMap::new();
        for (index, shape) in self.shapes.iter().enumerate() {
            kinds.entry(kind(shape)).or_default().push(index);
        }
        kinds.into_values().collect()
    }

    /// Number of cables with readings.
    pub fn cables(&self) -> usize {
        let classes = self.conditions.classes.iter();
        classes
            .filter_map(|id| id.cable)
            .max()
            .map_or(0, |last| last + 1)
    }

    fn kinds(&self) -> Vec<(Quantity, Vec<usize>)> {
        let mut kinds: Vec<(Quantity, Vec<usize>)> = Vec::new();
        for (class, id) in self.conditions.classes.iter().enumerate() {
            match kinds.last_mut() {
                Some((quantity, classes)) if *quantity == id.quantity => classes.push(class),
                _ => kinds.push((id.quantity, vec![class])),
            }
        }
        kinds
    }

    fn with_prior(
        &self,
        variance: Vec<f64>,
        amplitude: Vec<usize>,
        factor: usize,
    ) -> Hyperparameters {
        // Log density of an inverse gamma prior with respect to the log variance, normalised to 0 at its mode.
        let density = |ratio: f64, worth: f64| 0.5 * worth * (1.0 - ratio.ln() - ratio.recip());
        let mut log_prior = 0.0;
        for (_, classes) in self.kinds() {
            let mean =
                classes.iter().map(|k| variance[*k].ln()).sum::<f64>() / classes.len() as f64;
            log_prior += density(mean.exp(), KIND_VARIANCE_WEIGHT);
            for class in &classes {
                log_prior += density(variance[*class] / mean.exp(), CABLE_VARIANCE_WEIGHT);
            }
        }
        for shapes in self.kinds_of_shapes() {
            let of_kind = |kind: usize| {
                let each = shapes
                    .iter()
                    .map(|k| log_amplitude_prior(amplitude[*k], kind, shapes.len()));
                log_kind_prior(kind) + each.sum::<f64>()
            };
            log_prior += (0..AMPLITUDES.len())
                .map(of_kind)
                .fold(f64::NEG_INFINITY, f64::max);
        }
        Hyperparameters {
            variance,
            amplitude,
            factor,
            log_prior,
        }
    }

    /// Eliminates the background, the deviations of the parts and the parameters that are always estimated at the
    /// hyperparameters `hyper`, and also `further` columns whose parameters have prior variance 1.
    pub fn reduced(&self, hyper: &Hyperparameters, further: &DMatrix<f64>) -> ReducedProblem<'_> {
        let noise = self.conditions.noise(&hyper.variance);
        let present = self.shapes.iter().zip(&hyper.amplitude);
        let present: Vec<(&Shape, f64)> = present
            .filter(|(_, amplitude)| **amplitude > 0)
            .map(|(shape, amplitude)| (shape, AMPLITUDES[*amplitude]))
            .collect();
        let factor = FACTORS[hyper.factor];
        let deviations = match factor > 0.0 {
            true => &self.deviations * factor,
            false => DMatrix::zeros(self.conditions.count, 0),
        };
        let mut others = concatenate_columns(&[&self.fixed, further, &deviations]);
        noise.whiten(&mut others);
        let whitened = self.whitened(&noise);
        let mut residual = whitened.clone();
        let mut log_determinant = noise.log_determinant;
        let fixed = self.fixed.ncols();
        for mut column in others.columns_mut(0, fixed).column_iter_mut() {
            let norm = column.norm();
            if norm > 0.0 {
                column /= norm;
                log_determinant += 2.0 * norm.ln();
            }
        }
        let background = Background::new(&noise, &present);
        let mut eliminated = background.rows_after(&others);
        let mut normal = background.normal_matrix(&eliminated, &others);
        for k in 0..normal.nrows() {
            normal[(k, k)] += if k < fixed { RIDGE } else { 1.0 };
        }
        if let Some(factor) = normal.cholesky() {
            log_determinant += evidence::log_determinant(&factor);
            divide_by_lower(factor.l_dirty(), &mut eliminated);
        }
        residual -= eliminated.tr_mul(&(&eliminated * &residual));
        // With priors the projection is not idempotent, so the square has to be `y^T P y`.
        let square = whitened.dot(&residual);
        ReducedProblem {
            noise,
            eliminated,
            chi2: square,
            log_evidence: -0.5 * (log_determinant + square),
            residual,
        }
    }

    fn whitened(&self, noise: &Noise<'_>) -> DVector<f64> {
        let mut y = DMatrix::from_column_slice(self.residual.len(), 1, self.residual.as_slice());
        noise.whiten(&mut y);
        y.column(0).into_owned()
    }

    fn at_start(&self, start: Start<'_>, amplitude: Vec<usize>, factor: usize) -> Hyperparameters {
        let described = || vec![1.0; self.conditions.classes.len()];
        let variance = start.map_or_else(described, <[f64]>::to_vec);
        self.with_prior(variance, amplitude, factor)
    }

    fn estimate_at(&self, hyper: Hyperparameters, further: &DMatrix<f64>) -> Estimate<'_> {
        let base = self.reduced(&hyper, further);
        Estimate {
            log_density: base.log_evidence + hyper.log_prior,
            hyper,
            base,
        }
    }

    /// Estimates the hyperparameters of largest posterior density given further columns, starting without background.
    ///
    /// Readings of several cables may show the same error, and the background and the deviations of the parts, too. If
    /// changing all of them at once lowers the density, only the one with the largest gain is changed.
    pub fn estimate(&self, start: Start<'_>, further: &DMatrix<f64>) -> Estimate<'_> {
        let factor = match self.deviations.ncols() {
            0 => 0,
            _ => FIRST_FACTOR,
        };
        let start = self.at_start(start, vec![0; self.shapes.len()], factor);
        let mut best = self.estimate_at(start, further);
        let mut step = self.step(&best);
        let mut next = step.all.clone();
        for _ in 1..MAX_HYPER_STEPS {
            if step.is_small {
                break;
            }
            let reached = self.estimate_at(next, further);
            if reached.log_density < best.log_density - TOLERATED_DECREASE {
                if step.strongest == reached.hyper {
                    break;
                }
                next = step.strongest.clone();
                continue;
            }
            best = reached;
            step = self.step(&best);
            next = step.all.clone();
        }
        best
    }

    /// The step from an estimate: variances from the residuals, amplitudes by their evidence.
    fn step(&self, from: &Estimate<'_>) -> Step {
        let (hyper, base) = (&from.hyper, &from.base);
        let evidence = self.amplitude_evidence(base, hyper);
        let amplitude = self.amplitudes(&evidence);
        let gain = |k: &usize| evidence[*k][amplitude[*k]] - evidence[*k][hyper.amplitude[*k]];
        let changed = (0..amplitude.len()).filter(|k| amplitude[*k] != hyper.amplitude[*k]);
        let strongest = changed.max_by(|a, b| gain(a).total_cmp(&gain(b)));
        let of_factor = self.factor_evidence(base, hyper);
        let best = |a: &usize, b: &usize| of_factor[*a].total_cmp(&of_factor[*b]);
        let factor = (0..FACTORS.len()).max_by(best).unwrap_or(hyper.factor);
        let gain_of_factor = of_factor[factor] - of_factor[hyper.factor];
        let mut single = hyper.amplitude.clone();
        let mut single_factor = hyper.factor;
        match strongest {
            Some(k) if gain(&k) > gain_of_factor => single[k] = amplitude[k],
            _ => single_factor = factor,
        }
        let variance = self.next_variances(base);
        let change = hyper.variance.iter().zip(&variance);
        let change = change.map(|(a, b)| (a / b).ln().abs()).fold(0.0, f64::max);
        Step {
            is_small: change < HYPER_CONVERGED && strongest.is_none() && factor == hyper.factor,
            strongest: self.with_prior(variance.clone(), single, single_factor),
            all: self.with_prior(variance, amplitude, factor),
        }
    }

    /// Estimates the variances for given amplitudes, a given factor of the tolerances and further columns.
    pub fn with_amplitudes(
        &self,
        start: Start<'_>,
        (amplitude, factor): (&[usize], usize),
        further: &DMatrix<f64>,
    ) -> Estimate<'_> {
        let start = self.at_start(start, amplitude.to_vec(), factor);
        self.refined(&start, further)
    }

    /// The same, starting from hyperparameters whose amplitudes and factor are kept.
    pub fn refined(&self, from: &Hyperparameters, further: &DMatrix<f64>) -> Estimate<'_> {
        let mut reached = self.estimate_at(from.clone(), further);
        for _ in 1..MAX_HYPER_STEPS {
            let variance = self.next_variances(&reached.base);
            let next = self.with_prior(variance, from.amplitude.clone(), from.factor);
            let before = reached.log_density;
            reached = self.estimate_at(next, further);
            if reached.log_density - before < TOLERATED_DECREASE {
                break;
            }
        }
        reached
    }

    /// Variances from the residuals of a reduced problem.
    fn next_variances(&self, base: &ReducedProblem<'_>) -> Vec<f64> {
        let sums = base.noise.class_sums(&base.residual, &base.eliminated);
        let mut variance = vec![1.0; sums.len()];
        for (_, classes) in self.kinds() {
            let total = |k: usize| classes.iter().map(|class| sums[*class][k]).sum::<f64>();
            let kind = (total(0) + KIND_VARIANCE_WEIGHT) / (total(1) + KIND_VARIANCE_WEIGHT);
            for class in classes {
                let [squares, redundancy] = sums[class];
                let shrunk =
                    (squares + CABLE_VARIANCE_WEIGHT * kind) / (redundancy + CABLE_VARIANCE_WEIGHT);
                variance[class] = shrunk.clamp(VARIANCES[0], VARIANCES[1]);
            }
        }
        variance
    }

    /// Log evidence of each factor of the tolerances relative to exact parts, all else as it is. The factors have equal
    /// prior probabilities.
    pub fn factor_evidence(
        &self,
        base: &ReducedProblem<'_>,
        hyper: &Hyperparameters,
    ) -> [f64; FACTORS.len()] {
        if self.deviations.ncols() == 0 {
            return std::array::from_fn(|k| {
                if k == hyper.factor {
                    0.0
                } else {
                    f64::NEG_INFINITY
                }
            });
        }
        let mut columns = self.deviations.clone();
        base.noise.whiten(&mut columns);
        let score = columns.tr_mul(&base.residual);
        let eliminated = &base.eliminated * &columns;
        let information =
            transposed_times(&columns, &columns) - transposed_times(&eliminated, &eliminated);
        evidence_of_sizes(score, information, FACTORS[hyper.factor], &FACTORS)
    }

    /// Amplitudes of largest posterior probability, each conditional on the present values of the others.
    fn amplitudes(&self, by_shape: &[[f64; AMPLITUDES.len()]]) -> Vec<usize> {
        let mut chosen = vec![0; self.shapes.len()];
        for shapes in self.kinds_of_shapes() {
            let best = |shape: usize, kind: usize| {
                let value =
                    |k: usize| by_shape[shape][k] + log_amplitude_prior(k, kind, shapes.len());
                let places = 0..AMPLITUDES.len();
                let best = places.max_by(|a, b| value(*a).total_cmp(&value(*b)));
                best.map_or((0, 0.0), |k| (k, value(k)))
            };
            let total = |kind: usize| {
                log_kind_prior(kind) + shapes.iter().map(|s| best(*s, kind).1).sum::<f64>()
            };
            let kind = (0..AMPLITUDES.len()).max_by(|a, b| total(*a).total_cmp(&total(*b)));
            for shape in &shapes {
                chosen[*shape] = best(*shape, kind.unwrap_or(0)).0;
            }
        }
        chosen
    }

    /// Log evidence of each amplitude of each shape relative to amplitude zero, the others as they are.
    fn amplitude_evidence(
        &self,
        base: &ReducedProblem<'_>,
        hyper: &Hyperparameters,
    ) -> Vec<[f64; AMPLITUDES.len()]> {
        let mut of_class: Option<(usize, ReadingErrors)> = None;
        let mut evidence = Vec::with_capacity(self.shapes.len());
        for (shape, present) in self.shapes.iter().zip(&hyper.amplitude) {
            // Shapes of one class are adjacent, so that its reading errors can be reused.
            let errors = match of_class.take() {
                Some((class, errors)) if class == shape.class => errors,
                _ => ReadingErrors::new(base, &[shape.class]),
            };
            let (score, information) = errors.of(&shape.functions);
            of_class = Some((shape.class, errors));
            evidence.push(evidence_of_sizes(
                score,
                information,
                AMPLITUDES[*present],
                &AMPLITUDES,
            ));
        }
        evidence
    }
}

/// Log evidence of each size of some columns relative to size 0, from their score and information in a problem in which
/// they have the size `present`. A size is the standard deviation of each coefficient.
fn evidence_of_sizes<const N: usize>(
    score: DVector<f64>,
    information: DMatrix<f64>,
    present: f64,
    sizes: &[f64; N],
) -> [f64; N] {
    let mut along = principal(&score, information);
    for [information, score] in &mut along {
        // Removes the size that the columns have at present.
        let remaining = (1.0 - present * present * *information).max(1e-12);
        *information /= remaining;
        *score /= remaining;
    }
    sizes.map(|size| {
        let [gain, price] = of_size(&along, size);
        0.5 * (gain - price)
    })
}

/// Background functions as whitened conditions. A function is its value at each pose times the whitened unit error of
/// its class there, so their products need one row per pose instead of one per condition.
struct Background {
    parts: Vec<BackgroundPart>,
    /// For each class with a background, the whitened unit error at each pose: index of the first condition, and values.
    errors: BTreeMap<usize, Vec<(usize, DVector<f64>)>>,
}

/// The functions of one shape.
struct BackgroundPart {
    class: usize,
    /// One column per pose.
    functions: DMatrix<f64>,
}

impl Background {
    /// The functions of some shapes, with their amplitudes.
    fn new(noise: &Noise<'_>, shapes: &[(&Shape, f64)]) -> Self {
        let part = |(shape, amplitude): &(&Shape, f64)| BackgroundPart {
            class: shape.class,
            functions: shape.all_functions().transpose() * *amplitude,
        };
        let classes = shapes.iter().map(|(shape, _)| shape.class);
        Self {
            parts: shapes.iter().map(part).collect(),
            errors: classes
                .map(|class| (class, noise.unit_errors(&[class])))
                .collect(),
        }
    }

    /// `Z^T` for other columns followed by the background functions.
    fn rows_after(&self, others: &DMatrix<f64>) -> DMatrix<f64> {
        let functions: usize = self.parts.iter().map(|part| part.functions.nrows()).sum();
        let mut rows = DMatrix::zeros(others.ncols() + functions, others.nrows());
        rows.rows_mut(0, others.ncols())
            .copy_from(&others.transpose());
        let mut start = others.ncols();
        for part in &self.parts {
            let count = part.functions.nrows();
            let poses = self.errors[&part.class]
                .iter()
                .zip(part.functions.column_iter());
            for ((first, error), values) in poses {
                for (k, error) in error.iter().enumerate() {
                    let mut to = rows.view_mut((start, first + k), (count, 1));
                    to.copy_from(&values);
                    to *= *error;
                }
            }
            start += count;
        }
        rows
    }

    /// Lower triangle of `Z^T Z` for `Z^T` as returned by `rows_after`.
    fn normal_matrix(&self, rows: &DMatrix<f64>, others: &DMatrix<f64>) -> DMatrix<f64> {
        let mut normal = DMatrix::zeros(rows.nrows(), rows.nrows());
        let with_others = rows * others;
        normal
            .columns_mut(0, others.ncols())
            .copy_from(&with_others);
        let mut column = others.ncols();
        for (index, part) in self.parts.iter().enumerate() {
            let mut row = column;
            for other in &self.parts[index..] {
                let mut weighted = part.functions.clone();
                let poses = self.errors[&part.class]
                    .iter()
                    .zip(&self.errors[&other.class]);
                for (mut values, ((_, one), (_, another))) in weighted.column_iter_mut().zip(poses)
                {
                    values *= one.dot(another);
                }
                let products = &other.functions * weighted.transpose();
                normal
                    .view_mut((row, column), products.shape())
                    .copy_from(&products);
                row += products.nrows();
            }
            column += part.functions.nrows();
        }
        normal
    }
}

fn log_kind_prior(kind: usize) -> f64 {
    let others = (AMPLITUDES.len() - 1) as f64;
    if kind == 0 {
        NO_BACKGROUND
    } else {
        (1.0 - NO_BACKGROUND) / others
    }
    .ln()
}

/// Log prior probability of the amplitude of one of `classes` classes, given the amplitude of its kind.
fn log_amplitude_prior(amplitude: usize, kind: usize, classes: usize) -> f64 {
    let others = (AMPLITUDES.len() - 1) as f64;
    if classes == 1 {
        return if amplitude == kind {
            0.0
        } else {
            f64::NEG_INFINITY
        };
    }
    if amplitude == kind {
        SAME_AS_KIND
    } else {
        (1.0 - SAME_AS_KIND) / others
    }
    .ln()
}
