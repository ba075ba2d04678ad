//! Measured elongation of a cable over length and tension.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Polynomial surface `elongation(length, tension)` in metres (Jin et al. 2018, equation 2).
///
/// With `x = (length - length_center) / length_scale` and `y` likewise for the tension it is
/// `sum p_ab x^a y^b` over `a + b <= degree`, ordered by total degree and then by falling `a`:
/// `p00 p10 p01 p20 p11 p02 ..`. Centre and scale are the middle and half the width of the measured
/// range, so that `|x| <= 1` and `|y| <= 1` is where the surface is valid; it is never extrapolated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ElongationSurface {
    /// Total degree, 1 to 5.
    pub degree: usize,
    /// Middle of the measured lengths (m).
    pub length_center_m: f64,
    /// Half the width of the measured lengths (m).
    pub length_scale_m: f64,
    /// Middle of the measured tensions (N).
    pub tension_center_n: f64,
    /// Half the width of the measured tensions (N).
    pub tension_scale_n: f64,
    /// Coefficients `p_ab` (m), `(degree + 1)(degree + 2)/2` of them.
    pub coefficients: Vec<f64>,
    /// Standard deviation of the residuals of the fit (m).
    pub residual_sd_m: f64,
}

/// Elongation and its derivatives at one length and tension.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceValue<T> {
    /// Elongation (m).
    pub elongation: T,
    /// Its derivative with respect to the length.
    pub by_length: T,
    /// Its derivative with respect to the tension (m/N).
    pub by_tension: T,
}

impl ElongationSurface {
    /// Value and derivatives without asking whether the surface is valid there.
    #[inline(always)]
    #[must_use]
    pub fn evaluate_unchecked<T: crate::real::Real>(
        &self,
        length: T,
        tension: T,
    ) -> SurfaceValue<T> {
        let zero = length.lift(0.0);
        let x = (length - zero.lift(self.length_center_m)) * zero.lift(1.0 / self.length_scale_m);
        let y =
            (tension - zero.lift(self.tension_center_n)) * zero.lift(1.0 / self.tension_scale_n);
        // Horner in x; the coefficient of x^a is a polynomial in y of degree `degree - a`.
        let index = |a: usize, b: usize| (a + b) * (a + b + 1) / 2 + b;
        let (mut value, mut by_x, mut by_y) = (zero, zero, zero);
        for a in (0..=self.degree).rev() {
            let (mut p, mut slope) = (zero, zero);
            for b in (0..=self.degree - a).rev() {
                slope = slope.mul_add(y, p);
                p = p.mul_add(y, zero.lift(self.coefficients[index(a, b)]));
            }
            by_x = by_x.mul_add(x, value);
            value = value.mul_add(x, p);
            by_y = by_y.mul_add(x, slope);
        }
        SurfaceValue {
            elongation: value,
            by_length: by_x * zero.lift(1.0 / self.length_scale_m),
            by_tension: by_y * zero.lift(1.0 / self.tension_scale_n),
        }
    }
}
