//! Machines as they are: every part a little off, with and without faults, diagnosed with all parts taken as exact and
//! with tolerances.

use std::collections::BTreeMap;

use anyhow::Result;
use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use tautline_core::diagnosis::{Cause, Diagnosis, FoundParameter, Verdict};
use tautline_core::effect::{
    BoundEffect, EffectSetting, PartDeviation, Scope, find, part_deviations,
};
use tautline_core::estimation::Problem;
use tautline_core::robot::presets::Preset;
use tautline_core::robot::{PartTolerances, Robot, StatedTolerances, Tolerance};
use tautline_core::simulation::{Simulated, SimulationOptions, simulate};

use super::counting::{Share, median, total};
use super::hidden::VISIBLE;
use super::markdown::Table;
use super::simulated::{
    EntryError, PRESETS, diagnosed, is_one_sided, log_uniform, preset, preset_options,
    scatter_part, solved, stream,
};
use super::study::Study;

/// Seed of the first machine without a fault, and the most faults that are hidden in one.
const FIRST_SEED: usize = 40_000;
const MOST_FAULTS: usize = 4;
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

/// So many machines for each number of faults, real and exact ones, the presets in turn.
#[derive(Debug)]
pub struct Tolerances {
    /// Number of machines.
    pub machines: usize,
}

/// A machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Case {
    /// Whether every part is a little off.
    is_real: bool,
    /// Number of hidden faults.
    faults: usize,
    number: usize,
}

/// What a diagnosis makes of a machine.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Outcome {
    /// Hidden faults that are named, and that are in a list.
    named: Share,
    listed: Share,
    /// Faults whose part is visibly outside its typical tolerance: those named, and those named or in a list.
    visible_named: Share,
    visible_found: Share,
    /// Names of something that is not hidden.
    wrong: usize,
    /// Names with a size that is more than four stated standard deviations from the true deviation of the part.
    false_names: usize,
    /// Coordinates of pulleys within their 95 % interval.
    covered: Share,
    /// Sizes of named faults within their 95 % interval.
    sizes: Share,
    /// Whether the final model explains the data.
    is_explained: bool,
    /// Factor of the tolerances.
    factor: f64,
    seconds: f64,
}

impl Study for Tolerances {
    type Case = Case;
    /// Under each assumption.
    type Outcome = [Outcome; 3];

    fn cases(&self) -> Result<Vec<Case>> {
        let kinds = [true, false].into_iter().flat_map(|is_real| {
            let faults = 0..=MOST_FAULTS;
            faults.map(move |faults| (is_real, faults))
        });
        let cases = kinds.flat_map(|(is_real, faults)| {
            (0..self.machines).map(move |number| Case {
                is_real,
                faults,
                number,
            })
        });
        Ok(cases.collect())
    }

    fn run(&self, case: &Case) -> Result<Option<[Outcome; 3]>> {
        let preset = preset(PRESETS[case.number % PRESETS.len()])?;
        let seed = (FIRST_SEED + 1000 * case.faults + case.number) as u64;
        let machine = machine(&preset, case.is_real, case.faults, seed)?;
        let outcome = |assumption: Assumption| -> Result<Outcome> {
            let mut dataset = machine.run.dataset.clone();
            dataset.robot.tolerances = assumption.stated(&preset.robot, seed);
            let (found, seconds) = diagnosed(&dataset)?;
            Ok(Outcome {
                seconds,
                ..machine.judge(&found)
            })
        };
        let [exact, stated, typical] = Assumption::ALL.map(outcome);
        Ok(Some([exact?, stated?, typical?]))
    }

    fn table(&self, outcomes: &[(Case, [Outcome; 3])]) -> Result<String> {
        let mut table = Table::aligned(
            "lrlr",
            "machines | faults | parts taken as | sets | named | in a list | visible | of these named | or in a list | wrong names | sets with one | false names | pulleys covered | sizes covered | explained | factor | median s",
        );
        for of_row in
            outcomes.chunk_by(|(a, _), (b, _)| a.is_real == b.is_real && a.faults == b.faults)
        {
            let (case, _) = of_row[0];
            let kind = if case.is_real { "real" } else { "exact" };
            for (k, assumption) in Assumption::ALL.iter().enumerate() {
                let all: Vec<&Outcome> = of_row.iter().map(|(_, three)| &three[k]).collect();
                table.row(format_args!(
                    "{kind} | {} | {} | {}",
                    case.faults,
                    assumption.name(),
                    row(&all)
                ));
            }
        }
        Ok(table.text())
    }
}

