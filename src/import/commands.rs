//! Commanded poses with missing coordinates: logs of translations have no orientation, those of planar robots no third axis.

use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;

use crate::cutting::{Averaged, CutPose};
use crate::recipe::{Quantity, QuantityKind as Kind};

/// Completes commanded positions: coordinates in which the platform cannot move, and a missing orientation, are those of the home
/// pose. Positions without a coordinate that is free are left out. Notices state both.
pub(crate) fn complete_commands(poses: &mut [CutPose], robot: &Robot, notices: &mut Vec<String>) {
    let has = |index: usize| poses.iter().any(|pose| has(pose, index));
    if !(0..3).any(has) {
        return;
    }
    let home = robot.home.map_or_else(Pose::identity, |home| home.pose());
    let free: Vec<usize> = robot.platform.free.iter().map(|one| one.index()).collect();
    let missing: Vec<usize> = (0..3).filter(|index| !has(*index)).collect();
    let names = |indices: &[usize]| {
        let columns = indices.iter().map(|index| quantity(*index).column());
        columns.collect::<Vec<_>>().join(", ")
    };
    let open: Vec<usize> = missing
        .iter()
        .copied()
        .filter(|index| free.contains(index))
        .collect();
    if !open.is_empty() {
        notices.push(format!(
            "commanded poses lack {}: they are not used, expected every coordinate in which the platform moves",
            names(&open)
        ));
        let is_other = |quantity: &Quantity| quantity.kind != Kind::Commanded;
        poses
            .iter_mut()
            .for_each(|pose| pose.readings.retain(|quantity, _| is_other(quantity)));
        return;
    }
    let rotates = free.iter().any(|index| *index > 2);
    let is_turned = !(3..7).any(has);
    if rotates && is_turned {
        notices.push(
            "commanded poses have no orientation: it is assumed to be that of the home pose"
                .to_owned(),
        );
    }
    let orientation = home.orientation_wxyz();
    for pose in poses {
        let whole = (0..3).all(|index| missing.contains(&index) || self::has(pose, index));
        let mut set = |index: usize, mean: f64| {
            let reading = Averaged {
                mean,
                sd: f64::NAN,
                number: 1,
            };
            pose.readings.insert(quantity(index), reading);
        };
        if whole {
            missing
                .iter()
                .for_each(|index| set(*index, home.position[*index]));
            if rotates && is_turned {
                (0..4).for_each(|k| set(3 + k, orientation[k]));
            }
        }
    }
}

fn quantity(index: usize) -> Quantity {
    let kind = Kind::Commanded;
    Quantity { kind, index }
}

fn has(pose: &CutPose, index: usize) -> bool {
    pose.readings.contains_key(&quantity(index))
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;

    use super::*;

    fn poses(indices: &[usize]) -> Vec<CutPose> {
        let reading = Averaged {
            mean: 0.25,
            sd: f64::NAN,
            number: 1,
        };
        let pose = CutPose {
            label: None,
            group: None,
            time_s: None,
            first_row: 0,
            rows: 1,
            readings: indices
                .iter()
                .map(|index| (quantity(*index), reading))
                .collect(),
        };
        vec![pose]
    }

    fn completed(preset: &str, indices: &[usize]) -> (Vec<f64>, Vec<String>) {
        let robot = presets::find(preset).expect("a preset").robot;
        let (mut poses, mut notices) = (poses(indices), Vec::new());
        complete_commands(&mut poses, &robot, &mut notices);
        let values = poses[0].readings.values().map(|reading| reading.mean);
        (values.collect(), notices)
    }

    #[test]
    fn what_commands_lack_is_assumed_and_said() {
        let (values, notices) = completed("mini", &[0, 1, 2]);
        assert_eq!(values, [0.25, 0.25, 0.25, 1.0, 0.0, 0.0, 0.0]);
        assert!(notices[0].contains("assumed to be that of the home pose"));
        let (values, notices) = completed("planar", &[0, 1, 3, 4, 5, 6]);
        assert_eq!(values, [0.25, 0.25, 0.0, 0.25, 0.25, 0.25, 0.25]);
        assert_eq!(notices, [""; 0]);
        let (values, notices) = completed("mini", &[0, 1]);
        assert_eq!(values, [0.0; 0]);
        assert!(notices[0].starts_with("commanded poses lack z_m: they are not used"));
        assert_eq!(completed("mini", &[]), (Vec::new(), Vec::new()));
    }
}
