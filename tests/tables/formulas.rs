//! Patterns hidden in simulated readings: how often the formulas that `formulas` lists are the hidden ones.

use std::ops::Range;

use anyhow::{Context, Result};
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use tautline_core::effect::{EffectSetting, Hypothesis};
use tautline_core::estimation::{Control, Problem};
use tautline_core::measurement::Dataset;
use tautline_core::robot::{PartTolerances, Robot};
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_workflow::formulas::{
    Formula, PatternDocument, Reading, find_formulas, formulas, unexplained,
};

use super::counting::{Share, by_name, count, total};
use super::lives::{ROBOTS, drawing, robot};
use super::markdown::Table;
use super::simulated::{asked, exp_uniform, solved, timed};
use super::study::Study;

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

/// Seed of the first data set.
pub const FIRST_SEED: u64 = 44_000;

/// Data sets with these seeds, each with a hidden pattern.
#[derive(Debug)]
pub struct Formulas(pub Range<u64>);

/// What is found in a data set.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Outcome {
    /// What is listed if the doctor leaves something unexplained.
    listed: Option<Listed>,
}

/// A list of patterns.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Listed {
    patterns: usize,
    /// Place of the hidden pattern.
    place: Option<usize>,
    seconds: f64,
}

impl Study for Formulas {
    type Case = u64;
    type Outcome = Outcome;

    fn cases(&self) -> Result<Vec<u64>> {
        Ok(self.0.clone().collect())
    }

    fn run(&self, seed: &u64) -> Result<Option<Outcome>> {
        let listed = one(robot(*seed), 10_000 * seed)?;
        Ok(Some(Outcome { listed }))
    }

    fn table(&self, outcomes: &[(u64, Outcome)]) -> Result<String> {
        let mut table = Table::of_numbers(
            "robot | data sets | something is unexplained | the hidden pattern is first | in the list | only others | none | mean s",
        );
        for (name, all) in by_name(&ROBOTS, outcomes, |seed| robot(*seed)) {
            let listed: Vec<&Listed> = all.iter().filter_map(|one| one.listed.as_ref()).collect();
            let seconds: f64 = total(&listed, |one| one.seconds);
            table.row(format_args!(
                "{name} | {} | {} | {} | {} | {} | {} | {:.1}",
                all.len(),
                listed.len(),
                Share::of(&listed, |one| one.place == Some(0)),
                Share::of(&listed, |one| one.place.is_some()),
                count(&listed, |one| one.place.is_none() && one.patterns > 0),
                count(&listed, |one| one.patterns == 0),
                seconds / listed.len().max(1) as f64,
            ));
        }
        Ok(table.text())
    }
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
    let solution = solved(&problem)?;
    let all = formulas(Reading::Length, &clean, &solution);
    let formula = all.choose(rng).context("a formula")?.clone();
    let hypothesis = Hypothesis::parse(&formula.text)?;
    let effect = hypothesis.effect();
    let [low, high] = effect.parameters()[0].typical_sizes();
    // Typical sizes are those of errors of 0.1 to 10 mm.
    let per_metre = (low * high).sqrt() / 1e-3;
    let noise_m = drawing.cables[0].winch.length_sd_m;
    let times = exp_uniform(SIZE, rng);
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

fn one(name: &str, seed: u64) -> Result<Option<Listed>> {
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
    let (found, seconds) = timed(|| -> Result<_> {
        let diagnosed = asked(dataset)?;
        if unexplained(&diagnosed).is_empty() {
            return Ok(None);
        }
        let found = find_formulas(&diagnosed, &mut |_| Control::Continue)?;
        Ok(Some(
            found.map(|found| found.patterns()).unwrap_or_default(),
        ))
    });
    Ok(found?.map(|patterns| Listed {
        patterns: patterns.len(),
        place: place_of(&patterns, &formula.id, &setting.targets),
        seconds,
    }))
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
