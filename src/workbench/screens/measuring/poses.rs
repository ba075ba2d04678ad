//! Planned and measured poses of a session, as table rows.

use std::collections::BTreeSet;

use tautline_core::geometry::Pose;
use tautline_session::Session;

/// Progress of a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseStatus {
    Planned,
    Measured,
    /// Measured, but excluded.
    Excluded,
    /// Measured, but not in the plan, because it repeats a planned pose.
    Repeat,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseRow {
    pub label: i64,
    /// Commanded position (mm); `None` if not recorded.
    pub position_mm: Option<[f64; 3]>,
    /// Rotation from the home pose (degrees).
    pub rotation_deg: Option<f64>,
    pub standing: PoseStatus,
}

/// All poses: the plan in its order, then measured poses without a plan.
pub fn rows(session: &Session) -> Vec<PoseRow> {
    let measurements = &session.measurements;
    let measured: BTreeSet<i64> = measurements.labels.iter().copied().collect();
    let planned: BTreeSet<i64> = session.plan.iter().map(|pose| pose.label).collect();
    let home = session.robot.home.map(|home| home.pose());
    let standing = |label: i64| {
        if session.excluded().contains(&label) {
            PoseStatus::Excluded
        } else if !measured.contains(&label) {
            PoseStatus::Planned
        } else if !planned.is_empty() && !planned.contains(&label) {
            PoseStatus::Repeat
        } else {
            PoseStatus::Measured
        }
    };
    let row = |label: i64, pose: Option<Pose>| PoseRow {
        label,
        position_mm: pose.map(|pose| (pose.position * 1e3).into()),
        rotation_deg: pose.zip(home).map(|(pose, home)| {
            let twist = pose.difference(&home);
            twist.fixed_rows::<3>(3).norm().to_degrees()
        }),
        standing: standing(label),
    };
    let of_plan = session.plan.iter().map(|p| row(p.label, Some(p.pose())));
    let labels = measurements.labels.iter().enumerate();
    let others = labels.filter(|(_, label)| !planned.contains(label));
    let others = others.map(|(at, label)| {
        let commanded = measurements.commanded.get(at).copied().flatten();
        row(*label, commanded)
    });
    of_plan.chain(others).collect()
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;
    use tautline_core::simulation::{SimulationOptions, simulate};
    use tautline_session::{PlannedPose, Timestamp};

    use super::*;

    #[test]
    fn planned_measured_and_left_out_poses_are_told_apart() {
        let robot = presets::find("mini").expect("a preset").robot;
        let simulated = simulate(&robot, &SimulationOptions::new(3, 1)).expect("simulated");
        let mut session = Session::new("test", robot, Timestamp::from_unix_seconds(0));
        session.measurements = simulated.dataset.measurements;
        let home = session.robot.home.expect("a home pose").pose();
        let mut turned = home;
        turned.orientation *= nalgebra::UnitQuaternion::from_euler_angles(0.1, 0.0, 0.0);
        let planned = [(0, home), (1, home), (2, home), (9, turned)];
        session.plan = planned
            .map(|(label, p)| PlannedPose::new(label, &p))
            .to_vec();
        session.exclude(1).expect("it is measured");
        let rows = rows(&session);
        let standings: Vec<_> = rows.iter().map(|row| (row.label, row.standing)).collect();
        let expected = [
            (0, PoseStatus::Measured),
            (1, PoseStatus::Excluded),
            (2, PoseStatus::Measured),
            (9, PoseStatus::Planned),
            (3, PoseStatus::Repeat),
        ];
        assert_eq!(standings, expected);
        let rotation = rows[3].rotation_deg.expect("a rotation");
        assert!((rotation - 0.1_f64.to_degrees()).abs() < 1e-9);
    }
}
