//! Exact binomial probabilities and confidence intervals.

/// Probability of at least `least` successes in `trials` trials with success probability `p`.
#[must_use]
pub fn binomial_tail(trials: usize, least: usize, p: f64) -> f64 {
    if least == 0 || p >= 1.0 {
        return f64::from(u8::from(least <= trials));
    }
    if p <= 0.0 {
        return 0.0;
    }
    let odds = (p / (1.0 - p)).ln();
    let mut log_term = trials as f64 * (-p).ln_1p();
    let mut sum = 0.0;
    for k in 0..=trials {
        if k >= least {
            sum += log_term.exp();
        }
        log_term += odds + ((trials - k) as f64 / (k + 1) as f64).ln();
    }
    f64::min(sum, 1.0)
}

/// Clopper-Pearson 95 % confidence interval of a probability, given `successes` in `trials` trials.
#[must_use]
pub fn clopper_pearson(successes: usize, trials: usize) -> [f64; 2] {
    if trials == 0 {
        return [0.0, 1.0];
    }
    let lower = if successes == 0 {
        0.0
    } else {
        bisect(|p| binomial_tail(trials, successes, p) - 0.025)
    };
    let upper = if successes == trials {
        1.0
    } else {
        bisect(|p| binomial_tail(trials, successes + 1, p) - 0.975)
    };
    [lower, upper]
}

/// Root of a function that increases on the interval from 0 to 1.
fn bisect(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tail_of_a_few_coins() {
        assert!((binomial_tail(4, 3, 0.5) - 5.0 / 16.0).abs() < 1e-14);
        assert!((binomial_tail(3, 0, 0.2) - 1.0).abs() < 1e-14);
        assert!((binomial_tail(2_000, 1, 1e-3) - (1.0 - 0.999_f64.powi(2_000))).abs() < 1e-12);
    }

    #[test]
    fn intervals_are_those_of_tables() {
        // Closed forms at the edges: (a/2)^(1/n).
        let [low, high] = clopper_pearson(10, 10);
        assert!((low - 0.025_f64.powf(0.1)).abs() < 1e-12);
        assert!((high - 1.0).abs() < 1e-12);
        // 5 of 20: 0.0866 to 0.4910 (Clopper and Pearson's charts; R's binom.test).
        let [low, high] = clopper_pearson(5, 20);
        assert!((low - 0.086_571).abs() < 1e-6, "{low}");
        assert!((high - 0.491_046).abs() < 1e-6, "{high}");
    }
}
