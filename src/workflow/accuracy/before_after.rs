//! Figures before and after the adjustment, beside each other.

use tautline_core::geometry::Pose;
use tautline_core::planning::position_jacobians;
use tautline_session::{CheckKind, CheckPose, CheckRow, Session, Stage, Verification};

use super::{Accuracy, VerificationDocument};
use crate::identification::Identification;
use crate::plot::figure::{self, Axis, Curve, Ink, Marker, Point, Series};

/// Name of the largest error of a pose.
pub const LARGEST: &str = "Pose accuracy, largest";

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

/// The result of an adjustment in a sentence, such as `Pose accuracy, mean: 1.11 mm before, 0.26 mm after; predicted 0.66 mm.`;
/// `None` before both runs are there.
#[must_use]
pub fn result_in_words(figures: &[Figure], predicted_m: Option<f64>) -> Option<String> {
    let main = figures.iter().find(|one| one.gain().is_some())?;
    let [before, after] = [main.before_m?, main.after_m?].map(|metres| 1e3 * metres);
    let predicted = predicted_m.map_or_else(String::new, |metres| {
        format!("; predicted {:.2} mm", 1e3 * metres)
    });
    let name = &main.name;
    Some(format!(
        "{name}: {before:.2} mm before, {after:.2} mm after{predicted}."
    ))
}

/// Root mean square of the position error (m) that the standard deviations of an identification predict at the poses of a run;
/// `None` where they are not determined.
#[must_use]
pub fn predicted_m(fit: &Identification, run: &Verification) -> Option<f64> {
    let is_first = |row: &&CheckRow| row.kind == CheckKind::Pose && row.cycle == run.rows[0].cycle;
    let pose = |row: &CheckRow| {
        let upright = [1.0, 0.0, 0.0, 0.0];
        let CheckPose {
            position_m,
            orientation_wxyz,
        } = row.commanded;
        Pose::from_parts(position_m, orientation_wxyz.unwrap_or(upright))
    };
    let targets: Vec<Pose> = run.rows.iter().filter(is_first).map(pose).collect();
    let solution = &fit.solution;
    let errors = position_jacobians(&fit.model, &targets, &solution.parameters)?;
    let covariance = solution.covariance.as_ref()?;
    let squares = errors
        .iter()
        .map(|error| (error * covariance * error.transpose()).trace());
    let mean = squares.sum::<f64>() / targets.len() as f64;
    (mean > 0.0).then(|| mean.sqrt())
}

/// Pose accuracies of the last run of each stage, in the order of the run, with the predicted error.
///
/// # Errors
/// One sentence if the rows of a run do not make them.
pub fn plot_of_errors(
    session: &Session,
    predicted_m: Option<f64>,
) -> Result<figure::Figure, String> {
    let runs = VerificationDocument::of(session, Stage::After)?;
    let series = |name, ink, marker, run: Option<Accuracy>| {
        let targets = (1_u32..).zip(run?.poses?.targets);
        let points = targets
            .map(|(number, target)| Point::new(number.into(), 1e3 * target.figures.accuracy_m));
        Some(Series::new(name, ink, marker, points.collect()))
    };
    let before = series("before", Ink::Warning, Marker::Circle, runs.before);
    let after = series("after", Ink::Accent, Marker::Square, runs.after);
    let series: Vec<Series> = before.into_iter().chain(after).collect();
    let most = series.iter().map(|one| one.points().len()).max();
    let ends = [1.0, most.unwrap_or(1) as f64];
    let predicted = predicted_m.map(|metres| Curve {
        dashed: true,
        ..Curve::new(
            "predicted",
            Ink::Text,
            ends.map(|x| [x, 1e3 * metres]).to_vec(),
        )
    });
    Ok(figure::Figure {
        x: Axis::whole("Test pose"),
        y: Axis::new("Position error", "mm"),
        series,
        curves: predicted.into_iter().collect(),
        ..figure::Figure::default()
    })
}

fn named(accuracy: Accuracy) -> Vec<(String, f64)> {
    let mut figures = Vec::new();
    if let Some(poses) = accuracy.poses {
        figures.extend([
            ("Pose accuracy, mean".to_owned(), poses.mean_accuracy_m),
            (LARGEST.to_owned(), poses.largest_accuracy_m),
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
    use tautline_session::Timestamp;

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
        let text = result_in_words(&both, Some(6.6e-4)).expect("both runs");
        assert_eq!(
            text,
            "Pose accuracy, mean: 2.00 mm before, 0.50 mm after; predicted 0.66 mm."
        );
        let plot = plot_of_errors(&session, None).expect("a plot");
        let errors = plot.series.iter().map(|one| one.points()[0].y);
        let errors: Vec<String> = errors.map(|mm| format!("{mm:.3}")).collect();
        assert_eq!(errors, ["2.000", "0.500"]);
    }
}
