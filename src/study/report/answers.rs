//! The answers of a study in sentences.

use tautline_workflow::wording::units::{mm, significant};

use super::group::{Group, groups};
use crate::plan::StudyPlan;
use crate::result::{CellResult, StudyResult};

/// Relative gain below which a better sensor or more poses are not worthwhile.
const WORTH: f64 = 0.05;
/// Maximum number of groups with sentences.
const MOST: usize = 12;

/// One sentence for each question that a study answers.
#[must_use]
pub fn sentences(plan: &StudyPlan, result: &StudyResult) -> Vec<String> {
    let groups = groups(plan, result);
    let mut sentences: Vec<String> = Vec::new();
    for group in groups.iter().take(MOST) {
        sentences.extend(which_sensor(group));
        sentences.extend(how_many_poses(group));
        sentences.extend(
            plan.study
                .wanted_m
                .and_then(|wanted| wanted_is_reached(group, wanted)),
        );
    }
    sentences.extend(what_else(&groups));
    sentences.extend(growth(&groups));
    sentences.extend(faults(plan, result));
    sentences
}

fn position(cell: &CellResult) -> Option<f64> {
    cell.planned.expected.position_m
}

fn shown(metres: f64) -> String {
    format!("{} mm", significant(1e3 * metres, 3))
}

fn with(laser: &str) -> String {
    match laser {
        "none" => "without a laser".to_owned(),
        "own" => "with its own laser".to_owned(),
        named => format!("with the laser {named}"),
    }
}

/// Accuracy with the best laser, and the worst laser of comparable accuracy.
fn which_sensor(group: &Group<'_>) -> Option<String> {
    let poses = *group.poses().last()?;
    let cells = group.over_laser(poses);
    let best = position(cells.first()?)?;
    let enough = cells
        .iter()
        .rev()
        .find(|cell| position(cell).is_some_and(|error| error <= (1.0 + WORTH) * best))?;
    let worst = cells.last()?;
    let sd = |cell: &CellResult| {
        cell.planned
            .laser_sd_m
            .map_or_else(String::new, |sd| format!("{} (1 sd)", shown(sd)))
    };
    if cells.len() < 2 {
        return Some(format!(
            "{}: {poses} poses and a laser of {} give {}.",
            group.title,
            sd(worst),
            shown(best)
        ));
    }
    let rest = match (
        enough.planned.laser_sd_m == worst.planned.laser_sd_m,
        enough.planned.laser_sd_m == cells[0].planned.laser_sd_m,
    ) {
        (true, _) => "all lasers of the study do as well".to_owned(),
        (false, true) => format!("the one of {} gives {}", sd(worst), shown(position(worst)?)),
        (false, false) => format!(
            "a better laser gains less than 5 %, and the one of {} gives {}",
            sd(worst),
            shown(position(worst)?)
        ),
    };
    Some(format!(
        "{}: with {poses} poses, a laser of {} gives {}; {rest}.",
        group.title,
        sd(enough),
        shown(position(enough)?)
    ))
}

/// Gain by the last increase of the number of poses.
fn how_many_poses(group: &Group<'_>) -> Option<String> {
    let laser = *group.lasers().first()?;
    let cells = group.over_poses(laser);
    let [before, last] = cells
        .len()
        .checked_sub(2)
        .map(|at| [cells[at], cells[at + 1]])?;
    let (from, to) = (position(before)?, position(last)?);
    let [fewer, more] = [before, last].map(|cell| cell.planned.combination.poses);
    let gain = 1.0 - to / from;
    let worth = if gain < WORTH {
        "are not worth it"
    } else {
        "still gain"
    };
    Some(format!(
        "{}: {more} poses instead of {fewer} {worth}: {} instead of {} {}.",
        group.title,
        shown(to),
        shown(from),
        with(laser)
    ))
}

