//! Figures of the plots, computed once per revision.

pub mod before_after;
pub mod convergence;
pub mod correlation;
pub mod course;
pub mod distances;
pub mod elongation;
pub mod external;
pub mod residuals;
pub mod tensions;
pub mod variable;

use std::collections::BTreeSet;

use tautline_core::measurement::Dataset;

use tautline_workflow::plot::figure::Point;

/// Label of an axis of poses.
pub(crate) const POSE: &str = "Pose";
/// Label of an axis of times.
pub(crate) const TIME: &str = "Time";

/// Point of the pose in a row.
fn at_row(dataset: &Dataset, excluded: &BTreeSet<i64>, row: usize, x: f64, y: f64) -> Point {
    let pose = dataset.measurements.labels.get(row).copied();
    Point {
        pose,
        excluded: pose.is_some_and(|pose| excluded.contains(&pose)),
        ..Point::new(x, y)
    }
}

fn over_pose(dataset: &Dataset, excluded: &BTreeSet<i64>, row: usize, y: f64) -> Point {
    let label = dataset.measurements.labels.get(row);
    let x = label.map_or(f64::NAN, |label| *label as f64);
    at_row(dataset, excluded, row, x, y)
}
