//! Equilibrium pose of a platform that hangs on fewer cables than it has degrees of freedom.

use anyhow::{Result, ensure};
use nalgebra::{DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use tautline_core::geometry::{Pose, Twist};
use tautline_core::kinematics::{applied_wrench, equilibrium_residual, inverse_kinematics};
use tautline_core::robot::Robot;
use tautline_core::simulation::{
    Simulated, SimulationOptions, TensionRange, TrueGeometry, simulate,
};

use super::conditions::normal;
use super::robots::TestRobot;

/// Maximum number of Newton steps.
const MAX_STEPS: usize = 60;
/// Step of numerical derivatives (m, rad).
const DIFFERENCE: f64 = 1e-6;

/// Simulates a hanging robot without noise. Its true geometry is drawn at random, and its poses are those at which it
/// comes to rest.
///
/// # Errors
/// If it does not come to rest or tensions are out of range.
pub fn simulated(
    robot: &TestRobot,
    options: &SimulationOptions,
    rng: &mut ChaCha8Rng,
) -> Result<Simulated> {
    let description = &robot.preset.robot;
    let mut truth = description.clone();
    for cable in &mut truth.cables {
        let sd = cable.pulley.entry_point_sd_m.each();
        for (value, sd) in cable.pulley.entry_point_m.iter_mut().zip(sd) {
            *value += normal(rng, sd.unwrap_or(0.0));
        }
        cable.pulley.entry_point_sd_m = tautline_core::robot::PerAxis::known(0.0);
    }
    let range = &robot.preset.tension;
    let centre = robot.preset.workspace.centre;
    let home = at_rest(&truth, &centre, range)?;
    let mut stated = description.clone();
    if let (Some(true_home), Some(stated)) = (&mut truth.home, &mut stated.home) {
        let sd = [stated.position_sd_m, stated.orientation_sd_rad];
        let off = home.perturbed(&Twist::from_fn(|k, _| normal(rng, sd[k / 3])));
        (true_home.position_m, true_home.orientation_wxyz) =
            (home.position.into(), home.orientation_wxyz());
        (true_home.position_sd_m, true_home.orientation_sd_rad) = (0.0, 0.0);
        (stated.position_m, stated.orientation_wxyz) =
            (off.position.into(), off.orientation_wxyz());
    }
    let mut poses = Vec::new();
    while poses.len() < robot.poses {
        let target = robot.preset.workspace.draw(&truth, rng);
        let level = Pose {
            orientation: centre.orientation,
            ..target
        };
        poses.extend(at_rest(&truth, &level, range));
    }
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        at: Some(poses),
        ..options.clone()
    };
    let mut run = simulate(&truth, &options)?;
    for (cable, stated) in run.truth.cables.iter_mut().zip(&stated.cables) {
        cable.pulley.entry_point_sd_m = stated.pulley.entry_point_sd_m;
    }
    if let (Some(home), Some(stated)) = (&mut run.truth.home, &stated.home) {
        (home.position_sd_m, home.orientation_sd_rad) =
            (stated.position_sd_m, stated.orientation_sd_rad);
    }
    run.dataset.robot = stated;
    Ok(run)
}

/// Pose at which the platform rests if its cables have the geometric lengths that they have at `near`, by Newton's
/// method on lengths and equilibrium for pose and tensions together.
///
/// # Errors
/// If the iteration does not converge or a tension is out of range.
pub fn at_rest(robot: &Robot, near: &Pose, range: &TensionRange) -> Result<Pose> {
    let lengths = |pose: &Pose| -> Result<Vec<f64>> {
        Ok(inverse_kinematics(robot, pose)?
            .iter()
            .map(|c| c.length_m)
            .collect())
    };
    let cables = robot.cable_count();
    let wanted = lengths(near)?;
    let weight_n = applied_wrench(robot, near)?.norm();
    let off = |pose: &Pose, tensions: &[f64]| -> Result<DVector<f64>> {
        let mut off: Vec<f64> = lengths(pose)?
            .iter()
            .zip(&wanted)
            .map(|(l, w)| l - w)
            .collect();
        off.extend((equilibrium_residual(robot, pose, tensions)? / weight_n).iter());
        Ok(DVector::from_vec(off))
    };
    let (mut pose, mut tensions) = (*near, vec![range.reference_n; cables]);
    for _ in 0..MAX_STEPS {
        let now = off(&pose, &tensions)?;
        let mut slopes = DMatrix::zeros(cables + 6, cables + 6);
        for k in 0..6 {
            let mut step = Twist::zeros();
            step[k] = DIFFERENCE;
            let there = off(&pose.perturbed(&step), &tensions)?;
            slopes.set_column(k, &((there - &now) / DIFFERENCE));
        }
        for k in 0..cables {
            let mut more = tensions.clone();
            more[k] += 1.0;
            slopes.set_column(6 + k, &(off(&pose, &more)? - &now));
        }
        let Some(step) = slopes.lu().solve(&now) else {
            break;
        };
        let turn = step.rows(0, 6).amax();
        let part = (0.3 / turn).min(1.0);
        pose = pose.perturbed(&Twist::from_fn(|k, _| -part * step[k]));
        (0..cables).for_each(|k| tensions[k] -= part * step[6 + k]);
        if turn < 1e-13 {
            break;
        }
    }
    ensure!(
        off(&pose, &tensions)?.amax() < 1e-11,
        "it does not come to rest"
    );
    let held = tensions
        .iter()
        .all(|t| (range.lower_n..range.upper_n).contains(t));
    ensure!(held, "a cable would be slack or overloaded");
    Ok(pose)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::hidden::robots::robot;

    #[test]
    fn the_platform_hangs_level_in_the_middle_and_tilts_elsewhere() {
        let robot = robot("hanging").unwrap();
        let (description, range) = (&robot.preset.robot, &robot.preset.tension);
        let middle = robot.preset.workspace.centre;
        let rest = at_rest(description, &middle, range).unwrap();
        assert!(rest.difference(&middle).amax() < 1e-9, "{rest:?}");

        let moved = middle.perturbed(&Twist::new(0.2, -0.15, 0.1, 0.0, 0.0, 0.0));
        let rest = at_rest(description, &moved, range).unwrap();
        let lengths = |pose| inverse_kinematics(description, pose).unwrap();
        for (at_rest, level) in lengths(&rest).iter().zip(lengths(&moved)) {
            assert!((at_rest.length_m - level.length_m).abs() < 1e-9);
        }
        assert!(rest.difference(&moved).fixed_rows::<3>(3).amax() > 1e-3);
        // The centre of mass sinks when the platform comes to rest.
        let height = |pose: &Pose| {
            pose.transform(&description.platform.center_of_mass_m.into())
                .z
        };
        assert!(height(&rest) < height(&moved));
    }
}
