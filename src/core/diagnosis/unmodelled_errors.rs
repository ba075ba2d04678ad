//! Unmodelled errors that remain beside the causes or explain the readings better than them.

use nalgebra::DMatrix;

use super::budget::MAX_REPORTED_ERRORS;
use super::calibration::{NEARLY_ALL, NEGLIGIBLE_LOG_ODDS, REPORTED_LOG_ODDS};
use super::conditions::concatenate_columns;
use super::fit::Fit;
use super::gain::Prediction;
use super::heavy_tails::odds_of_heavy_tails;
use super::inference::Inference;
use super::reading_id::ReadingId;
use super::report::{
    Cause, Discrepancy, ErrorForm, Evidence, Finding, Quantity, Subject, UnmodelledError,
};
use super::structured_errors::{ErrorSearch, StructuredError};
use super::variables::Variables;
use crate::effect::words::{degrees, millimetres, newtons};
use crate::robot::Robot;

/// An unmodelled error with its log posterior odds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct WeighedError {
    pub error: UnmodelledError,
    pub log_odds: f64,
}

/// Unmodelled errors beside and in place of the causes of a fit.
#[derive(Debug, Clone, Default)]
pub(super) struct UnmodelledErrors {
    /// Errors beside the causes, the most significant first.
    pub remaining: Vec<WeighedError>,
    /// For each cause the errors that could replace it: the likeliest, with the log odds of all over the cause.
    pub rivals: Vec<Option<WeighedError>>,
}

impl UnmodelledErrors {
    /// Compares errors with the causes of a fit; `None` if `go_on`, which is called before each comparison, returns false.
    pub fn new(inference: &Inference<'_>, go_on: &mut dyn FnMut() -> bool) -> Option<Self> {
        if !go_on() {
            return None;
        }
        let fit = &inference.fit;
        let linear = &inference.linear;
        let linearisation = fit.linearisation();
        let variables = Variables::new(&fit.problem, &fit.solution, &linearisation);
        let search = ErrorSearch::new(linear, &inference.hyper, &linearisation, &variables);
        let mut remaining: Vec<StructuredError> = Vec::new();
        let mut columns = inference.columns.clone();
        while remaining.len() < MAX_REPORTED_ERRORS {
            if !go_on() {
                return None;
            }
            let Some(found) = search.find_beside(&columns, REPORTED_LOG_ODDS) else {
                break;
            };
            columns = concatenate_columns(&[&columns, &found.columns]);
            remaining.push(found);
        }
        let mut rivals = vec![None; fit.causes.len()];
        for set in replaceable_sets(&fit.causes) {
            if !go_on() {
                return None;
            }
            let Some(rival) = best_rival(inference, &search, &remaining, &set) else {
                continue;
            };
            for index in set {
                let present: &mut Option<WeighedError> = &mut rivals[index];
                if present.as_ref().is_none_or(|k| rival.log_odds > k.log_odds) {
                    *present = Some(rival.clone());
                }
            }
        }
        for (index, odds) in odds_of_heavy_tails(inference).into_iter().enumerate() {
            let replaced = rivals[index]
                .as_ref()
                .map_or(0.0, |rival| rival.log_odds.exp());
            if let Some(error) = inference.scatter_like(index).filter(|_| odds > 0.0) {
                let scatter = WeighedError {
                    error,
                    log_odds: odds.ln(),
                };
                let mut rival = rivals[index]
                    .take()
                    .filter(|_| replaced >= odds)
                    .unwrap_or(scatter);
                rival.log_odds = (replaced + odds).ln();
                rivals[index] = Some(rival);
            }
        }
        // A second error in the same readings is often the rest of the first one, whose period falls between two that
        // are tried.
        let mut reported: Vec<WeighedError> = Vec::new();
        for structure in &remaining {
            if reported
                .iter()
                .all(|other| other.error.readings != structure.id)
            {
                reported.push(structure.into());
            }
        }
        Some(Self {
            remaining: reported,
            rivals,
        })
    }
}

/// Sets of causes that one unmodelled error could replace: each cause alone, and all causes on the same cables.
fn replaceable_sets(causes: &[Cause]) -> Vec<Vec<usize>> {
    let mut sets: Vec<Vec<usize>> = (0..causes.len()).map(|k| vec![k]).collect();
    for (index, cause) in causes.iter().enumerate() {
        let same = |k: &usize| causes[*k].cables() == cause.cables();
        let alike: Vec<usize> = (0..causes.len()).filter(same).collect();
        if alike.len() > 1 && alike[0] == index {
            sets.push(alike);
        }
    }
    sets
}

