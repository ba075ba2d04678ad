//! The hypotheses that a robot knows.

use super::super::{Effect, find};
use super::{Hypothesis, effect_of};
use crate::robot::Robot;

/// Most hypotheses of a robot.
pub const MAX_HYPOTHESES: usize = 100;

/// Reasons why a robot does not accept a hypothesis.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum HypothesisNotAdded {
    /// The robot carries a hypothesis with the same identifier and another text.
    #[error(
        "found the hypothesis \"{0}\" with another text than the robot carries, expected one text for each id"
    )]
    OtherText(String),
    /// The robot carries the largest number of hypotheses.
    #[error("found more than {MAX_HYPOTHESES} hypotheses, expected at most so many")]
    TooMany,
}

impl Robot {
    /// The effects of the hypotheses that the robot carries.
    pub fn hypothesis_effects(&self) -> impl Iterator<Item = &'static Effect> {
        self.hypotheses.iter().filter_map(|text| effect_of(text))
    }

    /// The effect with this identifier: of the catalogue, or a hypothesis that the robot carries.
    #[must_use]
    pub fn effect(&self, id: &str) -> Option<&'static Effect> {
        find(id).or_else(|| self.hypothesis_effects().find(|effect| effect.id() == id))
    }

    /// Makes a hypothesis known to the robot; one that it carries already is not repeated.
    ///
    /// # Errors
    /// If the robot carries another one with the same identifier, or too many.
    pub fn add_hypothesis(&mut self, hypothesis: &Hypothesis) -> Result<(), HypothesisNotAdded> {
        let text = hypothesis.text();
        if self.hypotheses.iter().any(|known| known == text) {
            return Ok(());
        }
        let is_same = |effect: &Effect| effect.id() == hypothesis.id();
        if self.hypothesis_effects().any(is_same) {
            return Err(HypothesisNotAdded::OtherText(hypothesis.id().to_owned()));
        }
        if self.hypotheses.len() == MAX_HYPOTHESES {
            return Err(HypothesisNotAdded::TooMany);
        }
        self.hypotheses.push(text.to_owned());
        Ok(())
    }
}
