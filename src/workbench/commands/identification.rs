//! Identification and diagnosis.

use std::collections::BTreeSet;
use std::sync::Arc;

use tautline_core::diagnosis::Diagnosis;
use tautline_core::effect::EffectSetting;
use tautline_core::estimation::Control;
use tautline_core::measurement::Dataset;
use tautline_session::{Method, Phase as LogPhase, ResultRecord, Session, VersionedFile as _};

use crate::model::OpenSession;
use crate::model::command::{
    DIAGNOSING, DiagnosisResult, IDENTIFYING, IdentificationCommand, IdentificationOutcome,
};
use crate::model::discrepancy;
use crate::model::fit_progress::{Before, FitProgress};
use crate::model::open_session::{Diagnosed, Stored};
use crate::model::tasks::TaskHandle;
use crate::screens::identification::Half;
use crate::shell::State;
use tautline_workflow::clock;
use tautline_workflow::diagnosis::{dataset_to_diagnose, diagnose_dataset};
use tautline_workflow::documents::diagnosis::{DiagnosisDocument, stage};
use tautline_workflow::documents::record;
use tautline_workflow::identification::{
    Identification, IdentificationRequest, identify as identify_request, identify_published,
};
use tautline_workflow::wording::{count, ratio};

pub(super) fn perform(state: &mut State, command: IdentificationCommand) {
    match command {
        IdentificationCommand::Identify => {
            state.panels.identification.half = Half::Geometry;
            identify(state, true);
        }
        IdentificationCommand::Diagnose => {
            state.panels.identification.half = Half::Doctor;
            start_diagnosis(state, true);
        }
        IdentificationCommand::Stop => {
            state.panels.identification.live.stop();
            state.model.tasks.cancel(IDENTIFYING);
            state.model.tasks.cancel(DIAGNOSING);
        }
    }
}