/// The most probable unmodelled error in place of some causes, with its log odds over them.
fn best_rival(
    inference: &Inference<'_>,
    search: &ErrorSearch<'_>,
    remaining: &[StructuredError],
    set: &[usize],
) -> Option<WeighedError> {
    let linear = &inference.linear;
    let causes = &inference.fit.causes;
    let cables: Vec<usize> = set.iter().flat_map(|k| causes[*k].cables()).collect();
    let is_eligible =
        |id: &ReadingId| cables.is_empty() || id.cable.is_none_or(|cable| cables.contains(&cable));
    let beside = |columns: &DMatrix<f64>, is_meant: &dyn Fn(&ReadingId) -> bool| {
        let meant = remaining.iter().filter(|s| is_meant(&s.id));
        meant.fold(columns.clone(), |joined, s| {
            concatenate_columns(&[&joined, &s.columns])
        })
    };
    let elsewhere = |id: &ReadingId| !is_eligible(id);
    let others = beside(&inference.columns_without(set), &elsewhere);
    // The background of these readings is removed, since it would compete with the error.
    let mut amplitude = inference.hyper.amplitude.clone();
    for (amplitude, shape) in amplitude.iter_mut().zip(&linear.shapes) {
        if is_eligible(&linear.conditions.classes[shape.class]) {
            *amplitude = 0;
        }
    }
    let error = search.find_in_place(&others, &amplitude, is_eligible)?;
    // The causes may leave an unmodelled error, of those found beside them or of any form, or a background in the same readings.
    let named = beside(&inference.columns, &elsewhere);
    let whole = beside(&named, &is_eligible);
    let penalty: f64 = remaining
        .iter()
        .filter(|s| is_eligible(&s.id))
        .map(|s| s.log_prior)
        .sum();
    let start = Some(&*inference.hyper.variance);
    let log_density = |amplitude: &[usize], columns: &DMatrix<f64>| {
        linear
            .with_amplitudes(start, (amplitude, inference.hyper.factor), columns)
            .log_density
    };
    let beside_causes = search.find_in_place(&named, &amplitude, is_eligible);
    let values = [
        log_density(&amplitude, &named),
        log_density(&inference.hyper.amplitude, &named),
        log_density(&amplitude, &whole) + penalty,
        beside_causes.map_or(f64::NEG_INFINITY, |error| error.log_odds),
    ];
    let of_causes = values.into_iter().fold(f64::NEG_INFINITY, f64::max) + inference.log_prior(set);
    let log_odds = error.log_odds - of_causes;
    // A cause that explains nearly all that the error explains, with no more parameters, is the simpler description.
    // Chi-squares are compared with the noise estimated for the error.
    let with_rival = concatenate_columns(&[&others, &error.columns]);
    let noise = linear
        .with_amplitudes(start, (&amplitude, inference.hyper.factor), &with_rival)
        .hyper;
    let chi2 = |columns: &DMatrix<f64>| linear.reduced(&noise, columns).chi2;
    let none = chi2(&others);
    let share = (none - chi2(&named)) / (none - chi2(&with_rival)).max(f64::MIN_POSITIVE);
    if inference.parameters_of(set) <= error.columns.ncols() && share >= NEARLY_ALL {
        return None;
    }
    (log_odds > NEGLIGIBLE_LOG_ODDS).then(|| WeighedError {
        log_odds,
        ..WeighedError::from(&error)
    })
}

impl From<&StructuredError> for WeighedError {
    fn from(error: &StructuredError) -> Self {
        Self {
            error: UnmodelledError {
                readings: error.id,
                form: error.form,
                rms: Some(error.rms),
            },
            log_odds: error.log_odds,
        }
    }
}

impl WeighedError {
    /// An error found by a test of the residuals.
    pub fn from_discrepancy(discrepancy: &Discrepancy) -> Self {
        Self {
            error: UnmodelledError {
                readings: ReadingId {
                    quantity: discrepancy.quantity,
                    cable: discrepancy.cable,
                    component: None,
                },
                form: ErrorForm::Smooth(discrepancy.variable),
                rms: None,
            },
            log_odds: -discrepancy.p_value.max(f64::MIN_POSITIVE).ln(),
        }
    }

    /// Posterior probability.
    pub fn probability(&self) -> f64 {
        1.0 / (1.0 + (-self.log_odds).exp())
    }

    /// The finding that reports the error.
    pub fn finding(&self, fit: &Fit<'_>) -> Finding {
        let prediction = Prediction::new(fit);
        Finding {
            subject: Subject::UnmodelledError(self.error.clone()),
            probability: self.probability(),
            sentence: self.error.sentence(&fit.problem.dataset.robot),
            advice: ADVICE.to_owned(),
            alternatives: Vec::new(),
            parameters: Vec::new(),
            evidence: Evidence {
                delta_chi2: 2.0 * self.log_odds,
                parameters: 0,
                p_value: 1.0 - self.probability(),
                questions: 0,
                ranking: Vec::new(),
            },
            gain: prediction.gain_over(&prediction),
            separation: None,
        }
    }
}

/// Advice for an error that no effect explains.
const ADVICE: &str = "Measure more poses between those where this error is large and small.";

/// Names of the components of a reading.
const AXES: [&str; 3] = ["x", "y", "z"];

impl UnmodelledError {
    /// Excess scatter of some readings without a recognisable pattern.
    pub(super) fn scatter(readings: ReadingId) -> Self {
        Self {
            readings,
            form: ErrorForm::Scatter,
            rms: None,
        }
    }

    fn sentence(&self, robot: &Robot) -> String {
        let name = self.readings.quantity.name();
        let what = match self.readings.cable {
            Some(cable) => format!("{name} readings of {}", robot.cables[cable].name),
            None => format!("{name} readings"),
        };
        let along = self
            .readings
            .component
            .and_then(|k| match self.readings.quantity {
                Quantity::TrackerPosition => Some(format!(" along {}", AXES[k])),
                Quantity::TrackerOrientation | Quantity::Inclination => {
                    Some(format!(" about {}", AXES[k]))
                }
                _ => None,
            });
        let in_words = match self.readings.quantity {
            Quantity::Length | Quantity::Laser | Quantity::TrackerPosition | Quantity::Distance => {
                millimetres
            }
            Quantity::Tension => newtons,
            Quantity::Swivel | Quantity::Inclination | Quantity::TrackerOrientation => degrees,
        };
        let rms = self.rms.map(|rms| format!(" of {} (rms)", in_words(rms)));
        format!(
            "The {what}{} have an error{} that {}; no known cause explains it.",
            along.unwrap_or_default(),
            rms.unwrap_or_default(),
            self.form.description(robot)
        )
    }
}
