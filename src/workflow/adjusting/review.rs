//! Review of the values by the operator before they are written.

use tautline_core::effect::EffectSetting;
use tautline_link::ParameterInfo;
use tautline_link::adjusting::{Difference, plan_adjustment};
use tautline_session::Session;

use super::{Doubt, recorded_differences, unsupported, unsupported_effects, values_to_write};
use crate::identification::Identification;

/// The values of a controller beside the identified ones, and the effects that it cannot hold.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Review {
    /// A line for each parameter of model and controller.
    pub lines: Vec<Difference>,
    /// Effects of the model for which the controller has no parameters.
    pub effects: Vec<EffectSetting>,
    /// Doubt about the pose accuracy without these effects, if they displace the platform.
    pub unsupported: Option<Doubt>,
}

impl Review {
    /// The review of a connected controller.
    #[must_use]
    pub fn of(parameters: &[ParameterInfo], fit: &Identification) -> Self {
        let lines = plan_adjustment(parameters, &fit.model, Some(&fit.solution));
        let effects = unsupported_effects(&fit.model, &lines);
        Self {
            effects: effects.into_iter().cloned().collect(),
            unsupported: unsupported(&fit.model, &lines),
            lines,
        }
    }

    /// The review of the values that a session recorded, which may be fewer than the controller has.
    #[must_use]
    pub fn recorded(session: &Session, fit: &Identification) -> Self {
        Self {
            lines: recorded_differences(session, fit),
            ..Self::default()
        }
    }

    /// The lines that would be written.
    pub fn changes(&self) -> impl Iterator<Item = &Difference> {
        self.lines.iter().filter(|line| line.is_writable_change())
    }

    /// The values that would be written.
    #[must_use]
    pub fn values_to_write(&self) -> Vec<(String, f64)> {
        values_to_write(self.lines.clone())
    }
}
