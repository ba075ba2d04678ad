//! Lines of text from a device, parsed as a distance, no return, or invalid.

use regex::Regex;
use tautline_session::LineLaserSettings;

use crate::laser::source::LONGEST_M;

/// Longest valid line (bytes).
const LONGEST_LINE: usize = 256;
/// Length limit of a quoted line in a message (characters).
const SHOWN: usize = 40;

/// The meaning of a line.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum LineContent {
    /// A distance (m).
    Distance(f64),
    /// The sensor has no return.
    NoReturn,
    /// Neither; the text states why.
    Invalid(String),
}

/// Splits bytes into lines in bounded memory.
///
/// The first line is dropped, because its start may be missing.
#[derive(Debug, Default)]
pub(super) struct LineSplitter {
    line: Vec<u8>,
    /// Whether the present line was received from its start.
    whole: bool,
    too_long: bool,
}

impl LineSplitter {
    /// Drops an incomplete line.
    pub fn reset(&mut self) {
        if !self.line.is_empty() || self.too_long {
            *self = Self::default();
        }
    }

    /// Adds bytes and passes on the completed lines; lines that are too long as `None`.
    pub fn take(&mut self, bytes: &[u8], mut each: impl FnMut(Option<&[u8]>)) {
        for byte in bytes {
            if matches!(byte, b'\n' | b'\r') {
                if self.whole && self.too_long {
                    each(None);
                } else if self.whole && !self.line.is_empty() {
                    each(Some(&self.line));
                }
                self.line.clear();
                self.whole = true;
                self.too_long = false;
            } else if self.line.len() < LONGEST_LINE {
                self.line.push(*byte);
            } else {
                self.too_long = true;
            }
        }
    }
}

/// Parses lines according to the settings of a device.
pub(super) struct LineParser {
    settings: LineLaserSettings,
    expression: Regex,
}

impl LineParser {
    /// Creates a parser; fails if the pattern is invalid.
    pub fn new(settings: &LineLaserSettings) -> Result<Self, String> {
        Ok(Self {
            expression: settings.expression()?,
            settings: settings.clone(),
        })
    }

    /// The meaning of a line; `None` if it is blank or the echo of the command.
    pub fn parse(&self, line: Option<&[u8]>) -> Option<LineContent> {
        let Some(line) = line else {
            let text = format!("it sent a line of more than {LONGEST_LINE} characters");
            return Some(LineContent::Invalid(text));
        };
        let printable = |byte: &u8| *byte == b'\t' || (b' '..=b'~').contains(byte);
        let text = std::str::from_utf8(line).ok();
        let Some(text) = text.filter(|_| line.iter().all(printable)) else {
            let text = "it sent bytes that are not plain text: do baud rate and parity match the settings?";
            return Some(LineContent::Invalid(text.to_owned()));
        };
        let text = text.trim();
        let command = self.settings.command.as_deref().map(str::trim);
        if text.is_empty() || command == Some(text) {
            return None;
        }
        let mut no_return = self.settings.no_return.iter();
        if no_return.any(|mark| text.contains(mark.as_str())) {
            return Some(LineContent::NoReturn);
        }
        Some(self.distance(text))
    }

    fn distance(&self, text: &str) -> LineContent {
        let shown: String = text.chars().take(SHOWN).collect();
        let garbage = |what: &str| LineContent::Invalid(format!("it sent {shown:?}, {what}"));
        let Some(found) = self.expression.captures(text) else {
            return garbage("which is not a distance by the settings");
        };
        let number = found.name("distance").map(|number| number.as_str());
        let Some(number) = number.and_then(|number| number.parse::<f64>().ok()) else {
            return garbage("in which the distance is not a number");
        };
        let unit = self.settings.unit;
        let stated = found.name("unit").map(|unit| unit.as_str());
        if stated.is_some_and(|stated| stated != unit.name()) {
            return garbage(&format!("but the unit is {} by the settings", unit.name()));
        }
        let distance_m = number * self.settings.scale * unit.metres() + self.settings.offset_m;
        if (0.0..=LONGEST_M).contains(&distance_m) {
            LineContent::Distance(distance_m)
        } else {
            let text = format!("expected a distance from 0 m to {LONGEST_M:.0} m");
            garbage(&text)
        }
    }
}

#[cfg(test)]
mod tests {
    use tautline_session::LaserSettings;

    use super::*;

