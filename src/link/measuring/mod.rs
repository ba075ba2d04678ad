//! The guided measuring run: from pose to pose, each settled, averaged, checked, and stored before the next.
//!
//! The caller calls [`MeasuringRun::tick`] repeatedly, at least as often as it wants samples, and stores every
//! [`MeasuringEvent::Measured`] pose before it confirms it. A pose is commanded only after the previous one
//! is confirmed, so a crash loses at most the pose in progress. The values of the controller are read before the first pose and
//! at the end, so that a change by someone else shows. The pose labelled 0 is home: there the controller
//! is sent home, where its encoders are zeroed; it should be first in the plan.

mod at_pose;
mod channels;
mod checks;
mod mean;
mod options;
mod precision;
mod settling;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;
use tautline_session::MeasuredPose;

pub use checks::{TensionFault, Warning};
pub use options::{MeasuringOptions, Prediction, Predictor, Rates, predict_by};
pub use precision::largest_sd_m;
pub use settling::{SettlingState, SettlingWindow};

use crate::adjusting::read_parameters;
use crate::controller::{Activity, Controller, Sample};
use crate::error::LinkError;
use crate::laser::ManualLaser;
use crate::parameters::ParameterInfo;
use channels::Channels;
use checks::MotionRecord;

/// Number of consecutive missing responses after which the run fails.
const LOST_ANSWERS: usize = 5;

/// Reason of a pause after the connection was lost.
pub const LOST: &str =
    "the connection to the controller is lost; when it is restored, arm it and resume";

const DISARMED: &str = "the controller is not armed: arm it, then resume";

/// An event of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum MeasuringEvent {
    /// The values that the controller holds before the first pose is commanded: store them, to compare them with those at
    /// the end.
    ValuesAtStart(Vec<ParameterInfo>),
    /// The values that the controller holds at the end of the run. If they could not be read, there is no such event, and
    /// those of the next connection should be compared.
    ValuesAtEnd(Vec<ParameterInfo>),
    /// The controller was sent to a pose.
    Commanded {
        /// Label of the pose.
        label: i64,
    },
    /// The platform has arrived and is settling.
    Settling {
        /// Rates of change of the readings; `None` until there are enough samples.
        rates: Option<Rates>,
        /// Limits of the rates at rest.
        limits: Rates,
        /// Shortest remaining time (s).
        remaining_s: f64,
    },
    /// A sample was taken.
    Sampling {
        /// Number of samples taken.
        taken: usize,
        /// Number of samples wanted.
        of: usize,
    },
    /// The platform is at rest: the operator must read the laser distance and answer the [`ManualLaser`] of the run.
    /// Nothing moves until then.
    LaserWanted {
        /// Label of the pose.
        label: i64,
    },
    /// A pose was measured: store it and call [`MeasuringRun::confirm_stored`].
    Measured(Box<MeasuredPose>),
    /// A reading is implausible.
    Warning(Warning),
    /// A pose was skipped.
    Skipped {
        /// Label of the pose.
        label: i64,
    },
    /// The run waits for [`MeasuringRun::resume`], [`MeasuringRun::skip`] or [`MeasuringRun::abort`].
    Paused {
        /// The reason, for the operator.
        reason: String,
        /// Whether the operator has to decide, by [`Controller::accept_overload`]: a cable is overloaded, or its force sensor is
        /// dead and an overload would not be detected.
        is_overload: bool,
    },
    /// All poses are measured or skipped.
    Finished,
    /// The run has failed; the text states why. A new run can continue from the measured poses.
    Failed(String),
}

/// Stage of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// The next pose can be commanded.
    Ready,
    /// Moving or settling.
    Approaching,
    /// At rest, waiting for the laser distance typed by the operator.
    Asking,
    /// Samples are taken.
    Sampling,
    /// Waiting until the measured pose is stored.
    Storing,
    /// Ended.
    Ended,
}

/// Stage of the last reading of the controller's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ValuesRead {
    /// Not read so far.
    None,
    /// Read at the start of the run.
    AtStart,
    /// Read at the end of the run.
    AtEnd,
}

