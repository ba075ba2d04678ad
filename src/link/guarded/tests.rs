//! Tests of the station around simulated controllers and one that breaks every rule.

use std::sync::{Arc, Mutex};

use tautline_core::robot::presets::Preset;

use super::*;
use crate::laser::LaserReading;
use crate::simulated::Fault;
use crate::testing::{armed, limits, preset};

#[test]
fn an_overloaded_cable_stops_every_motion_until_the_operator_has_decided() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let mut target = preset.workspace.centre;
    target.position.x += 0.15;
    robot.command(&target).unwrap();
    clock.advance(0.5);
    let overload = Fault::Tension {
        cable: 1,
        reading_n: 400.0,
    };
    robot.inner_mut().set_faults(vec![overload]);
    let told = robot.sample().unwrap_err().to_string();
    assert!(
        told.contains("cable-2 pulls with 200 N, at most 150 N"),
        "{told}"
    );
    assert_eq!(robot.last().unwrap().force_n[1], 400.0);
    assert_eq!(robot.state().activity, Activity::Still);
    // As long as the cable is overloaded, for every command.
    for _ in 0..2 {
        assert_eq!(robot.sample().unwrap_err().to_string(), told);
        robot.command(&target).unwrap();
        clock.advance(0.01);
        assert!(robot.sample().is_err());
        assert_eq!(robot.state().activity, Activity::Still);
    }
    robot.accept_overload();
    robot.command(&target).unwrap();
    clock.advance(0.01);
    assert!(robot.sample().is_ok());
    assert_eq!(robot.state().activity, Activity::Moving);
    // An accepted overload must not increase, and has to be accepted again after it has ended.
    let pulling = |reading_n| {
        vec![Fault::Tension {
            cable: 1,
            reading_n,
        }]
    };
    robot.inner_mut().set_faults(pulling(420.0));
    assert!(robot.sample().is_err());
    robot.inner_mut().set_faults(Vec::new());
    assert!(robot.sample().is_ok());
    robot.inner_mut().set_faults(pulling(400.0));
    assert!(robot.sample().is_err());
}

#[test]
fn a_restarted_controller_is_only_sent_home() {
    let preset = preset("mini");
    let pose = preset.workspace.centre;
    let mut station = Bad::station(&preset);
    station.inner.sample.started = Some(3.0);
    station.connect().unwrap();
    station.sample().unwrap();
    station.disconnect();
    station.inner.sample.started = Some(4.0);
    station.connect().unwrap();
    station.arm().unwrap();
    assert!(station.sample().is_ok(), "it was noticed when it was armed");
    let told = station.command(&pose).unwrap_err();
    assert!(matches!(told, LinkError::Restarted(_)), "{told}");
    station.home().unwrap();
    assert_eq!(station.command(&pose), Ok(()));
    // A restart within a connection disarms.
    station.sample().unwrap();
    station.inner.sample.started = Some(5.0);
    assert!(matches!(station.sample(), Err(LinkError::Restarted(_))));
    assert!(!station.state().armed);
}

/// A controller that obeys every command, armed or not, and reconnects on its own.
struct Bad {
    sample: Sample,
    activity: Activity,
    armed: bool,
    /// Whether arming succeeds.
    arms: bool,
    loses: bool,
    /// Commands that reached the controller.
    heard: Vec<&'static str>,
}

impl Bad {
    fn station(preset: &Preset) -> GuardedController<Self> {
        let cables = preset.robot.cable_count();
        let sample = Sample {
            time_s: 0.0,
            revolutions: vec![0.0; cables],
            force_n: vec![40.0; cables],
            laser_m: Some(0.5),
            temperature_c: None,
            swivel_rad: None,
            inclination_rad: None,
            commanded: None,
            started: None,
        };
        let bad = Self {
            sample,
            activity: Activity::Still,
            armed: true,
            arms: true,
            loses: false,
            heard: Vec::new(),
        };
        GuardedController::new(Box::new(bad), limits(preset))
    }

    fn hear(&mut self, what: &'static str) -> Result<(), LinkError> {
        if self.loses {
            return Err(LinkError::Disconnected("it broke".to_owned()));
        }
        self.heard.push(what);
        Ok(())
    }
}

