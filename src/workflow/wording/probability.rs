//! Probabilities in words and numbers.

use tautline_core::diagnosis::NAMING_PROBABILITY;

/// Probability from which something is called probable.
const PROBABLE: f64 = 0.75;
/// Largest odds given as a number.
const MOST_ODDS: f64 = 1000.0;

/// `98 %`; nothing is rounded to 0 or 100 %.
pub fn percent(probability: f64) -> String {
    let percent = 100.0 * probability;
    match percent {
        _ if percent > 99.9 => "more than 99.9 %".to_owned(),
        _ if percent < 0.1 => "less than 0.1 %".to_owned(),
        _ if !(1.0..=99.0).contains(&percent) => format!("{percent:.1} %"),
        _ => format!("{percent:.0} %"),
    }
}

/// `almost certainly (98 %)`.
pub fn certainty(probability: f64) -> String {
    format!("{} ({})", degree(probability), percent(probability))
}

/// A probability in words: `almost certainly`.
pub fn degree(probability: f64) -> &'static str {
    match probability {
        p if p >= NAMING_PROBABILITY => "almost certainly",
        p if p >= PROBABLE => "probably",
        p if p > 0.5 => "more likely than not",
        _ => "possibly",
    }
}

/// Odds of one probability against another: `2 to 1`, or `even odds` if they are about equal.
pub fn odds_between(one: f64, other: f64) -> String {
    let odds = one / other;
    if !(1.2..=MOST_ODDS).contains(&odds) {
        return if odds < 1.2 {
            "even odds".to_owned()
        } else {
            format!("more than {MOST_ODDS} to 1")
        };
    }
    if odds < 1.75 {
        return "3 to 2".to_owned();
    }
    let digits = if odds < 20.0 { 1.0 } else { 10.0 };
    format!("{} to 1", digits * (odds / digits).round())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_rounded_to_certain() {
        let said = [0.5, 0.98, 0.9934, 0.99996, 1.0, 0.004, 1e-9].map(percent);
        let expected = [
            "50 %",
            "98 %",
            "99.3 %",
            "more than 99.9 %",
            "more than 99.9 %",
            "0.4 %",
            "less than 0.1 %",
        ];
        assert_eq!(said, expected);
    }

    #[test]
    fn words_go_with_the_number() {
        let said = [0.98, 0.8, 0.6, 0.5, 0.1].map(certainty);
        let expected = [
            "almost certainly (98 %)",
            "probably (80 %)",
            "more likely than not (60 %)",
            "possibly (50 %)",
            "possibly (10 %)",
        ];
        assert_eq!(said, expected);
    }

    #[test]
    fn odds_are_small_numbers() {
        let said = [
            (0.5, 0.45),
            (0.6, 0.4),
            (0.6, 0.3),
            (0.98, 0.02),
            (0.99, 1e-9),
        ];
        let said = said.map(|(one, other)| odds_between(one, other));
        assert_eq!(
            said,
            [
                "even odds",
                "3 to 2",
                "2 to 1",
                "50 to 1",
                "more than 1000 to 1"
            ]
        );
    }
}
