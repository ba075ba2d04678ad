//! The whitened equations of one packet of poses, with their derivatives.

use super::layout::{CABLE_COLUMNS, Layout};
use crate::estimation::observation::ObservationKind as Kind;
use crate::real::{Real, scaled};
use crate::small_cholesky::{TRIANGLE, back_substitute};

/// Rows of one packet of poses; stored sparsely where the equations are sparse.
#[derive(Debug, Clone)]
pub(in crate::estimation) struct Equations<T> {
    /// Whitened residual of each row.
    pub residual: Vec<T>,
    /// Derivative of each row with respect to the pose (translation, rotation vector; base frame).
    pub by_pose: Vec<[T; 6]>,
    /// Derivative of length row i with respect to the columns of cable i.
    pub length_by_cable: Vec<[T; CABLE_COLUMNS]>,
    /// Derivative of swivel row i with respect to the entry point of cable i.
    pub swivel_by_cable: Vec<[T; CABLE_COLUMNS]>,
    /// Derivative of the laser row with respect to the offset of the target plane.
    pub laser_by_plane: T,
    /// Derivative of the equilibrium rows, column by column.
    pub equilibrium_by_column: Vec<[T; 6]>,
    /// Derivative of every row with respect to the effects of [`Layout::effects_of`], row by row; those of the
    /// equilibrium rows are in `equilibrium_by_column`.
    pub by_effect: Vec<T>,
    /// 1 where a row was measured, otherwise 0.
    pub present: Vec<T>,
    /// Cholesky factor of the equilibrium rows' covariance, with the reciprocals of its diagonal.
    pub equilibrium_factor: [T; TRIANGLE],
    /// `dL0/dT` of each cable (m/N); filled in for latent tensions and details only.
    pub length_by_tension: Vec<T>,
    /// Force and torque per unit tension of each cable; filled in likewise.
    pub structure: Vec<[T; 6]>,
}

impl<T: Real> Equations<T> {
    pub fn new(layout: &Layout, zero: T) -> Self {
        let swivels = if layout.swivel.is_some() {
            layout.cables
        } else {
            0
        };
        let dense = if layout.equilibrium.is_some() {
            layout.columns
        } else {
            0
        };
        Self {
            residual: vec![zero; layout.rows],
            by_pose: vec![[zero; 6]; layout.rows],
            length_by_cable: vec![[zero; CABLE_COLUMNS]; layout.cables],
            swivel_by_cable: vec![[zero; CABLE_COLUMNS]; swivels],
            laser_by_plane: zero,
            equilibrium_by_column: vec![[zero; 6]; dense],
            by_effect: vec![zero; layout.effect_derivatives()],
            present: vec![zero; layout.rows],
            equilibrium_factor: [zero; TRIANGLE],
            length_by_tension: vec![zero; layout.cables],
            structure: vec![[zero; 6]; layout.cables],
        }
    }

    /// Derivatives of one row by the effects of [`Layout::effects_of`].
    #[inline(always)]
    pub fn effects_of(&mut self, layout: &Layout, row: usize) -> &mut [T] {
        &mut self.by_effect[layout.effect_range(row)]
    }

    /// Derivative of a row that is not of the equilibrium by a column of effects.
    pub fn by_effect_column(&self, layout: &Layout, row: usize, column: usize) -> T {
        let own = layout.effects_of(row);
        let found = own.binary_search(&(column - layout.effect_column()));
        let at = found.map(|k| self.by_effect[layout.effect_range(row)][k]);
        at.unwrap_or(self.laser_by_plane.lift(0.0))
    }

    /// Applies Huber weights: rows beyond `limit` standard deviations are scaled down so that their
    /// square equals the linear loss up to a constant. Returns the loss of all weighted rows.
    #[inline(always)]
    pub fn weigh_down_outliers(&mut self, layout: &Layout, limit: f64) -> T {
        let zero = self.laser_by_plane.lift(0.0);
        let mut loss = zero;
        for row in 0..layout.rows {
            let r = self.residual[row];
            let size = r.max(-r);
            let kind = layout.kinds[row];
            if matches!(kind, Kind::Equilibrium(_)) {
                loss = loss + r * r;
                continue;
            }
            let k = zero.lift(limit);
            let weight = (k / size.max(k)).sqrt();
            loss = loss + (size - k).select_positive(k * (size + size - k), r * r);
            self.residual[row] = r * weight;
            self.by_pose[row] = scaled(self.by_pose[row], weight);
            match kind {
                Kind::Length(cable) => {
                    self.length_by_cable[cable] = scaled(self.length_by_cable[cable], weight);
                }
                Kind::Swivel(cable) => {
                    self.swivel_by_cable[cable] = scaled(self.swivel_by_cable[cable], weight);
                }
                Kind::Laser => self.laser_by_plane = self.laser_by_plane * weight,
                _ => {}
            }
            for e in self.effects_of(layout, row) {
                *e = *e * weight;
            }
        }
        loss
    }

    /// `lambda_q = E^-1 residual` of the equilibrium rows, with their covariance `E`.
    #[inline(always)]
    pub fn equilibrium_multipliers(&self, layout: &Layout) -> [T; 6] {
        let mut lambda = [self.laser_by_plane.lift(0.0); 6];
        if let Some(first) = layout.equilibrium {
            lambda.copy_from_slice(&self.residual[first..first + 6]);
            back_substitute(&self.equilibrium_factor, &mut lambda);
        }
        lambda
    }

    /// `lambda_l` of a length row: entry of `covariance^-1 residual` of the length and equilibrium rows.
    /// `tension_variance` is `sd_T^2`.
    #[inline(always)]
    pub fn length_multiplier(&self, cable: usize, tension_variance: f64, lambda: &[T; 6]) -> T {
        let c = self.length_by_tension[cable];
        // The derivative of the length row by the length at home is minus its weight 1 / sqrt(D).
        let weight = -self.length_by_cable[cable][3];
        let regression = c * c.lift(tension_variance) * weight * weight;
        self.residual[cable] * weight - regression * self.structure_product(cable, lambda)
    }

    /// `A lambda_q` of a cable.
    #[inline(always)]
    fn structure_product(&self, cable: usize, lambda: &[T; 6]) -> T {
        let a = &self.structure[cable];
        let mut sum = lambda[0].lift(0.0);
        for k in 0..6 {
            sum = a[k].mul_add(lambda[k], sum);
        }
        sum
    }

    /// Estimated error of a tension reading (N): `sd_T^2 (c lambda_l + A lambda_q)`.
    #[inline(always)]
    pub fn tension_error(&self, cable: usize, tension_variance: f64, lambda: &[T; 6]) -> T {
        let c = self.length_by_tension[cable];
        let length = self.length_multiplier(cable, tension_variance, lambda);
        c.lift(tension_variance) * c.mul_add(length, self.structure_product(cable, lambda))
    }

    /// Sum of squares of all rows.
    #[inline(always)]
    pub fn square_sum(&self) -> T {
        let mut sum = self.laser_by_plane.lift(0.0);
        for r in &self.residual {
            sum = r.mul_add(*r, sum);
        }
        sum
    }
}
