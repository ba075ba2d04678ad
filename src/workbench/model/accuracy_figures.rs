//! Figures of ISO 9283 before and after, from the verification runs of a session.

use tautline_session::{Session, Stage, Verification};

use tautline_workflow::accuracy;

/// One figure of accuracy (m), before and after.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    pub name: String,
    pub before_m: Option<f64>,
    pub after_m: Option<f64>,
}

impl Figure {
    /// Part by which the error has become smaller, where both are known.
    pub fn gain(&self) -> Option<f64> {
        let (before, after) = self.before_m.zip(self.after_m)?;
        (before > 0.0).then(|| 1.0 - after / before)
    }
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Figures {
    /// In the order of the table.
    pub lines: Vec<Figure>,
}

type Named = Vec<(String, f64)>;

/// The figures of the last run of each stage.
///
/// # Errors
/// One sentence if the rows of a run do not make one.
pub fn figures(session: &Session) -> Result<Figures, String> {
    let last = |stage: Stage| {
        let runs = session.verifications().iter().rev();
        let mut of_stage = runs.filter(|run| run.stage == stage);
        of_stage.next().map(of_run).transpose()
    };
    let before = last(Stage::Before)?.unwrap_or_default();
    let after = last(Stage::After)?.unwrap_or_default();
    let names = before.iter().chain(&after).map(|(name, _)| name);
    let mut lines: Vec<Figure> = Vec::new();
    for name in names {
        if lines.iter().all(|line| line.name != *name) {
            let of = |side: &Named| side.iter().find(|(n, _)| n == name).map(|(_, m)| *m);
            lines.push(Figure {
                name: name.clone(),
                before_m: of(&before),
                after_m: of(&after),
            });
        }
    }
    Ok(Figures { lines })
}

fn of_run(run: &Verification) -> Result<Named, String> {
    let accuracy = accuracy::figures(&run.rows)?;
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
    Ok(figures)
}

#[cfg(test)]
pub(super) mod tests {
    use tautline_core::robot::presets;
    use tautline_session::{CheckKind, CheckPose, CheckRow, Timestamp};

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
        let alone = figures(&session).expect("figures");
        assert_eq!(alone.lines[0].gain(), None);
        session.add_verification(run(Stage::After, 0, 5e-4));
        let both = figures(&session).expect("figures");
        assert_eq!(both.lines[0].name, "Pose accuracy, mean");
        assert!((both.lines[0].gain().expect("both") - 0.75).abs() < 1e-9);
    }
}
