//! Measurements that end as soon as it is certain, against a fixed plan: simulated robots of five kinds with and without faults, noise
//! other than stated, and parts a little off.

use std::ops::Range;

use anyhow::{Context, Result};
use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use tautline_core::diagnosis::Finding;
use tautline_core::effect::{
    BoundEffect, CATALOGUE, Effect, EffectSetting, Scope, Search, part_deviations,
};
use tautline_core::estimation::{Control, Problem};
use tautline_core::geometry::Pose;
use tautline_core::measurement::Dataset;
use tautline_core::planning::{PlanOptions, plan};
use tautline_core::robot::presets::Preset;
use tautline_core::robot::{PartTolerances, PerAxis, Robot, Tracker};
use tautline_core::sequential::{
    Assessment, FaultOfInterest, Goal, NextStep, SequentialDesign, SequentialOptions,
};
use tautline_core::simulation::{SimulationOptions, simulate};

use super::counting::{Share, median, total};
use super::hidden::{Claim, Found, NoiseFactors, VISIBLE, add_noise, judge, wrong_names};
use super::markdown::Table;
use super::simulated::{
    self, diagnosed, is_one_sided, log_uniform, preset_options, random_sign, scatter_part, solved,
    stream, timed,
};
use super::study::Study;

/// Seed of the first robot.
pub const FIRST_SEED: u64 = 46_000;
/// Kinds of robots, in turn; the last one is the first with an external instrument.
const ROBOTS: [&str; 5] = ["mini", "hall", "suspended", "planar", "mini-tracked"];
/// Number of poses of the fixed plan, and the most that the other measures.
const POSES: usize = 41;
/// The goal of a run.
const GOAL: f64 = 0.95;
/// Range of the ratio of actual and stated noise.
const NOISE: [f64; 2] = [0.5, 2.0];
/// By what the parts scatter in units of their typical tolerances.
const SCATTER: f64 = 0.5;
/// Faults are drawn this often before a robot is given up.
const MAX_DRAWS: usize = 300;
/// Borders of the classes of stated probability.
const BORDERS: [f64; 5] = [0.0, 0.5, 0.8, GOAL, 1.0];
/// Streams of random numbers of a seed; the simulation uses streams 0 and 1.
const FAULTS: u64 = 21;
const READINGS: u64 = 22;

/// A robot with its hidden faults.
struct Machine {
    preset: Preset,
    /// The robot with its actual noise.
    actual: Robot,
    parts: Vec<EffectSetting>,
    faults: Vec<EffectSetting>,
    seed: u64,
}

/// What a run or the fixed plan says about a robot.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Said {
    poses: usize,
    /// Hidden faults that are named.
    named: usize,
    /// Names of something that is not hidden.
    wrong: usize,
    /// Stated probability that the findings are what is wrong, of faults of the size of interest, and whether they are.
    stated: f64,
    is_true: bool,
    /// Whether the findings are all faults, however small.
    is_complete: bool,
    is_fault_free: bool,
}

/// Outcome of one robot.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Outcome {
    faults: usize,
    fixed: Said,
    until: Said,
    is_reached: bool,
    seconds: Vec<f64>,
}

/// A robot of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Case {
    /// Which of [`ROBOTS`].
    kind: usize,
    faults: usize,
    seed: u64,
}

/// Robots with these seeds: the kinds in turn, and of each none, one and two faults.
#[derive(Debug)]
pub struct Until {
    seeds: Range<u64>,
    /// Fixed plan of each kind.
    plans: Vec<Vec<Pose>>,
}

impl Until {
    /// Plans the fixed poses.
    ///
    /// # Errors
    /// If a robot has no plan.
    pub fn new(seeds: Range<u64>) -> Result<Self> {
        let plans = ROBOTS.iter().map(|name| fixed_plan(name));
        Ok(Self {
            seeds,
            plans: plans.collect::<Result<_>>()?,
        })
    }
}

impl Study for Until {
    type Case = Case;
    type Outcome = Outcome;

