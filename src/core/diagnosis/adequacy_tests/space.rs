//! The residual space and the variables against dense linear algebra and the simulated truth.

use nalgebra::{DMatrix, DVector};

use super::super::discrepancy::smooth_functions;
use super::super::reading_id::ReadingId;
use super::*;
use crate::estimation::{ObservationKind, RowKind};

/// The residual projector `M` as a dense matrix.
fn dense(linear: &Linearisation) -> DMatrix<f64> {
    let count = linear.rows.len();
    let mut m = DMatrix::identity(count, count);
    for pose in &linear.poses {
        let block = &pose.remainder * pose.remainder.transpose();
        let (first, size) = (pose.rows.start, pose.rows.len());
        m.view_mut((first, first), (size, size)).copy_from(&block);
    }
    let information = linear.design.tr_mul(&linear.design);
    m - &linear.design * information.try_inverse().unwrap() * linear.design.transpose()
}

fn close(a: &DMatrix<f64>, b: &DMatrix<f64>, tolerance: f64, what: &str) {
    let off = (a - b).amax();
    assert!(off < tolerance, "{what}: {off:e}");
}

/// Five classes that cut across poses, home rows and priors, by row number modulo 7; the rows with remainder 5 or 6
/// have none.
fn classes(count: usize) -> Vec<Option<usize>> {
    (0..count)
        .map(|row| Some(row % 7).filter(|k| *k < 5))
        .collect()
}

#[test]
fn sums_over_classes_are_those_of_the_dense_projector() {
    for name in ["planar", "mini"] {
        let run = run_with(name, 7, 5, &[]);
        let fitted = Fitted::new(&run.dataset);
        let m = dense(&fitted.linear);
        close(&(&m * &m), &m, 1e-7, "a projector");
        let residual = &fitted.space.residual;
        let off = (&m * residual - residual).amax();
        assert!(off < 1e-4, "residuals are in its range: {off:e}");
        let class_of = classes(fitted.space.rows());
        let sums = fitted.space.class_sums(&class_of, 5);
        let rows = |class| (0..m.nrows()).filter(move |row| row % 7 == class);
        for a in 0..5 {
            let trace: f64 = rows(a).map(|row| m[(row, row)]).sum();
            assert!((sums.traces[a] - trace).abs() < 1e-8, "trace");
            let squares: f64 = rows(a).map(|row| residual[row].powi(2)).sum();
            assert!((sums.squares[a] - squares).abs() < 1e-9, "squares");
            for b in 0..5 {
                let pairs = rows(a).flat_map(|i| rows(b).map(move |k| (i, k)));
                let expected: f64 = pairs.map(|at| m[at] * m[at]).sum();
                let off = sums.information[(a, b)] - expected;
                assert!(off.abs() < 1e-7, "{name} information {off:e}");
            }
        }
        let freedom: f64 = fitted.space.redundancy().iter().sum();
        assert!((freedom - fitted.solution.degrees_of_freedom).abs() < 1e-7);
    }
}

#[test]
fn scores_and_signatures_are_those_of_the_dense_projector() {
    let run = run_with("mini", 7, 6, &[]);
    let fitted = Fitted::new(&run.dataset);
    let m = dense(&fitted.linear);
    let rows: Vec<usize> = (0..m.nrows()).filter(|row| row % 3 == 0).collect();
    let functions = DMatrix::from_fn(rows.len(), 2, |i, k| ((i + 3 * k) as f64).sin());
    let group = fitted.space.group(rows.clone());
    let score = group.score(&functions);
    let columns = m.select_columns(&rows);
    let inside = columns.select_rows(&rows);
    close(&score.projected, &(&inside * &functions), 1e-8, "projected");
    let expected = functions.tr_mul(&(&inside * &functions));
    close(&score.information, &expected, 1e-8, "information");
    let expected = functions.tr_mul(&fitted.space.residual.select_rows(&rows));
    assert!((score.score - expected).amax() < 1e-12);
}

/// Changing the noise is the same as weighting the problem anew: with `D` the diagonal matrix of the factors of the standard
/// deviations, `M'` is the projector on the range of `D M`, and the residuals are `M'` times the old ones divided by `D`.
#[test]
fn other_variances_solve_the_weighted_problem() {
    let run = run_with("planar", 9, 7, &[]);
    let fitted = Fitted::new(&run.dataset);
    let classes = fitted.space.classes();
    let variances: Vec<f64> = (0..classes.len())
        .map(|class| (1.0 + 0.5 * (class % 4) as f64).powi(2))
        .collect();
    let weighted = fitted.space.with_variances(&variances);
    let factor = |id: &Option<ReadingId>| {
        let class = id.and_then(|id| classes.iter().position(|class| *class == id));
        class.map_or(1.0, |class| variances[class].sqrt())
    };
    let factors = DVector::from_iterator(
        fitted.space.rows(),
        fitted.space.readings.iter().map(factor),
    );
    assert!(factors.iter().any(|f| *f > 2.0) && factors.iter().any(|f| *f == 1.0));
    let d = DMatrix::from_diagonal(&factors);
    let stretched = &d * dense(&fitted.linear);
    let eigen = (&stretched * stretched.transpose()).symmetric_eigen();
    let kept: Vec<usize> = (0..fitted.space.rows())
        .filter(|k| eigen.eigenvalues[*k] > 1e-6)
        .collect();
    let basis = eigen.eigenvectors.select_columns(&kept);
    let m = &basis * basis.transpose();
    for (row, redundancy) in weighted.redundancy().into_iter().enumerate() {
        assert!((redundancy - m[(row, row)]).abs() < 1e-7, "row {row}");
    }
    let unscaled = fitted.space.residual.component_div(&factors);
    assert!((m * unscaled - &weighted.residual).amax() < 1e-7);
    let back = weighted.with_variances(&vec![1.0; variances.len()]);
    assert!((back.residual - &fitted.space.residual).amax() < 1e-12);
}

