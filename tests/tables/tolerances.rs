//! Machines as they are: every part a little off, with and without faults, diagnosed with all parts taken as exact and
//! with tolerances.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::time::Instant;

use anyhow::{Context, Result};
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use tautline_core::diagnosis::{
    Cause, Diagnosis, DiagnosisOptions, FoundParameter, Verdict, diagnose,
};
use tautline_core::effect::{
    BoundEffect, EffectSetting, PartDeviation, Scope, find, part_deviations,
};
use tautline_core::estimation::{Control, Options, ParameterId, Problem, solve};
use tautline_core::robot::presets::{self, Preset};
use tautline_core::robot::{PartTolerances, Robot, StatedTolerances, Tolerance};
use tautline_core::simulation::{Simulated, SimulationOptions, simulate};

use crate::tables::hidden::VISIBLE;

/// Robots, in turn.
const ROBOTS: [&str; 4] = ["mini", "hall", "suspended", "planar"];
/// By what the parts scatter in units of the typical tolerances, drawn for each effect.
const SCATTER: [f64; 2] = [0.3, 1.5];
/// Largest factor by which the stated tolerance of an effect is wrong, in either direction.
const MISSTATED: f64 = 2.0;
/// Size of a fault in units of the geometric mean of its typical sizes.
const FAULT: [f64; 2] = [1.2, 2.5];
/// Number of poses with up to two faults, and with more.
const POSES: [usize; 2] = [41, 60];
/// Effects that are hidden as faults.
const FAULTS: [&str; 19] = [
    "winch_scale",
    "drum_eccentricity",
    "drum_growth",
    "winch_backlash",
    "cable_slip",
    "cable_stiffness",
    "cable_stiffening",
    "cable_creep",
    "pulley_radius",
    "pulley_friction",
    "platform_anchor",
    "payload_mass",
    "payload_com",
    "frame_compliance",
    "laser_scale",
    "laser_beam_tilt",
    "laser_drift",
    "force_gain",
    "force_bias",
];

/// Streams of random numbers of a seed; the simulation uses stream 0.
const PARTS: u64 = 11;
const HIDDEN: u64 = 12;
const STATED: u64 = 13;

/// What a diagnosis takes the parts for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Assumption {
    /// Exact.
    Exact,
    /// Of tolerances that are stated, each wrong by its own factor.
    Stated,
    /// Of typical tolerances.
    Typical,
}

impl Assumption {
    const ALL: [Self; 3] = [Self::Exact, Self::Stated, Self::Typical];

    fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Stated => "tolerances, wrong by up to 2",
            Self::Typical => "typical tolerances",
        }
    }

    /// What `robot.json` states under this assumption.
    fn stated(self, robot: &Robot, seed: u64) -> Option<PartTolerances> {
        match self {
            Self::Typical => None,
            Self::Exact => Some(PartTolerances::exact()),
            Self::Stated => Some(PartTolerances::Stated(StatedTolerances {
                factor: 1.0,
                effects: misstated(robot, seed),
            })),
        }
    }
}

/// Sums over the data sets of one row of the table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Row {
    /// Whether every part is a little off.
    pub is_real: bool,
    /// Number of faults hidden in each data set.
    pub faults: usize,
    /// What the parts are taken for.
    pub assumption: Option<Assumption>,
    /// Number of data sets.
    pub sets: usize,
    /// Number of hidden faults.
    pub hidden: usize,
    /// Hidden faults that are named.
    pub named: usize,
    /// Hidden faults in a list.
    pub listed: usize,
    /// Hidden faults whose part is visibly outside its typical tolerance.
    pub visible: usize,
    /// Visible faults that are named.
    pub visible_named: usize,
    /// Visible faults that are named or in a list.
    pub visible_found: usize,
    /// Names of something that is not hidden.
    pub wrong: usize,
    /// Data sets with a wrong name.
    pub sets_with_wrong: usize,
    /// Names with a size that is more than four stated standard deviations from the true deviation of the part.
    pub false_names: usize,
    /// Coordinates of pulleys, and those within their 95 % interval.
    pub coordinates: usize,
    /// Coordinates within their interval.
    pub covered: usize,
    /// Sizes of named faults, and those within their 95 % interval.
    pub sizes: usize,
    /// Sizes within their interval.
    pub sizes_covered: usize,
    /// Data sets that the final model explains.
    pub explained: usize,
    /// Sum of the factors of the tolerances.
    pub factor: f64,
    /// Time of each diagnosis (s).
    pub seconds: Vec<f64>,
}

/// A simulated machine with what is hidden in it.
struct Machine {
    run: Simulated,
    hidden: Vec<EffectSetting>,
    /// Whether each hidden fault is visible.
    is_visible: Vec<bool>,
}

