//! Causes in words.

use tautline_core::diagnosis::{Cause, Subject, UnmodelledError};
use tautline_core::effect::{Scope, Search};
use tautline_core::robot::Robot;

use super::Diagnosed;
use crate::wording::{count, list, readings};

impl Diagnosed {
    /// Title of the subject of a finding or of an alternative.
    #[must_use]
    pub fn subject(&self, subject: &Subject) -> String {
        match subject {
            Subject::Cause(cause) => self.title(cause),
            Subject::UnmodelledError(error) => self.error(error),
            Subject::WrongDrawing(pattern) => self.drawing_title(*pattern),
            Subject::Slack(cable) => {
                let cable = &self.robot().cables[*cable].name;
                format!("Slack cable ({cable})")
            }
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
        cause_title(self.robot(), cause)
    }

    /// The cables `targets` of a cause in words; `None` for an effect of the robot or an instrument.
    #[must_use]
    pub fn cables(&self, cause: &Cause, targets: &[String]) -> Option<String> {
        cables_in_words(self.robot(), cause, targets)
    }
}

/// Title, cables and pose of a cause of a robot: `Cable slip (cable-3, from pose 17)`.
#[must_use]
pub fn cause_title(robot: &Robot, cause: &Cause) -> String {
    let cables = cause.cables().into_iter();
    let targets: Vec<String> = cables
        .map(|index| robot.cables[index].name.clone())
        .collect();
    let (title, cables) = match cause.on_each_cable(robot) {
        Some(texts) => (texts.title, None),
        None => (
            cause.effect().title(),
            cables_in_words(robot, cause, &targets),
        ),
    };
    let words: Vec<_> = cables.into_iter().chain(event(cause)).collect();
    if words.is_empty() {
        return title.to_owned();
    }
    format!("{title} ({})", words.join(", "))
}

fn cables_in_words(robot: &Robot, cause: &Cause, targets: &[String]) -> Option<String> {
    match targets.len() {
        0 if cause.effect().scope() == Scope::CableOrAll => Some("all cables".to_owned()),
        0 => None,
        all if all > 1 && all == robot.cable_count() => Some("each cable".to_owned()),
        1..=4 => Some(list(targets)),
        several => Some(count(several, "cable")),
    }
}

/// The pose at which, or from which on, a cause acts.
fn event(cause: &Cause) -> Option<String> {
    let value = |index: usize| cause.instances[0].values[index];
    match cause.effect().search() {
        Search::FromPose(index) => Some(format!("from pose {}", value(index))),
        Search::AtPose(index) => Some(format!("pose {}", value(index))),
        Search::AtDistance(index) => Some(format!("row {}", value(index))),
        Search::Direct | Search::Wave { .. } | Search::Exchange => None,
    }
}
