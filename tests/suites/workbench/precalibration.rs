//! The panel of phase 1.

use egui::Role;

use tautline_validation::support::phase_tables::{
    force_table, home_platform, home_table, per_revolution, winch_table,
};

use crate::tables::Bench;

fn robot_has(bench: &Bench, cable: usize) -> f64 {
    bench.session().robot.cables[cable - 1]
        .winch
        .cable_per_revolution_m()
}

#[test]
fn winches_are_imported_assessed_applied_and_undone() {
    let mut bench = Bench::new();
    assert!(
        bench.shows("Each winch needs at least three pairs"),
        "it says what will be here"
    );
    let before = robot_has(&bench, 1);
    let path = bench.write("winch.csv", &winch_table(None));
    bench.import("winch.csv", &path);
    assert!(bench.shows("Imported 32 rows from winch.csv."));
    assert!(bench.shows("All 8 winches measured are within 0.1 mm."));
    assert!(
        bench.shows("cable-3, 4, 0.028, 0.020, passed"),
        "spread, largest, verdict"
    );
    bench.press("Apply values");
    for cable in 1..=8 {
        assert!((robot_has(&bench, cable) - per_revolution(cable)).abs() < 1e-12);
    }
    assert!(bench.shows("These values are applied."));
    assert_eq!(bench.next_undo(), Some("apply measured winches"));
    bench.undo();
    assert!((robot_has(&bench, 1) - before).abs() < 1e-15);
    bench.undo();
    assert!(bench.session().phases.winch.is_empty());
}

#[test]
fn a_winch_that_fails_is_named_with_its_size() {
    let mut bench = Bench::new();
    let path = bench.write("winch.csv", &winch_table(Some(3)));
    bench.import("winch.csv", &path);
    assert!(bench.shows("cable-3: largest residual 0.300 mm, more than 0.1 mm."));
    assert!(bench.shows("cable-3, 4, 0.424, 0.300, failed"));
    assert!(bench.shows("cable-4, 4, 0.028, 0.020, passed"));
    assert!(
        bench.shows("Pairs of cable-3"),
        "the one that failed is open"
    );
}

#[test]
fn a_wrong_table_names_file_line_and_column() {
    let mut bench = Bench::new();
    let path = bench.write("winch.csv", "cable,rev,length_m\ncable-1,abc,0.1\n");
    bench.import("winch.csv", &path);
    let said = bench.said().to_owned();
    assert!(
        said.contains("winch.csv, line 2, column \"rev\": found \"abc\""),
        "{said}"
    );
    assert!(bench.shows(&said), "the status bar says it");
    assert!(bench.session().phases.winch.is_empty());
    assert_eq!(bench.next_undo(), None);
}

#[test]
fn pairs_can_be_typed_changed_and_removed() {
    let mut bench = Bench::new();
    let rows = "0 500\n1\t625,5\n2; 751,0; 20\n";
    bench.type_into(Role::MultilineTextInput, "Pairs to add", rows);
    bench.press("Add pairs");
    let pairs = &bench.session().phases.winch;
    assert_eq!(pairs.len(), 3);
    assert!((pairs[1].length_m - 0.6255).abs() < 1e-12 && pairs[1].cable == 0);
    assert_eq!(pairs[2].tension_n, Some(20.0));
    assert_eq!(bench.next_undo(), Some("add 3 pairs"));
    assert!(bench.shows("cable-1, 3, "), "fitted at once");

    bench.type_into(Role::TextInput, "Length of pair 2", "625.7");
    bench.harness.key_press(egui::Key::Enter);
    bench.harness.run_ok();
    let changed = bench.session().phases.winch[1].length_m;
    assert!((changed - 0.6257).abs() < 1e-12, "{changed}");
    assert_eq!(bench.next_undo(), Some("change pair 2"));
    bench.undo();
    bench.press("Remove pair 3");
    assert_eq!(bench.session().phases.winch.len(), 2);
    bench.undo();
    bench.undo();
    assert!(bench.session().phases.winch.is_empty());
}

