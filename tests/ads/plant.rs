//! The controller's program and the robot behind the server: the simulated robot, commanded by what clients write.
//!
//! Simulated time advances with each count of the watchdog, that is, with each sample of an armed client, so that the
//! tests do not depend on the speed of the machine.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::thread::JoinHandle;
use std::time::Duration;

use serde_json::{Value, json};
use tautline_core::geometry::Pose;
use tautline_core::robot::presets::{self, Preset};
use tautline_link::ads::{AdsController, AdsOptions};
use tautline_link::simulated::{SimulatedRobot, SimulatedSetup, SimulatedTracker};
use tautline_link::{Activity, Controller, GuardedController, Limits, ManualClock, SystemClock};

use super::server::{Orders, Server, Written};
use super::symbols::{Place, Style, TURNS, declarations, global, mapping, places};

/// Simulated time of a sample (s).
const STEP_S: f64 = 0.05;
/// Simulated time of a sample where the program is the client: it samples at the rate of a real robot.
const LONG_STEP_S: f64 = 0.25;

/// A controller: the server with a simulated robot behind it.
pub struct Plant {
    /// The server.
    pub server: Server,
    /// The robot that is simulated.
    pub preset: Preset,
    /// The layout of the symbols.
    pub style: Style,
    tracker: Option<SimulatedTracker>,
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

    /// Starts a controller whose simulated time runs fast.
    ///
    /// # Panics
    /// If the server cannot be started.
    #[must_use]
    pub fn fast(style: Style) -> Self {
        Self::with(style, LONG_STEP_S, |_| ())
    }

    /// Starts a controller with changes to the simulated robot.
    ///
    /// # Panics
    /// If the server cannot be started.
    #[must_use]
    pub fn changed(style: Style, change: impl FnOnce(&mut SimulatedSetup)) -> Self {
        Self::with(style, STEP_S, change)
    }

    fn with(style: Style, step_s: f64, change: impl FnOnce(&mut SimulatedSetup)) -> Self {
        let preset = presets::find("mini").expect("a preset");
        let mut setup = SimulatedSetup::of_preset(&preset, 4);
        change(&mut setup);
        let clock = ManualClock::default();
        let mut robot = SimulatedRobot::new(setup, Arc::new(clock.clone())).expect("a robot");
        robot.connect().expect("connected");
        let tracker = robot.tracker(2e-5, 5e-5, 8);
        let server = Server::start();
        server.order(json!({ "declare": declarations(&preset.robot, style) }));
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
        };
        program.show();
        // Orders are carried out in turn: what is shown is there after this.
        server.order(json!({}));
        let (wrote, end) = (server.wrote(), Arc::clone(&ends));
        let worker = std::thread::spawn(move || program.run(&wrote, &end));
        Self {
            server,
            preset,
            style,
            tracker: Some(tracker),
            ends,
            worker: Some(worker),
        }
    }

    /// A client that respects the limits of the robot.
    ///
    /// # Panics
    /// If the mapping does not fit.
    #[must_use]
    pub fn client(&self) -> GuardedController<AdsController> {
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
    pub fn client_with(&self, options: AdsOptions) -> GuardedController<AdsController> {
        let mapping = mapping(&self.preset.robot, self.style);
        let controller = AdsController::new(
            self.server.address(),
            &mapping,
            &self.preset.robot,
            options,
            Arc::new(SystemClock::start()),
        );
        let limits = Limits {
            robot: self.preset.robot.clone(),
            workspace: self.preset.workspace,
            tension: self.preset.tension,
        };
        GuardedController::new(Box::new(controller.expect("a mapping that fits")), limits)
    }

    /// A connected and armed client.
    ///
    /// # Panics
    /// If the controller refuses.
    #[must_use]
    pub fn armed(&self) -> GuardedController<AdsController> {
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

impl Drop for Plant {
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
    places: Vec<Place>,
    written: BTreeMap<String, Vec<f64>>,
    acknowledged: f64,
    fault: Option<String>,
}

impl Program {
    fn run(&mut self, wrote: &Receiver<Written>, end: &AtomicBool) {
        while !end.load(Ordering::Relaxed) {
            match wrote.recv_timeout(Duration::from_millis(20)) {
                Ok((name, values)) => self.take(name, values),
                Err(RecvTimeoutError::Timeout) => continue,
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
            Some("watchdog") => self.clock.advance(self.step_s),
            Some("release") if first == 1.0 => {
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

    fn obey(&mut self) -> Result<(), tautline_link::LinkError> {
        let kind = self.written.get(&global("kind")).and_then(|v| v.first());
        match kind.copied().unwrap_or(0.0) as i64 {
            1 => self.robot.home(),
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

    /// Gives the robot the parameters that were written.
    fn take_parameters(&mut self) {
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

    fn show(&mut self) {
        let sample = self.robot.sample().expect("connected");
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
