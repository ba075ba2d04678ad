//! Unmodelled errors: their evidence against dense linear algebra, and whether they are found.

use nalgebra::DMatrix;

use super::super::error_functions::field;
use super::super::inference::inference_at_fit;
use super::super::linear_fit::LinearFit;
use super::super::reading_errors::ReadingErrors;
use super::super::unmodelled_errors::UnmodelledErrors;
use super::super::{ErrorForm, Quantity, Subject, Variable, Verdict};
use super::{Fit, diagnosed, problem_at_fitted_poses, run_with};
use crate::measurement::Dataset;

/// Clean data with a wave over time in the lengths of the third cable.
fn with_wave(size_m: f64) -> Dataset {
    let mut dataset = run_with("mini", 41, 5, &[]).dataset;
    let data = &mut dataset.measurements;
    let per_turn = dataset.robot.cables[2].winch.cable_per_revolution_m();
    let error = |time: f64| size_m * (std::f64::consts::TAU * time / 210.0).sin() / per_turn;
    let home = data.home_row();
    let first = home.map_or(0.0, |row| error(data.time_s[row]));
    for row in (0..data.len()).filter(|row| Some(*row) != home) {
        let value = data.revolutions.get(row, 2) + error(data.time_s[row]) - first;
        data.revolutions.set(row, 2, value);
    }
    dataset
}

#[test]
fn score_and_information_of_reading_errors_are_those_of_their_columns() {
    let dataset = run_with("planar", 12, 3, &[]).dataset;
    let problem = problem_at_fitted_poses(&dataset);
    let fit = Fit::new(&problem, &[]).unwrap();
    let at = LinearFit::new(&fit, false);
    let linear = &at.linear;
    let base = linear.reduced(
        &linear.with_variance_factor(1.7),
        &DMatrix::zeros(linear.conditions.count, 0),
    );
    let poses = linear.conditions.poses;
    let functions = DMatrix::from_fn(poses, 3, |pose, k| {
        ((pose + 1) * (k + 2)) as f64 % 5.0 - 2.0
    });
    for classes in [vec![0], vec![0, 1]] {
        let (score, information) = ReadingErrors::new(&base, &classes).of(&functions);
        let mut columns = DMatrix::zeros(linear.conditions.count, 3);
        for class in &classes {
            columns += linear.conditions.project_class(*class, &functions);
        }
        base.noise.whiten(&mut columns);
        let left = &columns - base.eliminated.tr_mul(&(&base.eliminated * &columns));
        let expected = columns.tr_mul(&left);
        assert!((information - &expected).amax() < 1e-9 * expected.amax());
        let expected = columns.tr_mul(&base.residual);
        assert!((score - &expected).amax() < 1e-9 * expected.amax());
    }
}

#[test]
fn a_field_has_the_covariance_of_its_kernel() {
    let x: Vec<f64> = (0..30).map(|k| (f64::from(k) / 7.0).sin()).collect();
    let y: Vec<f64> = (0..30).map(|k| (f64::from(k) / 3.0).cos()).collect();
    let functions = field(&[x.clone(), y.clone()], 0.5).unwrap();
    let covariance = &functions * functions.transpose();
    for a in 0..30 {
        for b in 0..30 {
            let square = (x[a] - x[b]).powi(2) + (y[a] - y[b]).powi(2);
            let expected = (-2.0 * square).exp();
            assert!((covariance[(a, b)] - expected).abs() < 1e-4);
        }
    }
}

/// The probability that noise hides a wave of ten standard deviations is below 1e-9.
#[test]
fn a_wave_in_one_channel_is_reported_as_unknown() {
    let dataset = with_wave(2e-3);
    let found = diagnosed(&dataset).findings;
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].verdict(), Verdict::Unknown);
    let Subject::UnmodelledError(error) = &found[0].subject else {
        panic!("{found:?}");
    };
    let id = error.readings;
    assert_eq!((id.quantity, id.cable), (Quantity::Length, Some(2)));
    assert!(
        matches!(error.form, ErrorForm::Wave(Variable::Time, period) if (period - 210.0).abs() < 8.0)
    );
    // An amplitude of 2 mm is 1.41 mm rms, 28 times the noise of the readings.
    assert!((error.rms.unwrap() - 1.41e-3).abs() < 0.25e-3, "{error:?}");
    assert!(
        found[0].sentence.contains("repeats every 2"),
        "{}",
        found[0].sentence
    );
}

/// Fewer than one in 200 clean datasets have odds of 100 to 1 for an unmodelled error.
#[test]
fn clean_data_have_no_unmodelled_error() {
    let dataset = run_with("mini", 41, 5, &[]).dataset;
    let problem = problem_at_fitted_poses(&dataset);
    let fit = Fit::new(&problem, &[]).unwrap();
    let inference = inference_at_fit(fit, Vec::new(), None);
    let found = UnmodelledErrors::new(&inference, &mut || true).unwrap();
    assert!(found.remaining.is_empty());
    assert!(
        inference
            .linear
            .conditions
            .classes
            .iter()
            .any(|id| id.quantity == Quantity::Length)
    );
}
