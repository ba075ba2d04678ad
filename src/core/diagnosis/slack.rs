//! A slack cable as a regime: at some poses one cable is longer than the distance that it spans, by undetermined amounts.
//!
//! A force sensor of the cable reads zero there, to within its noise, so that the poses are known. Without a sensor they are
//! found one by one, each the one that reduces chi-square most, as long as readings are too long. The length, and the force,
//! are left out at these poses. With `k` of `m` poses the log evidence is, beside `-chi^2/2` of the fit without these readings,
//!
//! ```text
//! log(p/n) + log P(k of m) - sum over poses of log(A / (sqrt(2 pi) s))
//! ```
//!
//! for the probability `p` that one of `n` cables gets slack, and amounts that are equally probable up to `A`, while their
//! readings have the standard deviation `s`. If a sensor tells the poses, the second term is omitted.

use std::f64::consts::TAU;

use statrs::function::factorial::ln_binomial;

use super::Quantity;
use super::budget::{
    LARGEST_SHARE_OF_SLACK, MAX_SLACK_CABLES, MAX_SLACK_POSES, MIN_REDUNDANCY_OF_SLACK, MIN_RELIEF,
};
use super::fit::Fit;
use super::fitted_problem::{chi2_with, problem_at_fitted_poses};
use super::priors::{LARGEST_SLACK, SLACK_CABLE, SLACK_FORCE};
use super::report::SlackCable;
use super::residual_space::ResidualSpace;
use crate::estimation::EstimationError;
use crate::measurement::Dataset;
use crate::statistics::log_sum;

/// A slack cable, and the dataset without its readings at the slack poses.
pub(super) struct WithoutSlack {
    pub slack: SlackCable,
    pub dataset: Dataset,
    /// Log evidence relative to readings without misfit.
    pub log_evidence: f64,
    /// The part of it that does not depend on the misfit.
    pub log_prior: f64,
}

/// A length reading that is too long.
struct TooLong {
    row: usize,
    excess_m: f64,
    sd_m: f64,
    relief: f64,
}

/// Explanation without a slack cable, which a slack cable has to surpass.
pub(super) struct Rival {
    /// Log evidence that a slack cable must exceed to be reported.
    pub least: f64,
    /// Chi-square that readings without misfit leave, as far as it is known.
    pub chi2: f64,
    /// Variance of the readings in that stated.
    pub variance: f64,
}