#[test]
fn undetermined_parameters_are_handled() {
    let run = run_with("mini", 7, 8, &[]);
    let fitted = Fitted::new(&run.dataset);
    let mut twice = fitted.linear.clone();
    let columns = twice.design.ncols();
    twice.design = twice.design.insert_column(columns, 0.0);
    twice.design = twice.design.insert_column(columns, 0.0);
    let copy = twice.design.column(0).clone_owned();
    twice.design.set_column(columns, &copy);
    let space = ResidualSpace::new(&twice);
    let pairs = space
        .redundancy()
        .into_iter()
        .zip(fitted.space.redundancy());
    for (a, b) in pairs {
        assert!((a - b).abs() < 1e-8);
    }
}

#[test]
fn fitted_tensions_are_better_than_readings() {
    let run = run_with("mini", 30, 9, &[]);
    let fitted = Fitted::new(&run.dataset);
    let variables = fitted.variables();
    let data = &run.dataset.measurements;
    let (mut read, mut adjusted) = (0.0, 0.0);
    for cable in 0..8 {
        let values = variables
            .values(Quantity::Length, Some(cable), Variable::Tension)
            .unwrap();
        let sensor = run.dataset.robot.cables[cable].force_sensor.unwrap();
        for at in &fitted.linear.rows {
            if at.kind == RowKind::Observation(ObservationKind::Tension(cable)) {
                let row = at.row.unwrap();
                let truth = data.truth.tension_n.get(row, cable);
                read += (sensor.tension_n(data.force_n.get(row, cable)) - truth).powi(2);
                adjusted += (values[row] - truth).powi(2);
            }
        }
    }
    // Equilibrium determines six of the eight tensions, so about a quarter of the variance remains.
    assert!(adjusted < 0.6 * read, "{adjusted} {read}");
}

#[test]
fn dependence_tests_are_consistent() {
    let run = run_with("mini", 20, 11, &[]);
    let fitted = Fitted::new(&run.dataset);
    for test in discrepancy::dependence_tests(&fitted.space, &fitted.variables()) {
        assert_eq!(test.functions.nrows(), test.rows.len());
        assert_eq!(test.values.len(), test.rows.len());
        assert!(test.component.is_none() && test.rank <= test.functions.ncols());
        assert!(test.noise_factor > 0.0 && test.noise_factor < 4.0);
        let score = fitted.space.group(test.rows).score(&test.functions);
        let inverse = score.information.pseudo_inverse(1e-9).unwrap();
        let chi2 = score.score.dot(&(inverse * &score.score));
        assert!((chi2 - test.chi2).abs() < 1e-6 * (1.0 + chi2));
    }
}

#[test]
fn variables_apply_only_to_suitable_readings() {
    let run = run_with("mini", 30, 10, &[]);
    let fitted = Fitted::new(&run.dataset);
    let variables = fitted.variables();
    let laser = |variable| variables.values(Quantity::Laser, None, variable);
    assert!(laser(Variable::CableLength).is_none());
    assert!(laser(Variable::Distance).is_some() && laser(Variable::Time).is_some());
    let length = |variable| variables.values(Quantity::Length, Some(2), variable);
    assert!(length(Variable::Distance).is_none());
    let swivel = length(Variable::SwivelAngle).unwrap();
    let fraction = length(Variable::DrumFraction).unwrap();
    assert!(fraction.iter().all(|f| (0.0..1.0).contains(f)));
    assert!(swivel.iter().all(|a| a.abs() < std::f64::consts::PI));
    let direction = length(Variable::Direction).unwrap();
    assert!(direction.iter().all(|d| [-1.0, 0.0, 1.0].contains(d)));
    let paid = length(Variable::CableLength).unwrap();
    let revolutions = length(Variable::Revolutions).unwrap();
    let k = run.dataset.robot.cables[2].winch.cable_per_revolution_m();
    let from_home = |row: usize| paid[row] - paid[0] - k * revolutions[row];
    // Apart from elongation, the cable paid out equals the change of length.
    assert!((0..31).all(|row| from_home(row).abs() < 0.02));
}

#[test]
fn smooth_functions_are_bounded_and_need_variation() {
    let values: Vec<f64> = (0..24).map(|k| f64::from(k) * 0.5).collect();
    let functions = smooth_functions(&values, Variable::Time, 9);
    assert_eq!(functions.shape(), (24, 5));
    assert!(functions.amax() <= 1.0);
    assert!((functions[(23, 0)] + 1.0).abs() < 1e-12);
    assert_eq!(smooth_functions(&values, Variable::Time, 2).ncols(), 2);
    assert_eq!(
        smooth_functions(&values, Variable::DrumFraction, 9).ncols(),
        4
    );
    assert_eq!(smooth_functions(&[1.0; 24], Variable::Time, 5).ncols(), 0);
    assert_eq!(smooth_functions(&values[..5], Variable::Time, 5).ncols(), 0);
    let there_and_back = [1.0, -1.0, 1.0, -1.0];
    assert_eq!(
        smooth_functions(&there_and_back, Variable::Direction, 1).ncols(),
        1
    );
}
