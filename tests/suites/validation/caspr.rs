//! Robots of CASPR. The files belong to that project and are expected in a folder next to the repository.

use std::path::{Path, PathBuf};

use tautline_core::estimation::{Control, Options, Problem, rank_defects, solve};
use tautline_core::geometry::Pose;
use tautline_core::planning::{PlanOptions, plan};
use tautline_core::robot::Robot;
use tautline_core::simulation::{SimulationOptions, TensionRange, Workspace, simulate};
use tautline_import::read_robot_description;

/// Name, number of cables, free coordinates.
const ROBOTS: [(&str, usize, usize); 8] = [
    ("CAROCA", 8, 6),
    ("CoGiRo", 8, 6),
    ("Example_point_XZ", 3, 2),
    ("Example_spatial", 7, 6),
    ("IPAnema_1", 8, 6),
    ("KNTU_planar", 4, 3),
    ("MACARM", 8, 6),
    ("NIST_RoboCrane", 6, 6),
];

/// The models of CASPR (github.com/darwinlau/CASPR, BSD 3-Clause).
fn folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/caspr");
    if folder.exists() {
        return Some(folder);
    }
    println!("ABSENT: the models of CASPR are not beside this repository; nothing was imported");
    None
}

fn robot(folder: &Path, name: &str) -> Robot {
    let files = ["cables", "bodies"].map(|part| folder.join(format!("{name}_{part}.xml")));
    let read = read_robot_description(&files);
    read.unwrap_or_else(|error| panic!("{error}")).value
}

#[test]
fn every_model_is_imported_with_home_workspace_and_tensions() {
    let Some(folder) = folder() else {
        return;
    };
    for (name, cables, free) in ROBOTS {
        let robot = robot(&folder, name);
        assert_eq!(
            (robot.cable_count(), robot.platform.free.len()),
            (cables, free),
            "{name}"
        );
        let home = robot.home.expect(name).pose();
        let limits = robot.limits.expect(name);
        assert!(
            limits.workspace.is_some() && limits.tension.is_some(),
            "{name}"
        );
        assert!(Workspace::of(&robot).contains(&home), "{name}");
        // The home pose of a suspended robot is below its pulleys, and its cables hold it there.
        let held = TensionRange::of(&robot).tensions(&robot, &home);
        assert!(held.expect(name).is_some(), "{name}");
    }
}

/// Root mean square distance of entry points from the true ones (m), in the coordinates that are not known.
fn error_m(truth: &Robot, points: impl Iterator<Item = [f64; 3]>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (cable, point) in truth.cables.iter().zip(points) {
        let sd = cable.pulley.entry_point_sd_m.each();
        for k in (0..3).filter(|k| sd[*k] != Some(0.0)) {
            sum += (point[k] - cable.pulley.entry_point_m[k]).powi(2);
            count += 1.0;
        }
    }
    f64::sqrt(sum / count)
}

#[test]
fn imported_robots_are_planned_inside_their_workspace_simulated_and_identified() {
    let Some(folder) = folder() else {
        return;
    };
    for (name, ..) in ROBOTS {
        let robot = robot(&folder, name);
        let options = PlanOptions {
            candidates: 300,
            ..PlanOptions::new(30, 1)
        };
        let plan = plan(&robot, &options, &mut |_| Control::Continue);
        let plan = plan.unwrap_or_else(|error| panic!("{name}: {error}"));
        let workspace = Workspace::of(&robot);
        let is_inside = |pose: &Pose| workspace.contains(pose);
        assert!(
            plan.poses.iter().all(|planned| is_inside(&planned.pose)),
            "{name}"
        );
        let options = SimulationOptions::new(40, 2);
        let run = simulate(&robot, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
        let problem = Problem::new(&run.dataset).unwrap_or_else(|error| panic!("{name}: {error}"));
        let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue);
        let solution = solution.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(solution.converged(), "{name}: {:?}", solution.termination);
        assert_eq!(rank_defects(&problem, &solution), [], "{name}");
        let drawn = robot.cables.iter().map(|cable| cable.pulley.entry_point_m);
        let before = error_m(&run.truth, drawn);
        let found = solution.globals.entry_points.iter();
        let after = error_m(&run.truth, found.copied());
        println!(
            "{name}: entry points {:.1} mm off, {:.1} mm after identification",
            1e3 * before,
            1e3 * after
        );
        assert!(after < before, "{name}: {before} m, {after} m");
    }
}
