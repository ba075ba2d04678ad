//! The thread that owns the controller.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use tautline_link::adjusting::{
    Adjustment, check_unchanged, check_values, read_parameters, settle_adjustment,
    write_adjustment, write_adjustment_reconnecting,
};
use tautline_link::measuring::LOST;
use tautline_link::verifying::CheckTarget;
use tautline_link::{Activity, Clock, Controller, LinkError};
use tautline_session::{CheckRow, Stage};

use super::connection::{Connection, ReconnectWhileWriting};
use super::message::{DriverCommand, DriverEvent, LinkRequest, LiveState, LostConnection};
use super::operation::{Operation, Verifying};
use super::publisher::{PICTURE, StatusPublisher};
use tautline_workflow::adjusting::Purpose;
use tautline_workflow::controllers::{ConnectionSetup, OpenError, RobotKind};

/// Interval between two samples in real time.
const TICK: Duration = Duration::from_millis(20);
/// Shortest interval between two samples of a simulated robot with a time factor.
const SHORTEST_TICK: Duration = Duration::from_millis(3);
/// Longest time step of a simulated robot during an operation (s).
const LONGEST_STEP_S: f64 = 0.2;
/// Interval at which the countdown to the next attempt to reconnect is updated.
const COUNTDOWN: Duration = Duration::from_millis(250);
/// Reason for an end by request.
const BY_OPERATOR: &str = "it was stopped by the operator";

struct Worker {
    publisher: StatusPublisher,
    connection: Option<Connection>,
    operation: Operation,
    polls_when_idle: bool,
    speed: f64,
}

/// Carries out commands until the channel is closed, then stops the platform.
pub(super) fn serve(commands: &Receiver<DriverCommand>, publisher: StatusPublisher, speed: f64) {
    let mut worker = Worker {
        publisher,
        connection: None,
        operation: Operation::None,
        polls_when_idle: false,
        speed,
    };
    let mut was_busy = false;
    loop {
        let pause = worker.pause();
        if was_busy && pause.is_none() {
            worker.show(true);
        }
        was_busy = pause.is_some();
        let command = match pause {
            Some(pause) => match commands.recv_timeout(pause) {
                Ok(command) => Some(command),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => break,
            },
            None => match commands.recv() {
                Ok(command) => Some(command),
                Err(_) => break,
            },
        };
        let done = catch_unwind(AssertUnwindSafe(|| worker.step(command, was_busy)));
        if done.is_err() {
            worker.end(Some(
                "the thread that serves it failed with an internal error".to_owned(),
            ));
        }
    }
    worker.end(None);
}

impl Worker {
    /// Time until the next sample; `None` without an operation.
    fn pause(&self) -> Option<Duration> {
        let connection = self.connection.as_ref()?;
        if connection.lost().is_some() {
            return Some(COUNTDOWN);
        }
        let moves = connection.controller.state().activity == Activity::Moving;
        if moves || self.operation.needs_ticks() {
            let tick = TICK.div_f64(connection.clock.speed().max(1.0));
            return Some(tick.max(SHORTEST_TICK));
        }
        let polls_when_idle = self.polls_when_idle.then_some(PICTURE);
        polls_when_idle.into_iter().chain(connection.pause()).min()
    }

    /// Whether there is more to do than to sample a real controller.
    fn is_busy(&self) -> bool {
        let moves = |connection: &Connection| {
            let state = connection.controller.state();
            state.activity == Activity::Moving
        };
        self.operation.needs_ticks()
            || self.polls_when_idle
            || self.connection.as_ref().is_some_and(moves)
    }

    /// Carries out one step; `goes_on` tells that an operation was running before.
    fn step(&mut self, command: Option<DriverCommand>, goes_on: bool) {
        let given = command.is_some();
        if let Some(connection) = &self.connection {
            connection
                .clock
                .follow_real_time(goes_on.then_some(LONGEST_STEP_S));
        }
        if let Some(command) = command
            && let Err(error) = self.perform(command)
        {
            self.refuse(&error);
        }
        self.tick();
        self.show(given);
    }

    fn refuse(&mut self, error: &LinkError) {
        self.publisher.report(match error {
            LinkError::Untrusted(server) => DriverEvent::Untrusted(server.clone()),
            error => DriverEvent::Refused(error.to_string()),
        });
        if error.is_disconnection() {
            self.lose(error.to_string());
        }
    }

