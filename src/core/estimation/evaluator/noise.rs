//! The noise of each reading as a linear function of the whitened rows.
//!
//! The readings of a pose enter the rows through `B`, one column per reading in its standard deviations; with the
//! covariance `D = B B^T` of the rows and the whitened rows `r = D^(-1/2) (...)`, the least-squares estimate of the
//! noise is `e = B^T D^(-1/2) r`. A reading that shares no row is its row. Where tensions are latent, a length reading and the
//! tension reading of its cable share the length row, and all tensions share the equilibrium rows.

use super::equations::Equations;
use super::layout::Layout;
use crate::estimation::observation::ObservationKind as Kind;
use crate::real::{Real, scaled};
use crate::small_cholesky::back_substitute;

/// Estimated noise of a reading, in its standard deviations, sign as prediction minus reading:
/// `own r_row + sum_k balance_k r_(q + k)` with the equilibrium rows `q..q + 6`.
#[derive(Debug, Clone, Copy)]
pub(in crate::estimation) struct NoiseEstimate<T> {
    pub kind: Kind,
    /// The row of the reading itself, or the length row of its cable.
    pub row: usize,
    /// Coefficient of that row.
    pub own: T,
    /// Coefficients of the equilibrium rows.
    pub balance: [T; 6],
}

/// Standard deviations of the quantities that enter the rows of one pose.
pub(in crate::estimation) struct NoiseSizes {
    /// Standard deviation of each length reading (m).
    pub length_m: Vec<f64>,
    /// Standard deviation of each tension reading (N); 0 if it is not a reading.
    pub tension_n: Vec<f64>,
    /// Standard deviation of each component of the unexplained wrench (N, N m).
    pub wrench: [f64; 6],
}

impl<T: Real> Equations<T> {
    /// Noise of every row that is a reading or an equation, then that of the tension readings.
    #[inline(always)]
    pub fn noise_estimates(&self, layout: &Layout, sizes: &NoiseSizes) -> Vec<NoiseEstimate<T>> {
        let zero = self.laser_by_plane.lift(0.0);
        let one = zero.lift(1.0);
        let multipliers = self.multipliers(layout);
        let mut estimates = Vec::with_capacity(layout.rows + layout.cables);
        for (row, kind) in layout.kinds.iter().copied().enumerate() {
            let (own, balance) = match kind {
                Kind::Length(cable) => {
                    let shared = self.shared_row(cable, sizes, &multipliers);
                    let sd = zero.lift(sizes.length_m[cable]);
                    let share = zero - sd * shared.regression;
                    (sd * shared.weight, scaled(shared.balance, share))
                }
                Kind::Equilibrium(axis) => {
                    let sd = zero.lift(sizes.wrench[axis.index()]);
                    let mut balance = [zero; 6];
                    for (entry, lambda) in balance.iter_mut().zip(&multipliers) {
                        *entry = sd * lambda[axis.index()];
                    }
                    (zero, balance)
                }
                _ => (one, [zero; 6]),
            };
            estimates.push(NoiseEstimate {
                kind,
                row,
                own,
                balance,
            });
        }
        for (cable, sd) in sizes.tension_n.iter().enumerate() {
            let shared = self.shared_row(cable, sizes, &multipliers);
            let minus_sd = zero.lift(-sd);
            let c = self.length_by_tension[cable];
            let share = minus_sd * (one - c * shared.regression);
            estimates.push(NoiseEstimate {
                kind: Kind::Tension(cable),
                row: cable,
                own: minus_sd * c * shared.weight,
                balance: scaled(shared.balance, share),
            });
        }
        estimates
    }

    /// `E^-1 r` for a unit whitened residual in each equilibrium row; zero without equilibrium.
    #[inline(always)]
    fn multipliers(&self, layout: &Layout) -> [[T; 6]; 6] {
        let zero = self.laser_by_plane.lift(0.0);
        let mut multipliers = [[zero; 6]; 6];
        let Some(first) = layout.equilibrium else {
            return multipliers;
        };
        for (k, lambda) in multipliers.iter_mut().enumerate() {
            lambda[k] = self.present[first + k];
            back_substitute(&self.equilibrium_factor, lambda);
        }
        multipliers
    }

    #[inline(always)]
    fn shared_row(
        &self,
        cable: usize,
        sizes: &NoiseSizes,
        multipliers: &[[T; 6]; 6],
    ) -> SharedRow<T> {
        let zero = self.laser_by_plane.lift(0.0);
        // The derivative of the length row by the length at home is minus its weight 1 / sqrt(D).
        let weight = zero - self.length_by_cable[cable][3];
        let sd = sizes.tension_n.get(cable).copied().unwrap_or(0.0);
        let c = self.length_by_tension[cable];
        let a = &self.structure[cable];
        let mut balance = [zero; 6];
        for (sum, lambda) in balance.iter_mut().zip(multipliers) {
            for (a, l) in a.iter().zip(lambda) {
                *sum = a.mul_add(*l, *sum);
            }
        }
        SharedRow {
            weight,
            regression: c * zero.lift(sd * sd) * weight * weight,
            balance,
        }
    }
}

/// Quantities of the length row of a cable that its tension shares.
struct SharedRow<T> {
    /// `1 / sqrt(D)`.
    weight: T,
    /// `c sd_T^2 / D`.
    regression: T,
    /// `A lambda` for a unit residual in each equilibrium row.
    balance: [T; 6],
}
