//! Coverage of the expanded uncertainties of certificates, over simulated robots whose drawings, parts and readings are all off by
//! what is stated.

use std::fmt::Write as _;

use anyhow::{Context, Result};
use tautline_core::estimation::{Control, Method};
use tautline_core::measurement::Dataset;
use tautline_core::robot::PartTolerances;
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, simulate};
use tautline_study::{drawn_entry_points, monte_carlo};
use tautline_workflow::identification::{Identification, IdentificationRequest, identify};
use tautline_workflow::report::CoverageInterval;

use super::parallel::in_parallel;

/// Robots, in turn.
const ROBOTS: [&str; 4] = ["mini", "hall", "suspended", "planar"];
/// Poses of each data set.
const POSES: usize = 25;

/// Coordinates whose interval holds the true place.
#[derive(Debug, Clone, Copy, Default)]
struct Held {
    coordinates: usize,
    held: usize,
    /// Sum of the coverage factors.
    factors: f64,
}

/// Identifies so many robots and counts the coordinates within their expanded uncertainties.
///
/// # Errors
/// If a robot cannot be simulated or identified.
pub fn coverage(robots: u64, first_seed: u64) -> Result<String> {
    let seeds: Vec<u64> = (first_seed..first_seed + robots).collect();
    let held = in_parallel(&seeds, None, |seed| held(*seed));
    let mut text = String::from(
        "| robot | robots | coordinates | within U | mean k |\n|---|--:|--:|--:|--:|\n",
    );
    let mut all = Held::default();
    for (index, robot) in ROBOTS.iter().enumerate() {
        let mut sum = Held::default();
        let mut sets = 0;
        for (seed, one) in seeds.iter().zip(&held) {
            if *seed % 4 != index as u64 {
                continue;
            }
            let one = one.as_ref().map_err(|error| anyhow::anyhow!("{error}"))?;
            sets += 1;
            sum.add(one);
        }
        all.add(&sum);
        writeln!(text, "| {robot} | {sets} | {} |", sum.row())?;
    }
    writeln!(text, "| all | {robots} | {} |", all.row())?;
    Ok(text)
}

impl Held {
    fn add(&mut self, other: &Self) {
        self.coordinates += other.coordinates;
        self.held += other.held;
        self.factors += other.factors;
    }

    fn row(&self) -> String {
        let count = self.coordinates as f64;
        format!(
            "{} | {:.1} % | {:.2}",
            self.coordinates,
            100.0 * self.held as f64 / count,
            self.factors / count
        )
    }
}

/// A robot as it is, simulated and identified.
fn identified(seed: u64) -> Result<(Identification, Vec<[f64; 3]>)> {
    let name = ROBOTS[(seed % 4) as usize];
    let mut robot = presets::find(name).context("a preset")?.robot;
    robot.tolerances = Some(PartTolerances::typical());
    let simulated = simulate(&robot, &SimulationOptions::new(POSES, seed))?;
    let truth = simulated.truth.cables.iter();
    let truth = truth.map(|cable| cable.pulley.entry_point_m).collect();
    let request = IdentificationRequest::new(simulated.dataset, Method::Joint, &[])?;
    Ok((identify(&request, &mut |_| Control::Continue)?, truth))
}

fn held(seed: u64) -> Result<Held> {
    let (fit, truth) = identified(seed)?;
    let budget = fit.budget().context("a budget")?;
    let document = fit.document();
    let mut sum = Held::default();
    for (index, cable) in fit.dataset.robot.cables.iter().enumerate() {
        let Some(factor) = budget.coverage_factor_of(&cable.name) else {
            continue;
        };
        for axis in 0..3 {
            let sd = document.entry_points_sd_m[index][axis];
            // Coordinates that are known exactly have no interval.
            let Some(sd) = sd.filter(|sd| *sd > 0.0) else {
                continue;
            };
            let off = fit.solution.globals.entry_points[index][axis] - truth[index][axis];
            sum.coordinates += 1;
            sum.held += usize::from(off.abs() <= factor * sd);
            sum.factors += factor;
        }
    }
    Ok(sum)
}

/// Widths of the intervals by propagation of distributions over those of the linear budget, for one robot of each kind.
///
/// # Errors
/// If a robot cannot be simulated or identified.
pub fn propagation(draws: usize, first_seed: u64) -> Result<String> {
    let mut text = String::from(
        "| robot | draws that converged | width by Monte Carlo over linear, median | least | most |\n|---|--:|--:|--:|--:|\n",
    );
    for (index, robot) in ROBOTS.iter().enumerate() {
        let (fit, _) = identified(4 * first_seed.div_ceil(4) + index as u64)?;
        let budget = fit.budget().context("a budget")?;
        let document = fit.document();
        let drawn = monte_carlo(&fit, draws);
        let mut ratios = Vec::new();
        for (index, cable) in fit.dataset.robot.cables.iter().enumerate() {
            let factor = budget.coverage_factor_of(&cable.name);
            for axis in 0..3 {
                let sd = document.entry_points_sd_m[index][axis];
                if let Some((factor, sd)) = factor.zip(sd.filter(|sd| *sd > 0.0)) {
                    let CoverageInterval { from_m, to_m } = drawn.entry_points[index][axis];
                    ratios.push((to_m - from_m) / (2.0 * factor * sd));
                }
            }
        }
        ratios.sort_by(f64::total_cmp);
        let at = |place: usize| ratios.get(place).copied().unwrap_or(f64::NAN);
        writeln!(
            text,
            "| {robot} | {} of {draws} | {:.2} | {:.2} | {:.2} |",
            drawn.converged,
            at(ratios.len() / 2),
            at(0),
            at(ratios.len().saturating_sub(1))
        )?;
    }
    Ok(text)
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
        drawn.robot.home = known.robot.home
    }),
    ("target_plane", |drawn, known| {
        drawn.robot.laser = known.robot.laser
    }),
    ("drawing", |drawn, known| {
        for (cable, known) in drawn.robot.cables.iter_mut().zip(&known.robot.cables) {
            cable.pulley.entry_point_m = known.pulley.entry_point_m;
        }
    }),
];

/// Share of each source in the variance of all entry points, by the budget and by what the variance of identifications from drawn
/// inputs loses when this source is not drawn.
///
/// # Errors
/// If a robot cannot be simulated or identified.
pub fn recomputation(draws: usize, first_seed: u64) -> Result<String> {
    let mut text = String::from(
        "| robot | source | share by the budget | share by recomputation without it |\n|---|---|--:|--:|\n",
    );
    for (index, robot) in ROBOTS.iter().enumerate() {
        let (fit, _) = identified(4 * first_seed.div_ceil(4) + index as u64)?;
        let budget = fit.budget().context("a budget")?;
        let variance = |change: &(dyn Fn(&mut Dataset) + Sync)| {
            variance_of_all(&drawn_entry_points(&fit, draws, change))
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
            writeln!(
                text,
                "| {robot} | {source} | {:.1} % | {:.1} % |",
                100.0 * by_budget,
                100.0 * (1.0 - without / whole)
            )?;
        }
    }
    Ok(text)
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
