//! Unmodelled errors that remain beside the causes or explain the readings better than them.

use nalgebra::DMatrix;

use super::conditions::joined;
use super::fit::Fit;
use super::gain::Prediction;
use super::inference::Inference;
use super::reading_id::ReadingId;
use super::report::{Cause, Discrepancy, Evidence, Finding, Quantity, Verdict};
use super::structure::{Structure, Structures};
use super::variables::Variables;
use crate::effect::unknown::{FIRST, FUNCTIONS, READING, SCALE};
use crate::effect::{BiasedReading, BoundEffect, UNKNOWN};
use crate::estimation::Linearisation;
use crate::robot::Robot;

/// Maximum number of unmodelled errors that are reported.
const MOST: usize = 3;
/// Log posterior odds from which an unmodelled error is reported.
const SAID: f64 = 5.0;
/// Log odds of a rival below which it is ignored.
const NO_RIVAL: f64 = -6.0;
/// Log odds that an unmodelled error exists beside a cause below which the cause is more probable.
const DOUBTED: f64 = 3.0;
/// A cause with no more parameters than an unmodelled error is preferred if it explains at least `NEARLY_ALL` of what
/// the error explains. From the share `ALL` on, the error has no advantage at all.
const NEARLY_ALL: f64 = 0.9;
const ALL: f64 = 0.98;
/// If the log odds of the error exceed `OPEN` all the same, the question is left open with the log odds `OPEN_ODDS`.
const OPEN: f64 = 6.0;
const OPEN_ODDS: f64 = 2.2;

/// An error of some readings that no effect of the catalogue explains.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Nameless {
    pub id: ReadingId,
    /// Its wording in a sentence, after "have an error that".
    form: String,
    /// Log posterior odds.
    pub log_odds: f64,
}

/// Unmodelled errors beside and in place of the causes of a fit.
#[derive(Debug, Clone, Default)]
pub(super) struct Remainder {
    /// Errors beside the causes, the most significant first.
    pub left: Vec<Nameless>,
    /// For each cause the error that could replace it, with its log odds over the cause.
    pub rivals: Vec<Option<Nameless>>,
}

impl Remainder {
    pub fn new(inference: &Inference<'_>) -> Self {
        let fit = &inference.fit;
        let linear = &inference.linear;
        let robot = &fit.problem.dataset.robot;
        let linearisation = Linearisation::new(&fit.problem, &fit.solution);
        let variables = Variables::new(&fit.problem, &fit.solution, &linearisation);
        let structures = Structures::new(linear, &linearisation, &variables);
        let mut left: Vec<Structure> = Vec::new();
        let mut columns = inference.columns.clone();
        while left.len() < MOST {
            let Some(found) = structures.beside(&columns, SAID) else {
                break;
            };
            columns = joined(&[&columns, &found.columns]);
            left.push(found);
        }
        let mut rivals = vec![None; fit.causes.len()];
        for set in contested(&fit.causes) {
            let Some(rival) = rival(inference, &structures, &left, &set) else {
                continue;
            };
            for index in set {
                let known: &mut Option<Nameless> = &mut rivals[index];
                if known.as_ref().is_none_or(|k| rival.log_odds > k.log_odds) {
                    *known = Some(rival.clone());
                }
            }
        }
        // A second error in the same readings is often the rest of the first one, whose period falls between two that
        // are tried.
        let mut said: Vec<Nameless> = Vec::new();
        for structure in &left {
            if said.iter().all(|known| known.id != structure.id) {
                said.push(Nameless::of_structure(structure, robot));
            }
        }
        Self { left: said, rivals }
    }
}

/// Sets of causes that one unmodelled error could replace: each cause alone, and all causes on the same cables.
fn contested(causes: &[Cause]) -> Vec<Vec<usize>> {
    let mut sets: Vec<Vec<usize>> = (0..causes.len()).map(|k| vec![k]).collect();
    for (index, cause) in causes.iter().enumerate() {
        let same = |k: &usize| causes[*k].cables() == cause.cables();
        let all: Vec<usize> = (0..causes.len()).filter(same).collect();
        if all.len() > 1 && all[0] == index {
            sets.push(all);
        }
    }
    sets
}

