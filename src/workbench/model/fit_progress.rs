//! Progress of a running identification: its residuals after each step.

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
    /// Begins with the data to be fitted.
    pub fn begin(&self, dataset: &Dataset) {
        self.course(|course| course.readings = readings(dataset));
    }

    /// Adds the chi-square of a step; returns the root mean square of the normalised residuals, as if every reading
    /// were redundant.
    pub fn step(&self, chi2: f64) -> f64 {
        self.course(|course| {
            let missed = (chi2 / course.readings.max(1) as f64).sqrt();
            course.missed.push(missed);
            missed
        })
    }

    /// Root mean square of the normalised residuals after each step.
    pub fn missed(&self) -> Vec<f64> {
        self.course(|course| course.missed.clone())
    }

    /// Marks the identification as unwanted, even if its result is there by now.
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

/// Fit before a change of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct PreviousFit {
    pub what: String,
    /// Root mean square of the residuals over that of noise alone.
    pub missed: Option<f64>,
    pub chi2: f64,
    pub degrees_of_freedom: f64,
}

/// Added effects whose identification is still running.
#[derive(Debug)]
pub(crate) struct PendingEffects {
    pub(crate) effects: Vec<EffectSetting>,
    pub(crate) inputs: u64,
    /// Number of the edit in the history.
    pub(crate) place: u64,
}

/// State of the identification of the open session.
#[derive(Debug, Default)]
pub struct IdentificationState {
    /// Progress of the running or last identification.
    pub progress: FitProgress,
    /// Fit before the last change of the model.
    pub before: Option<PreviousFit>,
    pub(crate) adding: Option<PendingEffects>,
    /// Effects that were removed again because the identification with them failed, with the reason.
    pub(crate) not_added: Option<(Vec<EffectSetting>, String)>,
    /// Check of the readings, with the number of the inputs.
    pub readiness: Option<(u64, Readiness)>,
    /// Patterns in the unexplained residuals, or an error message, with the number of the inputs.
    pub patterns: Option<(u64, Result<Vec<PatternDocument>, String>)>,
}

/// Number of measured lengths, distances and angles.
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