fn stream(seed: u64, number: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    rng
}

/// A number from a range, uniform in its logarithm.
fn log_uniform(rng: &mut ChaCha8Rng, [low, high]: [f64; 2]) -> f64 {
    low * (high / low).powf(rng.random::<f64>())
}

fn typical_deviations(robot: &Robot) -> Vec<PartDeviation> {
    part_deviations(robot, &PartTolerances::typical())
}

/// The deviation of every part, by effects that each have a scatter of their own.
fn draw_parts(robot: &Robot, seed: u64) -> Vec<EffectSetting> {
    let mut rng = stream(seed, PARTS);
    let mut scatter: BTreeMap<&str, f64> = BTreeMap::new();
    let draw = |mut deviation: PartDeviation| {
        let id = deviation.bound.effect.id();
        let own = match scatter.get(id) {
            Some(own) => *own,
            None => log_uniform(&mut rng, SCATTER),
        };
        scatter.insert(id, own);
        let parameters = deviation.bound.effect.parameters().iter();
        let of_parameters = parameters.zip(&deviation.prior_sd);
        for (value, (parameter, sd)) in deviation.bound.values.iter_mut().zip(of_parameters) {
            let normal: f64 = StandardNormal.sample(&mut rng);
            let off = own * sd * normal;
            let is_one_sided = parameter.bounds[0] == parameter.neutral;
            *value += if is_one_sided { off.abs() } else { off };
        }
        deviation.bound.setting(robot)
    };
    typical_deviations(robot).into_iter().map(draw).collect()
}

/// Tolerances that are wrong, each effect by its own factor.
fn misstated(robot: &Robot, seed: u64) -> BTreeMap<String, Tolerance> {
    let mut rng = stream(seed, STATED);
    let mut stated = BTreeMap::new();
    for deviation in typical_deviations(robot) {
        let sd = deviation.prior_sd.iter().copied().fold(0.0, f64::max);
        let id = deviation.bound.effect.id().to_owned();
        stated.entry(id).or_insert_with(|| {
            let factor = log_uniform(&mut rng, [MISSTATED.recip(), MISSTATED]);
            Tolerance::Same(factor * sd)
        });
    }
    stated
}

/// Faults on random parts, of different effects.
fn draw_faults(robot: &Robot, faults: usize, poses: usize, seed: u64) -> Vec<EffectSetting> {
    let mut rng = stream(seed, HIDDEN);
    let mut hidden: Vec<EffectSetting> = Vec::new();
    while hidden.len() < faults {
        let Some(id) = FAULTS.choose(&mut rng) else {
            break;
        };
        let is_read = robot.laser.is_some() || !id.starts_with("laser");
        let is_new = hidden.iter().all(|other| other.effect != *id);
        if is_read && is_new {
            hidden.extend(draw_fault(robot, id, poses, &mut rng));
        }
    }
    hidden
}

fn draw_fault(
    robot: &Robot,
    id: &str,
    poses: usize,
    rng: &mut ChaCha8Rng,
) -> Option<EffectSetting> {
    let effect = find(id)?;
    let targets = match effect.scope() {
        Scope::Robot => Vec::new(),
        _ => vec![robot.cables.choose(rng)?.name.clone()],
    };
    let size = log_uniform(rng, FAULT);
    let estimated = effect.parameters().iter().filter(|p| !p.discrete).count();
    let mut parameters = BTreeMap::new();
    for p in effect.parameters() {
        let [least, largest] = p.typical_sizes();
        let value = if p.discrete {
            // In the middle of the poses, where an event leaves enough of them on either side.
            rng.random_range(8..poses - 8) as f64
        } else if p.name == "phase" {
            rng.random_range(p.typical[0]..p.typical[1])
        } else {
            let coordinates = if estimated == 3 || p.unit == "rad" {
                estimated
            } else {
                1
            };
            let value = size * (least * largest).sqrt() / (coordinates as f64).sqrt();
            let is_one_sided = p.bounds[0] == p.neutral;
            if is_one_sided || rng.random() {
                value
            } else {
                -value
            }
        };
        parameters.insert(p.name.to_owned(), p.neutral + value);
    }
    Some(EffectSetting {
        effect: id.to_owned(),
        targets,
        parameters,
    })
}

