//! Tests of statics and tension distribution.

use super::super::length_gradients;
use super::super::samples::{self, Kind};
use super::*;
use crate::geometry::Coordinate;
use rand::RngExt;

/// The optimum by trying, for every cable, "at the lower limit", "at the upper limit" and "free".
/// The optimum is the stationary point of one of these choices, so the best admissible one is it.
fn by_enumeration(
    structure: &DMatrix<f64>,
    wrench: &DVector<f64>,
    reference: &[f64],
    lower: f64,
    upper: f64,
) -> Option<(f64, Vec<f64>)> {
    let m = reference.len();
    let mut best: Option<(f64, Vec<f64>)> = None;
    for code in 0..3_usize.pow(m as u32) {
        let choice: Vec<usize> = (0..m).map(|i| code / 3_usize.pow(i as u32) % 3).collect();
        let mut tensions: Vec<f64> = (0..m)
            .map(|i| [lower, upper, reference[i]][choice[i]])
            .collect();
        let mut free = structure.clone();
        for i in (0..m).filter(|i| choice[*i] != 2) {
            free.row_mut(i).fill(0.0);
        }
        let rest = structure.tr_mul(&DVector::from_vec(tensions.clone())) + wrench;
        let normal = free.tr_mul(&free);
        let Ok(lambda) = normal.svd(true, true).solve(&-rest, 1e-10) else {
            continue;
        };
        let change = free * lambda;
        for i in 0..m {
            tensions[i] += change[i];
        }
        let left = structure.tr_mul(&DVector::from_vec(tensions.clone())) + wrench;
        let inside = tensions
            .iter()
            .all(|t| (lower - 1e-9..upper + 1e-9).contains(t));
        if left.norm() > 1e-8 || !inside {
            continue;
        }
        let pairs = tensions.iter().zip(reference);
        let distance: f64 = pairs.map(|(t, r)| (t - r).powi(2)).sum();
        if best.as_ref().is_none_or(|(d, _)| distance < *d) {
            best = Some((distance, tensions));
        }
    }
    best
}

/// Compares with the enumeration; returns whether the pose was feasible.
fn check(robot: &Robot, pose: &Pose, lower: f64, upper: f64) -> bool {
    let structure = structure_matrix(robot, pose).unwrap();
    let wrench = applied_wrench(robot, pose).unwrap();
    let m = robot.cable_count();
    let reference: Vec<f64> = (0..m).map(|i| 20.0 + i as f64).collect();
    let (lo, hi) = (vec![lower; m], vec![upper; m]);
    let result = distribute_tension(&structure, &wrench, &reference, &lo, &hi);
    let best = by_enumeration(&structure, &wrench, &reference, lower, upper);
    let feasible = result.feasibility == Feasibility::Feasible;
    assert_eq!(feasible, best.is_some(), "{:?}", result.residual);
    assert!(
        result
            .tensions_n
            .iter()
            .all(|t| (lower..=upper).contains(t))
    );
    if let Some((_, tensions)) = best {
        for (a, b) in result.tensions_n.iter().zip(&tensions) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
        let residual = equilibrium_residual(robot, pose, &result.tensions_n).unwrap();
        assert!(residual.norm() < 1e-7, "{}", residual.norm());
    }
    feasible
}

#[test]
fn structure_matrix_is_minus_the_length_gradient() {
    let mut rng = samples::generator(21);
    for kind in [Kind::Spatial, Kind::Planar, Kind::PointMass] {
        let robot = samples::of_kind(kind, 0.02);
        let twist = Twist::from_fn(|_, _| rng.random_range(-0.1..0.1));
        let pose = Pose::identity().perturbed(&twist);
        let structure = structure_matrix(&robot, &pose).unwrap();
        for (i, gradient) in length_gradients(&robot, &pose).unwrap().iter().enumerate() {
            for (j, slope) in gradient.pose_free(&robot).iter().enumerate() {
                assert_eq!(structure[(i, j)], -slope);
            }
        }
    }
}

#[test]
fn distribution_is_the_enumerated_optimum() {
    use Coordinate::{Rz, X, Y, Z};
    let mut rng = samples::generator(22);
    let (mut feasible, mut infeasible) = (0, 0);
    for round in 0..240 {
        let count = 1 + round % 7;
        let free: &[Coordinate] =
            [&[X, Y][..], &[X, Y, Z], &[X, Y, Rz], &Coordinate::ALL][rng.random_range(0..4)];
        let (robot, pose) = samples::anywhere(&mut rng, free, count);
        if check(&robot, &pose, 2.0, 80.0) {
            feasible += 1;
        } else {
            infeasible += 1;
        }
    }
    assert!(
        feasible >= 40 && infeasible >= 40,
        "{feasible} {infeasible}"
    );
}

#[test]
fn eight_cable_robot_is_balanced_where_enumeration_says_so() {
    let mut rng = samples::generator(23);
    let mut feasible = 0;
    let robot = samples::spatial(0.018);
    for _ in 0..10 {
        let twist = Twist::from_fn(|k, _| rng.random_range(-0.2..0.2) * [1.0, 2.0][k / 3]);
        let pose = Pose::identity().perturbed(&twist);
        feasible += usize::from(check(&robot, &pose, 5.0, 60.0));
    }
    assert!((1..10).contains(&feasible), "{feasible}");
}

#[test]
fn without_cables_only_no_wrench_is_feasible() {
    let none = DMatrix::zeros(0, 3);
    let wrench = DVector::from_column_slice(&[0.0, 0.0, -9.8]);
    let result = distribute_tension(&none, &wrench, &[], &[], &[]);
    assert_eq!(result.feasibility, Feasibility::Infeasible);
    let result = distribute_tension(&none, &DVector::zeros(3), &[], &[], &[]);
    assert_eq!(result.feasibility, Feasibility::Feasible);
}

#[test]
fn without_limits_it_is_the_least_norm_correction() {
    let robot = samples::spatial(0.018);
    let pose = Pose::from_parts([0.05, -0.02, 0.1], [0.99, 0.02, 0.03, -0.05]);
    let structure = structure_matrix(&robot, &pose).unwrap();
    let wrench = applied_wrench(&robot, &pose).unwrap();
    let (reference, infinite) = (vec![30.0; 8], vec![f64::INFINITY; 8]);
    let minus: Vec<f64> = infinite.iter().map(|v| -v).collect();
    let result = distribute_tension(&structure, &wrench, &reference, &minus, &infinite);
    assert_eq!(result.feasibility, Feasibility::Feasible);
    let rest = structure.tr_mul(&DVector::from_column_slice(&reference)) + &wrench;
    let lambda = structure
        .tr_mul(&structure)
        .cholesky()
        .unwrap()
        .solve(&-rest);
    let change = &structure * lambda;
    for i in 0..8 {
        assert!((result.tensions_n[i] - reference[i] - change[i]).abs() < 1e-8);
    }
}

#[test]
fn missing_mass_is_said() {
    let mut robot = samples::spatial(0.018);
    robot.platform.mass_kg = None;
    let error = applied_wrench(&robot, &Pose::identity()).unwrap_err();
    assert_eq!(error.to_string(), "the mass of the platform is not given");
}
