//! The checklist of an adjustment: measure before, review, write, measure after, accept.

use tautline_link::adjusting::Difference;
use tautline_session::{Session, Stage};

use super::written;
use crate::accuracy::{Figure, before_and_after};
use crate::wording::count;

/// A step of an adjustment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AdjustmentStep {
    /// Measure the accuracy with the values that the controller has.
    MeasureBefore,
    /// Review the differences between the controller and the identified values.
    Review,
    /// Write the values.
    Write,
    /// Measure the accuracy with the identified values.
    MeasureAfter,
    /// Accept the robot.
    Accept,
}

impl AdjustmentStep {
    /// All steps, in their order.
    pub const ALL: [Self; 5] = [
        Self::MeasureBefore,
        Self::Review,
        Self::Write,
        Self::MeasureAfter,
        Self::Accept,
    ];

    /// Title of the step.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::MeasureBefore => "Measure before",
            Self::Review => "Review differences",
            Self::Write => "Write",
            Self::MeasureAfter => "Measure after",
            Self::Accept => "Accept",
        }
    }
}

/// State of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CheckState {
    /// Done, with a good result.
    Done,
    /// To be done now.
    Next,
    /// Not possible before an earlier step.
    Later,
    /// Not done, although later steps were.
    LeftOut,
    /// Done, with a bad result.
    Bad,
}

/// A step with its state and result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Check {
    /// The step.
    pub step: AdjustmentStep,
    /// State of the step.
    pub state: CheckState,
    /// Result of the step, in a few words.
    pub result: String,
}

/// The checklist of a session with these differences between controller and identified values; `is_old` if the data were
/// changed after the identification.
#[must_use]
pub fn checklist(session: &Session, differences: &[Difference], is_old: bool) -> [Check; 5] {
    let changes = differences.iter().filter(|one| one.is_writable_change());
    let changes = changes.count();
    let written = written(session, differences).filter(|_| !is_old);
    let mut runs = session.verifications().iter();
    let before = runs.rfind(|run| run.stage == Stage::Before);
    let after = written.and_then(|written| written.verification);
    let main = before_and_after(session).ok();
    let main = main.and_then(|all| all.into_iter().next());
    let gain = main
        .as_ref()
        .and_then(Figure::gain)
        .filter(|_| after.is_some());
    let is_worse = gain.is_some_and(|gain| gain <= 0.0);
    let accepted = written.and_then(|written| written.acceptance);
    let mm =
        |metres: Option<f64>| metres.map(|metres| format!("{:.2} mm on average", metres * 1e3));
    let is_done = [
        before.is_some(),
        written.is_some(),
        written.is_some(),
        after.is_some(),
        accepted.is_some(),
    ];
    let last_done = is_done.iter().rposition(|is_done| *is_done);
    let next = last_done.map_or(0, |last| last + 1);
    let mut results = [
        before.and_then(|_| mm(main.as_ref()?.before_m)),
        (changes > 0).then(|| count(changes, "value") + " to write"),
        written.map(|written| match written.adjustment.operator.as_str() {
            "" => "written".to_owned(),
            name => format!("by {name}"),
        }),
        after.and_then(|_| {
            let text = mm(main.as_ref()?.after_m)?;
            Some(match gain {
                Some(gain) => format!("{text} ({:+.0} %)", -100.0 * gain),
                None => text,
            })
        }),
        accepted.map(|accepted| match accepted.operator.as_str() {
            "" => "accepted".to_owned(),
            name => format!("by {name}"),
        }),
    ];
    std::array::from_fn(|place| {
        let step = AdjustmentStep::ALL[place];
        let state = match is_done[place] {
            true if step == AdjustmentStep::MeasureAfter && is_worse => CheckState::Bad,
            true => CheckState::Done,
            false if place < next => CheckState::LeftOut,
            false if place == next => CheckState::Next,
            false => CheckState::Later,
        };
        Check {
            step,
            state,
            result: results[place].take().unwrap_or_default(),
        }
    })
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;
    use tautline_session::{Adjustment, Outcome, Session, Timestamp};

    use super::*;
    use crate::accuracy::verification_of_one_pose as run;

    fn at(seconds: i64) -> Timestamp {
        Timestamp::from_unix_seconds(seconds)
    }

    fn written(seconds: i64) -> Adjustment {
        Adjustment {
            time: at(seconds),
            operator: "Ada".into(),
            controller: String::new(),
            changes: Vec::new(),
            outcome: Outcome::Written,
            read_back: Vec::new(),
            restores: false,
        }
    }

    fn states(session: &Session) -> [CheckState; 5] {
        checklist(session, &[], false).map(|check| check.state)
    }

    #[test]
    fn lines_are_ticked_in_their_order() {
        use CheckState::{Bad, Done, Later, LeftOut, Next};
        let robot = presets::find("mini").expect("a preset").robot;
        let mut session = Session::new("test", robot, at(0));
        assert_eq!(states(&session), [Next, Later, Later, Later, Later]);
        let mut without_before = session.clone();
        without_before.add_adjustment(written(2));
        assert_eq!(
            states(&without_before),
            [LeftOut, Done, Done, Next, Later],
            "what was left out is said"
        );
        session.add_verification(run(Stage::Before, 1, 2e-3));
        assert_eq!(states(&session), [Done, Next, Later, Later, Later]);
        session.add_adjustment(written(2));
        assert_eq!(states(&session), [Done, Done, Done, Next, Later]);
        let mut worse = session.clone();
        worse.add_verification(run(Stage::After, 3, 4e-3));
        assert_eq!(states(&worse), [Done, Done, Done, Bad, Next]);
        session.add_verification(run(Stage::After, 3, 5e-4));
        assert_eq!(states(&session), [Done, Done, Done, Done, Next]);
        session.accept("Ada", at(4));
        assert_eq!(states(&session), [Done; 5]);
        let [before, _, wrote, after, accepted] = checklist(&session, &[], false);
        assert_eq!(before.result, "2.00 mm on average");
        assert_eq!(wrote.result, "by Ada");
        assert_eq!(after.result, "0.50 mm on average (-75 %)");
        assert_eq!(accepted.result, "by Ada");
        // Other identified values end the acceptance until they are the accepted ones again.
        let other = Difference {
            name: "home.x_m".into(),
            unit: "m",
            controller: Some(0.0),
            identified: Some(1e-3),
            in_model: true,
            difference: Some(1e-3),
            sd: None,
            gain_m: None,
        };
        let changed = checklist(&session, &[other], false).map(|check| check.state);
        assert_eq!(changed, [Done, Next, Later, Later, Later]);
        // Other values need another measurement.
        session.add_adjustment(written(5));
        assert_eq!(states(&session), [Done, Done, Done, Next, Later]);
    }
}
