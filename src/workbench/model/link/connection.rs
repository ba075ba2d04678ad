//! A connection to a controller, and how a lost one is re-established.

use std::collections::HashMap;
use std::time::{Duration, Instant};

use tautline_link::laser::ManualLaser;
use tautline_link::measuring::{MeasuringOptions, MeasuringRun, predict_by};
use tautline_link::reconnecting::{Attempts, BackOff, Reconnect, ReconnectPolicy, Reconnected};
use tautline_link::{
    Activity, Controller, ControllerState, GuardedController, Instrument, LinkError, PoseTracker,
    Sample,
};

use super::message::{Doing, Lost, MeasuringRequest};
use super::operation::Measuring;
use tautline_workflow::controllers::{ConnectionSetup, Opened, SimulationClock};

/// Attempts to reconnect at once after a connection broke while values were written; later ones are made in the background.
const ATTEMPTS: u32 = 6;
/// Interval of the samples that keep a real controller's release without an operation; its program waits longer.
const ARMED: Duration = Duration::from_millis(100);
/// Between two samples by which a lost connection is noticed.
const DISARMED: Duration = Duration::from_millis(500);

/// Between two readings that a controller sends of its own accord (s).
const SENT_EVERY_S: f64 = 0.01;
/// After such a silence of the readings that it sends, those that were asked for are shown again.
const SILENCE: Duration = Duration::from_millis(500);

/// A controller with what belongs to its connection.
pub(super) struct Connection {
    pub controller: GuardedController<dyn Controller>,
    /// The laser to which the operator answers.
    pub asked: Option<ManualLaser>,
    pub instrument: Option<Box<dyn Instrument>>,
    pub clock: SimulationClock,
    pub rig: Box<ConnectionSetup>,
    pub whereabouts: Option<PoseTracker>,
    lost: Option<Reconnection>,
    /// When the last reading came that the controller sent of its own accord.
    sent: Option<Instant>,
}

/// A lost connection that is being re-established.
struct Reconnection {
    since: Instant,
    attempts: Reconnect,
    status: Lost,
}

impl Connection {
    pub fn new(opened: Opened, rig: Box<ConnectionSetup>) -> Self {
        Self {
            controller: opened.controller,
            asked: opened.manual_laser,
            instrument: opened.instrument,
            clock: opened.clock,
            whereabouts: PoseTracker::of(rig.robot()),
            rig,
            lost: None,
            sent: None,
        }
    }

    /// Has a real controller send its readings of its own accord, if it can: then more of them are shown than are asked for.
    pub fn subscribe(&mut self) {
        self.sent = None;
        if self.rig.reconnects() {
            // Otherwise those that are asked for are shown.
            let _ = self.controller.subscribe(SENT_EVERY_S);
        }
    }

    /// The readings to show that are new: those that the controller has sent, else the last one that was asked for.
    pub fn new_readings(&mut self) -> Vec<Sample> {
        // A loss of the connection shows in the state.
        let sent = self.controller.sent().unwrap_or_default();
        if !sent.is_empty() {
            self.sent = Some(Instant::now());
            return sent;
        }
        let silent = self.sent.is_none_or(|sent| sent.elapsed() > SILENCE);
        let last = self.controller.last().filter(|_| silent);
        last.cloned().into_iter().collect()
    }

    /// Time until the next sample of a real controller without an operation, or until the next attempt.
    pub fn pause(&self) -> Option<Duration> {
        if !self.rig.reconnects() {
            return None;
        }
        let armed = self.controller.state().armed;
        Some(if armed { ARMED } else { DISARMED })
    }

    /// The lost connection that is being re-established.
    pub fn lost(&self) -> Option<&Lost> {
        self.lost.as_ref().map(|lost| &lost.status)
    }

    /// What the controller does; `None` of a lost connection.
    pub fn state(&self) -> Option<ControllerState> {
        let there = self.lost.is_none();
        there.then(|| self.controller.state())
    }

    /// Whether the controller is silent, and nobody has noticed yet.
    pub fn is_newly_lost(&self) -> bool {
        self.lost.is_none() && self.controller.state().activity == Activity::Disconnected
    }

    /// The connection is lost; attempts begin at once.
    pub fn lose(&mut self, why: String) {
        let since = Instant::now();
        self.lost = Some(Reconnection {
            since,
            attempts: Reconnect::new(BackOff::default()),
            status: Lost { why, due: since },
        });
    }

    pub fn try_now(&mut self) {
        if let Some(lost) = &mut self.lost {
            lost.attempts = Reconnect::new(BackOff::default());
        }
    }

    /// Tries again if that is due; whether the controller is there again.
    pub fn try_again(&mut self) -> bool {
        let Some(lost) = &mut self.lost else {
            return false;
        };
        let now_s = lost.since.elapsed().as_secs_f64();
        match lost.attempts.tick(&mut self.controller, now_s) {
            Reconnected::Connected => {
                self.lost = None;
                return true;
            }
            Reconnected::Waiting(_) => {}
            Reconnected::Failed(error, due_s) => {
                lost.status = Lost {
                    why: error.to_string(),
                    due: lost.since + Duration::from_secs_f64(due_s),
                };
            }
        }
        false
    }

    /// A measuring run of this robot.
    pub fn measuring(&self, order: MeasuringRequest) -> Measuring {
        let rig = &self.rig;
        let mut options = MeasuringOptions::of(rig.robot());
        options.tension = rig.tension();
        options.waits_for_connection = rig.reconnects();
        let poses: HashMap<i64, _> = order.plan.iter().copied().collect();
        let mut run = MeasuringRun::new(order.plan, rig.robot(), options)
            .predicting(predict_by(&order.model, rig.tension()))
            .asking(self.asked.clone())
            .continuing(&order.measured);
        if order.is_open_ended {
            run = run.open_ended();
        }
        let per_revolution = rig.robot().cables.iter();
        Measuring {
            remaining: run.remaining(),
            run,
            poses,
            predictor: predict_by(&order.model, rig.tension()),
            per_revolution_m: per_revolution
                .map(|cable| cable.winch.cable_per_revolution_m())
                .collect(),
            doing: Doing::Moving,
        }
    }
}

/// Re-establishes a connection that broke while values are written.
pub(super) struct ReconnectWhileWriting<W> {
    /// Waits, and publishes the waiting.
    pub wait: W,
    /// Time after which nothing sent before can still arrive (s).
    pub late_s: f64,
}

impl<W: FnMut(f64)> ReconnectPolicy for ReconnectWhileWriting<W> {
    fn restore(&mut self, controller: &mut dyn Controller) -> Result<(), LinkError> {
        let mut attempts = Attempts {
            back_off: BackOff::default(),
            attempts: ATTEMPTS,
            late_s: self.late_s,
            wait: &mut self.wait,
            gives_up: || false,
        };
        attempts.restore(controller)
    }

    fn pause(&mut self) {
        (self.wait)(self.late_s);
    }
}
