//! The controller's program and the robot behind the server: the simulated robot, commanded by what clients write.
//!
//! Simulated time advances with each count of the watchdog, that is, with each sample of an armed client, so that the
//! tests do not depend on the speed of the machine.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tautline_core::geometry::Pose;
use tautline_core::robot::presets::{self, Preset};
use tautline_link::ads::AdsOptions;
use tautline_link::simulated::{SimulatedRobot, SimulatedSetup, SimulatedTracker};
use tautline_link::symbols::SymbolController;
use tautline_link::{Activity, Controller, GuardedController, Limits, ManualClock};

use super::host::{Host, Orders, Written};
use super::server::{Protocol, Server};
use super::symbols::{ParameterElement, Style, TURNS, declarations, global, mapping, places};
use super::unruly::Unruly;

/// Simulated time of a sample (s).
const STEP_S: f64 = 0.05;
/// Time without a count of the watchdog after which the program ends the release; a little longer than that of the sample
/// program, as a machine that runs many tests at once is slow.
const WATCHDOG: Duration = Duration::from_secs(3);
/// Simulated time of a sample where the program is the client: it samples at the rate of a real robot.
const LONG_STEP_S: f64 = 0.25;

/// Differences between the values that the controller shows and those of its robot.
#[derive(Debug, Clone, Default)]
struct Shown {
    /// Added to all encoders until it is homed.
    revolutions: f64,
    /// Subtracted from the time (s).
    since_s: f64,
    /// Number of starts.
    starts: u32,
    /// The tension that a sensor shows instead of its own: cable and reading (N).
    force: Option<(usize, f64)>,
}

/// A controller: a server with a simulated robot behind it.
pub struct Plant<H: Host = Server> {
    /// The server.
    pub server: H,
    /// The robot that is simulated.
    pub preset: Preset,
    /// The layout of the symbols.
    pub style: Style,
    tracker: Option<SimulatedTracker>,
    shown: Arc<Mutex<Shown>>,
    ends: Arc<AtomicBool>,
    worker: Option<JoinHandle<()>>,
}

impl Plant {
    /// Starts a controller.
    ///
    /// # Panics
    /// If the server cannot be started.
    #[must_use]
    pub fn start(style: Style) -> Self {
        Self::changed(style, |_| ())
    }

    /// Starts a controller that speaks a protocol.
    ///
    /// # Panics
    /// If the server cannot be started.
    #[must_use]
    pub fn speaking(protocol: Protocol, style: Style) -> Self {
        Self::with(Server::start(protocol), (style, STEP_S), |_| ())
    }

    /// Starts an encrypted controller whose security is that of the script of its server; see there.
    ///
    /// # Panics
    /// If the server cannot be started.
    #[must_use]
    pub fn with_security(security: &Value, style: Style) -> Self {
        let server = Server::with_security(Protocol::OpcUaEncrypted, Some(security));
        Self::with(server, (style, STEP_S), |_| ())
    }

    /// Starts a controller whose simulated time runs fast.
    ///
    /// # Panics
    /// If the server cannot be started.
    #[must_use]
    pub fn fast(protocol: Protocol, style: Style) -> Self {
        Self::with(Server::start(protocol), (style, LONG_STEP_S), |_| ())
    }

    /// Starts a controller with changes to the simulated robot.
    ///
    /// # Panics
    /// If the server cannot be started.
    #[must_use]
    pub fn changed(style: Style, change: impl FnOnce(&mut SimulatedSetup)) -> Self {
        Self::with(Server::start(Protocol::Ads), (style, STEP_S), change)
    }
}

impl Plant<Unruly> {
    /// Starts a controller whose server can misbehave and whose simulated time runs fast.
    ///
    /// # Panics
    /// If the server cannot be started.
    #[must_use]
    pub fn unruly() -> Self {
        Self::with(Unruly::start(), (Style::Arrays, LONG_STEP_S), |_| ())
    }

    /// The controller starts anew: connections end, its time begins at 0, it counts one start more, and its encoders have
    /// lost their zero by so many revolutions.
    pub fn restart(&self, revolutions: f64) {
        self.server.down();
        let time_s = self.server.numbers(&global("time"))[0];
        self.change(|shown| {
            shown.revolutions += revolutions;
            shown.since_s += time_s;
            shown.starts += 1;
        });
        self.server
            .carry_out(json!({"set": {global("release"): [false]}}));
        self.server.up();
    }

    /// A force sensor shows this from now on: cable and reading (N); nothing: its own.
    pub fn show_force(&self, force: Option<(usize, f64)>) {
        self.change(|shown| shown.force = force);
    }

