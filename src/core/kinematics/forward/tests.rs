//! Tests of the forward kinematics.

use super::super::inverse_kinematics;
use super::super::samples::{self, Kind};
use super::*;
use crate::geometry::Twist;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

fn lengths(robot: &Robot, pose: &Pose) -> Option<Vec<f64>> {
    let states = inverse_kinematics(robot, pose).ok()?;
    Some(states.iter().map(|state| state.length_m).collect())
}

/// A pose in the workspace: within half the frame's half widths about the centre, each component
/// of the rotation vector up to 0.5 rad.
fn random_pose(rng: &mut ChaCha8Rng, robot: &Robot, centre: &Pose, half: [f64; 3]) -> Pose {
    let free = robot.platform.freedom();
    let twist = Twist::from_fn(|k, _| {
        let scale = if k < 3 { half[k] } else { 0.5 };
        scale * rng.random_range(-1.0..1.0)
    });
    let free_part: Vec<f64> = free
        .coordinates()
        .iter()
        .map(|c| twist[c.index()])
        .collect();
    centre.perturbed(&free.expand(&free_part))
}

const KINDS: [(Kind, [f64; 3]); 3] = [
    (Kind::Spatial, [0.25, 0.19, 0.22]),
    (Kind::Planar, [0.4, 0.3, 0.0]),
    (Kind::PointMass, [0.75, 0.5, 0.7]),
];

#[derive(Debug, Default)]
struct Tally {
    right: usize,
    second_solution: usize,
    flagged: usize,
    wrong: usize,
    further_starts: usize,
    starts: usize,
    iterations: usize,
}

fn tally(kind: Kind, half: [f64; 3], count: usize, limit: Option<f64>) -> Tally {
    let robot = samples::of_kind(kind, 0.02);
    let mut solver = ForwardKinematics::new(&robot).unwrap();
    if let Some(limit) = limit {
        solver = solver.with_residual_limit(limit);
    }
    let mut rng = samples::generator(31);
    let mut tally = Tally::default();
    for _ in 0..count {
        let pose = random_pose(&mut rng, &robot, solver.centre(), half);
        let Some(lengths) = lengths(&robot, &pose) else {
            continue;
        };
        let found = solver.solve_from_anywhere(&lengths);
        tally.further_starts += usize::from(found.starts_used > 1);
        tally.starts += found.starts_used;
        tally.iterations += found.iterations;
        let off = found.pose.difference(&pose).norm();
        if !found.converged {
            tally.flagged += 1;
        } else if off < 1e-8 {
            tally.right += 1;
        } else if found.residual_rms_m < 1e-10 {
            tally.second_solution += 1;
        } else {
            tally.wrong += 1;
        }
    }
    tally
}

#[test]
fn converges_from_the_centre_of_the_workspace() {
    for (kind, half) in KINDS {
        for limit in [None, Some(0.01)] {
            let tally = tally(kind, half, 5000, limit);
            println!("{kind:?} {limit:?}: {tally:?}");
        }
    }
}
