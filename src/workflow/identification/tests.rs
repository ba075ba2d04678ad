//! Identification where the data do not determine everything.

use tautline_core::estimation::{Control, Method};
use tautline_core::geometry::Vec3;
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};

use super::{IdentificationRequest, identify};

/// Lengths tell where pulleys are from the home pose, not where both are: a robot that is homed in a wrong place is
/// identified as well as any, all its pulleys with the error of home.
#[test]
fn a_wrong_home_pose_moves_all_pulleys_with_it_and_does_not_show() {
    let preset = presets::find("mini").expect("a preset");
    let mut robot = preset.robot.clone();
    // The true home pose is drawn with 2 mm, and described with 0.1 mm.
    let described = robot.home.expect("a home pose");
    robot.home.as_mut().expect("a home pose").position_sd_m = 2e-3;
    robot.home.as_mut().expect("a home pose").orientation_sd_rad = 0.0;
    let nominal = robot.cables.iter().map(|cable| cable.pulley.entry_point_m);
    let options = SimulationOptions {
        geometry: TrueGeometry::EntryPoints(nominal.collect()),
        noise: false,
        ..SimulationOptions::new(30, 3)
    };
    let mut run = simulate(&robot, &options).expect("a run");
    let true_home = run.truth.home.expect("a home pose").pose();
    let error = described.pose().position - true_home.position;
    assert!(error.norm() > 1e-3, "a wrong home pose: {error}");
    run.dataset.robot.home = Some(described);
    let request = IdentificationRequest::new(run.dataset, Method::Joint, &[]).expect("a request");
    let found = identify(&request, &mut |_| Control::Continue).expect("identified");
    let p_value = found.solution.p_value().expect("it is redundant");
    assert!(p_value > 0.01, "nothing shows: {p_value}");
    let points = found.solution.globals.entry_points.iter();
    let off = points
        .zip(&run.truth.cables)
        .map(|(found, cable)| Vec3::from(*found) - Vec3::from(cable.pulley.entry_point_m));
    let mean = off.sum::<Vec3>() / 8.0;
    assert!(
        (mean - error).norm() < 0.2 * error.norm(),
        "pulleys by {mean}, home by {error}"
    );
}

#[test]
fn a_summary_says_the_same_without_the_list_of_readings() {
    let preset = presets::find("mini").expect("a preset");
    let mut run = simulate(&preset.robot, &SimulationOptions::new(40, 8)).expect("a run");
    // A reading that does not fit, so that there is a suspect.
    let laser = &mut run.dataset.measurements.laser_m;
    laser[7] += 0.02;
    let mut request =
        IdentificationRequest::new(run.dataset, Method::Joint, &[]).expect("a request");
    let whole = identify(&request, &mut |_| Control::Continue).expect("identified");
    request.lists_readings = false;
    let brief = identify(&request, &mut |_| Control::Continue).expect("identified");
    assert!(!whole.analysis.observations.is_empty() && brief.analysis.observations.is_empty());
    let mut documents = [whole.document(), brief.document()];
    documents[0].seconds = documents[1].seconds;
    assert!(!documents[0].suspect_readings.is_empty());
    assert_eq!(documents[0], documents[1]);
}
