//! Progress of a measuring run.

use std::collections::BTreeSet;

use tautline_link::measuring::Warning;
use tautline_session::MeasuredPose;

use super::message::PoseDeviation;
use tautline_workflow::planning::poses_in_words;
use tautline_workflow::sequential::SequentialRun;

/// Measured pose that is not on disk yet.
#[derive(Debug, Clone)]
pub struct PendingPose {
    pub label: i64,
    /// Measured pose with its label.
    pub pose: MeasuredPose,
    /// Whether storing it failed.
    pub failed: bool,
}

/// Measuring run as the operator follows it.
#[derive(Debug, Default)]
pub struct RunLog {
    to_measure: BTreeSet<i64>,
    measured: BTreeSet<i64>,
    /// Labels of skipped poses.
    pub skipped: BTreeSet<i64>,
    /// Label of the pose that the platform is at or moves to.
    pub current: Option<i64>,
    /// Reason why it is paused.
    pub paused: Option<String>,
    /// Warnings, oldest first.
    pub warnings: Vec<Warning>,
    /// Number of warnings stored in the session.
    stored_warnings: usize,
    /// Deviation of each pose from its prediction.
    pub surprises: Vec<PoseDeviation>,
    /// Label measured last.
    last: Option<i64>,
    /// Times of the measurements (s, clock of the controller).
    times_s: Vec<f64>,
    pub ended: Option<Result<(), String>>,
    /// Whether it ended because the controller was restarted.
    pub restarted: bool,
    /// Sequential choice of poses, if enabled.
    pub until: Option<SequentialRun>,
    /// Reason why the choice of a pose failed.
    pub undecided: Option<String>,
    /// Number of poses measured before the run, without the home pose.
    before: usize,
}

impl RunLog {
    /// Run over poses of these labels, in addition to `before` poses measured earlier.
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

    /// Whether the run ended by its end condition.
    #[must_use]
    pub fn has_decided(&self) -> bool {
        let until = self.until.as_ref();
        self.has_ended() && until.is_some_and(|until| until.end().is_some())
    }

    /// Number of measured poses, including those before the run, without the home pose.
    #[must_use]
    pub fn done(&self) -> usize {
        self.before + self.measured.iter().filter(|label| **label != 0).count()
    }

    /// Number of all poses, including those before the run, without skipped ones and the home pose; of an open-ended
    /// run, the largest number.
    #[must_use]
    pub fn of(&self) -> usize {
        if let Some(until) = &self.until {
            return until.at_most().max(self.done());
        }
        let wanted = self.to_measure.difference(&self.skipped);
        self.before + wanted.filter(|label| **label != 0).count()
    }

    /// Measured poses in words.
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

    /// Warnings since the last call, to be stored with the measured pose.
    pub(crate) fn take_new_warnings(&mut self) -> Vec<Warning> {
        let new = self.warnings.get(self.stored_warnings..);
        let new = new.unwrap_or_default().to_vec();
        self.stored_warnings = self.warnings.len();
        new
    }

    /// Pose measured last; `None` for the home pose, which cannot be repeated.
    #[must_use]
    pub fn last_measured(&self) -> Option<i64> {
        self.last.filter(|label| *label != 0)
    }

    /// Marks a pose as to be measured again.
    pub fn again(&mut self, label: i64) {
        self.measured.remove(&label);
        self.to_measure.insert(label);
    }

    /// Remaining time until the last pose is measured (s, clock of the controller); `None` before the second pose.
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
