//! Poses that would separate two causes: where the models that fit these data differ most.

use super::fit::Fit;
use super::report::Separation;
use crate::estimation::{Control, Geometry, Linearisation, Options, Problem, solve};
use crate::geometry::Pose;
use crate::measurement::Dataset;
use crate::robot::Robot;
use crate::simulation::{SimulationOptions, TensionRange, TrueGeometry, Workspace, simulate};

/// Poses that are tried, and those that are proposed.
const TRIED: usize = 80;
const PROPOSED: usize = 5;
/// Seed of the poses tried.
const SEED: u64 = 41;
/// Difference of chi-square that decides.
const DECISIVE: f64 = 9.0;

/// The robot as a fit has it.
pub(super) fn robot_of(fit: &Fit<'_>) -> Robot {
    let globals = &fit.solution.globals;
    let mut robot = fit.problem.dataset.robot.clone();
    for (cable, entry) in robot.cables.iter_mut().zip(&globals.entry_points) {
        cable.pulley.entry_point_m = *entry;
    }
    if let Some(laser) = &mut robot.laser {
        laser.target_plane.offset_m = globals.plane_offset_m;
    }
    if let Some(home) = &mut robot.home {
        home.position_m = globals.home.position.into();
        home.orientation_wxyz = globals.home.orientation_wxyz();
    }
    robot.effects = globals
        .effects
        .iter()
        .map(|bound| bound.setting(&robot))
        .collect();
    robot
}

/// Poses at which the two fits predict different readings; `None` where the robot cannot be simulated.
pub(super) fn separation(one: &Fit<'_>, other: &Fit<'_>) -> Option<Separation> {
    let robot = robot_of(one);
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        noise: false,
        workspace: Workspace::around(one.solution.poses.iter().map(|(_, pose)| pose)),
        tension: tension_of(one),
        ..SimulationOptions::new(TRIED, SEED)
    };
    let mut run = simulate(&robot, &options).ok()?;
    let poses = std::mem::take(&mut run.dataset.measurements.truth.poses);
    let dataset = Dataset {
        robot: robot_of(other),
        measurements: run.dataset.measurements,
    };
    let mut differences = differences(&dataset)?;
    differences.sort_by(|a, b| b.1.total_cmp(&a.1));
    let best = &differences[..PROPOSED.min(differences.len())];
    let each = best.iter().map(|(_, d)| d).sum::<f64>() / best.len().max(1) as f64;
    let chosen: Vec<Pose> = best.iter().map(|(row, _)| poses[*row]).collect();
    Some(Separation {
        advice: advice(each),
        expected_delta_chi2: each * chosen.len() as f64,
        poses: chosen,
    })
}

/// The tensions at which the data were taken.
fn tension_of(fit: &Fit<'_>) -> Option<TensionRange> {
    let dataset = fit.problem.dataset;
    let mut all = Vec::new();
    for row in 0..dataset.measurements.len() {
        for (index, cable) in dataset.robot.cables.iter().enumerate() {
            let read = dataset.measurements.force_n.get(row, index);
            all.extend(cable.force_sensor.map(|sensor| sensor.tension_n(read)));
        }
    }
    all.retain(|tension| *tension > 0.0);
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    let largest = all.iter().copied().fold(0.0, f64::max);
    (!all.is_empty()).then(|| TensionRange {
        lower_n: all.iter().copied().fold(mean, f64::min) / 2.0,
        reference_n: mean,
        upper_n: 2.0 * largest,
    })
}

fn advice(each: f64) -> String {
    let needed = (DECISIVE / each.max(1e-12)).ceil();
    if needed <= 200.0 {
        format!(
            "Measure the platform at the poses listed, about {needed:.0} times in all: there these causes differ most."
        )
    } else {
        "No pose of this workspace tells these causes apart; a reading of another kind would."
            .to_owned()
    }
}

/// Chi-square of each pose with the geometry held: row of the measurements, value.
fn differences(dataset: &Dataset) -> Option<Vec<(usize, f64)>> {
    let mut problem = Problem::new(dataset).ok()?;
    problem.geometry = Geometry::Held;
    let quiet = &mut |_: &_| Control::Continue;
    let solution = solve(&problem, &Options::default(), quiet).ok()?;
    let linear = Linearisation::new(&problem, &solution);
    let of = |block: &crate::estimation::PoseBlock| {
        let residual = linear.residual.rows(block.rows.start, block.rows.len());
        (block.row, residual.norm_squared())
    };
    Some(linear.poses.iter().map(of).collect())
}
