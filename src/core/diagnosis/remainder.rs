//! What the causes leave, and what could explain the readings in their place: errors without a name.

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

/// Most errors without a name that are reported.
const MOST: usize = 3;
/// Logarithm of the posterior odds from which one is.
const SAID: f64 = 5.0;
/// Logarithm of the odds of a rival up to which it does not matter.
const NO_RIVAL: f64 = -6.0;
/// Logarithm of the odds that an error without a name is there beside a cause, up to which the cause is likelier.
const DOUBTED: f64 = 3.0;
/// Shares of what an error without a name explains from which a cause with no more parameters is preferred, and from which
/// the error has nothing over it.
const NEARLY_ALL: f64 = 0.9;
const ALL: f64 = 0.98;
/// Logarithm of the odds from which such an error is possible all the same, and those that are said of it.
const OPEN: f64 = 6.0;
const OPEN_ODDS: f64 = 2.2;

/// An error without a name.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Nameless {
    pub id: ReadingId,
    /// How it looks, after "have an error that".
    form: String,
    /// Logarithm of its posterior odds.
    pub log_odds: f64,
}

/// What causes leave, and what else could explain the readings.
#[derive(Debug, Clone, Default)]
pub(super) struct Remainder {
    /// The clearest first.
    pub left: Vec<Nameless>,
    /// For each cause what could explain the readings in its place, with the logarithm of its odds over the cause.
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
        // What the first leaves of one error, a period between two that are tried, is no second one.
        let mut said: Vec<Nameless> = Vec::new();
        for structure in &left {
            if said.iter().all(|known| known.id != structure.id) {
                said.push(Nameless::of_structure(structure, robot));
            }
        }
        Self { left: said, rivals }
    }
}

/// The sets of causes for which one error without a name could stand: each, and all of the same cables.
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

/// The likeliest error without a name in the place of some causes, with the logarithm of its odds over them.
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
    // Where an error without a name is looked for there is no background, which would stand for it.
    let mut amplitude = inference.at.amplitude.clone();
    for (amplitude, shape) in amplitude.iter_mut().zip(&linear.shapes) {
        if is_asked(&linear.conditions.classes[shape.class]) {
            *amplitude = 0;
        }
    }
    let found = structures.instead(&others, &amplitude, is_asked)?;
    // The causes may leave an error without a name on the same readings, or a background.
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
    // What both explain is compared in the noise that the error without a name leaves.
    let with_rival = joined(&[&others, &found.columns]);
    let noise = linear.with_amplitudes(&amplitude, &with_rival).1;
    let left = |columns: &DMatrix<f64>| linear.base(&noise, columns).chi2;
    let none = left(&others);
    let share = (none - left(&named)) / (none - left(&with_rival)).max(f64::MIN_POSITIVE);
    let has_no_more = inference.parameters_of(set) <= found.columns.ncols();
    // What a cause explains with no more parameters is not taken from it. If its rival explains more, and is far likelier,
    // which of both it is stays open.
    let log_odds = match has_no_more && share >= NEARLY_ALL {
        true if share < ALL && log_odds > OPEN => OPEN_ODDS,
        true => return None,
        false => log_odds,
    };
    if log_odds <= NO_RIVAL {
        return None;
    }
    // What an error without a name has in common with the causes, its constant above all, is no reason to doubt them: of
    // its form something must be left beside them, too.
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

    /// Scatter of readings that is not noise alone.
    pub fn of(id: ReadingId) -> Self {
        Self {
            id,
            form: "has no clear pattern".to_owned(),
            log_odds: 0.0,
        }
    }

    /// What a test of the residuals found.
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

    /// Its posterior probability.
    pub fn probability(&self) -> f64 {
        1.0 / (1.0 + (-self.log_odds).exp())
    }

    /// The cause that stands for it.
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

    /// What is said of it.
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
