//! Plausibility checks of values that fit the format but not the robot: wrong units, missing home, unknown instruments.

use tautline_core::geometry::{Pose, Vec3};
use tautline_core::measurement::{Grid, Measurements};
use tautline_core::robot::{Cable, Robot};
use tautline_core::threads;

use super::column::{Group, PerCable};
use super::columns::Fault;

/// Largest position or length relative to the size of the frame: metres given in
/// millimetres exceed it by far, detours of a cable do not reach it.
const FRAME_SIZES: f64 = 10.0;
/// Largest laser distance relative to the size of the frame, as a laser may look far out of it.
const LASER_FRAME_SIZES: f64 = 30.0;
const FARTHEST_LASER_M: f64 = 1000.0;
/// Number of poses that one thread checks at a time, some milliseconds of work.
const REACHED_TOGETHER: usize = 1 << 14;

/// Checks that the home row is present if the encoders count from it.
pub(super) fn check_home(measurements: &Measurements, robot: &Robot) -> Result<(), Fault> {
    if robot.home.is_some()
        && !measurements.revolutions.is_empty()
        && measurements.home_row().is_none()
    {
        let message = "found no row with pose 0, expected the home row because the robot has a \
                       home and revolutions count from it";
        return Err(Fault::new(None, super::LABEL, message));
    }
    Ok(())
}

/// Checks that units are plausible and that cables can reach the poses.
pub(crate) fn check_plausible(measurements: &Measurements, robot: &Robot) -> Result<(), Fault> {
    let m = measurements;
    check_angles(m)?;
    check_temperature(&m.temperature_c)?;
    check_deviations(&m.tracked_position_sd_m)?;
    if let Some(size_m) = robot.frame_size_m() {
        check_positions(m, robot, size_m)?;
        check_lengths(m, robot, size_m)?;
        check_laser(&m.laser_m, size_m)?;
    }
    check_reach(&m.commanded, robot)
}

/// Checks that all cables have paths at all poses, on several threads if there are many poses.
fn check_reach(poses: &[Option<Pose>], robot: &Robot) -> Result<(), Fault> {
    let parts: Vec<_> = poses.chunks(REACHED_TOGETHER).collect();
    let first_fault = |part: usize| {
        let mut poses = parts[part].iter().enumerate();
        poses.find_map(|(index, pose)| {
            let error = robot.check_reach(pose.as_ref()?).err()?;
            Some((part * REACHED_TOGETHER + index, error.message))
        })
    };
    let threads = match parts.len() {
        0 | 1 => 1,
        _ => threads::available(),
    };
    let mut faults = threads::map(parts.len(), threads, first_fault).into_iter();
    match faults.find_map(|fault| fault) {
        Some((row, message)) => Fault::at(row, Group::Commanded.names()[0], message),
        None => Ok(()),
    }
}

fn check_positions(m: &Measurements, robot: &Robot, size_m: f64) -> Result<(), Fault> {
    let entry_points = robot
        .cables
        .iter()
        .map(|c| Vec3::from(c.pulley.entry_point_m));
    let centre = entry_points.sum::<Vec3>() / robot.cable_count() as f64;
    let check = |row: usize, position: &[f64; 3], names: &[&str]| {
        for k in 0..3 {
            if (position[k] - centre[k]).abs() > FRAME_SIZES * size_m {
                let message = format!(
                    "found {} m, far outside the frame of {size_m:.3} m: it looks like millimetres",
                    position[k]
                );
                return Fault::at(row, names[k], message);
            }
        }
        Ok(())
    };
    for (row, position) in m.tracked_position_m.iter().enumerate() {
        check(row, position, Group::Tracked.names())?;
    }
    for (row, pose) in m.commanded.iter().enumerate() {
        if let Some(pose) = pose {
            check(row, &pose.position.into(), Group::Commanded.names())?;
        }
    }
    for (row, pose) in m.truth.poses.iter().enumerate() {
        check(row, &pose.position.into(), Group::TruePose.names())?;
    }
    Ok(())
}

fn check_lengths(m: &Measurements, robot: &Robot, size_m: f64) -> Result<(), Fault> {
    let limit_m = FRAME_SIZES * size_m;
    for_each(&m.revolutions, PerCable::Revolutions, |value, cable| {
        let length_m = value * robot.cables[cable].winch.cable_per_revolution_m();
        (length_m.abs() > limit_m).then(|| {
            format!(
                "found {value} revolutions, {length_m:.1} m of cable in a frame of \
                 {size_m:.3} m: it looks like degrees or counts"
            )
        })
    })?;
    for_each(&m.length_m, PerCable::Length, |value, _| {
        if value <= 0.0 {
            return Some(format!("found {value}, expected a length greater than 0"));
        }
        (value > limit_m).then(|| {
            format!("found {value} m in a frame of {size_m:.3} m: it looks like millimetres")
        })
    })
}

