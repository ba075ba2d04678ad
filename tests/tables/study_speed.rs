//! How fast studies run, beside the solver alone, how much memory they take, and how fast *Which sensor?* answers.

use std::fmt::Write as _;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use anyhow::Result;
use tautline_core::estimation::Control;
use tautline_core::geometry::Vec3;
use tautline_core::robot::Robot;
use tautline_session::parse_versioned_toml;
use tautline_study::calibration::Simulator;
use tautline_study::run::run;
use tautline_study::which_sensor::Advisor;
use tautline_study::{StudyFile, StudyPlan, merge};

use super::markdown::Table;
use super::simulated::preset;
use crate::support::process::{self, PEAK, memory_mib};

/// Runs that the solver alone is given, again and again.
const RUNS: u64 = 500;
/// Questions of which the fastest answer counts: other programs disturb one, none makes it faster.
const QUESTIONS: usize = 9;

/// MINI at 25 poses, so many calibrations in chunks of 10,000.
fn plan(calibrations: u64) -> Result<StudyPlan> {
    let text = format!(
        "format = \"tautline-study\"\nversion = 1\nname = \"speed\"\n[design]\nrobots = [\"mini\"]\n\
         choice = [\"random\"]\n[simulation]\ncalibrations = {calibrations}\nshare = 1.0\nchunk = 10000\n"
    );
    let study = parse_versioned_toml::<StudyFile>(text.as_bytes(), "speed")?.value;
    let plan = StudyPlan::new(study, Path::new("."), &mut |_, _| Control::Continue)?;
    Ok(plan)
}

/// A table: studies of a hundredth, a tenth and all of these calibrations, run and merged in one process.
///
/// # Errors
/// If MINI cannot be simulated or this is not Linux.
pub fn table(calibrations: u64) -> Result<String> {
    let threads = tautline_core::threads::available();
    let mut table = Table::new(
        "calibrations | time s | processor time s | per second and core | largest memory so far MB",
    );
    let mut each = f64::NAN;
    for part in [100, 10, 1] {
        let plan = plan((calibrations / part).max(1))?;
        let folder = tempfile::tempdir()?;
        let parts = plan.parts(None).map_err(anyhow::Error::msg)?;
        let (began, before) = (Instant::now(), processor_s()?);
        run(&plan, folder.path(), &parts, threads, &mut |_| {
            Control::Continue
        })?;
        merge(&plan, folder.path())?;
        let (wall, busy) = (began.elapsed().as_secs_f64(), processor_s()? - before);
        each = busy / plan.calibrations() as f64;
        table.row(format_args!(
            "{} | {wall:.1} | {busy:.1} | {:.0} | {:.0}",
            plan.calibrations(),
            1.0 / each,
            1.048_576 * memory_mib(std::process::id(), PEAK)?
        ));
    }
    let mut text = table.text();
    let solver = solver_s(&plan(1)?, (calibrations / RUNS / 10).max(1))?;
    writeln!(
        text,
        "\nThe solver alone, from data in memory to the result in memory: {:.0} per second and core; {:.0} % of the processor time of a study are the solver's.",
        1.0 / solver,
        100.0 * solver / each
    )?;
    for (name, robot) in [
        ("MINI", mini()?),
        ("a robot with 64 cables", of_64_cables(mini()?)),
    ] {
        writeln!(
            text,
            "\n*Which sensor?* answers in {:.0} ms for {name}.",
            1e3 * answer_s(&robot)?
        )?;
    }
    Ok(text)
}

/// Processor time of the solver for one calibration (s).
fn solver_s(plan: &StudyPlan, rounds: u64) -> Result<f64> {
    let cell = plan.cell(0)?;
    let method = plan.cells[0].combination.method.of_solver();
    let simulator = Simulator::new(&plan.study, &cell, method)?;
    let runs: Result<Vec<_>, _> = (0..RUNS).map(|index| simulator.run(index)).collect();
    let runs = runs?;
    let before = processor_s()?;
    for _ in 0..rounds {
        for run in &runs {
            black_box(simulator.solve(black_box(run))?);
        }
    }
    Ok((processor_s()? - before) / (rounds * RUNS) as f64)
}

/// Time of an answer (s), as the window asks for it when a slider moves.
fn answer_s(robot: &Robot) -> Result<f64> {
    let advisor = Advisor::new(robot).map_err(anyhow::Error::msg)?;
    let question = advisor.question();
    let mut least = f64::INFINITY;
    for _ in 0..QUESTIONS {
        let began = Instant::now();
        black_box(advisor.answer(&question)).map_err(anyhow::Error::msg)?;
        least = least.min(began.elapsed().as_secs_f64());
    }
    Ok(least)
}

fn mini() -> Result<Robot> {
    Ok(preset("mini")?.robot)
}

/// Every cable eight times, with entry points and anchors a little apart.
fn of_64_cables(mut robot: Robot) -> Robot {
    let eight = std::mem::take(&mut robot.cables);
    for number in 0..8 * eight.len() {
        let mut cable = eight[number % eight.len()].clone();
        cable.name = format!("cable-{}", number + 1);
        let turn = number as f64;
        let apart = 0.01 * Vec3::new(turn.sin(), (2.0 * turn).sin(), (3.0 * turn).cos());
        for axis in 0..3 {
            cable.pulley.entry_point_m[axis] += apart[axis];
            cable.platform_anchor_m[axis] += 0.2 * apart[axis];
        }
        robot.cables.push(cable);
    }
    robot
}

/// Processor time of this process (s), with that of threads that have ended.
fn processor_s() -> Result<f64> {
    process::processor_s(std::process::id())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_with_64_cables_is_answered_like_any_other() {
        let robot = of_64_cables(mini().expect("there"));
        assert_eq!(robot.cable_count(), 64);
        let advisor = Advisor::new(&robot).expect("poses");
        let answer = advisor.answer(&advisor.question()).expect("an answer");
        let mini = Advisor::new(&mini().expect("there")).expect("poses");
        let of_mini = mini.answer(&mini.question()).expect("an answer");
        // Eight times as many cables average their errors.
        assert!(answer.position_m.expect("known") < of_mini.position_m.expect("known"));
    }
}
