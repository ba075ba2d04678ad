use super::*;
use crate::phases::WinchPair;
use serde_json::{Value, json};

fn session() -> Session {
    let cable = |name: &str, x: f64| {
        json!({"name": name, "platform_anchor_m": [0, 0, 0],
            "pulley": {"entry_point_m": [x, 0, 1], "swivel_axis": [0, 0, 1], "radius_m": 0},
            "winch": {"drum_diameter_m": 0.1, "length_sd_m": 1e-3}})
    };
    let robot = json!({"format": "tautline-robot", "version": 1, "name": "two",
        "platform": {"free": ["x", "y"]}, "cables": [cable("a", -1.0), cable("b", 1.0)]});
    let robot = crate::parse_robot(robot.to_string().as_bytes(), "robot.json").expect("a robot");
    let now = Timestamp::from_unix_seconds(1_532_336_700);
    let mut session = Session::new("Monday", robot.value, now);
    let text = "pose,length_1_m,length_2_m,time_s,note\n3,1.1,0.30000000000000004,,x\n1,0.9,,7,y\n";
    session.measurements = crate::read_poses(text.as_bytes(), "poses.csv", &session.robot)
        .expect("a table")
        .value;
    session.phases.winch = vec![WinchPair {
        cable: 1,
        revolutions: 0.1,
        length_m: 0.2,
        tension_n: None,
    }];
    session.settings.identification.effects = vec![FreeEffect {
        effect: "winch_scale".into(),
        cable: Some("b".into()),
    }];
    session.record(LogEntry {
        time: Timestamp::from_unix_seconds(1_532_336_800),
        phase: Phase::Poses,
        text: "Imported poses.csv.".into(),
    });
    session.add_result(ResultRecord {
        time: Timestamp::from_unix_seconds(1_532_336_900),
        title: "First try".into(),
        document: json!({"format": "tautline-identification", "version": 9, "chi2": 0.1}),
    });
    session
}

fn saved() -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.json");
    write_session(&path, &session()).expect("written");
    let bytes = std::fs::read(&path).expect("a file");
    serde_json::from_slice(&bytes).expect("JSON")
}

fn error(change: impl FnOnce(&mut Value)) -> String {
    let mut document = saved();
    change(&mut document);
    let text = document.to_string();
    let error = parse_session(text.as_bytes(), "s.json").expect_err("a broken session");
    error.to_string()
}

#[test]
fn a_session_reads_back() {
    let text = saved().to_string();
    let loaded = parse_session(text.as_bytes(), "s.json").expect("a session");
    assert!(loaded.notices.is_empty(), "{:?}", loaded.notices);
    // NaN is not equal to itself, so the numbers are compared as they print.
    assert_eq!(format!("{:?}", loaded.value), format!("{:?}", session()));
    assert_eq!(
        loaded.value.results()[0].format(),
        Some("tautline-identification")
    );
    assert_eq!(loaded.value.modified.to_string(), "2018-07-23T09:08:20Z");
}

#[test]
fn a_session_without_measurements_reads_back() {
    let mut empty = session();
    empty.measurements = Measurements::default();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.json");
    write_session(&path, &empty).expect("written");
    assert_eq!(read_session(&path).expect("a session").value, empty);
}

#[test]
fn broken_sessions_are_refused_with_a_pointer() {
    let newer = error(|s| s["version"] = json!(2));
    assert!(
        newer.contains("version 2 of \"tautline-session\""),
        "{newer}"
    );
    let cell = error(|s| s["measurements"]["columns"]["length_2_m"][0] = json!("x"));
    assert!(
        cell.starts_with("s.json, /measurements/columns/length_2_m/0: found \"x\""),
        "{cell}"
    );
    let short = error(|s| s["measurements"]["columns"]["time_s"] = json!([1]));
    assert!(
        short.contains("/measurements/columns/time_s: found 1 values"),
        "{short}"
    );
    let far = error(|s| s["measurements"]["columns"]["length_1_m"][1] = json!(900));
    assert!(
        far.contains("/measurements/columns/length_1_m/1: found 900"),
        "{far}"
    );
    let robot = error(|s| s["robot"]["cables"][1]["winch"]["drum_diameter_m"] = json!(0));
    assert!(
        robot.contains("/robot/cables/1/winch/drum_diameter_m: found 0"),
        "{robot}"
    );
    let cable = error(|s| s["phases"]["winch"][0]["cable"] = json!(2));
    assert!(cable.contains("/phases/winch/0/cable"), "{cable}");
    let time = error(|s| s["log"][0]["time"] = json!("yesterday"));
    assert!(
        time.contains("/log/0/time: found \"yesterday\", expected a time"),
        "{time}"
    );
}

#[test]
fn a_session_that_cannot_be_read_is_not_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.json");
    std::fs::write(&path, "kept").expect("written");
    let mut broken = session();
    broken.measurements.time_s = vec![f64::INFINITY, 0.0];
    assert!(write_session(&path, &broken).is_err());
    assert_eq!(std::fs::read_to_string(&path).expect("a file"), "kept");
    let left: Vec<_> = std::fs::read_dir(folder.path())
        .expect("a folder")
        .collect();
    assert_eq!(left.len(), 1, "no temporary file stays");
}