    fn cases(&self) -> Result<Vec<Case>> {
        let case = |(number, seed): (usize, u64)| Case {
            kind: number % ROBOTS.len(),
            faults: number / ROBOTS.len() % 3,
            seed,
        };
        Ok(self.seeds.clone().enumerate().map(case).collect())
    }

    fn run(&self, case: &Case) -> Result<Option<Outcome>> {
        outcome((ROBOTS[case.kind], &self.plans[case.kind]), case).map(Some)
    }

    fn table(&self, outcomes: &[(Case, Outcome)]) -> Result<String> {
        let all: Vec<&Outcome> = outcomes.iter().map(|(_, outcome)| outcome).collect();
        Ok(format!(
            "{}\n{}\n{}",
            by_faults(&all),
            reliability(&all),
            certified(&all)
        ))
    }
}

fn preset(name: &str) -> Result<Preset> {
    let known = name.strip_suffix("-tracked").unwrap_or(name);
    let mut preset = simulated::preset(known)?;
    if known != name {
        preset.robot.tracker = Some(Tracker {
            position_sd_m: PerAxis::Same(2e-4),
            orientation_sd_rad: Some(1e-3),
        });
    }
    Ok(preset)
}

fn plan_options(preset: &Preset, poses: usize) -> PlanOptions<'static> {
    PlanOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..PlanOptions::new(poses, 1)
    }
}

fn fixed_plan(name: &str) -> Result<Vec<Pose>> {
    let preset = preset(name)?;
    let quiet = &mut |_: &_| Control::Continue;
    let planned = plan(&preset.robot, &plan_options(&preset, POSES), quiet)?;
    Ok(planned.poses.iter().map(|planned| planned.pose).collect())
}

impl Machine {
    fn draw(name: &str, faults: usize, poses: &[Pose], seed: u64) -> Result<Self> {
        let preset = preset(name)?;
        let mut rng = stream(seed, FAULTS);
        let noise = NoiseFactors::each(|| log_uniform(NOISE, &mut rng));
        let mut machine = Self {
            actual: noise.of(&preset.robot),
            parts: parts(&preset.robot, &mut rng),
            faults: Vec::new(),
            preset,
            seed,
        };
        for _ in 0..MAX_DRAWS {
            if machine.faults.len() == faults {
                return Ok(machine);
            }
            machine.add_fault(poses, &mut rng);
        }
        anyhow::bail!("no {faults} visible faults were found")
    }

    /// Adds a fault of typical size if it and those before it are visible beside each other at the poses of the fixed plan.
    fn add_fault(&mut self, poses: &[Pose], rng: &mut ChaCha8Rng) {
        let Some(effect) = CATALOGUE.choose(rng) else {
            return;
        };
        let is_new = self.faults.iter().all(|other| other.effect != effect.id());
        let drawn = fault(effect, &self.preset.robot, rng).filter(|_| is_new);
        let Some(drawn) = drawn else {
            return;
        };
        self.faults.push(drawn);
        let are_visible = (0..self.faults.len()).all(|index| {
            self.noncentrality(index, poses)
                .is_ok_and(|seen| seen >= VISIBLE)
        });
        if !are_visible {
            self.faults.pop();
        }
    }

    fn exact(&self, poses: &[Pose], parts: &[EffectSetting]) -> Result<Dataset> {
        let options = SimulationOptions {
            effects: parts.iter().chain(&self.faults).cloned().collect(),
            noise: false,
            ..preset_options(&self.preset, 0, self.seed)
        };
        Ok(simulate(&self.preset.robot, &options.commanding(poses.to_vec()))?.dataset)
    }

    /// Chi-square of a model without one of the faults for readings without noise.
    fn noncentrality(&self, index: usize, poses: &[Pose]) -> Result<f64> {
        let chi2 = |without: Option<usize>| -> Result<f64> {
            let dataset = Dataset {
                robot: self.actual.clone(),
                ..self.exact(poses, &[])?
            };
            let mut problem = Problem::new(&dataset)?;
            for (_, fault) in (self.faults.iter().enumerate()).filter(|(k, _)| Some(*k) != without)
            {
                problem
                    .free_effects
                    .push(BoundEffect::from_setting(fault, &dataset.robot)?);
            }
            Ok(solved(&problem)?.chi2)
        };
        Ok(chi2(Some(index))? - chi2(None)?)
    }