/// A measuring run: a state machine that [`Self::tick`] advances.
pub struct MeasuringRun {
    robot: Robot,
    plan: Vec<(i64, Pose)>,
    options: MeasuringOptions,
    predictor: Predictor,
    /// The laser whose distance is typed by the operator, if there is one.
    asked: Option<ManualLaser>,
    queue: VecDeque<(i64, Pose)>,
    current: Option<(i64, Pose)>,
    stage: Stage,
    paused: bool,
    /// Whether poses may still be added, so that the run does not end when all are measured.
    is_open: bool,
    window: SettlingWindow,
    samples: Vec<Sample>,
    motion: Option<MotionRecord>,
    /// Cables with dead force sensors that the operator has accepted, and those for which a decision is pending.
    unprotected: Vec<Option<usize>>,
    asked_about: Vec<Option<usize>>,
    /// Cables whose encoders jumped on the way to the present pose; `None` is the laser.
    jumped: Vec<Option<usize>>,
    /// The previous pose.
    before: Option<Pose>,
    commanded_at_s: Option<f64>,
    /// Caller's time of the last new sample, and the controller's time in it.
    last_sample: Option<(f64, f64)>,
    lost_answers: usize,
    /// Whether the run has failed because the controller was restarted.
    restarted: bool,
    values_read: ValuesRead,
    channels: Channels,
    pending: Vec<MeasuringEvent>,
}

impl MeasuringRun {
    /// A run over labelled poses; `robot` predicts the readings unless [`Self::predicting`] replaces it.
    #[must_use]
    pub fn new(plan: Vec<(i64, Pose)>, robot: &Robot, options: MeasuringOptions) -> Self {
        Self {
            predictor: predict_by(robot, options.tension),
            robot: robot.clone(),
            queue: plan.iter().copied().collect(),
            plan,
            options,
            asked: None,
            current: None,
            stage: Stage::Ready,
            paused: false,
            is_open: false,
            window: SettlingWindow::default(),
            samples: Vec::new(),
            motion: None,
            unprotected: Vec::new(),
            asked_about: Vec::new(),
            jumped: Vec::new(),
            before: None,
            commanded_at_s: None,
            last_sample: None,
            lost_answers: 0,
            restarted: false,
            values_read: ValuesRead::None,
            channels: Channels::default(),
            pending: Vec::new(),
        }
    }

    /// Replaces the prediction, for example by that of an identified model.
    #[must_use]
    pub fn predicting(mut self, predictor: Predictor) -> Self {
        self.predictor = predictor;
        self
    }

    /// Uses a laser distance typed by the operator; `laser` is a clone of that in the station.
    #[must_use]
    pub fn asking(mut self, laser: Option<ManualLaser>) -> Self {
        self.asked = laser;
        self
    }

    /// Leaves out the poses that are already measured.
    #[must_use]
    pub fn continuing(mut self, measured: &[i64]) -> Self {
        self.queue.retain(|(label, _)| !measured.contains(label));
        self
    }

    /// Goes on after the last pose until [`Self::close`], because poses are added one by one.
    #[must_use]
    pub fn open_ended(mut self) -> Self {
        self.is_open = true;
        self
    }

    /// Adds a pose to the end of the plan.
    pub fn add(&mut self, label: i64, pose: Pose) {
        self.plan.push((label, pose));
        self.queue.push_back((label, pose));
    }

    /// Ends an open-ended run after the poses that it has.
    pub fn close(&mut self) {
        self.is_open = false;
    }

    /// The stage of the run.
    #[must_use]
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// Whether the run is paused.
    #[must_use]
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// Whether the run has failed because the controller was restarted, so that another run cannot continue it.
    #[must_use]
    pub fn was_restarted(&self) -> bool {
        self.restarted
    }

    /// Label of the present pose.
    #[must_use]
    pub fn current(&self) -> Option<i64> {
        self.current.map(|(label, _)| label)
    }

    /// Label of the present or else the next pose, to which a pause refers.
    #[must_use]
    pub fn under_way(&self) -> Option<i64> {
        let next = || self.queue.front().map(|(label, _)| *label);
        self.current().or_else(next)
    }

