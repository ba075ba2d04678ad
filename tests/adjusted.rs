//! Accuracy of a robot before and after an adjustment: the whole loop of the commands on the simulated MINI, over many
//! seeds.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::program::program;

/// Seeds of the robots, their noise and their plans.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=20;
/// Numbers of poses, the methods by which they are identified, and how often the home pose is measured; `None`: it is
/// that of the drawing, which counts as one measurement.
const ROWS: [(usize, &str, Option<usize>); 11] = [
    (25, "joint", None),
    (25, "simple", None),
    (25, "published", None),
    (100, "joint", None),
    (400, "joint", None),
    (25, "joint", Some(1)),
    (25, "joint", Some(4)),
    (25, "joint", Some(16)),
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

/// Runs everything.
///
/// # Errors
/// If a command fails.
pub fn study() -> Result<Vec<Row>> {
    let rows = ROWS.iter().map(|&(poses, method, home)| {
        let robots: Result<Vec<_>> = SEEDS
            .map(|seed| figures((poses, method, home), seed))
            .collect();
        let is_planned = method == "joint";
        Ok(Row {
            poses,
            method,
            home,
            expected_m: is_planned.then(|| expected_m(poses, home)).transpose()?,
            robots: robots?,
        })
    });
    rows.collect()
}

fn figures((poses, method, home): (usize, &str, Option<usize>), seed: u64) -> Result<Figures> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("mini.json");
    let (poses, seed) = (poses.to_string(), seed.to_string());
    let robot = ["--controller", "sim", "--arm"];
    let new = ["--robot", "mini", "--poses", &poses, "--seed", &seed];
    told("measure", &file, &[&robot[..], &new].concat())?;
    let targets = ["--targets", "cube,circle"];
    told("verify", &file, &[&robot[..], &targets].concat())?;
    if let Some(repeats) = home {
        let repeats = repeats.to_string();
        told(
            "home",
            &file,
            &[&robot[..], &["--repeats", &repeats]].concat(),
        )?;
    }
    let by = ["--method", method, "--allow-unconverged"];
    told("adjust", &file, &[&robot[..], &by].concat())?;
    let both = told("verify", &file, &[&robot[..], &targets].concat())?;
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

fn expected_m(poses: usize, home: Option<usize>) -> Result<[f64; 2]> {
    let poses = poses.to_string();
    let plan = answer(&["plan", "mini", "--poses", &poses, "--json", "-"])?;
    let gains = plan.pointer("/home").and_then(Value::as_array);
    let with = |times: Option<usize>| {
        let mut gains = gains.into_iter().flatten();
        let gain = gains.find(|gain| gain["times"] == serde_json::json!(times));
        let value = gain.and_then(|gain| gain["platform_m"].as_f64());
        value.context("the plan promises nothing")
    };
    Ok([with(Some(home.unwrap_or(1)))?, with(None)?])
}

/// The result document of a command on a session.
fn told(command: &str, file: &Path, arguments: &[&str]) -> Result<Value> {
    let file = file
        .to_str()
        .context("the folder has a name that is no text")?;
    answer(&[&[command, file, "--json", "-"], arguments].concat())
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
