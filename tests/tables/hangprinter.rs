//! A real machine: Hangprinter 4, four lines, point mass. The data are not part of this repository; the
//! folder that holds `series1` and `series2` is given.

use std::path::Path;

use anyhow::{Context, Result};
use tautline_core::diagnosis::{Cause, Finding, Verdict};
use tautline_core::effect::{EffectRequest, find};
use tautline_core::estimation::{
    Analysis, Geometry, Globals, ObservationKind, Poses, Problem, Solution,
};
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_session::read_dataset;

use super::markdown::table;
use super::simulated::{diagnosed, solved};

/// Folds of the cross-validation.
const FOLDS: usize = 5;

/// One model on the data.
#[derive(Debug, Clone)]
pub struct ModelRow {
    /// Freed effects.
    pub effects: &'static [&'static str],
    /// Chi-square of the whole problem on series 2.
    pub chi2: f64,
    /// Degrees of freedom.
    pub dof: f64,
    /// Common build-up of line with its standard deviation (1/rev), where freed.
    pub growth: Option<(f64, f64)>,
    /// Length residual with poses held at the camera's values (m).
    pub held_rms_m: f64,
    /// The same on held-out poses (m).
    pub held_out_rms_m: f64,
    /// Chi-square of series 1, poses fitted, model held.
    pub other_chi2: f64,
    /// Its degrees of freedom.
    pub other_dof: f64,
    /// Length residual of series 1, poses held at the camera's values, model held (m).
    pub other_rms_m: f64,
}

/// Effect and cables of a cause.
pub type Name = (&'static str, Vec<usize>);

/// The diagnosis of series 2.
#[derive(Debug, Clone)]
pub struct Opinion {
    /// Verdict, effect and targets of each finding, its alternatives after it.
    pub findings: Vec<(Verdict, Vec<Name>)>,
    /// Sentence, held-out error before and after of each finding.
    pub lines: Vec<(String, f64, f64)>,
    /// Build-up of line, the mean of all winches (1/rev), if there is one.
    pub growth: Option<f64>,
    /// Length residual of series 1, poses held at the camera's values, the extended model held (m).
    pub other_rms_m: f64,
}

/// Asks the doctor.
///
/// # Errors
/// If the data are absent or cannot be used.
pub fn opinion(folder: &Path) -> Result<Opinion> {
    let series2 = read_dataset(&folder.join("series2"))?.dataset;
    let series1 = read_dataset(&folder.join("series1"))?.dataset;
    let (diagnosis, _) = diagnosed(&series2)?;
    let model = diagnosis.extended_solution.globals.model(&series2.robot);
    let of = |cause: &Cause| (cause.effect().id(), cause.cables());
    let of_drums = |f: &&Finding| f.causes().any(|cause| cause.effect().id() == "drum_growth");
    let growth = diagnosis.findings.iter().find(of_drums).map(|f| {
        let values = f.parameters.iter().map(|p| p.value);
        values.sum::<f64>() / f.parameters.len() as f64
    });
    let all = diagnosis.findings.iter();
    Ok(Opinion {
        findings: all
            .clone()
            .map(|f| (f.verdict(), f.causes().map(of).collect()))
            .collect(),
        lines: all
            .map(|f| (f.sentence.clone(), f.gain.before, f.gain.after))
            .collect(),
        growth,
        other_rms_m: length_rms(&with_robot(&series1, &model), None)?,
    })
}

/// The diagnosis as Markdown.
#[must_use]
pub fn opinion_markdown(opinion: &Opinion) -> String {
    let findings = opinion.findings.iter().zip(&opinion.lines);
    let rows = findings.map(|((verdict, _), (sentence, before, after))| {
        format!("{verdict:?} | {before:.2} to {after:.2} | {sentence}")
    });
    format!(
        "The model doctor, asked about series 2 without a hint:\n\n{}\n\
         Its model predicts the lengths of series 1, poses held at the camera's values, to {:.2} mm rms.\n",
        table("verdict | held out, rms over sd | sentence", rows),
        opinion.other_rms_m * 1e3
    )
}

/// The models that are compared.
pub const MODELS: [&[&str]; 3] = [&[], &["winch_scale"], &["winch_scale", "drum_growth"]];

/// Fits all models.
///
/// # Errors
/// If the data are absent or cannot be used.
pub fn study(folder: &Path) -> Result<Vec<ModelRow>> {
    let series2 = read_dataset(&folder.join("series2"))?.dataset;
    let series1 = read_dataset(&folder.join("series1"))?.dataset;
    MODELS
        .iter()
        .map(|effects| row(effects, &series2, &series1))
        .collect()
}

fn row(effects: &'static [&'static str], series2: &Dataset, series1: &Dataset) -> Result<ModelRow> {
    let whole = fit(series2, effects, Poses::Estimated)?;
    let held = fit(series2, effects, Poses::HeldAtTracker)?;
    let model = held.globals.model(&series2.robot);
    let whole_model = whole.globals.model(&series2.robot);
    let other = with_robot(series1, &whole_model);
    let mut problem = Problem::new(&other)?;
    problem.geometry = Geometry::Held;
    let other_fit = solved(&problem)?;
    let build_up = find("drum_growth")
        .context("no build-up of the drum")?
        .title();
    let mut parameters = whole.parameters.iter();
    let growth = parameters.position(|p| p.name.starts_with(build_up));
    let value = |globals: &Globals| globals.effects.last().map_or(f64::NAN, |e| e.values[0]);
    Ok(ModelRow {
        effects,
        chi2: whole.chi2,
        dof: whole.degrees_of_freedom,
        growth: growth.map(|k| {
            (
                value(&whole.globals),
                whole.standard_deviation(k).unwrap_or(f64::NAN),
            )
        }),
        held_rms_m: length_rms(&with_robot(series2, &model), None)?,
        held_out_rms_m: held_out(series2, effects)?,
        other_chi2: other_fit.chi2,
        other_dof: other_fit.degrees_of_freedom,
        other_rms_m: length_rms(&with_robot(series1, &model), None)?,
    })
}