    /// Handles a lost connection: one to a real controller is re-established, any other has ended.
    fn lose(&mut self, why: String) {
        let Some(connection) = &mut self.connection else {
            return;
        };
        if !connection.rig.reconnects() {
            return self.end(Some(why));
        }
        if connection.lost().is_some() {
            return;
        }
        connection.lose(why.clone());
        let now_s = connection.clock.now_s();
        let mut reports = Vec::new();
        match &mut self.operation {
            Operation::Measuring(measuring) => {
                measuring.run.hold(LOST.to_owned());
                reports = measuring.tick(&mut connection.controller, now_s);
            }
            // A verification belongs to one uninterrupted motion.
            Operation::Verifying(_) => reports.extend(self.operation.abort(&why)),
            Operation::None => {}
        }
        for report in reports {
            self.publisher.report(report);
        }
        self.publisher.report(DriverEvent::Lost(why));
    }

    /// Tries to reconnect, if an attempt is due.
    fn try_again(&mut self) {
        let Some(connection) = &mut self.connection else {
            return;
        };
        if !connection.try_again() {
            return;
        }
        match read_parameters(&mut connection.controller) {
            Ok(parameters) => {
                connection.subscribe();
                self.publisher.report(DriverEvent::Regained(parameters));
                self.show(true);
            }
            Err(error) => connection.lose(error.to_string()),
        }
    }

    /// Determines the values of the controller after an interrupted write, and restores the old ones if possible.
    fn settle(&mut self, old: &[(String, f64)], new: &[(String, f64)]) -> Result<(), LinkError> {
        let Some(connection) = &mut self.connection else {
            return Ok(());
        };
        let controller = &mut connection.controller;
        let found = check_values(controller, old, new)?;
        let adjustment = settle_adjustment(controller, old, new)?;
        self.publisher.report(DriverEvent::Settled {
            found,
            adjustment: Box::new(adjustment),
            holds: controller.parameters().ok(),
        });
        Ok(())
    }

    fn perform(&mut self, command: DriverCommand) -> Result<(), LinkError> {
        match command {
            DriverCommand::Connect(rig, session_id) => self.connect(rig, session_id)?,
            DriverCommand::Requested(LinkRequest::Disconnect) => self.end(None),
            DriverCommand::PollWhenIdle(polls_when_idle) => self.polls_when_idle = polls_when_idle,
            DriverCommand::Speed(speed) => {
                self.speed = speed;
                if let Some(connection) = &self.connection
                    && !connection.rig.runs_in_real_time()
                {
                    connection.clock.set_speed(speed);
                }
            }
            other => self.control(other)?,
        }
        Ok(())
    }