    /// Number of poses still to be measured, including the present one.
    #[must_use]
    pub fn remaining(&self) -> usize {
        self.queue.len() + usize::from(self.current.is_some())
    }

    /// Confirms that the measured pose is stored, so that the next one may be commanded.
    pub fn confirm_stored(&mut self, label: i64) {
        if self.stage == Stage::Storing && self.current() == Some(label) {
            self.before = self.current.take().map(|(_, pose)| pose);
            self.stage = Stage::Ready;
        }
    }

    /// Pauses before the next step; a motion in progress is completed.
    pub fn pause(&mut self) {
        self.hold("paused by the operator".to_owned());
    }

    /// Pauses for a reason, unless the run is paused already.
    pub fn hold(&mut self, reason: String) {
        self.pause_for(reason, false);
    }

    fn pause_for(&mut self, reason: String, is_overload: bool) {
        if !self.paused && self.stage != Stage::Ended {
            self.paused = true;
            self.pending.push(MeasuringEvent::Paused {
                reason,
                is_overload,
            });
        }
    }

    /// Resumes. The present pose is approached again, unless it is waiting to be stored. The operator is not asked again about
    /// the same force sensors.
    pub fn resume(&mut self) {
        if std::mem::take(&mut self.paused) {
            self.unprotected.append(&mut self.asked_about);
            self.last_sample = None;
            self.approach_anew();
        }
    }

    fn approach_anew(&mut self) {
        let approaches = [Stage::Approaching, Stage::Asking, Stage::Sampling];
        if approaches.contains(&self.stage) {
            self.queue.extend(self.current.take());
            self.queue.rotate_right(1);
            self.stage = Stage::Ready;
        }
    }