fn fit(dataset: &Dataset, effects: &[&str], poses: Poses) -> Result<Solution> {
    let requests: Vec<_> = effects
        .iter()
        .map(|e| EffectRequest::parse(e).expect("an effect"))
        .collect();
    let mut problem = Problem::new(dataset)?;
    problem.poses = poses;
    problem.free(&requests)?;
    solved(&problem)
}

fn with_robot(dataset: &Dataset, robot: &Robot) -> Dataset {
    Dataset {
        robot: robot.clone(),
        measurements: dataset.measurements.clone(),
    }
}

/// Length residual of a model with poses held at the camera's values (m), of all rows or some.
fn length_rms(dataset: &Dataset, rows: Option<&[usize]>) -> Result<f64> {
    let mut problem = Problem::new(dataset)?;
    problem.geometry = Geometry::Held;
    problem.poses = Poses::HeldAtTracker;
    let analysis = Analysis::new(&problem, &solved(&problem)?);
    let squares: Vec<f64> = analysis
        .observations
        .iter()
        .filter(|r| matches!(r.kind, ObservationKind::Length(_)))
        .filter(|r| rows.is_none_or(|rows| rows.contains(&r.row)))
        .map(|r| r.residual().powi(2))
        .collect();
    Ok((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// Cross-validation over poses, poses held at the camera's values (m).
fn held_out(dataset: &Dataset, effects: &[&str]) -> Result<f64> {
    let count = dataset.measurements.len();
    let (mut sum, mut number) = (0.0, 0.0);
    for fold in 0..FOLDS {
        let out = |row: &usize| *row > 0 && *row % FOLDS == fold;
        let kept: Vec<usize> = (0..count).filter(|row| !out(row)).collect();
        let training = Dataset {
            robot: dataset.robot.clone(),
            measurements: dataset.measurements.select(&kept),
        };
        let fitted = fit(&training, effects, Poses::HeldAtTracker)?;
        let rows: Vec<usize> = (0..count)
            .filter(out)
            .filter(|row| dataset.measurements.tracked_position_at(*row).is_some())
            .collect();
        let model = fitted.globals.model(&dataset.robot);
        let rms = length_rms(&with_robot(dataset, &model), Some(&rows))?;
        sum += rms * rms * rows.len() as f64;
        number += rows.len() as f64;
    }
    Ok((sum / number).sqrt())
}

/// The table as Markdown.
#[must_use]
pub fn markdown(rows: &[ModelRow]) -> String {
    let rows = rows.iter().map(|row| {
        let effects = match row.effects {
            [] => "-".to_owned(),
            effects => effects.join(", "),
        };
        let growth = row.growth.map_or("-".to_owned(), |(value, sd)| {
            format!("({:.2} ± {:.2})e-4", value * 1e4, sd * 1e4)
        });
        format!(
            "{effects} | {:.1} | {:.0} | {growth} | {:.2} | {:.2} | {:.1} | {:.0} | {:.2}",
            row.chi2,
            row.dof,
            row.held_rms_m * 1e3,
            row.held_out_rms_m * 1e3,
            row.other_chi2,
            row.other_dof,
            row.other_rms_m * 1e3,
        )
    });
    table(
        "freed besides anchors | chi-square | dof | build-up per motor revolution | lengths, poses held, rms mm | 5-fold held out mm | series 1: chi-square | dof | lengths, poses held, rms mm",
        rows,
    )
}
