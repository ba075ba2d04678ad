//! The thread that owns the controller.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tautline_link::adjusting::write_adjustment;
use tautline_link::laser::ManualLaser;
use tautline_link::measuring::{MeasuringOptions, MeasuringRun, predict_by};
use tautline_link::verifying::{VerifyingOptions, VerifyingRun};
use tautline_link::{Activity, Clock, Controller, Instrument, LinkError, Station};

use super::message::{Doing, Live, MeasuringOrder, Order, Purpose, Report};
use super::whereabouts::Whereabouts;
use super::work::{Measuring, Verifying, Work};
use crate::controllers::{FastClock, OpenError, Rig};

/// Between two samples at the speed of real time.
const TICK: Duration = Duration::from_millis(20);
/// Shortest time between two samples of a simulated robot whose time runs faster.
const SHORTEST_TICK: Duration = Duration::from_millis(1);
/// Longest step of a simulated robot's time while something goes on (s).
const LONGEST_STEP_S: f64 = 0.2;
/// Between two pictures of the window.
const PICTURE: Duration = Duration::from_millis(50);
/// Why something ends if nothing is wrong.
const BY_OPERATOR: &str = "it was stopped by the operator";

/// Tells the window; wakes it no more often than it can show.
pub(super) struct Teller {
    pub reports: Sender<Report>,
    pub live: Arc<Mutex<Live>>,
    pub context: egui::Context,
    pub woken: Option<Instant>,
}

impl Teller {
    pub fn report(&mut self, report: Report) {
        // Nobody listens any more when the program ends.
        let _ = self.reports.send(report);
        self.wake();
    }

    fn wake(&mut self) {
        let since = self.woken.map_or(PICTURE, |woken| woken.elapsed());
        if since >= PICTURE {
            self.woken = Some(Instant::now());
            self.context.request_repaint();
        } else {
            self.context.request_repaint_after(PICTURE - since);
        }
    }

    /// Whether a picture is due.
    fn is_due(&self) -> bool {
        self.woken.is_none_or(|woken| woken.elapsed() >= PICTURE)
    }
}

/// A controller with what belongs to its connection.
struct Connection {
    controller: Station<Box<dyn Controller>>,
    /// The laser to which the operator answers.
    asked: Option<ManualLaser>,
    instrument: Option<Box<dyn Instrument>>,
    clock: FastClock,
    rig: Box<Rig>,
    whereabouts: Option<Whereabouts>,
}

struct Worker {
    tell: Teller,
    connection: Option<Connection>,
    work: Work,
    watches: bool,
    speed: f64,
}

/// Serves orders until nobody gives any more; then the platform is stopped.
pub(super) fn serve(orders: &Receiver<Order>, tell: Teller, speed: f64) {
    let mut worker = Worker {
        tell,
        connection: None,
        work: Work::None,
        watches: false,
        speed,
    };
    let mut was_busy = false;
    loop {
        let pause = worker.pause();
        if was_busy && pause.is_none() {
            worker.show(true);
        }
        was_busy = pause.is_some();
        let order = match pause {
            Some(pause) => match orders.recv_timeout(pause) {
                Ok(order) => Some(order),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => break,
            },
            None => match orders.recv() {
                Ok(order) => Some(order),
                Err(_) => break,
            },
        };
        let done = catch_unwind(AssertUnwindSafe(|| worker.step(order, was_busy)));
        if done.is_err() {
            worker.end(Some(
                "the part of the program that serves it broke down".to_owned(),
            ));
        }
    }
    worker.end(None);
}

impl Worker {
    /// Time until the next sample; `None` while nothing goes on.
    fn pause(&self) -> Option<Duration> {
        let connection = self.connection.as_ref()?;
        let moves = connection.controller.state().activity == Activity::Moving;
        if moves || self.work.needs_ticks() {
            let tick = TICK.div_f64(connection.clock.speed().max(1.0));
            return Some(tick.max(SHORTEST_TICK));
        }
        self.watches.then_some(PICTURE)
    }

    /// Does one step; `goes_on`: something went on before.
    fn step(&mut self, order: Option<Order>, goes_on: bool) {
        let given = order.is_some();
        if let Some(connection) = &self.connection {
            connection.clock.go_on(goes_on.then_some(LONGEST_STEP_S));
        }
        if let Some(order) = order
            && let Err(error) = self.perform(order)
        {
            self.refuse(&error);
        }
        self.tick();
        self.show(given);
    }

    fn refuse(&mut self, error: &LinkError) {
        let lost = error.is_disconnection();
        self.tell.report(Report::Refused(error.to_string()));
        if lost {
            self.end(Some(error.to_string()));
        }
    }

