//! The linearisation agrees with the solution that it belongs to.

use super::*;

const ROBOTS: [&str; 4] = ["mini", "hall", "suspended", "planar"];

#[test]
fn information_and_chi_square_are_those_of_the_solution() {
    for name in ROBOTS {
        let run = run_of(name, 15, 3);
        let problem = Problem::new(&run.dataset).unwrap();
        let solution = solved(&problem);
        let linear = Linearisation::new(&problem, &solution);
        let chi2 = linear.residual.norm_squared();
        assert!((chi2 / solution.chi2 - 1.0).abs() < 1e-6, "{name}: {chi2}");
        let information = linear.design.tr_mul(&linear.design);
        for (a, b) in information.iter().zip(solution.information.iter()) {
            let size = information.diagonal().max() * 1e-6;
            assert!((a - b).abs() < size.max(1e-3 * b.abs()), "{name}: {a} {b}");
        }
        let gradient = linear.design.tr_mul(&linear.residual);
        let step = solution.covariance.as_ref().unwrap() * &gradient;
        assert!(step.dot(&gradient) < 1e-4, "{name}");
    }
}

#[test]
fn redundancies_sum_to_the_degrees_of_freedom() {
    for name in ROBOTS {
        let run = run_of(name, 15, 4);
        let problem = Problem::new(&run.dataset).unwrap();
        let solution = solved(&problem);
        let linear = Linearisation::new(&problem, &solution);
        let remainder: f64 = linear
            .poses
            .iter()
            .map(|pose| pose.remainder.norm_squared())
            .sum();
        let outside = linear.rows.len() - linear.poses.iter().map(|p| p.rows.len()).sum::<usize>();
        let freedom = remainder + outside as f64 - linear.parameters.len() as f64;
        let expected = solution.degrees_of_freedom;
        assert!(
            (freedom - expected).abs() < 1e-6,
            "{name}: {freedom} {expected}"
        );
    }
}
