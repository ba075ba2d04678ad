//! Patterns hidden in simulated readings: how often the formulas that `formulas` lists are the hidden ones.

use std::fmt::Write as _;
use std::sync::Arc;

use anyhow::{Context, Result};
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tautline_core::diagnosis::DiagnosisOptions;
use tautline_core::effect::{EffectSetting, Hypothesis};
use tautline_core::estimation::{Control, Options, Problem, solve};
use tautline_core::measurement::Dataset;
use tautline_core::robot::{PartTolerances, Robot};
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_workflow::diagnosis::{TIME_LIMIT_S, diagnose_dataset};
use tautline_workflow::formulas::{
    Formula, PatternDocument, Reading, find_formulas, formulas, unexplained,
};

use crate::tables::lives::{ROBOTS, drawing, share};

/// A hypothesis that no effect of the catalogue looks like: an error that depends on two quantities together, with another id and
/// order of factors than the grammar's.
pub const UNNAMED: &str = r#"
id = "oval_groove"
title = "Groove that widens towards one side"
scope = "cable"
cause = "The groove of the pulley of {cable} widens: {size}."
workshop = "Measure the groove."

[parameters.size]
unit = "1/rad"
typical = [1e-3, 1e-1]

[change]
paid = "paid + size * wrap * position_z"
"#;

/// Poses of a data set.
const POSES: usize = 40;
/// Root mean square of the hidden error over the noise of the readings, log-uniform.
const SIZE: [f64; 2] = [4.0, 40.0];

/// Counts over data sets.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counts {
    sets: usize,
    /// Those in which the doctor leaves something unexplained.
    unexplained: usize,
    first: usize,
    listed: usize,
    /// Those in which only other patterns are listed, and those with none.
    others: usize,
    none: usize,
    seconds: f64,
}

/// Hides patterns in `sets` data sets, from a first seed on.
///
/// # Errors
/// If a robot cannot be simulated or diagnosed.
pub fn study(sets: usize, first_seed: u64) -> Result<Vec<(&'static str, Counts)>> {
    let mut found: Vec<(&'static str, Counts)> =
        ROBOTS.map(|name| (name, Counts::default())).into();
    for set in 0..sets {
        let (name, counts) = &mut found[set % ROBOTS.len()];
        one(name, first_seed + set as u64, counts).with_context(|| format!("{name}, set {set}"))?;
    }
    Ok(found)
}

/// A formula of the grammar for the lengths of a robot, and the size at which its error has a root mean square.
fn hidden(
    drawing: &Robot,
    truth: &Robot,
    rng: &mut ChaCha8Rng,
    seed: u64,
) -> Result<(Formula, EffectSetting)> {
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        ..SimulationOptions::new(POSES, seed)
    };
    let mut clean = simulate(truth, &options)?.dataset;
    clean.robot = drawing.clone();
    let problem = Problem::new(&clean)?;
    let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue)?;
    let all = formulas(Reading::Length, &clean, &solution);
    let formula = all.choose(rng).context("a formula")?.clone();
    let hypothesis = Hypothesis::parse(&formula.text)?;
    let effect = hypothesis.effect();
    let [low, high] = effect.parameters()[0].typical_sizes();
    // Typical sizes are those of errors of 0.1 to 10 mm.
    let per_metre = (low * high).sqrt() / 1e-3;
    let noise_m = drawing.cables[0].winch.length_sd_m;
    let times = rng.random_range(SIZE[0].ln()..SIZE[1].ln()).exp();
    let value = per_metre * noise_m * times;
    let cable = &drawing.cables[rng.random_range(0..drawing.cable_count())];
    let parameters = effect.parameters().iter();
    let setting = EffectSetting {
        effect: formula.id.clone(),
        targets: vec![cable.name.clone()],
        parameters: parameters.map(|p| (p.name.to_owned(), value)).collect(),
    };
    Ok((formula, setting))
}

fn one(name: &str, seed: u64, counts: &mut Counts) -> Result<()> {
    let seed = 10_000 * seed;
    let mut drawing = drawing(name)?;
    drawing.tolerances = Some(PartTolerances::typical());
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut truth = simulate(&drawing, &SimulationOptions::new(1, seed))?.truth;
    let (formula, setting) = hidden(&drawing, &truth, &mut rng, seed + 1)?;
    truth.add_hypothesis(&Hypothesis::parse(&formula.text)?)?;
    truth.effects.push(setting.clone());
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        ..SimulationOptions::new(POSES, seed + 2)
    };
    let measurements = simulate(&truth, &options)?.dataset.measurements;
    let dataset = Dataset {
        robot: drawing,
        measurements,
    };
    let started = std::time::Instant::now();
    let alpha = DiagnosisOptions::default().alpha;
    let asked = (alpha, TIME_LIMIT_S);
    let diagnosed = diagnose_dataset(Arc::new(dataset), asked, &mut |_| Control::Continue)?;
    counts.sets += 1;
    if unexplained(&diagnosed).is_empty() {
        return Ok(());
    }
    counts.unexplained += 1;
    let found = find_formulas(&diagnosed, &mut |_| Control::Continue)?;
    counts.seconds += started.elapsed().as_secs_f64();
    let patterns = found.map(|found| found.patterns()).unwrap_or_default();
    let place = place_of(&patterns, &formula.id, &setting.targets);
    match (place, patterns.is_empty()) {
        (Some(0), _) => counts.first += 1,
        (Some(_), _) => {}
        (None, false) => counts.others += 1,
        (None, true) => counts.none += 1,
    }
    counts.listed += usize::from(place.is_some());
    Ok(())
}

/// Place of a formula on its targets in a list.
pub(crate) fn place_of(
    patterns: &[PatternDocument],
    effect: &str,
    targets: &[String],
) -> Option<usize> {
    let is_it = |one: &PatternDocument| one.effect == effect && one.targets == targets;
    patterns.iter().position(is_it)
}

/// The table in Markdown.
#[must_use]
pub fn markdown(found: &[(&'static str, Counts)]) -> String {
    let mut text = String::from(
        "| robot | data sets | something is unexplained | the hidden pattern is first | in the list | only others | none | mean s |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let mut all = Counts::default();
    for (_, counts) in found {
        all.add(counts);
    }
    for (name, counts) in found.iter().map(|(n, c)| (*n, c)).chain([("all", &all)]) {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {} | {} | {} | {:.1} |",
            counts.sets,
            counts.unexplained,
            share(counts.first, counts.unexplained),
            share(counts.listed, counts.unexplained),
            counts.others,
            counts.none,
            counts.seconds / counts.unexplained.max(1) as f64,
        );
    }
    text
}

impl Counts {
    fn add(&mut self, other: &Self) {
        self.sets += other.sets;
        self.unexplained += other.unexplained;
        self.first += other.first;
        self.listed += other.listed;
        self.others += other.others;
        self.none += other.none;
        self.seconds += other.seconds;
    }
}
