//! Accuracy figures of ISO 9283 from the rows of a check.

mod before_after;
mod document;
mod group;
mod uncertainty;
mod verification;

use tautline_core::accuracy::iso9283::{Target, path_accuracy, pose_accuracy};
use tautline_session::{CheckKind, CheckRow};

#[cfg(test)]
pub(crate) use before_after::tests::run as verification_of_one_pose;
pub use before_after::{
    Figure, LARGEST, before_and_after, plot_of_errors, predicted_m, result_in_words,
};
pub use document::{Accuracy, Figures, PathAccuracy, PointAccuracy, PoseAccuracy, TargetAccuracy};
pub use group::{Group, Point, group, word};
pub use uncertainty::{UncertainFigure, UncertainPoseFigures, pose_uncertainties};
pub use verification::VerificationDocument;

/// Whether some but not all rows have an orientation.
pub fn is_partly_oriented(group: &Group) -> bool {
    let some = group.points.iter().any(|p| p.some_oriented);
    some && !group.points.iter().all(|p| p.oriented)
}

/// Computes the figures of the rows of a check.
///
/// # Errors
/// One sentence if the rows of a pose or path are inconsistent.
pub fn figures(rows: &[CheckRow]) -> Result<Accuracy, String> {
    accuracy(&group(rows)?)
}

/// Computes the figures of groups of rows.
///
/// # Errors
/// One sentence if the rows of a pose or path are inconsistent.
pub fn accuracy(groups: &[Group]) -> Result<Accuracy, String> {
    let of_kind = |kind: CheckKind| groups.iter().filter(move |g| g.kind == kind);
    let poses: Vec<&Group> = of_kind(CheckKind::Pose).collect();
    Ok(Accuracy {
        poses: match poses.is_empty() {
            true => None,
            false => Some(poses_accuracy(&poses)?),
        },
        paths: of_kind(CheckKind::Path)
            .map(|path| path_of(path).map_err(|e| format!("path \"{}\": {e}", path.name)))
            .collect::<Result<_, _>>()?,
    })
}

fn poses_accuracy(groups: &[&Group]) -> Result<PoseAccuracy, String> {
    let points: Vec<&Point> = groups.iter().map(|group| &group.points[0]).collect();
    let targets: Vec<Target> = points.iter().map(|point| point.target.clone()).collect();
    let summary = pose_accuracy(&targets).map_err(|error| error.to_string())?;
    let oriented = points.iter().all(|point| point.oriented);
    let figures = groups.iter().zip(&points).zip(&summary.targets);
    Ok(PoseAccuracy {
        largest_accuracy_m: summary.largest_accuracy_m,
        mean_accuracy_m: summary.mean_accuracy_m,
        largest_repeatability_m: summary.largest_repeatability_m.unwrap_or(f64::NAN),
        mean_repeatability_m: summary.mean_repeatability_m.unwrap_or(f64::NAN),
        largest_angle_accuracy_rad: oriented.then_some(summary.largest_angle_accuracy_rad),
        largest_angle_repeatability_rad: summary
            .largest_angle_repeatability_rad
            .filter(|_| oriented),
        targets: figures
            .map(|((group, point), figures)| TargetAccuracy {
                target: group.name.clone(),
                cycles: figures.cycles,
                figures: Figures::new(point.commanded_m(), figures, point.oriented),
            })
            .collect(),
    })
}

fn path_of(group: &Group) -> Result<PathAccuracy, String> {
    let targets: Vec<Target> = group.points.iter().map(|p| p.target.clone()).collect();
    let path = path_accuracy(&targets).map_err(|error| error.to_string())?;
    let oriented = group.points.iter().all(|point| point.oriented);
    let figures = group.points.iter().zip(&path.points);
    Ok(PathAccuracy {
        target: group.name.clone(),
        cycles: path.cycles,
        accuracy_m: path.accuracy_m,
        repeatability_m: path.repeatability_m.unwrap_or(f64::NAN),
        angle_accuracy_rad: oriented.then_some(path.angle_accuracy_rad),
        angle_repeatability_rad: path.angle_repeatability_rad.filter(|_| oriented),
        points: figures
            .map(|(point, figures)| PointAccuracy {
                sample: point.sample,
                figures: Figures::new(point.commanded_m(), figures, point.oriented),
            })
            .collect(),
    })
}
