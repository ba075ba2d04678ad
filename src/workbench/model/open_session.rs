//! The open session with its results.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

use tautline_core::diagnosis::Finding;
use tautline_core::effect::EffectSetting;
use tautline_core::robot::FieldError;
use tautline_link::adjusting::Difference;
use tautline_session::{
    LogEntry, MeasuredPose, Phase as LogPhase, ResultRecord, Session, VersionedFile as _,
};

use super::edit::{Edit, History, InputRevision, same_effect};
use tautline_workflow::adjusting::{Check, checklist};
use tautline_workflow::clock;
pub use tautline_workflow::diagnosis::Diagnosed;
use tautline_workflow::diagnosis::evidence::{Evidence, evidence};
use tautline_workflow::identification::{Identification, IdentificationDocument};
use tautline_workflow::planning::missing_labels;
use tautline_workflow::precalibration::Calibration;
use tautline_workflow::readiness::{CheckItem, check_readings};
use tautline_workflow::wording::sentence;

/// Numbers of inputs, never reused, so that a late result cannot belong to another session. The first number of a
/// session is its id.
static NUMBERS: AtomicU64 = AtomicU64::new(0);

/// Largest number of stored diagnoses, so that undoing an edit brings back the diagnosis of that model.
const KEPT_DIAGNOSES: usize = 8;

/// Diagnosis with its plots.
#[derive(Debug)]
pub struct PlottedDiagnosis {
    pub diagnosed: Arc<Diagnosed>,
    pub evidence: Vec<Option<Evidence>>,
}

impl From<Diagnosed> for PlottedDiagnosis {
    fn from(diagnosed: Diagnosed) -> Self {
        Self {
            evidence: evidence(&diagnosed),
            diagnosed: Arc::new(diagnosed),
        }
    }
}

/// Diagnosis with the inputs and effects of its model.
struct DiagnosisOfModel {
    result: PlottedDiagnosis,
    inputs: u64,
    effects: Vec<EffectSetting>,
}

impl DiagnosisOfModel {
    /// Whether a model has all effects of the diagnosed one and otherwise only effects that the diagnosis proposed.
    fn is_of(&self, effects: &[EffectSetting]) -> bool {
        let has = |all: &[EffectSetting], one: &EffectSetting| {
            all.iter().any(|other| same_effect(one, other))
        };
        let diagnosed = &self.result.diagnosed;
        let findings = diagnosed.diagnosis.findings.iter();
        let proposed: Vec<EffectSetting> = findings
            .flat_map(Finding::causes)
            .flat_map(|cause| diagnosed.settings(cause))
            .collect();
        self.effects.iter().all(|one| has(effects, one))
            && effects
                .iter()
                .all(|one| has(&self.effects, one) || has(&proposed, one))
    }
}

/// State of the last identification stored in the session.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum StoredFit {
    #[default]
    None,
    /// It belongs to the data with which the session was opened.
    Current,
    /// The data have changed since.
    OutOfDate,
}

/// Content of a session, as the numbers of its edits and other changes, so that undoing can restore the saved state.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Content {
    /// Number of the last edit that is not undone.
    edit: u64,
    /// Number of changes that cannot be undone.
    lasting: u64,
}

impl StoredFit {
    fn of(session: &Session) -> Self {
        let of_identification =
            |record: &&ResultRecord| record.format() == Some(IdentificationDocument::FORMAT);
        let Some(last) = session.results().iter().rev().find(of_identification) else {
            return Self::None;
        };
        if last.basis == Some(session.basis()) {
            Self::Current
        } else {
            Self::OutOfDate
        }
    }
}

