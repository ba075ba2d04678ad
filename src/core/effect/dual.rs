//! Dual numbers: a value and its derivative with respect to one parameter.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub};

/// `value + slope * epsilon` with `epsilon^2 = 0`; arithmetic carries the exact derivative along.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Dual {
    /// The value.
    pub value: f64,
    /// Its derivative with respect to the chosen parameter.
    pub slope: f64,
}

impl Dual {
    /// A constant.
    pub const fn constant(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }

    /// The parameter itself.
    pub fn variable(value: f64) -> Self {
        Self { value, slope: 1.0 }
    }

    fn chain(self, value: f64, derivative: f64) -> Self {
        Self {
            value,
            slope: derivative * self.slope,
        }
    }

    /// Sine.
    pub fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }

    /// Cosine.
    pub fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }

    /// Square root.
    pub fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }

    /// Arc sine.
    pub fn asin(self) -> Self {
        let slope = (1.0 - self.value * self.value).sqrt().recip();
        self.chain(self.value.asin(), slope)
    }

    /// Natural logarithm.
    pub fn ln(self) -> Self {
        self.chain(self.value.ln(), self.value.recip())
    }

    /// Absolute value; its derivative at 0 is taken as 0.
    pub fn abs(self) -> Self {
        let sign = match self.value == 0.0 {
            true => 0.0,
            false => self.value.signum(),
        };
        self.chain(self.value.abs(), sign)
    }

    /// Power with a constant exponent.
    pub fn power(self, exponent: f64) -> Self {
        let derivative = exponent * self.value.powf(exponent - 1.0);
        self.chain(self.value.powf(exponent), derivative)
    }

    /// Angle of the point `(x, self)`.
    pub fn atan2(self, x: Self) -> Self {
        let square = self.value * self.value + x.value * x.value;
        let slope = (self.slope * x.value - self.value * x.slope) / square;
        Self {
            value: self.value.atan2(x.value),
            slope,
        }
    }

    /// Exponential.
    pub fn exp(self) -> Self {
        self.chain(self.value.exp(), self.value.exp())
    }

    /// Reciprocal.
    pub fn recip(self) -> Self {
        let inverse = self.value.recip();
        self.chain(inverse, -inverse * inverse)
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slope: self.slope + other.slope,
        }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            slope: self.slope * other.value + self.value * other.slope,
        }
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self {
            value,
            slope: (self.slope - value * other.slope) / other.value,
        }
    }
}

impl Add<f64> for Dual {
    type Output = Self;
    fn add(self, other: f64) -> Self {
        self.chain(self.value + other, 1.0)
    }
}

impl Mul<f64> for Dual {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        self.chain(self.value * other, other)
    }
}

impl AddAssign for Dual {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl MulAssign for Dual {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_match_finite_differences() {
        let function = |x: Dual| {
            let y = (x * 3.0).sin() + (x * x).exp() * 0.5 - x.recip();
            let z = (x * x + 1.0).sqrt().atan2(x.cos()) + 2.0;
            y * x + z / (x.ln().abs() + x.asin()) + x.power(2.5) + (-x).power(3.0)
        };
        let (x, h) = (0.7, 1e-6);
        let at = |x: f64| function(Dual::constant(x)).value;
        let numeric = (at(x + h) - at(x - h)) / (2.0 * h);
        assert!((function(Dual::variable(x)).slope - numeric).abs() < 1e-8);
    }
}
