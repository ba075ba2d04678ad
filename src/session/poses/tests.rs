use super::*;
use tautline_core::geometry::Pose;
use tautline_core::measurement::Grid;

const ROBOT: &str = r#"{"format": "tautline-robot", "version": 1, "name": "two",
 "home": {"position_m": [0,0,0], "orientation_wxyz": [1,0,0,0], "position_sd_m": 0, "orientation_sd_rad": 0},
 "platform": {"free": ["x","y","rz"]},
 "cables": [
  {"name": "left", "pulley": {"entry_point_m": [-1,0,1], "swivel_axis": [0,0,1], "radius_m": 0},
   "platform_anchor_m": [0,0,0], "winch": {"drum_diameter_m": 0.1, "length_sd_m": 1e-3}},
  {"name": "right", "pulley": {"entry_point_m": [1,0,1], "swivel_axis": [0,0,1], "radius_m": 0},
   "platform_anchor_m": [0,0,0], "winch": {"drum_diameter_m": 0.1, "length_sd_m": 1e-3}}]}"#;

fn robot() -> Robot {
    crate::parse_robot(ROBOT.as_bytes(), "robot.json")
        .expect("a robot")
        .value
}

fn read(text: &str) -> Loaded<Measurements> {
    read_poses(text.as_bytes(), "poses.csv", &robot()).expect("a table")
}

/// Every column in use, with holes and with values that are hard to round-trip.
fn full() -> Measurements {
    let hard = [0.1 + 0.2, f64::MIN_POSITIVE, 1.0 / 3.0, -0.0];
    let mut grid = Grid::new(2);
    let mut readings = Grid::new(2);
    for k in 0..4 {
        grid.push_row(&[hard[k], f64::NAN]);
        readings.push_row(&[hard[k] + 7.0, 1e3 * hard[k]]);
    }
    let quaternion = [-0.3, 0.2, 0.9, 0.1_f64];
    let poses: Vec<Pose> = hard
        .iter()
        .map(|h| Pose::from_parts([*h, 0.5, -0.25], [quaternion[0] + h, 0.2, 0.9, 0.1]))
        .collect();
    let mut m = Measurements {
        labels: vec![0, 7, -3, i64::MAX],
        time_s: hard.to_vec(),
        temperature_c: vec![20.5, f64::NAN, 21.0, 22.0],
        groups: ["a", "a", "", "b, free"].map(String::from).to_vec(),
        commanded: vec![Some(poses[0]), None, Some(poses[1]), Some(poses[2])],
        revolutions: grid,
        force_n: readings.clone(),
        laser_m: vec![0.4, f64::NAN, 0.5, 1.0 / 7.0],
        swivel_rad: readings,
        inclination_rad: vec![[0.1, f64::NAN, hard[0]]; 4],
        tracked_position_m: vec![[hard[0], f64::NAN, 0.0]; 4],
        tracked_orientation_wxyz: vec![[1.0, 0.0, 0.0, 0.0]; 4],
        tracked_position_sd_m: vec![[1e-3, 2e-3, f64::NAN]; 4],
        ..Measurements::default()
    };
    m.swivel_rad = Grid::missing(4, 2);
    m.truth.poses = poses;
    m.truth.tension_n = m.force_n.clone();
    m.other = vec![("note, free".into(), vec!["a \"b\"".into(); 4])];
    m
}

#[test]
fn writing_and_reading_gives_every_bit_back() {
    let mut bytes = Vec::new();
    write_poses(&mut bytes, &full()).expect("written");
    let read = read_poses(bytes.as_slice(), "poses.csv", &robot()).expect("a table");
    let mut again = Vec::new();
    write_poses(&mut again, &read.value).expect("written");
    assert_eq!(String::from_utf8(again), String::from_utf8(bytes));
    // NaN is not equal to itself, so the numbers are compared as they print.
    assert_eq!(format!("{:?}", read.value), format!("{:?}", full()));
}

#[test]
fn german_excel_reads_like_any_other() {
    let english =
        "pose,rev_1,rev_2,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,,,,,,,\n1,1.5,-2.25,0.1,0,0,1,0,0,0\n";
    let german = english.replace(',', ";").replace('.', ",");
    let german = format!("\u{feff}{}", german.replace('\n', "\r\n"));
    assert_eq!(read(&german), read(english));
    assert_eq!(read(english).value.revolutions.row(1), [1.5, -2.25]);
    assert_eq!(read(english).value.commanded[0], None);
}

#[test]
fn columns_come_in_any_order_and_unknown_ones_are_kept() {
    let text = "rev_2,note,pose,rev_1\n0,start,0,0\n4,,1,3\n";
    let loaded = read(text);
    assert_eq!(loaded.value.revolutions.row(1), [3.0, 4.0]);
    assert_eq!(loaded.value.other[0].1, ["start", ""]);
    assert_eq!(
        loaded.notices,
        ["poses.csv, column \"note\": unknown, kept"]
    );
}

#[test]
fn group_labels_are_read_without_a_notice() {
    let loaded = read("pose,group,rev_1,rev_2\n0,,0,0\n1,7,1,1\n2, 7 ,1,2\n");
    assert_eq!(loaded.value.groups, ["", "7", "7"]);
    assert_eq!(loaded.notices, Vec::<String>::new());
    assert_eq!(
        read("pose,rev_1,rev_2\n0,0,0\n").value.groups,
        Vec::<String>::new()
    );
}

#[test]
fn readings_without_an_instrument_are_noticed() {
    let loaded = read("pose,rev_1,rev_2,laser_m\n0,0.5,0,0.3\n");
    assert_eq!(loaded.notices.len(), 1, "{:?}", loaded.notices);
    assert!(loaded.notices[0].contains("laser"));
}

/// Spreadsheets and people write `Rev_1` and `X_M`.
#[test]
fn names_of_columns_are_known_in_any_case() {
    let plain = read("pose,rev_1,rev_2,x_m,y_m,z_m,qw,qx,qy,qz,note\n0,0,0,0,0,0,1,0,0,0,a\n");
    let other = read("Pose,Rev_1,REV_2,X_m,Y_M,z_m,qW,qX,qY,qZ,note\n0,0,0,0,0,0,1,0,0,0,a\n");
    assert_eq!(other.value, plain.value);
    assert_eq!(other.notices, plain.notices);
    let twice = read_poses(
        "pose,rev_1,REV_1\n0,0,0\n".as_bytes(),
        "poses.csv",
        &robot(),
    );
    let twice = twice.expect_err("the same column").to_string();
    assert!(
        twice.contains("found in the header row again, expected once"),
        "{twice}"
    );
}
