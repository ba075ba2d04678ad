//! Lists, numbers, readings and probabilities in words, shared by reports, screens and the terminal.

pub mod local_time;
pub mod parameters;
mod printable;
pub mod probability;
mod recording;
mod session;
pub mod units;

use tautline_core::diagnosis::Quantity;

pub use printable::{is_obeyed, printable};
pub use recording::{poses_used, sampling_sentence};
pub use session::{recent_facts, session_facts, session_verdict};

/// Name and version of the program, as stated in reports and audit trails.
pub const PROGRAM: &str = concat!("Tautline ", env!("CARGO_PKG_VERSION"));

/// `a, b and c`.
pub fn list<S: AsRef<str>>(items: &[S]) -> String {
    let items: Vec<&str> = items.iter().map(AsRef::as_ref).collect();
    match &items[..] {
        [before @ .., last] if !before.is_empty() => format!("{} and {last}", before.join(", ")),
        _ => items.concat(),
    }
}

/// A noun with its number: `1 pose`, `2 poses`.
pub fn count(number: usize, noun: &str) -> String {
    let ending = if number == 1 { "" } else { "s" };
    format!("{number} {noun}{ending}")
}

/// A noun with its number and the matching verb: `1 pose is`, `2 poses are`.
pub fn count_are(number: usize, noun: &str) -> String {
    let verb = if number == 1 { "is" } else { "are" };
    format!("{} {verb}", count(number, noun))
}

/// The text with an initial capital.
pub fn sentence(text: &str) -> String {
    let mut rest = text.chars();
    let first = rest.next().into_iter().flat_map(char::to_uppercase);
    first.chain(rest).collect()
}

/// A title inside a sentence: the first letter is small.
pub fn first_lower(text: &str) -> String {
    let mut rest = text.chars();
    let first = rest.next().into_iter().flat_map(char::to_lowercase);
    first.chain(rest).collect()
}

/// A probability in words.
pub fn odds(p_value: f64) -> String {
    if p_value < 1e-6 {
        return "less than once in a million times".to_owned();
    }
    if p_value > 0.05 {
        return format!("{:.0} times in 100", 100.0 * p_value);
    }
    // Two significant digits.
    let step = 10_f64.powf((1.0 / p_value).log10().floor() - 1.0);
    let times = ((1.0 / p_value) / step).round() * step;
    format!("about once in {} times", thousands(times as u64))
}

/// A count of at most a million, with a comma from 10,000 on.
fn thousands(count: u64) -> String {
    match count {
        0..10_000 => count.to_string(),
        1_000_000.. => "a million".to_owned(),
        _ => format!("{},{:03}", count / 1000, count % 1000),
    }
}

/// Short label of a cable: its name if that is as short as a number, else its number.
pub fn cable_label(index: usize, name: &str) -> String {
    match name.chars().count() {
        1 | 2 => name.to_owned(),
        _ => (index + 1).to_string(),
    }
}

/// A p-value as in a table of tests: `p = 0.034`, `p < 1e-6`.
pub fn p_value(p_value: f64) -> String {
    match p_value {
        p if p < 1e-6 => "p < 1e-6".to_owned(),
        p if p < 1e-3 => format!("p = {p:.0e}"),
        p => format!("p = {p:.3}"),
    }
}

/// A ratio with three significant digits, or all digits before the point.
pub fn ratio(times: f64) -> String {
    let decimals = match times {
        _ if times < 9.995 => 2,
        _ if times < 99.95 => 1,
        _ => 0,
    };
    format!("{times:.decimals$}")
}

/// Readings of a quantity, or of one cable: `the length readings of cable-3`.
pub fn readings(quantity: Quantity, cable: Option<&str>) -> String {
    let readings = match quantity {
        Quantity::Length => "the length readings",
        Quantity::Tension => "the tension readings",
        Quantity::Laser => "the laser's readings",
        Quantity::Swivel => "the swivel angles",
        Quantity::Inclination => "the inclinometer's readings",
        Quantity::TrackerPosition => "the external instrument's positions",
        Quantity::TrackerOrientation => "the external instrument's orientations",
        Quantity::Distance => "the measured distances",
    };
    match cable {
        Some(cable) => format!("{readings} of {cable}"),
        None => readings.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_said_as_odds() {
        for (p_value, text) in [
            (1e-9, "less than once in a million times"),
            (0.001, "about once in 1000 times"),
            (1.0 / 453_859.0, "about once in 450,000 times"),
            (1e-6, "about once in a million times"),
            (0.3, "30 times in 100"),
        ] {
            assert_eq!(odds(p_value), text);
        }
    }

    #[test]
    fn a_verb_suits_its_number() {
        assert_eq!(count_are(1, "pose"), "1 pose is");
        assert_eq!(count_are(2, "pose"), "2 poses are");
        assert_eq!(count_are(0, "value"), "0 values are");
    }

    #[test]
    fn large_ratios_have_fewer_decimals() {
        assert_eq!(
            [1.0, 9.876, 10.01, 242.57].map(ratio).join(" "),
            "1.00 9.88 10.0 243"
        );
    }

    #[test]
    fn readings_have_names() {
        for quantity in Quantity::ALL {
            assert!(readings(quantity, None).starts_with("the "));
        }
        let text = readings(Quantity::Length, Some("left"));
        assert_eq!(sentence(&text), "The length readings of left");
    }
}
