//! Structure that no effect explains is called unknown, and kept out of the geometry.

use super::super::Verdict;
use super::{diagnosed, run_with};
use crate::effect::unknown::READING;
use crate::effect::{BiasedReading, UNKNOWN};
use crate::estimation::Solution;
use crate::measurement::Variable;
use crate::robot::Robot;
use crate::simulation::Simulated;

/// A run whose laser has a smooth error against x that no effect of the catalogue has.
fn with_smooth_error(size_m: f64, seed: u64) -> Simulated {
    let mut run = run_with("mini", 80, seed, &[]);
    let data = &mut run.dataset.measurements;
    let x: Vec<f64> = data
        .truth
        .poses
        .iter()
        .map(|pose| pose.position.x)
        .collect();
    let from = x.iter().copied().fold(f64::INFINITY, f64::min);
    let to = x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    for (laser, x) in data.laser_m.iter_mut().zip(&x) {
        let u = (x - from) / (to - from);
        *laser += size_m * (std::f64::consts::PI * (2.0 * u + 0.3)).sin();
    }
    run
}

/// Root mean square error of the entry points (m).
fn geometry_error(solution: &Solution, truth: &Robot) -> f64 {
    let pairs = solution.globals.entry_points.iter().zip(&truth.cables);
    let squares = pairs.flat_map(|(found, cable)| {
        let is = cable.pulley.entry_point_m;
        (0..3).map(move |k| (found[k] - is[k]).powi(2))
    });
    (squares.sum::<f64>() / (3 * truth.cable_count()) as f64).sqrt()
}

/// The error is 10 standard deviations of the laser: noise does not hide it.
#[test]
fn a_smooth_error_is_named_unknown_with_its_variable() {
    let run = with_smooth_error(0.003, 71);
    let diagnosis = diagnosed(&run.dataset);
    let finding = &diagnosis.findings[0];
    assert_eq!(finding.verdict, Verdict::Unknown, "{}", finding.sentence);
    assert_eq!(finding.cause.effect().id(), UNKNOWN.id());
    let values = &finding.cause.instances[0].values;
    let reading = BiasedReading::ALL[values[READING] as usize];
    assert_eq!(reading, BiasedReading::Laser);
    let name = Variable::Position(0).name();
    assert!(finding.sentence.contains(name), "{}", finding.sentence);
    assert!(diagnosis.extended.global.chi2 < 0.8 * diagnosis.base.global.chi2);
    let errors = [&diagnosis.base_solution, &diagnosis.extended_solution]
        .map(|solution| geometry_error(solution, &run.truth));
    assert!(errors[1] < errors[0], "{errors:?}");
}
