//! Readable form of the accuracy figures: millimetres and degrees.

use crate::output::say;
use crate::table;
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
    let mut rows = table::numbers(&[
        "Pose", "cycles", "AP mm", "RP mm", "dx mm", "dy mm", "dz mm", "rx °", "ry °", "rz °",
    ]);
    for target in &poses.targets {
        let Figures {
            deviation_m,
            accuracy_m,
            repeatability_m,
            angle_accuracy_rad,
            angle_repeatability_rad,
            ..
        } = &target.figures;
        let mut cells = vec![target.target.clone(), target.cycles.to_string()];
        cells.extend([accuracy_m, repeatability_m].map(|v| table::mm(*v, 3)));
        cells.extend(deviation_m.map(|v| table::mm(v, 3)));
        cells.extend(angles(*angle_accuracy_rad, *angle_repeatability_rad));
        table::push(&mut rows, &cells);
    }
    say!("{rows}");
    say!(
        "pose accuracy AP: largest {} mm, mean {} mm",
        table::mm(poses.largest_accuracy_m, 3),
        table::mm(poses.mean_accuracy_m, 3)
    );
    say!(
        "pose repeatability RP: largest {} mm, mean {} mm",
        table::mm(poses.largest_repeatability_m, 3),
        table::mm(poses.mean_repeatability_m, 3)
    );
}

fn print_paths(paths: &[PathAccuracy]) {
    let mut rows = table::numbers(&[
        "Path", "cycles", "points", "AT mm", "RT mm", "rx °", "ry °", "rz °",
    ]);
    for path in paths {
        let mut cells = vec![
            path.target.clone(),
            path.cycles.to_string(),
            path.points.len().to_string(),
            table::mm(path.accuracy_m, 3),
            table::mm(path.repeatability_m, 3),
        ];
        cells.extend(angles(
            path.angle_accuracy_rad,
            path.angle_repeatability_rad,
        ));
        table::push(&mut rows, &cells);
    }
    say!("{rows}");
}

/// Accuracy and repeatability about each axis in degrees; a dash without figures.
fn angles(accuracy: Option<[f64; 3]>, repeatability: Option<[f64; 3]>) -> [String; 3] {
    std::array::from_fn(|k| match (accuracy, repeatability) {
        (Some(accuracy), Some(repeatability)) => format!(
            "{:.3} ±{:.3}",
            accuracy[k].to_degrees(),
            repeatability[k].to_degrees()
        ),
        _ => "-".to_owned(),
    })
}
