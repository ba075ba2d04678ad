//! The guided measuring run: from pose to pose, each settled, averaged, checked, and stored before the next.
//!
//! The caller calls [`MeasuringRun::tick`] again and again, at least as often as it wants samples, and stores every
//! [`MeasuringEvent::Measured`] pose before it confirms it. A pose is commanded only when that before it
//! is confirmed: so a crash loses at most the pose under way. The pose labelled 0 is home: there the controller
//! is told to go home, where its encoders are zeroed; put it first in the plan.

mod accepted;
mod checks;
mod options;
mod precision;
mod settling;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;

pub use accepted::{Accepted, measurements_of};
pub use checks::Warning;
pub use options::{MeasuringOptions, Prediction, Predictor, Rates, predict_by};
pub use precision::largest_sd_m;

use crate::controller::{Activity, Controller, LinkError, Sample};
use checks::{Checks, Journey, exchanged, jump};
use settling::Window;

/// Answers that may be missing one after the other before the run gives up.
const LOST_ANSWERS: usize = 5;

/// What happened.
#[derive(Debug, Clone, PartialEq)]
pub enum MeasuringEvent {
    /// The controller was sent to a pose.
    Commanded {
        /// Label of the pose.
        label: i64,
    },
    /// The platform has arrived and is waited for to stand still.
    Settling {
        /// How fast readings change; `None` until enough samples tell it.
        rates: Option<Rates>,
        /// How fast they may.
        limits: Rates,
        /// At least this much time is left (s).
        remaining_s: f64,
    },
    /// A sample was taken.
    Sampling {
        /// Samples taken.
        taken: usize,
        /// Samples wanted.
        of: usize,
    },
    /// A pose was measured: store it and call [`MeasuringRun::confirm_stored`].
    Measured(Box<Accepted>),
    /// Something does not look right.
    Warning(Warning),
    /// A pose was left out.
    Skipped {
        /// Label of the pose.
        label: i64,
    },
    /// The run waits for [`MeasuringRun::resume`], [`MeasuringRun::skip`] or [`MeasuringRun::abort`].
    Paused {
        /// Why, as for the operator.
        reason: String,
    },
    /// All poses are measured or skipped.
    Finished,
    /// The run has ended early; the text says why. Begin a new one with what is measured.
    Failed(String),
}

/// Where a run is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// The next pose can be commanded.
    Ready,
    /// On the way or settling.
    Approaching,
    /// Samples are taken.
    Sampling,
    /// The measured pose waits to be stored.
    Storing,
    /// Over.
    Ended,
}

/// A measuring run; plain state, moved on by [`Self::tick`].
pub struct MeasuringRun {
    robot: Robot,
    plan: Vec<(i64, Pose)>,
    options: MeasuringOptions,
    predictor: Predictor,
    queue: VecDeque<(i64, Pose)>,
    current: Option<(i64, Pose)>,
    stage: Stage,
    paused: bool,
    window: Window,
    samples: Vec<Sample>,
    journey: Option<Journey>,
    /// Pose commanded before the present one.
    before: Option<Pose>,
    commanded_at_s: Option<f64>,
    /// Caller's time of the last new sample, and the controller's time in it.
    heard: Option<(f64, f64)>,
    lost_answers: usize,
    /// Measured and predicted revolutions of the poses so far.
    compared: Vec<(Vec<f64>, Vec<f64>)>,
    reported_pairs: Vec<[usize; 2]>,
    pending: Vec<MeasuringEvent>,
}