    /// Another client sends the robot somewhere.
    pub fn command_as_another(&self, kind: f64) {
        let number = self.server.numbers(&global("number"))[0];
        self.server.write_as_another(&global("kind"), &[kind]);
        self.server
            .write_as_another(&global("number"), &[number + 1.0]);
    }

    fn change(&self, change: impl FnOnce(&mut Shown)) {
        change(&mut self.shown.lock().unwrap_or_else(PoisonError::into_inner));
        // The program shows it after the next write.
        self.server.write_as_another(&global("shown"), &[0.0]);
        std::thread::sleep(Duration::from_millis(60));
    }
}

impl<H: Host> Plant<H> {
    fn with(
        server: H,
        (style, step_s): (Style, f64),
        change: impl FnOnce(&mut SimulatedSetup),
    ) -> Self {
        let preset = presets::find("mini").expect("a preset");
        let mut setup = SimulatedSetup::of_preset(&preset, 4);
        change(&mut setup);
        let clock = ManualClock::default();
        let mut robot = SimulatedRobot::new(setup, Arc::new(clock.clone())).expect("a robot");
        robot.connect().expect("connected");
        let tracker = robot.tracker(2e-5, 5e-5, 8);
        server.carry_out(json!({ "declare": declarations(&preset.robot, style) }));
        let shown = Arc::new(Mutex::new(Shown::default()));
        let ends = Arc::new(AtomicBool::new(false));
        let mut program = Program {
            robot,
            clock,
            step_s,
            style,
            orders: server.orders(),
            places: places(&preset.robot, style),
            written: BTreeMap::new(),
            acknowledged: 7.0,
            fault: None,
            shown: Arc::clone(&shown),
            counted: Instant::now(),
        };
        program.show();
        // Orders are carried out in turn: after this one, the values are shown.
        server.carry_out(json!({}));
        let (wrote, end) = (server.wrote(), Arc::clone(&ends));
        let worker = std::thread::spawn(move || program.run(&wrote, &end));
        Self {
            server,
            preset,
            style,
            tracker: Some(tracker),
            shown,
            ends,
            worker: Some(worker),
        }
    }

    /// A client that respects the limits of the robot.
    ///
    /// # Panics
    /// If the mapping does not fit.
    #[must_use]
    pub fn client(&self) -> GuardedController<SymbolController> {
        self.client_with(AdsOptions {
            // A machine that runs many tests at once is slow; the tests of slowness set their own.
            timeout_s: 20.0,
            acknowledge_s: 20.0,
            ..AdsOptions::default()
        })
    }

    /// A client with options of its own.
    ///
    /// # Panics
    /// If the mapping does not fit.
    #[must_use]
    pub fn client_with(&self, options: AdsOptions) -> GuardedController<SymbolController> {
        let mapping = mapping(&self.preset.robot, self.style);
        let controller = self.server.client(&mapping, &self.preset.robot, options);
        let limits = Limits {
            robot: self.preset.robot.clone(),
            workspace: self.preset.workspace,
            tension: self.preset.tension,
        };
        GuardedController::new(Box::new(controller), limits)
    }

    /// A connected and armed client.
    ///
    /// # Panics
    /// If the controller refuses.
    #[must_use]
    pub fn armed(&self) -> GuardedController<SymbolController> {
        let mut client = self.client();
        client.connect().expect("connected");
        client.arm().expect("armed");
        client
    }

    /// The external instrument that measures the platform.
    ///
    /// # Panics
    /// If it was taken before.
    pub fn tracker(&mut self) -> SimulatedTracker {
        self.tracker.take().expect("taken once")
    }
}

impl<H: Host> Drop for Plant<H> {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        if let Some(worker) = self.worker.take() {
            let _ = worker.join();
        }
    }
}

/// The program of the controller.
struct Program {
    robot: SimulatedRobot,
    clock: ManualClock,
    step_s: f64,
    style: Style,
    orders: Orders,
    places: Vec<ParameterElement>,
    written: BTreeMap<String, Vec<f64>>,
    acknowledged: f64,
    fault: Option<String>,
    shown: Arc<Mutex<Shown>>,
    /// Time of the last count of the watchdog.
    counted: Instant,
}

impl Program {
    fn run(&mut self, wrote: &Receiver<Written>, end: &AtomicBool) {
        while !end.load(Ordering::Relaxed) {
            match wrote.recv_timeout(Duration::from_millis(20)) {
                Ok((name, values)) => self.take(name, values),
                Err(RecvTimeoutError::Timeout) => {
                    self.end_stale_release();
                    continue;
                }
                Err(RecvTimeoutError::Disconnected) => return,
            }
            while let Ok((name, values)) = wrote.try_recv() {
                self.take(name, values);
            }
            self.take_parameters();
            self.show();
        }
    }

