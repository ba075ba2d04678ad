//! Table 1 of Jin et al. 2018 on simulated data: MINI with its measured geometry as the truth
//! and its drawing as nominal, identified by each method.

use std::time::Instant;

use anyhow::{Context, Result, anyhow};
use nalgebra::Vector3;
use tautline_core::estimation::published::{PublishedOptions, identify_published};
use tautline_core::estimation::{Method, Problem};
use tautline_core::geometry::Pose;
use tautline_core::kinematics::{ForwardKinematics, inverse_kinematics};
use tautline_core::measurement::Dataset;
use tautline_core::robot::{Home, Robot};
use tautline_core::simulation::{Simulated, SimulationOptions, TrueGeometry, simulate};

use super::markdown::table;
use super::simulated::{preset, preset_options, solved};

/// Measured poses, as in the paper.
pub const POSES: usize = 25;
/// Other poses at which the platform position is judged.
pub const TEST_POSES: usize = 100;

/// One method over all data sets.
#[derive(Debug, Clone)]
pub struct MethodRow {
    /// Name of the method.
    pub method: &'static str,
    /// Root mean square error of an entry point coordinate (m).
    pub entry_error_m: f64,
    /// Root mean square platform position error at other poses, in the base frame (m).
    pub position_error_m: f64,
    /// The same relative to the home pose, from which every motion starts (m).
    pub relative_error_m: f64,
    /// Least time of one identification (s); nothing for the drawing.
    pub seconds: Option<f64>,
}

/// Entry points and home pose that a method arrives at.
struct Outcome {
    entry_points: Vec<[f64; 3]>,
    home: Pose,
    seconds: Option<f64>,
}

type Identify = fn(&Simulated) -> Result<Outcome>;

const METHODS: [(&str, Identify); 5] = [
    ("drawing", drawing),
    (
        "published method, 8 coordinates given exactly",
        published_given,
    ),
    ("published method, nothing given", published_alone),
    ("joint method R1 (tensions exact)", joint_simple),
    ("joint method R2 (default)", joint),
];

/// Runs all methods on `data_sets` data sets.
///
/// # Errors
/// If a data set cannot be simulated or identified.
pub fn study(data_sets: usize) -> Result<Vec<MethodRow>> {
    let mut sums = [(0.0, [0.0; 2], None::<f64>); METHODS.len()];
    for seed in 1..=data_sets as u64 {
        let run = mini_run(seed)?;
        let tests = test_poses(&run.truth, seed)?;
        for ((_, identify), sum) in METHODS.iter().zip(&mut sums) {
            let outcome = identify(&run)?;
            sum.0 += entry_error(&outcome, &run.truth).powi(2);
            let believed = (&outcome.entry_points[..], &outcome.home);
            let errors = position_errors(believed, (&run.dataset.robot, &run.truth), &tests)?;
            sum.1[0] += errors[0].powi(2);
            sum.1[1] += errors[1].powi(2);
            sum.2 = match (sum.2, outcome.seconds) {
                (Some(least), Some(seconds)) => Some(least.min(seconds)),
                (least, seconds) => least.or(seconds),
            };
        }
    }
    let n = data_sets as f64;
    Ok(METHODS
        .iter()
        .zip(sums)
        .map(
            |((method, _), (entry, [position, relative], seconds))| MethodRow {
                method,
                entry_error_m: (entry / n).sqrt(),
                position_error_m: (position / n).sqrt(),
                relative_error_m: (relative / n).sqrt(),
                seconds,
            },
        )
        .collect())
}

/// MINI: measured column as truth, drawing as nominal.
fn mini_run(seed: u64) -> Result<Simulated> {
    let preset = preset("mini")?;
    let points = preset
        .measured_entry_points_m
        .clone()
        .context("MINI has no measured points")?;
    let options = SimulationOptions {
        geometry: TrueGeometry::EntryPoints(points),
        ..preset_options(&preset, POSES, seed)
    };
    Ok(simulate(&preset.robot, &options)?)
}

/// Poses that took no part in measuring.
fn test_poses(truth: &Robot, seed: u64) -> Result<Vec<Pose>> {
    let preset = preset("mini")?;
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        ..preset_options(&preset, TEST_POSES, seed + 1_000_000)
    };
    let poses = simulate(truth, &options)?.dataset.measurements.truth.poses;
    Ok(poses[1..].to_vec())
}

fn nominal_home(robot: &Robot) -> Result<Pose> {
    let home = robot.home.as_ref().map(Home::pose);
    home.ok_or_else(|| anyhow!("MINI has no home pose"))
}

fn entry_points(robot: &Robot) -> Vec<[f64; 3]> {
    let cables = robot.cables.iter();
    cables.map(|cable| cable.pulley.entry_point_m).collect()
}

