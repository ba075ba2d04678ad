//! The current operation in words, and its remaining time.

use tautline_workflow::sequential::SequentialRun;

use super::{Link, RunStep};

impl Link {
    /// Current operation as a sentence.
    #[must_use]
    pub fn doing(&self) -> Option<String> {
        let doing = self.live().doing;
        let run = self.run.as_ref().filter(|run| !run.has_ended());
        if let Some(run) = run {
            return Some(match (&run.paused, run.current) {
                (Some(_), _) => "Paused".to_owned(),
                (None, None) if run.until.as_ref().is_some_and(SequentialRun::is_deciding) => {
                    "Choosing the next pose".to_owned()
                }
                (None, None) if run.until.is_some() && run.done() > 0 => {
                    "Going to the next pose".to_owned()
                }
                (None, None) => "Starting".to_owned(),
                (None, Some(label)) => at_pose(doing, label),
            });
        }
        if self.writing {
            return Some("Writing to the controller".to_owned());
        }
        self.verifying.map(|_| match doing {
            RunStep::Verifying { done, of } => format!("Test pose {done} of {of}"),
            RunStep::Locating { number, of } => {
                format!("At test pose {number} of {of}, waiting for its position")
            }
            _ => "Moving to the home pose".to_owned(),
        })
    }

    /// Number of poses done, and of all poses, in the current operation.
    #[must_use]
    pub fn done_of(&self) -> Option<[usize; 2]> {
        if let Some(run) = self.run.as_ref().filter(|run| !run.has_ended()) {
            return Some([run.done(), run.of()]);
        }
        self.verifying?;
        match self.live().doing {
            RunStep::Verifying { done, of } | RunStep::Locating { number: done, of } => {
                Some([done.saturating_sub(1), of])
            }
            _ => None,
        }
    }

    /// Remaining time of the current operation (s, clock of the operator).
    #[must_use]
    pub fn time_left_s(&self) -> Option<f64> {
        let run = self.run.as_ref().filter(|run| !run.has_ended());
        let left_s = match run {
            Some(run) => run.remaining_s(),
            None => self.live().remaining_s.filter(|_| self.verifying.is_some()),
        };
        Some(left_s? / self.speed())
    }

    /// Remaining time in words, such as "2 min left".
    #[must_use]
    pub fn time_left(&self) -> Option<String> {
        let left = duration(self.time_left_s()?);
        let is_open_ended = self.run.as_ref().is_some_and(|run| run.until.is_some());
        Some(match is_open_ended {
            true => format!("at most {left} left"),
            false => format!("{left} left"),
        })
    }
}

fn at_pose(doing: RunStep, label: i64) -> String {
    let place = match label {
        0 => "home".to_owned(),
        label => format!("pose {label}"),
    };
    match doing {
        RunStep::Settling { .. } => format!("At {place}, settling"),
        RunStep::Sampling { taken, of } => {
            format!("At {place}, reading sample {taken} of {of}")
        }
        RunStep::Asking { .. } => format!("At {place}, waiting for the laser distance"),
        RunStep::Nothing
        | RunStep::Moving
        | RunStep::Verifying { .. }
        | RunStep::Locating { .. } => {
            format!("Moving to {place}")
        }
    }
}

/// A duration in seconds or minutes.
#[must_use]
pub fn duration(seconds: f64) -> String {
    if seconds < 90.0 {
        format!("{seconds:.0} s")
    } else {
        format!("{:.0} min", seconds / 60.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_say_where_the_robot_is_and_what_it_does() {
        let settling = RunStep::Settling {
            rates: None,
            limits: Default::default(),
            remaining_s: 1.0,
        };
        assert_eq!(at_pose(settling, 7), "At pose 7, settling");
        assert_eq!(at_pose(RunStep::Moving, 0), "Moving to home");
        let sampling = RunStep::Sampling { taken: 3, of: 10 };
        assert_eq!(at_pose(sampling, 7), "At pose 7, reading sample 3 of 10");
        assert_eq!(duration(89.0), "89 s");
        assert_eq!(duration(200.0), "3 min");
    }
}
