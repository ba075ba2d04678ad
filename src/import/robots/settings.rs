//! The numbers of a text file with their keys and positions, for reading and for replacing them.
//!
//! | syntax | text | key |
//! |---|---|---|
//! | G-code | `M669 A1:2:3` | `M669 A.1` is 2 |
//! | sections | `[stepper_a]`, `anchor_x: 1` | `stepper_a.anchor_x` |
//! | mappings of YAML | `kinematics:`, below it `tlX: 1` | `kinematics.tlX` |
//! | sequences of YAML | `points:`, below it `- frame: [1, 2]` | `points.0.frame.1` is 2 |
//!
//! Where a key occurs several times, the last one holds, as it does for the programs that read these files.

use std::ops::Range;

use tautline_files::{Location, ReadError, quoted};

use super::dialect::{Meaning, Parameter, Setting};

/// Deepest nesting of YAML.
const MAX_DEPTH: usize = 64;

/// All values of a text, with a record of those that were read.
#[derive(Debug)]
pub(super) struct Settings<'t> {
    pub(super) file: &'t str,
    text: &'t str,
    /// Keys with the bytes of their values.
    all: Vec<(String, Range<usize>)>,
    used: Vec<String>,
    /// Numbers that were read and that a calibration may change.
    pub(super) parameters: Vec<Parameter>,
}

impl<'t> Settings<'t> {
    pub(super) fn new(file: &'t str, text: &'t str) -> Self {
        Self {
            file,
            text,
            all: Vec::new(),
            used: Vec::new(),
            parameters: Vec::new(),
        }
    }

    /// Adds the value of a key.
    pub(super) fn push(&mut self, key: String, value: &str) {
        let value = value.trim();
        let start = value.as_ptr() as usize - self.text.as_ptr() as usize;
        self.all.push((key, start..start + value.len()));
    }

    /// Adds the values of a list, which white space or commas separate.
    fn push_list(&mut self, key: &str, list: &str) {
        let is_between = |letter: char| letter == ',' || letter.is_whitespace();
        let values = list.split(is_between).filter(|value| !value.is_empty());
        for (index, value) in values.enumerate() {
            self.push(format!("{key}.{index}"), value);
        }
    }

    /// Numbers under a key, each with the row for its index.
    pub(super) fn numbers<const N: usize>(
        &mut self,
        key: &str,
        cable: &str,
        row: fn(usize) -> Setting,
    ) -> Result<[f64; N], ReadError> {
        let mut numbers = [0.0; N];
        for (index, number) in numbers.iter_mut().enumerate() {
            *number = self.number(&row(index), format!("{key}.{index}"), cable)?;
        }
        Ok(numbers)
    }

    /// Makes the coordinates (m) of a cable's point in some bytes of the text parameters.
    pub(super) fn point(
        &mut self,
        key: &str,
        at: Range<usize>,
        cable: &str,
        row: fn(usize) -> Setting,
    ) -> Result<(), ReadError> {
        self.push_list(key, self.text.get(at).unwrap_or_default());
        self.numbers::<3>(key, cable, row).map(drop)
    }

    /// Commands of G-code: a word in letters and digits, then letters with values, which colons separate.
    pub(super) fn of_gcode(file: &'t str, text: &'t str) -> Self {
        let mut settings = Self::new(file, text);
        for line in text.lines() {
            let mut words = words(line.split(';').next().unwrap_or_default());
            let command = words.next().unwrap_or_default().to_uppercase();
            for word in words {
                let mut letters = word.chars();
                let letter = letters.next().unwrap_or_default().to_ascii_uppercase();
                for (index, value) in letters.as_str().split(':').enumerate() {
                    settings.push(format!("{command} {letter}.{index}"), value);
                }
            }
        }
        settings
    }

    /// Lines `key: value` or `key = value` in sections `[name]`.
    pub(super) fn of_sections(file: &'t str, text: &'t str) -> Self {
        let mut settings = Self::new(file, text);
        let mut section = "";
        for line in text.lines() {
            let line = line.split(['#', ';']).next().unwrap_or_default().trim();
            if let Some(name) = line.strip_prefix('[') {
                section = name.trim_end_matches(']');
            } else if let Some((key, value)) = line.split_once([':', '=']) {
                settings.push(format!("{section}.{}", key.trim()), value);
            }
        }
        settings
    }

