//! Units of parameters and numbers.

use std::fmt;

/// Units with their factor to SI and their exponents of metre, kilogram, second and kelvin. Angles and revolutions are
/// numbers.
const UNITS: [(&str, f64, [f64; 4]); 26] = [
    ("1", 1.0, [0.0; 4]),
    ("rad", 1.0, [0.0; 4]),
    ("mrad", 1e-3, [0.0; 4]),
    ("deg", std::f64::consts::PI / 180.0, [0.0; 4]),
    ("rev", 1.0, [0.0; 4]),
    ("%", 1e-2, [0.0; 4]),
    ("ppm", 1e-6, [0.0; 4]),
    ("m", 1.0, [1.0, 0.0, 0.0, 0.0]),
    ("mm", 1e-3, [1.0, 0.0, 0.0, 0.0]),
    ("um", 1e-6, [1.0, 0.0, 0.0, 0.0]),
    ("km", 1e3, [1.0, 0.0, 0.0, 0.0]),
    ("kg", 1.0, [0.0, 1.0, 0.0, 0.0]),
    ("g", 1e-3, [0.0, 1.0, 0.0, 0.0]),
    ("t", 1e3, [0.0, 1.0, 0.0, 0.0]),
    ("s", 1.0, [0.0, 0.0, 1.0, 0.0]),
    ("ms", 1e-3, [0.0, 0.0, 1.0, 0.0]),
    ("min", 60.0, [0.0, 0.0, 1.0, 0.0]),
    ("h", 3600.0, [0.0, 0.0, 1.0, 0.0]),
    ("d", 86400.0, [0.0, 0.0, 1.0, 0.0]),
    ("K", 1.0, [0.0, 0.0, 0.0, 1.0]),
    ("Hz", 1.0, [0.0, 0.0, -1.0, 0.0]),
    ("N", 1.0, [1.0, 1.0, -2.0, 0.0]),
    ("kN", 1e3, [1.0, 1.0, -2.0, 0.0]),
    ("Pa", 1.0, [-1.0, 1.0, -2.0, 0.0]),
    ("MPa", 1e6, [-1.0, 1.0, -2.0, 0.0]),
    ("J", 1.0, [2.0, 1.0, -2.0, 0.0]),
];

/// Units in which dimensions are named in messages.
const NAMES: [&str; 16] = [
    "1", "m", "s", "K", "kg", "N", "1/N", "1/m", "1/s", "1/K", "m/s", "m/s^2", "N/m", "m/N", "N/s",
    "N s/m",
];

/// Largest exponent that a unit may have.
const MAX_EXPONENT: i32 = 9;

/// Exponents of metre, kilogram, second and kelvin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dimension([f64; 4]);

/// A unit: its dimension and its size in SI units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unit {
    pub dimension: Dimension,
    pub factor: f64,
}

impl Dimension {
    /// That of numbers and angles.
    pub const NUMBER: Self = Self([0.0; 4]);

    pub fn times(self, other: Self, exponent: f64) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + exponent * other.0[k]))
    }

    pub fn power(self, exponent: f64) -> Self {
        Self::NUMBER.times(self, exponent)
    }

    pub fn is_number(self) -> bool {
        self == Self::NUMBER
    }
}

impl PartialEq for Dimension {
    fn eq(&self, other: &Self) -> bool {
        let pairs = self.0.iter().zip(&other.0);
        // Roots leave rounding errors in the exponents.
        pairs.fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs())) < 1e-9
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known = NAMES
            .iter()
            .find(|name| Unit::parse(name).is_some_and(|unit| unit.dimension == *self));
        if let Some(name) = known {
            return f.write_str(name);
        }
        let bases = ["m", "kg", "s", "K"].iter().zip(self.0);
        let parts = bases.filter(|(_, exponent)| *exponent != 0.0);
        let words: Vec<String> = parts
            .map(|(base, exponent)| match exponent {
                1.0 => (*base).to_owned(),
                _ => format!("{base}^{exponent}"),
            })
            .collect();
        f.write_str(&words.join(" "))
    }
}

impl Unit {
    /// Parses symbols with `^` and an integer, separated by a space or `*`; `/` divides by the symbol that follows.
    pub fn parse(text: &str) -> Option<Self> {
        let mut unit = Self {
            dimension: Dimension::NUMBER,
            factor: 1.0,
        };
        let mut sign = 1;
        let mut rest = text.trim();
        loop {
            let end = rest.find([' ', '*', '/']).unwrap_or(rest.len());
            let (name, exponent) = match rest[..end].split_once('^') {
                Some((name, exponent)) => (name, exponent.parse().ok()?),
                None => (&rest[..end], 1),
            };
            let (_, factor, dimension) = UNITS.iter().find(|(symbol, ..)| *symbol == name)?;
            if !(-MAX_EXPONENT..=MAX_EXPONENT).contains(&exponent) {
                return None;
            }
            let power = sign * exponent;
            unit.factor *= factor.powi(power);
            unit.dimension = unit
                .dimension
                .times(Dimension(*dimension), f64::from(power));
            rest = rest[end..].trim_start();
            sign = 1;
            if rest.is_empty() {
                return Some(unit);
            }
            if let Some(after) = rest.strip_prefix('/') {
                sign = -1;
                rest = after.trim_start();
            } else if let Some(after) = rest.strip_prefix('*') {
                rest = after.trim_start();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_a_size_and_a_dimension() {
        let is = |text: &str| Unit::parse(text).map(|u| (u.factor, u.dimension.to_string()));
        for (text, factor, name) in [
            ("1", 1.0, "1"),
            ("m/h", 1.0 / 3600.0, "m/s"),
            ("1/rev", 1.0, "1"),
            ("N s/m", 1.0, "N s/m"),
            ("kg * m / s^2", 1.0, "N"),
            ("mm^2", 1e-6, "m^2"),
            ("mm/kN", 1e-6, "m/N"),
        ] {
            let (found, dimension) = is(text).expect(text);
            assert!((found / factor - 1.0).abs() < 1e-14, "{text}: {found}");
            assert_eq!(dimension, name, "{text}");
        }
        for text in ["", "furlong", "m^", "m^99", "m//s", "/s", "m/", "m s^1.5"] {
            assert!(is(text).is_none(), "{text}");
        }
    }
}