fn drawing(run: &Simulated) -> Result<Outcome> {
    Ok(Outcome {
        entry_points: entry_points(&run.dataset.robot),
        home: nominal_home(&run.dataset.robot)?,
        seconds: None,
    })
}

fn published_given(run: &Simulated) -> Result<Outcome> {
    published(run, Some(entry_points(&run.truth)))
}

fn published_alone(run: &Simulated) -> Result<Outcome> {
    published(run, None)
}

fn published(run: &Simulated, given: Option<Vec<[f64; 3]>>) -> Result<Outcome> {
    let options = PublishedOptions {
        given_entry_points_m: given,
        ..PublishedOptions::for_robot(&run.dataset.robot)
    };
    let start = Instant::now();
    let result = identify_published(&run.dataset, &options)?;
    Ok(Outcome {
        entry_points: result.entry_points_m,
        home: nominal_home(&run.dataset.robot)?,
        seconds: Some(start.elapsed().as_secs_f64()),
    })
}

fn joint_simple(run: &Simulated) -> Result<Outcome> {
    jointly(&run.dataset, Method::Simple)
}

fn joint(run: &Simulated) -> Result<Outcome> {
    jointly(&run.dataset, Method::Joint)
}

fn jointly(dataset: &Dataset, method: Method) -> Result<Outcome> {
    let problem = Problem::new(dataset)?.with_method(method);
    let start = Instant::now();
    let solution = solved(&problem)?;
    Ok(Outcome {
        seconds: Some(start.elapsed().as_secs_f64()),
        entry_points: solution.globals.entry_points,
        home: solution.globals.home,
    })
}

fn entry_error(outcome: &Outcome, truth: &Robot) -> f64 {
    let truth = entry_points(truth);
    let pairs = outcome.entry_points.iter().zip(&truth);
    let square = |(found, truth): (&[f64; 3], &[f64; 3])| {
        (Vector3::from(*found) - Vector3::from(*truth)).norm_squared()
    };
    let sum: f64 = pairs.map(square).sum();
    (sum / (3 * truth.len()) as f64).sqrt()
}

/// The controller pays out the length that the identified geometry predicts for the way from home to the test
/// pose; the true robot goes where its own geometry makes these lengths fit best. Errors in the base frame
/// and relative to home.
pub(crate) fn position_errors(
    (entry_points, believed_home): (&[[f64; 3]], &Pose),
    (drawing, truth): (&Robot, &Robot),
    tests: &[Pose],
) -> Result<[f64; 2]> {
    let mut believed = drawing.clone();
    for (cable, point) in believed.cables.iter_mut().zip(entry_points) {
        cable.pulley.entry_point_m = *point;
    }
    let lengths = |robot: &Robot, pose: &Pose| -> Result<Vec<f64>> {
        Ok(inverse_kinematics(robot, pose)?
            .iter()
            .map(|c| c.length_m)
            .collect())
    };
    let lengths_at_home = lengths(&believed, believed_home)?;
    let home = nominal_home(truth)?;
    let true_home = lengths(truth, &home)?;
    // Lengths of a wrong geometry do not fit exactly: any residual is accepted.
    let forward = ForwardKinematics::new(truth)?.with_residual_limit(1.0);
    let from_home =
        |home: &Pose, pose: &Pose| home.orientation.inverse() * (pose.position - home.position);
    let mut sums = [0.0; 2];
    for test in tests {
        let wanted = lengths(&believed, test)?;
        let attained: Vec<f64> = (0..wanted.len())
            .map(|k| true_home[k] + wanted[k] - lengths_at_home[k])
            .collect();
        let pose = forward.solve(&attained, test).pose;
        sums[0] += (pose.position - test.position).norm_squared();
        let relative = from_home(&home, &pose) - from_home(believed_home, test);
        sums[1] += relative.norm_squared();
    }
    Ok(sums.map(|sum| (sum / tests.len() as f64).sqrt()))
}

/// The table as Markdown.
#[must_use]
pub fn markdown(rows: &[MethodRow]) -> String {
    let better = |now: f64, before: f64| (1.0 - now / before) * 100.0;
    let rows = rows.iter().map(|row| {
        let drawing = &rows[0];
        let time = row.seconds.map(|s| format!("{:.2} ms", s * 1e3));
        format!(
            "{} | {:.2} | {:.3} | {:.1} % | {:.3} | {:.1} % | {}",
            row.method,
            row.entry_error_m * 1e3,
            row.position_error_m * 1e3,
            better(row.position_error_m, drawing.position_error_m),
            row.relative_error_m * 1e3,
            better(row.relative_error_m, drawing.relative_error_m),
            time.as_deref().unwrap_or("-"),
        )
    });
    table(
        "method | entry point coordinates, rms error mm | platform position, rms error mm | improvement | relative to home mm | improvement | time",
        rows,
    )
}
