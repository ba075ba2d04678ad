//! Accuracy measured by an external instrument: figures of ISO 9283.

use tautline_core::accuracy::iso9283::Target;
use tautline_session::{CheckKind, CheckRow, Session, Stage};

use super::{NONE, when};
use crate::accuracy::{
    Accuracy, Group, UncertainFigure, UncertainPoseFigures, accuracy, group, pose_uncertainties,
};
use crate::adjusting::verified_before_last_write;
use crate::report::document::{Section, Table};
use crate::wording::units::{decimals_of_uncertainty, fixed, mm, quantity, signed};

/// A run with its figures, or the reason why there are none.
struct Run {
    name: String,
    stage: Option<Stage>,
    figures: Result<Figures, String>,
}

/// Figures with their uncertainties.
struct Figures {
    whole: Accuracy,
    poses: Option<UncertainPoseFigures>,
    /// Of each path with figures, in their order.
    paths: Vec<UncertainPoseFigures>,
}

fn figures(rows: &[CheckRow], instrument_sd_m: f64) -> Result<Figures, String> {
    let groups = group(rows)?;
    let points = |group: &Group| -> Vec<Target> {
        group
            .points
            .iter()
            .map(|point| point.target.clone())
            .collect()
    };
    let (poses, paths): (Vec<&Group>, Vec<&Group>) =
        (groups.iter()).partition(|group| group.kind == CheckKind::Pose);
    let poses: Vec<Target> = poses.into_iter().flat_map(points).collect();
    let of_path = |path: &Group| pose_uncertainties(&points(path), instrument_sd_m);
    Ok(Figures {
        whole: accuracy(&groups)?,
        poses: pose_uncertainties(&poses, instrument_sd_m),
        paths: paths.into_iter().filter_map(of_path).collect(),
    })
}

/// Standard uncertainty of a position by the external instrument (m), as the robot's description states it.
fn instrument_sd_m(session: &Session) -> Option<f64> {
    let tracker = session.robot.tracker.as_ref()?;
    Some((tracker.position_sd_m.each().into_iter()).fold(0.0, f64::max))
}

fn runs(session: &Session) -> Vec<Run> {
    let instrument_sd_m = instrument_sd_m(session).unwrap_or(0.0);
    let figures = |rows: &[CheckRow]| figures(rows, instrument_sd_m);
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
        let mut poses = of_stage.filter_map(|run| run.figures.as_ref().ok()?.whole.poses.as_ref());
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
        "Poses: accuracy AP, repeatability RP, distance accuracy AD and drift dAP of ISO 9283:1998 with expanded uncertainties (mm)",
        2,
        &[
            "Run",
            "stage",
            "poses",
            "AP mean",
            "AP largest",
            "RP mean",
            "RP largest",
            "AD largest",
            "dAP largest",
        ],
    );
    let mut paths = Table::new(
        "Paths: accuracy AT and repeatability RT of ISO 9283:1998 with expanded uncertainties (mm)",
        3,
        &["Run", "stage", "path", "cycles", "AT", "RT"],
    );
    for run in &runs {
        match &run.figures {
            Ok(figures) => add(run, figures, &mut poses, &mut paths),
            Err(error) => section.paragraph(format!("{}: no figures, {error}.", run.name)),
        }
    }
    section.table(poses);
    section.table(paths);
    let instrument = match instrument_sd_m(session) {
        Some(sd_m) => format!(
            "the instrument ({}, common to all cycles)",
            quantity(sd_m, "m")
        ),
        None => "the instrument is not stated and taken as exact".to_owned(),
    };
    section.note(format!(
        "Uncertainties for a coverage probability of 95 %, by the t distribution: scatter of the cycles; {instrument}. AD: successive poses. dAP: from the first half of the cycles to the last, by four cycles or more; the instrument cancels."
    ));
    Some(section)
}

/// A figure with its uncertainty, to two digits of that.
fn figure(of: UncertainFigure, show: fn(f64, usize) -> String) -> String {
    let expanded = 1e3 * of.expanded_m;
    if !(expanded.is_finite() && expanded > 0.0) {
        return mm(of.value_m, 2);
    }
    let digits = decimals_of_uncertainty(expanded);
    format!(
        "{} ± {}",
        show(1e3 * of.value_m, digits),
        fixed(expanded, digits)
    )
}

fn add(run: &Run, figures: &Figures, poses: &mut Table, paths: &mut Table) {
    let stage = match run.stage {
        Some(Stage::Before) => "as found",
        Some(Stage::After) => "as left",
        None => NONE,
    };
    if let (Some(found), Some(poses_of)) = (&figures.poses, &figures.whole.poses) {
        let or_none = |of: Option<UncertainFigure>, show| {
            of.map_or_else(|| NONE.to_owned(), |one| figure(one, show))
        };
        poses.push([
            run.name.clone(),
            stage.to_owned(),
            poses_of.targets.len().to_string(),
            figure(found.mean_accuracy, fixed),
            figure(found.largest_accuracy, fixed),
            figure(found.mean_repeatability, fixed),
            figure(found.largest_repeatability, fixed),
            or_none(found.largest_distance_accuracy, signed),
            or_none(found.largest_drift, fixed),
        ]);
    }
    for (path, found) in figures.whole.paths.iter().zip(&figures.paths) {
        paths.push([
            run.name.clone(),
            stage.to_owned(),
            path.target.clone(),
            path.cycles.to_string(),
            figure(found.largest_accuracy, fixed),
            figure(found.largest_repeatability, fixed),
        ]);
    }
}
