//! Counts of many, with exact binomial intervals.

use std::fmt::{self, Display};
use std::ops::Add;

use serde::{Deserialize, Serialize};

/// So many of so many. As text with its 95 % interval, to one decimal unless another precision is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Share {
    /// Number of those that are counted.
    pub part: usize,
    /// Number of all.
    pub whole: usize,
}

impl Share {
    /// Of all, those of which something is true.
    pub fn of<T>(all: impl IntoIterator<Item = T>, is: impl Fn(T) -> bool) -> Self {
        let mut share = Self::default();
        all.into_iter().for_each(|one| share.count(is(one)));
        share
    }

    /// Counts one more, of which something is true or not.
    pub fn count(&mut self, is: bool) {
        self.part += usize::from(is);
        self.whole += 1;
    }

    /// Part of the whole; 0 of nothing.
    #[must_use]
    pub fn ratio(self) -> f64 {
        self.part as f64 / self.whole.max(1) as f64
    }

    /// Clopper-Pearson 95 % interval of the ratio.
    #[must_use]
    pub fn interval(self) -> [f64; 2] {
        clopper_pearson(self.part, self.whole)
    }

    /// The ratio in percent, without an interval.
    #[must_use]
    pub fn percent(self) -> String {
        match self.whole {
            0 => "-".to_owned(),
            _ => format!("{:.1} %", 100.0 * self.part as f64 / self.whole as f64),
        }
    }

    /// The part without the whole, and the ratio with its interval.
    #[must_use]
    pub fn without_whole(self) -> String {
        let [low, high] = self.interval().map(|p| 100.0 * p);
        let own = 100.0 * self.ratio();
        match self.whole {
            0 => "-".to_owned(),
            _ => format!("{}: {own:.1} % ({low:.1} to {high:.1})", self.part),
        }
    }
}

impl Add for Share {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            part: self.part + other.part,
            whole: self.whole + other.whole,
        }
    }
}

impl Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { part, whole } = self;
        if *whole == 0 {
            return f.write_str("-");
        }
        let decimals = f.precision().unwrap_or(1);
        let [low, high] = self.interval().map(|p| 100.0 * p);
        let own = 100.0 * *part as f64 / *whole as f64;
        write!(
            f,
            "{part} of {whole}: {own:.decimals$} % ({low:.decimals$} to {high:.decimals$})"
        )
    }
}

/// The middle value, or the upper one of two; no number of none.
#[must_use]
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Sum of a value over many; unlike that of an iterator, the sum of no numbers is not -0.
pub fn total<O, T: Default + Add<Output = T>>(all: &[&O], value: impl Fn(&O) -> T) -> T {
    let values = all.iter().map(|one| value(one));
    values.fold(T::default(), T::add)
}

/// Number of those of which something is true.
pub fn count<O>(all: &[&O], is: impl Fn(&O) -> bool) -> usize {
    all.iter().filter(|one| is(one)).count()
}

/// Outcomes by the name of their case in the order of the names, and all of them last.
pub fn by_name<'o, C, O>(
    names: &[&'static str],
    outcomes: &'o [(C, O)],
    name: impl Fn(&C) -> &'static str,
) -> Vec<(&'static str, Vec<&'o O>)> {
    let only = |wanted: &'static str| {
        let of = outcomes.iter().filter(|(case, _)| name(case) == wanted);
        (wanted, of.map(|(_, outcome)| outcome).collect())
    };
    let all = outcomes.iter().map(|(_, outcome)| outcome).collect();
    names
        .iter()
        .map(|name| only(name))
        .chain([("all", all)])
        .collect()
}

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
    fn shares_are_written_with_their_interval() {
        let share = Share::of(0..20, |k| k < 5);
        assert_eq!(share.to_string(), "5 of 20: 25.0 % (8.7 to 49.1)");
        assert_eq!(format!("{share:.0}"), "5 of 20: 25 % (9 to 49)");
        assert_eq!(share.without_whole(), "5: 25.0 % (8.7 to 49.1)");
        let both = total(&[&share, &Share::default()], |one| *one);
        assert_eq!(
            (both.percent(), Share::default().to_string()),
            ("25.0 %".to_owned(), "-".to_owned())
        );
    }

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
