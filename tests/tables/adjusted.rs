//! Accuracy of a robot before and after an adjustment: the whole loop of the commands on the simulated MINI, over many
//! seeds.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::support::program::program;

/// Seeds of the robots and their noise.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=20;
/// Numbers of poses, the methods by which they are identified, and how often the home pose is measured; `None`: it is
/// that of the drawing, which counts as one measurement.
const ROWS: [(usize, &str, Option<usize>); 11] = [
    (25, "joint", None),
    (25, "simple", None),
    (25, "published", None),
    (25, "joint", Some(1)),
    (25, "joint", Some(4)),
    (25, "joint", Some(16)),
    (100, "joint", None),
    (400, "joint", None),
    (400, "joint", Some(1)),
    (400, "joint", Some(4)),
    (400, "joint", Some(16)),
];

/// Figures of one robot (m).
#[derive(Debug, Clone, Copy)]
struct Figures {
    /// Mean position accuracy at the poses of the cubes, before and after.
    pose: [f64; 2],
    /// Path accuracy on the circle, before and after.
    circle: [f64; 2],
}

/// What many robots make of one number of poses and one method.
#[derive(Debug, Clone)]
pub struct Row {
    poses: usize,
    method: &'static str,
    /// How often the home pose is measured.
    home: Option<usize>,
    /// Root mean square position error that the plan promises (m), and that with the home pose known exactly; only for the
    /// method that plans are made for.
    expected_m: Option<[f64; 2]>,
    robots: Vec<Figures>,
}

/// Runs everything. Each robot is measured and verified once for each number of poses; the rows go on from copies of that
/// session, and differ in the home pose and the method alone.
///
/// # Errors
/// If a command fails.
pub fn study() -> Result<Vec<Row>> {
    let folder = tempfile::tempdir()?;
    let mut rows = Vec::with_capacity(ROWS.len());
    for of_one_number in ROWS.chunk_by(|a, b| a.0 == b.0) {
        let plan = Plan::make(folder.path(), of_one_number[0].0)?;
        let mut robots = vec![Vec::new(); of_one_number.len()];
        for seed in SEEDS {
            let measured = measured(folder.path(), &plan, seed)?;
            for (row, robots) in of_one_number.iter().zip(&mut robots) {
                robots.push(adjusted(&measured, *row)?);
            }
        }
        for (&(poses, method, home), robots) in of_one_number.iter().zip(robots) {
            let is_planned = method == "joint";
            rows.push(Row {
                poses,
                method,
                home,
                expected_m: is_planned.then(|| plan.expected_m(home)).transpose()?,
                robots,
            });
        }
    }
    Ok(rows)
}

/// The poses that all robots measure, and what their plan promises.
struct Plan {
    file: PathBuf,
    document: Value,
}

impl Plan {
    fn make(folder: &Path, poses: usize) -> Result<Self> {
        let file = folder.join("plan.csv");
        let poses = poses.to_string();
        let arguments = ["plan", "mini", "--poses", &poses, "--json", "-"];
        let document = answer(&[&arguments[..], &["--out", text(&file)?]].concat())?;
        Ok(Self { file, document })
    }

    /// Position error (m) with the home pose measured so often, and with the home pose known exactly.
    fn expected_m(&self, home: Option<usize>) -> Result<[f64; 2]> {
        let gains = self.document["home"].as_array();
        let with = |times: Option<usize>| {
            let mut gains = gains.into_iter().flatten();
            let gain = gains.find(|gain| gain["times"] == serde_json::json!(times));
            let value = gain.and_then(|gain| gain["platform_m"].as_f64());
            value.context("the plan promises nothing")
        };
        Ok([with(Some(home.unwrap_or(1)))?, with(None)?])
    }
}

/// Every command on a session needs these.
const ROBOT: [&str; 3] = ["--controller", "sim", "--arm"];
const TARGETS: [&str; 2] = ["--targets", "cube,circle"];

