//! The open session with what was computed from it.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use tautline_core::diagnosis::Diagnosis;
use tautline_core::measurement::Dataset;
use tautline_session::{LogEntry, Phase, ResultRecord, Session};

use super::clock;
use super::edit::{Edit, History};
use super::fit::Fit;

/// A diagnosis with what it is about.
#[derive(Debug)]
pub struct Diagnosed {
    /// Robot and measurements, excluded poses left out.
    pub dataset: Arc<Dataset>,
    /// What was found.
    pub diagnosis: Diagnosis,
    /// Probability of a false alarm that was asked for.
    pub alpha: f64,
    /// Time that it took (s).
    pub seconds: f64,
}

/// A result with the revision of the inputs it was computed from.
#[derive(Debug, Clone)]
pub struct Computed<T> {
    value: Arc<T>,
    inputs: u64,
}

static NEXT: AtomicU64 = AtomicU64::new(0);

/// The open session.
///
/// It has two counters: `revision` counts every change, `inputs` those that identification and diagnosis depend on.
pub struct Document {
    identity: u64,
    session: Session,
    path: Option<PathBuf>,
    history: History,
    revision: u64,
    inputs: u64,
    saved: Option<u64>,
    fit: Option<Computed<Fit>>,
    diagnosis: Option<Computed<Diagnosed>>,
}

impl Document {
    /// A session; `path` is the file it came from, if it did.
    #[must_use]
    pub fn new(session: Session, path: Option<PathBuf>) -> Self {
        let saved = path.as_ref().map(|_| 0);
        Self {
            identity: NEXT.fetch_add(1, Ordering::Relaxed),
            session,
            path,
            history: History::default(),
            revision: 0,
            inputs: 0,
            saved,
            fit: None,
            diagnosis: None,
        }
    }

    /// A recovered session: its file, if it has one, is older.
    #[must_use]
    pub fn recovered(session: Session, path: Option<PathBuf>) -> Self {
        Self {
            saved: None,
            ..Self::new(session, path)
        }
    }

    /// Tells it from every other document of this run of the program.
    #[must_use]
    pub fn identity(&self) -> u64 {
        self.identity
    }

    /// What is in it.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Its file, once it has one.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Counts every change.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Counts the changes that results depend on.
    #[must_use]
    pub fn inputs(&self) -> u64 {
        self.inputs
    }

    /// Whether there are changes that the file does not have.
    #[must_use]
    pub fn is_unsaved(&self) -> bool {
        self.saved != Some(self.revision)
    }

    /// The file has the state of `revision` now.
    pub fn saved_as(&mut self, path: PathBuf, revision: u64) {
        self.path = Some(path);
        self.saved = Some(revision);
    }

    /// Edits that can be undone and redone.
    #[must_use]
    pub fn history(&self) -> &History {
        &self.history
    }

    /// Does an edit; says whether anything changed.
    pub fn edit(&mut self, edit: Edit) -> bool {
        let changed = self.history.perform(edit, &mut self.session);
        if changed {
            self.touch();
        }
        changed
    }

    /// Undoes the last edit and gives its name.
    pub fn undo(&mut self) -> Option<String> {
        let name = self.history.undo(&mut self.session)?;
        self.touch();
        Some(name)
    }

    /// Does the last undone edit again and gives its name.
    pub fn redo(&mut self) -> Option<String> {
        let name = self.history.redo(&mut self.session)?;
        self.touch();
        Some(name)
    }

    /// Adds what cannot be undone, such as a measurement; results depend on it.
    pub fn append(&mut self, change: impl FnOnce(&mut Session)) {
        change(&mut self.session);
        self.touch();
    }

    /// Adds what cannot be undone and no result depends on, such as what was written to a controller.
    pub fn record(&mut self, change: impl FnOnce(&mut Session)) {
        change(&mut self.session);
        self.revision += 1;
    }

    /// Adds to the session's log.
    pub fn log(&mut self, phase: Phase, text: impl Into<String>) {
        self.session.record(LogEntry {
            time: clock::now(),
            phase,
            text: text.into(),
        });
        self.revision += 1;
    }

    /// Adds a result to the session.
    pub fn add_result(&mut self, result: ResultRecord) {
        self.session.add_result(result);
        self.revision += 1;
    }

    fn touch(&mut self) {
        self.revision += 1;
        self.inputs += 1;
        self.session.modified = self.session.modified.max(clock::now());
    }

    /// Takes an identification that was computed from the inputs of the given count.
    pub fn set_fit(&mut self, fit: Fit, inputs: u64) {
        self.fit = Some(Computed {
            value: Arc::new(fit),
            inputs,
        });
    }

    /// Takes a diagnosis that was computed from the inputs of the given count.
    pub fn set_diagnosis(&mut self, diagnosed: Diagnosed, inputs: u64) {
        self.diagnosis = Some(Computed {
            value: Arc::new(diagnosed),
            inputs,
        });
    }

    /// The last identification, also if it is out of date.
    #[must_use]
    pub fn fit(&self) -> Option<&Arc<Fit>> {
        self.fit.as_ref().map(|computed| &computed.value)
    }

    /// The last diagnosis, also if it is out of date.
    #[must_use]
    pub fn diagnosis(&self) -> Option<&Arc<Diagnosed>> {
        self.diagnosis.as_ref().map(|computed| &computed.value)
    }

    /// Whether the last identification is of the present inputs.
    #[must_use]
    pub fn fit_is_current(&self) -> bool {
        self.fit
            .as_ref()
            .is_some_and(|computed| computed.inputs == self.inputs)
    }

    /// Whether the last diagnosis is of the present inputs.
    #[must_use]
    pub fn diagnosis_is_current(&self) -> bool {
        self.diagnosis
            .as_ref()
            .is_some_and(|computed| computed.inputs == self.inputs)
    }
}
