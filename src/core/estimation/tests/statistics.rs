//! Chi-square, standard deviations, redundancies, tension errors on simulated data.

use super::*;

/// Standard deviations that one of the figures below may be away from its expectation: with less
/// than 40 of them in this file, each fails with probability 6e-7 times 40, below 3e-5, if normal.
const LIMIT: f64 = 5.0;

#[test]
fn redundancies_sum_to_the_degrees_of_freedom() {
    for name in presets::NAMES {
        let run = run_of(name, 21, 11);
        for method in [Method::Joint, Method::Simple] {
            let problem = Problem::new(&run.dataset).unwrap().with_method(method);
            let solution = solved(&problem);
            let analysis = Analysis::new(&problem, &solution);
            let readings = analysis.observations.iter().map(|r| r.redundancy.unwrap());
            let priors = analysis.prior_redundancies.iter().flatten();
            let sum = readings.sum::<f64>() + priors.sum::<f64>();
            let off = sum - solution.degrees_of_freedom;
            assert!(off.abs() < 1e-6, "{name} {method:?} {off:e}");
        }
    }
}

#[test]
fn chi_square_has_its_degrees_of_freedom() {
    for name in presets::NAMES {
        for method in [Method::Joint, Method::Simple] {
            // Taking noisy tensions as exact is wrong: the simple method is judged without noise.
            if method == Method::Simple && name != "planar" {
                continue;
            }
            let (mut chi2, mut dof) = (0.0, 0.0);
            for seed in 0..12 {
                let mut run = run_of(name, 20, 300 + seed);
                if method == Method::Simple {
                    exact_tensions(&mut run);
                }
                let solution = identified(&run.dataset, method);
                chi2 += solution.chi2;
                dof += solution.degrees_of_freedom;
            }
            let away = (chi2 - dof) / (2.0 * dof).sqrt();
            assert!(away.abs() < LIMIT, "{name} {method:?}: {chi2} of {dof}");
        }
    }
}

/// Replaces the force readings by what the true tensions give.
fn exact_tensions(run: &mut Simulated) {
    let data = &mut run.dataset.measurements;
    for row in 0..data.len() {
        for (index, cable) in run.dataset.robot.cables.iter().enumerate() {
            let tension = data.truth.tension_n.get(row, index);
            let reading = cable.force_sensor.unwrap().reading_n(tension);
            data.force_n.set(row, index, reading);
        }
    }
}

#[test]
fn errors_of_entry_points_are_as_large_as_stated() {
    for name in presets::NAMES {
        // The errors of one run are correlated, those of different runs are not: each run gives one
        // chi-square variable with as many degrees of freedom as coordinates.
        let (mut sum, mut count) = (0.0, 0.0);
        for seed in 0..12 {
            let run = run_of(name, 20, 400 + seed);
            let solution = identified(&run.dataset, Method::Joint);
            let (error, coordinates) = entry_error(&run, &solution);
            sum += error;
            count += coordinates;
        }
        let away = (sum - count) / (2.0 * count).sqrt();
        assert!(away.abs() < LIMIT, "{name}: {sum} of {count}");
    }
}

#[test]
fn normalised_residuals_are_standard_normal() {
    for name in presets::NAMES {
        let run = run_of(name, 60, 12);
        let problem = Problem::new(&run.dataset).unwrap();
        let analysis = Analysis::new(&problem, &solved(&problem));
        let squares: Vec<f64> = analysis
            .observations
            .iter()
            .filter_map(Observation::normalised)
            .map(|v| v * v)
            .collect();
        let n = squares.len() as f64;
        // Normalised residuals that share degrees of freedom are correlated; at worst the mean square
        // scatters like that of the redundancies' sum of independent ones.
        let redundancy: f64 = analysis
            .observations
            .iter()
            .filter_map(|r| r.redundancy)
            .sum();
        let away = (squares.iter().sum::<f64>() / n - 1.0) / (2.0 / redundancy).sqrt();
        assert!(away.abs() < LIMIT, "{name}: {away}");
    }
}

#[test]
fn estimated_tension_errors_follow_the_true_ones() {
    for name in presets::NAMES {
        let run = run_of(name, 30, 13);
        let problem = Problem::new(&run.dataset).unwrap();
        let analysis = Analysis::new(&problem, &solved(&problem));
        let data = &run.dataset.measurements;
        let (mut product, mut estimated, mut true_square) = (0.0, 0.0, 0.0);
        let mut count = 0;
        for one in &analysis.observations {
            let ObservationKind::Tension(cable) = one.kind else {
                continue;
            };
            count += 1;
            let error = -one.residual();
            let sensor = run.dataset.robot.cables[cable].force_sensor.unwrap();
            let reading = sensor.tension_n(data.force_n.get(one.row, cable));
            let noise = reading - data.truth.tension_n.get(one.row, cable);
            product += noise * error;
            estimated += error * error;
            true_square += noise * noise;
        }
        // The best estimate e of noise t has cov(e, t) = var(e): the slope of t over e is 1. Its standard
        // deviation is that of the remaining noise over the size of e.
        let slope = product / estimated;
        let sd = ((true_square - product) / f64::from(count) / estimated).sqrt();
        assert!(estimated > 0.0 && product > 0.0, "{name}");
        assert!((slope - 1.0).abs() < LIMIT * sd, "{name}: {slope} +- {sd}");
    }
}

#[test]
fn more_poses_make_smaller_standard_deviations() {
    let few = identified(&run_of("mini", 15, 14).dataset, Method::Joint);
    let many = identified(&run_of("mini", 60, 14).dataset, Method::Joint);
    let trace = |s: &Solution| {
        s.covariance
            .as_ref()
            .unwrap()
            .view((0, 0), (24, 24))
            .trace()
    };
    assert!(trace(&many) < trace(&few));
}

#[test]
fn correlations_are_those_of_the_covariance() {
    let solution = identified(&run_of("mini", 25, 8).dataset, Method::Joint);
    let correlations = solution.correlations().unwrap();
    let covariance = solution.covariance.as_ref().unwrap();
    for i in 0..correlations.nrows() {
        assert!((correlations[(i, i)] - 1.0).abs() < 1e-12);
        for k in 0..i {
            let product =
                solution.standard_deviation(i).unwrap() * solution.standard_deviation(k).unwrap();
            assert!((correlations[(i, k)] * product - covariance[(i, k)]).abs() < 1e-12 * product);
            assert!(correlations[(i, k)].abs() < 1.0);
        }
    }
}
