//! What a report says, part by part: in words for the technician first, then the numbers for the engineer.

mod about;
mod accuracy;
mod adjustments;
mod causes;
mod data;
mod fit;
mod geometry;
mod limits;
mod method;
mod result;
mod robot;

use tautline_session::Timestamp;

use super::ReportInput;
use super::document::Document;
use crate::wording::units;

/// What stands where there is no number.
const NONE: &str = "–";

/// The whole report.
pub fn document(input: &ReportInput<'_>) -> Document {
    let session = input.session;
    let sections = [
        Some(result::section(input)),
        Some(robot::section(&session.robot)),
        Some(data::section(session)),
        input.fit.map(|fit| method::section(session, fit)),
        input.fit.map(geometry::section),
        input.fit.map(|fit| fit::section(fit, input.diagnosis)),
        input.diagnosis.map(causes::section),
        accuracy::section(session),
        adjustments::section(session),
        Some(limits::section(input)),
        Some(about::section(input)),
        about::log(session),
    ];
    Document {
        title: format!("Calibration report: {}", session.name),
        subtitle: vec![
            format!("Robot {}", session.robot.name),
            format!("Made on {}", when(input.now)),
        ],
        sections: sections.into_iter().flatten().collect(),
    }
}

/// A point in time as people write it: `2018-07-23, 09:05 UTC`.
fn when(time: Timestamp) -> String {
    let text = time.to_string();
    let part = |from: usize, to: usize| text.get(from..to).unwrap_or_default();
    format!("{}, {} UTC", part(0, 10), part(11, 16))
}

/// A number with a sign that is as long as the digits are high, and no minus before nothing but zeros.
fn number(value: f64, decimals: usize) -> String {
    units::fixed(value, decimals).replace('-', "−")
}

/// The same with a plus where it is positive.
fn signed(value: f64, decimals: usize) -> String {
    units::signed(value, decimals).replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_signs_that_mean_something() {
        let all = [-1.25, -0.001, 0.0, 0.001, 2.0];
        assert_eq!(
            all.map(|v| number(v, 1)),
            ["−1.2", "0.0", "0.0", "0.0", "2.0"]
        );
        assert_eq!(
            all.map(|v| signed(v, 1)),
            ["−1.2", "0.0", "0.0", "0.0", "+2.0"]
        );
    }

    #[test]
    fn times_are_readable() {
        let time = "2018-07-23T09:05:00Z".parse().expect("a time");
        assert_eq!(when(time), "2018-07-23, 09:05 UTC");
    }
}
