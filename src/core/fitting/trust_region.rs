//! Steps of a least-squares problem linearised about one point.

use nalgebra::{DMatrix, DVector};

/// Singular values below this fraction of the largest count as zero.
const RANK_TOLERANCE: f64 = 1e-14;

/// A weighted Jacobian `J` and residual vector `e`, factorised so that steps of any length are
/// cheap: `J D^-1 = Q R` (Householder), `R = U S V^T`, `c = U^T Q^T e`.
///
/// No normal equations are formed: squaring `J` would square its condition.
pub(super) struct Linearization {
    scale: DVector<f64>,
    singular_values: DVector<f64>,
    v: DMatrix<f64>,
    c: DVector<f64>,
}

/// A step in the parameters and its reduction of the linearised problem.
pub(super) struct Step {
    /// Change of the parameters.
    pub(super) change: DVector<f64>,
    /// Length of the scaled step `|D change|`.
    pub(super) scaled_length: f64,
    /// Expected decrease of the sum of squares.
    pub(super) predicted_reduction: f64,
}

impl Linearization {
    /// Factorises; `None` if a number is not finite. `scale` holds the diagonal of `D`, all
    /// positive.
    pub(super) fn new(
        jacobian: &DMatrix<f64>,
        residuals: &DVector<f64>,
        scale: &DVector<f64>,
    ) -> Option<Self> {
        let mut scaled = jacobian.clone();
        for (mut column, scale) in scaled.column_iter_mut().zip(scale.iter()) {
            column /= *scale;
        }
        let mut numbers = scaled.iter().chain(residuals).chain(scale);
        if !numbers.all(|v| v.is_finite()) {
            return None;
        }
        let qr = scaled.qr();
        let mut rotated = residuals.clone();
        qr.q_tr_mul(&mut rotated);
        let r = qr.unpack_r();
        let svd = r.svd(true, true);
        let (u, v_t) = (svd.u?, svd.v_t?);
        Some(Self {
            scale: scale.clone(),
            c: u.tr_mul(&rotated.rows(0, u.nrows())),
            singular_values: svd.singular_values,
            v: v_t.transpose(),
        })
    }

    fn significant(&self) -> impl Iterator<Item = usize> + '_ {
        let threshold = RANK_TOLERANCE * self.singular_values.max();
        (0..self.c.len()).filter(move |k| self.singular_values[*k] > threshold)
    }

    /// Number of parameter combinations that the residuals determine.
    pub(super) fn rank(&self) -> usize {
        self.significant().count()
    }

    /// Square of the part of the residuals that a Gauss-Newton step would remove.
    pub(super) fn removable_square(&self) -> f64 {
        self.significant().map(|k| self.c[k].powi(2)).sum()
    }

    /// The step that minimises the linearised sum of squares within `|D change| <= radius`.
    ///
    /// Its components along the singular vectors are `s c / (s^2 + lambda)`; lambda is zero if the
    /// Gauss-Newton step fits, else the root of `|step(lambda)| = radius` (Levenberg, Marquardt, More).
    pub(super) fn step(&self, radius: f64) -> Step {
        let lambda = if self.length(0.0) <= radius {
            0.0
        } else {
            self.damping(radius)
        };
        let mut along = DVector::zeros(self.c.len());
        let mut predicted_reduction = 0.0;
        for k in self.significant() {
            let (s, c) = (self.singular_values[k], self.c[k]);
            along[k] = s * c / (s * s + lambda);
            predicted_reduction += c * c * (1.0 - (lambda / (s * s + lambda)).powi(2));
        }
        let scaled = &self.v * along;
        Step {
            scaled_length: scaled.norm(),
            change: scaled.component_div(&self.scale),
            predicted_reduction,
        }
    }

    fn length(&self, lambda: f64) -> f64 {
        let component = |k| {
            let s: f64 = self.singular_values[k];
            s * self.c[k] / (s * s + lambda)
        };
        let square: f64 = self.significant().map(|k| component(k).powi(2)).sum();
        square.sqrt()
    }

    /// Bisection in the logarithm: the length falls monotonically, and a tenth of the radius is
    /// close enough.
    fn damping(&self, radius: f64) -> f64 {
        let gradient = self.c.component_mul(&self.singular_values).norm();
        let mut high = gradient / radius;
        let mut low = high * 1e-32;
        for _ in 0..60 {
            let middle = (low * high).sqrt();
            let length = self.length(middle);
            if (length - radius).abs() <= 0.05 * radius {
                return middle;
            }
            if length > radius {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// `(J^T J)^-1`; infinite on the diagonal for parameters that take part in an undetermined
    /// combination.
    pub(super) fn cofactor(&self) -> DMatrix<f64> {
        let count = self.scale.len();
        let mut root = self.v.clone();
        // With fewer residuals than parameters, no parameter is determined.
        let mut undetermined = vec![self.c.len() < count; count];
        let significant: Vec<usize> = self.significant().collect();
        for k in 0..self.c.len() {
            if significant.contains(&k) {
                root.column_mut(k).unscale_mut(self.singular_values[k]);
                continue;
            }
            for i in 0..count {
                undetermined[i] |= self.v[(i, k)].abs() > 1e-6;
            }
            root.column_mut(k).fill(0.0);
        }
        for (mut row, scale) in root.row_iter_mut().zip(self.scale.iter()) {
            row /= *scale;
        }
        let mut cofactor = &root * root.transpose();
        for i in 0..count {
            if undetermined[i] {
                cofactor[(i, i)] = f64::INFINITY;
            }
        }
        cofactor
    }
}