#[test]
fn wrong_typing_says_what_is_expected() {
    let mut bench = Bench::new();
    bench.type_into(Role::MultilineTextInput, "Pairs to add", "1 125\n2 much\n");
    bench.press("Add pairs");
    let said = bench.said().to_owned();
    assert!(
        said.contains("line 2: length: found \"much\", expected a number"),
        "{said}"
    );
    assert!(bench.session().phases.winch.is_empty());
}

#[test]
fn force_sensors_are_assessed_and_applied() {
    let mut bench = Bench::new();
    bench.open("Force sensors");
    let path = bench.write("force.csv", &force_table());
    bench.import("force.csv", &path);
    assert!(bench.shows("All 2 force sensors measured are within 1 N."));
    assert!(bench.shows("2 of 2 sensors within 1 N, not applied yet"));
    bench.press("Apply values");
    let sensor = bench.session().robot.cables[1]
        .force_sensor
        .expect("sensor");
    assert!((sensor.tension_gain - 2.02).abs() < 1e-12);
    assert!((sensor.bias_n - 1.5).abs() < 1e-10);
    bench.undo();
    let sensor = bench.session().robot.cables[1]
        .force_sensor
        .expect("sensor");
    assert!((sensor.bias_n - 1.5).abs() > 1.0);
}

#[test]
fn the_home_pose_is_measured_and_applied() {
    let mut bench = Bench::with_robot(|robot| robot["home_platform"] = home_platform());
    bench.open("Home platform");
    assert!(bench.shows("Picture of the six sensors"));
    let path = bench.write("home.csv", &home_table());
    bench.import("home.csv", &path);
    assert!(bench.shows("The six distances determine the platform position to"));
    // z at 3 mm, 0.1 mm above and below: a standard deviation of 0.141 mm.
    assert!(
        bench.shows("z (mm), 0.000, 3.000, 0.082, 0.141"),
        "with repeatability"
    );
    bench.press("Apply pose");
    let home = bench.session().robot.home.expect("home");
    for (found, expected) in home.position_m.iter().zip([1e-3, 2e-3, 3e-3]) {
        assert!((found - expected).abs() < 1e-9, "{found}");
    }
    assert!(
        bench.shows("These values are applied."),
        "it stays used although the fit starts there"
    );
}

#[test]
fn a_robot_without_home_platform_gets_advice() {
    let mut bench = Bench::new();
    bench.open("Home platform");
    assert!(bench.shows("has no home platform"));
    assert!(bench.shows("Add home_platform"));
}

#[test]
fn the_home_pose_is_typed_several_times_and_its_mean_applied() {
    let mut bench = Bench::new();
    bench.open("Home platform");
    for x_mm in ["0.1", "0.3"] {
        for (field, text) in [("Home x", x_mm), ("Home y", "0"), ("Home z", "-0,2")] {
            bench.type_into(Role::TextInput, field, text);
        }
        bench.press("Add measurement");
    }
    let poses = &bench.session().phases.home_poses;
    assert_eq!(poses.len(), 2);
    assert!((poses[1].position_m[2] + 2e-4).abs() < 1e-12);
    assert_eq!(poses[0].position_sd_m, 1e-4, "as the robot says");
    assert!(bench.shows("2 measurements of the home pose: position to 0.071 mm."));
    bench.press("Apply pose");
    let home = bench.session().robot.home.expect("home");
    assert!((home.position_m[0] - 2e-4).abs() < 1e-9);
    assert!((home.position_sd_m - 1e-4 / 2.0_f64.sqrt()).abs() < 1e-9);
    assert!(home.covariance.is_some());
    assert!(bench.shows("These values are applied."));
    bench.press("Remove the last measurement");
    assert_eq!(bench.session().phases.home_poses.len(), 1);
    assert_eq!(bench.next_undo(), Some("remove home measurement 2"));
}