    fn take(&mut self, name: String, values: Vec<f64>) {
        let first = values.first().copied().unwrap_or(0.0);
        match name.strip_prefix("GVL_Tautline.") {
            Some("watchdog") => {
                self.counted = Instant::now();
                self.clock.advance(self.step_s);
            }
            Some("release") if first == 1.0 => {
                self.counted = Instant::now();
                self.fault = self.robot.arm().err().map(|e| e.to_string());
            }
            Some("release") => {
                self.robot.disarm();
                self.fault = None;
            }
            Some("number") if first != self.acknowledged => {
                self.fault = self.obey().err().map(|e| e.to_string());
                self.acknowledged = first;
            }
            _ => {
                self.written.insert(name, values);
            }
        }
    }

    fn end_stale_release(&mut self) {
        if self.robot.state().armed && self.counted.elapsed() > WATCHDOG {
            self.robot.disarm();
            self.orders
                .give(&json!({"set": {global("release"): [false]}}));
        }
    }

    fn obey(&mut self) -> Result<(), tautline_link::LinkError> {
        // Parameters written before a command apply to it, even if both are read at the same time.
        self.take_parameters();
        let kind = self.written.get(&global("kind")).and_then(|v| v.first());
        match kind.copied().unwrap_or(0.0) as i64 {
            1 => {
                self.shown().revolutions = 0.0;
                self.robot.home()
            }
            2 => {
                let target = self
                    .written
                    .get(&global("target"))
                    .map_or(&[][..], Vec::as_slice);
                let Ok([x, y, z, a, b, c, d]) = <[f64; 7]>::try_from(target) else {
                    let text = "the target has not seven values".to_owned();
                    return Err(tautline_link::LinkError::Refused(text));
                };
                self.robot
                    .command(&Pose::from_parts([x, y, z], [a, b, c, d]))
            }
            _ => self.robot.stop(),
        }
    }

    /// Gives the written parameters to the robot once it is at rest.
    fn take_parameters(&mut self) {
        if self.robot.state().activity == Activity::Moving {
            return;
        }
        let held = self.robot.parameters().expect("connected");
        let changed = self.places.iter().filter_map(|place| {
            let value = self.written.get(&place.symbol)?.get(place.element)? * place.scale;
            let known = held.iter().find(|p| p.name == place.name)?;
            (known.value != value).then(|| (place.name.clone(), value))
        });
        let changed: Vec<(String, f64)> = changed.collect();
        if !changed.is_empty() {
            let released = self.robot.state().armed;
            self.robot.arm().expect("armed");
            self.robot.write(&changed).expect("parameters that it has");
            if !released {
                self.robot.disarm();
            }
        }
    }

    fn shown(&self) -> MutexGuard<'_, Shown> {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn show(&mut self) {
        let mut sample = self.robot.sample().expect("connected");
        let shown = self.shown().clone();
        sample
            .revolutions
            .iter_mut()
            .for_each(|turns| *turns += shown.revolutions);
        sample.time_s -= shown.since_s;
        if let Some((cable, reading_n)) = shown.force {
            sample.force_n[cable] = reading_n;
        }
        let moving = self.robot.state().activity == Activity::Moving;
        let pose = sample.commanded.expect("a pose");
        let pose: Vec<f64> = pose
            .position
            .iter()
            .copied()
            .chain(pose.orientation_wxyz())
            .collect();
        let mut set = json!({
            global("laser"): [sample.laser_m.unwrap_or(0.0)],
            global("laser_valid"): [sample.laser_m.is_some()],
            global("temperature"): [sample.temperature_c.unwrap_or(0.0)],
            global("time"): [sample.time_s],
            global("pose"): pose,
            global("moving"): [moving],
            global("fault"): [u8::from(self.fault.is_some())],
            global("fault_text"): [self.fault.clone().unwrap_or_default()],
            global("acknowledged"): [self.acknowledged],
            global("started"): [f64::from(shown.starts)],
        });
        match self.style {
            Style::Arrays => {
                set[global("revolutions")] = json!(sample.revolutions);
                set[global("force")] = json!(sample.force_n);
            }
            Style::Single => {
                for (n, (turns, force)) in (1..).zip(sample.revolutions.iter().zip(&sample.force_n))
                {
                    let (scale, offset) = TURNS;
                    set[format!("Winch[{n}].turns")] = json!([(turns - offset) / scale]);
                    set[format!("Force{n}")] = json!([force]);
                }
            }
        }
        let order: Value = json!({ "set": set });
        self.orders.give(&order);
    }
}