/// The open session.
///
/// `revision` counts every change; `inputs` numbers the inputs of identification and diagnosis: undoing an edit
/// restores the number.
pub struct OpenSession {
    id: u64,
    session: Session,
    path: Option<PathBuf>,
    history: History,
    revision: u64,
    measured: u64,
    replaced: u64,
    inputs: u64,
    /// Number of changes that cannot be undone.
    lasting: u64,
    saved: Option<Content>,
    stored: StoredFit,
    fit: Option<Arc<Identification>>,
    /// Revision of the inputs of the fit.
    fit_inputs: u64,
    diagnoses: Vec<DiagnosisOfModel>,
    /// Number of the data for each number of inputs; data are the inputs other than the effects of the model.
    data: BTreeMap<u64, u64>,
    calibration: OnceLock<Arc<Calibration>>,
    missing: OnceLock<Vec<i64>>,
    checked: OnceLock<Vec<CheckItem>>,
}

impl OpenSession {
    /// Session with the file it came from, if any.
    #[must_use]
    pub fn new(session: Session, path: Option<PathBuf>) -> Self {
        let saved = path.as_ref().map(|_| Content::default());
        let inputs = NUMBERS.fetch_add(1, Ordering::Relaxed);
        Self {
            id: inputs,
            stored: StoredFit::of(&session),
            session,
            path,
            history: History::default(),
            revision: 0,
            measured: 0,
            replaced: 0,
            inputs,
            lasting: 0,
            saved,
            fit: None,
            fit_inputs: inputs,
            diagnoses: Vec::new(),
            data: [(inputs, inputs)].into(),
            calibration: OnceLock::new(),
            missing: OnceLock::new(),
            checked: OnceLock::new(),
        }
    }

    /// Recovered session; its file, if any, is older.
    #[must_use]
    pub fn recovered(session: Session, path: Option<PathBuf>) -> Self {
        Self {
            saved: None,
            ..Self::new(session, path)
        }
    }

    /// Id, unique in this run of the program.
    #[must_use]
    pub fn id(&self) -> u64 {
        self.id
    }

    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// File of the session, if any.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Number of changes other than measured poses.
    #[must_use]
    pub fn edits(&self) -> u64 {
        self.revision - self.measured
    }

    /// Number of changes of the measurements other than pose by pose.
    #[must_use]
    pub fn replaced(&self) -> u64 {
        self.replaced
    }

    /// Revision of the inputs of results; unique among all open sessions.
    #[must_use]
    pub fn inputs(&self) -> u64 {
        self.inputs
    }

    /// Whether a number of inputs, assigned in ascending order, is not older than this open session.
    #[must_use]
    pub fn knows(&self, inputs: u64) -> bool {
        inputs >= self.id
    }

    /// Whether there are unsaved changes.
    #[must_use]
    pub fn is_unsaved(&self) -> bool {
        self.saved != Some(self.content())
    }

    /// Marks `revision` as saved in a file.
    pub fn saved_as(&mut self, path: PathBuf, revision: u64) {
        self.path = Some(path);
        // Changes made while the file was being written are not in it.
        self.saved = (revision == self.revision).then(|| self.content());
    }

    fn content(&self) -> Content {
        Content {
            edit: self.history.place(),
            lasting: self.lasting,
        }
    }

    /// Edits that can be undone and redone.
    #[must_use]
    pub fn history(&self) -> &History {
        &self.history
    }

    /// Performs an edit; returns whether anything changed.
    pub fn edit(&mut self, edit: Edit) -> bool {
        let is_import = matches!(edit, Edit::Import(..));
        let is_of_model = matches!(edit, Edit::AddEffects(..) | Edit::RemoveEffects(..));
        let data = self.data.get(&self.inputs).copied();
        let told = edit.log_phase().map(|phase| (phase, edit.name()));
        let inputs = self.history.perform(edit, &mut self.session, self.inputs);
        let is_done = inputs.map(|inputs| self.touch(&inputs)).is_some();
        if let Some((phase, name)) = told.filter(|_| is_done) {
            self.record_step(phase, format!("{}.", sentence(&name)));
        }
        if let (true, Some(data)) = (is_of_model, data) {
            self.data.insert(self.inputs, data);
        }
        self.replaced += u64::from(is_import && is_done);
        is_done
    }