/// Simulates a machine.
fn machine(preset: &Preset, is_real: bool, faults: usize, seed: u64) -> Result<Machine> {
    let robot = &preset.robot;
    let poses = POSES[usize::from(faults > 2)];
    let hidden = draw_faults(robot, faults, poses, seed);
    let mut effects = hidden.clone();
    if is_real {
        effects.extend(draw_parts(robot, seed));
    }
    let options = SimulationOptions {
        effects,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(poses, seed)
    };
    let run = simulate(robot, &options)?;
    let noncentralities =
        (0..hidden.len()).map(|fault| noncentrality(robot, &options, &hidden, fault));
    let noncentralities = noncentralities.collect::<Result<Vec<f64>>>()?;
    Ok(Machine {
        run,
        is_visible: noncentralities
            .iter()
            .map(|value| *value >= VISIBLE)
            .collect(),
        hidden,
    })
}

/// Chi-square that parts within typical tolerances and the other faults leave of a fault, in readings without noise.
fn noncentrality(
    robot: &Robot,
    options: &SimulationOptions,
    hidden: &[EffectSetting],
    fault: usize,
) -> Result<f64> {
    let options = SimulationOptions {
        effects: hidden.to_vec(),
        noise: false,
        ..options.clone()
    };
    let data = simulate(robot, &options)?.dataset;
    let others = hidden.iter().enumerate().filter(|(k, _)| *k != fault);
    let others = others.map(|(_, other)| BoundEffect::from_setting(other, robot));
    let problem = Problem::new(&data)?
        .with_tolerances(&PartTolerances::typical())
        .with_effects(others.collect::<Result<_, _>>()?);
    let quiet = &mut |_: &_| Control::Continue;
    let first = solve(&problem, &Options::default(), quiet)?;
    let second = solve(&problem.at_poses_of(&first), &Options::default(), quiet)?;
    Ok(second.chi2)
}

impl Machine {
    /// Whether a cause is one of the hidden faults.
    fn is_hidden(&self, cause: &Cause) -> bool {
        self.hidden
            .iter()
            .any(|hidden| self.is_fault(cause, hidden))
    }

    fn is_fault(&self, cause: &Cause, hidden: &EffectSetting) -> bool {
        let robot = &self.run.dataset.robot;
        let cables: Vec<&String> = cause
            .cables()
            .iter()
            .map(|c| &robot.cables[*c].name)
            .collect();
        let same_target = match hidden.targets.as_slice() {
            [] => true,
            targets => cables.len() == 1 && targets.contains(cables[0]),
        };
        cause.effect().id() == hidden.effect && same_target
    }

    /// Whole deviation of the part of a cause: the fault, if it has one, and the deviation within the tolerance.
    fn true_value(&self, cause: &Cause, parameter: &str) -> f64 {
        let robot = &self.run.dataset.robot;
        let settings: Vec<EffectSetting> =
            cause.instances.iter().map(|b| b.setting(robot)).collect();
        let same = |e: &&EffectSetting| {
            let mut settings = settings.iter();
            settings.any(|own| own.effect == e.effect && own.targets == e.targets)
        };
        let all = self.run.truth.effects.iter().filter(same);
        all.filter_map(|e| e.parameters.get(parameter)).sum()
    }

    /// Whether a named size is more than four of its standard deviations from the true deviation. Waves, whose parts add as
    /// vectors, are left out.
    fn is_false(&self, cause: &Cause, parameters: &[FoundParameter]) -> bool {
        let is_off = |p: &FoundParameter| {
            let off = (p.value - self.true_value(cause, p.name)).abs();
            p.sd.is_some_and(|sd| off > 4.0 * sd)
        };
        cause.effect().id() != "drum_eccentricity" && parameters.iter().any(is_off)
    }

    /// Adds the outcome of a diagnosis to a row.
    fn judge(&self, found: &Diagnosis, row: &mut Row) {
        row.sets += 1;
        row.hidden += self.hidden.len();
        row.explained += usize::from(found.extended.adequate);
        row.factor += found.tolerances.factor;
        let mut wrong = 0;
        for finding in &found.findings {
            let is_right = finding.cause().is_some_and(|cause| self.is_hidden(cause));
            let is_false = |cause| self.is_false(cause, &finding.parameters);
            match finding.verdict() {
                Verdict::Named if is_right => {
                    row.named += 1;
                    let cause = finding.cause();
                    cause.inspect(|cause| self.judge_size(cause, &finding.parameters, row));
                    row.false_names += usize::from(cause.is_some_and(is_false));
                }
                Verdict::Named => {
                    wrong += 1;
                    row.false_names += usize::from(finding.cause().is_some_and(is_false));
                }
                Verdict::Ambiguous | Verdict::Unknown => {
                    let is_listed = finding.causes().any(|cause| self.is_hidden(cause));
                    row.listed += usize::from(is_listed);
                }
            }
        }
        self.judge_visible(found, row);
        row.wrong += wrong;
        row.sets_with_wrong += usize::from(wrong > 0);
        let solution = &found.extended_solution;
        for (k, parameter) in solution.parameters.iter().enumerate() {
            let ParameterId::EntryPoint { cable, axis } = parameter.id else {
                continue;
            };
            let Some(sd) = solution.standard_deviation(k) else {
                continue;
            };
            let truth = self.run.truth.cables[cable].pulley.entry_point_m[axis];
            let off = solution.globals.entry_points[cable][axis] - truth;
            row.coordinates += 1;
            row.covered += usize::from(off.abs() < 1.96 * sd);
        }
    }

