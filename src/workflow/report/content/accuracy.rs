//! Accuracy measured by an external instrument: figures of ISO 9283.

use tautline_session::{CheckRow, Session, Stage};

use super::{NONE, when};
use crate::accuracy::{Accuracy, figures};
use crate::adjusting::verified_before_last_write;
use crate::report::document::{Section, Table};
use crate::wording::units::mm;
use crate::wording::units::quantity;

/// A run with its figures, or the reason why there are none.
struct Run {
    name: String,
    stage: Option<Stage>,
    figures: Result<Accuracy, String>,
}

fn runs(session: &Session) -> Vec<Run> {
    let verifications = session.verifications().iter().map(|run| Run {
        name: format!("{} ({})", run.title, when(run.time)),
        stage: Some(run.stage),
        figures: figures(&run.rows),
    });
    let check: &[CheckRow] = &session.phases.check;
    let check = (!check.is_empty()).then(|| Run {
        name: "Imported check".to_owned(),
        stage: None,
        figures: figures(check),
    });
    verifications.chain(check).collect()
}

/// Accuracy before and after the adjustment, if both were measured.
pub fn summary(session: &Session) -> Option<String> {
    let runs = runs(session);
    let last = |stage: Stage| {
        let of_stage = runs.iter().rev().filter(|run| run.stage == Some(stage));
        let mut poses = of_stage.filter_map(|run| run.figures.as_ref().ok()?.poses.as_ref());
        poses.next().map(|poses| poses.mean_accuracy_m)
    };
    let (before, after) = (last(Stage::Before)?, last(Stage::After)?);
    let share = 100.0 * (1.0 - after / before);
    let change = if share >= 0.5 {
        format!("{share:.0} % better")
    } else {
        "no better".to_owned()
    };
    let old = match verified_before_last_write(session) {
        true => " The accuracy after it was measured before the values were last written.",
        false => "",
    };
    Some(format!(
        "Mean position accuracy (ISO 9283): {} before the adjustment, {} after it, {change}.{old}",
        quantity(before, "m"),
        quantity(after, "m")
    ))
}

pub fn section(session: &Session) -> Option<Section> {
    let runs = runs(session);
    if runs.is_empty() {
        return None;
    }
    let mut section = Section::new("Accuracy by an external instrument");
    if let Some(text) = summary(session) {
        section.lead(text);
    }
    let mut poses = Table::new(
        "Poses: accuracy AP and repeatability RP of ISO 9283:1998 (mm)",
        2,
        &[
            "Run",
            "adjustment",
            "poses",
            "AP mean",
            "AP largest",
            "RP mean",
            "RP largest",
        ],
    );
    let mut paths = Table::new(
        "Paths: accuracy AT and repeatability RT of ISO 9283:1998 (mm)",
        3,
        &["Run", "adjustment", "path", "cycles", "AT", "RT"],
    );
    for run in &runs {
        match &run.figures {
            Ok(figures) => add(run, figures, &mut poses, &mut paths),
            Err(error) => section.paragraph(format!("{}: no figures, {error}.", run.name)),
        }
    }
    section.table(poses);
    section.table(paths);
    Some(section)
}

fn add(run: &Run, figures: &Accuracy, poses: &mut Table, paths: &mut Table) {
    let stage = match run.stage {
        Some(Stage::Before) => "before",
        Some(Stage::After) => "after",
        None => NONE,
    };
    let length = |value: f64| {
        if value.is_finite() {
            mm(value, 2)
        } else {
            NONE.to_owned()
        }
    };
    if let Some(found) = &figures.poses {
        poses.push([
            run.name.clone(),
            stage.to_owned(),
            found.targets.len().to_string(),
            length(found.mean_accuracy_m),
            length(found.largest_accuracy_m),
            length(found.mean_repeatability_m),
            length(found.largest_repeatability_m),
        ]);
    }
    for path in &figures.paths {
        paths.push([
            run.name.clone(),
            stage.to_owned(),
            path.target.clone(),
            path.cycles.to_string(),
            length(path.accuracy_m),
            length(path.repeatability_m),
        ]);
    }
}
