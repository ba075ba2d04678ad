//! Predictions of held-out poses against explicit fits without those poses.

use super::super::gain::{Prediction, quantity_of};
use super::super::report::{Cause, Quantity};
use super::{Fit, problem_at_fitted_poses, run_with, setting};
use crate::effect::EffectRequest;
use crate::estimation::{Linearisation, Problem};
use crate::measurement::Dataset;

/// For each kind of reading the sum of squares and its expectation from noise alone.
type Sums = Vec<(Quantity, f64, f64)>;

/// Predicts the readings of each pose from a full fit to all other poses. Only the pose itself is fitted to its
/// readings.
fn by_refits(problem: &Problem<'_>, causes: &[Cause]) -> Sums {
    let full = Fit::new(problem, causes).unwrap();
    let data = &problem.dataset.measurements;
    let mut sums: Sums = Quantity::ALL.map(|quantity| (quantity, 0.0, 0.0)).to_vec();
    for (index, left_out) in problem.pose_rows().into_iter().enumerate() {
        let rows: Vec<usize> = (0..data.len()).filter(|row| *row != left_out).collect();
        let others = Dataset {
            robot: problem.dataset.robot.clone(),
            measurements: data.select(&rows),
        };
        let refit = Fit::new(&Problem::new(&others).unwrap(), causes).unwrap();
        let mut solution = full.solution.clone();
        solution.globals = refit.solution.globals.clone();
        let linear = Linearisation::new(&full.problem, &solution);
        let block = &linear.poses[index];
        assert_eq!(block.row, left_out);
        for (k, row) in block.rows.clone().enumerate() {
            let quantity = quantity_of(linear.rows[row].kind);
            if let Some(sum) = sums.iter_mut().find(|sum| Some(sum.0) == quantity) {
                sum.1 += linear.residual[row].powi(2);
                sum.2 += block.remainder.row(k).norm_squared();
            }
        }
    }
    sums
}

fn compare(problem: &Problem<'_>, causes: &[Cause], tolerance: f64) {
    let fit = Fit::new(problem, causes).unwrap();
    let prediction = Prediction::new(&fit);
    let kinds = prediction.gain_over(&prediction).kinds;
    let sums = by_refits(problem, causes);
    let mut compared = 0;
    for (quantity, squares, freedom) in sums {
        let Some(kind) = kinds.iter().find(|kind| kind.quantity == quantity) else {
            continue;
        };
        let explicit = (squares / freedom).sqrt();
        assert!((kind.after - explicit).abs() < tolerance, "{quantity:?}");
        compared += 1;
    }
    assert_eq!(compared, 3);
}

/// Tolerance 1 % of the noise for the model as described.
#[test]
fn residuals_of_poses_held_out_are_those_of_refits() {
    let run = run_with("mini", 16, 51, &[]);
    compare(&Problem::new(&run.dataset).unwrap(), &[], 0.01);
}

/// Tolerance 2 % of the noise with a cause in the model.
#[test]
fn with_a_cause_in_the_model_too() {
    let hidden = setting("winch_scale", &["cable-3"], &[("scale", 0.02)]);
    let run = run_with("mini", 16, 52, &[hidden]);
    let request = EffectRequest::parse("winch_scale:cable-3").unwrap();
    let cause = Cause {
        instances: request.bind(&run.dataset.robot).unwrap(),
    };
    compare(&Problem::new(&run.dataset).unwrap(), &[cause], 0.02);
}

/// The gain of a cause has the right size and interval, and excludes the pose at which an event acts alone.
#[test]
fn a_cause_gains_on_poses_held_out() {
    let hidden = setting(
        "encoder_outlier",
        &["cable-3"],
        &[("error", 0.03), ("pose", 9.0)],
    );
    let scale = setting("winch_scale", &["cable-1"], &[("scale", 0.02)]);
    let run = run_with("mini", 30, 53, &[hidden, scale]);
    let base = problem_at_fitted_poses(&run.dataset);
    let cause = |text: &str| Cause {
        instances: EffectRequest::parse(text)
            .unwrap()
            .bind(&run.dataset.robot)
            .unwrap(),
    };
    let outlier = cause("encoder_outlier:cable-3:pose=9");
    let both = [outlier.clone(), cause("winch_scale:cable-1")];
    let [none, one, two] = [&both[..0], &both[..1], &both[..]]
        .map(|causes| Prediction::new(&Fit::new(&base, causes).unwrap()));
    assert_eq!(one.gain_over(&none).poses_held_out, 29);
    let gain = two.gain_over(&one);
    assert_eq!(gain.poses_held_out, 29);
    assert!(gain.before > 1.5 && gain.after < 1.3, "{gain:?}");
    let [low, high] = gain.interval;
    assert!(0.0 < low && low < gain.before - gain.after && gain.before - gain.after < high);
    let position = gain.position;
    let [low, high] = position.interval_m;
    assert!(low <= position.rms_m && position.rms_m <= high);
    assert!(position.rms_m <= position.largest_m && position.largest_m < 0.02);
    // A model gains nothing over itself.
    let nothing = two.gain_over(&two);
    assert_eq!(
        (nothing.before, nothing.interval),
        (nothing.after, [0.0; 2])
    );
    assert_eq!(nothing.position.largest_m, 0.0);
}
