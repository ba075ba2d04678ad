//! Identification and diagnosis.

use std::collections::BTreeSet;
use std::sync::Arc;

use tautline_core::diagnosis::Diagnosis;
use tautline_core::effect::EffectSetting;
use tautline_core::measurement::Dataset;
use tautline_session::{Method, Phase as LogPhase, ResultRecord, Session, VersionedFile as _};

use crate::model::command::{
    DIAGNOSING, DiagnosisResult, FORMULAS, IDENTIFYING, IdentificationCommand,
    IdentificationOutcome, READINESS, Readiness,
};
use crate::model::edit::Edit;
use crate::model::fit_progress::{FitProgress, PendingEffects, PreviousFit};
use crate::model::messages::Cause;
use crate::model::open_session::{Diagnosed, StoredFit};
use crate::model::tasks::TaskHandle;
use crate::model::{Model, OpenSession, UiRequest};
use tautline_workflow::clock;
use tautline_workflow::diagnosis::{DiagnosisDocument, stage};
use tautline_workflow::diagnosis::{dataset_to_diagnose, diagnose_dataset};
use tautline_workflow::formulas::find_formulas;
use tautline_workflow::identification::{
    Identification, IdentificationRequest, identify as identify_request, identify_published,
};
use tautline_workflow::isolability::IsolabilityTable;
use tautline_workflow::readiness::check;
use tautline_workflow::results::record;
use tautline_workflow::wording::{count, poses_used, ratio};

pub(super) fn perform(model: &mut Model, command: IdentificationCommand) {
    match command {
        IdentificationCommand::Check => check_readings(model),
        IdentificationCommand::Identify => {
            model.request(UiRequest::ShowGeometry);
            model.identification.before = None;
            identify(model, true);
        }
        IdentificationCommand::Diagnose => {
            model.request(UiRequest::ShowDoctor);
            start_diagnosis(model, true);
        }
        IdentificationCommand::FindFormulas => find_patterns(model),
        IdentificationCommand::Stop => {
            model.tasks.cancel(FORMULAS);
            model.identification.progress.stop();
            model.tasks.cancel(IDENTIFYING);
            model.tasks.cancel(DIAGNOSING);
        }
    }
}

fn check_readings(model: &mut Model) {
    let Some(open) = model.measured().filter(|_| !model.tasks.runs(READINESS)) else {
        return;
    };
    let (dataset, inputs) = (open.session().dataset(), open.inputs());
    model.tasks.start(READINESS, move |_| {
        let found = check(&dataset, None, true);
        let readiness = Box::new(Readiness {
            faults: found.isolability.as_ref().map(IsolabilityTable::of),
            checks: found.checks,
        });
        IdentificationOutcome::Checked { inputs, readiness }.into()
    });
}

fn identify(model: &mut Model, keep: bool) {
    let Some(open) = model.measured() else {
        return;
    };
    let (session, inputs) = (open.session().clone(), open.inputs());
    model.tasks.cancel(IDENTIFYING);
    let progress = FitProgress::default();
    model.identification.progress = progress.clone();
    model.tasks.start(IDENTIFYING, move |task| {
        let result = identified(&session, &progress, task);
        let record = match &result {
            Ok(Some(fit)) if keep => Some(Box::new(identification_record(&session, fit))),
            _ => None,
        };
        let result = result.map(|fit| fit.map(Box::new));
        IdentificationOutcome::Identified {
            inputs,
            record,
            result,
        }
        .into()
    });
}

/// Repeats identification and diagnosis of a session that has stored results, after it was opened.
pub(super) fn reopened(model: &mut Model) {
    let stored = model.open.as_ref().map(OpenSession::stored);
    model.identification = Default::default();
    model.request(UiRequest::ShowGeometry);
    if stored == Some(StoredFit::Current) {
        identify(model, false);
    }
    let session = model.open.as_ref().map(OpenSession::session);
    if session.is_some_and(has_current_diagnosis) {
        start_diagnosis(model, false);
    }
}

fn has_current_diagnosis(session: &Session) -> bool {
    let mut results = session.results().iter().rev();
    let last = results.find(|record| record.format() == Some(DiagnosisDocument::FORMAT));
    last.is_some_and(|record| record.basis == Some(session.basis()))
}

/// Choices that change the identification, for comparison before and after an edit.
#[derive(PartialEq)]
pub(super) struct FitChoices {
    effects: Vec<EffectSetting>,
    /// Texts of the hypotheses, which change the meaning of the fit.
    hypotheses: Vec<String>,
    excluded: BTreeSet<i64>,
}

impl FitChoices {
    pub(super) fn of(model: &Model) -> Option<Self> {
        let session = model.open.as_ref()?.session();
        Some(Self {
            effects: session.settings.identification.effects.clone(),
            hypotheses: session.robot.hypotheses.clone(),
            excluded: session.excluded().clone(),
        })
    }
}

