//! The estimator against the plain solution of the same problem.

use super::plain::{FoundEffect, Plain};
use super::*;
use crate::estimation::solver::LevenbergMarquardt;
use crate::estimation::start::Start;
use crate::real::{Lanes, Packet};

fn cases() -> Vec<Simulated> {
    vec![
        run_of("mini", 8, 1),
        run_of("mini", 6, 2),
        run_of("planar", 7, 3),
        with_measured_home(run_of("mini", 7, 5)),
        with_measured_home(run_of("planar", 8, 6)),
    ]
}

/// The same run with a home pose whose coordinates correlate and are known differently well.
fn with_measured_home(mut run: Simulated) -> Simulated {
    let sd = [1e-4, 2e-4, 0.5e-4, 5e-4, 2e-4, 8e-4];
    let home = run.dataset.robot.home.as_mut().unwrap();
    home.covariance = Some(std::array::from_fn(|i| {
        // A correlation that falls off with the distance is positive definite.
        std::array::from_fn(|k| sd[i] * sd[k] * 0.7_f64.powi((i as i32 - k as i32).abs()))
    }));
    run.dataset.robot.check().unwrap();
    run
}

/// Indices of the free entry point coordinates among the parameters.
fn entry_points(solution: &Solution) -> Vec<(usize, usize, usize)> {
    let parameters = solution.parameters.iter().enumerate();
    parameters
        .filter_map(|(k, p)| match p.id {
            ParameterId::EntryPoint { cable, axis } => Some((k, cable, axis)),
            _ => None,
        })
        .collect()
}

/// Largest differences of entry points in standard deviations, and of covariances in products of
/// standard deviations.
fn differences(solution: &Solution, plain: &FoundEffect) -> (f64, f64) {
    let covariance = solution.covariance.as_ref().unwrap();
    let indices = entry_points(solution);
    let (mut points, mut covariances) = (0.0_f64, 0.0_f64);
    for (i, (k, cable, axis)) in indices.iter().enumerate() {
        let sd = plain.covariance[(i, i)].sqrt();
        let off = solution.globals.entry_points[*cable][*axis] - plain.state.entry[*cable][*axis];
        points = points.max(off.abs() / sd);
        for (j, (q, ..)) in indices.iter().enumerate() {
            let other = plain.covariance[(j, j)].sqrt();
            let off = covariance[(*k, *q)] - plain.covariance[(i, j)];
            covariances = covariances.max(off.abs() / (sd * other));
        }
    }
    (points, covariances)
}

#[test]
fn simple_method_finds_the_minimum_of_problem_r1() {
    for run in cases() {
        let plain = Plain::new(&run.dataset, false).solve();
        let solution = identified(&run.dataset, Method::Simple);
        let off = (solution.chi2 - plain.chi2).abs() / plain.chi2;
        assert!(off < 1e-9, "{} {} {off:e}", solution.chi2, plain.chi2);
        let (points, covariances) = differences(&solution, &plain);
        // Both stop where a step promises 1e-11 of the sum of squares, about 1e-9 here: 3e-5
        // standard deviations. The numerical Jacobian is exact to 1e-8.
        assert!(
            points < 1e-4 && covariances < 1e-5,
            "{points:e} {covariances:e}"
        );
    }
}

#[test]
fn joint_method_finds_the_minimum_of_problem_r2() {
    for run in cases() {
        let plain = Plain::new(&run.dataset, true).solve();
        let solution = identified(&run.dataset, Method::Joint);
        let (points, covariances) = differences(&solution, &plain);
        // Tensions are eliminated from lengths linearised at the readings: MINI's cables leave
        // 7e-10 m per square newton, 1.5e-5 standard deviations of a length, the same at all poses.
        assert!(points < 0.01, "{points}");
        assert!(covariances < 0.01, "{covariances}");
        assert!((solution.chi2 - plain.chi2).abs() < 1e-3);
    }
}

/// The solution with one instruction set after the other, as far as this processor has them.
fn by_instruction_set(problem: &Problem<'_>) -> Vec<Solution> {
    fn with<T: Packet>(token: T::Token, problem: &Problem<'_>) -> Solution {
        LevenbergMarquardt::<T>::new(token, problem, Start::Given, Division::default())
            .run(&Options::default(), &mut quiet)
    }
    let mut solutions = vec![
        with::<f64>((), problem),
        with::<Lanes<pulp::Scalar>>(pulp::Scalar, problem),
    ];
    #[cfg(target_arch = "x86_64")]
    if let Some(v3) = pulp::x86::V3::try_new() {
        solutions.push(with::<Lanes<pulp::x86::V3>>(v3, problem));
    }
    solutions
}

#[test]
fn all_instruction_sets_find_the_same() {
    for name in ["mini", "suspended", "planar"] {
        // Not a multiple of any number of lanes.
        let run = run_of(name, 13, 4);
        for method in [Method::Joint, Method::Simple] {
            let problem = Problem::new(&run.dataset).unwrap().with_method(method);
            let chosen = solve(&problem, &Options::default(), &mut quiet).unwrap();
            for other in by_instruction_set(&problem) {
                assert_eq!(chosen.iterations, other.iterations);
                assert_eq!(chosen.degrees_of_freedom, other.degrees_of_freedom);
                // The same arithmetic but for the order of sums and fused operations.
                let off = difference_in_sd(&chosen, &other);
                assert!(off < 1e-9, "{name} {method:?}: {off:e}");
                assert!((chosen.chi2 - other.chi2).abs() < 1e-9 * other.chi2);
            }
        }
    }
}