    /// Counts which of the visible faults are found.
    fn judge_visible(&self, found: &Diagnosis, row: &mut Row) {
        let visible = self.hidden.iter().zip(&self.is_visible);
        for (hidden, _) in visible.filter(|(_, is_visible)| **is_visible) {
            let is_named = found.findings.iter().any(|finding| {
                let mut own = finding.cause().into_iter();
                finding.verdict() == Verdict::Named && own.any(|cause| self.is_fault(cause, hidden))
            });
            let is_listed = found.findings.iter().any(|finding| {
                let mut causes = finding.causes();
                causes.any(|cause| self.is_fault(cause, hidden))
            });
            row.visible += 1;
            row.visible_named += usize::from(is_named);
            row.visible_found += usize::from(is_named || is_listed);
        }
    }

    /// Compares the size of a named fault with the truth; waves, whose parts add as vectors, are left out.
    fn judge_size(&self, cause: &Cause, parameters: &[FoundParameter], row: &mut Row) {
        if cause.effect().id() == "drum_eccentricity" {
            return;
        }
        for parameter in parameters {
            if let Some(sd) = parameter.sd {
                let off = parameter.value - self.true_value(cause, parameter.name);
                row.sizes += 1;
                row.sizes_covered += usize::from(off.abs() < 1.96 * sd);
            }
        }
    }
}

/// Diagnoses so many machines for each number of faults from 0 to `most`, real and exact ones.
///
/// # Errors
/// If a machine cannot be simulated or its data cannot be used.
pub fn study(sets: usize, most: usize, first_seed: u64) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for is_real in [true, false] {
        for faults in 0..=most {
            rows.extend(rows_of(is_real, faults, sets, first_seed)?);
        }
    }
    Ok(rows)
}

/// Diagnoses so many machines with a number of faults, each under all assumptions.
///
/// # Errors
/// If a machine cannot be simulated or its data cannot be used.
pub fn rows_of(is_real: bool, faults: usize, sets: usize, first_seed: u64) -> Result<[Row; 3]> {
    let mut rows = Assumption::ALL.map(|assumption| Row {
        is_real,
        faults,
        assumption: Some(assumption),
        ..Row::default()
    });
    for number in 0..sets {
        let preset = presets::find(ROBOTS[number % ROBOTS.len()]).context("a preset")?;
        let seed = first_seed + (1000 * faults + number) as u64;
        let machine = machine(&preset, is_real, faults, seed)?;
        for (row, assumption) in rows.iter_mut().zip(Assumption::ALL) {
            let mut dataset = machine.run.dataset.clone();
            dataset.robot.tolerances = assumption.stated(&preset.robot, seed);
            let start = Instant::now();
            let options = DiagnosisOptions::default();
            let found = diagnose(&dataset, &options, &mut |_| Control::Continue)?;
            row.seconds.push(start.elapsed().as_secs_f64());
            machine.judge(&found, row);
        }
    }
    Ok(rows)
}

/// The study as a table.
#[must_use]
pub fn markdown(rows: &[Row]) -> String {
    let mut text = "| machines | faults | parts taken as | sets | named | in a list | visible | of these named | or in a list | wrong names | sets with one | false names | pulleys covered | sizes covered | explained | factor | median s |\n|---|--:|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n".to_owned();
    let share = |some: usize, of: usize| match of {
        0 => "-".to_owned(),
        _ => format!("{:.1} %", 100.0 * some as f64 / of as f64),
    };
    for row in rows {
        let mut seconds = row.seconds.clone();
        seconds.sort_by(f64::total_cmp);
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.2} | {:.2} |",
            if row.is_real { "real" } else { "exact" },
            row.faults,
            row.assumption.map_or("", Assumption::name),
            row.sets,
            share(row.named, row.hidden),
            share(row.listed, row.hidden),
            row.visible,
            share(row.visible_named, row.visible),
            share(row.visible_found, row.visible),
            row.wrong,
            share(row.sets_with_wrong, row.sets),
            row.false_names,
            share(row.covered, row.coordinates),
            share(row.sizes_covered, row.sizes),
            share(row.explained, row.sets),
            row.factor / row.sets.max(1) as f64,
            seconds.get(seconds.len() / 2).copied().unwrap_or(f64::NAN),
        );
    }
    text
}