    /// Undoes the last edit and returns its name.
    pub fn undo(&mut self) -> Option<String> {
        self.replaced += u64::from(self.history.is_import(false));
        let (name, inputs) = self.history.undo(&mut self.session, self.inputs)?;
        self.touch(&inputs);
        self.record_step(LogPhase::Session, format!("Undone: {name}."));
        Some(name)
    }

    /// Redoes the last undone edit and returns its name.
    pub fn redo(&mut self) -> Option<String> {
        self.replaced += u64::from(self.history.is_import(true));
        let (name, inputs) = self.history.redo(&mut self.session, self.inputs)?;
        self.touch(&inputs);
        self.record_step(LogPhase::Session, format!("Done again: {name}."));
        Some(name)
    }

    /// Appends a measured pose.
    ///
    /// # Errors
    /// If it does not match the session, which then remains unchanged.
    pub fn append_pose(&mut self, pose: &MeasuredPose) -> Result<(), FieldError> {
        self.session.append_pose(pose)?;
        self.measured += 1;
        self.lasting += 1;
        self.history.forget_inputs();
        self.touch(&InputRevision::New);
        Ok(())
    }

    /// Changes measurements other than pose by pose; results depend on them, and it cannot be undone.
    pub fn append(&mut self, change: impl FnOnce(&mut Session)) {
        change(&mut self.session);
        self.replaced += 1;
        self.lasting += 1;
        self.history.forget_inputs();
        self.touch(&InputRevision::New);
    }

    /// Records something on which no result depends, such as an adjustment; it cannot be undone.
    pub fn record(&mut self, change: impl FnOnce(&mut Session)) {
        change(&mut self.session);
        self.revision += 1;
        self.lasting += 1;
    }

    /// Adds poses chosen by a run to the plan; undoing an edit does not remove them.
    pub fn extend_plan<T>(&mut self, change: impl FnOnce(&mut Session) -> T) -> T {
        let before = self.session.plan.clone();
        let result = change(&mut self.session);
        let mut added = self.session.plan.clone();
        added.retain(|planned| !before.contains(planned));
        if !added.is_empty() {
            self.history.keep_planned(&added);
            self.lasting += 1;
            self.touch(&InputRevision::Unchanged);
        }
        result
    }

    /// Adds an entry to the session's log that does not count as a change: after undo, the session equals its file.
    fn record_step(&mut self, phase: LogPhase, text: String) {
        self.session.record(LogEntry {
            time: clock::now(),
            phase,
            text,
        });
    }

    /// Adds an entry to the session's log.
    pub fn log(&mut self, phase: LogPhase, text: impl Into<String>) {
        self.record_step(phase, text.into());
        self.revision += 1;
        self.lasting += 1;
    }

    pub fn add_result(&mut self, result: ResultRecord) {
        self.record(|session| session.add_result(result));
    }

    fn touch(&mut self, inputs: &InputRevision) {
        self.revision += 1;
        match inputs {
            InputRevision::Unchanged => {}
            InputRevision::Restored(number) => self.inputs = *number,
            InputRevision::New => {
                self.inputs = NUMBERS.fetch_add(1, Ordering::Relaxed);
                self.data.insert(self.inputs, self.inputs);
            }
        }
        self.session.modified = self.session.modified.max(clock::now());
        self.missing.take();
        self.checked.take();
        if let Some(calibration) = self.calibration.get()
            && !calibration.is_of(&self.session)
        {
            self.calibration.take();
        }
    }

    /// Results of the tables of phases 1 and 2, computed on first use.
    #[must_use]
    pub fn calibration(&self) -> &Arc<Calibration> {
        self.calibration
            .get_or_init(|| Arc::new(Calibration::of(&self.session)))
    }

    /// Labels of planned poses that are not measured yet, in the order of the plan; recomputed after a change.
    #[must_use]
    pub fn missing(&self) -> &[i64] {
        self.missing
            .get_or_init(|| missing_labels(&self.session).collect())
    }

