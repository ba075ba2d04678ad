//! What the causes leave: structure without a name on some readings.

use super::background::Group;
use super::fit::Fit;
use super::gain::Prediction;
use super::inference::Inference;
use super::reading_id::ReadingId;
use super::report::{Cause, Discrepancy, Evidence, Finding, Quantity, Verdict};
use crate::effect::unknown::{FIRST, FUNCTIONS, READING, SCALE};
use crate::effect::{BiasedReading, BoundEffect, UNKNOWN};

/// Readings with structure, and the logarithm of the posterior odds for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Structure {
    pub id: ReadingId,
    pub group: Group,
    pub log_evidence: f64,
}

/// Most readings of which it is said.
const MOST: usize = 3;
/// Logarithm of the posterior odds from which structure is said, its prior odds included.
const SAID: f64 = 4.0;
/// Logarithm of the evidence, in the noise that there is, from which it is compared with none.
const COMPARED: f64 = 4.0;

/// The readings with structure given the causes, the clearest first.
pub(super) fn structures(inference: &Inference<'_>) -> Vec<Structure> {
    let linear = &inference.linear;
    let columns = &inference.columns;
    let mut amplitude = vec![0; linear.shapes.len()];
    let (mut value, mut at) = linear.with_amplitudes(&amplitude, columns);
    let mut found: Vec<Structure> = Vec::new();
    while found.len() < MOST {
        let best = {
            let base = linear.base(&inference.at.with(&amplitude), columns);
            let of = |shape: usize| {
                let evidence = linear.amplitude_evidence(&base, &at, shape);
                let places = (0..evidence.len()).map(|k| (evidence[k], shape, k));
                places.max_by(|a, b| a.0.total_cmp(&b.0))
            };
            let open = (0..amplitude.len()).filter(|shape| amplitude[*shape] == 0);
            open.filter_map(of).max_by(|a, b| a.0.total_cmp(&b.0))
        };
        let Some((_, shape, place)) = best.filter(|best| best.0 > COMPARED) else {
            break;
        };
        amplitude[shape] = place;
        let (with, there) = linear.with_amplitudes(&amplitude, columns);
        if with - value < SAID {
            break;
        }
        found.push(Structure {
            id: linear.conditions.classes[linear.shapes[shape].class],
            group: linear.shapes[shape].group,
            log_evidence: with - value,
        });
        (value, at) = (with, there);
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

    /// Structure that a test of the residuals found.
    pub fn of_discrepancy(discrepancy: &Discrepancy) -> Self {
        let id = ReadingId {
            quantity: discrepancy.quantity,
            cable: discrepancy.cable,
            component: None,
        };
        Self {
            log_evidence: -discrepancy.p_value.max(f64::MIN_POSITIVE).ln(),
            ..Self::of(id)
        }
    }

    /// Its posterior probability.
    pub fn probability(&self) -> f64 {
        1.0 / (1.0 + (-self.log_evidence).exp())
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