fn row(all: &[&Outcome]) -> String {
    let sum = |share: fn(&Outcome) -> Share| -> Share { total(all, share) };
    let visible = sum(|one| one.visible_named);
    let factors: f64 = total(all, |one| one.factor);
    format!(
        "{} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.2} | {:.2}",
        all.len(),
        sum(|one| one.named).percent(),
        sum(|one| one.listed).percent(),
        visible.whole,
        visible.percent(),
        sum(|one| one.visible_found).percent(),
        total::<_, usize>(all, |one| one.wrong),
        Share::of(all, |one| one.wrong > 0).percent(),
        total::<_, usize>(all, |one| one.false_names),
        sum(|one| one.covered).percent(),
        sum(|one| one.sizes).percent(),
        Share::of(all, |one| one.is_explained).percent(),
        factors / all.len().max(1) as f64,
        median(all.iter().map(|one| one.seconds)),
    )
}

/// A simulated machine with what is hidden in it.
struct Machine {
    run: Simulated,
    hidden: Vec<EffectSetting>,
    /// Whether each hidden fault is visible.
    is_visible: Vec<bool>,
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
            None => log_uniform(SCATTER, &mut rng),
        };
        scatter.insert(id, own);
        scatter_part(&mut deviation, own, &mut rng);
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
            let factor = log_uniform([MISSTATED.recip(), MISSTATED], &mut rng);
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
    let size = log_uniform(FAULT, rng);
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
            let is_vector = estimated == 3 || p.unit == "rad";
            let coordinates = if is_vector { estimated } else { 1 };
            let value = size * (least * largest).sqrt() / (coordinates as f64).sqrt();
            let is_positive = is_one_sided(p) || rng.random();
            if is_positive { value } else { -value }
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
        ..preset_options(preset, poses, seed)
    };
    let is_visible = |fault| Ok(noncentrality(robot, &options, &hidden, fault)? >= VISIBLE);
    Ok(Machine {
        run: simulate(robot, &options)?,
        is_visible: (0..hidden.len()).map(is_visible).collect::<Result<_>>()?,
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
    let first = solved(&problem)?;
    Ok(solved(&problem.at_poses_of(&first))?.chi2)
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

    /// The outcome of a diagnosis.
    fn judge(&self, found: &Diagnosis) -> Outcome {
        let [mut named, mut listed] = [0; 2];
        let mut outcome = Outcome {
            is_explained: found.extended.adequate,
            factor: found.tolerances.factor,
            ..Outcome::default()
        };
        for finding in &found.findings {
            let cause = finding.cause();
            let is_right = cause.is_some_and(|cause| self.is_hidden(cause));
            if finding.verdict() != Verdict::Named {
                listed += usize::from(finding.causes().any(|cause| self.is_hidden(cause)));
                continue;
            }
            let is_false = |cause| self.is_false(cause, &finding.parameters);
            outcome.false_names += usize::from(cause.is_some_and(is_false));
            outcome.wrong += usize::from(!is_right);
            named += usize::from(is_right);
            if let Some(cause) = cause.filter(|_| is_right) {
                self.judge_size(cause, &finding.parameters, &mut outcome.sizes);
            }
        }
        let whole = self.hidden.len();
        outcome.named = Share { part: named, whole };
        outcome.listed = Share {
            part: listed,
            whole,
        };
        self.judge_visible(found, &mut outcome);
        for one in EntryError::all(&found.extended_solution, &self.run.truth) {
            if let Some(sd_m) = one.sd_m {
                outcome.covered.count(one.error_m.abs() < 1.96 * sd_m);
            }
        }
        outcome
    }

    /// Counts which of the visible faults are found.
    fn judge_visible(&self, found: &Diagnosis, outcome: &mut Outcome) {
        let visible = self.hidden.iter().zip(&self.is_visible);
        for (hidden, _) in visible.filter(|(_, is_visible)| **is_visible) {
            let is_it = |cause: &Cause| self.is_fault(cause, hidden);
            let mut findings = found.findings.iter();
            let is_named = findings.any(|finding| {
                finding.verdict() == Verdict::Named && finding.cause().is_some_and(is_it)
            });
            let mut findings = found.findings.iter();
            let is_listed = findings.any(|finding| finding.causes().any(is_it));
            outcome.visible_named.count(is_named);
            outcome.visible_found.count(is_named || is_listed);
        }
    }

    /// Compares the size of a named fault with the truth; waves, whose parts add as vectors, are left out.
    fn judge_size(&self, cause: &Cause, parameters: &[FoundParameter], sizes: &mut Share) {
        if cause.effect().id() == "drum_eccentricity" {
            return;
        }
        for parameter in parameters {
            if let Some(sd) = parameter.sd {
                let off = parameter.value - self.true_value(cause, parameter.name);
                sizes.count(off.abs() < 1.96 * sd);
            }
        }
    }
}
