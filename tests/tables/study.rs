//! Studies: cases that do not depend on each other, run on all processors and kept on record, and tables of their outcomes.

use std::collections::BTreeMap;
use std::fmt::Debug;
use std::fs::{self, File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::sync::Mutex;

use anyhow::{Context, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use tautline_core::threads;

/// Cases, how one is run, and the table of all.
pub trait Study: Sync {
    /// What determines an outcome, mostly a seed.
    type Case: Debug + Ord + Serialize + DeserializeOwned + Send + Sync;
    /// What a case adds to the table.
    type Outcome: Clone + Serialize + DeserializeOwned + Send + Sync;

    /// All cases, in the order of the table.
    ///
    /// # Errors
    /// If they cannot be determined.
    fn cases(&self) -> Result<Vec<Self::Case>>;

    /// Runs a case; `None` if it does not exist, as a fault of a sensor that the robot has not got.
    ///
    /// # Errors
    /// If it cannot be simulated or evaluated.
    fn run(&self, case: &Self::Case) -> Result<Option<Self::Outcome>>;

    /// The table in Markdown.
    ///
    /// # Errors
    /// If a part of it is computed only here, and cannot be.
    fn table(&self, outcomes: &[(Self::Case, Self::Outcome)]) -> Result<String>;
}

/// Records of a study.
type RecordsOf<S> = Records<<S as Study>::Case, <S as Study>::Outcome>;
/// Cases that exist, with their outcomes.
pub type Outcomes<S> = Vec<(<S as Study>::Case, <S as Study>::Outcome)>;
/// All cases, with what became of them.
pub type Results<C, O> = Vec<(C, Result<Option<O>>)>;

/// Runs cases on all processors; those on record come from there.
pub fn results<C, O>(
    cases: Vec<C>,
    records: &Records<C, O>,
    run: impl Fn(&C) -> Result<Option<O>> + Sync,
) -> Results<C, O>
where
    C: Ord + Serialize + DeserializeOwned + Send + Sync,
    O: Clone + Serialize + DeserializeOwned + Send + Sync,
{
    let result = |case: &C| -> Result<Option<O>> {
        if let Some(known) = records.known.get(case) {
            return Ok(known.clone());
        }
        let outcome = run(case)?;
        records.add(case, outcome.as_ref())?;
        Ok(outcome)
    };
    let results = threads::map(cases.len(), threads::available(), |k| result(&cases[k]));
    cases.into_iter().zip(results).collect()
}

/// Runs all cases.
///
/// # Errors
/// That of the first case that fails.
pub fn outcomes<S: Study>(study: &S, records: &RecordsOf<S>) -> Result<Outcomes<S>> {
    let results = results(study.cases()?, records, |case| study.run(case));
    let existing = results
        .into_iter()
        .filter_map(|(case, result)| match result {
            Ok(outcome) => Some(Ok((case, outcome?))),
            Err(error) => Some(Err(error.context(format!("{case:?}")))),
        });
    existing.collect()
}

/// The table of a study.
///
/// # Errors
/// If a case fails.
pub fn table<S: Study>(study: &S, records: &RecordsOf<S>) -> Result<String> {
    study.table(&outcomes(study, records)?)
}

/// A file of outcomes, a case and its outcome per line, so that an interrupted study goes on. By default there is no file.
#[derive(Debug)]
pub struct Records<C, O> {
    /// Recorded outcomes; `None` of cases that do not exist.
    known: BTreeMap<C, Option<O>>,
    file: Option<Mutex<File>>,
}

impl<C, O> Default for Records<C, O> {
    fn default() -> Self {
        Self {
            known: BTreeMap::new(),
            file: None,
        }
    }
}

impl<C: Ord + Serialize + DeserializeOwned, O: Serialize + DeserializeOwned> Records<C, O> {
    /// Reads a file if it exists, and opens it for appending. An incomplete last line is ignored.
    ///
    /// # Errors
    /// If the file cannot be read or written.
    pub fn open(path: &Path) -> Result<Self> {
        let mut known = BTreeMap::new();
        if path.exists() {
            for line in BufReader::new(File::open(path)?).lines() {
                if let Ok((case, outcome)) = serde_json::from_str(&line?) {
                    known.insert(case, outcome);
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

    /// The records of a study in a folder, begun anew if this program was built after them.
    ///
    /// # Errors
    /// If the file cannot be read or written.
    pub fn of_this_build(folder: &Path, study: &str) -> Result<Self> {
        let path = folder.join(format!("{study}.jsonl"));
        fs::create_dir_all(folder)?;
        let built = fs::metadata(std::env::current_exe()?)?.modified()?;
        let recorded = fs::metadata(&path).and_then(|file| file.modified());
        if recorded.is_ok_and(|time| time < built) {
            fs::remove_file(&path)?;
        }
        Self::open(&path)
    }

    /// Recorded outcomes in the order of their cases.
    pub fn outcomes(&self) -> impl Iterator<Item = &O> + Clone {
        self.known.values().flatten()
    }

    /// The recorded outcome of a case that exists.
    #[must_use]
    pub fn of(&self, case: &C) -> Option<&O> {
        self.known.get(case)?.as_ref()
    }

    fn add(&self, case: &C, outcome: Option<&O>) -> Result<()> {
        let line = serde_json::to_string(&(case, outcome))?;
        if let Some(Ok(mut file)) = self.file.as_ref().map(Mutex::lock) {
            writeln!(file, "{line}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    /// Squares of even numbers.
    #[derive(Default)]
    struct Squares {
        runs: AtomicUsize,
    }

    impl Study for Squares {
        type Case = usize;
        type Outcome = usize;

        fn cases(&self) -> Result<Vec<usize>> {
            Ok((0..100).collect())
        }

        fn run(&self, case: &usize) -> Result<Option<usize>> {
            self.runs.fetch_add(1, Ordering::Relaxed);
            Ok(case.is_multiple_of(2).then_some(case * case))
        }

        fn table(&self, outcomes: &[(usize, usize)]) -> Result<String> {
            Ok(format!("{outcomes:?}"))
        }
    }

    #[test]
    fn outcomes_are_in_the_order_of_the_cases_and_an_interrupted_study_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("squares.jsonl");
        let expected: Vec<_> = (0..100).step_by(2).map(|k| (k, k * k)).collect();
        let study = Squares::default();
        let found = outcomes(&study, &Records::open(&path).unwrap()).unwrap();
        assert_eq!((found, study.runs.into_inner()), (expected.clone(), 100));

        let text = fs::read_to_string(&path).unwrap();
        let line = text.lines().find(|line| *line == "[6,36]").unwrap();
        fs::write(&path, text.replace(line, "[6,3")).unwrap();
        let study = Squares::default();
        let found = outcomes(&study, &Records::open(&path).unwrap()).unwrap();
        assert_eq!((found, study.runs.into_inner()), (expected, 1));
    }
}