    /// Carries out a command that needs a connection.
    fn control(&mut self, command: DriverCommand) -> Result<(), LinkError> {
        let Some(connection) = self.connection.as_mut() else {
            // A command for a run that ended with its connection needs no answer.
            return Ok(());
        };
        let controller = &mut connection.controller;
        match command {
            DriverCommand::Arm => controller.arm()?,
            DriverCommand::Requested(LinkRequest::Disarm) => controller.disarm(),
            DriverCommand::Abort => {
                let stopped = controller.stop();
                // Updates the position shown; an error of a reading shows in the state.
                let _ = controller.sample();
                let read = self.operation.values_at_end(controller);
                let report = self.operation.abort(BY_OPERATOR);
                (read.into_iter().chain(report)).for_each(|r| self.publisher.report(r));
                stopped?;
            }
            DriverCommand::Measure(command) => {
                self.operation = Operation::Measuring(Box::new(connection.measuring(*command)));
            }
            DriverCommand::Add(label, pose) => self.operation.measuring(|m| m.add(label, pose)),
            DriverCommand::Close => self.operation.measuring(|m| m.run.close()),
            DriverCommand::Verify(targets, stage, rows) => self.verify(targets, stage, rows),
            DriverCommand::Requested(LinkRequest::TypedPose(number, pose)) => {
                if let Operation::Verifying(verifying) = &self.operation
                    && let Some(typed) = &verifying.typed
                {
                    typed.answer(number, pose)?;
                }
            }
            DriverCommand::Requested(LinkRequest::TryNow) => connection.try_now(),
            DriverCommand::Requested(LinkRequest::ReadParameters) => {
                let parameters = read_parameters(controller)?;
                self.publisher.report(DriverEvent::Parameters(parameters));
            }
            DriverCommand::Write { old, new, purpose } => self.write(&old, new, purpose),
            DriverCommand::Settle { old, new } => self.settle(&old, &new)?,
            DriverCommand::Requested(LinkRequest::Pause) => {
                self.operation.measuring(|m| m.run.pause());
            }
            DriverCommand::Requested(LinkRequest::Resume) => {
                controller.accept_overload();
                self.operation.measuring(|m| m.run.resume());
                self.publisher.report(DriverEvent::Resumed);
            }
            DriverCommand::Requested(LinkRequest::Skip) => {
                controller.accept_overload();
                self.operation.measuring(|m| m.run.skip());
            }
            DriverCommand::Repeat(label) => self.operation.measuring(|m| {
                m.run.repeat(label);
            }),
            DriverCommand::Requested(LinkRequest::LaserDistance(label, distance_m)) => {
                if let Some(laser) = &connection.asked {
                    laser.answer(label, distance_m)?;
                }
            }
            DriverCommand::Stored(label) => {
                self.operation.measuring(|m| m.run.confirm_stored(label));
            }
            DriverCommand::Connect(..)
            | DriverCommand::Requested(LinkRequest::Disconnect)
            | DriverCommand::PollWhenIdle(_)
            | DriverCommand::Speed(_) => {}
        }
        Ok(())
    }

    fn connect(&mut self, rig: Box<ConnectionSetup>, session_id: u64) -> Result<(), LinkError> {
        let had_another = self.close(BY_OPERATOR);
        let made = self.make(rig, session_id);
        if made.is_err() && had_another {
            self.publisher.report(DriverEvent::Disconnected(None));
        }
        made
    }

    fn make(&mut self, rig: Box<ConnectionSetup>, session_id: u64) -> Result<(), LinkError> {
        let opened = rig.open(self.speed).map_err(|error| match error {
            OpenError::Link(error) => error,
            OpenError::Read(error) => LinkError::Setup(error.to_string()),
        })?;
        let mut connection = Connection::new(opened, rig.clone());
        connection.controller.connect()?;
        let parameters = read_parameters(&mut connection.controller)?;
        connection.subscribe();
        let identity = connection.controller.identity();
        let protection = connection.controller.protection();
        self.publisher.begin_scope(connection.rig.robot());
        self.connection = Some(connection);
        self.publisher.report(DriverEvent::Connected {
            identity,
            protection,
            parameters,
            rig,
            session_id,
        });
        Ok(())
    }

    /// Stops the platform, ends the connection and reports it.
    fn end(&mut self, why: Option<String>) {
        if self.close(why.as_deref().unwrap_or(BY_OPERATOR)) {
            self.show(true);
            self.publisher.report(DriverEvent::Disconnected(why));
        }
    }

    /// Stops the platform and ends operation and connection for the reason `why`; returns whether there was a
    /// connection.
    fn close(&mut self, why: &str) -> bool {
        let mut connection = self.connection.take();
        let read = connection.as_mut().and_then(|connection| {
            // The connection ends in any case, and its loss stops the drives.
            let _ = connection.controller.stop();
            self.operation.values_at_end(&mut connection.controller)
        });
        let ended = self.operation.abort(why);
        (read.into_iter().chain(ended)).for_each(|r| self.publisher.report(r));
        connection.is_some_and(|mut connection| {
            connection.controller.disconnect();
            true
        })
    }

    fn verify(&mut self, targets: Vec<CheckTarget>, stage: Stage, rows: Vec<CheckRow>) {
        let Some(connection) = &mut self.connection else {
            return;
        };
        let begun = match connection.rig.kind {
            RobotKind::Recording => Err("Not available for a recording.".to_owned()),
            _ => (connection.controller.home()).map_err(|e| format!("The way home: {e}.")),
        };
        match begun {
            Ok(()) => {
                let has_instrument = connection.instrument.is_some();
                let run = Verifying::new(targets, (stage, rows), has_instrument);
                self.operation = Operation::Verifying(Box::new(run));
            }
            Err(text) => self
                .publisher
                .report(DriverEvent::Verified(stage, Vec::new(), Err(text))),
        }
    }