/// The session of a robot that was measured and verified.
fn measured(folder: &Path, plan: &Plan, seed: u64) -> Result<PathBuf> {
    let file = folder.join("measured.json");
    if file.exists() {
        fs::remove_file(&file)?;
    }
    let (seed, poses) = (seed.to_string(), text(&plan.file)?);
    let new = ["--robot", "mini", "--plan", poses, "--seed", &seed];
    told("measure", &file, &new)?;
    told("verify", &file, &TARGETS)?;
    Ok(file)
}

fn adjusted(measured: &Path, (_, method, home): (usize, &str, Option<usize>)) -> Result<Figures> {
    let file = measured.with_file_name("adjusted.json");
    fs::copy(measured, &file)?;
    if let Some(repeats) = home {
        told("home", &file, &["--repeats", &repeats.to_string()])?;
    }
    let by = ["--method", method, "--allow-unconverged"];
    told("adjust", &file, &by)?;
    let both = told("verify", &file, &TARGETS)?;
    let figure = |pointer: &str| {
        let value = both.pointer(pointer).and_then(Value::as_f64);
        value.with_context(|| format!("no {pointer}"))
    };
    Ok(Figures {
        pose: [
            figure("/before/poses/mean_accuracy_m")?,
            figure("/after/poses/mean_accuracy_m")?,
        ],
        circle: [
            figure("/before/paths/0/accuracy_m")?,
            figure("/after/paths/0/accuracy_m")?,
        ],
    })
}

/// The result document of a command on a session.
fn told(command: &str, file: &Path, arguments: &[&str]) -> Result<Value> {
    let session = [command, text(file)?, "--json", "-"];
    answer(&[&session[..], &ROBOT, arguments].concat())
}

fn text(path: &Path) -> Result<&str> {
    path.to_str()
        .context("the folder has a name that is no text")
}

fn answer(arguments: &[&str]) -> Result<Value> {
    let output = Command::new(program()).args(arguments).output()?;
    ensure!(
        output.status.success(),
        "{arguments:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// The table.
#[must_use]
pub fn markdown(rows: &[Row]) -> String {
    let mut text = "| poses | method | home measured | position accuracy before, mm | after, mm | better by, % | expected, mm | home exact, mm | circle before, mm | after, mm | below 0.3 mm |\n|---|---|---|---|---|---|---|---|---|---|---|\n".to_owned();
    for row in rows {
        let of = |get: &dyn Fn(&Figures) -> f64| {
            let mut values: Vec<f64> = row.robots.iter().map(get).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let mm = |get: &dyn Fn(&Figures) -> f64| range(&of(&|f| get(f) * 1e3), 2);
        let close = row.robots.iter().filter(|f| f.circle[1] < 3e-4).count();
        text.push_str(&format!(
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {close} of {} |\n",
            row.poses,
            row.method,
            row.home
                .map_or("drawing".to_owned(), |times| format!("{times}")),
            mm(&|f| f.pose[0]),
            mm(&|f| f.pose[1]),
            range(&of(&|f| 100.0 * (1.0 - f.pose[1] / f.pose[0])), 0),
            expected(row, 0),
            expected(row, 1),
            mm(&|f| f.circle[0]),
            mm(&|f| f.circle[1]),
            row.robots.len(),
        ));
    }
    text
}

fn expected(row: &Row, which: usize) -> String {
    let expected = row.expected_m.map(|values| values[which] * 1e3);
    expected.map_or("-".to_owned(), |mm| format!("{mm:.2}"))
}

/// Median, least and greatest of sorted values.
fn range(sorted: &[f64], decimals: usize) -> String {
    let middle = sorted.len() / 2;
    let median = match sorted.len() % 2 {
        0 => 0.5 * (sorted[middle - 1] + sorted[middle]),
        _ => sorted[middle],
    };
    let (least, greatest) = (sorted[0], sorted[sorted.len() - 1]);
    format!("{median:.decimals$} ({least:.decimals$} to {greatest:.decimals$})")
}
