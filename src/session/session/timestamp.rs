//! Points in time as RFC 3339 in UTC; the clock is the caller's.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A point in time with a resolution of one second, written `2018-07-23T09:05:00Z`.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String", extend("pattern" = r"^\d{4}-\d{2}-\d{2}T\d{2}:\d{2}:\d{2}Z$"))]
pub struct Timestamp {
    seconds: i64,
}

/// The text is not a point in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("invalid value, expected a time such as 2018-07-23T09:05:00Z")]
pub struct NotATimestamp;

const SECONDS_PER_DAY: i64 = 86_400;
/// The last second of the year 9999: later ones have no four-digit year.
const LAST: i64 = 253_402_300_799;

impl Timestamp {
    /// From seconds since 1970-01-01T00:00:00Z; times outside the years 1970 to 9999 are clamped to
    /// that range.
    #[must_use]
    pub fn from_unix_seconds(seconds: i64) -> Self {
        Self {
            seconds: seconds.clamp(0, LAST),
        }
    }

    /// Seconds since 1970-01-01T00:00:00Z.
    #[must_use]
    pub fn unix_seconds(self) -> i64 {
        self.seconds
    }
}

/// Days since 1970-01-01 for a date of the Gregorian calendar (with months counted from March, so that the leap
/// day is the last of its year).
fn days_from_date(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let month_from_march = (month + 9) % 12;
    let day_of_year = (153 * month_from_march + 2) / 5 + day - 1;
    365 * year + year / 4 - year / 100 + year / 400 + day_of_year - 719_468
}

/// Year, month and day of a number of days since 1970-01-01.
fn date_from_days(days: i64) -> (i64, i64, i64) {
    let days = days + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = (month_from_march + 2) % 12 + 1;
    let year = 400 * era + year_of_era + i64::from(month <= 2);
    (year, month, day)
}

impl fmt::Display for Timestamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (year, month, day) = date_from_days(self.seconds / SECONDS_PER_DAY);
        let second = self.seconds % SECONDS_PER_DAY;
        let (h, m, s) = (second / 3600, second / 60 % 60, second % 60);
        write!(f, "{year:04}-{month:02}-{day:02}T{h:02}:{m:02}:{s:02}Z")
    }
}

impl FromStr for Timestamp {
    type Err = NotATimestamp;

    fn from_str(text: &str) -> Result<Self, NotATimestamp> {
        let number = |start: usize, end: usize| {
            let digits = text.get(start..end).ok_or(NotATimestamp)?;
            digits
                .parse::<u32>()
                .map(i64::from)
                .map_err(|_| NotATimestamp)
        };
        let (year, month, day) = (number(0, 4)?, number(5, 7)?, number(8, 10)?);
        let second = 3600 * number(11, 13)? + 60 * number(14, 16)? + number(17, 19)?;
        let days = days_from_date(year, month.clamp(1, 12), day);
        let time = Self::from_unix_seconds(SECONDS_PER_DAY * days + second);
        // A text with values out of range or misplaced characters differs from the text written for its value.
        if time.to_string() == text {
            Ok(time)
        } else {
            Err(NotATimestamp)
        }
    }
}

impl TryFrom<String> for Timestamp {
    type Error = NotATimestamp;

    fn try_from(text: String) -> Result<Self, NotATimestamp> {
        text.parse()
    }
}

impl From<Timestamp> for String {
    fn from(time: Timestamp) -> Self {
        time.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_times() {
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (1_532_336_700, "2018-07-23T09:05:00Z"),
            (4_107_542_399, "2100-02-28T23:59:59Z"),
            (LAST, "9999-12-31T23:59:59Z"),
        ] {
            assert_eq!(Timestamp::from_unix_seconds(seconds).to_string(), text);
            assert_eq!(text.parse(), Ok(Timestamp { seconds }));
        }
    }

    #[test]
    fn what_is_no_time_is_refused() {
        for text in [
            "",
            "2018-07-23",
            "2018-02-29T00:00:00Z",
            "2018-13-01T00:00:00Z",
            "2018-07-23T24:00:00Z",
            "2018-07-23T09:05:00+02:00",
            "2018-07-23T09:05:00Z ",
            "1969-12-31T23:59:59Z",
            "2018-07-23T0\u{e4}:05:00Z",
        ] {
            assert_eq!(text.parse::<Timestamp>(), Err(NotATimestamp), "{text}");
        }
    }

    #[test]
    fn every_day_reads_back() {
        for day in 0..150_000 {
            let time = Timestamp::from_unix_seconds(day * SECONDS_PER_DAY + day % SECONDS_PER_DAY);
            assert_eq!(time.to_string().parse(), Ok(time));
        }
    }
}
