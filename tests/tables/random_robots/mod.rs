//! What the doctor says about random robots without a fault, and how its answers change with the number of readings.

mod robot;

use std::ops::Range;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use tautline_core::diagnosis::Verdict;
use tautline_core::effect::EffectRequest;
use tautline_core::estimation::{ParameterId, Problem};
use tautline_core::measurement::Dataset;
use tautline_core::robot::{PartTolerances, Robot};
use tautline_core::simulation::{SimulationOptions, TensionRange, Workspace, simulate};

use super::counting::{count, median, total};
use super::markdown::Table;
use super::simulated::{diagnosed, preset, setting, solved};
use super::study::Study;
use robot::{Kind, RandomRobot, random_robot};

/// Seed of the first random robot.
pub const FIRST_SEED: u64 = 48_000;
/// Numbers of poses of the random robots, in turn.
const POSES: [usize; 5] = [20, 30, 40, 50, 60];

/// Clean data of the random robots of these seeds: every second one is exact, the parts of the others are within typical tolerances.
/// Robots that cannot be held in their workspace are left out.
#[derive(Debug)]
pub struct CleanRobots(pub Range<u64>);

/// What is said about a robot without a fault.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Said {
    kind: Kind,
    /// Whether the cables are soft, and whether there are force sensors.
    groups: [String; 2],
    has_finding: bool,
    has_name: bool,
    /// Whether the model is rejected although its residuals are as large as often as not.
    is_contradicted: bool,
    seconds: f64,
}

impl Study for CleanRobots {
    type Case = u64;
    type Outcome = Said;

    fn cases(&self) -> Result<Vec<u64>> {
        Ok(self.0.clone().collect())
    }

    /// What is said goes to standard error.
    fn run(&self, seed: &u64) -> Result<Option<Said>> {
        let random = random_robot(*seed);
        let Some(dataset) = clean_data(&random, *seed) else {
            return Ok(None);
        };
        let (diagnosis, seconds) = diagnosed(&dataset)?;
        if !diagnosis.findings.is_empty() {
            let said: Vec<_> = diagnosis.findings.iter().map(|f| &f.sentence).collect();
            eprintln!("seed {seed}, {}: {said:?}", random.kind.name());
        }
        let softness = if random.is_soft { "soft" } else { "stiff" };
        let has_forces = dataset.robot.has_force_sensors();
        let with = if has_forces { "with" } else { "without" };
        let mut findings = diagnosis.findings.iter();
        Ok(Some(Said {
            kind: random.kind,
            groups: [softness.to_owned(), format!("{with} forces")],
            has_finding: !diagnosis.findings.is_empty(),
            has_name: findings.any(|f| f.verdict() == Verdict::Named),
            is_contradicted: diagnosis.base.global.p_value > 0.5 && !diagnosis.base.adequate,
            seconds,
        }))
    }

    fn table(&self, outcomes: &[(u64, Said)]) -> Result<String> {
        let mut table = Table::new(
            "platform | robots | data sets | with a finding | with a name | rejected though usual | median s",
        );
        let mut line = |name: &str, group: &str, all: &[&Said]| {
            let with_finding = count(all, |one| one.has_finding);
            let share = 100.0 * with_finding as f64 / all.len().max(1) as f64;
            table.row(format_args!(
                "{name} | {group} | {} | {with_finding}: {share:.1} % | {} | {} | {:.2}",
                all.len(),
                count(all, |one| one.has_name),
                count(all, |one| one.is_contradicted),
                median(all.iter().map(|one| one.seconds))
            ));
        };
        let all: Vec<&Said> = outcomes.iter().map(|(_, said)| said).collect();
        for kind in Kind::ALL {
            for group in ["soft", "stiff", "with forces", "without forces"] {
                let is_in =
                    |one: &&&Said| one.kind == kind && one.groups.iter().any(|g| g == group);
                let of: Vec<&Said> = all.iter().filter(is_in).copied().collect();
                if !of.is_empty() {
                    line(kind.name(), group, &of);
                }
            }
        }
        line("all", "", &all);
        Ok(table.text())
    }
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

/// Robots of the table over the numbers of poses.
const ROBOTS: [&str; 5] = ["mini", "hall", "suspended", "planar", "point"];
/// Sizes of the fault, in standard deviations of its estimate.
const SIZES: [f64; 5] = [3.0, 10.0, 30.0, 100.0, 300.0];
/// Numbers of poses where none is given.
pub const NUMBERS_OF_POSES: [usize; 5] = [40, 160, 400, 1000, 2000];

/// A wrong scale of one winch of five robots, exact and well kept, at each number of poses.
#[derive(Debug)]
pub struct OverPoses(pub Vec<usize>);

/// Robot, number of poses, and whether its parts have typical tolerances.
type PosesCase = (usize, usize, bool);

/// What is said about one size of the fault.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Answer {
    named: usize,
    wrong: usize,
    seconds: f64,
}

