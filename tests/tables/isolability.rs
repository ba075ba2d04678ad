//! Predicted probabilities of detection and confusion against simulation: random pairs of faults on random robots.

use anyhow::{Context, Result};
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tautline_core::diagnosis::{Cause, Isolability, is_confused, is_seen, isolability, log_odds};
use tautline_core::effect::EffectSetting;
use tautline_core::geometry::Pose;
use tautline_core::robot::presets::Preset;
use tautline_core::robot::{PartTolerances, Robot};
use tautline_core::simulation::{TrueGeometry, simulate};

use super::counting::Share;
use super::markdown::table;
use super::simulated::{preset, preset_options};

/// Numbers of pairs and of data sets of each, and the seed.
pub const STUDY: (usize, usize, u64) = (30, 60, 2027);
/// Robots among which is drawn, and their poses.
const ROBOTS: [&str; 3] = ["mini", "suspended", "planar"];
const POSES: usize = 25;
/// Rivals among which half of the pairs are drawn: the others would be told apart for certain.
const NEAR: usize = 6;

/// A predicted probability and how often it happened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compared {
    /// Predicted.
    pub predicted: f64,
    /// Data sets in which it happened, of all.
    pub happened: Share,
}

impl Compared {
    /// Whether the prediction is in the 95 % interval of the simulation (Clopper and Pearson).
    #[must_use]
    pub fn agrees(&self) -> bool {
        let [low, high] = self.happened.interval();
        (low..=high).contains(&self.predicted)
    }
}

/// A pair of faults.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// Robot.
    pub robot: &'static str,
    /// The fault that is present, and the other.
    pub names: [String; 2],
    /// Whether the present one is seen.
    pub detection: Compared,
    /// Whether something is seen and the other not ruled out.
    pub confusion: Compared,
}

/// A robot at its poses.
struct Place {
    name: &'static str,
    preset: Preset,
    poses: Vec<Pose>,
    expected: Isolability,
}

impl Place {
    fn new(name: &'static str, seed: u64) -> Result<Self> {
        let mut preset = preset(name)?;
        let mut options = preset_options(&preset, POSES, seed);
        options.geometry = TrueGeometry::Nominal;
        options.noise = false;
        let mut data = simulate(&preset.robot, &options)?.dataset;
        // The prediction is made for exact readings; the machines that it is compared with are as machines are.
        preset.robot.tolerances = Some(PartTolerances::typical());
        data.robot.tolerances.clone_from(&preset.robot.tolerances);
        let commanded = data
            .measurements
            .commanded
            .iter()
            .skip(usize::from(preset.robot.home.is_some()));
        let poses: Option<Vec<Pose>> = commanded.copied().collect();
        Ok(Self {
            name,
            poses: poses.context("commanded poses")?,
            expected: isolability(&data)?,
            preset,
        })
    }

    /// A fault that can be simulated and one that it could be taken for.
    fn draw(&self, rng: &mut ChaCha8Rng) -> Option<[usize; 2]> {
        let all: Vec<usize> = (0..self.expected.faults.len()).collect();
        // What is never or always seen tells little of a prediction.
        let open = |k: &&usize| (0.02..0.98).contains(&self.expected.faults[**k].detection);
        let uncertain: Vec<&usize> = all.iter().filter(open).collect();
        let present = if rng.random_range(0..2) == 0 {
            **uncertain.choose(rng)?
        } else {
            *all.choose(rng)?
        };
        let near = self.expected.rivals(present, 0.0);
        let near = &near[..NEAR.min(near.len())];
        let other = if rng.random_range(0..2) == 0 {
            near.choose(rng)?
        } else {
            all.choose(rng)?
        };
        (present != *other).then_some([present, *other])
    }
}