/// The slack cable that explains most of the misfit of an independent dataset; `None` if none is as good as a rival, or
/// `go_on` says no. Without force sensors, only the cables whose readings are too long by most are tried.
pub(super) fn find_slack(
    dataset: &Dataset,
    rival: &Rival,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Option<WithoutSlack>, EstimationError> {
    let problem = problem_at_fitted_poses(dataset)?;
    let fit = Fit::new(&problem, &[])?;
    let is_read = |cable: &usize| {
        let sensor = dataset.robot.cables[*cable].force_sensor;
        !dataset.measurements.force_n.is_empty() && sensor.is_some()
    };
    let cables = 0..dataset.robot.cable_count();
    let (read, mut unread): (Vec<usize>, Vec<usize>) = cables.partition(is_read);
    let relief = |cable: &usize| -> f64 {
        let readings = too_long(&fit, dataset, *cable);
        readings.iter().map(|one| one.relief).sum()
    };
    unread.sort_by(|a, b| relief(b).total_cmp(&relief(a)));
    unread.truncate(MAX_SLACK_CABLES);
    let mut best: Option<WithoutSlack> = None;
    for cable in read.into_iter().chain(unread) {
        let slack = slack_of(dataset, cable, rival, go_on)?;
        let least = best.as_ref().map_or(rival.least, |best| best.log_evidence);
        best = slack.filter(|slack| slack.log_evidence > least).or(best);
    }
    Ok(best)
}

fn slack_of(
    dataset: &Dataset,
    cable: usize,
    rival: &Rival,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Option<WithoutSlack>, EstimationError> {
    let data = &dataset.measurements;
    let most = (LARGEST_SHARE_OF_SLACK * data.len() as f64) as usize;
    let most = most.min(MAX_SLACK_POSES);
    let possible: Vec<usize> = (0..data.len())
        .filter(|row| may_be_slack(dataset, *row, cable))
        .collect();
    let is_read = !data.force_n.is_empty() && dataset.robot.cables[cable].force_sensor.is_some();
    let log_prior = (SLACK_CABLE / dataset.robot.cable_count() as f64).ln();
    let without = |dataset: Dataset, rows: &[usize], excess_m, log_prior: f64, chi2: f64| {
        let mut poses: Vec<i64> = rows.iter().map(|row| data.labels[*row]).collect();
        poses.sort_unstable();
        WithoutSlack {
            slack: SlackCable {
                cable,
                poses,
                excess_m,
                log_odds: 0.0,
                is_left_out: false,
            },
            dataset,
            log_evidence: log_prior - 0.5 * chi2 / rival.variance,
            log_prior,
        }
    };
    let largest_m = largest_slack_m(dataset);
    let price = |sd_m: f64| {
        let sd_m = sd_m * rival.variance.sqrt();
        (largest_m / (TAU.sqrt() * sd_m)).ln().max(0.0)
    };
    let mut kept = dataset.clone();
    if is_read {
        if possible.is_empty() || possible.len() > most {
            return Ok(None);
        }
        for row in &possible {
            leave_out(&mut kept, *row, cable);
        }
        let sd_m = dataset.robot.cables[cable].winch.length_sd_m;
        let chi2 = chi2_with(&kept, &[], 0.0)?;
        let log_prior = log_prior - possible.len() as f64 * price(sd_m);
        return Ok(Some(without(kept, &possible, None, log_prior, chi2)));
    }
    let mut rows: Vec<usize> = Vec::new();
    let mut excess_m = [f64::INFINITY, 0.0];
    let mut cost = 0.0;
    let mut best: Option<WithoutSlack> = None;
    // Leaving out a reading without misfit takes away about one of chi-square.
    let may_win = |cost: f64, count: usize| {
        log_prior - cost - 0.5 * (rival.chi2 / rival.variance - count as f64) > rival.least
    };
    while rows.len() <= most && may_win(cost, rows.len()) && go_on() {
        let problem = problem_at_fitted_poses(&kept)?;
        let fit = Fit::new(&problem, &[])?;
        let log_prior = log_prior + log_share_of(&rows, &possible) - cost;
        let chi2 = fit.solution.chi2;
        let slack = without(kept.clone(), &rows, Some(excess_m), log_prior, chi2);
        let is_better = (best.as_ref()).is_none_or(|best| slack.log_evidence > best.log_evidence);
        if !rows.is_empty() && is_better {
            best = Some(slack);
        }
        let order = |a: &TooLong, b: &TooLong| a.relief.total_cmp(&b.relief);
        let Some(next) = too_long(&fit, &kept, cable).into_iter().max_by(order) else {
            break;
        };
        rows.push(next.row);
        excess_m = [
            excess_m[0].min(next.excess_m),
            excess_m[1].max(next.excess_m),
        ];
        cost += price(next.sd_m);
        leave_out(&mut kept, next.row, cable);
    }
    Ok(best)
}

/// Log probability of a set of slack poses among those possible: with equal odds any set with an unknown share of the poses, or
/// an unknown number of runs of successive poses, which lie close together as the region of low tension does.
fn log_share_of(rows: &[usize], possible: &[usize]) -> f64 {
    let size = possible.len() as u64;
    let is_slack = |row: &usize| rows.contains(row);
    let starts = (0..possible.len())
        .filter(|k| is_slack(&possible[*k]) && (*k == 0 || !is_slack(&possible[*k - 1])));
    let whichever = -((size + 1) as f64).ln() - ln_binomial(size, rows.len() as u64);
    let in_runs = -((size / 2 + 1) as f64).ln() - ln_binomial(size + 1, 2 * starts.count() as u64);
    log_sum([whichever, in_runs].into_iter()) - std::f64::consts::LN_2
}

/// Whether a cable may be slack at a row: its sensor, if it has one, reads no force.
fn may_be_slack(dataset: &Dataset, row: usize, cable: usize) -> bool {
    let data = &dataset.measurements;
    if dataset.robot.home.is_some() && Some(row) == data.home_row() {
        return false;
    }
    let sensor = dataset.robot.cables[cable].force_sensor;
    let Some(sensor) = sensor.filter(|_| !data.force_n.is_empty()) else {
        return true;
    };
    let tension_n = sensor.tension_n(data.force_n.get(row, cable));
    tension_n.is_nan() || tension_n.abs() < SLACK_FORCE * sensor.tension_sd_n
}

/// The readings of a cable that are too long.
fn too_long(fit: &Fit<'_>, dataset: &Dataset, cable: usize) -> Vec<TooLong> {
    let linear = fit.linearisation();
    let space = ResidualSpace::new(&linear);
    let redundancy = space.redundancy();
    let of_cable = (0..space.rows()).filter_map(|k| {
        let id = space.readings[k]?;
        let row = space.measured[k]?;
        let is_length = id.quantity == Quantity::Length && id.cable == Some(cable);
        if !is_length
            || redundancy[k] < MIN_REDUNDANCY_OF_SLACK
            || !may_be_slack(dataset, row, cable)
        {
            return None;
        }
        // Residuals are predictions minus readings.
        let error = -space.residual[k] / redundancy[k];
        let sd_m = linear.rows[k].sd;
        Some(TooLong {
            row,
            excess_m: error * sd_m,
            sd_m: sd_m / redundancy[k].sqrt(),
            relief: space.residual[k].powi(2) / redundancy[k],
        })
    });
    let largest_m = largest_slack_m(dataset);
    let is_relief =
        |one: &TooLong| (0.0..largest_m).contains(&one.excess_m) && one.relief > MIN_RELIEF;
    of_cable.filter(is_relief).collect()
}

fn largest_slack_m(dataset: &Dataset) -> f64 {
    LARGEST_SLACK * dataset.robot.frame_size_m().unwrap_or(0.0)
}

/// The dataset without the readings of some cables, but those at home.
pub(super) fn without_cables(dataset: &Dataset, cables: &[usize]) -> Dataset {
    let mut reduced = dataset.clone();
    let home = dataset.robot.home.and(dataset.measurements.home_row());
    for row in (0..dataset.measurements.len()).filter(|row| Some(*row) != home) {
        cables
            .iter()
            .for_each(|cable| leave_out(&mut reduced, row, *cable));
    }
    reduced
}

fn leave_out(dataset: &mut Dataset, row: usize, cable: usize) {
    let data = &mut dataset.measurements;
    for grid in [&mut data.revolutions, &mut data.length_m, &mut data.force_n] {
        if !grid.is_empty() {
            grid.set(row, cable, f64::NAN);
        }
    }
}