impl Study for OverPoses {
    type Case = PosesCase;
    /// For each size of the fault.
    type Outcome = Vec<Answer>;

    fn cases(&self) -> Result<Vec<PosesCase>> {
        let kinds = [false, true];
        let of_robot = |robot| {
            let numbers = self.0.iter();
            numbers.flat_map(move |poses| kinds.map(|is_typical| (robot, *poses, is_typical)))
        };
        Ok((0..ROBOTS.len()).flat_map(of_robot).collect())
    }

    fn run(&self, (name, poses, is_typical): &PosesCase) -> Result<Option<Vec<Answer>>> {
        let name = ROBOTS[*name];
        let (mut robot, workspace, tension) = robot(name)?;
        robot.tolerances = Some(match is_typical {
            true => PartTolerances::typical(),
            false => PartTolerances::exact(),
        });
        let options = SimulationOptions {
            workspace: Some(workspace),
            tension: Some(tension),
            ..SimulationOptions::new(*poses, FIRST_SEED)
        };
        let sd = sd_of_scale(&simulate(&robot, &options)?.dataset)?;
        let answer = |size: &f64| -> Result<Answer> {
            let cable = robot.cables[1].name.as_str();
            let options = SimulationOptions {
                effects: vec![setting("winch_scale", &[cable], "scale", size * sd)],
                ..options.clone()
            };
            judged(
                &simulate(&robot, &options)?.dataset,
                &format!("{name}, {poses} poses, {size} standard deviations"),
            )
        };
        SIZES.iter().map(answer).collect::<Result<_>>().map(Some)
    }

    fn table(&self, outcomes: &[(PosesCase, Vec<Answer>)]) -> Result<String> {
        let mut table = Table::new(
            "poses | fault, standard deviations | data sets | named | wrong names | median s",
        );
        let mut numbers = self.0.clone();
        numbers.sort_unstable();
        for poses in numbers {
            for (index, size) in SIZES.iter().enumerate() {
                let of = outcomes
                    .iter()
                    .filter(|((_, number, _), _)| *number == poses);
                let of: Vec<&Answer> = of.map(|(_, answers)| &answers[index]).collect();
                table.row(format_args!(
                    "{poses} | {size} | {} | {} | {} | {:.1}",
                    of.len(),
                    total::<_, usize>(&of, |one| one.named),
                    total::<_, usize>(&of, |one| one.wrong),
                    median(of.iter().map(|one| one.seconds))
                ));
            }
        }
        Ok(table.text())
    }
}

/// Diagnoses a data set with a fault of the second winch; wrong names go to standard error.
fn judged(data: &Dataset, described: &str) -> Result<Answer> {
    let (diagnosis, seconds) = diagnosed(data)?;
    let findings = diagnosis.findings.iter();
    let named = findings.filter(|finding| finding.verdict() == Verdict::Named);
    let (right, wrong): (Vec<_>, Vec<_>) = named.partition(|finding| {
        let cause = finding.cause();
        cause.is_some_and(|cause| cause.effect().id() == "winch_scale" && cause.cables() == [1])
    });
    for finding in &wrong {
        eprintln!("{described}: {}", finding.sentence);
    }
    Ok(Answer {
        named: right.len(),
        wrong: wrong.len(),
        seconds,
    })
}

fn robot(name: &str) -> Result<(Robot, Workspace, TensionRange)> {
    let preset = preset(if name == "point" { "mini" } else { name })?;
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
