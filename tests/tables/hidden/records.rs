//! Recorded outcomes, which let an interrupted study resume.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::sync::Mutex;

use anyhow::{Context, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{Found, Outcome, Plan};

/// A data set that gets another answer, before and after.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The plan of the data set.
    pub plan: Plan,
    /// Result for each hidden effect.
    pub found: [Vec<Found>; 2],
    /// Findings without their probabilities.
    pub said: [String; 2],
}

/// A file of outcomes, one plan and its outcome per line. By default there is no file.
#[derive(Debug)]
pub struct Records<P = Plan, O = Outcome> {
    /// Recorded outcomes by plan; `None` if the robot has no reading for the effect.
    known: BTreeMap<P, Option<O>>,
    file: Option<Mutex<File>>,
}

impl<P, O> Default for Records<P, O> {
    fn default() -> Self {
        Self {
            known: BTreeMap::new(),
            file: None,
        }
    }
}

impl<P: Ord + Serialize + DeserializeOwned, O: Serialize + DeserializeOwned> Records<P, O> {
    /// Reads a file if it exists, and opens it for appending. An incomplete last line is ignored.
    ///
    /// # Errors
    /// If the file cannot be read or written.
    pub fn open(path: &Path) -> Result<Self> {
        let mut known = BTreeMap::new();
        if path.exists() {
            let file = BufReader::new(File::open(path)?);
            for line in file.lines() {
                if let Ok((plan, outcome)) = serde_json::from_str(&line?) {
                    known.insert(plan, outcome);
                }
            }
        }
        let file = OpenOptions::new().create(true).append(true).open(path);
        let mut file = file.with_context(|| path.display().to_string())?;
        writeln!(file)?;
        Ok(Self {
            known,
            file: Some(Mutex::new(file)),
        })
    }

    /// The recorded outcome of a plan.
    #[must_use]
    pub fn of(&self, plan: &P) -> Option<&Option<O>> {
        self.known.get(plan)
    }

    /// Appends an outcome to the file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&self, plan: &P, outcome: Option<&O>) -> Result<()> {
        let Some(file) = &self.file else {
            return Ok(());
        };
        let line = serde_json::to_string(&(plan, outcome))?;
        if let Ok(mut file) = file.lock() {
            writeln!(file, "{line}")?;
        }
        Ok(())
    }
}

impl Records {
    /// All recorded outcomes.
    pub fn outcomes(&self) -> impl Iterator<Item = &Outcome> {
        self.known.values().flatten()
    }

    /// The data sets of both files that get another answer, as they read before and after, and the number of data sets
    /// that both have.
    #[must_use]
    pub fn changes(&self, after: &Self) -> (Vec<Change>, usize) {
        let known = self.known.iter().filter_map(|(plan, outcome)| {
            let now = after.known.get(plan)?.as_ref()?;
            Some((plan, outcome.as_ref()?, now))
        });
        let both: Vec<(&Plan, &Outcome, &Outcome)> = known.collect();
        let changed = both.iter().filter_map(|(plan, before, now)| {
            let change = Change {
                plan: **plan,
                found: [before.found.clone(), now.found.clone()],
                said: [before.answer(), now.answer()],
            };
            let is_same = change.found[0] == change.found[1] && change.said[0] == change.said[1];
            (!is_same).then_some(change)
        });
        (changed.collect(), both.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::hidden::{Circumstances, Stratum, Wanted, draw, run};

    #[test]
    fn recorded_outcomes_are_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("outcomes.jsonl");
        let plan = Plan {
            robot: "planar",
            seed: 1,
            wanted: Wanted::One("winch_scale", Stratum::Typical),
            circumstances: Circumstances::HeavyTails,
        };
        let outcome = run(&plan, draw(&plan).unwrap().unwrap()).unwrap();
        let records: Records = Records::open(&path).unwrap();
        assert!(records.of(&plan).is_none());
        records.add(&plan, Some(&outcome)).unwrap();

        let again: Records = Records::open(&path).unwrap();
        let known = again.of(&plan).unwrap().as_ref().unwrap();
        assert_eq!(known.drawn, outcome.drawn);
        assert_eq!(known.said, outcome.said);
        assert_eq!(known.parameters, outcome.parameters);
        assert_eq!(again.changes(&again), (Vec::new(), 1));

        let other: Records = Records::open(&folder.path().join("other.jsonl")).unwrap();
        let silent = Outcome {
            found: vec![Found::Missed],
            said: Vec::new(),
            ..outcome
        };
        other.add(&plan, Some(&silent)).unwrap();
        let other: Records = Records::open(&folder.path().join("other.jsonl")).unwrap();
        let (changes, both) = again.changes(&other);
        assert_eq!((changes.len(), both), (1, 1));
        assert_eq!(changes[0].found[1], [Found::Missed]);
        assert!(changes[0].said[0].contains("winch_scale") && changes[0].said[1].is_empty());
    }
}
