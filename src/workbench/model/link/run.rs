//! What is known of a measuring run.

use std::collections::BTreeSet;

use tautline_link::measuring::Warning;
use tautline_session::MeasuredPose;

use super::message::Surprise;
use tautline_workflow::planning::poses_in_words;
use tautline_workflow::sequential::SequentialRun;

/// A measured pose that waits to be on disk.
#[derive(Debug, Clone)]
pub struct Pending {
    pub label: i64,
    /// What was measured, with the label that it gets.
    pub pose: MeasuredPose,
    /// Whether it could not be kept.
    pub failed: bool,
}

/// A measuring run as the operator follows it.
#[derive(Debug, Default)]
pub struct RunLog {
    to_measure: BTreeSet<i64>,
    measured: BTreeSet<i64>,
    /// Labels that were left out.
    pub skipped: BTreeSet<i64>,
    /// Label that the platform is at or on its way to.
    pub current: Option<i64>,
    /// Why it waits, if it does.
    pub paused: Option<String>,
    /// Warnings, oldest first.
    pub warnings: Vec<Warning>,
    /// Number of warnings that the session has already.
    stored_warnings: usize,
    /// How far each pose was from what was expected.
    pub surprises: Vec<Surprise>,
    /// Label that was measured last.
    last: Option<i64>,
    /// When poses were measured, by the controller's clock (s).
    times_s: Vec<f64>,
    pub ended: Option<Result<(), String>>,
    /// Whether it ended because the controller was restarted.
    pub restarted: bool,
    /// Decisions on its poses, if they are made one by one.
    pub until: Option<SequentialRun>,
    /// Why no pose could be decided on, if that failed.
    pub undecided: Option<String>,
    /// Poses that were measured before the run, the home pose not counted.
    before: usize,
}

impl RunLog {
    /// A run over poses of these labels, beside `before` poses that were measured before.
    #[must_use]
    pub fn new(labels: impl Iterator<Item = i64>, before: usize) -> Self {
        Self {
            to_measure: labels.collect(),
            before,
            ..Self::default()
        }
    }

    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.ended.is_some()
    }

    /// Whether it ended because a decision has ended it.
    #[must_use]
    pub fn has_decided(&self) -> bool {
        let until = self.until.as_ref();
        self.has_ended() && until.is_some_and(|until| until.end().is_some())
    }

    /// Poses that are measured, those before the run included and the home pose not counted.
    #[must_use]
    pub fn done(&self) -> usize {
        self.before + self.measured.iter().filter(|label| **label != 0).count()
    }

    /// Poses in all, those before the run included, those left out and the home pose not counted; of an open-ended run the
    /// largest number.
    #[must_use]
    pub fn of(&self) -> usize {
        if let Some(until) = &self.until {
            return until.at_most().max(self.done());
        }
        let wanted = self.to_measure.difference(&self.skipped);
        self.before + wanted.filter(|label| **label != 0).count()
    }

    /// The poses that are measured, in words.
    #[must_use]
    pub fn measured_in_words(&self) -> String {
        poses_in_words(self.measured.iter().copied())
    }

    pub fn measured(&mut self, label: i64, time_s: f64) {
        self.measured.insert(label);
        self.skipped.remove(&label);
        self.last = Some(label);
        self.times_s.push(time_s);
    }

    /// Warnings since the last call, to be stored with the pose that was measured.
    pub(crate) fn take_new_warnings(&mut self) -> Vec<Warning> {
        let new = self.warnings.get(self.stored_warnings..);
        let new = new.unwrap_or_default().to_vec();
        self.stored_warnings = self.warnings.len();
        new
    }

    /// The pose that was measured last, unless it is the home pose, which cannot be repeated.
    #[must_use]
    pub fn last_measured(&self) -> Option<i64> {
        self.last.filter(|label| *label != 0)
    }

    /// A pose is measured again.
    pub fn again(&mut self, label: i64) {
        self.measured.remove(&label);
        self.to_measure.insert(label);
    }

    /// Time until the last pose is measured (s, clock of the controller); `None` before the second pose.
    #[must_use]
    pub fn remaining_s(&self) -> Option<f64> {
        let [first, .., last] = *self.times_s else {
            return None;
        };
        let each_s = (last - first) / (self.times_s.len() - 1) as f64;
        Some(each_s * self.of().saturating_sub(self.done()) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_left_follows_from_the_poses_so_far() {
        let mut run = RunLog::new(0..6, 0);
        run.measured(0, 10.0);
        assert_eq!(run.remaining_s(), None);
        run.measured(1, 14.0);
        assert_eq!(run.remaining_s(), Some(16.0));
        run.skipped.insert(5);
        assert_eq!((run.done(), run.of()), (1, 4), "home is not counted");
        assert_eq!(run.measured_in_words(), "1 pose and the home pose");
        assert_eq!(run.remaining_s(), Some(12.0));
        run.again(1);
        assert_eq!(run.done(), 0);
        let mut continued = RunLog::new(8..12, 7);
        continued.measured(8, 20.0);
        assert_eq!((continued.done(), continued.of()), (8, 11));
    }
}