/// The most probable unmodelled error in place of some causes, with its log odds over them.
fn rival(
    inference: &Inference<'_>,
    structures: &Structures<'_>,
    left: &[Structure],
    set: &[usize],
) -> Option<Nameless> {
    let linear = &inference.linear;
    let causes = &inference.fit.causes;
    let cables: Vec<usize> = set.iter().flat_map(|k| causes[*k].cables()).collect();
    let is_asked =
        |id: &ReadingId| cables.is_empty() || id.cable.is_none_or(|cable| cables.contains(&cable));
    let beside = |columns: &DMatrix<f64>, is_meant: &dyn Fn(&ReadingId) -> bool| {
        let meant = left.iter().filter(|s| is_meant(&s.id));
        meant.fold(columns.clone(), |all, s| joined(&[&all, &s.columns]))
    };
    let elsewhere = |id: &ReadingId| !is_asked(id);
    let others = beside(&inference.columns_without(set), &elsewhere);
    // The background of these readings is removed, since it would compete with the error.
    let mut amplitude = inference.at.amplitude.clone();
    for (amplitude, shape) in amplitude.iter_mut().zip(&linear.shapes) {
        if is_asked(&linear.conditions.classes[shape.class]) {
            *amplitude = 0;
        }
    }
    let found = structures.instead(&others, &amplitude, is_asked)?;
    // The causes may leave an unmodelled error or a background in the same readings.
    let named = beside(&inference.columns, &elsewhere);
    let whole = beside(&named, &is_asked);
    let price: f64 = left
        .iter()
        .filter(|s| is_asked(&s.id))
        .map(|s| s.log_prior)
        .sum();
    let values = [
        linear.with_amplitudes(&amplitude, &named).0,
        linear.with_amplitudes(&inference.at.amplitude, &named).0,
        linear.with_amplitudes(&amplitude, &whole).0 + price,
    ];
    let own = values.into_iter().fold(f64::NEG_INFINITY, f64::max) + inference.log_prior(set);
    let log_odds = found.log_odds - own;
    // Chi-squares are compared with the noise estimated for the unmodelled error.
    let with_rival = joined(&[&others, &found.columns]);
    let noise = linear.with_amplitudes(&amplitude, &with_rival).1;
    let left = |columns: &DMatrix<f64>| linear.base(&noise, columns).chi2;
    let none = left(&others);
    let share = (none - left(&named)) / (none - left(&with_rival)).max(f64::MIN_POSITIVE);
    let has_no_more = inference.parameters_of(set) <= found.columns.ncols();
    // A cause with no more parameters keeps what it explains. If the rival explains clearly more and is far more
    // probable, both are listed.
    let log_odds = match has_no_more && share >= NEARLY_ALL {
        true if share < ALL && log_odds > OPEN => OPEN_ODDS,
        true => return None,
        false => log_odds,
    };
    if log_odds <= NO_RIVAL {
        return None;
    }
    // What an unmodelled error has in common with the causes, its constant above all, is no evidence against them. Part
    // of the error must also remain beside them.
    let log_odds = if set.len() > 1 {
        log_odds
    } else {
        let more = structures.instead(&named, &amplitude, is_asked)?;
        log_odds.min(more.log_odds - values[0].max(values[1]) - DOUBTED)
    };
    (log_odds > NO_RIVAL).then(|| Nameless {
        log_odds,
        ..Nameless::of_structure(&found, &inference.fit.problem.dataset.robot)
    })
}

impl Nameless {
    fn of_structure(structure: &Structure, robot: &Robot) -> Self {
        Self {
            id: structure.id,
            form: structure.form.words(robot),
            log_odds: structure.log_odds,
        }
    }

    /// Excess scatter of some readings without a recognisable pattern.
    pub fn of(id: ReadingId) -> Self {
        Self {
            id,
            form: "has no clear pattern".to_owned(),
            log_odds: 0.0,
        }
    }

    /// An error found by a test of the residuals.
    pub fn of_discrepancy(discrepancy: &Discrepancy) -> Self {
        Self {
            id: ReadingId {
                quantity: discrepancy.quantity,
                cable: discrepancy.cable,
                component: None,
            },
            form: format!("depends on the {}", discrepancy.variable.name()),
            log_odds: -discrepancy.p_value.max(f64::MIN_POSITIVE).ln(),
        }
    }

    /// Posterior probability.
    pub fn probability(&self) -> f64 {
        1.0 / (1.0 + (-self.log_odds).exp())
    }

    /// The cause that represents the error in reports.
    pub fn cause(&self, cables: usize) -> Cause {
        let reading = match self.id.quantity {
            Quantity::Length => Some(BiasedReading::Length),
            Quantity::Tension => Some(BiasedReading::Tension),
            Quantity::Swivel => Some(BiasedReading::Swivel),
            Quantity::Laser => Some(BiasedReading::Laser),
            Quantity::Inclination => {
                Some(BiasedReading::Inclination(self.id.component.unwrap_or(0)))
            }
            Quantity::TrackerPosition | Quantity::TrackerOrientation => None,
        };
        let number = BiasedReading::ALL.iter().position(|r| Some(*r) == reading);
        let mut values = vec![0.0; FIRST + FUNCTIONS];
        values[READING] = number.unwrap_or(BiasedReading::ALL.len()) as f64;
        values[SCALE] = 1.0;
        let cable = self.id.cable;
        Cause {
            instances: vec![BoundEffect {
                effect: &UNKNOWN,
                cables: cable.map_or_else(|| (0..cables).collect(), |cable| vec![cable]),
                targeted: cable.is_some(),
                values,
            }],
        }
    }

    /// The finding that reports the error.
    pub fn finding(&self, fit: &Fit<'_>) -> Finding {
        let robot = &fit.problem.dataset.robot;
        let name = self.id.quantity.name();
        let what = match self.id.cable {
            Some(cable) => format!("{name} readings of {}", robot.cables[cable].name),
            None => format!("{name} readings"),
        };
        let prediction = Prediction::new(fit);
        Finding {
            verdict: Verdict::Unknown,
            cause: self.cause(robot.cable_count()),
            probability: self.probability(),
            sentence: format!("The {what} have an error that {}; no known cause explains it.", self.form),
            advice: "Look at the plot of this error; measure poses between those where it is large and small.".to_owned(),
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
