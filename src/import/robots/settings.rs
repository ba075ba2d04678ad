//! The numbers of a text file with their keys and places, for reading them and for writing others in their place.
//!
//! | syntax | text | key |
//! |---|---|---|
//! | G-code | `M669 A1:2:3` | `M669 A.1` is 2 |
//! | sections | `[stepper_a]`, `anchor_x: 1` | `stepper_a.anchor_x` |
//! | YAML | `points:`, `- frame: [1, 2]` | `points.0.frame.1` is 2 |
//!
//! Where a key occurs several times, the last one holds, as it does for the programs that read these files.

use std::ops::Range;

use tautline_session::{Place, ReadError, quoted};

/// One value with its place.
#[derive(Debug, Clone)]
struct Setting {
    key: String,
    /// Bytes of the value.
    at: Range<usize>,
}

/// All values of a text, in its order.
#[derive(Debug, Clone)]
pub(super) struct Settings<'t> {
    pub(super) file: &'t str,
    text: &'t str,
    all: Vec<Setting>,
}

impl<'t> Settings<'t> {
    fn new(file: &'t str, text: &'t str) -> Self {
        Self {
            file,
            text,
            all: Vec::new(),
        }
    }

    fn push(&mut self, key: String, value: &str) {
        let start = value.as_ptr() as usize - self.text.as_ptr() as usize;
        self.all.push(Setting {
            key,
            at: start..start + value.len(),
        });
    }

    /// Commands of G-code: a word in letters and digits, then letters with values, which colons separate.
    pub(super) fn of_gcode(file: &'t str, text: &'t str) -> Self {
        let mut settings = Self::new(file, text);
        for line in text.lines() {
            let mut words = words(line.split(';').next().unwrap_or_default());
            let Some(command) = words.next().map(str::to_uppercase) else {
                continue;
            };
            for word in words {
                let mut letters = word.chars();
                let letter = letters.next().unwrap_or_default().to_ascii_uppercase();
                for (index, value) in letters.as_str().split(':').enumerate() {
                    settings.push(format!("{command} {letter}.{index}"), value.trim());
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
            let line = line.split(['#', ';']).next().unwrap_or_default();
            let name = line.trim().strip_prefix('[');
            if let Some(name) = name.and_then(|name| name.strip_suffix(']')) {
                section = name.trim();
            } else if let Some((key, value)) = line.split_once([':', '=']) {
                settings.push(format!("{section}.{}", key.trim()), value.trim());
            }
        }
        settings
    }

    /// Mappings and sequences of YAML, in blocks or in `[..]` and `{..}` on one line.
    pub(super) fn of_yaml(file: &'t str, text: &'t str) -> Self {
        let mut settings = Self::new(file, text);
        let mut open: Vec<Block<'_>> = Vec::new();
        for line in text.lines() {
            let line = line.split(" #").next().unwrap_or_default().trim_end();
            let mut rest = line.trim_start();
            if rest.is_empty() || rest.starts_with(['#', '%']) || rest.starts_with("---") {
                continue;
            }
            let mut indent = line.len() - rest.len();
            loop {
                let is_item = rest == "-" || rest.starts_with("- ");
                // The items of a sequence may stand below the first letter of its key.
                let least = indent + usize::from(is_item);
                while open.last().is_some_and(|block| block.indent >= least) {
                    open.pop();
                }
                if !is_item {
                    break;
                }
                match open.last_mut() {
                    Some(Block {
                        indent: at,
                        part: Part::Item(count),
                    }) if *at == indent => *count += 1,
                    _ => open.push(Block {
                        indent,
                        part: Part::Item(0),
                    }),
                }
                let inner = rest[1..].trim_start();
                indent += rest.len() - inner.len();
                rest = inner;
            }
            let is_flow = rest.is_empty() || rest.starts_with(['[', '{']);
            match rest.split_once(':').filter(|_| !is_flow) {
                Some((key, "")) => open.push(Block {
                    indent,
                    part: Part::Key(key),
                }),
                Some((key, value)) => {
                    settings.push_flow(&path(&open, Some(key)), value.trim());
                }
                None if rest.is_empty() => {}
                None => settings.push_flow(&path(&open, None), rest),
            }
        }
        settings
    }

    /// A value of YAML on one line, which may be a sequence or a mapping.
    fn push_flow(&mut self, key: &str, value: &'t str) {
        let inside = |open: char, close: char| value.strip_prefix(open)?.strip_suffix(close);
        let Some(items) = inside('[', ']').or_else(|| inside('{', '}')) else {
            self.push(key.to_owned(), value);
            return;
        };
        let mut depth = 0_i32;
        let items = items.split(|letter| {
            depth += i32::from("[{".contains(letter)) - i32::from("]}".contains(letter));
            letter == ',' && depth == 0
        });
        for (index, item) in items.map(str::trim).enumerate() {
            match item.split_once(':').filter(|_| value.starts_with('{')) {
                Some((name, value)) => {
                    self.push_flow(&format!("{key}.{}", name.trim()), value.trim())
                }
                None => self.push_flow(&format!("{key}.{index}"), item),
            }
        }
    }

    /// The value of a key.
    pub(super) fn text(&self, key: &str) -> Option<&'t str> {
        let found = self.all.iter().rev().find(|setting| setting.key == key)?;
        self.text.get(found.at.clone())
    }

    /// The bytes of a value.
    pub(super) fn place(&self, key: &str) -> Option<Range<usize>> {
        let found = self.all.iter().rev().find(|setting| setting.key == key)?;
        Some(found.at.clone())
    }

    /// The number of a key, `None` where there is none.
    pub(super) fn number(&self, key: &str) -> Result<Option<f64>, ReadError> {
        let Some(text) = self.text(key) else {
            return Ok(None);
        };
        let number = text.parse().ok().filter(|value: &f64| value.is_finite());
        number.map(Some).ok_or_else(|| {
            let message = format!("{key}: found {}, expected a number", quoted(text));
            self.error(key, message)
        })
    }

    /// An error about the value of a key, or about the file if the key is absent.
    pub(super) fn error(&self, key: &str, message: impl Into<String>) -> ReadError {
        let place = self.place(key).map_or(Place::File, |at| {
            let before = &self.text[..at.start];
            let line = before.rsplit('\n').next().unwrap_or_default();
            let lines = before.matches('\n').count() as u64;
            Place::Character(lines + 1, line.chars().count() as u64 + 1)
        });
        ReadError::new(self.file, place, message)
    }

    /// The keys, in the order of the text.
    pub(super) fn keys(&self) -> impl Iterator<Item = &str> {
        self.all.iter().map(|setting| setting.key.as_str())
    }
}

/// A mapping or sequence of YAML that is open at a line.
struct Block<'t> {
    indent: usize,
    part: Part<'t>,
}

