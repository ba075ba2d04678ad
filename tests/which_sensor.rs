//! The tables of docs/WHICH-SENSOR.md: the studies of docs/studies, planned, run, merged. And how fast studies run.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result};
use tautline_core::estimation::Control;
use tautline_core::planning::random_poses;
use tautline_core::robot::presets;
use tautline_session::read_versioned_toml;
use tautline_study::calibration::Simulator;
use tautline_study::cell::{Cell, options};
use tautline_study::chunk::Part;
use tautline_study::report::{groups, sentences};
use tautline_study::run::{Shared, run};
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
    let of = plan.chunks();
    let parts: Vec<Part> = (1..=of).map(|number| Part { number, of }).collect();
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    run(&plan, temporary.path(), &parts, threads, &Shared::default())?;
    let result = merge(&plan, temporary.path())?;
    Ok((plan, result))
}

/// Position errors as tables, lasers by numbers of poses, and the answers in sentences.
///
/// # Errors
/// If writing fails, which it does not.
pub fn markdown(plan: &StudyPlan, result: &StudyResult) -> Result<String> {
    let mut text = String::new();
    for group in groups(plan, result) {
        let poses = group.poses();
        write!(text, "\n**{}**\n\n| laser | 1 sd mm |", group.title)?;
        poses
            .iter()
            .try_for_each(|poses| write!(text, " {poses} poses |"))?;
        writeln!(text, "\n|---|---|{}", "---|".repeat(poses.len()))?;
        for laser in group.lasers() {
            let cells = group.over_poses(laser);
            let sd = cells.first().and_then(|cell| cell.planned.laser_sd_m);
            let sd = sd.map_or_else(|| "-".to_owned(), |sd| format!("{:.2}", 1e3 * sd));
            write!(text, "| {laser} | {sd} |")?;
            for cell in cells {
                let expected = cell.planned.expected.position_m.context("an expectation")?;
                write!(text, " {:.3}", 1e3 * expected)?;
                if let Some(found) = &cell.simulated {
                    let rms_m = found.position.map_or(f64::NAN, |position| position.rms_m);
                    write!(
                        text,
                        " ({:.3}{})",
                        1e3 * rms_m,
                        if found.is_marked { "*" } else { "" }
                    )?;
                }
                write!(text, " |")?;
            }
            writeln!(text)?;
        }
    }
    writeln!(text)?;
    for sentence in sentences(plan, result) {
        writeln!(text, "- {sentence}")?;
    }
    let ratios: Vec<[f64; 3]> = result
        .cells
        .iter()
        .filter_map(|cell| cell.simulated.as_ref()?.over_expected)
        .collect();
    let ends = ratios.iter().map(|ratio| ratio[0]);
    writeln!(
        text,
        "\n{} cells, {} of them simulated with {} calibrations each: simulated over expected {:.3} to {:.3}; {} of the 95 % intervals contain 1.",
        result.cells.len(),
        ratios.len(),
        plan.study.simulation.calibrations,
        ends.clone().fold(f64::INFINITY, f64::min),
        ends.fold(0.0, f64::max),
        ratios
            .iter()
            .filter(|ratio| ratio[1] <= 1.0 && ratio[2] >= 1.0)
            .count()
    )?;
    Ok(text)
}

/// Calibrations per second on one core, and the share of their time that the solver alone takes.
#[derive(Debug, Clone, Copy)]
pub struct Speed {
    /// Calibrations per second.
    pub per_second: f64,
    /// Time of the solver over that of the whole.
    pub solver_share: f64,
}

/// Measures with MINI at 25 poses, best of five rounds: other programs disturb a round, none makes it faster.
///
/// # Errors
/// If MINI cannot be simulated.
pub fn speed(calibrations: u64) -> Result<Speed> {
    let study: StudyFile = read_versioned_toml(&folder().join("mini.toml"))?.value;
    let robot = presets::find("mini").context("no MINI")?.robot;
    let poses = random_poses(&robot, &options(25, 1, 1.0))?;
    let method = tautline_core::estimation::Method::Joint;
    let cell = Cell::new(robot, poses, method)?;
    let simulator = Simulator::new(&study, &cell, method)?;
    let (mut whole, mut solver) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..5 {
        let begin = Instant::now();
        for index in 0..calibrations {
            std::hint::black_box(simulator.calibrate(index, index));
        }
        whole = whole.min(begin.elapsed().as_secs_f64());
        let mut seconds = 0.0;
        for index in 0..calibrations {
            let run = simulator.run(index)?;
            let begin = Instant::now();
            simulator.solve(&run)?;
            seconds += begin.elapsed().as_secs_f64();
        }
        solver = solver.min(seconds);
    }
    Ok(Speed {
        per_second: calibrations as f64 / whole,
        solver_share: solver / whole,
    })
}
