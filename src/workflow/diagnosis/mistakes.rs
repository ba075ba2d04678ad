//! Mistakes in the readings that a check finds, undone before a diagnosis: the linear comparison of causes cannot find errors
//! by a factor of two or by a whole turn.

use tautline_core::effect::{EffectSetting, find};
use tautline_core::measurement::Dataset;
use tautline_import::{Mistake, Suggestion, check_table};
use tautline_session::{LogEntry, Phase as LogPhase, Session, Timestamp};

use super::Diagnosed;

/// Largest number of rounds: some mistakes show only after others are corrected.
const ROUNDS: usize = 5;
/// Effect of a model that states exchanged channels.
const EXCHANGED: &str = "cable_swap";
/// Effects that estimate the remaining error of an alignment: of the frame and of the point on the platform.
const OF_ALIGNMENT: [&str; 3] = ["tracker_frame", "tracker_target", "tracker_tilt"];

/// A dataset with the mistakes corrected, and the mistakes; `None` if there are none.
pub(super) fn without_mistakes(dataset: &Dataset) -> Option<(Dataset, Vec<Suggestion>)> {
    let mut corrected = dataset.clone();
    let mut undone: Vec<Suggestion> = Vec::new();
    // A model that states exchanged channels has readings on other channels than the check compares.
    if dataset
        .robot
        .effects
        .iter()
        .any(|one| one.effect == EXCHANGED)
    {
        return None;
    }
    for _ in 0..ROUNDS {
        let found = check_table(&corrected.measurements, &corrected.robot).suggestions;
        let is_known = |one: &Suggestion| undone.iter().any(|known| known.change == one.change);
        let new = found
            .into_iter()
            .filter(|one| is_undone(one) && !is_known(one));
        let new: Vec<Suggestion> = new
            .filter(|one| one.correct(&mut corrected.measurements))
            .collect();
        if new.is_empty() {
            break;
        }
        undone.extend(new);
    }
    corrected.robot.effects.extend(left_by(&undone));
    (!undone.is_empty()).then_some((corrected, undone))
}

/// Effects that estimate what the correction of mistakes leaves.
fn left_by(undone: &[Suggestion]) -> Vec<EffectSetting> {
    if !undone.iter().any(|one| one.mistake == Mistake::OtherFrame) {
        return Vec::new();
    }
    let left = OF_ALIGNMENT.into_iter().filter_map(find);
    left.map(|effect| EffectSetting {
        effect: effect.id().to_owned(),
        targets: Vec::new(),
        parameters: (effect.parameters().iter())
            .map(|parameter| (parameter.name.to_owned(), parameter.neutral))
            .collect(),
    })
    .collect()
}

impl Diagnosed {
    /// A copy of a diagnosed session in which the mistakes are corrected. The session itself keeps what was recorded.
    #[must_use]
    pub fn corrected_copy(&self, session: &Session, now: Timestamp) -> Session {
        let mut readings = session.measurements.clone();
        for mistake in &self.mistakes {
            mistake.correct(&mut readings);
        }
        let mut copy = session.with_readings(format!("{}, corrected", session.name), readings, now);
        for mistake in &self.mistakes {
            copy.record(LogEntry {
                time: now,
                phase: LogPhase::Poses,
                text: format!("Corrected: {}.", mistake.sentence),
            });
        }
        let effects = &mut copy.settings.identification.effects;
        effects.extend(left_by(&self.mistakes));
        copy
    }
}

/// Whether a diagnosis undoes a mistake. Not so steps of a few millimetres, which are causes that the diagnosis finds itself
/// with their uncertainty, nor mistakes that follow only from the mass of the platform: the mass may be wrong.
fn is_undone(one: &Suggestion) -> bool {
    !one.by_mass && !matches!(one.mistake, Mistake::EncoderStep | Mistake::ClockJump)
}

#[cfg(test)]
mod tests {
    use tautline_core::estimation::Control;
    use tautline_core::robot::presets;
    use tautline_core::simulation::{SimulationOptions, simulate};

    use super::super::{TIME_LIMIT_S, diagnose_dataset};
    use super::*;

    fn dataset() -> Dataset {
        let robot = presets::find("mini").expect("a preset").robot;
        let run = simulate(&robot, &SimulationOptions::new(30, 3)).expect("simulated");
        run.dataset
    }

    #[test]
    fn sound_readings_have_no_mistakes() {
        assert!(without_mistakes(&dataset()).is_none());
    }

    #[test]
    fn a_diagnosis_goes_on_without_the_mistakes() {
        let mut wrong = dataset();
        let data = &mut wrong.measurements;
        for row in 0..data.len() {
            let value = data.revolutions.get(row, 3);
            data.revolutions.set(row, 3, -value);
            let [a, b] = [1, 4].map(|cable| data.revolutions.get(row, cable));
            data.revolutions.set(row, 1, b);
            data.revolutions.set(row, 4, a);
        }
        let now = Timestamp::from_unix_seconds(1_700_000_000);
        let mut session = Session::new("MINI", wrong.robot.clone(), now);
        session.measurements = wrong.measurements.clone();
        session.exclude(7).expect("a measured pose");
        let options = (0.01, TIME_LIMIT_S);
        let told = diagnose_dataset(wrong.into(), options, &mut |_| Control::Continue);
        let told = told.expect("a diagnosis");
        let copy = told.corrected_copy(&session, now);
        assert_eq!(copy.name, "MINI, corrected");
        assert_eq!(copy.excluded(), session.excluded());
        assert_eq!(copy.measurements, dataset().measurements);
        assert_ne!(copy.measurements, session.measurements);
        let mistakes: Vec<Mistake> = told.mistakes.iter().map(|one| one.mistake).collect();
        assert_eq!(mistakes, [Mistake::Exchanged, Mistake::ReversedSign]);
        assert!(told.diagnosis.base.adequate && told.diagnosis.findings.is_empty());
        assert!(
            told.headline()
                .contains("2 mistakes in the readings are undone; then the model explains")
        );
        let document = told.document();
        assert!(!document.adequate);
        assert_eq!(document.mistakes, told.mistakes);
        let [(heading, lines)] = &told.gross()[..] else {
            panic!("{:?}", told.gross());
        };
        assert_eq!(*heading, "Mistakes in the readings, undone here");
        assert!(
            lines[0].starts_with("Rev_2 follows the expected values of rev_5"),
            "{lines:?}"
        );
    }
}
