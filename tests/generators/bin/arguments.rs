//! What follows the name of the program.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::str::FromStr;

use anyhow::{Context, Result, bail, ensure};
use serde::Serialize;
use serde::de::DeserializeOwned;
use tautline_validation::tables::study::{self, Records, Study};

/// Where the outcomes of studies are kept, so that they go on where they were interrupted.
const FOLDER: &str = "target/studies";
/// Options with a value.
const OPTIONS: [&str; 5] = ["--records", "--robot", "--effect", "--seed", "--cases"];
/// The option without one.
const FAILURES: &str = "--failures";

/// Words in order, and options.
#[derive(Debug, Default)]
pub struct Arguments {
    words: Vec<String>,
    options: BTreeMap<String, String>,
}

impl Arguments {
    /// Sorts arguments.
    ///
    /// # Errors
    /// If there is no such option, or it has no value.
    pub fn new(mut all: impl Iterator<Item = String>) -> Result<Self> {
        let mut sorted = Self::default();
        while let Some(argument) = all.next() {
            let value = match argument.as_str() {
                FAILURES => Some(String::new()),
                option if OPTIONS.contains(&option) => all.next(),
                option if option.starts_with('-') => bail!("no option {option}"),
                _ => {
                    sorted.words.push(argument);
                    continue;
                }
            };
            let value = value.with_context(|| format!("{argument} what?"))?;
            sorted.options.insert(argument, value);
        }
        let is_hidden = sorted.word(0) == Some("hidden");
        let mut options = sorted.options.keys();
        ensure!(
            is_hidden || options.all(|option| option == "--records"),
            "only `hidden` has options beside --records"
        );
        Ok(sorted)
    }

    pub fn word(&self, place: usize) -> Option<&str> {
        self.words.get(place).map(String::as_str)
    }

    pub fn words_from(&self, place: usize) -> &[String] {
        self.words.get(place..).unwrap_or_default()
    }

    /// The number at a place, or a default.
    ///
    /// # Errors
    /// If it is no number.
    pub fn number<N: FromStr>(&self, place: usize, default: N) -> Result<N> {
        self.word(place).map_or(Ok(default), parsed)
    }

    /// So many seeds from a first one on: the two words after the command, or defaults.
    ///
    /// # Errors
    /// If they are no numbers.
    pub fn seeds(&self, count: u64, first: u64) -> Result<Range<u64>> {
        let first = self.number(2, first)?;
        Ok(first..first + self.number(1, count)?)
    }

    pub fn option(&self, name: &str) -> Option<&str> {
        self.options.get(name).map(String::as_str)
    }

    /// The value of an option.
    ///
    /// # Errors
    /// If it cannot be parsed.
    pub fn value<V: FromStr>(&self, name: &str) -> Result<Option<V>> {
        self.option(name).map(parsed).transpose()
    }

    pub fn lists_failures(&self) -> bool {
        self.options.contains_key(FAILURES)
    }

    /// The records of a study: the file that is asked for, or those that this build of the program has made.
    ///
    /// # Errors
    /// If they cannot be read or written.
    pub fn records<C, O>(&self, name: &str) -> Result<Records<C, O>>
    where
        C: Ord + Serialize + DeserializeOwned,
        O: Serialize + DeserializeOwned,
    {
        match self.option("--records") {
            Some(file) => Records::open(Path::new(file)),
            None => Records::of_this_build(Path::new(FOLDER), name),
        }
    }

    /// The table of a study.
    ///
    /// # Errors
    /// If a case fails.
    pub fn table<S: Study>(&self, name: &str, study: &S) -> Result<String> {
        study::table(study, &self.records(name)?)
    }
}

fn parsed<N: FromStr>(text: &str) -> Result<N> {
    let number = text.parse().ok();
    number.with_context(|| format!("{text} is no number"))
}
