//! Builds a dataset in code, as a program that reads its own controller would, and identifies the pulleys from it.
//!
//! `cargo run --release -p tautline-core --example identify`

use std::error::Error;

use nalgebra::Vector3;
use tautline_core::estimation::{Control, Options, Problem, rank_defects, solve};
use tautline_core::geometry::Twist;
use tautline_core::kinematics::inverse_kinematics;
use tautline_core::measurement::{Dataset, Grid, Measurements};
use tautline_core::robot::{Robot, presets};

/// Poses measured besides home.
const POSES: usize = 30;

fn main() -> Result<(), Box<dyn Error>> {
    let drawing = presets::find("mini")
        .ok_or("there is no such preset")?
        .robot;
    // The robot as it was built: every pulley is 8 mm off the drawing, along one axis or another.
    let mut built = drawing.clone();
    for (index, cable) in built.cables.iter_mut().enumerate() {
        cable.pulley.entry_point_m[index % 3] += 0.008;
    }

    let dataset = Dataset {
        measurements: measure(&built)?,
        robot: drawing,
    };
    let problem = Problem::new(&dataset)?;
    let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue)?;
    if !solution.converged() {
        return Err(format!("no convergence: {:?}", solution.termination).into());
    }

    let steps = solution.iterations;
    println!(
        "converged in {steps} steps, chi-square {:.1} for {:.0} degrees of freedom",
        solution.chi2, solution.degrees_of_freedom
    );
    for defect in rank_defects(&problem, &solution) {
        println!("open: {}", defect.sentence);
    }
    for (found, cable) in solution.globals.entry_points.iter().zip(&built.cables) {
        let error = Vector3::from(*found) - Vector3::from(cable.pulley.entry_point_m);
        println!("{}: off by {:.2} mm", cable.name, 1e3 * error.norm());
    }
    Ok(())
}

/// Readings of the encoders and the laser at home and at some poses, without noise; forces are not read.
fn measure(robot: &Robot) -> Result<Measurements, Box<dyn Error>> {
    let laser = robot.laser.ok_or("the robot has no laser")?;
    let home = robot.home.ok_or("the robot has no home pose")?.pose();
    let mut measurements = Measurements {
        revolutions: Grid::new(robot.cable_count()),
        ..Measurements::default()
    };
    let home_lengths = inverse_kinematics(robot, &home)?;
    for label in 0..=POSES {
        // Oscillations with different periods fill the workspace; the first pose is home.
        let swing = |period: f64, size: f64| size * (label as f64 / period).sin();
        let (x, y, z) = (swing(1.1, 0.15), swing(1.7, 0.12), swing(2.9, 0.15));
        let (rx, ry, rz) = (swing(1.3, 0.2), swing(2.3, 0.2), swing(3.1, 0.2));
        let pose = home.perturbed(&Twist::new(x, y, z, rx, ry, rz));

        let states = inverse_kinematics(robot, &pose)?;
        let paid_out = states.iter().zip(&home_lengths);
        let revolutions: Vec<f64> = paid_out
            .zip(&robot.cables)
            .map(|((state, at_home), cable)| {
                (state.length_m - at_home.length_m) / cable.winch.cable_per_revolution_m()
            })
            .collect();
        let origin = pose.position + pose.orientation * Vector3::from(laser.origin_m);
        let direction = pose.orientation * Vector3::from(laser.direction);
        let normal = Vector3::from(laser.target_plane.normal);
        let distance = (laser.target_plane.offset_m - normal.dot(&origin)) / normal.dot(&direction);

        measurements.labels.push(i64::try_from(label)?);
        measurements.commanded.push(Some(pose));
        measurements.revolutions.push_row(&revolutions);
        measurements.laser_m.push(distance);
    }
    Ok(measurements)
}
