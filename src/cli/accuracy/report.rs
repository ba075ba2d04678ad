//! Readable form of the accuracy figures: millimetres and degrees.

use crate::output::say;
use crate::table::{self, mm};
use tautline_workflow::accuracy::{Accuracy, Figures, PathAccuracy, PoseAccuracy};

/// Cycles per pose required by ISO 9283:1998.
const STANDARD_CYCLES: usize = 30;

/// Prints all figures.
pub fn print(accuracy: &Accuracy) {
    if let Some(poses) = &accuracy.poses {
        print_poses(poses);
    }
    if !accuracy.paths.is_empty() {
        print_paths(&accuracy.paths);
    }
    let poses = || accuracy.poses.iter().flat_map(|p| &p.targets);
    let angles = poses().map(|t| t.figures.angle_accuracy_rad);
    let mut angles = angles.chain(accuracy.paths.iter().map(|p| p.angle_accuracy_rad));
    if angles.any(|angle| angle.is_some()) {
        say!("angles about the base axes: accuracy ±repeatability");
    }
    let few = poses().filter(|t| t.cycles < STANDARD_CYCLES).count();
    if few > 0 {
        let ending = if few == 1 { "" } else { "s" };
        say!("{few} pose{ending} with fewer than the {STANDARD_CYCLES} cycles of ISO 9283");
    }
}

fn print_poses(poses: &PoseAccuracy) {
    let angle =
        |of: &Figures, k: usize| angle(of.angle_accuracy_rad, of.angle_repeatability_rad, k);
    table::rows(&poses.targets).print(&[
        ("Pose", &|one| one.target.clone()),
        ("cycles", &|one| one.cycles.to_string()),
        ("AP mm", &|one| mm(one.figures.accuracy_m, 3)),
        ("RP mm", &|one| mm(one.figures.repeatability_m, 3)),
        ("dx mm", &|one| mm(one.figures.deviation_m[0], 3)),
        ("dy mm", &|one| mm(one.figures.deviation_m[1], 3)),
        ("dz mm", &|one| mm(one.figures.deviation_m[2], 3)),
        ("rx °", &|one| angle(&one.figures, 0)),
        ("ry °", &|one| angle(&one.figures, 1)),
        ("rz °", &|one| angle(&one.figures, 2)),
    ]);
    say!(
        "pose accuracy AP: largest {} mm, mean {} mm",
        mm(poses.largest_accuracy_m, 3),
        mm(poses.mean_accuracy_m, 3)
    );
    say!(
        "pose repeatability RP: largest {} mm, mean {} mm",
        mm(poses.largest_repeatability_m, 3),
        mm(poses.mean_repeatability_m, 3)
    );
}

fn print_paths(paths: &[PathAccuracy]) {
    let angle =
        |of: &PathAccuracy, k: usize| angle(of.angle_accuracy_rad, of.angle_repeatability_rad, k);
    table::rows(paths).print(&[
        ("Path", &|one| one.target.clone()),
        ("cycles", &|one| one.cycles.to_string()),
        ("points", &|one| one.points.len().to_string()),
        ("AT mm", &|one| mm(one.accuracy_m, 3)),
        ("RT mm", &|one| mm(one.repeatability_m, 3)),
        ("rx °", &|one| angle(one, 0)),
        ("ry °", &|one| angle(one, 1)),
        ("rz °", &|one| angle(one, 2)),
    ]);
}

/// Accuracy and repeatability about an axis in degrees; a dash without figures.
fn angle(accuracy: Option<[f64; 3]>, repeatability: Option<[f64; 3]>, axis: usize) -> String {
    let angles = accuracy.zip(repeatability).map(|of| {
        let [accuracy, repeatability] = [of.0, of.1].map(|all| all[axis].to_degrees());
        format!("{accuracy:.3} ±{repeatability:.3}")
    });
    angles.unwrap_or_else(|| "-".to_owned())
}
