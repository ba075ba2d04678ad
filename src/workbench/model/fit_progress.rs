//! A running identification: how its residuals shrink.

use std::sync::{Arc, Mutex, PoisonError};

use tautline_core::effect::EffectSetting;
use tautline_core::measurement::Dataset;

use super::command::Readiness;
use tautline_workflow::formulas::PatternDocument;

/// Residuals after each step, shared with the task.
#[derive(Debug, Clone, Default)]
pub struct FitProgress(Arc<Mutex<Course>>);

#[derive(Debug, Default)]
struct Course {
    readings: usize,
    missed: Vec<f64>,
    stopped: bool,
}

impl FitProgress {
    /// The data that are fitted.
    pub fn begin(&self, dataset: &Dataset) {
        self.course(|course| course.readings = readings(dataset));
    }

    /// Takes the chi-square of a step; gives the root mean square of the residuals over their noise, as if every
    /// reading were redundant.
    pub fn step(&self, chi2: f64) -> f64 {
        self.course(|course| {
            let missed = (chi2 / course.readings.max(1) as f64).sqrt();
            course.missed.push(missed);
            missed
        })
    }

    /// Root mean square of the residuals over their noise after each step.
    pub fn missed(&self) -> Vec<f64> {
        self.course(|course| course.missed.clone())
    }

    /// The operator does not want the result any more, even if it is there by now.
    pub fn stop(&self) {
        self.course(|course| course.stopped = true);
    }

    pub fn is_stopped(&self) -> bool {
        self.course(|course| course.stopped)
    }

    fn course<T>(&self, of: impl FnOnce(&mut Course) -> T) -> T {
        of(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// How well the model fitted before a change.
#[derive(Debug, Clone, PartialEq)]
pub struct Before {
    pub what: String,
    /// By how many times their noise the readings were missed.
    pub missed: Option<f64>,
    pub chi2: f64,
    pub degrees_of_freedom: f64,
}

/// Effects whose identification has not ended yet.
#[derive(Debug)]
pub(crate) struct Adding {
    pub(crate) effects: Vec<EffectSetting>,
    pub(crate) inputs: u64,
    /// Place of the edit in the history.
    pub(crate) place: u64,
}

/// What accompanies the identification of the open session.
#[derive(Debug, Default)]
pub struct IdentificationState {
    /// The identification that runs or ran last.
    pub progress: FitProgress,
    /// The fit before the last change of the model.
    pub before: Option<Before>,
    pub(crate) adding: Option<Adding>,
    /// The effects that were taken out again because the identification with them failed, and why it did.
    pub(crate) not_added: Option<(Vec<EffectSetting>, String)>,
    /// The check before it, with the number of the inputs that were checked.
    pub readiness: Option<(u64, Readiness)>,
    /// Patterns of what is unexplained, or one sentence, with the number of the inputs.
    pub patterns: Option<(u64, Result<Vec<PatternDocument>, String>)>,
}

/// Number of lengths, distances and angles that were read.
fn readings(dataset: &Dataset) -> usize {
    let data = &dataset.measurements;
    let grids = [&data.revolutions, &data.length_m, &data.swivel_rad];
    let in_grids = grids.into_iter().map(|grid| {
        let rows = (0..grid.rows()).flat_map(|row| grid.row(row));
        rows.filter(|v| v.is_finite()).count()
    });
    let lasers = data.laser_m.iter().filter(|v| v.is_finite()).count();
    in_grids.sum::<usize>() + lasers
}