    /// Skips the present or else the next pose, and resumes.
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
        self.asked_about.clear();
    }

    /// Measures a pose of the plan again, as the next one; `false` if the plan has no such pose or the run has ended.
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
    /// If the controller cannot be stopped; the run has ended anyway.
    pub fn abort(&mut self, controller: &mut dyn Controller) -> Result<(), LinkError> {
        self.stage = Stage::Ended;
        controller.stop()
    }

    /// Advances the run by at most one sample and returns the events.
    ///
    /// `now_s` is the caller's time, by which a silent controller is detected; rates and the settling time are measured on
    /// the controller's own clock.
    pub fn tick(&mut self, controller: &mut dyn Controller, now_s: f64) -> Vec<MeasuringEvent> {
        let waits = self.paused || matches!(self.stage, Stage::Storing | Stage::Ended);
        if !waits {
            self.advance(controller, now_s);
            if self.stage == Stage::Ended {
                // Before the event of the end, which is the last one.
                let read = self.values_at_end(controller);
                self.pending.splice(0..0, read);
            }
        }
        std::mem::take(&mut self.pending)
    }

    fn fail(&mut self, text: String) {
        self.stage = Stage::Ended;
        self.pending.push(MeasuringEvent::Failed(text));
    }

    /// Fails because the measured poses cannot be continued.
    fn fail_restarted(&mut self, error: &LinkError) {
        self.restarted = true;
        self.fail(format!("{error}."));
    }

    /// Handles a lost connection.
    fn lose(&mut self, text: String) {
        if self.options.waits_for_connection {
            self.lost_answers = 0;
            self.hold(LOST.to_owned());
        } else {
            self.fail(text);
        }
    }

    fn warn(&mut self, cable: Option<usize>, text: String) {
        self.pending.push(MeasuringEvent::Warning(Warning {
            label: self.current().unwrap_or(0),
            cable,
            text,
            refuses: false,
            is_dead_sensor: false,
        }));
    }

    fn advance(&mut self, controller: &mut dyn Controller, now_s: f64) {
        let state = controller.state();
        match state.activity {
            Activity::Disconnected => {
                return self.lose("The connection to the controller is lost.".to_owned());
            }
            Activity::Fault(text) => {
                return self.fail(format!("The controller reports a fault: {text}."));
            }
            _ => {}
        }
        if !state.armed {
            return self.hold(DISARMED.to_owned());
        }
        let Some(sample) = self.listen(controller, now_s) else {
            return;
        };
        // The sample itself may reveal a state in which it does not count; the pose is then not measured.
        let now = controller.state();
        if let Activity::Fault(text) = now.activity {
            return self.fail(format!("The controller reports a fault: {text}."));
        }
        if !now.armed {
            return self.hold(DISARMED.to_owned());
        }
        match self.stage {
            Stage::Ready => self.command_next(controller, sample),
            Stage::Approaching => {
                let moving = state.activity == Activity::Moving;
                self.approach(sample, moving);
            }
            Stage::Asking => self.wait_for_answer(&sample),
            Stage::Sampling => self.collect(sample, controller.laser_problem()),
            Stage::Storing | Stage::Ended => {}
        }
    }

    /// Waits for a new sample.
    fn listen(&mut self, controller: &mut dyn Controller, now_s: f64) -> Option<Sample> {
        match controller.sample() {
            Ok(sample) => {
                self.lost_answers = 0;
                let seen = self
                    .last_sample
                    .filter(|(_, time_s)| *time_s == sample.time_s);
                let Some((since_s, _)) = seen else {
                    self.last_sample = Some((now_s, sample.time_s));
                    return Some(sample);
                };
                if now_s - since_s > self.options.timeout_s {
                    self.fail("The controller sends no new readings.".to_owned());
                }
            }
            Err(error @ LinkError::Limit(_)) => self.pause_for(error.to_string(), true),
            Err(error @ LinkError::Restarted(_)) => self.fail_restarted(&error),
            Err(error) => {
                self.lost_answers += 1;
                if error.is_disconnection() {
                    self.lose(error.to_string());
                } else if self.lost_answers >= LOST_ANSWERS {
                    self.fail(error.to_string());
                } else {
                    self.warn(None, error.to_string());
                }
            }
        }
        None
    }

    /// Reads the values of the controller at the end of a run that its caller ends, once.
    pub fn values_at_end(&mut self, controller: &mut dyn Controller) -> Option<MeasuringEvent> {
        if self.values_read != ValuesRead::AtStart {
            return None;
        }
        let read = read_parameters(controller).ok()?;
        self.values_read = ValuesRead::AtEnd;
        Some(MeasuringEvent::ValuesAtEnd(read))
    }

    /// Reads the values of the controller before anything moves.
    fn read_first_values(&mut self, controller: &mut dyn Controller) {
        match read_parameters(controller) {
            Ok(read) => {
                self.values_read = ValuesRead::AtStart;
                self.pending.push(MeasuringEvent::ValuesAtStart(read));
            }
            Err(error) if error.is_disconnection() => self.lose(error.to_string()),
            Err(error @ LinkError::Restarted(_)) => self.fail_restarted(&error),
            Err(error) => self.fail(error.to_string()),
        }
    }

    fn command_next(&mut self, controller: &mut dyn Controller, sample: Sample) {
        if self.values_read == ValuesRead::None && !self.queue.is_empty() {
            return self.read_first_values(controller);
        }
        let Some((label, pose)) = self.queue.pop_front() else {
            if self.is_open {
                return;
            }
            self.stage = Stage::Ended;
            self.pending.push(MeasuringEvent::Finished);
            return;
        };
        let result = match label {
            0 => controller.home(),
            _ => controller.command(&pose),
        };
        if let Err(error) = result {
            self.queue.push_front((label, pose));
            if error.is_disconnection() {
                self.lose(error.to_string());
            } else if matches!(error, LinkError::Restarted(_)) {
                self.fail_restarted(&error);
            } else {
                self.hold(format!("pose {label} was not commanded: {error}"));
            }
            return;
        }
        self.current = Some((label, pose));
        self.stage = Stage::Approaching;
        self.window.clear();
        self.samples.clear();
        self.jumped.clear();
        self.commanded_at_s = Some(sample.time_s);
        let expected = self.before.and_then(|before| (self.predictor)(&before));
        // At home the encoders are zeroed, so their change is meaningless.
        self.motion = (label != 0).then(|| MotionRecord::from(sample, expected));
        self.pending.push(MeasuringEvent::Commanded { label });
    }
}
