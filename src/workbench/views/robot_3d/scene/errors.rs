//! Errors of position of the platform, measured by an external instrument.

use tautline_core::geometry::Vec3;
use tautline_session::{CheckRow, Session, Stage};

/// Mean error of position at a test pose or a point of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionError {
    /// Commanded position (m).
    pub commanded: Vec3,
    /// Measured minus commanded position (m).
    pub by: Vec3,
    /// Before or after the adjustment.
    pub stage: Stage,
}

/// Errors of the last verification of each stage.
#[must_use]
pub fn of_session(session: &Session) -> Vec<PositionError> {
    let last = |stage: Stage| {
        let mut runs = session.verifications().iter().rev();
        let run = runs.find(|run| run.stage == stage);
        run.map_or_else(Vec::new, |run| means(&run.rows, stage))
    };
    [last(Stage::Before), last(Stage::After)].concat()
}

/// Means over all cycles for each target.
fn means(rows: &[CheckRow], stage: Stage) -> Vec<PositionError> {
    let mut sums: Vec<((&str, i64), Vec3, Vec3, f64)> = Vec::new();
    for row in rows {
        let commanded = Vec3::from(row.commanded.position_m);
        let by = Vec3::from(row.attained.position_m) - commanded;
        let target = (row.target.as_str(), row.sample);
        match sums.iter_mut().find(|(known, ..)| *known == target) {
            Some((_, _, sum, count)) => {
                *sum += by;
                *count += 1.0;
            }
            None => sums.push((target, commanded, by, 1.0)),
        }
    }
    let mean = |(_, commanded, sum, count): (_, Vec3, Vec3, f64)| PositionError {
        commanded,
        by: sum / count,
        stage,
    };
    sums.into_iter().map(mean).collect()
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;
    use tautline_session::{CheckKind, CheckPose, Timestamp, Verification};

    use super::*;

    #[test]
    fn errors_are_means_over_the_cycles_of_the_last_run() {
        let pose = |x: f64| CheckPose {
            position_m: [x, 0.0, 0.0],
            orientation_wxyz: None,
        };
        let row = |target: &str, cycle: i64, x: f64, off_m: f64| CheckRow {
            kind: CheckKind::Pose,
            target: target.into(),
            cycle,
            sample: 0,
            time_s: None,
            commanded: pose(x),
            attained: pose(x + off_m),
        };
        let run = |rows: Vec<CheckRow>| Verification {
            time: Timestamp::from_unix_seconds(0),
            title: String::new(),
            stage: Stage::Before,
            rows,
            accepted: None,
        };
        let robot = presets::find("mini").expect("a preset").robot;
        let mut session = Session::new("test", robot, Timestamp::from_unix_seconds(0));
        assert!(of_session(&session).is_empty());
        session.add_verification(run(vec![row("P1", 1, 0.0, 9e-3)]));
        session.add_verification(run(vec![
            row("P1", 1, 0.1, 1e-3),
            row("P2", 1, 0.2, 5e-3),
            row("P1", 2, 0.1, 3e-3),
        ]));
        let errors = of_session(&session);
        assert_eq!(errors.len(), 2);
        assert!((errors[0].by.x - 2e-3).abs() < 1e-12 && errors[0].commanded.x == 0.1);
        assert!((errors[1].by.x - 5e-3).abs() < 1e-12);
    }
}