/// Identifies again after an edit that changed effects or excluded poses, if there are results to compare with.
pub(super) fn follow(
    model: &mut Model,
    before: Option<&FitChoices>,
    what: &str,
    adds: Option<Vec<EffectSetting>>,
) {
    let Some(open) = &model.open else {
        return;
    };
    let changed = FitChoices::of(model).as_ref() != before;
    if !changed || open.fit().is_none() && open.diagnosis().is_none() {
        return;
    }
    model.identification.not_added = None;
    model.identification.adding = adds.map(|effects| PendingEffects {
        effects,
        inputs: open.inputs(),
        place: open.history().place(),
    });
    model.identification.before = open.fit().map(|fit| PreviousFit {
        what: what.to_owned(),
        missed: fit.residual_ratio(),
        chi2: fit.solution.chi2,
        degrees_of_freedom: fit.solution.degrees_of_freedom,
    });
    identify(model, true);
}

fn identified(
    session: &Session,
    shown: &FitProgress,
    task: &TaskHandle,
) -> Result<Option<Identification>, String> {
    let request = IdentificationRequest::of_session(session).map_err(|error| error.to_string())?;
    shown.begin(&request.dataset);
    let found = identify_request(&request, &mut |progress| {
        let missed = shown.step(progress.loss);
        let step = progress.iteration;
        task.tell(
            None,
            format!("step {step}, residuals {} of their noise", ratio(missed)),
        );
        task.control()
    });
    let mut found = found.map_err(|error| error.to_string())?;
    if task.cancelled() {
        return Ok(None);
    }
    if session.settings.identification.method == Method::Published {
        task.tell(None, "the published method, for comparison");
        let published = identify_published(&found.dataset);
        found.published = Some(published.map_err(|error| error.to_string()));
    }
    Ok(Some(found))
}

/// Document of `identify --json`, for the session.
fn identification_record(session: &Session, fit: &Identification) -> ResultRecord {
    let document = match &fit.published {
        Some(Ok(published)) => published.document(),
        _ => fit.document(),
    };
    record(session, "Identification", &document, clock::now())
}

fn start_diagnosis(model: &mut Model, keep: bool) {
    let Some(open) = model.measured().filter(|_| !model.tasks.runs(DIAGNOSING)) else {
        return;
    };
    let (session, inputs) = (open.session().clone(), open.inputs());
    let current = open.current_fit().cloned();
    let limit_s = model.diagnosis_limit_s();
    model.tasks.start(DIAGNOSING, move |task| {
        let result = diagnosed(&session, current, keep, limit_s, task);
        IdentificationOutcome::Diagnosed { inputs, result }.into()
    });
}

/// Diagnoses the present model; its added effects are estimated again, starting from their identified values.
fn diagnosed(
    session: &Session,
    current: Option<Arc<Identification>>,
    keep: bool,
    limit_s: f64,
    task: &TaskHandle,
) -> Result<Option<Box<DiagnosisResult>>, String> {
    let mut dataset = session.dataset();
    if !session.settings.identification.effects.is_empty() {
        let fitted = match current {
            Some(fit) => fit,
            None => match identified(session, &FitProgress::default(), task)? {
                Some(fit) => Arc::new(fit),
                None => return Ok(None),
            },
        };
        dataset = dataset_to_diagnose(session, &fitted);
    }
    let alpha = session.settings.diagnosis.alpha;
    let Some(diagnosed) = examined(dataset, (alpha, limit_s), task)? else {
        return Ok(None);
    };
    let record = keep.then(|| record(session, "Diagnosis", &diagnosed.document(), clock::now()));
    Ok(Some(Box::new(DiagnosisResult {
        result: diagnosed.into(),
        effects: session.settings.identification.effects.clone(),
        record,
    })))
}

/// Looks for patterns in the residuals left unexplained by the last diagnosis.
fn find_patterns(model: &mut Model) {
    let Some(open) = &model.open else {
        return;
    };
    let Some(diagnosed) = open.diagnosis().filter(|_| !model.tasks.runs(FORMULAS)) else {
        return;
    };
    let (diagnosed, inputs) = (Arc::clone(diagnosed), open.inputs());
    model.tasks.start(FORMULAS, move |task| {
        let found = find_formulas(&diagnosed, &mut |_| task.control());
        let result = match found {
            _ if task.cancelled() => Ok(None),
            Ok(found) => Ok(Some(
                found.map(|found| found.patterns()).unwrap_or_default(),
            )),
            Err(error) => Err(format!("Patterns cannot be tried: {error}.")),
        };
        IdentificationOutcome::Formulas { inputs, result }.into()
    });
}

fn examined(
    dataset: Dataset,
    terms: (f64, f64),
    task: &TaskHandle,
) -> Result<Option<Diagnosed>, String> {
    let found = diagnose_dataset(Arc::new(dataset), terms, &mut |progress| {
        let words = stage(progress.stage);
        let text = match progress.findings {
            0 => words.to_owned(),
            some => format!("{} so far, {words}", count(some, "finding")),
        };
        task.tell(None, text);
        task.control()
    });
    let diagnosed = found.map_err(|error| error.to_string())?;
    let Diagnosis {
        cancelled,
        findings,
        ..
    } = &diagnosed.diagnosis;
    // A diagnosis cancelled before its last tests must not look like one without findings. One that ended at its time
    // limit states that itself.
    let by_operator = *cancelled && !diagnosed.ended_at_limit;
    let is_inconclusive = by_operator && findings.is_empty();
    Ok((!is_inconclusive).then_some(diagnosed))
}

