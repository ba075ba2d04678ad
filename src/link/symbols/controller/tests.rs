//! A controller whose program runs in cycles, with a switch at the robot that revokes the release in the next one.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use tautline_core::robot::presets;

use super::super::access::{Content, Count, SymbolFound, SymbolValues};
use super::super::layout::RequiredSymbol;
use super::*;
use crate::clock::SystemClock;

/// The program and the memory behind it.
struct Plc {
    start: Instant,
    cycle_s: f64,
    cycles: u64,
    /// Cycle from which on the switch is off.
    off_from: u64,
    /// Whether the program has a symbol for its time.
    has_clock: bool,
    wanted: Vec<RequiredSymbol>,
    memory: BTreeMap<String, Vec<f64>>,
    /// Parameters that were written.
    written: usize,
}

impl Plc {
    /// Carries out the cycles that are due.
    fn run(&mut self) {
        let due = (self.start.elapsed().as_secs_f64() / self.cycle_s) as u64;
        if due == self.cycles {
            return;
        }
        self.cycles = due;
        if self.cycles >= self.off_from {
            self.set("release", 0.0);
        }
        if self.has_clock {
            self.set("time", self.cycles as f64 * self.cycle_s);
        }
    }

    fn set(&mut self, name: &str, value: f64) {
        let name = format!("GVL_Tautline.{name}");
        self.memory.insert(name, vec![value]);
    }
}

#[derive(Clone)]
struct Server(Arc<Mutex<Plc>>);

impl Server {
    fn plc(&self) -> MutexGuard<'_, Plc> {
        let mut plc = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        plc.run();
        plc
    }
}

impl SymbolServer for Server {
    fn place(&self) -> String {
        "a test".to_owned()
    }

    fn connect(&self) -> Result<Box<dyn SymbolAccess>, LinkError> {
        Ok(Box::new(self.clone()))
    }
}

impl SymbolAccess for Server {
    fn look_up(&mut self, wanted: &[RequiredSymbol]) -> Result<Vec<SymbolFound>, LinkError> {
        let mut plc = self.plc();
        plc.wanted = wanted.to_vec();
        for symbol in wanted {
            let (Count::Exactly(count) | Count::AtLeast(count)) = symbol.count;
            let held = plc.memory.entry(symbol.name.clone()).or_default();
            held.resize(count.max(held.len()), 0.0);
        }
        let type_name = || "LREAL".to_owned();
        let good = wanted.iter().map(|_| SymbolFound::Good {
            type_name: type_name(),
        });
        Ok(good.collect())
    }

    fn problem(&mut self) -> Result<Option<String>, Failure> {
        Ok(None)
    }

    fn check_unchanged(&mut self) -> Result<(), Failure> {
        Ok(())
    }

    fn read(&mut self, indices: &mut dyn Iterator<Item = usize>) -> Result<SymbolValues, Failure> {
        let plc = self.plc();
        let mut values = vec![None; plc.wanted.len()];
        for index in indices {
            let held = plc.memory[&plc.wanted[index].name].clone();
            values[index] = Some(Content::Numbers(held));
        }
        Ok(SymbolValues(values))
    }

    fn write(&mut self, values: &[(Slot, f64)]) -> Result<(), Failure> {
        let mut plc = self.plc();
        for (slot, value) in values {
            let name = plc.wanted[slot.symbol].name.clone();
            let is_parameter = !name.ends_with("release") && !name.ends_with("watchdog");
            plc.written += usize::from(is_parameter);
            let held = plc.memory.get_mut(&name).expect("a symbol");
            held[slot.element] = *value;
        }
        Ok(())
    }
}

/// A connected controller whose switch is off from a cycle on.
fn connected(cycle_s: f64, off_from: u64, has_clock: bool) -> (SymbolController, Server) {
    let robot = presets::find("mini").expect("a preset").robot;
    let server = Server(Arc::new(Mutex::new(Plc {
        start: Instant::now(),
        cycle_s,
        cycles: 0,
        off_from,
        has_clock,
        wanted: Vec::new(),
        memory: BTreeMap::new(),
        written: 0,
    })));
    let mut mapping = SymbolMapping::default_for(&robot);
    if !has_clock {
        mapping.readings.time = None;
    }
    let clock = Arc::new(SystemClock::start());
    let boxed = Box::new(server.clone());
    let mut controller =
        SymbolController::new(boxed, (&mapping, &robot), 2.0, clock).expect("a controller");
    controller.connect().expect("connected");
    (controller, server)
}

const VALUE: (&str, f64) = ("home.x_m", 0.01);

fn write(controller: &mut SymbolController) -> Result<(), LinkError> {
    controller.write(&[(VALUE.0.to_owned(), VALUE.1)])
}

