//! The tables of the other phases.

use tautline_core::geometry::Pose;
use tautline_core::robot::{PerAxis, Tracker};
use tautline_core::simulation::{
    Simulated, SimulationError, SimulationOptions, approaches, phase_tables, simulate,
};
use tautline_session::{
    CheckKind, CheckPose, CheckRow, ElongationPoint, ForcePair, HomeReading, PhaseData, WinchPair,
};

/// Number of poses of the check, and of approaches to each.
const TARGETS: usize = 5;
const CYCLES: usize = 10;
/// The external instrument of the check.
const TRACKER: Tracker = Tracker {
    position_sd_m: PerAxis::Same(5e-5),
    orientation_sd_rad: Some(1e-4),
};

/// Tables of the run's true robot. A robot with a home pose but no home platform gets one, whose readings are
/// among the tables.
pub fn tables(
    run: &mut Simulated,
    options: &SimulationOptions,
) -> Result<PhaseData, SimulationError> {
    let seed = options.seed.wrapping_add(1);
    let tables = phase_tables(&run.dataset.robot, &run.truth, seed, options.noise);
    let mut data = PhaseData {
        check: check(run, options)?,
        ..PhaseData::default()
    };
    for (cable, pair) in tables.winch {
        data.winch.push(WinchPair {
            cable,
            revolutions: pair.revolutions,
            length_m: pair.length_m,
            tension_n: pair.tension_n,
        });
    }
    for (cable, pair) in tables.force {
        data.force.push(ForcePair {
            cable,
            reading_n: pair.reading_n,
            load_n: pair.load_n,
        });
    }
    for point in tables.elongation {
        data.elongation.push(ElongationPoint {
            length_m: point.length_m,
            tension_n: point.tension_n,
            elongation_m: point.elongation_m,
        });
    }
    if let Some((platform, readings)) = tables.home {
        run.dataset.robot.home_platform = Some(platform);
        let readings = readings.into_iter();
        data.home = readings
            .map(|(sensor, reading)| HomeReading { sensor, reading })
            .collect();
    }
    Ok(data)
}

/// Some poses of the run, approached repeatedly and measured by an external instrument in all coordinates.
fn check(run: &Simulated, options: &SimulationOptions) -> Result<Vec<CheckRow>, SimulationError> {
    let measured = &run.dataset.measurements;
    let away = measured
        .commanded
        .iter()
        .zip(&measured.labels)
        .filter(|(_, label)| **label != 0);
    let targets: Vec<Pose> = away.filter_map(|(pose, _)| *pose).take(TARGETS).collect();
    let robot = &run.dataset.robot;
    let once = options.clone().commanding(targets.clone());
    let at_targets = simulate(robot, &once)?.dataset.measurements;
    let first = at_targets.len() - targets.len();
    let attained = &at_targets.truth.poses[first..];
    let seed = options.seed.wrapping_add(2);
    let measured = approaches(robot, (attained, CYCLES), &TRACKER, seed, options.noise);
    let pose = |pose: &Pose| CheckPose {
        position_m: pose.position.into(),
        orientation_wxyz: Some(pose.orientation_wxyz()),
    };
    let row = |(k, measured): (usize, &Pose)| {
        let target = k % targets.len();
        CheckRow {
            kind: CheckKind::Pose,
            target: format!("P{}", target + 1),
            cycle: (k / targets.len()) as i64 + 1,
            sample: 0,
            time_s: None,
            commanded: pose(&targets[target]),
            attained: pose(measured),
        }
    };
    Ok(measured.iter().enumerate().map(row).collect())
}