    fn perform(&mut self, order: Order) -> Result<(), LinkError> {
        match order {
            Order::Connect(rig, document) => self.connect(rig, document)?,
            Order::Disconnect => self.end(None),
            Order::Watch(watches) => self.watches = watches,
            Order::Speed(speed) => {
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

    /// What needs a connection.
    fn control(&mut self, order: Order) -> Result<(), LinkError> {
        let Some(connection) = self.connection.as_mut() else {
            // What concerns a run that has ended with its connection needs no answer.
            return Ok(());
        };
        let controller = &mut connection.controller;
        match order {
            Order::Arm => controller.arm()?,
            Order::Disarm => controller.disarm(),
            Order::Abort => {
                let stopped = controller.stop();
                let report = self.work.abort(BY_OPERATOR);
                report.into_iter().for_each(|r| self.tell.report(r));
                stopped?;
            }
            Order::Measure(order) => {
                self.work = Work::Measuring(Box::new(measuring(connection, *order)));
            }
            Order::Verify(_, stage) if connection.instrument.is_none() => {
                let text = "No external instrument is connected: import a check.csv instead.";
                let report = Report::Verified(stage, Err(text.to_owned()));
                self.tell.report(report);
            }
            Order::Verify(targets, stage) => {
                if let Err(error) = controller.home() {
                    let report = Report::Verified(stage, Err(format!("The way home: {error}.")));
                    self.tell.report(report);
                    return Ok(());
                }
                let run = VerifyingRun::new(targets, VerifyingOptions::default());
                self.work = Work::Verifying(Box::new(Verifying::new(run, stage)));
            }
            Order::Parameters => {
                let parameters = controller.parameters()?;
                self.tell.report(Report::Parameters(parameters));
            }
            Order::Write(values, purpose) => self.write(values, purpose),
            Order::Pause => self.work.measuring(|m| m.run.pause()),
            Order::Resume => {
                self.work.measuring(|m| m.run.resume());
                self.tell.report(Report::Resumed);
            }
            Order::Skip => self.work.measuring(|m| m.run.skip()),
            Order::Repeat(label) => self.work.measuring(|m| {
                m.run.repeat(label);
            }),
            Order::LaserDistance(label, distance_m) => {
                if let Some(laser) = &connection.asked {
                    laser.answer(label, distance_m)?;
                }
            }
            Order::Stored(label) => self.work.measuring(|m| m.run.confirm_stored(label)),
            Order::Connect(..) | Order::Disconnect | Order::Watch(_) | Order::Speed(_) => {}
        }
        Ok(())
    }

    fn connect(&mut self, rig: Box<Rig>, document: u64) -> Result<(), LinkError> {
        self.close(BY_OPERATOR);
        let opened = rig.open(self.speed).map_err(|error| match error {
            OpenError::Link(error) => error,
            OpenError::Read(error) => LinkError::Setup(error.to_string()),
        })?;
        let mut controller = opened.controller;
        controller.connect()?;
        let parameters = controller.parameters()?;
        let identity = controller.identity();
        self.connection = Some(Connection {
            controller,
            asked: opened.asked,
            instrument: opened.instrument,
            clock: opened.clock,
            whereabouts: Whereabouts::of(rig.robot()),
            rig: rig.clone(),
        });
        self.tell.report(Report::Connected {
            identity,
            parameters,
            rig,
            document,
        });
        Ok(())
    }

    /// Stops the platform, ends the connection and says so.
    fn end(&mut self, why: Option<String>) {
        if self.close(why.as_deref().unwrap_or(BY_OPERATOR)) {
            self.show(true);
            self.tell.report(Report::Disconnected(why));
        }
    }

    /// Stops the platform and ends the connection; whether there was one. What goes on ends with the reason `why`.
    fn close(&mut self, why: &str) -> bool {
        let ended = self.work.abort(why);
        ended.into_iter().for_each(|r| self.tell.report(r));
        let connection = self.connection.take();
        connection.is_some_and(|mut connection| {
            // The connection ends either way, and a lost connection stops the drives.
            let _ = connection.controller.stop();
            connection.controller.disconnect();
            true
        })
    }

    fn write(&mut self, values: Vec<(String, f64)>, purpose: Purpose) {
        let Some(connection) = &mut self.connection else {
            return;
        };
        let written = write_adjustment(&mut connection.controller, &values);
        let holds = connection.controller.parameters().ok();
        self.tell.report(Report::Written {
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
        let controller = &mut connection.controller;
        let reports = match &mut self.work {
            Work::None => {
                if self.watches && self.tell.is_due() {
                    // What is wrong with a reading nobody waits for shows in the state.
                    let _ = controller.sample();
                }
                Vec::new()
            }
            Work::Measuring(measuring) => measuring.tick(controller, connection.clock.now_s()),
            Work::Verifying(verifying) => match &mut connection.instrument {
                Some(instrument) => verifying.tick(controller, instrument.as_mut()),
                None => Vec::new(),
            },
        };
        if self.work.has_ended() {
            self.work = Work::None;
        }
        for report in reports {
            self.tell.report(report);
        }
        if connection.controller.state().activity == Activity::Disconnected {
            self.end(Some("the connection to the controller is lost".to_owned()));
        }
    }

    /// Puts what is going on where the window finds it; `changed`: at once.
    fn show(&mut self, changed: bool) {
        if !changed && !self.tell.is_due() && self.work.needs_ticks() {
            return;
        }
        let live = match &mut self.connection {
            None => Live::default(),
            Some(connection) => {
                let sample = connection.controller.last().cloned();
                let whereabouts = connection.whereabouts.as_mut();
                let pose = whereabouts
                    .zip(sample.as_ref())
                    .map(|(w, s)| w.of_sample(s));
                Live {
                    state: Some(connection.controller.state()),
                    pose,
                    sample,
                    doing: self.work.doing(),
                    remaining: self.work.remaining(),
                }
            }
        };
        *self
            .tell
            .live
            .lock()
            .unwrap_or_else(PoisonError::into_inner) = live;
        self.tell.wake();
    }
}

fn measuring(connection: &Connection, order: MeasuringOrder) -> Measuring {
    let rig = &connection.rig;
    let mut options = MeasuringOptions::of(rig.robot());
    options.tension = rig.tension();
    let run = MeasuringRun::new(order.plan, rig.robot(), options)
        .predicting(predict_by(&order.model, rig.tension()))
        .asking(connection.asked.clone())
        .continuing(&order.measured);
    let per_revolution = rig.robot().cables.iter();
    Measuring {
        remaining: run.remaining(),
        run,
        predictor: predict_by(&order.model, rig.tension()),
        per_revolution_m: per_revolution
            .map(|cable| cable.winch.cable_per_revolution_m())
            .collect(),
        doing: Doing::Moving,
    }
}
