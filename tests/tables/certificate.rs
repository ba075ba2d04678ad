//! Coverage of the expanded uncertainties of certificates, over simulated robots whose drawings, parts and readings are all off by
//! what is stated.

use std::ops::Range;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use tautline_core::estimation::{Control, Method};
use tautline_core::measurement::Dataset;
use tautline_core::robot::PartTolerances;
use tautline_core::simulation::{SimulationOptions, simulate};
use tautline_study::{drawn_entry_points, monte_carlo};
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
        let first = self.0.start;
        let (propagation, recomputation) = (propagation(first)?, recomputation(first)?);
        Ok(format!("{}\n{propagation}\n{recomputation}", table.text()))
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

/// An input that can be put back to its value in the first data set.
type Restore = fn(&mut Dataset, &Dataset);

/// Sources of the budget that a data set holds, by name.
const SOURCES: [(&str, Restore); 6] = [
    ("encoders", |drawn, known| {
        (drawn.measurements.revolutions).clone_from(&known.measurements.revolutions);
        (drawn.measurements.length_m).clone_from(&known.measurements.length_m);
    }),
    ("force_sensors", |drawn, known| {
        (drawn.measurements.force_n).clone_from(&known.measurements.force_n);
    }),
    ("laser", |drawn, known| {
        (drawn.measurements.laser_m).clone_from(&known.measurements.laser_m);
    }),
    ("home_pose", |drawn, known| {
        drawn.robot.home = known.robot.home;
    }),
    ("target_plane", |drawn, known| {
        drawn.robot.laser = known.robot.laser;
    }),
    ("drawing", |drawn, known| {
        for (cable, known) in drawn.robot.cables.iter_mut().zip(&known.robot.cables) {
            cable.pulley.entry_point_m = known.pulley.entry_point_m;
        }
    }),
];

/// Share of each source in the variance of all entry points, by the budget and by what the variance of identifications from drawn
/// inputs loses when this source is not drawn, for one robot of each kind.
fn recomputation(first_seed: u64) -> Result<String> {
    let mut table = Table::aligned(
        "llr",
        "robot | source | share by the budget | share by recomputation without it",
    );
    for (index, robot) in PRESETS.iter().enumerate() {
        let (fit, _) = identified(4 * first_seed.div_ceil(4) + index as u64)?;
        let budget = fit.budget().context("a budget")?;
        let variance = |change: &(dyn Fn(&mut Dataset) + Sync)| {
            variance_of_all(&drawn_entry_points(&fit, DRAWS, change))
        };
        let whole = variance(&|_| ());
        let budgets = || budget.pulleys.iter().map(|pulley| &pulley.budget);
        let total: f64 = budgets().map(|one| one.variance_m2).sum();
        for (source, restore) in SOURCES {
            let of_source = budgets().map(|one| one.share(source) * one.variance_m2);
            let by_budget = of_source.sum::<f64>() / total;
            if by_budget == 0.0 {
                continue;
            }
            let without = variance(&|drawn| restore(drawn, &fit.dataset));
            table.row(format_args!(
                "{robot} | {source} | {:.1} % | {:.1} %",
                100.0 * by_budget,
                100.0 * (1.0 - without / whole)
            ));
        }
    }
    Ok(table.text())
}

/// Sum of the sample variances of all coordinates (m^2).
fn variance_of_all(found: &[Vec<[f64; 3]>]) -> f64 {
    let count = found.len() as f64;
    let cables = found.first().map_or(0, Vec::len);
    let coordinates = (0..cables).flat_map(|cable| [0, 1, 2].map(|axis| (cable, axis)));
    let variance = |(cable, axis): (usize, usize)| {
        let values = || found.iter().map(|places| places[cable][axis]);
        let mean = values().sum::<f64>() / count;
        values().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0)
    };
    coordinates.map(variance).sum()
}
