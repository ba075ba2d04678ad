//! precalibrate: tables made from known values.

use serde_json::json;
use tautline_session::read_robot;
use tautline_validation::support::phase_tables::{
    elongation_table, force_table, home_platform, home_table, per_revolution, winch_table,
};

use super::program::{Folder, assert_number, assert_valid, number, tautline};

/// A dataset without poses.
fn dataset() -> Folder {
    let folder = Folder::new();
    let arguments = ["simulate", "--robot", "mini", "--poses", "1", "--out"];
    let made = folder.join("made");
    tautline(&[&arguments[..], &[&made]].concat()).succeeded();
    let mut robot = folder.json("made/robot.json");
    robot["home_platform"] = home_platform();
    folder.write("robot.json", &robot.to_string());
    folder.write("winch.csv", &winch_table(Some(3)));
    folder.write("force.csv", &force_table());
    folder.write("home.csv", &home_table());
    folder.write("elongation.csv", &elongation_table());
    folder
}

fn path(folder: &Folder) -> &str {
    folder.path().to_str().expect("UTF-8")
}

#[test]
fn known_values_are_found() {
    let folder = dataset();
    let answer = tautline(&["precalibrate", path(&folder), "--json", "-"]).succeeded();
    assert_eq!(answer.stderr, "");
    let result = answer.json();
    assert_valid(&result);
    assert_eq!(result["format"], "tautline-precalibration");
    let close = |pointer: &str, expected: f64| assert_number(&result, pointer, expected, 1e-9);
    for cable in 1..=8 {
        let winch = format!("/winches/{}", cable - 1);
        close(
            &format!("{winch}/cable_per_revolution_m"),
            per_revolution(cable),
        );
        close(&format!("{winch}/offset_m"), 0.5);
        let amplitude = if cable == 3 { 3e-4 } else { 2e-5 };
        close(&format!("{winch}/largest_residual_m"), amplitude);
        // Sum of squares 4 a^2 with two degrees of freedom; the revolutions' squares add to 20.
        let sd = amplitude * 2.0_f64.sqrt();
        close(&format!("{winch}/residual_sd_m"), sd);
        close(
            &format!("{winch}/cable_per_revolution_sd_m"),
            sd / 20.0_f64.sqrt(),
        );
        let passed = result["winches"][cable - 1]["passed"].as_bool();
        assert_eq!(passed, Some(cable != 3));
    }
    assert_eq!(result["force_sensors"].as_array().map(Vec::len), Some(2));
    close("/force_sensors/1/tension_gain", 2.02);
    close("/force_sensors/1/bias_n", 1.5);
    close("/force_sensors/1/largest_residual_n", 0.2 / 2.02);
    for (k, expected) in [0.001, 0.002, 0.003].into_iter().enumerate() {
        close(&format!("/home/position_m/{k}"), expected);
    }
    close("/home/orientation_wxyz/0", 1.0);
    // Deviations of 0.1 mm up and down.
    close("/home/position_repeatability_m/2", 2.0_f64.sqrt() * 1e-4);
    assert_eq!(result["elongation"]["surface"]["degree"], 2);
    assert!(number(&result, "/elongation/largest_residual_m") < 1.5e-5);
}

#[test]
fn the_verdicts_are_in_words() {
    let folder = dataset();
    let report = tautline(&["precalibrate", path(&folder)])
        .succeeded()
        .stdout;
    for part in [
        "7 of 8 winches within 0.1 mm",
        "2 of 2 force sensors within 1 N",
        "FAILED",
        "z mm",
        "degree 2 (chosen)",
    ] {
        assert!(report.contains(part), "{report}");
    }
}

