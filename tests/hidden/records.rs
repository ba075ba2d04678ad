//! Recorded outcomes, which let an interrupted study resume.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::sync::Mutex;

use anyhow::{Context, Result};

use super::{Outcome, Plan};

/// Recorded outcomes by plan; `None` if the robot has no reading for the effect.
type Known = BTreeMap<Plan, Option<Outcome>>;

/// A file of outcomes, one plan and its outcome per line. By default there is no file.
#[derive(Debug, Default)]
pub struct Records {
    known: Known,
    file: Option<Mutex<File>>,
}

impl Records {
    /// Reads a file if it exists, and opens it for appending. An incomplete last line is ignored.
    ///
    /// # Errors
    /// If the file cannot be read or written.
    pub fn open(path: &Path) -> Result<Self> {
        let mut known = Known::new();
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
    pub fn of(&self, plan: &Plan) -> Option<&Option<Outcome>> {
        self.known.get(plan)
    }

    /// Appends an outcome to the file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&self, plan: &Plan, outcome: Option<&Outcome>) -> Result<()> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hidden::{Circumstances, Stratum, Wanted, draw, run};

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
        let records = Records::open(&path).unwrap();
        assert!(records.of(&plan).is_none());
        records.add(&plan, Some(&outcome)).unwrap();

        let again = Records::open(&path).unwrap();
        let known = again.of(&plan).unwrap().as_ref().unwrap();
        assert_eq!(known.drawn, outcome.drawn);
        assert_eq!(known.said, outcome.said);
        assert_eq!(known.parameters, outcome.parameters);
    }
}