pub(super) fn receive(model: &mut Model, outcome: IdentificationOutcome) {
    let (inputs, what) = match &outcome {
        IdentificationOutcome::Checked { inputs, .. } => (*inputs, "The check"),
        IdentificationOutcome::Identified { inputs, .. } => (*inputs, "Identification"),
        IdentificationOutcome::Diagnosed { inputs, .. } => (*inputs, "Diagnosis"),
        IdentificationOutcome::Formulas { inputs, .. } => (*inputs, "The search for patterns"),
    };
    let Some(open) = &model.open else {
        return;
    };
    if !open.knows(inputs) {
        return;
    }
    let stopped = model.identification.progress.is_stopped();
    if let IdentificationOutcome::Identified { result, .. } = &outcome
        && let Some(adding) = model
            .identification
            .adding
            .take_if(|one| one.inputs == inputs)
        && let Some(reason) = failure(result)
    {
        return take_back(model, adding, reason);
    }
    let Some(open) = &mut model.open else {
        return;
    };
    let said = match outcome {
        IdentificationOutcome::Checked { readiness, .. } => {
            model.identification.readiness = Some((inputs, *readiness));
            return;
        }
        IdentificationOutcome::Formulas { result, .. } => {
            let result = result.transpose();
            model.identification.patterns = result.map(|result| (inputs, result));
            return;
        }
        IdentificationOutcome::Identified {
            record,
            result: Ok(Some(fit)),
            ..
        } if !stopped => Ok(take_fit(open, inputs, *fit, record)),
        IdentificationOutcome::Diagnosed {
            result: Ok(Some(examined)),
            ..
        } => {
            model.identification.before = None;
            model.identification.not_added = None;
            Ok(take_diagnosis(open, inputs, *examined))
        }
        IdentificationOutcome::Identified { result: Ok(_), .. }
        | IdentificationOutcome::Diagnosed {
            result: Ok(None), ..
        } => {
            // A failure of a superseded identification is not reported.
            let overtaken = open.inputs() != inputs || model.tasks.runs(IDENTIFYING);
            if overtaken {
                return;
            }
            Ok(format!("{what} was stopped; nothing has changed."))
        }
        IdentificationOutcome::Identified {
            result: Err(error), ..
        }
        | IdentificationOutcome::Diagnosed {
            result: Err(error), ..
        } => Err(format!("{what} is not possible: {error}.")),
    };
    match said {
        Ok(text) => {
            model.messages.resolve(Cause::Estimation);
            model.messages.info(text);
        }
        Err(text) => model.messages.failure(Cause::Estimation, text),
    }
}

/// Reason why an identification is not usable, if any.
fn failure(result: &Result<Option<Box<Identification>>, String>) -> Option<String> {
    match result {
        Err(reason) => Some(reason.clone()),
        Ok(Some(fit)) if !fit.solution.converged() => {
            Some("the identification does not converge with it".to_owned())
        }
        Ok(_) => None,
    }
}

/// Removes effects with which the identification failed.
fn take_back(model: &mut Model, adding: PendingEffects, reason: String) {
    let Some(open) = &mut model.open else {
        return;
    };
    if open.history().place() == adding.place {
        open.undo();
    } else {
        let what = "take out what cannot be identified".to_owned();
        open.edit(Edit::RemoveEffects(adding.effects.clone(), what));
    }
    model.identification.before = None;
    let text = format!("Nothing was added to the model, because {reason}.");
    model.messages.error(text);
    model.identification.not_added = Some((adding.effects, reason));
}

fn take_fit(
    open: &mut OpenSession,
    inputs: u64,
    fit: Identification,
    record: Option<Box<ResultRecord>>,
) -> String {
    let session = open.session();
    let measured = session
        .measurements
        .len()
        .saturating_sub(session.excluded().len());
    let poses = poses_used(&fit.dataset.measurements, measured);
    let text = format!("Identified from {poses}.");
    open.set_fit(fit, inputs);
    if let Some(record) = record {
        open.add_result(*record);
        open.log(LogPhase::Identification, text.as_str());
    }
    text
}

fn take_diagnosis(open: &mut OpenSession, inputs: u64, examined: DiagnosisResult) -> String {
    let findings = examined.result.diagnosed.diagnosis.findings.len();
    let (is_clean, found) = (findings == 0, count(findings, "finding"));
    let is_gross = !examined.result.diagnosed.gross().is_empty();
    open.set_diagnosis(examined.result, inputs, examined.effects);
    if let Some(record) = examined.record {
        open.add_result(record);
        open.log(LogPhase::Diagnosis, format!("Diagnosed: {found}."));
    }
    match is_clean {
        true if is_gross => {
            "Diagnosis finished: no faulty part, but see the findings on the readings or the drawing.".to_owned()
        }
        true => "Diagnosis finished: nothing was found.".to_owned(),
        false => format!("Diagnosis finished with {found}."),
    }
}
