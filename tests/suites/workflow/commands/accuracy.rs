//! accuracy: figures computed by hand.

use super::program::{Folder, assert_number, assert_valid, tautline};

const HEADER: &str = "kind,target,cycle,sample,cmd_x_m,cmd_y_m,cmd_z_m,cmd_qw,cmd_qx,cmd_qy,cmd_qz,\
    x_m,y_m,z_m,qw,qx,qy,qz\n";

/// Pose P1: 0, 0, 0 and 4 mm off along x, and 0, 0, 0 and 0.04 rad about z. The barycentre is 1 mm off,
/// the distances from it 1, 1, 1 and 3 mm have the mean 1.5 mm and the standard deviation 1 mm; the angles
/// have the mean 0.01 rad and the standard deviation 0.02 rad.
/// Pose P2: 2 mm and 4 mm off along y, so 3 mm and 1 mm + 3 x 0.
/// Path A: at point 0 it is 1 and 3 mm off, so 2 mm and 1 mm; at point 1 it is 5 mm off twice.
fn table() -> String {
    let (sin, cos) = 0.02_f64.sin_cos();
    let pose = "0.1,0.2,0.3,1,0,0,0";
    format!(
        "{HEADER}\
        pose,P1,1,0,{pose},0.1,0.2,0.3,1,0,0,0\n\
        pose,P1,2,0,{pose},0.1,0.2,0.3,1,0,0,0\n\
        pose,P2,1,0,0,0,0,1,0,0,0,0,0.002,0,1,0,0,0\n\
        pose,P1,3,0,{pose},0.1,0.2,0.3,1,0,0,0\n\
        pose,P1,4,0,{pose},0.104,0.2,0.3,{cos},0,0,{sin}\n\
        pose,P2,2,0,0,0,0,1,0,0,0,0,0.004,0,1,0,0,0\n\
        path,A,1,0,0,0,0,,,,,0,0.001,0,,,,\n\
        path,A,1,1,1,0,0,,,,,1,0,-0.005,,,,\n\
        path,A,2,0,0,0,0,,,,,0,0.003,0,,,,\n\
        path,A,2,1,1,0,0,,,,,1,0,-0.005,,,,\n"
    )
}

#[test]
fn figures_are_those_computed_by_hand() {
    let folder = Folder::new();
    let check = folder.write("check.csv", &table());
    let answer = tautline(&["accuracy", &check, "--json", "-"]).succeeded();
    assert_eq!(answer.stderr, "");
    let result = answer.json();
    assert_valid(&result);
    assert_eq!(result["format"], "tautline-accuracy");
    assert_eq!(result["version"], 1);
    let close = |pointer: &str, expected: f64| assert_number(&result, pointer, expected, 1e-12);
    assert_eq!(result["poses"]["targets"][0]["target"], "P1");
    assert_eq!(result["poses"]["targets"][0]["cycles"], 4);
    close("/poses/targets/0/figures/accuracy_m", 0.001);
    close("/poses/targets/0/figures/deviation_m/0", 0.001);
    close("/poses/targets/0/figures/repeatability_m", 0.0045);
    close("/poses/targets/0/figures/angle_accuracy_rad/2", 0.01);
    close("/poses/targets/0/figures/angle_repeatability_rad/2", 0.06);
    close("/poses/targets/1/figures/accuracy_m", 0.003);
    close("/poses/targets/1/figures/repeatability_m", 0.001);
    close("/poses/largest_accuracy_m", 0.003);
    close("/poses/mean_accuracy_m", 0.002);
    close("/poses/largest_repeatability_m", 0.0045);
    close("/poses/mean_repeatability_m", 0.00275);
    close("/poses/largest_angle_accuracy_rad/2", 0.01);
    assert_eq!(result["paths"][0]["target"], "A");
    close("/paths/0/accuracy_m", 0.005);
    close("/paths/0/repeatability_m", 0.001);
    close("/paths/0/points/0/figures/accuracy_m", 0.002);
    close("/paths/0/points/1/figures/repeatability_m", 0.0);
    assert!(result["paths"][0]["angle_accuracy_rad"].is_null());
}

#[test]
fn the_report_is_in_millimetres_and_degrees() {
    let folder = Folder::new();
    let check = folder.write("check.csv", &table());
    let json = folder.join("out.json");
    let report = tautline(&["accuracy", &check, "--json", &json])
        .succeeded()
        .stdout;
    assert_valid(&folder.json("out.json"));
    let line = |start: &str| {
        let line = report.lines().find(|line| line.trim().starts_with(start));
        line.unwrap_or_else(|| panic!("no {start} in {report}"))
    };
    // 0.01 rad = 0.573 degrees, 0.06 rad = 3.438 degrees.
    for part in ["1.000", "4.500", "0.573 ±3.438"] {
        assert!(line("P1").contains(part), "{report}");
    }
    assert!(line("A ").contains("5.000") && line("A ").contains("1.000"));
    assert!(report.contains("pose accuracy AP: largest 3.000 mm, mean 2.000 mm"));
    assert!(report.contains("2 poses with fewer than the 30 cycles of ISO 9283"));
}

#[test]
fn rows_without_orientation_cost_the_orientation_figures_only() {
    let folder = Folder::new();
    let table = table().replacen(",0.1,0.2,0.3,1,0,0,0\n", ",0.1,0.2,0.3,,,,\n", 1);
    let check = folder.write("check.csv", &table);
    let answer = tautline(&["accuracy", &check, "--json", "-"]).succeeded();
    assert!(answer.stderr.contains("pose \"P1\" has rows without"));
    let result = answer.json();
    assert_valid(&result);
    let figures = |k: usize| &result["poses"]["targets"][k]["figures"];
    assert!(figures(0)["angle_accuracy_rad"].is_null());
    assert!(figures(1)["angle_accuracy_rad"].is_array());
    assert!(result["poses"]["largest_angle_accuracy_rad"].is_null());
}

#[test]
fn incomplete_check_tables_are_refused() {
    let folder = Folder::new();
    for (change, parts) in [
        (
            ["pose,P1,3,0,0.1,", "pose,P1,3,0,0.1001,"],
            vec!["pose \"P1\"", "the commanded pose of cycle 3"],
        ),
        (
            ["pose,P2,2,0", "pose,P3,2,0"],
            vec!["pose \"P2\"", "found only cycle 1, expected at least 2"],
        ),
        (
            ["pose,P2,2,0", "pose,P2,2,5"],
            vec!["pose \"P2\"", "samples 0 and 5, expected one"],
        ),
        (
            ["path,A,2,1", "path,A,3,1"],
            vec!["path \"A\"", "sample 1: found no row of cycle 2"],
        ),
        (
            ["path,A,2,1", "path,A,1,0"],
            vec!["column \"cycle\"", "each cycle of a target once"],
        ),
        (["kind,", "sort,"], vec!["line 1", "column \"kind\""]),
    ] {
        let text = table();
        assert!(text.contains(change[0]));
        let text = text.replacen(change[0], change[1], 1);
        let check = folder.write("check.csv", &text);
        let answer = tautline(&["accuracy", &check]);
        answer.refused(&parts);
        answer.refused(&[&check]);
    }
    let missing = folder.join("none.csv");
    tautline(&["accuracy", &missing]).refused(&["none.csv: not found"]);
}
