//! Estimates the sizes of noise and of mild model error, given a set of causes.
//!
//! Each class of readings has a variance factor and an amplitude of its [`super::background`]. The variance factors are
//! estimated by restricted maximum likelihood with inverse gamma priors, which are centred on 1 for a kind of reading
//! and on the factor of the kind for a cable. In each step a variance becomes the mean of the squared estimated errors
//! over their redundancy (Helmert 1907, Foerstner 1979). Amplitudes are chosen on a grid by their evidence, which the
//! eigenvalues of the functions' information give for all amplitudes at once.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DMatrixView, DMatrixViewMut, DVector, SymmetricEigen};

use super::Quantity;
use super::background::{Group, Shape};
use super::conditions::{Conditions, Noise, concatenate_columns};
use super::reading_errors::ReadingErrors;

/// Grid of amplitudes, in standard deviations of the readings as described.
pub(super) const AMPLITUDES: [f64; 8] = [0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
/// Prior probabilities that a kind of reading has no background, and that a class has the amplitude of its kind.
const NO_BACKGROUND: f64 = 0.7;
const SAME_AS_KIND: f64 = 0.85;
/// Weights of the variance priors in numbers of readings: of a kind around 1, and of a cable around its kind.
const KIND_PRIOR: f64 = 1.0;
const CABLE_PRIOR: f64 = 60.0;
/// Bounds of the variance factors.
const VARIANCES: [f64; 2] = [1e-3, 1e5];
/// Maximum number of steps of the estimation, and the largest change of a log variance at convergence.
const MAX_STEPS: usize = 12;
const CONVERGED: f64 = 0.05;
/// Decrease of the log posterior density that a step may cause.
const TOLERATED_DECREASE: f64 = 0.05;
/// Regularises directions of the fixed parameters that the data do not determine.
pub(super) const RIDGE: f64 = 1e-11;

/// Variance factor of each class of readings, and amplitude of each background shape.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hyperparameters {
    pub variance: Vec<f64>,
    /// Indices into [`AMPLITUDES`].
    pub amplitude: Vec<usize>,
    /// Log prior density.
    pub log_prior: f64,
}

impl Hyperparameters {
    /// Whether two points differ enough to give different probabilities.
    pub fn is_far_from(&self, other: &Self) -> bool {
        let far = |(a, b): (&f64, &f64)| (a / b).ln().abs() > 0.3;
        self.amplitude != other.amplitude || self.variance.iter().zip(&other.variance).any(far)
    }

    /// Whether noise or background is much larger than described, so that much is unexplained.
    pub fn is_noisy(&self) -> bool {
        self.variance.iter().any(|v| *v > 2.0) || self.amplitude.iter().any(|a| *a > 2)
    }
}

/// The linear problem without candidate causes.
pub(super) struct LinearProblem {
    pub conditions: Conditions,
    /// Residuals as conditions, minus what the causes of the fit explain.
    pub residual: DVector<f64>,
    /// Derivatives with respect to the parameters that are always estimated.
    pub fixed: DMatrix<f64>,
    pub shapes: Vec<Shape>,
    /// Variance factors at which their estimation starts, without background. From louder noise than there is, the
    /// estimation would not find a background; from quieter noise it would try one in every class.
    pub start: Vec<f64>,
}

/// The problem at given hyperparameters, with the background and the parameters that are always estimated eliminated.
pub(super) struct ReducedProblem<'l> {
    pub noise: Noise<'l>,
    /// `U^T`, where `1 - U U^T` is the projection of whitened conditions by the elimination.
    pub eliminated: DMatrix<f64>,
    /// Whitened and projected residual.
    pub residual: DVector<f64>,
    /// Weighted sum of squared residuals, including those of the parameters with priors.
    pub chi2: f64,
    /// Log density of the readings.
    pub log_evidence: f64,
}

impl LinearProblem {
    /// Hyperparameters with the same variance factor for all classes and no background.
    pub fn with_variance_factor(&self, factor: f64) -> Hyperparameters {
        let classes = self.conditions.classes.len();
        self.with_prior(vec![factor; classes], vec![0; self.shapes.len()])
    }

