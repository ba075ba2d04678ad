//! What the causes leave: structure without a name on some readings.

use super::background::Group;
use super::fit::Fit;
use super::gain::Prediction;
use super::inference::Inference;
use super::reading_id::ReadingId;
use super::report::{Cause, Discrepancy, Evidence, Finding, Quantity, Verdict};
use crate::effect::unknown::{FIRST, FUNCTIONS, READING, SCALE};
use crate::effect::{BiasedReading, BoundEffect, UNKNOWN};

/// Readings with structure, and the logarithm of the evidence for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Structure {
    pub id: ReadingId,
    pub group: Group,
    pub log_evidence: f64,
}

/// Most readings of which it is said.
const MOST: usize = 3;
/// Logarithm of the prior odds against structure on any readings.
const RARE: f64 = 4.0;
/// Logarithm of the posterior odds from which it is said.
const SAID: f64 = 2.944;

/// The readings with structure given the causes, the clearest first.
pub(super) fn structures(inference: &Inference<'_>) -> Vec<Structure> {
    let linear = &inference.linear;
    let classes = &linear.conditions.classes;
    let mut at = inference.at.clone();
    at.amplitude.fill(0);
    let mut found: Vec<Structure> = Vec::new();
    while found.len() < MOST {
        let base = linear.base(&at, &inference.columns);
        let best = |shape: usize| {
            let evidence = linear.amplitude_evidence(&base, &at, shape);
            let (place, value) = (0..evidence.len())
                .map(|k| (k, evidence[k]))
                .max_by(|a, b| a.1.total_cmp(&b.1))
                .unwrap_or((0, 0.0));
            (value, shape, place)
        };
        let open = (0..linear.shapes.len()).filter(|shape| at.amplitude[*shape] == 0);
        let Some((value, shape, place)) = open.map(best).max_by(|a, b| a.0.total_cmp(&b.0)) else {
            break;
        };
        if value < SAID + RARE + (classes.len() as f64).ln() {
            break;
        }
        at.amplitude[shape] = place;
        found.push(Structure {
            id: classes[linear.shapes[shape].class],
            group: linear.shapes[shape].group,
            log_evidence: value,
        });
    }
    found
}

impl Structure {
    /// Structure on readings, of which nothing else is known.
    pub fn of(id: ReadingId) -> Self {
        Self {
            id,
            group: Group::Position,
            log_evidence: 0.0,
        }
    }

    /// Its posterior probability.
    pub fn probability(&self) -> f64 {
        let odds = self.log_evidence - RARE;
        1.0 / (1.0 + (-odds).exp())
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

    /// What is said of it; `left` are the dependences that the model leaves.
    pub fn finding(&self, fit: &Fit<'_>, left: &[Discrepancy]) -> Finding {
        let robot = &fit.problem.dataset.robot;
        let name = self.id.quantity.name();
        let what = match self.id.cable {
            Some(cable) => format!("{name} readings of {}", robot.cables[cable].name),
            None => format!("{name} readings"),
        };
        let own = |d: &&Discrepancy| d.quantity == self.id.quantity && d.cable == self.id.cable;
        let on = left
            .iter()
            .find(own)
            .map_or(self.group.name(), |d| d.variable.name());
        let prediction = Prediction::new(fit);
        Finding {
            verdict: Verdict::Unknown,
            cause: self.cause(robot.cable_count()),
            probability: self.probability(),
            sentence: format!("The {what} have an error that depends on the {on}; no known cause explains it."),
            advice: "Look at the plot of this error; measure poses between those where it is large and small.".to_owned(),
            alternatives: Vec::new(),
            parameters: Vec::new(),
            evidence: Evidence {
                delta_chi2: 2.0 * self.log_evidence,
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