fn for_each(
    grid: &Grid,
    quantity: PerCable,
    fault: impl Fn(f64, usize) -> Option<String>,
) -> Result<(), Fault> {
    for row in 0..grid.rows() {
        for (cable, value) in grid.row(row).iter().enumerate() {
            if let Some(message) = fault(*value, cable) {
                return Fault::at(row, quantity.name(cable + 1), message);
            }
        }
    }
    Ok(())
}

fn check_laser(laser_m: &[f64], size_m: f64) -> Result<(), Fault> {
    let limit_m = FARTHEST_LASER_M.min(LASER_FRAME_SIZES * size_m);
    for (row, value) in laser_m.iter().enumerate() {
        let message = if *value <= 0.0 {
            format!("found {value}, expected a distance greater than 0")
        } else if *value > limit_m {
            format!("found {value} m, expected at most {limit_m:.0} m: it looks like millimetres")
        } else {
            continue;
        };
        return Fault::at(row, "laser_m", message);
    }
    Ok(())
}

/// Angles in radians stay within one turn; in a recording, angles in degrees eventually do not.
fn check_angles(m: &Measurements) -> Result<(), Fault> {
    let fault = |angle: f64| {
        (angle.abs() > 6.3)
            .then(|| format!("found {angle} rad, more than one turn: it looks like degrees"))
    };
    for (row, angles) in m.inclination_rad.iter().enumerate() {
        for (angle, name) in angles.iter().zip(Group::Inclination.names()) {
            if let Some(message) = fault(*angle) {
                return Fault::at(row, *name, message);
            }
        }
    }
    for_each(&m.swivel_rad, PerCable::Swivel, |angle, _| fault(angle))
}

fn check_temperature(temperature_c: &[f64]) -> Result<(), Fault> {
    let strange = |value: &f64| *value < -100.0 || *value > 200.0;
    match temperature_c.iter().position(strange) {
        Some(row) => {
            let value = temperature_c[row];
            let message = format!("found {value}, expected degrees Celsius from -100 to 200");
            Fault::at(row, "temperature_c", message)
        }
        None => Ok(()),
    }
}

fn check_deviations(deviations: &[[f64; 3]]) -> Result<(), Fault> {
    for (row, values) in deviations.iter().enumerate() {
        for (value, name) in values.iter().zip(Group::TrackedSd.names()) {
            if *value <= 0.0 {
                let message = format!("found {value}, expected a number greater than 0");
                return Fault::at(row, *name, message);
            }
        }
    }
    Ok(())
}

/// Notices about readings for which the robot has no instrument.
pub(super) fn unused_readings(m: &Measurements, robot: &Robot) -> Vec<String> {
    let every = |has: fn(&Cable) -> bool| robot.cables.iter().all(has);
    let swivels = |c: &Cable| c.pulley.swivel_zero.is_some() && c.pulley.swivel_sd_rad.is_some();
    let tracked = !m.tracked_position_m.is_empty() || !m.tracked_orientation_wxyz.is_empty();
    // Whether it was measured, whether the robot has the instrument, the name of the reading and of the missing part.
    let readings = [
        (
            !m.laser_m.is_empty(),
            robot.laser.is_some(),
            "laser readings",
            "laser",
        ),
        (
            !m.inclination_rad.is_empty(),
            robot.inclinometer.is_some(),
            "roll, pitch and yaw",
            "inclinometer",
        ),
        (
            tracked,
            robot.tracker.is_some(),
            "measured poses",
            "tracker",
        ),
        (
            !m.force_n.is_empty(),
            every(|c| c.force_sensor.is_some()),
            "some force readings",
            "force_sensor on some cable",
        ),
        (
            !m.swivel_rad.is_empty(),
            every(swivels),
            "some swivel angles",
            "swivel_zero or swivel_sd_rad on some pulley",
        ),
    ];
    readings
        .into_iter()
        .filter(|(measured, explained, ..)| *measured && !explained)
        .map(|(_, _, what, lacks)| {
            format!(
                "{what} are kept, but identification does not use them, as the robot has no {lacks}"
            )
        })
        .collect()
}
