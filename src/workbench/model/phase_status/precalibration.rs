//! State of the parts of phase 1.

use tautline_core::instrument::{FORCE_RESIDUAL_LIMIT_N, HomeAverage, WINCH_RESIDUAL_LIMIT_M};

use crate::model::phase::{PhaseStatus, Progress};
use tautline_workflow::precalibration::{Calibration, PerCable, Proposal};

/// The whole phase: among the parts begun, the one that is furthest from done.
#[must_use]
pub fn whole(calibration: &Calibration) -> PhaseStatus {
    let parts = [
        winches(calibration),
        force_sensors(calibration),
        home(calibration),
    ];
    let rank = |standing: &PhaseStatus| match standing.progress {
        Progress::Attention | Progress::OutOfDate => 0,
        Progress::InProgress => 1,
        Progress::Done => 2,
        Progress::NotStarted => 3,
    };
    let worst = parts.into_iter().min_by_key(rank);
    worst
        .filter(|standing| standing.progress != Progress::NotStarted)
        .unwrap_or_else(|| PhaseStatus::new(Progress::NotStarted, "nominal values"))
}

#[must_use]
pub fn winches(calibration: &Calibration) -> PhaseStatus {
    let passed = passed(&calibration.winches, |fit| fit.passed);
    let limit = format!("{} mm", WINCH_RESIDUAL_LIMIT_M * 1e3);
    let noun = ["winch", "winches"];
    share(passed, noun, &limit, &calibration.with_winches)
}

#[must_use]
pub fn force_sensors(calibration: &Calibration) -> PhaseStatus {
    let passed = passed(&calibration.force_sensors, |fit| fit.passed);
    let limit = format!("{FORCE_RESIDUAL_LIMIT_N} N");
    let noun = ["sensor", "sensors"];
    share(passed, noun, &limit, &calibration.with_force_sensors)
}

/// Home platform.
#[must_use]
pub fn home(calibration: &Calibration) -> PhaseStatus {
    let fit = match &calibration.home {
        None => {
            let Some(average) = &calibration.home_average else {
                return PhaseStatus::new(Progress::NotStarted, "nominal home pose");
            };
            return begun(home_line(average), &calibration.with_home);
        }
        Some(Err(_)) => return PhaseStatus::new(Progress::Attention, "no home pose found"),
        Some(Ok(fit)) => fit,
    };
    let outside = fit.sensors.iter().filter(|s| !s.in_range).count();
    if outside > 0 {
        let line = format!("{outside} of {} sensors out of range", fit.sensors.len());
        return PhaseStatus::new(Progress::Attention, line);
    }
    let average = calibration.home_average.as_ref();
    begun(
        average.map_or_else(String::new, home_line),
        &calibration.with_home,
    )
}

fn home_line(average: &HomeAverage) -> String {
    let worst_m = average.sd().0.into_iter().fold(0.0, f64::max);
    format!("home pose to {:.2} mm", worst_m * 1e3)
}

/// Number of fits that pass, and of all fits.
fn passed<T>(fits: &[PerCable<T>], passes: impl Fn(&T) -> bool) -> [usize; 2] {
    let good = |one: &&PerCable<T>| one.fit.as_ref().is_ok_and(&passes);
    [fits.iter().filter(good).count(), fits.len()]
}

fn share(
    [passed, count]: [usize; 2],
    [one, many]: [&str; 2],
    limit: &str,
    proposal: &Proposal,
) -> PhaseStatus {
    if count == 0 {
        return PhaseStatus::new(Progress::NotStarted, "nominal values");
    }
    let noun = if count == 1 { one } else { many };
    let line = format!("{passed} of {count} {noun} within {limit}");
    if passed < count {
        return PhaseStatus::new(Progress::Attention, line);
    }
    begun(line, proposal)
}

/// Passed values are done once they are applied to the robot.
pub(super) fn begun(line: String, proposal: &Proposal) -> PhaseStatus {
    if proposal.is_used {
        PhaseStatus::new(Progress::Done, line)
    } else {
        PhaseStatus::new(Progress::InProgress, format!("{line}, not applied yet"))
    }
}
