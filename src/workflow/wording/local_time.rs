//! Points in time in the time zone of the computer. Files use UTC.

use jiff::tz::{Offset, TimeZone};
use jiff::{Timestamp as Instant, Zoned};
use tautline_session::Timestamp;

/// Date and time of day: `2018-07-23 11:05`.
#[must_use]
pub fn date_and_time(time: Timestamp) -> String {
    local(time, TimeZone::system())
        .strftime("%Y-%m-%d %H:%M")
        .to_string()
}

/// Time of day: `11:05:00`.
#[must_use]
pub fn time_of_day(time: Timestamp) -> String {
    local(time, TimeZone::system())
        .strftime("%H:%M:%S")
        .to_string()
}

/// Date and time of day with UTC offset: `2018-07-23, 11:05 (UTC+02:00)`.
#[must_use]
pub fn with_offset(time: Timestamp) -> String {
    said_with_offset(&local(time, TimeZone::system()))
}

fn said_with_offset(time: &Zoned) -> String {
    let text = time.strftime("%Y-%m-%d, %H:%M");
    if time.offset() == Offset::UTC {
        return format!("{text} UTC");
    }
    format!("{text} (UTC{})", time.strftime("%:z"))
}

fn local(time: Timestamp, zone: TimeZone) -> Zoned {
    // All times in files are within the range of jiff, whose last year is 9999, too.
    let instant = Instant::from_second(time.unix_seconds()).unwrap_or(Instant::MAX);
    instant.to_zoned(zone)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str, zone: TimeZone) -> Zoned {
        local(text.parse().expect("a time"), zone)
    }

    #[test]
    fn reports_say_the_offset_and_know_summer_time() {
        // The rule of central Europe, written out: the test does not depend on the zones that a computer knows.
        let berlin = || TimeZone::posix("CET-1CEST,M3.5.0,M10.5.0/3").expect("a rule");
        for (time, zone, expected) in [
            (
                "2018-07-23T09:05:00Z",
                TimeZone::UTC,
                "2018-07-23, 09:05 UTC",
            ),
            (
                "2018-07-23T09:05:00Z",
                berlin(),
                "2018-07-23, 11:05 (UTC+02:00)",
            ),
            (
                "2018-12-31T23:30:00Z",
                berlin(),
                "2019-01-01, 00:30 (UTC+01:00)",
            ),
        ] {
            assert_eq!(said_with_offset(&at(time, zone)), expected);
        }
    }

    #[test]
    fn the_last_second_of_files_is_no_error() {
        for time in ["1970-01-01T00:00:00Z", "9999-12-31T23:59:59Z"] {
            for text in [date_and_time, time_of_day, with_offset] {
                assert!(!text(time.parse().expect("a time")).is_empty());
            }
        }
    }
}