#[test]
fn the_model_holds_the_fitted_values() {
    let folder = dataset();
    let model = folder.join("model.json");
    let answer = tautline(&[
        "precalibrate",
        path(&folder),
        "--model-out",
        &model,
        "--json",
        "-",
    ]);
    let result = answer.succeeded().json();
    assert_valid(&folder.json("model.json"));
    let before = read_robot(folder.path().join("robot.json").as_ref()).expect("a robot");
    let after = read_robot(model.as_ref()).expect("a robot").value;
    for (k, cable) in after.cables.iter().enumerate() {
        let fitted = number(&result, &format!("/winches/{k}/cable_per_revolution_m"));
        let told = cable.winch.cable_per_revolution_m();
        assert!((told - fitted).abs() < 1e-15, "{told} m, not {fitted} m");
        let nominal = &before.value.cables[k];
        assert_eq!(cable.winch.drum_pitch_m, nominal.winch.drum_pitch_m);
        assert_eq!(cable.winch.gear_ratio, nominal.winch.gear_ratio);
        assert_eq!(cable.pulley, nominal.pulley);
        let surface = cable.cable.elongation_surface.as_ref().expect("a surface");
        let told = serde_json::to_value(surface).expect("JSON");
        assert_eq!(told, result["elongation"]["surface"]);
    }
    let gain = |cable: usize| {
        after.cables[cable]
            .force_sensor
            .expect("a sensor")
            .tension_gain
    };
    assert_eq!(gain(1), number(&result, "/force_sensors/1/tension_gain"));
    assert_eq!(gain(2), 2.0);
    let home = after.home.expect("a home");
    assert_eq!(home.position_m[2], number(&result, "/home/position_m/2"));
    let sds = (0..3).map(|k| number(&result, &format!("/home/position_sd_m/{k}")));
    assert_eq!(home.position_sd_m, sds.fold(0.0, f64::max));
}

#[test]
fn calibration_tables_are_optional() {
    let folder = dataset();
    for name in ["winch.csv", "home.csv", "elongation.csv"] {
        std::fs::remove_file(folder.path().join(name)).expect("removed");
    }
    let answer = tautline(&["precalibrate", path(&folder), "--json", "-"]).succeeded();
    let result = answer.json();
    assert_valid(&result);
    assert_eq!(result["winches"], json!([]));
    assert!(result["home"].is_null() && result["elongation"].is_null());
    std::fs::remove_file(folder.path().join("force.csv")).expect("removed");
    let answer = tautline(&["precalibrate", path(&folder)]);
    answer.refused(&[path(&folder), "found none of winch.csv, force.csv"]);
}

#[test]
fn tables_that_cannot_be_fitted_are_named() {
    let winch = "cable,rev,length_m\n";
    for (file, text, parts) in [
        (
            "winch.csv",
            format!("{winch}3,0,0\n3,1,0.1\n"),
            ["cable-3", "2 pairs are too few"],
        ),
        (
            "winch.csv",
            format!("{winch}3,1,0\n3,1,0.1\n3,1,0.1\n"),
            ["cable-3", "same motor revolution"],
        ),
        (
            "winch.csv",
            format!("{winch}3,0,0\n3,1,-0.1\n3,2,-0.2\n"),
            ["cable-3", "of cable per revolution"],
        ),
        (
            "force.csv",
            "cable,reading_n,load_n\n2,1,5\n2,2,5\n2,3,5\n".to_owned(),
            ["cable-2", "the same load"],
        ),
        (
            "home.csv",
            "sensor,reading\n1,0.1\n".to_owned(),
            ["sensor 2", "no reading"],
        ),
        (
            "elongation.csv",
            "length_m,tension_n,elongation_m\n1,1,0\n".to_owned(),
            ["degree 1", "too few"],
        ),
    ] {
        let folder = dataset();
        let file = folder.write(file, &text);
        let answer = tautline(&["precalibrate", path(&folder), "--json", "-"]);
        answer.refused(&[&file]);
        answer.refused(&parts);
    }
}

#[test]
fn home_readings_need_a_home_platform() {
    let folder = dataset();
    std::fs::copy(folder.join("made/robot.json"), folder.join("robot.json")).expect("copied");
    let answer = tautline(&["precalibrate", path(&folder)]);
    answer.refused(&["home.csv", "robot.json has no home_platform"]);
}