    /// Mappings and sequences of YAML, nested by their indentation, and lists of numbers on one line.
    pub(super) fn of_yaml(file: &'t str, text: &'t str) -> Self {
        let mut settings = Self::new(file, text);
        let mut open: Vec<(usize, String)> = Vec::new();
        for line in text.lines() {
            let line = line.split('#').next().unwrap_or_default().trim_end();
            let mut rest = line.trim_start();
            let mut is_item = false;
            while (rest == "-" || rest.starts_with("- ")) && open.len() < MAX_DEPTH {
                let indent = line.len() - rest.len();
                // A sequence may stand below its key without being indented.
                open.retain(|(outer, _)| *outer <= indent);
                let is_item_of = |(outer, key): &mut (usize, String)| {
                    *outer == indent && key.parse::<u32>().is_ok()
                };
                let before = open.pop_if(is_item_of).and_then(|one| one.1.parse().ok());
                let index = before.map_or(0, |before: u32| before.saturating_add(1));
                open.push((indent, index.to_string()));
                (rest, is_item) = (rest[1..].trim_start(), true);
            }
            let indent = line.len() - rest.len();
            let mut value = rest;
            if let Some((key, after)) = rest.split_once(':') {
                open.retain(|(outer, _)| *outer < indent);
                open.push((indent, key.to_owned()));
                value = after;
            } else if !is_item {
                continue;
            }
            let path: Vec<&str> = open.iter().map(|(_, key)| key.as_str()).collect();
            match value.trim().strip_prefix('[') {
                Some(list) => settings.push_list(&path.join("."), list.trim_end_matches(']')),
                None => settings.push(path.join("."), value),
            }
        }
        settings
    }

    /// The bytes of the value of a key.
    fn place(&self, key: &str) -> Option<Range<usize>> {
        let found = self.all.iter().rev().find(|(known, _)| known == key)?;
        Some(found.1.clone())
    }

    /// The value of a key.
    pub(super) fn text(&self, key: &str) -> Option<&'t str> {
        self.text.get(self.place(key)?)
    }

    /// The number of a row in SI units, for a cable with its index and name.
    pub(super) fn get(
        &mut self,
        row: &Setting,
        (index, name): (usize, &str),
    ) -> Result<f64, ReadError> {
        let key = row.key.replace("{cable}", name);
        let key = key.replace("{index}", &index.to_string());
        self.number(row, key, name)
    }

    /// The number of a row that stands under another key, in SI units.
    pub(super) fn number(
        &mut self,
        row: &Setting,
        key: String,
        cable: &str,
    ) -> Result<f64, ReadError> {
        self.used.push(key.clone());
        let Some((text, at)) = self.text(&key).zip(self.place(&key)) else {
            let message = format!("found no {key}, expected a number in {}", row.unit.0);
            let missing = || self.error(&key, message);
            return Ok(row.default.ok_or_else(missing)? / row.unit.1);
        };
        let number = text.parse().ok().filter(|value: &f64| value.is_finite());
        let value = number.ok_or_else(|| {
            let message = format!("{key}: found {}, expected a number", quoted(text));
            self.error(&key, message)
        })?;
        if row.meaning != Meaning::Kept {
            self.parameters.push(Parameter {
                key,
                cable: cable.to_owned(),
                value,
                row: *row,
                at,
            });
        }
        Ok(value / row.unit.1)
    }

    /// The number of a row, which must be positive.
    pub(super) fn positive(&mut self, row: &Setting, at: (usize, &str)) -> Result<f64, ReadError> {
        let value = self.get(row, at)?;
        if value > 0.0 {
            return Ok(value);
        }
        let key = self.used.last().cloned().unwrap_or_default();
        let found = value * row.unit.1;
        let message = format!("{key}: found {found}, expected a positive number");
        Err(self.error(&key, message))
    }

    /// An error about the value of a key, or about the file if the key is absent.
    pub(super) fn error(&self, key: &str, message: impl Into<String>) -> ReadError {
        let place = self.place(key).map_or(Location::File, |at| {
            let before = &self.text[..at.start];
            let line = before.rsplit('\n').next().unwrap_or_default();
            let lines = before.matches('\n').count() as u64;
            Location::Character(lines + 1, line.chars().count() as u64 + 1)
        });
        ReadError::new(self.file, place, message)
    }

    /// Whether any key begins with `prefix`.
    pub(super) fn has(&self, prefix: &str) -> bool {
        self.all.iter().any(|(key, _)| key.starts_with(prefix))
    }

    /// A notice with a reason about the unused keys with one of these beginnings; a list of values counts as one.
    pub(super) fn left_out(&self, prefixes: &[&str], why: &str) -> Option<String> {
        let is_meant = |key: &String| prefixes.iter().any(|prefix| key.starts_with(prefix));
        let keys = self.all.iter().map(|(key, _)| key);
        let keys = keys.filter(|key| is_meant(key) && !self.used.contains(key));
        let digits = |letter: char| letter == '.' || letter.is_ascii_digit();
        let mut names: Vec<&str> = keys.map(|key| key.trim_end_matches(digits)).collect();
        names.sort_unstable();
        names.dedup();
        let names = names.join(", ");
        (!names.is_empty()).then(|| format!("{}: left out, as {why}: {names}", self.file))
    }
}