enum Part<'t> {
    Key(&'t str),
    /// Number of items so far, less one.
    Item(usize),
}

/// The key of a value in the open blocks.
fn path(open: &[Block<'_>], key: Option<&str>) -> String {
    let parts = open.iter().map(|block| match block.part {
        Part::Key(key) => key.trim().to_owned(),
        Part::Item(count) => count.to_string(),
    });
    let key = key.map(|key| key.trim().to_owned());
    parts.chain(key).collect::<Vec<_>>().join(".")
}

/// Words of a line of G-code; a text in quotes is part of its word.
fn words(line: &str) -> impl Iterator<Item = &str> {
    let mut is_quoted = false;
    line.split(move |letter: char| {
        is_quoted ^= letter == '"';
        letter.is_whitespace() && !is_quoted
    })
    .filter(|word| !word.is_empty())
}

/// A text with some of its parts replaced, whose places do not overlap.
pub(super) fn replaced(text: &str, parts: &[(Range<usize>, String)]) -> String {
    let mut parts: Vec<_> = parts.iter().collect();
    parts.sort_by_key(|(at, _)| at.start);
    let (mut result, mut done) = (String::with_capacity(text.len()), 0);
    for (at, new) in parts {
        result.push_str(&text[done..at.start]);
        result.push_str(new);
        done = at.end;
    }
    result.push_str(&text[done..]);
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_places_in_every_syntax() {
        let gcode = "M669 K6 ; A9\nm669 A1.5:-2 B3\nM569 P40.0 S1\nM950 C\"a b\"\n";
        let sections = "[printer]\nkinematics = winch # no\n[stepper_a]\nanchor_x: 4\n";
        let yaml = "a:\n  b: 1 # no\n  c: {d: [2, 3], e: x}\npoints:\n- frame: [4, 5]\n  platform:\n    - 6\n    - 7\n-\n  frame: [8]\nlast: 9\n";
        let read = [
            Settings::of_gcode("f", gcode),
            Settings::of_sections("f", sections),
            Settings::of_yaml("f", yaml),
        ];
        let keys: Vec<Vec<&str>> = read.iter().map(|one| one.keys().collect()).collect();
        let of_gcode = [
            "M669 K.0", "M669 A.0", "M669 A.1", "M669 B.0", "M569 P.0", "M569 S.0", "M950 C.0",
        ];
        assert_eq!(keys[0], of_gcode);
        assert_eq!(keys[1], ["printer.kinematics", "stepper_a.anchor_x"]);
        let of_yaml = [
            "a.b",
            "a.c.d.0",
            "a.c.d.1",
            "a.c.e",
            "points.0.frame.0",
            "points.0.frame.1",
            "points.0.platform.0",
            "points.0.platform.1",
            "points.1.frame.0",
            "last",
        ];
        assert_eq!(keys[2], of_yaml);
        assert_eq!(read[0].number("M669 A.1").unwrap(), Some(-2.0));
        assert_eq!(read[1].text("printer.kinematics"), Some("winch"));
        assert_eq!(read[2].number("points.0.platform.1").unwrap(), Some(7.0));
        let error = read[2].number("a.c.e").unwrap_err().to_string();
        assert_eq!(
            error,
            "f, line 3, column 21: a.c.e: found \"x\", expected a number"
        );
        let place = read[0].place("M669 A.0").unwrap();
        let text = replaced(gcode, &[(place, "7".into())]);
        assert_eq!(text, gcode.replace("1.5", "7"));
    }
}