    /// Hyperparameters with noise as described and no background.
    pub fn described(&self) -> Hyperparameters {
        let classes = self.conditions.classes.len();
        self.with_prior(vec![1.0; classes], vec![0; self.shapes.len()])
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

    fn with_prior(&self, variance: Vec<f64>, amplitude: Vec<usize>) -> Hyperparameters {
        // Log density of an inverse gamma prior with respect to the log variance, normalised to 0 at its mode.
        let density = |ratio: f64, worth: f64| 0.5 * worth * (1.0 - ratio.ln() - ratio.recip());
        let mut log_prior = 0.0;
        for (_, classes) in self.kinds() {
            let mean =
                classes.iter().map(|k| variance[*k].ln()).sum::<f64>() / classes.len() as f64;
            log_prior += density(mean.exp(), KIND_PRIOR);
            for class in &classes {
                log_prior += density(variance[*class] / mean.exp(), CABLE_PRIOR);
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
            log_prior,
        }
    }

    /// Eliminates the background and the parameters that are always estimated at the hyperparameters `at`, and also
    /// `further` columns whose parameters have prior variance 1.
    pub fn reduced(&self, at: &Hyperparameters, further: &DMatrix<f64>) -> ReducedProblem<'_> {
        let noise = self.conditions.noise(&at.variance);
        let mut parts = vec![self.fixed.clone()];
        for (shape, amplitude) in self.shapes.iter().zip(&at.amplitude) {
            if *amplitude > 0 {
                parts.push(&shape.columns * AMPLITUDES[*amplitude]);
                parts.push(&shape.low_order * AMPLITUDES[*amplitude]);
            }
        }
        parts.push(further.clone());
        let mut z = concatenate_columns(&parts.iter().collect::<Vec<_>>());
        let width = z.ncols();
        noise.whiten(&mut z);
        let whitened = self.whitened(&noise);
        let mut residual = whitened.clone();
        let mut log_determinant = noise.log_determinant;
        let fixed = self.fixed.ncols();
        for mut column in z.columns_mut(0, fixed).column_iter_mut() {
            let norm = column.norm();
            if norm > 0.0 {
                column /= norm;
                log_determinant += 2.0 * norm.ln();
            }
        }
        let mut normal = z.transpose() * &z;
        for k in 0..width {
            normal[(k, k)] += if k < fixed { RIDGE } else { 1.0 };
        }
        let mut eliminated = z.transpose();
        if let Some(factor) = normal.cholesky() {
            log_determinant += 2.0 * factor.l_dirty().diagonal().map(f64::ln).sum();
            solve_lower(&factor.l_dirty().as_view(), &mut eliminated.as_view_mut());
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

    /// Estimates the hyperparameters of largest posterior density given further columns.
    ///
    /// Readings of several cables may show the same error. If changing all amplitudes at once lowers the density, only
    /// the amplitude with the largest gain is changed.
    pub fn estimate(&self, further: &DMatrix<f64>) -> Hyperparameters {
        let mut at = self.with_prior(self.start.clone(), vec![0; self.shapes.len()]);
        let mut best: Option<(f64, Hyperparameters, Hyperparameters)> = None;
        for _ in 0..MAX_STEPS {
            let base = self.reduced(&at, further);
            let value = base.log_evidence + at.log_prior;
            if let Some((least, _, instead)) = &mut best
                && value < *least - TOLERATED_DECREASE
            {
                if *instead == at {
                    break;
                }
                at = instead.clone();
                continue;
            }
            let evidence = self.amplitude_evidence(&base, &at);
            let amplitude = self.amplitudes(&evidence);
            let gain = |k: &usize| evidence[*k][amplitude[*k]] - evidence[*k][at.amplitude[*k]];
            let changed = (0..amplitude.len()).filter(|k| amplitude[*k] != at.amplitude[*k]);
            let strongest = changed.max_by(|a, b| gain(a).total_cmp(&gain(b)));
            let mut single = at.amplitude.clone();
            if let Some(k) = strongest {
                single[k] = amplitude[k];
            }
            let sums = base.noise.class_sums(&base.residual, &base.eliminated);
            let variance = self.variances(&sums);
            let change = at
                .variance
                .iter()
                .zip(&variance)
                .map(|(a, b)| (a / b).ln().abs());
            let settled = change.fold(0.0, f64::max) < CONVERGED && strongest.is_none();
            let instead = self.with_prior(variance.clone(), single);
            best = Some((value, at, instead));
            at = self.with_prior(variance, amplitude);
            if settled {
                break;
            }
        }
        best.map_or(at, |(_, best, _)| best)
    }

    /// Estimates the variances for given amplitudes and further columns. Also returns the log posterior density there.
    pub fn with_amplitudes(
        &self,
        amplitude: &[usize],
        further: &DMatrix<f64>,
    ) -> (f64, Hyperparameters) {
        let start = self.with_prior(self.start.clone(), amplitude.to_vec());
        self.refined(&start, further)
    }

    /// The same, starting from hyperparameters whose amplitudes are kept.
    pub fn refined(
        &self,
        from: &Hyperparameters,
        further: &DMatrix<f64>,
    ) -> (f64, Hyperparameters) {
        let mut at = from.clone();
        let mut value = f64::NEG_INFINITY;
        for _ in 0..MAX_STEPS {
            let base = self.reduced(&at, further);
            let before = std::mem::replace(&mut value, base.log_evidence + at.log_prior);
            if value - before < TOLERATED_DECREASE {
                break;
            }
            let sums = base.noise.class_sums(&base.residual, &base.eliminated);
            at = self.with_prior(self.variances(&sums), at.amplitude.clone());
        }
        (value, at)
    }

    fn variances(&self, sums: &[[f64; 2]]) -> Vec<f64> {
        let mut variance = vec![1.0; sums.len()];
        for (_, classes) in self.kinds() {
            let total = |k: usize| classes.iter().map(|class| sums[*class][k]).sum::<f64>();
            let kind = (total(0) + KIND_PRIOR) / (total(1) + KIND_PRIOR);
            for class in classes {
                let [squares, redundancy] = sums[class];
                let own = (squares + CABLE_PRIOR * kind) / (redundancy + CABLE_PRIOR);
                variance[class] = own.clamp(VARIANCES[0], VARIANCES[1]);
            }
        }
        variance
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
        at: &Hyperparameters,
    ) -> Vec<[f64; AMPLITUDES.len()]> {
        let mut of_class: Option<(usize, ReadingErrors)> = None;
        let mut all = Vec::with_capacity(self.shapes.len());
        for (shape, present) in self.shapes.iter().zip(&at.amplitude) {
            // Shapes of one class are adjacent, so that its reading errors can be reused.
            let errors = match of_class.take() {
                Some((class, errors)) if class == shape.class => errors,
                _ => ReadingErrors::new(base, &[shape.class]),
            };
            let (score, information) = errors.of(&shape.functions);
            of_class = Some((shape.class, errors));
            let mut evidence = [0.0; AMPLITUDES.len()];
            let eigen = SymmetricEigen::new(information);
            let along = eigen.eigenvectors.tr_mul(&score);
            let present = AMPLITUDES[*present].powi(2);
            for (value, along) in eigen.eigenvalues.iter().zip(along.iter()) {
                // Removes the amplitude that the shape has at present.
                let left = (1.0 - present * value.max(0.0)).max(1e-12);
                let (value, along) = (value.max(0.0) / left, along / left);
                for (k, amplitude) in AMPLITUDES.iter().enumerate() {
                    let square = amplitude * amplitude;
                    let spread = 1.0 + square * value;
                    evidence[k] += 0.5 * (square * along * along / spread - spread.ln());
                }
            }
            all.push(evidence);
        }
        all
    }
}

/// `b := L^-1 b` for a large triangular `L`. Recursive halving makes nearly all of the work products of matrices, which
/// are fast.
fn solve_lower(l: &DMatrixView<'_, f64>, b: &mut DMatrixViewMut<'_, f64>) {
    const DIRECT: usize = 32;
    let n = l.nrows();
    if n <= DIRECT {
        l.solve_lower_triangular_mut(b);
        return;
    }
    let half = n / 2;
    let columns = b.ncols();
    let first = {
        let mut upper = b.rows_mut(0, half);
        let mut owned = upper.clone_owned();
        solve_lower(&l.view((0, 0), (half, half)), &mut owned.as_view_mut());
        upper.copy_from(&owned);
        owned
    };
    let mut lower = b.view_mut((half, 0), (n - half, columns)).clone_owned();
    lower.gemm(-1.0, &l.view((half, 0), (n - half, half)), &first, 1.0);
    solve_lower(
        &l.view((half, half), (n - half, n - half)),
        &mut lower.as_view_mut(),
    );
    b.view_mut((half, 0), (n - half, columns)).copy_from(&lower);
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