    /// Quick check of the readings; repeated after a change.
    #[must_use]
    pub fn checked_readings(&self) -> &[CheckItem] {
        self.checked
            .get_or_init(|| check_readings(&self.session.dataset(), None))
    }

    /// Whether poses are chosen one by one from the workspace instead of from a plan.
    #[must_use]
    pub fn decides_on_poses(&self) -> bool {
        let until = &self.session.settings.until;
        until.enabled && !until.only_planned
    }

    /// Checklist of the adjustment.
    #[must_use]
    pub fn checklist(&self, differences: &[Difference]) -> [Check; 5] {
        let is_old = self.fit.is_some() && !self.fit_is_current();
        checklist(&self.session, differences, is_old)
    }

    /// Largest acceptable deviation of a pulley from the drawing (m).
    #[must_use]
    pub fn tolerance_m(&self) -> Option<f64> {
        self.session.settings.tolerance_m
    }

    /// State of the identification that was stored before the session was opened.
    #[must_use]
    pub fn stored(&self) -> StoredFit {
        self.stored
    }

    /// Stores the identification of the inputs of this number.
    pub fn set_fit(&mut self, fit: Identification, inputs: u64) {
        self.stored = StoredFit::None;
        self.fit = Some(Arc::new(fit));
        self.fit_inputs = inputs;
    }

    /// Stores the diagnosis of a model with these effects and the inputs of this number.
    pub fn set_diagnosis(
        &mut self,
        result: PlottedDiagnosis,
        inputs: u64,
        effects: Vec<EffectSetting>,
    ) {
        self.diagnoses.retain(|one| one.inputs != inputs);
        if self.diagnoses.len() == KEPT_DIAGNOSES {
            self.diagnoses.remove(0);
        }
        self.diagnoses.push(DiagnosisOfModel {
            result,
            inputs,
            effects,
        });
    }

    /// Last identification, even if out of date.
    #[must_use]
    pub fn fit(&self) -> Option<&Arc<Identification>> {
        self.fit.as_ref()
    }

    /// The fit, if it is of the present inputs.
    #[must_use]
    pub fn current_fit(&self) -> Option<&Arc<Identification>> {
        self.fit.as_ref().filter(|_| self.fit_is_current())
    }

    /// Diagnosis of the present model; if there is none, the last one, which is out of date.
    #[must_use]
    pub fn diagnosis(&self) -> Option<&Arc<Diagnosed>> {
        self.plotted_diagnosis().map(|found| &found.diagnosed)
    }

    /// Same diagnosis with its plots.
    #[must_use]
    pub fn plotted_diagnosis(&self) -> Option<&PlottedDiagnosis> {
        let current = self.current_diagnosis().or(self.diagnoses.last());
        current.map(|one| &one.result)
    }

    fn current_diagnosis(&self) -> Option<&DiagnosisOfModel> {
        let data = self.data.get(&self.inputs);
        let effects = &self.session.settings.identification.effects;
        let is_current =
            |one: &&DiagnosisOfModel| self.data.get(&one.inputs) == data && one.is_of(effects);
        let mut newest_first = self.diagnoses.iter().rev();
        let same = newest_first.find(|one| one.inputs == self.inputs);
        same.or_else(|| self.diagnoses.iter().rev().find(is_current))
    }

    /// Whether the last identification belongs to the present inputs.
    #[must_use]
    pub fn fit_is_current(&self) -> bool {
        self.fit.is_some() && self.fit_inputs == self.inputs
    }

    /// Whether a diagnosis applies: of the present inputs, or of the same data with only its proposals added since.
    #[must_use]
    pub fn diagnosis_is_current(&self) -> bool {
        self.current_diagnosis().is_some()
    }

    /// Whether there is a diagnosis of exactly the present inputs.
    #[must_use]
    pub fn is_model_diagnosed(&self) -> bool {
        self.diagnoses.iter().any(|one| one.inputs == self.inputs)
    }
}
