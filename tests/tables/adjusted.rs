//! Accuracy of a robot before and after an adjustment: the whole loop of the commands on the simulated MINI, over many
//! seeds.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use tempfile::TempDir;

use super::counting::Share;
use super::markdown::Table;
use super::study::Study;
use crate::support::program::program;

/// Seeds of the robots and their noise.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=20;
/// Numbers of poses, the methods by which they are identified, and how often the home pose is measured; `None`: it is
/// that of the drawing, which counts as one measurement.
const ROWS: [Row; 11] = [
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

/// Number of poses, method, and how often the home pose is measured.
type Row = (usize, &'static str, Option<usize>);

/// Figures of one robot (m).
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Figures {
    /// Mean position accuracy at the poses of the cubes, before and after.
    pose: [f64; 2],
    /// Path accuracy on the circle, before and after.
    circle: [f64; 2],
}

/// Robots that are measured and verified once for each number of poses; the rows go on from copies of that session, and differ in the
/// home pose and the method alone.
#[derive(Debug)]
pub struct Adjusted {
    folder: TempDir,
    plans: Vec<Plan>,
}

impl Adjusted {
    /// Plans the poses.
    ///
    /// # Errors
    /// If the program fails.
    pub fn new() -> Result<Self> {
        let folder = tempfile::tempdir()?;
        let plans = groups().map(|rows| Plan::make(folder.path(), rows[0].0));
        Ok(Self {
            plans: plans.collect::<Result<_>>()?,
            folder,
        })
    }
}

/// Rows of each number of poses.
fn groups() -> impl Iterator<Item = &'static [Row]> {
    ROWS.chunk_by(|a, b| a.0 == b.0)
}

/// Which number of poses, and the seed.
type Case = (usize, u64);

impl Study for Adjusted {
    type Case = Case;
    /// For each row of this number of poses.
    type Outcome = Vec<Figures>;

    fn cases(&self) -> Result<Vec<Case>> {
        let of = |group| SEEDS.map(move |seed| (group, seed));
        Ok((0..self.plans.len()).flat_map(of).collect())
    }

    fn run(&self, (group, seed): &Case) -> Result<Option<Vec<Figures>>> {
        let folder = tempfile::tempdir_in(self.folder.path())?;
        let measured = measured(folder.path(), &self.plans[*group], *seed)?;
        let rows = groups().nth(*group).context("a group")?;
        let figures = rows.iter().map(|row| adjusted(&measured, *row));
        figures.collect::<Result<_>>().map(Some)
    }

    fn table(&self, outcomes: &[(Case, Vec<Figures>)]) -> Result<String> {
        let mut table = Table::new(
            "poses | method | home measured | position accuracy before, mm | after, mm | better by, % | expected, mm | home exact, mm | circle before, mm | after, mm | below 0.3 mm",
        );
        for (index, (rows, plan)) in groups().zip(&self.plans).enumerate() {
            let of_group = outcomes.iter().filter(|((group, _), _)| *group == index);
            for (k, row) in rows.iter().enumerate() {
                let robots = of_group.clone().map(|(_, figures)| figures[k]);
                table.row(cells(row, plan, &robots.collect::<Vec<_>>())?);
            }
        }
        Ok(table.text())
    }
}

/// The poses that all robots measure, and what their plan promises.
#[derive(Debug)]
struct Plan {
    file: PathBuf,
    document: Value,
}

impl Plan {
    fn make(folder: &Path, poses: usize) -> Result<Self> {
        let file = folder.join(format!("plan-{poses}.csv"));
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
    let (seed, poses) = (seed.to_string(), text(&plan.file)?);
    let new = ["--robot", "mini", "--plan", poses, "--seed", &seed];
    told("measure", &file, &new)?;
    told("verify", &file, &TARGETS)?;
    Ok(file)
}

fn adjusted(measured: &Path, (_, method, home): Row) -> Result<Figures> {
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

/// A row of the table. Plans are made for one method.
fn cells(&(poses, method, home): &Row, plan: &Plan, robots: &[Figures]) -> Result<String> {
    let expected_m = (method == "joint")
        .then(|| plan.expected_m(home))
        .transpose()?;
    let expected = expected_m.map(|expected| expected.map(|m| format!("{:.2}", 1e3 * m)));
    let [expected, home_exact] = expected.unwrap_or(["-", "-"].map(str::to_owned));
    let mm = |get: fn(&Figures) -> f64| range(robots.iter().map(|f| 1e3 * get(f)), 2);
    let better = robots.iter().map(|f| 100.0 * (1.0 - f.pose[1] / f.pose[0]));
    let close = Share::of(robots, |f| f.circle[1] < 3e-4);
    Ok(format!(
        "{poses} | {method} | {} | {} | {} | {} | {expected} | {home_exact} | {} | {} | {} of {}",
        home.map_or("drawing".to_owned(), |times| times.to_string()),
        mm(|f| f.pose[0]),
        mm(|f| f.pose[1]),
        range(better, 0),
        mm(|f| f.circle[0]),
        mm(|f| f.circle[1]),
        close.part,
        close.whole,
    ))
}

/// Median, least and greatest of values.
fn range(values: impl Iterator<Item = f64>, decimals: usize) -> String {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    let median = match sorted.len() % 2 {
        0 => 0.5 * (sorted[middle - 1] + sorted[middle]),
        _ => sorted[middle],
    };
    let (least, greatest) = (sorted[0], sorted[sorted.len() - 1]);
    format!("{median:.decimals$} ({least:.decimals$} to {greatest:.decimals$})")
}