/// Words of a line of G-code; a text in quotes is part of its word.
fn words(line: &str) -> impl Iterator<Item = &str> {
    let mut is_quoted = false;
    let words = line.split(move |letter: char| {
        is_quoted ^= letter == '"';
        letter.is_whitespace() && !is_quoted
    });
    words.filter(|word| !word.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_places_in_every_syntax() {
        let gcode = "M669 K6 ; A9\nm669 A1.5:-2 B3\nM950 C\"a b\"\n";
        let sections = "[printer]\nkinematics = winch # no\n[stepper_a]\nanchor_x: 4\n";
        let sequences = "p: [1, 2]\nq:\n- f: [3, 4]\n  g:\n  - 5\n  - 6\n-\n  f: 7\n";
        let keys_of = |text| {
            let read = Settings::of_yaml("f", text).all;
            let pairs = read.into_iter().filter(|(_, at)| !at.is_empty());
            let pairs = pairs.map(|(key, at)| format!("{key}={}", &text[at]));
            pairs.collect::<Vec<_>>().join(" ")
        };
        assert_eq!(
            keys_of(sequences),
            "p.0=1 p.1=2 q.0.f.0=3 q.0.f.1=4 q.0.g.0=5 q.0.g.1=6 q.1.f=7"
        );
        let yaml = "a:\n  b: 1 # no\n  c:\n    d: 2\n  e: 3\nmeta: \nlast: 9\n";
        let read = [
            Settings::of_gcode("f", gcode),
            Settings::of_sections("f", sections),
            Settings::of_yaml("f", yaml),
        ];
        let keys = |settings: &Settings<'_>| -> Vec<String> {
            settings.all.iter().map(|(key, _)| key.clone()).collect()
        };
        let of_gcode = ["M669 K.0", "M669 A.0", "M669 A.1", "M669 B.0", "M950 C.0"];
        assert_eq!(keys(&read[0]), of_gcode);
        assert_eq!(keys(&read[1]), ["printer.kinematics", "stepper_a.anchor_x"]);
        assert_eq!(
            keys(&read[2]),
            ["a", "a.b", "a.c", "a.c.d", "a.e", "meta", "last"]
        );
        assert_eq!(read[0].text("M669 A.1"), Some("-2"));
        assert_eq!(read[1].text("printer.kinematics"), Some("winch"));
        assert_eq!(read[2].text("a.c.d"), Some("2"));
        let error = read[2].error("a.e", "no").to_string();
        assert_eq!(error, "f, line 5, column 6: no");
    }
}