/// Another client of the same controller.
fn another(server: &Server) -> SymbolController {
    let robot = presets::find("mini").expect("a preset").robot;
    let mapping = SymbolMapping::default_for(&robot);
    let clock = Arc::new(SystemClock::start());
    let boxed = Box::new(server.clone());
    let made = SymbolController::new(boxed, (&mapping, &robot), 2.0, clock);
    let mut controller = made.expect("a controller");
    controller.connect().expect("connected");
    controller
}

#[test]
fn a_release_of_another_program_refuses_arming() {
    let (mut controller, server) = connected(0.01, u64::MAX, true);
    server.plc().set("release", 1.0);
    server.plc().set("watchdog", 41.0);
    let told = controller.arm().expect_err("another is armed");
    assert!(matches!(told, LinkError::Occupied(_)), "{told}");
    assert_eq!(server.plc().memory["GVL_Tautline.release"], [1.0]);
    assert_eq!(server.plc().memory["GVL_Tautline.watchdog"], [41.0]);
    // The controller's watchdog has ended it.
    server.plc().set("release", 0.0);
    controller.arm().expect("armed");
    // A release that this program has set is its own, also on a new connection.
    controller.forget();
    controller.connect().expect("connected again");
    controller.arm().expect("armed again");
}

#[test]
fn of_two_programs_that_arm_at_once_at_most_one_is_armed() {
    for round in 0..12_u64 {
        let (mut one, server) = connected(0.01, u64::MAX, true);
        let mut two = another(&server);
        let (one_armed, two_armed) = std::thread::scope(|scope| {
            let first = scope.spawn(|| one.arm().is_ok());
            std::thread::sleep(std::time::Duration::from_millis(5 * round));
            let second = two.arm().is_ok();
            (first.join().expect("a thread"), second)
        });
        assert!(!(one_armed && two_armed), "round {round}");
        assert!(one_armed || two_armed, "round {round}");
    }
}

#[test]
fn nothing_is_written_beside_another_program_that_counts() {
    let (mut controller, server) = connected(0.01, u64::MAX, true);
    controller.arm().expect("armed");
    write(&mut controller).expect("written");
    controller.confirm_alone().expect("alone");
    assert_eq!(server.plc().written, 1);
    let own = server.plc().memory["GVL_Tautline.watchdog"][0];
    server.plc().set("watchdog", own + 1.0);
    let told = controller.confirm_alone().expect_err("another counts");
    assert!(matches!(told, LinkError::Occupied(_)), "{told}");
    assert!(write(&mut controller).is_err());
    assert!(!controller.state().armed);
    controller.disarm();
    // Not even the release, which is that of the other program.
    let plc = server.plc();
    assert_eq!(plc.written, 1);
    assert_eq!(plc.memory["GVL_Tautline.release"], [1.0]);
    assert_eq!(plc.memory["GVL_Tautline.watchdog"], [own + 1.0]);
}

#[test]
fn nothing_is_written_while_the_switch_is_off() {
    for (cycle_s, has_clock) in [
        (0.001, true),
        (0.01, true),
        (0.1, true),
        (0.4, true),
        (0.4, false),
    ] {
        let (mut controller, server) = connected(cycle_s, 0, has_clock);
        let told = controller.arm().expect_err("the switch is off").to_string();
        assert!(told.contains("turn on the switch"), "{cycle_s}: {told}");
        assert!(!controller.state().armed);
        assert_eq!(write(&mut controller), Err(LinkError::NotArmed));
        let plc = server.plc();
        assert_eq!(plc.written, 0, "{cycle_s}");
        assert_eq!(plc.memory["GVL_Tautline.release"], [0.0]);
    }
}

#[test]
fn a_release_that_stays_for_three_cycles_is_believed() {
    for cycle_s in [0.001, 0.2] {
        let (mut controller, server) = connected(cycle_s, u64::MAX, true);
        let begun = Instant::now();
        controller.arm().expect("armed");
        let least_s = f64::max(0.3, 2.0 * cycle_s);
        assert!(begun.elapsed().as_secs_f64() >= least_s, "{cycle_s}");
        write(&mut controller).expect("written");
        assert_eq!(server.plc().written, 1);
    }
}

#[test]
fn after_a_revoked_release_only_arming_permits_writing() {
    let (mut controller, server) = connected(0.01, u64::MAX, true);
    controller.arm().expect("armed");
    server.plc().set("release", 0.0);
    assert!(write(&mut controller).is_err());
    // The switch is on again, and another client sets the release.
    server.plc().set("release", 1.0);
    assert!(write(&mut controller).is_err());
    assert_eq!(server.plc().written, 0);
    controller.arm().expect("armed again");
    write(&mut controller).expect("written");
}

#[test]
fn a_clock_that_stands_still_confirms_nothing() {
    let (mut controller, server) = connected(0.01, u64::MAX, true);
    server.plc().has_clock = false;
    let told = controller.arm().expect_err("no cycles").to_string();
    assert!(told.contains("its time changed 0 times"), "{told}");
    assert_eq!(server.plc().memory["GVL_Tautline.release"], [0.0]);
}