fn wanted_is_reached(group: &Group<'_>, wanted_m: f64) -> Option<String> {
    let reaching = |cell: &&&CellResult| position(cell).is_some_and(|error| error <= wanted_m);
    let cheapest = group.cells.iter().filter(reaching).min_by(|a, b| {
        let key = |cell: &CellResult| {
            (
                cell.planned.combination.poses,
                -cell.planned.laser_sd_m.unwrap_or(f64::INFINITY),
            )
        };
        key(a)
            .partial_cmp(&key(b))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    Some(match cheapest {
        Some(cell) => format!(
            "{}: {} is reached with {} poses or more, {}.",
            group.title,
            shown(wanted_m),
            cell.planned.combination.poses,
            with(&cell.planned.combination.laser)
        ),
        None => format!(
            "{}: {} is not reached; the best cell attains {}.",
            group.title,
            shown(wanted_m),
            shown(best(group)?)
        ),
    })
}

fn best(group: &Group<'_>) -> Option<f64> {
    group
        .cells
        .iter()
        .filter_map(|cell| position(cell))
        .reduce(f64::min)
}

/// The best and the worst of several groups.
fn what_else(groups: &[Group<'_>]) -> Option<String> {
    let same_size = groups.iter().all(|group| group.size_m == groups[0].size_m);
    let same_robot = |group: &&Group<'_>| {
        let robot = |group: &Group<'_>| group.cells[0].planned.combination.robot;
        robot(group) == robot(&groups[0])
    };
    if groups.len() < 2 || !same_size || !groups.iter().all(|group| same_robot(&group)) {
        return None;
    }
    let ranked = |ascending: bool| {
        let mut known: Vec<(&Group<'_>, f64)> = groups
            .iter()
            .filter_map(|group| Some((group, best(group)?)))
            .collect();
        known.sort_by(|a, b| {
            if ascending {
                a.1.total_cmp(&b.1)
            } else {
                b.1.total_cmp(&a.1)
            }
        });
        known.into_iter().next()
    };
    let ((good, best), (bad, worst)) = (ranked(true)?, ranked(false)?);
    Some(format!(
        "With the best laser and the most poses, {} gives {} and {} gives {}: a factor of {} that no laser compensates.",
        good.title,
        shown(best),
        bad.title,
        shown(worst),
        significant(worst / best, 2)
    ))
}

/// Growth of the error with the size.
fn growth(groups: &[Group<'_>]) -> Option<String> {
    let mut sizes: Vec<(f64, f64, f64)> = groups
        .iter()
        .filter_map(|group| {
            let cell = group.cells.first()?;
            Some((
                group.size_m?,
                best(group)?,
                cell.planned.expected.position_m_per_kelvin?,
            ))
        })
        .collect();
    sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, last) = (sizes.first()?, sizes.last()?);
    if last.0 <= first.0 {
        return None;
    }
    let order = (last.1 / first.1).ln() / (last.0 / first.0).ln();
    Some(format!(
        "From {} m to {} m the error grows from {} to {}, with the {} power of the size; a steel frame adds {} mm per kelvin at {} m.",
        significant(first.0, 2),
        significant(last.0, 2),
        shown(first.1),
        shown(last.1),
        significant(order, 2),
        mm(last.2, 3),
        significant(last.0, 2)
    ))
}

fn faults(plan: &StudyPlan, result: &StudyResult) -> Option<String> {
    let mut seen = [0_u64; 2];
    let mut verdicts = [0_u64; 3];
    for errors in result
        .cells
        .iter()
        .filter_map(|cell| cell.simulated.as_ref())
    {
        seen[0] += errors.with_fault.count;
        seen[1] += errors.with_fault.of;
        let doctor = errors.doctor;
        verdicts[0] += doctor.right;
        verdicts[1] += doctor.wrong;
        verdicts[2] +=
            doctor.right + doctor.wrong + doctor.partly + doctor.missed + doctor.rightly_silent;
    }
    if plan.study.faults.is_empty() || seen[1] == 0 {
        return None;
    }
    let percent = |count: u64, of: u64| significant(100.0 * count as f64 / of as f64, 3);
    let doctor = match verdicts[2] {
        0 => String::new(),
        of => format!(
            "; of {of} runs submitted to the diagnosis, it named all faults in {} and a wrong one in {}",
            verdicts[0], verdicts[1]
        ),
    };
    Some(format!(
        "The global test detects {} % of the {} calibrations with a fault{doctor}.",
        percent(seen[0], seen[1]),
        seen[1]
    ))
}
