//! Identification and diagnosis.

use std::sync::Arc;
use std::time::Instant;

use tautline_core::diagnosis::{DiagnosisOptions, Stage, diagnose};
use tautline_core::estimation::{Control, Method};
use tautline_core::measurement::Dataset;
use tautline_session::Phase;

use crate::app::Document;
use crate::app::command::Outcome;
use crate::app::document::Diagnosed;
use crate::app::fit::{Fit, FitOrder, fit};
use crate::app::state::State;
use crate::app::tasks::TaskHandle;

/// Title of the task that identifies.
pub const IDENTIFYING: &str = "Identifying";
/// Title of the task that looks for what the model lacks.
pub const DIAGNOSING: &str = "Looking for what the model lacks";

/// Computes with the measured poses.
#[derive(Debug, Clone)]
pub enum ModelCommand {
    /// Identifies the geometry.
    Identify,
    /// Asks what the model gets wrong.
    Diagnose,
}

/// What it came to; `inputs` counts the inputs it was computed from.
#[derive(Debug)]
pub enum ModelOutcome {
    /// Of an identification.
    Identified {
        /// Count of the inputs.
        inputs: u64,
        /// The fit, or one sentence.
        result: Result<Box<Fit>, String>,
    },
    /// Of a diagnosis.
    Diagnosed {
        /// Count of the inputs.
        inputs: u64,
        /// The diagnosis, or one sentence.
        result: Result<Box<Diagnosed>, String>,
    },
}

pub(super) fn perform(state: &mut State, command: ModelCommand) {
    let Some(document) = &state.document else {
        return;
    };
    let inputs = document.inputs();
    match command {
        ModelCommand::Identify => {
            let order = order(document);
            state
                .tasks
                .start(IDENTIFYING, move |task| identified(order, inputs, task));
        }
        ModelCommand::Diagnose => {
            let dataset = Arc::new(document.session().dataset());
            let alpha = document.session().settings.diagnosis.alpha;
            state.tasks.start(DIAGNOSING, move |task| {
                diagnosed(dataset, alpha, inputs, task)
            });
        }
    }
}

fn order(document: &Document) -> FitOrder {
    FitOrder {
        dataset: Arc::new(document.session().dataset()),
        method: method(document),
        effects: Vec::new(),
    }
}

/// The method that the operator chose.
pub(super) fn method(document: &Document) -> Method {
    match document.session().settings.identification.method {
        tautline_session::Method::Simple => Method::Simple,
        _ => Method::Joint,
    }
}

fn control(task: &TaskHandle) -> Control {
    if task.cancelled() {
        Control::Cancel
    } else {
        Control::Continue
    }
}

fn identified(order: FitOrder, inputs: u64, task: &TaskHandle) -> Outcome {
    let result = fit(order, &mut |progress| {
        task.tell(
            None,
            format!(
                "step {}, chi-square {:.1}",
                progress.iteration, progress.loss
            ),
        );
        control(task)
    });
    let result = result.map(Box::new).map_err(|error| error.to_string());
    ModelOutcome::Identified { inputs, result }.into()
}

fn diagnosed(dataset: Arc<Dataset>, alpha: f64, inputs: u64, task: &TaskHandle) -> Outcome {
    let options = DiagnosisOptions {
        alpha,
        ..DiagnosisOptions::default()
    };
    let started = Instant::now();
    let found = diagnose(&dataset, &options, &mut |progress| {
        task.tell(None, stage(progress.stage));
        control(task)
    });
    let seconds = started.elapsed().as_secs_f64();
    let result = match found {
        Ok(diagnosis) => Ok(Box::new(Diagnosed {
            dataset,
            diagnosis,
            alpha,
            seconds,
        })),
        Err(error) => Err(error.to_string()),
    };
    ModelOutcome::Diagnosed { inputs, result }.into()
}

fn stage(stage: Stage) -> &'static str {
    match stage {
        Stage::BaseFit => "fitting the model as it is",
        Stage::Discrepancy => "asking where the model is wrong",
        Stage::Scores => "asking every effect on every cable",
        Stage::Refits => "fitting the most likely causes completely",
        Stage::HeldOut => "predicting poses that were held out",
        Stage::Separation => "looking for poses that would tell causes apart",
    }
}

pub(super) fn receive(state: &mut State, outcome: ModelOutcome) {
    let Some(document) = &mut state.document else {
        return;
    };
    match outcome {
        ModelOutcome::Identified {
            inputs,
            result: Ok(fit),
        } => {
            let poses = fit.dataset.measurements.len();
            document.set_fit(*fit, inputs);
            document.log(
                Phase::Identification,
                format!("Identified from {poses} poses."),
            );
            state
                .messages
                .info(format!("Identified from {poses} poses."));
        }
        ModelOutcome::Diagnosed {
            inputs,
            result: Ok(diagnosed),
        } => {
            let found = diagnosed.diagnosis.findings.len();
            document.set_diagnosis(*diagnosed, inputs);
            document.log(Phase::Diagnosis, format!("Diagnosed: {found} findings."));
            state
                .messages
                .info(format!("Diagnosis finished with {found} findings."));
        }
        ModelOutcome::Identified {
            result: Err(error), ..
        } => {
            state
                .messages
                .error(format!("Identification is not possible: {error}."));
        }
        ModelOutcome::Diagnosed {
            result: Err(error), ..
        } => {
            state
                .messages
                .error(format!("Diagnosis is not possible: {error}."));
        }
    }
}
