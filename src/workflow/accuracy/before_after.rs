//! Figures before and after the adjustment, beside each other.

use tautline_session::{Session, Stage};

use super::{Accuracy, VerificationDocument};

/// A figure of accuracy (m), before and after.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Its name.
    pub name: String,
    /// Before the adjustment; `None` if it was not measured.
    pub before_m: Option<f64>,
    /// After it.
    pub after_m: Option<f64>,
}

impl Figure {
    /// Part by which the error has become smaller, where both are known.
    #[must_use]
    pub fn gain(&self) -> Option<f64> {
        let (before, after) = self.before_m.zip(self.after_m)?;
        (before > 0.0).then(|| 1.0 - after / before)
    }
}

/// The figures of the last run of each stage, in the order of a table; the mean pose accuracy first.
///
/// # Errors
/// One sentence if the rows of a run do not make one.
pub fn before_and_after(session: &Session) -> Result<Vec<Figure>, String> {
    let of = VerificationDocument::of(session, Stage::After)?;
    let [before, after] = [of.before, of.after].map(|run| run.map_or_else(Vec::new, named));
    let mut figures: Vec<Figure> = Vec::new();
    for (name, _) in before.iter().chain(&after) {
        if figures.iter().all(|known| known.name != *name) {
            let of = |run: &[(String, f64)]| run.iter().find(|(n, _)| n == name).map(|(_, m)| *m);
            figures.push(Figure {
                name: name.clone(),
                before_m: of(&before),
                after_m: of(&after),
            });
        }
    }
    Ok(figures)
}

fn named(accuracy: Accuracy) -> Vec<(String, f64)> {
    let mut figures = Vec::new();
    if let Some(poses) = accuracy.poses {
        figures.extend([
            ("Pose accuracy, mean".to_owned(), poses.mean_accuracy_m),
            (
                "Pose accuracy, largest".to_owned(),
                poses.largest_accuracy_m,
            ),
            (
                "Pose repeatability, largest".to_owned(),
                poses.largest_repeatability_m,
            ),
        ]);
    }
    figures.extend(accuracy.paths.into_iter().map(|path| {
        let name = format!("Path accuracy, {}", path.target.to_lowercase());
        (name, path.accuracy_m)
    }));
    figures
}

#[cfg(test)]
pub(super) mod tests {
    use tautline_core::robot::presets;
    use tautline_session::{CheckKind, CheckPose, CheckRow, Timestamp, Verification};

    use super::*;

    /// A verification of one pose, measured twice, off by so much each time.
    pub fn run(stage: Stage, seconds: i64, off_m: f64) -> Verification {
        let pose = |x: f64| CheckPose {
            position_m: [x, 0.0, 0.0],
            orientation_wxyz: None,
        };
        let row = |cycle: i64| CheckRow {
            kind: CheckKind::Pose,
            target: "P1".into(),
            cycle,
            sample: 0,
            time_s: None,
            commanded: pose(0.1),
            attained: pose(0.1 + off_m),
        };
        Verification {
            time: Timestamp::from_unix_seconds(seconds),
            title: String::new(),
            stage,
            rows: vec![row(1), row(2)],
            accepted: None,
        }
    }

    #[test]
    fn the_last_run_of_each_stage_counts() {
        let robot = presets::find("mini").expect("a preset").robot;
        let mut session = Session::new("test", robot, Timestamp::from_unix_seconds(0));
        session.add_verification(run(Stage::Before, 0, 5e-3));
        session.add_verification(run(Stage::Before, 0, 2e-3));
        let alone = before_and_after(&session).expect("figures");
        assert_eq!(alone[0].gain(), None);
        session.add_verification(run(Stage::After, 0, 5e-4));
        let both = before_and_after(&session).expect("figures");
        assert_eq!(both[0].name, "Pose accuracy, mean");
        assert!((both[0].gain().expect("both") - 0.75).abs() < 1e-9);
    }
}
