//! What the doctor says about random robots without a fault, and how its answers change with the number of readings.

mod robot;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::time::Instant;

use anyhow::{Context, Result};
use tautline_core::diagnosis::{Diagnosis, DiagnosisOptions, Verdict, diagnose};
use tautline_core::effect::{EffectRequest, EffectSetting};
use tautline_core::estimation::{Control, ParameterId, Problem};
use tautline_core::measurement::Dataset;
use tautline_core::robot::{PartTolerances, Robot, presets};
use tautline_core::simulation::{SimulationOptions, TensionRange, Workspace, simulate};

use super::hidden::solved;
use robot::{Kind, RandomRobot, random_robot};

/// Numbers of poses of the random robots, in turn.
const POSES: [usize; 5] = [20, 30, 40, 50, 60];

/// What is said about the data sets of one row.
#[derive(Debug, Clone, Default)]
pub struct Row {
    sets: usize,
    with_finding: usize,
    with_name: usize,
    /// Data sets whose model is rejected although its residuals are as large as often as not.
    contradicted: usize,
    seconds: Vec<f64>,
}

impl Row {
    fn add(&mut self, diagnosis: &Diagnosis, seconds: f64) {
        self.sets += 1;
        self.with_finding += usize::from(!diagnosis.findings.is_empty());
        let mut findings = diagnosis.findings.iter();
        self.with_name += usize::from(findings.any(|f| f.verdict() == Verdict::Named));
        let is_usual = diagnosis.base.global.p_value > 0.5;
        self.contradicted += usize::from(is_usual && !diagnosis.base.adequate);
        self.seconds.push(seconds);
    }
}