    /// The readings at poses; those of the first poses do not depend on how many follow.
    fn measured(&self, poses: &[Pose]) -> Result<Dataset> {
        let mut dataset = self.exact(poses, &self.parts)?;
        let mut rng = stream(self.seed, READINGS);
        add_noise(&self.actual, &mut dataset.measurements, None, &mut rng);
        Ok(dataset)
    }

    /// `of_interest` are the faults that a statement is about.
    fn said(
        &self,
        poses: usize,
        findings: &[Finding],
        (of_interest, assessment): (&[FaultOfInterest], Option<&Assessment>),
    ) -> Said {
        let robot = &self.preset.robot;
        let claims = Claim::of(findings);
        let judged = judge(&self.faults, &claims, robot);
        let is_asked = |fault: &EffectSetting| {
            let bound = BoundEffect::from_setting(fault, robot);
            bound.is_ok_and(|bound| of_interest.iter().any(|one| one.includes(&bound)))
        };
        let mut each = self.faults.iter().zip(&judged);
        let are_found = each.all(|(fault, (found, _))| *found == Found::Named || !is_asked(fault));
        let is_named = |(found, _): &&(Found, Option<usize>)| *found == Found::Named;
        let named = judged.iter().filter(is_named).count();
        let wrong = wrong_names(&self.faults, &claims, robot).len();
        Said {
            poses,
            named,
            wrong,
            stated: assessment.map_or(0.0, |known| known.explained),
            is_true: wrong == 0 && are_found,
            is_complete: wrong == 0 && named == self.faults.len(),
            is_fault_free: assessment.is_some_and(|known| known.fault_free() >= GOAL),
        }
    }
}

/// Parts that scatter by a share of their typical tolerances.
fn parts(robot: &Robot, rng: &mut ChaCha8Rng) -> Vec<EffectSetting> {
    let mut all = part_deviations(robot, &PartTolerances::typical());
    all.iter_mut()
        .for_each(|part| scatter_part(part, SCATTER, rng));
    all.iter()
        .map(|deviation| deviation.bound.setting(robot))
        .collect()
}

/// A permanent effect of typical size on a random target.
fn fault(effect: &'static Effect, robot: &Robot, rng: &mut ChaCha8Rng) -> Option<EffectSetting> {
    if effect.search() != Search::Direct || !effect.is_estimable() {
        return None;
    }
    let (cables, targeted) = match effect.scope() {
        Scope::Robot => ((0..robot.cable_count()).collect(), false),
        Scope::Cable | Scope::CableOrAll => (vec![rng.random_range(0..robot.cable_count())], true),
        Scope::Pair => return None,
    };
    let share = (effect.parameters().len() as f64).sqrt();
    let values = effect.parameters().iter().map(|parameter| {
        let [smallest, largest] = parameter.typical_sizes();
        let size = log_uniform([smallest.max(0.05 * largest), largest], rng) / share;
        let sign = if is_one_sided(parameter) {
            1.0
        } else {
            random_sign(rng)
        };
        parameter.neutral + sign * size
    });
    let bound = BoundEffect {
        effect,
        cables,
        targeted,
        values: values.collect(),
    };
    Some(bound.setting(robot))
}

