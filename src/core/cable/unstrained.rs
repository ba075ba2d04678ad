//! Unstrained length of a cable that spans a path at a tension.
//!
//! `L0 = (D + l + s) / (1 + T c + eps)` with the run from drum to pulley `D`, the geometric length `l`
//! from entry point to anchor, the compliance `c = 1/EA` (1/N), an extra strain `eps`, and the
//! extra length by sag `s = w^2 h^2 l_f / (24 T^2)` for the weight `w` per metre and the horizontal
//! span `h` of the free part `l_f` (parabola, first order in the sag; physics: Irvine, Cable
//! Structures, 1981). With a measured elongation surface `f(length, tension)` (Jin et al. 2018,
//! equation 2) instead of a compliance: `L0 = (D + l - f(D + l, T) + s) / (1 + eps)`.

use super::ElongationSurface;
use crate::kinematics::{CablePath, PathChange};
use crate::real::{Real, add_scaled, constants, dot, scaled};

/// Material, load and run-in of one cable at one pose: everything but the path that `L0` depends on.
#[derive(Debug, Clone, Copy)]
pub struct CableLaw<'a, T> {
    /// Cable between drum and pulley entry point `D` (m).
    pub run: T,
    /// Tension `T` (N).
    pub tension: T,
    /// Reciprocal axial stiffness `c` (1/N).
    pub compliance: T,
    /// Extra strain `eps`.
    pub strain: T,
    /// Weight per metre `w` (N/m); `None` where sag is not modelled.
    pub weight: Option<T>,
    /// Direction of gravity, unit vector in the base frame.
    pub down: [f64; 3],
    /// Measured elongation, instead of the compliance.
    pub surface: Option<&'a ElongationSurface>,
}

/// Unstrained length and its derivatives.
#[derive(Debug, Clone, Copy)]
pub struct Unstrained<T> {
    /// `L0` (m).
    pub length: T,
    /// Extra length by sag `s` (m).
    pub sag: T,
    /// `dL0/dT` (m/N).
    pub by_tension: T,
    /// `dL0/dc` (m N).
    pub by_compliance: T,
    /// `dL0/d eps` (m).
    pub by_strain: T,
    /// `dL0/dw` (m^2/N).
    pub by_weight: T,
    by_length: T,
    by_free_length: T,
    by_slope: T,
    down: [T; 3],
}

impl<T: Real> CableLaw<'_, T> {
    /// Unstrained length `L0` of the cable over `path`, with its derivatives.
    #[inline(always)]
    #[must_use]
    pub fn unstrained(&self, path: &CablePath<T>) -> Unstrained<T> {
        let zero = self.run.lift(0.0);
        let one = self.run.lift(1.0);
        let down = constants(zero, self.down);
        let span = self.run + path.length;
        let (elongation, by_span, by_load, stretch) = match self.surface {
            Some(surface) => {
                let value = surface.evaluate_unchecked(span, self.tension);
                let stretch = one / (one + self.strain);
                (
                    value.elongation_m,
                    value.by_length,
                    value.by_tension_m_per_n,
                    stretch,
                )
            }
            None => {
                let stretch = one / (self.tension.mul_add(self.compliance, one) + self.strain);
                (zero, zero, zero, stretch)
            }
        };
        let mut result = Unstrained {
            length: (span - elongation) * stretch,
            sag: zero,
            by_tension: -(by_load * stretch),
            by_compliance: zero,
            by_strain: zero,
            by_weight: zero,
            by_length: (one - by_span) * stretch,
            by_free_length: zero,
            by_slope: zero,
            down,
        };
        if let Some(weight) = self.weight {
            self.add_sag(path, weight, stretch, &mut result);
        }
        result.by_strain = -(result.length * stretch);
        if self.surface.is_none() {
            result.by_compliance = result.by_strain * self.tension;
            result.by_tension = result.by_strain.mul_add(self.compliance, result.by_tension);
        }
        result
    }

    #[inline(always)]
    fn add_sag(&self, path: &CablePath<T>, weight: T, stretch: T, result: &mut Unstrained<T>) {
        let one = self.run.lift(1.0);
        let inverse_tension = one / self.tension;
        let slope = dot(path.toward_exit, result.down);
        let flatness = one - slope * slope;
        let square = path.free_length * path.free_length;
        // kappa = w / (24 T^2); sag = w kappa l_f^3 (1 - slope^2).
        let kappa = weight * inverse_tension * inverse_tension * one.lift(1.0 / 24.0);
        let per_weight = kappa * square * path.free_length * flatness;
        let curvature = weight * kappa * square * stretch;
        result.sag = weight * per_weight;
        result.length = result.sag.mul_add(stretch, result.length);
        result.by_free_length = one.lift(3.0) * curvature * flatness;
        result.by_slope = one.lift(-2.0) * curvature * path.free_length * slope;
        result.by_weight = one.lift(2.0) * per_weight * stretch;
        let by_tension = one.lift(-2.0) * result.sag * inverse_tension * stretch;
        result.by_tension = result.by_tension + by_tension;
    }
}

impl<T: Real> Unstrained<T> {
    /// Gradient of `L0` with respect to the anchor in the base frame; the gradient with respect to the entry
    /// point is its negative.
    #[inline(always)]
    #[must_use]
    pub fn by_anchor(&self, path: &CablePath<T>, radius: T, sags: bool) -> [T; 3] {
        let gradient = scaled(path.toward_exit, -self.by_length);
        if !sags {
            return gradient;
        }
        let free = path.free_length_gradient(radius);
        let gradient = add_scaled(gradient, self.by_free_length, free);
        add_scaled(gradient, self.by_slope, path.turn(self.down))
    }

    /// First-order change of `L0` for a small change of the path (m).
    #[inline(always)]
    #[must_use]
    pub fn change(&self, change: &PathChange<T>) -> T {
        let by_slope = self.by_slope * dot(change.toward_exit, self.down);
        let by_free = self.by_free_length * change.free_length;
        self.by_length.mul_add(change.length, by_free + by_slope)
    }
}
