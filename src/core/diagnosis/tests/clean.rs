//! Clean data of robots unlike the presets, in which there is nothing to find.

use super::{diagnosed, found};
use crate::geometry::Coordinate;
use crate::robot::{PerAxis, Robot, Tracker, presets};
use crate::simulation::{Simulated, SimulationOptions, TrueGeometry, simulate};

/// MINI as a point, with tensions as low as its weight needs: all cables end at one place, so five tensions are redundant, and
/// the noise of a force sensor stretches a cable by more than the noise of its length.
fn run_of_point_mass(seed: u64) -> Simulated {
    let mut robot = presets::find("mini").unwrap().robot;
    robot.limits = None;
    robot.platform.free.truncate(3);
    for cable in &mut robot.cables {
        cable.platform_anchor_m = [0.0; 3];
    }
    simulate(&robot, &SimulationOptions::new(30, seed)).unwrap()
}

/// The noise of a tension reading is not taken for a dependence on the tension. A correct program finds something in one of the
/// six data sets with a probability of about 0.03; with readings in place of fitted tensions, five had a stiffness that depends on
/// tension.
#[test]
fn noise_of_tensions_is_no_cause() {
    for seed in 1..7 {
        let diagnosis = diagnosed(&run_of_point_mass(seed).dataset);
        assert!(diagnosis.findings.is_empty(), "{:?}", found(&diagnosis));
    }
}

/// A point in a vertical plane that hangs on two cables, without force sensors.
fn plotter() -> Robot {
    let mut robot = presets::find("mini").unwrap().robot;
    robot.limits = None;
    robot.laser = None;
    robot.platform.free = vec![Coordinate::X, Coordinate::Z];
    robot.cables.truncate(2);
    for (cable, side) in robot.cables.iter_mut().zip([-1.0, 1.0]) {
        cable.pulley.entry_point_m = [1.5 * side, 0.0, 1.2];
        cable.pulley.entry_point_sd_m = PerAxis::Each([Some(5e-3), Some(0.0), Some(5e-3)]);
        cable.pulley.swivel_axis = [0.0, 1.0, 0.0];
        cable.pulley.radius_m = 0.0;
        cable.platform_anchor_m = [0.0; 3];
        cable.force_sensor = None;
    }
    robot
}

/// Two lengths determine two coordinates, so any channels explain the readings: the mirror image of a plotter is one, too.
#[test]
fn readings_without_redundancy_are_no_exchanged_channels() {
    for seed in 1..4 {
        let run = simulate(&plotter(), &SimulationOptions::new(30, seed)).unwrap();
        let diagnosis = diagnosed(&run.dataset);
        assert!(diagnosis.findings.is_empty(), "{:?}", found(&diagnosis));
    }
}

/// If the places of the pulleys are unknown, a drawing with two pulleys interchanged explains the same readings as exchanged
/// channels.
#[test]
fn exchanged_pulleys_of_unknown_places_are_no_exchanged_channels() {
    let mut robot = plotter();
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(5e-4),
        orientation_sd_rad: None,
    });
    let mut places = robot.cables.iter().map(|c| c.pulley.entry_point_m);
    let mut exchanged: Vec<[f64; 3]> = places.by_ref().collect();
    exchanged.swap(0, 1);
    for cable in &mut robot.cables {
        cable.pulley.entry_point_sd_m = PerAxis::Each([None, Some(0.0), None]);
    }
    let options = SimulationOptions {
        geometry: TrueGeometry::EntryPoints(exchanged),
        ..SimulationOptions::new(30, 1)
    };
    let diagnosis = diagnosed(&simulate(&robot, &options).unwrap().dataset);
    assert!(diagnosis.findings.is_empty(), "{:?}", found(&diagnosis));
}
