//! Review of the values by the operator before they are written.

use tautline_core::effect::EffectSetting;
use tautline_core::estimation::Solution;
use tautline_core::robot::Robot;
use tautline_link::ParameterInfo;
use tautline_link::adjusting::{Difference, plan_adjustment};
use tautline_session::Session;

use super::Doubt;
use super::adaptation::{Adaptation, adapt, set_gains, unsupported_effects};
use super::record::recorded;
use crate::identification::Identification;

/// The values of a controller beside those that it is to hold.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Review {
    /// A line for each parameter of model and controller.
    pub lines: Vec<Difference>,
    /// Effects of the model for which the controller has no parameters.
    pub effects: Vec<EffectSetting>,
    /// How entry points and drums make up for these effects, if they displace the platform.
    pub adaptation: Option<Adaptation>,
}

impl Review {
    /// The review of a controller with these parameters.
    #[must_use]
    pub fn of(controller: &[ParameterInfo], model: &Robot, solution: Option<&Solution>) -> Self {
        let mut lines = plan_adjustment(controller, model, solution);
        if controller.is_empty() {
            return Self {
                lines,
                ..Self::default()
            };
        }
        let effects = unsupported_effects(model, &lines);
        let adaptation = adapt(model, &effects, &mut lines);
        set_gains(model, &effects, &mut lines);
        Self {
            adaptation,
            effects: effects.into_iter().cloned().collect(),
            lines,
        }
    }

    /// The review of the values that a session recorded of its controller.
    #[must_use]
    pub fn recorded(session: &Session, fit: &Identification) -> Self {
        Self::of(&recorded(session), &fit.model, Some(&fit.solution))
    }

    /// The doubt about a pose accuracy that the values do not restore.
    #[must_use]
    pub fn doubt(&self) -> Option<Doubt> {
        self.adaptation.as_ref().and_then(Adaptation::doubt)
    }

    /// The lines that would be written.
    pub fn changes(&self) -> impl Iterator<Item = &Difference> {
        self.lines.iter().filter(|line| line.is_writable_change())
    }

    /// The values that would be written.
    #[must_use]
    pub fn values_to_write(&self) -> Vec<(String, f64)> {
        let changes = self.changes();
        changes
            .filter_map(|line| Some((line.name.clone(), line.identified?)))
            .collect()
    }
}
