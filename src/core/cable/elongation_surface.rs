//! Measured elongation of a cable over length and tension.

use crate::real::Real;
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

/// Tolerance for rounding at the border of the measured range, in units of its half-width.
const BORDER: f64 = 1e-9;

/// Highest total degree: equation 2 of Jin et al. 2018.
pub(super) const MAX_DEGREE: usize = 5;

/// Elongation at one length and tension, with its partial derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceValue<T> {
    /// Elongation (m).
    pub elongation_m: T,
    /// Derivative with respect to the cable length (m/m).
    pub by_length: T,
    /// Derivative with respect to the tension (m/N).
    pub by_tension_m_per_n: T,
}

/// A length or tension outside the range in which the elongation was measured.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the {quantity} {value} {unit} is outside the measured range {lowest} to {highest} {unit}")]
pub struct OutsideMeasuredRange {
    /// Name of the quantity.
    pub quantity: &'static str,
    /// Value outside the range.
    pub value: f64,
    /// Least measured value.
    pub lowest: f64,
    /// Greatest measured value.
    pub highest: f64,
    /// Unit of the values.
    pub unit: &'static str,
}

/// Number of terms of total degree at most `degree`: `(n + 1)(n + 2) / 2`.
pub(super) fn term_count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// Exponents `(a, b)` of the terms in the order of the coefficients.
pub(super) fn exponents(degree: usize) -> impl Iterator<Item = (i32, i32)> {
    (0..=degree as i32).flat_map(|total| (0..=total).map(move |b| (total - b, b)))
}

impl ElongationSurface {
    /// Describes the first inconsistency of the surface in one sentence; `None` if there is none.
    #[must_use]
    pub fn check(&self) -> Option<String> {
        if !(1..=MAX_DEGREE).contains(&self.degree) {
            return Some(format!(
                "the degree is {}, not 1 to {MAX_DEGREE}",
                self.degree
            ));
        }
        let (needed, given) = (term_count(self.degree), self.coefficients.len());
        if given != needed {
            let degree = self.degree;
            return Some(format!(
                "degree {degree} has {needed} coefficients, {given} are given"
            ));
        }
        let scales = [
            ("length_scale_m", self.length_scale_m),
            ("tension_scale_n", self.tension_scale_n),
        ];
        for (name, scale) in scales {
            if !(scale > 0.0 && scale.is_finite()) {
                return Some(format!("{name} is {scale}, not positive"));
            }
        }
        let centers = [self.length_center_m, self.tension_center_n];
        let mut numbers = self.coefficients.iter().chain(&centers);
        if !numbers.all(|v| v.is_finite()) {
            return Some("a coefficient or centre is not a finite number".to_owned());
        }
        let residual_sd = self.residual_sd_m;
        if !(residual_sd >= 0.0 && residual_sd.is_finite()) {
            return Some(format!(
                "residual_sd_m is {residual_sd}, not zero or positive"
            ));
        }
        None
    }

    /// Elongation and its derivatives at a cable length (m) and tension (N).
    ///
    /// # Errors
    /// If either lies outside the measured range: the polynomial is not extrapolated.
    pub fn evaluate(
        &self,
        length_m: f64,
        tension_n: f64,
    ) -> Result<SurfaceValue<f64>, OutsideMeasuredRange> {
        let check = |quantity, value: f64, center: f64, scale: f64, unit| {
            // The comparison is written so that NaN counts as outside.
            if ((value - center) / scale).abs() <= 1.0 + BORDER {
                return Ok(());
            }
            Err(OutsideMeasuredRange {
                quantity,
                value,
                lowest: center - scale,
                highest: center + scale,
                unit,
            })
        };
        let (center, scale) = (self.length_center_m, self.length_scale_m);
        check("cable length", length_m, center, scale, "m")?;
        let (center, scale) = (self.tension_center_n, self.tension_scale_n);
        check("tension", tension_n, center, scale, "N")?;
        Ok(self.evaluate_unchecked(length_m, tension_n))
    }

