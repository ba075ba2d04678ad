//! Problem R1 against Ceres Solver: the minimum that Ceres finds on the same data, frozen.
//!
//! `.ci/peers` runs Ceres itself against this program where it is installed.

use tautline_core::estimation::{Control, Method, Options, Problem, solve};
use tautline_core::robot::presets;
use tautline_core::simulation::{TrueGeometry, simulate};
use tautline_validation::tables::simulated::preset_options;

/// Poses, and Ceres' chi-square on MINI with seed 3 (automatic derivatives, DENSE_SCHUR,
/// tolerances 1e-12).
const CERES: [(usize, f64); 3] = [
    (24, 100.189_391_331_669_78),
    (1_000, 4_559.865_544_882_009),
    (10_000, 41_282.822_320_546_32),
];

#[test]
fn simple_problem_has_the_minimum_that_ceres_finds() {
    let preset = presets::find("mini").unwrap();
    for (poses, chi2) in CERES {
        let mut options = preset_options(&preset, poses, 3);
        options.geometry =
            TrueGeometry::EntryPoints(preset.measured_entry_points_m.clone().unwrap());
        let run = simulate(&preset.robot, &options).unwrap();
        let problem = Problem::new(&run.dataset)
            .unwrap()
            .with_method(Method::Simple);
        let found = solve(&problem, &Options::default(), &mut |_| Control::Continue).unwrap();
        assert!(found.converged());
        assert!(
            (found.chi2 / chi2 - 1.0).abs() < 1e-9,
            "{poses}: {} {chi2}",
            found.chi2
        );
    }
}