    fn reader(query: &str) -> LineParser {
        let settings = format!("tcp:host:1{query}").parse();
        let Ok(LaserSettings::Line(line)) = settings else {
            panic!("{settings:?}");
        };
        LineParser::new(&line).unwrap()
    }

    fn parse(reader: &LineParser, text: &str) -> Option<LineContent> {
        reader.parse(Some(text.as_bytes()))
    }

    #[test]
    fn numbers_that_stand_alone_are_distances() {
        let plain = reader("?no_return=E255");
        for text in [
            "512.5",
            " D: 512.5 mm",
            "d=512.5mm ok",
            "+5.125e2",
            "512.5;1",
            "Distance = 512.5",
            "RANGE 512.5 mm",
        ] {
            let read = parse(&plain, text);
            assert_eq!(read, Some(LineContent::Distance(0.5125)), "{text}");
        }
        assert_eq!(parse(&plain, "E255"), Some(LineContent::NoReturn));
        assert_eq!(parse(&plain, "  "), None);
        for text in [
            "E15",
            "12,5",
            "1.2.3",
            "0x12",
            "12abc",
            "-3",
            "NaN",
            "inf",
            "1e9",
            "5.1 m",
            "--12",
            "1-2",
            "µ 3",
            "3\u{0}",
            "ready",
            "ERR 12",
            "E 15",
            "Error: 3",
            "alarm=7",
            "T: 23.5",
            "code;9",
            "D: ERR 12",
        ] {
            let read = parse(&plain, text);
            assert!(
                matches!(read, Some(LineContent::Invalid(_))),
                "{text}: {read:?}"
            );
        }
        let read = plain.parse(Some(&[0xff, b'1']));
        assert!(matches!(read, Some(LineContent::Invalid(text)) if text.contains("baud")));
        assert!(matches!(plain.parse(None), Some(LineContent::Invalid(_))));
    }

    #[test]
    fn settings_say_what_a_number_is() {
        let dimetix = reader(
            r"?pattern=^g0g\+(?<distance>\d{8})$&scale=0.1&offset_m=0.05&no_return=g0@E&command=s0g%0D%0A",
        );
        let Some(LineContent::Distance(read)) = parse(&dimetix, "g0g+00012345") else {
            panic!("no distance");
        };
        assert!((read - 1.2845).abs() < 1e-12);
        assert_eq!(parse(&dimetix, "g0@E255"), Some(LineContent::NoReturn));
        assert_eq!(parse(&dimetix, "s0g"), None);
        for text in ["g0g+0001234", "0g+00012345", "00012345"] {
            assert!(matches!(
                parse(&dimetix, text),
                Some(LineContent::Invalid(_))
            ));
        }
        let letters = reader("?pattern=(?<distance>.*)");
        assert!(matches!(
            parse(&letters, "NaN"),
            Some(LineContent::Invalid(_))
        ));
        assert!(matches!(
            parse(&letters, "abc"),
            Some(LineContent::Invalid(_))
        ));
        let metres = reader("?unit=m");
        assert_eq!(parse(&metres, "1.5"), Some(LineContent::Distance(1.5)));
        let micrometres = reader("?unit=um");
        let read = parse(&micrometres, "250000 um");
        assert_eq!(read, Some(LineContent::Distance(0.25)));
    }

    fn lines(chunks: &[&[u8]]) -> Vec<Option<String>> {
        let mut lines = LineSplitter::default();
        let mut found = Vec::new();
        for chunk in chunks {
            lines.take(chunk, |line| {
                found.push(line.map(|line| String::from_utf8_lossy(line).into_owned()));
            });
            assert!(lines.line.capacity() <= 2 * LONGEST_LINE);
        }
        found
    }

    #[test]
    fn only_whole_lines_count() {
        let text = |text: &str| Some(text.to_owned());
        assert_eq!(
            lines(&[b"23.4\r\n1", b"02", b"3.4\r", b"\n\n5\n6"]),
            [text("1023.4"), text("5")]
        );
        let long = vec![b'7'; 100_000];
        assert_eq!(lines(&[b"\n", &long, b"\n8\n"]), [None, text("8")]);
        assert_eq!(lines(&[&long, b"\n8\n"]), [text("8")]);
        let mut given_up = LineSplitter::default();
        let mut found = Vec::new();
        given_up.take(b"\n12", |_| found.push(0));
        given_up.reset();
        given_up.take(b"34\n56\n", |line| found.push(line.map_or(0, <[u8]>::len)));
        assert_eq!(found, [2]);
    }
}