/// Kind and whether the cables are soft, or whether there are force sensors.
type Group = (Kind, &'static str);

/// Diagnoses clean data of so many random robots: every second one is exact, the parts of the others are within typical
/// tolerances. Robots that cannot be held in their workspace are left out.
///
/// # Errors
/// If a diagnosis fails.
pub fn clean(robots: usize, first_seed: u64) -> Result<BTreeMap<Group, Row>> {
    let mut rows: BTreeMap<Group, Row> = BTreeMap::new();
    for seed in first_seed..first_seed + robots as u64 {
        let random = random_robot(seed);
        let Some(dataset) = clean_data(&random, seed) else {
            continue;
        };
        let (diagnosis, seconds) = diagnosed(&dataset)?;
        let softness = if random.is_soft { "soft" } else { "stiff" };
        let has_forces = dataset.robot.has_force_sensors();
        let sensors = if has_forces {
            "with forces"
        } else {
            "without forces"
        };
        for group in [softness, sensors] {
            let row = rows.entry((random.kind, group)).or_default();
            row.add(&diagnosis, seconds);
        }
        if !diagnosis.findings.is_empty() {
            let said: Vec<_> = diagnosis.findings.iter().map(|f| &f.sentence).collect();
            eprintln!("seed {seed}, {}: {said:?}", random.kind.name());
        }
    }
    Ok(rows)
}

fn clean_data(random: &RandomRobot, seed: u64) -> Option<Dataset> {
    let mut robot = random.robot.clone();
    robot.tolerances = (seed % 2 == 1).then(PartTolerances::typical);
    let options = SimulationOptions {
        workspace: Some(random.workspace),
        tension: Some(random.tension),
        ..SimulationOptions::new(POSES[(seed % POSES.len() as u64) as usize], seed)
    };
    Some(simulate(&robot, &options).ok()?.dataset)
}

fn diagnosed(dataset: &Dataset) -> Result<(Diagnosis, f64)> {
    let begun = Instant::now();
    let options = DiagnosisOptions::default();
    let diagnosis = diagnose(dataset, &options, &mut |_| Control::Continue)?;
    Ok((diagnosis, begun.elapsed().as_secs_f64()))
}

fn median(seconds: &[f64]) -> f64 {
    let mut sorted = seconds.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The table of clean robots.
#[must_use]
pub fn clean_markdown(rows: &BTreeMap<Group, Row>) -> String {
    let mut table = "| platform | robots | data sets | with a finding | with a name | rejected though usual | median s |\n|---|---|---|---|---|---|---|\n".to_owned();
    let mut line = |name: &str, group: &str, row: &Row| {
        let share = 100.0 * row.with_finding as f64 / row.sets.max(1) as f64;
        let _ = writeln!(
            table,
            "| {name} | {group} | {} | {}: {share:.1} % | {} | {} | {:.2} |",
            row.sets,
            row.with_finding,
            row.with_name,
            row.contradicted,
            median(&row.seconds)
        );
    };
    let mut all = Row::default();
    for ((kind, group), row) in rows {
        line(kind.name(), group, row);
        // Each data set is in two rows.
        if ["soft", "stiff"].contains(group) {
            all.sets += row.sets;
            all.with_finding += row.with_finding;
            all.with_name += row.with_name;
            all.contradicted += row.contradicted;
            all.seconds.extend(&row.seconds);
        }
    }
    line("all", "", &all);
    table
}

/// Robots of the table over the numbers of poses.
const ROBOTS: [&str; 5] = ["mini", "hall", "suspended", "planar", "point"];
/// Sizes of the fault, in standard deviations of its estimate.
const SIZES: [f64; 5] = [3.0, 10.0, 30.0, 100.0, 300.0];

/// What is said about one number of poses and size of the fault.
#[derive(Debug, Clone, Default)]
pub struct Answers {
    sets: usize,
    named: usize,
    wrong: usize,
    seconds: Vec<f64>,
}

/// Diagnoses a wrong scale of one winch of five robots, exact and well kept, at each number of poses.
///
/// # Errors
/// If a simulation or diagnosis fails.
pub fn over_poses(poses: &[usize], seed: u64) -> Result<BTreeMap<(usize, usize), Answers>> {
    let mut rows: BTreeMap<(usize, usize), Answers> = BTreeMap::new();
    for (name, poses) in ROBOTS
        .iter()
        .flat_map(|name| poses.iter().map(move |n| (name, *n)))
    {
        for tolerances in [PartTolerances::exact(), PartTolerances::typical()] {
            let (mut robot, workspace, tension) = robot(name)?;
            robot.tolerances = Some(tolerances);
            let options = SimulationOptions {
                workspace: Some(workspace),
                tension: Some(tension),
                ..SimulationOptions::new(poses, seed)
            };
            let sd = sd_of_scale(&simulate(&robot, &options)?.dataset)?;
            for (index, size) in SIZES.iter().enumerate() {
                let options = SimulationOptions {
                    effects: vec![scale(&robot, size * sd)],
                    ..options.clone()
                };
                let data = simulate(&robot, &options)?.dataset;
                let (diagnosis, seconds) = diagnosed(&data)?;
                let row = rows.entry((poses, index)).or_default();
                row.sets += 1;
                row.seconds.push(seconds);
                for finding in &diagnosis.findings {
                    if finding.verdict() != Verdict::Named {
                        continue;
                    }
                    let is_right = finding.cause().is_some_and(|cause| {
                        cause.effect().id() == "winch_scale" && cause.cables() == [1]
                    });
                    if is_right {
                        row.named += 1;
                    } else {
                        row.wrong += 1;
                        let said = &finding.sentence;
                        eprintln!("{name}, {poses} poses, {size} standard deviations: {said}");
                    }
                }
            }
        }
    }
    Ok(rows)
}

fn robot(name: &str) -> Result<(Robot, Workspace, TensionRange)> {
    let preset = presets::find(if name == "point" { "mini" } else { name });
    let preset = preset.context("a preset")?;
    if name != "point" {
        return Ok((preset.robot, preset.workspace, preset.tension));
    }
    let mut robot = preset.robot;
    robot.limits = None;
    robot.platform.free.truncate(3);
    for cable in &mut robot.cables {
        cable.platform_anchor_m = [0.0; 3];
    }
    let (workspace, tension) = (Workspace::of(&robot), TensionRange::of(&robot));
    Ok((robot, workspace, tension))
}

fn scale(robot: &Robot, size: f64) -> EffectSetting {
    EffectSetting {
        effect: "winch_scale".to_owned(),
        targets: vec![robot.cables[1].name.clone()],
        parameters: [("scale".to_owned(), size)].into(),
    }
}

/// Standard deviation of the scale of the winch from clean data.
fn sd_of_scale(dataset: &Dataset) -> Result<f64> {
    let mut problem = Problem::new(dataset)?.with_stated_tolerances();
    problem.free(&[EffectRequest {
        effect: "winch_scale".to_owned(),
        cables: vec![dataset.robot.cables[1].name.clone()],
        values: Vec::new(),
    }])?;
    let solution = solved(&problem)?;
    let is_scale = |id: &ParameterId| matches!(id, ParameterId::Effect { .. });
    let index = solution.parameters.iter().position(|p| is_scale(&p.id));
    let sd = solution.standard_deviation(index.context("a scale")?);
    sd.context("a scale that the readings determine")
}

/// The table over the numbers of poses.
#[must_use]
pub fn poses_markdown(rows: &BTreeMap<(usize, usize), Answers>) -> String {
    let mut table = "| poses | fault, standard deviations | data sets | named | wrong names | median s |\n|---|---|---|---|---|---|\n".to_owned();
    for ((poses, index), row) in rows {
        let _ = writeln!(
            table,
            "| {poses} | {} | {} | {} | {} | {:.1} |",
            SIZES[*index],
            row.sets,
            row.named,
            row.wrong,
            median(&row.seconds)
        );
    }
    table
}
