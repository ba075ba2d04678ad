//! Measurements that end as soon as it is certain, against a fixed plan: simulated robots of five kinds with and without faults, noise
//! other than stated, and parts a little off.

use std::fmt::Write as _;

use anyhow::{Context, Result, ensure};
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};
use tautline_core::diagnosis::{DiagnosisOptions, Finding, diagnose};
use tautline_core::effect::{
    BoundEffect, CATALOGUE, Effect, EffectSetting, Scope, Search, part_deviations,
};
use tautline_core::estimation::{Control, Options, Problem, solve};
use tautline_core::geometry::Pose;
use tautline_core::measurement::Dataset;
use tautline_core::planning::{PlanOptions, plan};
use tautline_core::robot::presets::{self, Preset};
use tautline_core::robot::{PartTolerances, PerAxis, Robot, Tracker};
use tautline_core::sequential::{
    Assessment, FaultOfInterest, Goal, NextStep, SequentialDesign, SequentialOptions,
};
use tautline_core::simulation::{SimulationOptions, simulate};

use crate::tables::hidden::{
    Claim, Found, NoiseFactors, Records, Started, VISIBLE, add_noise, clopper_pearson, judge,
    wrong_names,
};
use crate::tables::parallel::in_parallel;

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
    /// Hidden faults that are named, and those that are named or listed.
    named: usize,
    found: usize,
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

/// The first cases, from a seed on: the kinds in turn, and of each none, one and two faults.
#[must_use]
pub fn cases(robots: usize, first_seed: u64) -> Vec<Case> {
    let case = |number: usize| Case {
        kind: number % ROBOTS.len(),
        faults: number / ROBOTS.len() % 3,
        seed: first_seed + number as u64,
    };
    (0..robots).map(case).collect()
}

/// Measures robots in both ways; the outcomes of those on record come from there.
///
/// # Errors
/// If a robot cannot be simulated or diagnosed, or the records cannot be written.
pub fn study(cases: &[Case], records: &Records<Case, Outcome>) -> Result<Vec<Outcome>> {
    let fixed: Result<Vec<Vec<Pose>>> = ROBOTS.iter().map(|name| fixed_plan(name)).collect();
    let fixed = fixed?;
    let outcome = |case: &Case| -> Result<Outcome> {
        if let Some(Some(known)) = records.of(case) {
            return Ok(known.clone());
        }
        let robot = (ROBOTS[case.kind], fixed[case.kind].as_slice());
        let outcome =
            outcome(robot, case.faults, case.seed).with_context(|| format!("{case:?}"))?;
        records.add(case, Some(&outcome))?;
        Ok(outcome)
    };
    in_parallel(cases, None, outcome).into_iter().collect()
}

