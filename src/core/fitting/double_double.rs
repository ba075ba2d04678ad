//! Numbers of twice the precision of `f64`, for least squares with nearly dependent columns.
//!
//! A value is the unevaluated sum `high + low` with `|low| <= ulp(high)/2`, about 32 decimal digits
//! (Dekker, Numerische Mathematik 18 (1971) 224; Hida, Li, Bailey, ARITH-15 (2001) 155).

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Unevaluated sum of two `f64`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DoubleDouble {
    high: f64,
    low: f64,
}

/// `a + b` exactly, as rounded sum and its error (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// `a + b` exactly when `|a| >= |b|` (Dekker).
fn quick_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// Splits into two halves of 26 bits each, so that products of halves are exact (Veltkamp).
fn split(a: f64) -> (f64, f64) {
    let shifted = 134_217_729.0 * a;
    let high = shifted - (shifted - a);
    (high, a - high)
}

/// `a b` exactly, as rounded product and its error. Not with fused multiply-add: without the
/// hardware instruction that is a slow library call.
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let (a_high, a_low) = split(a);
    let (b_high, b_low) = split(b);
    let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product, error)
}

impl DoubleDouble {
    pub(super) const ZERO: Self = Self {
        high: 0.0,
        low: 0.0,
    };
    pub(super) const ONE: Self = Self {
        high: 1.0,
        low: 0.0,
    };

    /// The nearest `f64`.
    pub(super) fn to_f64(self) -> f64 {
        self.high
    }

    /// Square root; zero for zero and below.
    pub(super) fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::ZERO;
        }
        // One Newton step doubles the digits of the hardware root.
        let root = Self::from(self.high.sqrt());
        let correction = (self - root * root).high / (2.0 * root.high);
        root + Self::from(correction)
    }

    /// `sum a_i b_i`.
    pub(super) fn dot(a: &[Self], b: &[Self]) -> Self {
        a.iter()
            .zip(b)
            .fold(Self::ZERO, |sum, (a, b)| sum + *a * *b)
    }
}

impl From<f64> for DoubleDouble {
    fn from(value: f64) -> Self {
        Self {
            high: value,
            low: 0.0,
        }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (sum, error) = two_sum(self.high, other.high);
        let (low_sum, low_error) = two_sum(self.low, other.low);
        let (sum, error) = quick_two_sum(sum, error + low_sum);
        let (high, low) = quick_two_sum(sum, error + low_error);
        Self { high, low }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + (-other)
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (product, error) = two_product(self.high, other.high);
        let (high, low) = quick_two_sum(
            product,
            error + (self.high * other.low + self.low * other.high),
        );
        Self { high, low }
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        // Long division, three quotient digits of 53 bits each.
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        let third = rest.high / other.high;
        Self::from(first) + Self::from(second) + Self::from(third)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_keeps_thirty_digits() {
        let third = DoubleDouble::ONE / DoubleDouble::from(3.0);
        let back = third * DoubleDouble::from(3.0) - DoubleDouble::ONE;
        assert!(back.to_f64().abs() < 1e-31);
        let root = DoubleDouble::from(2.0).sqrt();
        let back = root * root - DoubleDouble::from(2.0);
        assert!(back.to_f64().abs() < 1e-31);
        let small = DoubleDouble::from(1e-25);
        let back = (DoubleDouble::ONE + small) - DoubleDouble::ONE;
        assert!((back.to_f64() / 1e-25 - 1.0).abs() < 1e-6);
    }
}
