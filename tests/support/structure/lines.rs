//! Lines of Rust by crate.

use std::fs;
use std::path::Path;

/// Beginning of the tests of a file, which are the last in it.
const TESTS: &str = "#[cfg(test)]\nmod tests {";

/// Lines of a crate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Lines {
    /// Lines of production code.
    pub production: usize,
    /// Lines of unit tests.
    pub tests: usize,
}

impl Lines {
    /// Lines of the Rust files in a folder and below; files called `tests.rs` and those in `tests` are tests.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub fn of_folder(folder: &Path) -> Result<Self, String> {
        let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
        let mut lines = Self::default();
        for entry in fs::read_dir(folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            let is_test = path.file_stem().is_some_and(|stem| stem == "tests");
            let found = if path.is_dir() {
                if path.file_name().is_some_and(|name| name == "target") {
                    continue;
                }
                Self::of_folder(&path)?
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                Self::of_text(&fs::read_to_string(&path).map_err(failed)?)
            } else {
                continue;
            };
            lines = if is_test {
                lines.plus(Self {
                    production: 0,
                    tests: found.production + found.tests,
                })
            } else {
                lines.plus(found)
            };
        }
        Ok(lines)
    }

    fn of_text(text: &str) -> Self {
        let production = text.find(TESTS).map_or(text, |at| &text[..at]);
        let all = text.lines().count();
        let production = production.lines().count();
        Self {
            production,
            tests: all - production,
        }
    }

    /// Lines of both.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            production: self.production + other.production,
            tests: self.tests + other.tests,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tests_are_counted_apart() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        fs::create_dir(folder.path().join("tests")).unwrap();
        write("a.rs", "fn a() {}\n\n#[cfg(test)]\nmod tests {\n}\n");
        write("tests.rs", "fn b() {}\n");
        write("tests/c.rs", "fn c() {}\n");
        write("notes.md", "three\nmore\nlines\n");
        let expected = Lines {
            production: 2,
            tests: 5,
        };
        assert_eq!(Lines::of_folder(folder.path()), Ok(expected));
    }
}
