//! Round numbers: 1, 2 or 5 times a power of ten.

/// Relative tolerance for the rounding of powers.
const ROUNDING: f64 = 1e-9;

fn power_of(value: f64) -> f64 {
    10_f64.powf(value.log10().floor())
}

/// The largest round number not above `most`; 1 if that is not a positive number.
#[must_use]
pub fn round_down(most: f64) -> f64 {
    if !(most.is_finite() && most > 0.0) {
        return 1.0;
    }
    let power = power_of(most);
    let numbers = [5.0, 2.0, 1.0].map(|digit| digit * power);
    let found = numbers
        .into_iter()
        .find(|one| *one <= most * (1.0 + ROUNDING));
    found.unwrap_or(power)
}

/// The smallest round number not below `least`, which must be positive.
#[must_use]
pub fn round_up(least: f64) -> f64 {
    let power = power_of(least);
    let numbers = [1.0, 2.0, 5.0].map(|digit| digit * power);
    let found = numbers
        .into_iter()
        .find(|one| *one >= least * (1.0 - ROUNDING));
    found.unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_lengths() {
        for (length, round) in [
            (0.14, 0.1),
            (0.2, 0.2),
            (4.9, 2.0),
            (5.0, 5.0),
            (73.0, 50.0),
        ] {
            assert!(
                (round_down(length) / round - 1.0_f64).abs() < 1e-12,
                "{length}"
            );
        }
    }

    #[test]
    fn magnifications_are_round_numbers() {
        for (most, expected) in [(62.8, 50.0), (0.3, 0.2), (1000.0, 1000.0), (f64::NAN, 1.0)] {
            assert!((round_down(most) - expected).abs() < 1e-9 * expected);
        }
    }

    #[test]
    fn numbers_are_round_and_on_the_right_side() {
        for value in [0.013, 0.02, 0.7, 1.0, 3.0, 5.0, 9.9, 120.0] {
            let (down, up) = (round_down(value), round_up(value));
            assert!(down <= value * (1.0 + 1e-9) && value <= up * (1.0 + 1e-9));
            assert!(up / down <= 2.5 + 1e-9, "{value}: {down}, {up}");
        }
        assert!((round_down(0.7) - 0.5).abs() < 1e-12);
        assert!((round_up(0.7) - 1.0).abs() < 1e-12);
        assert!((round_down(0.0) - 1.0).abs() < 1e-12);
    }
}