impl MeasuringRun {
    /// A run over labelled poses; what is expected follows from `robot` unless
    /// [`Self::predicting`] says otherwise.
    #[must_use]
    pub fn new(plan: Vec<(i64, Pose)>, robot: &Robot, options: MeasuringOptions) -> Self {
        Self {
            predictor: predict_by(robot, options.tension),
            robot: robot.clone(),
            queue: plan.iter().copied().collect(),
            plan,
            options,
            current: None,
            stage: Stage::Ready,
            paused: false,
            window: Window::default(),
            samples: Vec::new(),
            journey: None,
            before: None,
            commanded_at_s: None,
            heard: None,
            lost_answers: 0,
            compared: Vec::new(),
            reported_pairs: Vec::new(),
            pending: Vec::new(),
        }
    }

    /// The same run with another prediction, such as by an identified model.
    #[must_use]
    pub fn predicting(mut self, predictor: Predictor) -> Self {
        self.predictor = predictor;
        self
    }

    /// The same run without the poses that are measured already.
    #[must_use]
    pub fn continuing(mut self, measured: &[i64]) -> Self {
        self.queue.retain(|(label, _)| !measured.contains(label));
        self
    }

    /// Where the run is.
    #[must_use]
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// Whether it is paused.
    #[must_use]
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// Label of the pose under way.
    #[must_use]
    pub fn current(&self) -> Option<i64> {
        self.current.map(|(label, _)| label)
    }

    /// Label of the pose under way, else of that which comes next: what a pause is about.
    #[must_use]
    pub fn under_way(&self) -> Option<i64> {
        let next = || self.queue.front().map(|(label, _)| *label);
        self.current().or_else(next)
    }

    /// Poses that are still to be measured, the present one included.
    #[must_use]
    pub fn remaining(&self) -> usize {
        self.queue.len() + usize::from(self.current.is_some())
    }

    /// The measured pose is stored: the next one may be commanded.
    pub fn confirm_stored(&mut self, label: i64) {
        if self.stage == Stage::Storing && self.current() == Some(label) {
            self.before = self.current.take().map(|(_, pose)| pose);
            self.stage = Stage::Ready;
        }
    }

    /// Waits before the next step; a motion under way ends.
    pub fn pause(&mut self) {
        self.hold("paused by the operator".to_owned());
    }

    fn hold(&mut self, reason: String) {
        if !self.paused && self.stage != Stage::Ended {
            self.paused = true;
            self.pending.push(MeasuringEvent::Paused { reason });
        }
    }

    /// Goes on. The pose under way is approached anew, unless it waits to be stored.
    pub fn resume(&mut self) {
        if std::mem::take(&mut self.paused) {
            self.heard = None;
            self.approach_anew();
        }
    }

    fn approach_anew(&mut self) {
        if matches!(self.stage, Stage::Approaching | Stage::Sampling) {
            self.queue.extend(self.current.take());
            self.queue.rotate_right(1);
            self.stage = Stage::Ready;
        }
    }

    /// Leaves out the pose under way, or the next one; goes on where the run was paused.
    pub fn skip(&mut self) {
        if matches!(self.stage, Stage::Storing | Stage::Ended) {
            return;
        }
        let skipped = self.current.take().or_else(|| self.queue.pop_front());
        if let Some((label, _)) = skipped {
            self.pending.push(MeasuringEvent::Skipped { label });
        }
        self.stage = Stage::Ready;
        self.paused = false;
    }

    /// Measures a pose of the plan again, next; `false` if the plan has no such pose or the run has ended.
    pub fn repeat(&mut self, label: i64) -> bool {
        let Some(pose) = self.plan.iter().find(|(known, _)| *known == label) else {
            return false;
        };
        if self.stage == Stage::Ended {
            return false;
        }
        self.queue.retain(|(queued, _)| *queued != label);
        self.queue.push_front(*pose);
        if self.current() == Some(label) && self.stage != Stage::Storing {
            self.current = None;
            self.stage = Stage::Ready;
        }
        true
    }

    /// Stops the platform and ends the run.
    ///
    /// # Errors
    /// If the controller cannot be told to stop; the run has ended all the same.
    pub fn abort(&mut self, controller: &mut dyn Controller) -> Result<(), LinkError> {
        self.stage = Stage::Ended;
        controller.stop()
    }

