//! Causes in words.

use tautline_core::diagnosis::{Cause, Subject, UnmodelledError};
use tautline_core::effect::{Scope, Search};

use super::Diagnosed;
use crate::wording::{count, list, readings};

impl Diagnosed {
    /// Title of what a finding or an alternative takes to be present.
    #[must_use]
    pub fn subject(&self, subject: &Subject) -> String {
        match subject {
            Subject::Cause(cause) => self.title(cause),
            Subject::UnmodelledError(error) => self.error(error),
        }
    }

    /// Title of an error: `Unexplained error in the length readings of cable-3`.
    fn error(&self, error: &UnmodelledError) -> String {
        let cable = self.cable(error.readings.cable);
        let of = readings(error.readings.quantity, cable.as_deref());
        format!("Unexplained error in {of}")
    }

    /// Title and cables of a cause: `Winch scale (cable-3)`.
    #[must_use]
    pub fn title(&self, cause: &Cause) -> String {
        format!("{}{}", cause.effect().title(), self.on(cause))
    }

    /// Cables and pose of a cause in brackets, after a space: ` (cable-3, from pose 17)`.
    fn on(&self, cause: &Cause) -> String {
        let cables = self.cables(cause, &self.targets(cause));
        let words: Vec<_> = cables.into_iter().chain(event(cause)).collect();
        if words.is_empty() {
            return String::new();
        }
        format!(" ({})", words.join(", "))
    }

    /// The cables `targets` of a cause in words; `None` for an effect of the robot or an instrument.
    #[must_use]
    pub fn cables(&self, cause: &Cause, targets: &[String]) -> Option<String> {
        match targets.len() {
            0 if cause.effect().scope() == Scope::CableOrAll => Some("all cables".to_owned()),
            0 => None,
            all if all > 1 && all == self.robot().cable_count() => Some("each cable".to_owned()),
            1..=4 => Some(list(targets)),
            several => Some(count(several, "cable")),
        }
    }
}

/// The pose at which, or from which on, a cause acts.
fn event(cause: &Cause) -> Option<String> {
    let value = |index: usize| cause.instances[0].values[index];
    match cause.effect().search() {
        Search::FromPose(index) => Some(format!("from pose {}", value(index))),
        Search::AtPose(index) => Some(format!("pose {}", value(index))),
        Search::Direct | Search::Wave { .. } | Search::Exchange => None,
    }
}