fn outcome((robot, fixed): (&str, &[Pose]), case: &Case) -> Result<Outcome> {
    let machine = Machine::draw(robot, case.faults, fixed, case.seed)?;
    let (diagnosis, _) = diagnosed(&machine.measured(fixed)?)?;
    let by_plan = machine.said(fixed.len(), &diagnosis.findings, (&[], None));
    let options = SequentialOptions {
        goals: &[Goal::Cause(GOAL)],
        at_most: POSES,
        among: None,
        plan: plan_options(&machine.preset, POSES),
    };
    let design = SequentialDesign::new(&machine.preset.robot, options)?;
    let mut poses = Vec::new();
    let mut seconds = Vec::new();
    loop {
        let measured = machine.measured(&poses)?.measurements;
        let (decision, spent_s) = timed(|| design.next(&measured, &[]));
        let decision = decision?;
        if decision.assessment.is_some() {
            seconds.push(spent_s);
        }
        if let NextStep::Measure { pose, .. } = decision.step {
            poses.push(pose);
            continue;
        }
        let known = decision.assessment.context("an assessment")?;
        return Ok(Outcome {
            faults: case.faults,
            fixed: by_plan,
            until: machine.said(poses.len(), &known.findings, (design.shown(), Some(&known))),
            is_reached: matches!(decision.step, NextStep::Reached),
            seconds,
        });
    }
}

fn by_faults(all: &[&Outcome]) -> String {
    let mut table = Table::of_numbers(
        "faults | robots | named, fixed plan | named, until certain | wrong names, fixed plan | wrong names, until certain | certain | median poses | of the plan",
    );
    for faults in [Some(0), Some(1), Some(2), None] {
        let is_in = |one: &&&Outcome| faults.is_none_or(|count| one.faults == count);
        let of: Vec<&Outcome> = all.iter().filter(is_in).copied().collect();
        let sum = |value: fn(&Outcome) -> usize| -> usize { total(&of, value) };
        let named = |part| Share {
            part,
            whole: sum(|one| one.faults),
        };
        let poses = median(of.iter().map(|one| one.until.poses as f64));
        table.row(format_args!(
            "{} | {} | {:.0} | {:.0} | {} | {} | {:.0} | {poses} | {:.0} %",
            faults.map_or("all".to_owned(), |count| count.to_string()),
            of.len(),
            named(sum(|one| one.fixed.named)),
            named(sum(|one| one.until.named)),
            sum(|one| one.fixed.wrong),
            sum(|one| one.until.wrong),
            Share::of(&of, |one| one.is_reached),
            100.0 * poses / POSES as f64,
        ));
    }
    table.text()
}

/// How often what is stated at the end is true: all hidden faults of the size of interest are named and nothing else is; and how often
/// that holds for all hidden faults.
fn reliability(all: &[&Outcome]) -> String {
    let mut table = Table::of_numbers(
        "stated at the end | runs | mean stated | true | true of smaller faults, too",
    );
    for borders in BORDERS.windows(2) {
        let is_in = |one: &&&Outcome| (borders[0]..borders[1]).contains(&one.until.stated);
        let of: Vec<&Outcome> = all.iter().filter(is_in).copied().collect();
        if of.is_empty() {
            continue;
        }
        let stated: f64 = total(&of, |one| one.until.stated);
        table.row(format_args!(
            "{:.0} to {:.0} % | {} | {:.1} % | {:.0} | {:.0}",
            100.0 * borders[0],
            100.0 * borders[1],
            of.len(),
            100.0 * stated / of.len() as f64,
            Share::of(&of, |one| one.until.is_true),
            Share::of(&of, |one| one.until.is_complete),
        ));
    }
    table.text()
}

/// Robots that are certified to be free of faults, and the time of decisions.
fn certified(all: &[&Outcome]) -> String {
    let certified = all.iter().filter(|one| one.until.is_fault_free);
    let clean = certified.clone().filter(|one| one.faults == 0);
    let wrongly = certified.clone().filter(|one| !one.until.is_true).count();
    let hidden = certified.clone().filter(|one| one.faults > 0).count();
    let seconds: Vec<f64> = all.iter().flat_map(|one| one.seconds.clone()).collect();
    format!(
        "Free of faults: {} certified, {wrongly} of them with a hidden fault of the size of interest, {} with a smaller one; clean robots \
         after {} poses in the median. Processor time of \
         a decision: median {:.2} s, at most {:.2} s.\n",
        certified.count(),
        hidden - wrongly,
        median(clean.map(|one| one.until.poses as f64)),
        median(seconds.iter().copied()),
        seconds.iter().copied().fold(0.0, f64::max),
    )
}