fn preset(name: &str) -> Result<Preset> {
    let known = name.strip_suffix("-tracked").unwrap_or(name);
    let mut preset = presets::find(known).with_context(|| format!("no preset {known}"))?;
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

fn log_uniform([low, high]: [f64; 2], rng: &mut ChaCha8Rng) -> f64 {
    low * (high / low).powf(rng.random::<f64>())
}

impl Machine {
    fn draw(name: &str, faults: usize, poses: &[Pose], seed: u64) -> Result<Self> {
        let preset = preset(name)?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(FAULTS);
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
            workspace: Some(self.preset.workspace),
            tension: Some(self.preset.tension),
            effects: parts.iter().chain(&self.faults).cloned().collect(),
            noise: false,
            ..SimulationOptions::new(0, self.seed)
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
            let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue)?;
            ensure!(solution.chi2.is_finite(), "the fit broke down");
            Ok(solution.chi2)
        };
        Ok(chi2(Some(index))? - chi2(None)?)
    }

    /// The readings at poses; those of the first poses do not depend on how many follow.
    fn measured(&self, poses: &[Pose]) -> Result<Dataset> {
        let mut dataset = self.exact(poses, &self.parts)?;
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(READINGS);
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
        let count =
            |is: &dyn Fn(Found) -> bool| judged.iter().filter(|(found, _)| is(*found)).count();
        let named = count(&|found| found == Found::Named);
        let wrong = wrong_names(&self.faults, &claims, robot).len();
        Said {
            poses,
            named,
            found: count(&|found| found <= Found::ListedNeedlessly),
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
    for deviation in &mut all {
        let parameters = deviation.bound.effect.parameters().iter();
        let sized = parameters.zip(&deviation.prior_sd);
        for (value, (parameter, sd)) in deviation.bound.values.iter_mut().zip(sized) {
            let normal: f64 = StandardNormal.sample(rng);
            let off = SCATTER * sd * normal;
            let is_one_sided = parameter.bounds[0] == parameter.neutral;
            *value += if is_one_sided { off.abs() } else { off };
        }
    }
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
        let is_one_sided = parameter.bounds[0] == parameter.neutral;
        let sign = if is_one_sided || rng.random_bool(0.5) {
            1.0
        } else {
            -1.0
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

fn outcome((robot, fixed): (&str, &[Pose]), faults: usize, seed: u64) -> Result<Outcome> {
    let machine = Machine::draw(robot, faults, fixed, seed)?;
    let diagnosis = diagnose(
        &machine.measured(fixed)?,
        &DiagnosisOptions::default(),
        &mut |_| Control::Continue,
    )?;
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
        let started = Started::now();
        let decision = design.next(&measured, &[])?;
        if decision.assessment.is_some() {
            seconds.push(started.elapsed_s());
        }
        if let NextStep::Measure { pose, .. } = decision.step {
            poses.push(pose);
            continue;
        }
        let known = decision.assessment.context("an assessment")?;
        return Ok(Outcome {
            faults,
            fixed: by_plan,
            until: machine.said(poses.len(), &known.findings, (design.shown(), Some(&known))),
            is_reached: matches!(decision.step, NextStep::Reached),
            seconds,
        });
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The tables in Markdown.
#[must_use]
pub fn markdown(outcomes: &[Outcome]) -> String {
    let mut text = String::from(
        "| faults | robots | named, fixed plan | named, until certain | wrong names, fixed plan | wrong names, until certain | certain | median poses | of the plan |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    for faults in [Some(0), Some(1), Some(2), None] {
        let of = outcomes
            .iter()
            .filter(|one| faults.is_none_or(|count| one.faults == count));
        let of: Vec<&Outcome> = of.collect();
        let hidden: usize = of.iter().map(|one| one.faults).sum();
        let sum =
            |value: &dyn Fn(&Outcome) -> usize| of.iter().map(|one| value(one)).sum::<usize>();
        let poses = median(of.iter().map(|one| one.until.poses as f64).collect());
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {poses} | {:.0} % |",
            faults.map_or("all".to_owned(), |count| count.to_string()),
            of.len(),
            share(sum(&|one| one.fixed.named), hidden),
            share(sum(&|one| one.until.named), hidden),
            sum(&|one| one.fixed.wrong),
            sum(&|one| one.until.wrong),
            share(sum(&|one| usize::from(one.is_reached)), of.len()),
            100.0 * poses / POSES as f64,
        );
    }
    text.push_str(&reliability(outcomes));
    let clean = outcomes
        .iter()
        .filter(|one| one.faults == 0 && one.until.is_fault_free);
    let clean: Vec<f64> = clean.map(|one| one.until.poses as f64).collect();
    let certified = outcomes.iter().filter(|one| one.until.is_fault_free);
    let certified: Vec<&Outcome> = certified.collect();
    let wrongly = certified.iter().filter(|one| !one.until.is_true).count();
    let hidden = certified.iter().filter(|one| one.faults > 0).count();
    let seconds: Vec<f64> = outcomes
        .iter()
        .flat_map(|one| one.seconds.clone())
        .collect();
    let _ = writeln!(
        text,
        "\nFree of faults: {} certified, {wrongly} of them with a hidden fault of the size of interest, {} with a smaller one; clean robots \
         after {} poses in the median. Processor time of \
         a decision: median {:.2} s, at most {:.2} s.",
        certified.len(),
        hidden - wrongly,
        median(clean),
        median(seconds.clone()),
        seconds.iter().copied().fold(0.0, f64::max),
    );
    text
}

/// How often what is stated at the end is true: all hidden faults of the size of interest are named and nothing else is; and how often
/// that holds for all hidden faults.
fn reliability(outcomes: &[Outcome]) -> String {
    let mut text = String::from(
        "\n| stated at the end | runs | mean stated | true | true of smaller faults, too |\n|---|--:|--:|--:|--:|\n",
    );
    for borders in BORDERS.windows(2) {
        let is_in = |one: &&Outcome| (borders[0]..borders[1]).contains(&one.until.stated);
        let of: Vec<&Outcome> = outcomes.iter().filter(is_in).collect();
        if of.is_empty() {
            continue;
        }
        let stated: f64 = of.iter().map(|one| one.until.stated).sum();
        let right = of.iter().filter(|one| one.until.is_true).count();
        let complete = of.iter().filter(|one| one.until.is_complete).count();
        let _ = writeln!(
            text,
            "| {:.0} to {:.0} % | {} | {:.1} % | {} | {} |",
            100.0 * borders[0],
            100.0 * borders[1],
            of.len(),
            100.0 * stated / of.len() as f64,
            share(right, of.len()),
            share(complete, of.len()),
        );
    }
    text
}

/// A share in percent with its 95 % interval.
fn share(part: usize, whole: usize) -> String {
    if whole == 0 {
        return "-".to_owned();
    }
    let [low, high] = clopper_pearson(part, whole).map(|p| 100.0 * p);
    let own = 100.0 * part as f64 / whole as f64;
    format!("{part} of {whole}: {own:.0} % ({low:.0} to {high:.0})")
}
