//! The tables of docs/which-sensor: the studies of docs/studies, planned, run, merged.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use tautline_core::estimation::Control;
use tautline_core::threads::available;
use tautline_session::read_versioned_toml;
use tautline_study::report::groups;
use tautline_study::result::CellResult;
use tautline_study::run::run;
use tautline_study::{StudyFile, StudyPlan, StudyResult, merge};

/// Folder of the studies.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/studies")
}

/// A study of the documentation with its result.
///
/// # Errors
/// If it cannot be planned, run or merged.
pub fn study(name: &str) -> Result<(StudyPlan, StudyResult)> {
    let path = folder().join(format!("{name}.toml"));
    let study = read_versioned_toml::<StudyFile>(&path)?.value;
    let plan = StudyPlan::new(study, &folder(), &mut |_, _| Control::Continue)?;
    let temporary = tempfile::tempdir()?;
    let parts = plan.parts(None).map_err(anyhow::Error::msg)?;
    let threads = available();
    run(&plan, temporary.path(), &parts, threads, &mut |_| {
        Control::Continue
    })?;
    let result = merge(&plan, temporary.path())?;
    Ok((plan, result))
}

/// Position errors as tables, lasers by numbers of poses, with simulation beside theory.
///
/// # Errors
/// If writing fails, which it does not.
pub fn markdown(plan: &StudyPlan, result: &StudyResult) -> Result<String> {
    let mut text = String::new();
    for group in groups(plan, result) {
        let poses = group.poses();
        write!(text, "\n**{}**\n\n| laser | 1 sd mm |", group.title)?;
        for poses in &poses {
            write!(text, " {poses} poses | simulated / expected |")?;
        }
        writeln!(text, "\n|---|---|{}", "---|---|".repeat(poses.len()))?;
        for laser in group.lasers() {
            let cells = group.over_poses(laser);
            let sd = cells.first().and_then(|cell| cell.planned.laser_sd_m);
            let sd = sd.map_or_else(|| "-".to_owned(), |sd| format!("{:.2}", 1e3 * sd));
            write!(text, "| {laser} | {sd} |")?;
            for cell in cells {
                let expected = cell.planned.expected.position_m.context("an expectation")?;
                write!(text, " {:.3} | {} |", 1e3 * expected, ratio(cell))?;
            }
            writeln!(text)?;
        }
    }
    writeln!(text, "\n{}", check(plan, result))?;
    Ok(text)
}

/// Simulated over expected position error with its 95 % interval, and a star where they differ by more than 5 %.
fn ratio(cell: &CellResult) -> String {
    let found = cell.simulated.as_ref();
    let ratio = found.and_then(|found| Some((found.over_expected?, found.is_marked)));
    ratio.map_or_else(String::new, |([ratio, low, high], is_marked)| {
        let star = if is_marked { " *" } else { "" };
        format!("{ratio:.3} ({low:.3} to {high:.3}){star}")
    })
}

fn check(plan: &StudyPlan, result: &StudyResult) -> String {
    let found = || {
        result
            .cells
            .iter()
            .filter_map(|cell| cell.simulated.as_ref())
    };
    let ratios: Vec<[f64; 3]> = found().filter_map(|found| found.over_expected).collect();
    let ends = ratios.iter().map(|ratio| ratio[0]);
    format!(
        "{} cells, {} of them simulated with {} calibrations each, of which {} did not converge: simulated over expected {:.3} to {:.3}; {} of the 95 % intervals contain 1, and {} cells differ by more than 5 %.",
        result.cells.len(),
        ratios.len(),
        plan.study.simulation.calibrations,
        found().map(|found| found.not_converged).sum::<u64>(),
        ends.clone().fold(f64::INFINITY, f64::min),
        ends.fold(0.0, f64::max),
        ratios
            .iter()
            .filter(|ratio| ratio[1] <= 1.0 && ratio[2] >= 1.0)
            .count(),
        found().filter(|found| found.is_marked).count()
    )
}