    /// Moves the run on: takes at most one sample and says what happened.
    ///
    /// `now_s` is the caller's time, by which silence of the controller is noticed; rates and the settling time count by
    /// the controller's own clock.
    pub fn tick(&mut self, controller: &mut dyn Controller, now_s: f64) -> Vec<MeasuringEvent> {
        let waits = self.paused || matches!(self.stage, Stage::Storing | Stage::Ended);
        if !waits {
            self.advance(controller, now_s);
        }
        std::mem::take(&mut self.pending)
    }

    fn fail(&mut self, text: String) {
        self.stage = Stage::Ended;
        self.pending.push(MeasuringEvent::Failed(text));
    }

    fn warn(&mut self, cable: Option<usize>, text: String) {
        self.pending.push(MeasuringEvent::Warning(Warning {
            label: self.current().unwrap_or(0),
            cable,
            text,
            refuses: false,
        }));
    }

    fn advance(&mut self, controller: &mut dyn Controller, now_s: f64) {
        let state = controller.state();
        match state.activity {
            Activity::Disconnected => {
                return self.fail("The connection to the controller is lost.".to_owned());
            }
            Activity::Fault(text) => {
                return self.fail(format!("The controller reports a fault: {text}."));
            }
            _ => {}
        }
        if !state.armed {
            let reason = "the controller is not armed: arm it, then go on";
            return self.hold(reason.to_owned());
        }
        let Some(sample) = self.listen(controller, now_s) else {
            return;
        };
        match self.stage {
            Stage::Ready => self.command_next(controller, sample),
            Stage::Approaching => {
                let moving = state.activity == Activity::Moving;
                self.approach(sample, moving);
            }
            Stage::Sampling => self.collect(sample),
            Stage::Storing | Stage::Ended => {}
        }
    }

    /// A sample that was not seen before.
    fn listen(&mut self, controller: &mut dyn Controller, now_s: f64) -> Option<Sample> {
        match controller.sample() {
            Ok(sample) => {
                self.lost_answers = 0;
                let seen = self.heard.filter(|(_, time_s)| *time_s == sample.time_s);
                let Some((since_s, _)) = seen else {
                    self.heard = Some((now_s, sample.time_s));
                    return Some(sample);
                };
                if now_s - since_s > self.options.timeout_s {
                    self.fail("The controller sends no new readings.".to_owned());
                }
            }
            Err(error @ LinkError::Limit(_)) => self.hold(error.to_string()),
            Err(error) => {
                self.lost_answers += 1;
                if error.is_disconnection() || self.lost_answers >= LOST_ANSWERS {
                    self.fail(error.to_string());
                } else {
                    self.warn(None, error.to_string());
                }
            }
        }
        None
    }

    fn command_next(&mut self, controller: &mut dyn Controller, sample: Sample) {
        let Some((label, pose)) = self.queue.pop_front() else {
            self.stage = Stage::Ended;
            self.pending.push(MeasuringEvent::Finished);
            return;
        };
        let told = match label {
            0 => controller.home(),
            _ => controller.command(&pose),
        };
        if let Err(error) = told {
            self.queue.push_front((label, pose));
            if error.is_disconnection() {
                self.fail(error.to_string());
            } else {
                self.hold(format!("pose {label} was not commanded: {error}"));
            }
            return;
        }
        self.current = Some((label, pose));
        self.stage = Stage::Approaching;
        self.window.clear();
        self.samples.clear();
        self.commanded_at_s = Some(sample.time_s);
        let expected = self.before.and_then(|before| (self.predictor)(&before));
        // At home the encoders are set to zero: nothing can be told from how they change.
        self.journey = (label != 0).then(|| Journey::from(sample, expected));
        self.pending.push(MeasuringEvent::Commanded { label });
    }