impl Controller for Bad {
    fn identity(&self) -> String {
        "bad".to_owned()
    }
    fn connect(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
    fn disconnect(&mut self) {}
    fn state(&self) -> ControllerState {
        ControllerState {
            activity: self.activity.clone(),
            armed: self.armed,
        }
    }
    fn arm(&mut self) -> Result<(), LinkError> {
        self.armed = self.arms;
        Ok(())
    }
    fn disarm(&mut self) {
        self.armed = false;
        self.heard.push("disarm");
    }
    fn sample(&mut self) -> Result<Sample, LinkError> {
        self.hear("sample")?;
        Ok(self.sample.clone())
    }
    fn home(&mut self) -> Result<(), LinkError> {
        self.hear("home")
    }
    fn command(&mut self, _: &Pose) -> Result<(), LinkError> {
        self.hear("command")
    }
    fn stop(&mut self) -> Result<(), LinkError> {
        self.hear("stop")
    }
    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, LinkError> {
        Ok(Vec::new())
    }
    fn read(&mut self, names: &[String]) -> Result<Vec<f64>, LinkError> {
        Ok(vec![0.0; names.len()])
    }
    fn write(&mut self, _: &[(String, f64)]) -> Result<(), LinkError> {
        self.hear("write")
    }
}

/// Results of the commands that only an armed station passes on.
fn moves_and_writes(
    station: &mut GuardedController<Bad>,
    pose: &Pose,
) -> [Result<(), LinkError>; 3] {
    let values = [("laser.target_plane.offset_m".to_owned(), 0.5)];
    [
        station.home(),
        station.command(pose),
        station.write(&values),
    ]
}

#[test]
fn nothing_moves_unless_it_was_armed_here() {
    let preset = preset("mini");
    let pose = preset.workspace.centre;
    let mut station = Bad::station(&preset);
    // The controller says it is armed, and would obey.
    for refused in moves_and_writes(&mut station, &pose) {
        assert_eq!(refused, Err(LinkError::NotArmed));
    }
    assert_eq!(station.inner.heard, ["disarm"]);
    station.connect().unwrap();
    assert!(!station.state().armed);
    station.arm().unwrap();
    assert!(station.state().armed);
    for done in moves_and_writes(&mut station, &pose) {
        assert_eq!(done, Ok(()));
    }
    assert_eq!(station.inner.heard, ["disarm", "home", "command", "write"]);
    station.disarm();
    for refused in moves_and_writes(&mut station, &pose) {
        assert_eq!(refused, Err(LinkError::NotArmed));
    }
}

#[test]
fn a_connection_that_comes_back_by_itself_is_not_armed() {
    let preset = preset("mini");
    let pose = preset.workspace.centre;
    // The loss appears in the state, or in an answer.
    let losses: [fn(&mut GuardedController<Bad>); 4] = [
        |station| {
            station.inner.activity = Activity::Disconnected;
            assert!(!station.state().armed);
            station.inner.activity = Activity::Still;
        },
        |station| {
            station.inner.loses = true;
            assert!(station.sample().is_err());
            station.inner.loses = false;
        },
        |station| {
            station.inner.armed = false;
            assert!(!station.state().armed);
            station.inner.armed = true;
        },
        |station| {
            station.inner.sample.time_s = 100.0;
            station.sample().unwrap();
            station.inner.sample.time_s = 1.0;
            let told = station.sample().unwrap_err().to_string();
            assert!(told.contains("its clock ran backwards"), "{told}");
            station.sample().unwrap();
            station.inner.armed = true;
        },
    ];
    for lose in losses {
        let mut station = Bad::station(&preset);
        station.connect().unwrap();
        station.arm().unwrap();
        lose(&mut station);
        assert!(!station.state().armed);
        for refused in moves_and_writes(&mut station, &pose) {
            assert_eq!(refused, Err(LinkError::NotArmed));
        }
        assert!(!station.inner.armed, "the controller is disarmed, too");
        station.connect().unwrap();
        assert!(!station.state().armed);
        station.arm().unwrap();
        station.home().unwrap();
        assert_eq!(station.command(&pose), Ok(()));
        // Connecting while it is connected disarms.
        station.connect().unwrap();
        assert!(!station.state().armed && !station.inner.armed);
    }
}

#[test]
fn arming_is_believed_only_where_it_shows() {
    let preset = preset("mini");
    let mut station = Bad::station(&preset);
    station.connect().unwrap();
    station.inner.arms = false;
    assert!(matches!(station.arm(), Err(LinkError::Refused(_))));
    station.inner.arms = true;
    station.inner.activity = Activity::Disconnected;
    assert!(station.arm().is_err_and(|e| e.is_disconnection()));
    station.inner.activity = Activity::Fault("hot".to_owned());
    assert_eq!(station.arm(), Err(LinkError::Fault("hot".to_owned())));
    assert!(!station.state().armed);
}

#[test]
fn what_is_no_pose_or_no_number_does_not_reach_the_controller() {
    let preset = preset("mini");
    let mut station = Bad::station(&preset);
    station.connect().unwrap();
    station.arm().unwrap();
    let before = station.inner.heard.len();
    for value in [f64::NAN, f64::INFINITY, 1e9] {
        let mut pose = preset.workspace.centre;
        pose.position.y = value;
        assert!(matches!(station.command(&pose), Err(LinkError::Limit(_))));
        let values = [("home.x_m".to_owned(), value)];
        assert_eq!(station.write(&values).is_err(), !value.is_finite());
    }
    assert_eq!(station.inner.heard[before..], ["write"]);
}

#[test]
fn samples_have_the_channels_of_the_robot() {
    let preset = preset("mini");
    let mut station = Bad::station(&preset);
    station.connect().unwrap();
    assert!(station.sample().is_ok() && station.last().is_some());
    station.inner.sample.revolutions.pop();
    let told = station.sample().unwrap_err().to_string();
    assert!(
        told.contains("7 revolutions for a robot with 8 cables"),
        "{told}"
    );
    station.inner.sample.revolutions.push(0.0);
    station.inner.sample.force_n.clear();
    assert!(station.sample().is_ok());
    station.inner.sample.force_n.push(40.0);
    assert!(station.sample().is_err());
    station.inner.sample.force_n.clear();
    station.inner.sample.time_s = f64::NAN;
    assert!(station.sample().is_err());
    station.disconnect();
    assert_eq!(station.last(), None);
}

/// A laser that shows what the test sets; leaving a place clears it.
#[derive(Clone, Default)]
struct Shown {
    reading: Arc<Mutex<Option<LaserReading>>>,
    connects: bool,
}

impl LaserSource for Shown {
    fn identity(&self) -> String {
        "shown".to_owned()
    }
    fn connect(&mut self) -> Result<(), LinkError> {
        match self.connects {
            true => Ok(()),
            false => Err(LinkError::Laser("it is not there".to_owned())),
        }
    }
    fn disconnect(&mut self) {}
    fn latest(&self) -> Option<LaserReading> {
        *self.reading.lock().unwrap()
    }
    fn max_age_s(&self) -> f64 {
        1.0
    }
    fn discard_reading(&mut self) {
        *self.reading.lock().unwrap() = None;
    }
    fn problem(&self) -> Option<String> {
        Some("it blinks".to_owned())
    }
}

#[test]
fn a_laser_beside_the_controller_stands_in_for_its_own() {
    let preset = preset("mini");
    let laser = Shown {
        connects: true,
        ..Shown::default()
    };
    let set = |age_s: f64, distance_m: Option<f64>| {
        *laser.reading.lock().unwrap() = Some(LaserReading { age_s, distance_m });
    };
    let mut station = Bad::station(&preset).with_laser(Some(Box::new(laser.clone())));
    station.connect().unwrap();
    assert_eq!(station.sample().unwrap().laser_m, None);
    set(0.5, Some(0.7));
    assert_eq!(station.sample().unwrap().laser_m, Some(0.7));
    for (age_s, distance_m) in [
        (1.5, Some(0.7)),
        (f64::NAN, Some(0.7)),
        (0.5, None),
        (0.5, Some(f64::NAN)),
        (0.5, Some(-0.1)),
    ] {
        set(age_s, distance_m);
        assert_eq!(station.sample().unwrap().laser_m, None);
    }
    assert_eq!(station.laser_problem(), Some("it blinks".to_owned()));
    station.arm().unwrap();
    for way in [Controller::home, |s: &mut GuardedController<Bad>| {
        let centre = s.limits().workspace.centre;
        s.command(&centre)
    }] {
        set(0.5, Some(0.7));
        way(&mut station).unwrap();
        assert_eq!(station.sample().unwrap().laser_m, None);
    }
}

#[test]
fn without_its_laser_there_is_no_connection() {
    let laser = Box::new(Shown::default());
    let mut station = Bad::station(&preset("mini")).with_laser(Some(laser));
    let told = station.connect().unwrap_err().to_string();
    assert_eq!(told, "the laser distance sensor: it is not there");
}

/// A robot with narrow limits, and two poses: the direct way between them cannot be held, and those over home can.
fn around_a_corner() -> (Preset, Pose, Pose) {
    use rand::SeedableRng;
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(2);
    for width in [0.5, 0.3, 0.2, 0.1] {
        // Higher up than it may go: near the pulleys it can be held, and amid them it cannot.
        let mut preset = preset("suspended");
        preset.workspace.centre.position.z = 5.0;
        preset.workspace.half_extent_m = [13.0, 8.0, 5.0];
        let range = &mut preset.tension;
        range.upper_n = range.lower_n + width * (range.upper_n - range.lower_n);
        range.reference_n = (range.lower_n + range.upper_n) / 2.0;
        let limits = limits(&preset);
        let home = preset.robot.home.unwrap().pose();
        let way = |a: &Pose, b: &Pose| limits.check_way(a, b).is_ok();
        let drawn = (0..2000).map(|_| preset.workspace.draw(&preset.robot, &mut rng));
        let held = drawn.filter(|pose| limits.check_pose(pose).is_ok());
        let ends: Vec<Pose> = held.filter(|p| way(&home, p) && way(p, &home)).collect();
        let found = ends.chunks_exact(2).find(|ends| {
            limits.check_pose(&home).is_ok() && !way(&ends[0], &ends[1]) && !way(&ends[1], &ends[0])
        });
        if let Some(ends) = found {
            let (from, to) = (ends[0], ends[1]);
            return (preset, from, to);
        }
    }
    panic!("no such poses");
}

#[test]
fn a_pose_whose_way_cannot_be_held_is_reached_over_home() {
    let (preset, from, to) = around_a_corner();
    let home = preset.robot.home.unwrap().pose();
    let (mut robot, clock) = armed(&preset, |_| ());
    let arrive = |robot: &mut GuardedController<_>| {
        let mut visited = Vec::new();
        loop {
            clock.advance(0.05);
            visited.extend(robot.sample().unwrap().commanded);
            visited.dedup();
            if robot.state().activity == Activity::Still {
                return visited;
            }
        }
    };
    robot.command(&from).unwrap();
    assert_eq!(arrive(&mut robot), [from]);
    robot.command(&to).unwrap();
    assert_eq!(robot.state().activity, Activity::Moving);
    assert_eq!(arrive(&mut robot), [home, to]);
    // Stopped on the way, it does not go on, and the next way begins where its encoders say that it is.
    robot.command(&from).unwrap();
    clock.advance(0.1);
    robot.sample().unwrap();
    robot.stop().unwrap();
    assert_eq!(robot.state().activity, Activity::Still);
    clock.advance(5.0);
    assert_eq!(robot.sample().unwrap().commanded, Some(home));
    robot.command(&to).unwrap();
    assert_eq!(arrive(&mut robot).last(), Some(&to));
    // Where no way can be held the pose is not commanded, and named.
    let mut narrow = limits(&preset);
    narrow.robot.home = None;
    let (inner, clock) = armed(&preset, |_| ());
    let mut robot = GuardedController::new(inner.inner, narrow);
    robot.connect().unwrap();
    robot.arm().unwrap();
    robot.sample().unwrap();
    robot.command(&from).unwrap();
    clock.advance(60.0);
    let refused = robot.command(&to).unwrap_err().to_string();
    assert!(refused.contains("on the way to position ("), "{refused}");
}
