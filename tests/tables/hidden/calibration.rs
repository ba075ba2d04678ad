//! Fits the function from computed to stated probabilities to the outcomes of studies.

use tautline_core::diagnosis::{Verdict, stated_probability};

use super::Study;
use super::table::logarithmic_score;
use crate::tables::counting::total;
use crate::tables::markdown::Table;

/// Bounds of computed log odds: beyond, a probability is 0 or 1 in double precision.
const LARGEST_LOG_ODDS: f64 = 36.0;
/// Borders of the classes of computed probability in the table.
const BORDERS: [f64; 11] = [0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.95, 0.99, 0.999, 0.9999, 1.0];

/// A list of causes that exclude each other, a name, or a possible cause.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statement {
    /// Computed log odds that one of the causes is present.
    pub log_odds: f64,
    /// Whether one is.
    pub is_true: bool,
}

/// `c s(a + b x)` of the computed log odds `x`, with the logistic function `s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// `a`, `b` and `c`.
    pub values: [f64; 3],
}

/// The statements of a study.
#[must_use]
pub fn statements(study: &Study) -> Vec<Statement> {
    let mut all = Vec::new();
    for outcome in &study.outcomes {
        let said = outcome
            .said
            .iter()
            .filter(|said| said.verdict != Verdict::Unknown);
        let lists = said.map(|said| &said.candidates[..]);
        for causes in lists.chain(outcome.possible.chunks(1)) {
            let stated: f64 = causes.iter().map(|cause| cause.probability).sum();
            if !causes.is_empty() {
                all.push(Statement {
                    log_odds: computed_log_odds(stated),
                    is_true: causes.iter().any(|cause| cause.right),
                });
            }
        }
    }
    all
}

/// Log odds whose stated probability is this, by bisection.
fn computed_log_odds(stated: f64) -> f64 {
    let (mut low, mut high) = (-LARGEST_LOG_ODDS, LARGEST_LOG_ODDS);
    while high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        match stated_probability(logistic(middle)) < stated {
            true => low = middle,
            false => high = middle,
        }
    }
    0.5 * (low + high)
}

fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + (-x).exp())
}

impl Calibration {
    /// The most likely calibration, by a pattern search (Hooke and Jeeves 1961).
    #[must_use]
    pub fn fit(statements: &[Statement]) -> Self {
        let mut best = Self {
            values: [-1.0, 0.7, 0.98],
        };
        let mut steps = [0.5, 0.2, 0.01];
        while steps[0] > 1e-4 {
            let mut has_moved = false;
            for k in 0..3 {
                for sign in [1.0, -1.0] {
                    let mut other = best;
                    other.values[k] += sign * steps[k];
                    if other.score(statements) < best.score(statements) {
                        best = other;
                        has_moved = true;
                    }
                }
            }
            if !has_moved {
                steps = steps.map(|step| 0.5 * step);
            }
        }
        best
    }

    /// The stated probability.
    #[must_use]
    pub fn stated(&self, log_odds: f64) -> f64 {
        let [offset, slope, ceiling] = self.values;
        ceiling * logistic(offset + slope * log_odds)
    }

    /// Mean logarithmic score; infinite for what is no probability.
    #[must_use]
    pub fn score(&self, statements: &[Statement]) -> f64 {
        if !(self.values[2] > 0.0 && self.values[2] < 1.0 && self.values[1] > 0.0) {
            return f64::INFINITY;
        }
        score(statements, |one| self.stated(one.log_odds))
    }
}

fn score(statements: &[Statement], stated: impl Fn(&Statement) -> f64) -> f64 {
    logarithmic_score(statements.iter().map(|one| (stated(one), one.is_true)))
}

/// The fitted calibration, and a table of what was computed, is stated and was true.
#[must_use]
pub fn calibration(study: &Study) -> String {
    let statements = statements(study);
    let fitted = Calibration::fit(&statements);
    let now = |one: &Statement| stated_probability(logistic(one.log_odds));
    let [offset, slope, ceiling] = fitted.values;
    let mut table = Table::new("computed | statements | stated now | fitted | true");
    for borders in BORDERS.windows(2) {
        let is_in = |one: &&Statement| {
            let computed = logistic(one.log_odds);
            (borders[0]..borders[1]).contains(&computed) || computed == 1.0 && borders[1] == 1.0
        };
        let class: Vec<&Statement> = statements.iter().filter(is_in).collect();
        if class.is_empty() {
            continue;
        }
        let mean = |value: &dyn Fn(&Statement) -> f64| {
            100.0 * total::<_, f64>(&class, value) / class.len() as f64
        };
        let [from, to] = [borders[0], borders[1]].map(|p| 100.0 * p);
        table.row(format_args!(
            "{from} to {to} % | {} | {:.1} % | {:.1} % | {:.1} %",
            class.len(),
            mean(&now),
            mean(&|one| fitted.stated(one.log_odds)),
            mean(&|one| f64::from(u8::from(one.is_true))),
        ));
    }
    format!(
        "{} names, lists and possible causes. Fitted: offset {offset:.2}, slope {slope:.2}, ceiling {ceiling:.4}; logarithmic \
         score {:.4}, now {:.4}.\n\n{}",
        statements.len(),
        fitted.score(&statements),
        score(&statements, now),
        table.text(),
    )
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    #[test]
    fn stated_probabilities_are_traced_back_to_what_was_computed() {
        for log_odds in [-4.0, -0.3, 2.0, 9.0] {
            let stated = stated_probability(logistic(log_odds));
            assert!((computed_log_odds(stated) - log_odds).abs() < 1e-5);
        }
    }

    /// With random seeds, each of the three comparisons fails with a probability below 1e-3: the tolerances are more than
    /// four standard deviations.
    #[test]
    fn a_calibration_is_found_again() {
        let truth = Calibration {
            values: [-1.0, 0.5, 0.97],
        };
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let statements: Vec<Statement> = (0..20_000)
            .map(|_| {
                let log_odds = rng.random_range(-5.0..20.0);
                let is_true = rng.random_range(0.0..1.0) < truth.stated(log_odds);
                Statement { log_odds, is_true }
            })
            .collect();
        let fitted = Calibration::fit(&statements).values;
        for ((found, truth), tolerance) in fitted.iter().zip(truth.values).zip([0.2, 0.06, 0.012]) {
            assert!((found - truth).abs() < tolerance, "{fitted:?}");
        }
    }
}