    fn write(&mut self, old: &[(String, f64)], values: Vec<(String, f64)>, purpose: Purpose) {
        let Some(connection) = &mut self.connection else {
            return;
        };
        let written = if connection.rig.kind == RobotKind::Recording {
            let text = "this is a recording, in which nothing can be changed";
            Err(LinkError::Refused(text.to_owned()))
        } else {
            check_unchanged(&mut connection.controller, old)
                .and_then(|()| write(connection, &mut self.publisher, &values))
        };
        let holds = connection.controller.parameters().ok();
        self.publisher.report(DriverEvent::Written {
            values,
            purpose,
            result: written.map(Box::new).map_err(|error| error.to_string()),
            holds,
        });
    }

    fn tick(&mut self) {
        let Some(connection) = &mut self.connection else {
            return;
        };
        if connection.lost().is_some() {
            return self.try_again();
        }
        let listens = connection.rig.reconnects();
        let controller = &mut connection.controller;
        // Between operations, an error of a reading shows in the state.
        let reports = match &mut self.operation {
            Operation::None => {
                let moves = controller.state().activity == Activity::Moving;
                if listens || moves || self.polls_when_idle && self.publisher.is_due() {
                    let _ = controller.sample();
                }
                Vec::new()
            }
            Operation::Measuring(measuring) => {
                if listens && !measuring.needs_ticks() {
                    let _ = controller.sample();
                }
                measuring.tick(controller, connection.clock.now_s())
            }
            Operation::Verifying(verifying) => {
                let now_s = controller.last().map(|sample| sample.time_s);
                let timed = (controller as &mut dyn Controller, now_s);
                verifying.tick(timed, connection.instrument.as_deref_mut())
            }
        };
        connection
            .new_readings()
            .iter()
            .for_each(|sample| self.publisher.record(sample));
        let is_newly_lost = connection.is_newly_lost();
        if self.operation.has_ended() {
            self.operation = Operation::None;
        }
        for report in reports {
            self.publisher.report(report);
        }
        if is_newly_lost {
            self.lose("the connection to the controller is lost".to_owned());
        }
    }

    /// Publishes the state of the controller; at once if `changed`.
    fn show(&mut self, changed: bool) {
        if !changed && !self.publisher.is_due() && self.operation.needs_ticks() {
            return;
        }
        let live = match &mut self.connection {
            None => LiveState::default(),
            Some(connection) => {
                let sample = connection.controller.last().cloned();
                let whereabouts = connection.whereabouts.as_mut();
                let pose = whereabouts
                    .zip(sample.as_ref())
                    .map(|(w, s)| w.of_sample(s));
                LiveState {
                    state: connection.state(),
                    lost: connection.lost().cloned(),
                    pose,
                    sample,
                    doing: self.operation.doing(),
                    remaining: self.operation.remaining(),
                    remaining_s: self.operation.remaining_s(),
                }
            }
        };
        // Sampling a controller at standstill does not wake the window.
        let is_new = |shown: &LiveState| shown.state != live.state || live.lost.is_some();
        if changed || self.is_busy() || self.publisher.shows(is_new) {
            self.publisher.put(live);
        }
    }
}

/// Writes values and reconnects if the connection breaks.
fn write(
    connection: &mut Connection,
    publisher: &mut StatusPublisher,
    values: &[(String, f64)],
) -> Result<Adjustment, LinkError> {
    let why = "the connection was lost while values were written";
    let reconnects = connection.rig.reconnects();
    let mut policy = ReconnectWhileWriting {
        late_s: connection.rig.late_s(),
        wait: |pause_s: f64| {
            let pause = Duration::from_secs_f64(pause_s);
            let lost = LostConnection {
                why: why.to_owned(),
                due: Instant::now() + pause,
            };
            publisher.put(LiveState {
                lost: Some(lost),
                ..LiveState::default()
            });
            std::thread::sleep(pause);
        },
    };
    let controller = &mut connection.controller;
    match reconnects {
        true => write_adjustment_reconnecting(controller, values, &mut policy),
        false => write_adjustment(controller, values),
    }
}
