//! Connection to a controller, and its recovery after a loss.

use std::collections::HashMap;
use std::time::{Duration, Instant};

use tautline_link::laser::ManualLaser;
use tautline_link::measuring::{MeasuringOptions, MeasuringRun, predict_by};
use tautline_link::reconnecting::{Attempts, BackOff, Reconnect, ReconnectPolicy, Reconnected};
use tautline_link::{
    Activity, Controller, ControllerState, GuardedController, Instrument, LinkError, PoseTracker,
    Sample,
};

use super::message::{LostConnection, MeasuringRequest, RunStep};
use super::operation::Measuring;
use tautline_workflow::controllers::{ConnectionSetup, Opened, SimulationClock};

/// Attempts to reconnect at once after a loss during writing; later ones are made in the background.
const ATTEMPTS: u32 = 6;
/// Sampling interval that keeps a real controller armed between operations; its watchdog waits longer.
const ARMED: Duration = Duration::from_millis(100);
/// Sampling interval at which the loss of a connection is detected.
const DISARMED: Duration = Duration::from_millis(500);

/// Interval of the readings that a controller publishes (s).
const SENT_EVERY_S: f64 = 0.01;
/// Polled readings are shown again after such a pause of the published ones.
const SILENCE: Duration = Duration::from_millis(500);

/// Controller with the state of its connection.
pub(super) struct Connection {
    pub controller: GuardedController<dyn Controller>,
    /// Laser whose distance the operator types.
    pub asked: Option<ManualLaser>,
    pub instrument: Option<Box<dyn Instrument>>,
    pub clock: SimulationClock,
    pub rig: Box<ConnectionSetup>,
    pub whereabouts: Option<PoseTracker>,
    lost: Option<Reconnection>,
    /// Time of the last published reading.
    sent: Option<Instant>,
}

/// A lost connection that is being re-established.
struct Reconnection {
    since: Instant,
    attempts: Reconnect,
    status: LostConnection,
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

    /// Subscribes to the readings of a real controller, if it publishes them: they come more often than polled ones.
    pub fn subscribe(&mut self) {
        self.sent = None;
        if self.rig.reconnects() {
            // Without a subscription the polled readings are shown.
            let _ = self.controller.subscribe(SENT_EVERY_S);
        }
    }

    /// New readings to show: those that the controller published, otherwise the last polled one.
    pub fn new_readings(&mut self) -> Vec<Sample> {
        // A lost connection shows in the state.
        let sent = self.controller.sent().unwrap_or_default();
        if !sent.is_empty() {
            self.sent = Some(Instant::now());
            return sent;
        }
        let silent = self.sent.is_none_or(|sent| sent.elapsed() > SILENCE);
        let last = self.controller.last().filter(|_| silent);
        last.cloned().into_iter().collect()
    }

    /// Time until the next sample of a real controller between operations, or until the next attempt to reconnect.
    pub fn pause(&self) -> Option<Duration> {
        if !self.rig.reconnects() {
            return None;
        }
        let armed = self.controller.state().armed;
        Some(if armed { ARMED } else { DISARMED })
    }

    /// The lost connection that is being re-established.
    pub fn lost(&self) -> Option<&LostConnection> {
        self.lost.as_ref().map(|lost| &lost.status)
    }

    /// State of the controller; `None` while the connection is lost.
    pub fn state(&self) -> Option<ControllerState> {
        let there = self.lost.is_none();
        there.then(|| self.controller.state())
    }

    /// Whether the connection has just been lost.
    pub fn is_newly_lost(&self) -> bool {
        self.lost.is_none() && self.controller.state().activity == Activity::Disconnected
    }

    /// Marks the connection as lost and begins to reconnect.
    pub fn lose(&mut self, why: String) {
        let since = Instant::now();
        self.lost = Some(Reconnection {
            since,
            attempts: Reconnect::new(BackOff::default()),
            status: LostConnection { why, due: since },
        });
    }

    pub fn try_now(&mut self) {
        if let Some(lost) = &mut self.lost {
            lost.attempts = Reconnect::new(BackOff::default());
        }
    }

    /// Tries to reconnect if an attempt is due; returns whether the controller is connected again.
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
                lost.status = LostConnection {
                    why: error.to_string(),
                    due: lost.since + Duration::from_secs_f64(due_s),
                };
            }
        }
        false
    }

    /// Measuring run with this robot.
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
            doing: RunStep::Moving,
        }
    }
}

/// Reconnects after a loss during writing.
pub(super) struct ReconnectWhileWriting<W> {
    /// Waits, and publishes the remaining time.
    pub wait: W,
    /// Time after which earlier messages can no longer arrive (s).
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