fn identify(state: &mut State, keep: bool) {
    let Some(open) = &state.model.open else {
        return;
    };
    if open.session().measurements.is_empty() {
        return;
    }
    state.model.tasks.cancel(IDENTIFYING);
    let (session, inputs) = (open.session().clone(), open.inputs());
    let live = FitProgress::default();
    state.panels.identification.live = live.clone();
    state.model.tasks.start(IDENTIFYING, move |task| {
        let result = identified(&session, &live, task);
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

/// After a session was opened: identifies and diagnoses again what it has results of, so that there is something to look
/// at.
pub(super) fn reopened(state: &mut State) {
    let stored = state.model.open.as_ref().map(OpenSession::stored);
    state.panels.identification = Default::default();
    if stored == Some(Stored::Current) {
        identify(state, false);
    }
    let session = state.model.open.as_ref().map(OpenSession::session);
    if session.is_some_and(has_current_diagnosis) {
        start_diagnosis(state, false);
    }
}

fn has_current_diagnosis(session: &Session) -> bool {
    let mut results = session.results().iter().rev();
    let last = results.find(|record| record.format() == Some(DiagnosisDocument::FORMAT));
    last.is_some_and(|record| record.basis == Some(session.basis()))
}

/// What the operator changes of the problem while looking at its solution.
#[derive(PartialEq)]
pub(super) struct Model {
    effects: Vec<EffectSetting>,
    excluded: BTreeSet<i64>,
}

impl Model {
    pub(super) fn of(state: &State) -> Option<Self> {
        let session = state.model.open.as_ref()?.session();
        Some(Self {
            effects: session.settings.identification.effects.clone(),
            excluded: session.excluded().clone(),
        })
    }
}

/// After an edit: identifies again where effects were added or removed or poses left out, if there are results to compare
/// with.
pub(super) fn follow(state: &mut State, before: Option<&Model>, what: &str) {
    let Some(open) = &state.model.open else {
        return;
    };
    let changed = Model::of(state).as_ref() != before;
    if !changed || open.fit().is_none() && open.diagnosis().is_none() {
        return;
    }
    state.panels.identification.before = open.fit().map(|fit| Before {
        what: what.to_owned(),
        missed: fit.residual_ratio(),
        chi2: fit.solution.chi2,
        degrees_of_freedom: fit.solution.degrees_of_freedom,
    });
    identify(state, true);
}

fn control(task: &TaskHandle) -> Control {
    if task.cancelled() {
        Control::Cancel
    } else {
        Control::Continue
    }
}

fn identified(
    session: &Session,
    live: &FitProgress,
    task: &TaskHandle,
) -> Result<Option<Identification>, String> {
    let request = IdentificationRequest::of_session(session).map_err(|error| error.to_string())?;
    live.begin(&request.dataset);
    let found = identify_request(&request, &mut |progress| {
        let missed = live.step(progress.loss);
        let step = progress.iteration;
        task.tell(
            None,
            format!("step {step}, residuals {} of their noise", ratio(missed)),
        );
        control(task)
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

/// The document that `identify --json` writes, for the session.
fn identification_record(session: &Session, fit: &Identification) -> ResultRecord {
    let document = match &fit.published {
        Some(Ok(published)) => published.document(),
        _ => fit.document(),
    };
    record(session, "Identification", &document, clock::now())
}

fn start_diagnosis(state: &mut State, keep: bool) {
    let Some(open) = &state.model.open else {
        return;
    };
    if open.session().measurements.is_empty() || state.model.tasks.runs(DIAGNOSING) {
        return;
    }
    let (session, inputs) = (open.session().clone(), open.inputs());
    let current = open.fit().filter(|_| open.fit_is_current()).cloned();
    state.model.tasks.start(DIAGNOSING, move |task| {
        let result = diagnosed(&session, current, keep, task);
        IdentificationOutcome::Diagnosed { inputs, result }.into()
    });
}

/// Diagnoses the model as it is, with the effects that were added to it at their identified values.
fn diagnosed(
    session: &Session,
    current: Option<Arc<Identification>>,
    keep: bool,
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
    let Some(diagnosed) = examined(dataset, alpha, task)? else {
        return Ok(None);
    };
    let record = keep.then(|| record(session, "Diagnosis", &diagnosed.document(), clock::now()));
    let figures = discrepancy::figures(&diagnosed);
    Ok(Some(Box::new(DiagnosisResult {
        diagnosed,
        record,
        figures,
    })))
}

fn examined(dataset: Dataset, alpha: f64, task: &TaskHandle) -> Result<Option<Diagnosed>, String> {
    let found = diagnose_dataset(Arc::new(dataset), alpha, &mut |progress| {
        let words = stage(progress.stage);
        let text = match progress.findings {
            0 => words.to_owned(),
            some => format!("{} so far, {words}", count(some, "finding")),
        };
        task.tell(None, text);
        control(task)
    });
    let diagnosed = found.map_err(|error| error.to_string())?;
    let Diagnosis {
        cancelled,
        findings,
        ..
    } = &diagnosed.diagnosis;
    // Without its last tests a diagnosis that found nothing yet looks like one that found nothing.
    let is_inconclusive = *cancelled && findings.is_empty();
    Ok((!is_inconclusive).then_some(diagnosed))
}

pub(super) fn receive(state: &mut State, outcome: IdentificationOutcome) {
    let (inputs, what) = match &outcome {
        IdentificationOutcome::Identified { inputs, .. } => (*inputs, "Identification"),
        IdentificationOutcome::Diagnosed { inputs, .. } => (*inputs, "Diagnosis"),
    };
    let Some(open) = &mut state.model.open else {
        return;
    };
    if !open.knows(inputs) {
        return;
    }
    let stopped = state.panels.identification.live.is_stopped();
    let said = match outcome {
        IdentificationOutcome::Identified {
            record,
            result: Ok(Some(fit)),
            ..
        } if !stopped => Ok(take_fit(open, inputs, *fit, record)),
        IdentificationOutcome::Diagnosed {
            result: Ok(Some(examined)),
            ..
        } => {
            state.panels.identification.examined(examined.figures);
            Ok(take_diagnosis(
                open,
                inputs,
                examined.diagnosed,
                examined.record,
            ))
        }
        IdentificationOutcome::Identified { result: Ok(_), .. }
        | IdentificationOutcome::Diagnosed {
            result: Ok(None), ..
        } => {
            // One that was overtaken by a newer one needs no word.
            let overtaken = open.inputs() != inputs || state.model.tasks.runs(IDENTIFYING);
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
        Ok(text) => state.model.messages.info(text),
        Err(text) => state.model.messages.error(text),
    }
}

fn take_fit(
    open: &mut OpenSession,
    inputs: u64,
    fit: Identification,
    record: Option<Box<ResultRecord>>,
) -> String {
    let text = format!(
        "Identified from {}.",
        count(fit.dataset.measurements.len(), "pose")
    );
    open.set_fit(fit, inputs);
    if let Some(record) = record {
        open.add_result(*record);
        open.log(LogPhase::Identification, text.as_str());
    }
    text
}

fn take_diagnosis(
    open: &mut OpenSession,
    inputs: u64,
    diagnosed: Diagnosed,
    record: Option<ResultRecord>,
) -> String {
    let found = count(diagnosed.diagnosis.findings.len(), "finding");
    open.set_diagnosis(diagnosed, inputs);
    if let Some(record) = record {
        open.add_result(record);
        open.log(LogPhase::Diagnosis, format!("Diagnosed: {found}."));
    }
    format!("Diagnosis finished with {found}.")
}
