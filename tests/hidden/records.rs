//! Outcomes on record: a long study goes on where it was interrupted.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::sync::Mutex;

use anyhow::{Context, Result};

use super::{Outcome, Plan};

/// Outcomes by plan; of `None` the robot has no reading.
type Known = BTreeMap<Plan, Option<Outcome>>;

/// Outcomes in a file, a plan and its outcome to a line. By default nothing is on record and nothing is put there.
#[derive(Debug, Default)]
pub struct Records {
    known: Known,
    file: Option<Mutex<File>>,
}

impl Records {
    /// Reads a file, if there is one, and writes what is added to it. A last line that is not complete is left out.
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

    /// The outcome of a plan, if it is on record.
    #[must_use]
    pub fn of(&self, plan: &Plan) -> Option<&Option<Outcome>> {
        self.known.get(plan)
    }

    /// Puts an outcome on record.
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
    fn what_was_on_record_is_there_again() {
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
