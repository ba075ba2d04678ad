//! Coverage of the expanded uncertainties of certificates, over simulated robots whose drawings, parts and readings are all off by
//! what is stated.

use std::ops::Range;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use tautline_core::estimation::{Control, Method};
use tautline_core::robot::PartTolerances;
use tautline_core::simulation::{SimulationOptions, simulate};
use tautline_study::monte_carlo;
use tautline_workflow::identification::{Identification, IdentificationRequest, identify};
use tautline_workflow::report::CoverageInterval;

use super::counting::{Share, by_name, median, total};
use super::markdown::Table;
use super::simulated::{PRESETS, preset};
use super::study::Study;

/// Seed of the first robot.
pub const FIRST_SEED: u64 = 2_026_000;
/// Poses of each data set.
const POSES: usize = 25;
/// Draws of the Monte Carlo.
const DRAWS: usize = 2000;

/// Robots with these seeds, the presets in turn, and what a Monte Carlo says of the first of each.
#[derive(Debug)]
pub struct Certificate(pub Range<u64>);

/// Coordinates of one robot.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Outcome {
    /// Those whose interval holds the true place.
    held: Share,
    /// Sum of the coverage factors.
    factors: f64,
}

impl Study for Certificate {
    type Case = u64;
    type Outcome = Outcome;

    fn cases(&self) -> Result<Vec<u64>> {
        Ok(self.0.clone().collect())
    }

    fn run(&self, seed: &u64) -> Result<Option<Outcome>> {
        let (fit, truth) = identified(*seed)?;
        let mut outcome = Outcome::default();
        for one in uncertain(&fit)? {
            let place = fit.solution.globals.entry_points[one.cable][one.axis];
            let off = place - truth[one.cable][one.axis];
            outcome.held.count(off.abs() <= one.factor * one.sd_m);
            outcome.factors += one.factor;
        }
        Ok(Some(outcome))
    }

    fn table(&self, outcomes: &[(u64, Outcome)]) -> Result<String> {
        let mut table = Table::of_numbers("robot | robots | coordinates | within U | mean k");
        for (name, all) in by_name(&PRESETS, outcomes, |seed| robot(*seed)) {
            let held: Share = total(&all, |one| one.held);
            let factors: f64 = total(&all, |one| one.factors);
            table.row(format_args!(
                "{name} | {} | {} | {:.1} % | {:.2}",
                all.len(),
                held.whole,
                100.0 * held.part as f64 / held.whole as f64,
                factors / held.whole as f64
            ));
        }
        Ok(format!("{}\n{}", table.text(), propagation(self.0.start)?))
    }
}

fn robot(seed: u64) -> &'static str {
    PRESETS[seed as usize % PRESETS.len()]
}

/// A robot as it is, simulated and identified, and the true entry points (m).
fn identified(seed: u64) -> Result<(Identification, Vec<[f64; 3]>)> {
    let mut robot = preset(robot(seed))?.robot;
    robot.tolerances = Some(PartTolerances::typical());
    let simulated = simulate(&robot, &SimulationOptions::new(POSES, seed))?;
    let truth = simulated.truth.cables.iter();
    let truth = truth.map(|cable| cable.pulley.entry_point_m).collect();
    let request = IdentificationRequest::new(simulated.dataset, Method::Joint, &[])?;
    Ok((identify(&request, &mut |_| Control::Continue)?, truth))
}

/// A coordinate of an entry point that has an interval.
struct Coordinate {
    cable: usize,
    axis: usize,
    /// Coverage factor and standard deviation (m).
    factor: f64,
    sd_m: f64,
}

fn uncertain(fit: &Identification) -> Result<Vec<Coordinate>> {
    let budget = fit.budget().context("a budget")?;
    let document = fit.document();
    let mut all = Vec::new();
    for (cable, of) in fit.dataset.robot.cables.iter().enumerate() {
        let factor = budget.coverage_factor_of(&of.name);
        for (axis, sd_m) in document.entry_points_sd_m[cable].iter().enumerate() {
            // Coordinates that are known exactly have no interval.
            if let Some((factor, sd_m)) = factor.zip(sd_m.filter(|sd| *sd > 0.0)) {
                all.push(Coordinate {
                    cable,
                    axis,
                    factor,
                    sd_m,
                });
            }
        }
    }
    Ok(all)
}

/// Widths of the intervals by propagation of distributions over those of the linear budget, for one robot of each kind.
fn propagation(first_seed: u64) -> Result<String> {
    let mut table = Table::of_numbers(
        "robot | draws that converged | width by Monte Carlo over linear, median | least | most",
    );
    for (index, robot) in PRESETS.iter().enumerate() {
        let (fit, _) = identified(4 * first_seed.div_ceil(4) + index as u64)?;
        let drawn = monte_carlo(&fit, DRAWS);
        let ratios = uncertain(&fit)?.into_iter().map(|one| {
            let CoverageInterval { from_m, to_m } = drawn.entry_points[one.cable][one.axis];
            (to_m - from_m) / (2.0 * one.factor * one.sd_m)
        });
        let ratios: Vec<f64> = ratios.collect();
        table.row(format_args!(
            "{robot} | {} of {DRAWS} | {:.2} | {:.2} | {:.2}",
            drawn.converged,
            median(ratios.iter().copied()),
            ratios.iter().copied().fold(f64::NAN, f64::min),
            ratios.iter().copied().fold(f64::NAN, f64::max)
        ));
    }
    Ok(table.text())
}