    /// As [`Self::evaluate`] for a length (m) and tension (N) known to lie in the measured range, of a surface that
    /// passes [`Self::check`].
    #[inline(always)]
    #[must_use]
    pub fn evaluate_unchecked<T: Real>(&self, length: T, tension: T) -> SurfaceValue<T> {
        let constant = |value: f64| length.lift(value);
        let per_length = constant(self.length_scale_m.recip());
        let per_tension = constant(self.tension_scale_n.recip());
        let x = (length - constant(self.length_center_m)) * per_length;
        let y = (tension - constant(self.tension_center_n)) * per_tension;
        // Horner in x; the coefficient of x^a is a polynomial in y of degree `degree - a`.
        let position = |a: usize, b: usize| (a + b) * (a + b + 1) / 2 + b;
        let zero = constant(0.0);
        let (mut value, mut by_x, mut by_y) = (zero, zero, zero);
        for a in (0..=self.degree).rev() {
            let (mut inner, mut slope) = (zero, zero);
            for b in (0..=self.degree - a).rev() {
                slope = slope.mul_add(y, inner);
                inner = inner.mul_add(y, constant(self.coefficients[position(a, b)]));
            }
            by_x = by_x.mul_add(x, value);
            value = value.mul_add(x, inner);
            by_y = by_y.mul_add(x, slope);
        }
        SurfaceValue {
            elongation_m: value,
            by_length: by_x * per_length,
            by_tension_m_per_n: by_y * per_tension,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface() -> ElongationSurface {
        ElongationSurface {
            degree: 5,
            length_center_m: 2.0,
            length_scale_m: 1.5,
            tension_center_n: 60.0,
            tension_scale_n: 50.0,
            coefficients: (0..21).map(|k| 1e-3 / f64::from(k + 1)).collect(),
            residual_sd_m: 1e-5,
        }
    }

    #[test]
    fn coefficients_stand_in_the_order_of_the_format() {
        let order: Vec<_> = exponents(2).collect();
        assert_eq!(order, [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]);
        assert_eq!(exponents(5).count(), 21);
        let value = surface().evaluate(3.5, 110.0).unwrap().elongation_m;
        let sum: f64 = surface().coefficients.iter().sum();
        assert!(
            (value - sum).abs() < 1e-17,
            "at x = y = 1 every term counts once"
        );
    }

    #[test]
    fn slopes_match_differences() {
        let (s, h) = (surface(), 1e-5);
        let at = |l: f64, t: f64| s.evaluate_unchecked(l, t);
        let slope = at(1.3, 82.0);
        let by_length = at(1.3 + h, 82.0).elongation_m - at(1.3 - h, 82.0).elongation_m;
        let by_tension = at(1.3, 82.0 + h).elongation_m - at(1.3, 82.0 - h).elongation_m;
        assert!((by_length / (2.0 * h) - slope.by_length).abs() < 1e-12);
        assert!((by_tension / (2.0 * h) - slope.by_tension_m_per_n).abs() < 1e-12);
    }

    #[test]
    fn is_not_extrapolated() {
        let s = surface();
        assert!(s.evaluate(0.5, 10.0).is_ok() && s.evaluate(3.5, 110.0).is_ok());
        let message = s.evaluate(3.6, 60.0).unwrap_err().to_string();
        assert_eq!(
            message,
            "the cable length 3.6 m is outside the measured range 0.5 to 3.5 m"
        );
        assert_eq!(s.evaluate(2.0, 5.0).unwrap_err().quantity, "tension");
        assert!(s.evaluate(f64::NAN, 60.0).is_err());
    }

    #[test]
    fn inconsistent_surfaces_are_told() {
        assert_eq!(surface().check(), None);
        let mut s = surface();
        s.degree = 4;
        assert_eq!(
            s.check().unwrap(),
            "degree 4 has 15 coefficients, 21 are given"
        );
        s = surface();
        s.tension_scale_n = 0.0;
        assert!(s.check().unwrap().contains("tension_scale_n"));
        s.degree = 6;
        assert!(s.check().unwrap().contains("degree is 6"));
    }
}