    fn approach(&mut self, sample: Sample, moving: bool) {
        if let Some(journey) = &mut self.journey {
            journey.follow(&sample);
        }
        let since_s = sample.time_s - self.commanded_at_s.unwrap_or(sample.time_s);
        let late = since_s > self.options.timeout_s;
        let label = self.current().unwrap_or(0);
        if moving {
            self.window.clear();
            if late {
                self.hold(format!(
                    "the platform has not arrived at pose {label} after {since_s:.0} s"
                ));
            }
            return;
        }
        if self.note_jump(&sample) {
            self.window.clear();
        }
        let span_s = self.options.settle_time_s;
        self.window.push(sample, span_s);
        let limits = self.options.still;
        let settled = self.window.settled(&self.robot, &limits, span_s);
        let still = settled.as_ref().is_some_and(|s| s.still);
        if still {
            self.stage = Stage::Sampling;
        } else if late {
            let restless = settled.as_ref().and_then(|s| s.restless.clone());
            let restless = restless.unwrap_or_else(|| "too few readings arrive".to_owned());
            self.hold(format!(
                "the platform does not come to rest at pose {label} within {:.0} s: {restless}",
                self.options.timeout_s
            ));
        }
        self.pending.push(MeasuringEvent::Settling {
            rates: settled.map(|s| s.rates),
            limits,
            remaining_s: self.window.missing_s(span_s),
        });
    }

    /// Warns of a jump since the sample before.
    fn note_jump(&mut self, sample: &Sample) -> bool {
        let averaged = self.options.samples;
        let before = self.samples.last().or(self.window.last());
        let found = before.and_then(|before| jump(&self.robot, averaged, (before, sample)));
        let jumped = found.is_some();
        if let Some((cable, text)) = found {
            self.warn(cable, format!("{text}: the pose is settled anew."));
        }
        jumped
    }

    fn collect(&mut self, sample: Sample) {
        if self.note_jump(&sample) {
            self.samples.clear();
            self.window.clear();
            self.stage = Stage::Approaching;
            return;
        }
        self.samples.push(sample);
        self.pending.push(MeasuringEvent::Sampling {
            taken: self.samples.len(),
            of: self.options.samples,
        });
        if self.samples.len() >= self.options.samples {
            self.accept();
        }
    }

    /// Checks the mean of the samples, and hands it to the caller unless it cannot be used.
    fn accept(&mut self) {
        let Some((label, pose)) = self.current else {
            return;
        };
        let mut accepted = Accepted::mean_of(label, pose, &self.samples);
        let expected = (self.predictor)(&pose);
        let checks = Checks {
            robot: &self.robot,
            options: &self.options,
            at: &accepted,
        };
        let warnings = checks.all(self.journey.as_ref(), expected.as_ref());
        let refusal = warnings.iter().find(|w| w.refuses).map(|w| w.text.clone());
        accepted.notes = warnings.iter().map(|w| w.text.clone()).collect();
        let told = warnings.into_iter().map(MeasuringEvent::Warning);
        self.pending.extend(told);
        if let Some(text) = refusal {
            self.hold(format!("pose {label} cannot be used: {text}"));
            return;
        }
        if let Some(expected) = expected.filter(|_| label != 0) {
            let measured = accepted.revolutions.clone();
            self.compared.push((measured, expected.revolutions));
            self.compare_channels();
        }
        self.stage = Stage::Storing;
        self.pending
            .push(MeasuringEvent::Measured(Box::new(accepted)));
    }

    fn compare_channels(&mut self) {
        for pair in exchanged(&self.compared) {
            if self.reported_pairs.contains(&pair) {
                continue;
            }
            self.reported_pairs.push(pair);
            let [a, b] = pair.map(|index| self.robot.cables[index].name.clone());
            self.warn(
                Some(pair[0]),
                format!("{a} and {b}: each encoder follows the motion of the other cable. Are their plugs exchanged?"),
            );
        }
    }
}