/// `count` pairs, each with so many data sets with noise and a geometry drawn from its priors.
///
/// # Errors
/// If a robot cannot be simulated.
pub fn study((count, data_sets, seed): (usize, usize, u64)) -> Result<Vec<Pair>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let places: Result<Vec<Place>> = ROBOTS
        .iter()
        .map(|name| Place::new(name, rng.random()))
        .collect();
    let places = places?;
    let mut pairs = Vec::new();
    while pairs.len() < count {
        let place = places.choose(&mut rng).context("a robot")?;
        if let Some(drawn) = place.draw(&mut rng) {
            // A fault with which no tensions hold the platform is another one's.
            pairs.extend(pair(place, drawn, data_sets, rng.random()).ok());
        }
    }
    Ok(pairs)
}

fn pair(place: &Place, [present, other]: [usize; 2], data_sets: usize, seed: u64) -> Result<Pair> {
    let faults = [present, other].map(|k| &place.expected.faults[k]);
    let causes: Vec<Cause> = faults.iter().map(|fault| fault.cause.clone()).collect();
    let robot = &place.preset.robot;
    let hidden = settings(robot, &causes[0]);
    let (mut seen, mut confused) = (Share::default(), Share::default());
    for k in 0..data_sets {
        let mut options = preset_options(&place.preset, POSES, seed.wrapping_add(k as u64));
        options.effects.clone_from(&hidden);
        let data = simulate(robot, &options.commanding(place.poses.clone()))?.dataset;
        let found = log_odds(&data, &causes)?;
        seen.count(is_seen(found[0]));
        confused.count(is_confused(found[0], found[1]));
    }
    Ok(Pair {
        robot: place.name,
        names: [0, 1].map(|k| name(robot, &causes[k])),
        detection: Compared {
            predicted: faults[0].detection,
            happened: seen,
        },
        confusion: Compared {
            predicted: place.expected.pair(present, other).confusion,
            happened: confused,
        },
    })
}

fn settings(robot: &Robot, cause: &Cause) -> Vec<EffectSetting> {
    cause
        .instances
        .iter()
        .map(|bound| bound.setting(robot))
        .collect()
}

fn name(robot: &Robot, cause: &Cause) -> String {
    let setting = &settings(robot, cause)[0];
    match setting.targets.as_slice() {
        [] => setting.effect.clone(),
        targets => format!("{} {}", setting.effect, targets.join(" ")),
    }
}

/// Predictions that agree with the simulation: of detection and of confusion.
#[must_use]
pub fn agreeing(pairs: &[Pair]) -> [Share; 2] {
    let share = |of: fn(&Pair) -> &Compared| Share::of(pairs, |pair| of(pair).agrees());
    [share(|pair| &pair.detection), share(|pair| &pair.confusion)]
}

/// The table.
#[must_use]
pub fn markdown(pairs: &[Pair]) -> String {
    let rows = pairs.iter().map(|pair| {
        let Pair {
            robot,
            names: [present, other],
            ..
        } = pair;
        let (seen, confused) = (cells(&pair.detection), cells(&pair.confusion));
        format!("{robot} | {present} | {other} | {seen} | {confused}")
    });
    let table = table(
        "robot | fault present | other | seen: predicted | simulated (95 %) | not told apart: predicted | simulated (95 %)",
        rows,
    );
    let [seen, confused] = agreeing(pairs);
    format!(
        "{table}\nThe prediction lies in the 95 % interval of the simulation for {} of {} probabilities of detection and {} of {} of \
         confusion.\n",
        seen.part, seen.whole, confused.part, confused.whole
    )
}

fn cells(compared: &Compared) -> String {
    let percent = |value: f64| format!("{:.0} %", 100.0 * value);
    let [low, high] = compared.happened.interval().map(percent);
    let mark = if compared.agrees() {
        ""
    } else {
        " **outside**"
    };
    let (predicted, rate) = (
        percent(compared.predicted),
        percent(compared.happened.ratio()),
    );
    format!("{predicted} | {rate} ({low} to {high}){mark}")
}
