//! The published JSON Schemas accept the documents that the readers accept, and refuse those of another structure.

use jsonschema::Validator;
use serde_json::{Value, json};
use tautline_session::{
    parse_robot, parse_session, read_robot, schemas, write_robot, write_session,
};
use tautline_validation::support::bad_input_cases::GOOD_ROBOT;

const PLANAR: &str = include_str!("../fuzz/seeds/robot_json/planar.json");
const FULL: &str = include_str!("../fuzz/seeds/robot_json/full.json");
const SESSION: &str = include_str!("../fuzz/seeds/session_file/small.json");

fn validator(format: &str) -> Validator {
    let file_name = format!("{format}-1.schema.json");
    let schemas = schemas();
    let schema = schemas.iter().find(|s| s.file_name == file_name);
    let schema = &schema.expect("published").schema;
    jsonschema::validator_for(schema).expect("a schema")
}

fn parsed(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

/// The smallest robot: one cable, nothing that is optional.
fn minimal() -> Value {
    json!({"format": "tautline-robot", "version": 1, "name": "one", "platform": {"free": ["x"]},
        "cables": [{"name": "c", "platform_anchor_m": [0, 0, 0],
            "pulley": {"entry_point_m": [1, 0, 0], "swivel_axis": [0, 0, 1], "radius_m": 0},
            "winch": {"drum_diameter_m": 0.1, "length_sd_m": 0.001}}]})
}

#[test]
fn robots_satisfy_schema_and_reader() {
    let validator = validator("tautline-robot");
    for robot in [minimal(), parsed(PLANAR), parsed(FULL), parsed(GOOD_ROBOT)] {
        let errors: Vec<_> = validator
            .iter_errors(&robot)
            .map(|e| e.to_string())
            .collect();
        assert!(errors.is_empty(), "{errors:?}");
        let loaded = parse_robot(robot.to_string().as_bytes(), "robot.json").expect("a robot");
        assert!(loaded.notices.is_empty(), "{:?}", loaded.notices);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("robot.json");
        write_robot(&path, &loaded.value).expect("written");
        assert_eq!(read_robot(&path).expect("a robot"), loaded);
        let written = parsed(&std::fs::read_to_string(&path).expect("a file"));
        assert!(validator.is_valid(&written), "{written}");
    }
}

#[test]
fn null_is_as_good_as_absent() {
    let mut robot = minimal();
    for key in ["home", "laser", "inclinometer", "tracker", "home_platform"] {
        robot[key] = Value::Null;
    }
    robot["platform"]["mass_kg"] = Value::Null;
    robot["cables"][0]["force_sensor"] = Value::Null;
    robot["cables"][0]["pulley"]["entry_point_sd_m"] = Value::Null;
    assert!(validator("tautline-robot").is_valid(&robot));
    let text = robot.to_string();
    parse_robot(text.as_bytes(), "robot.json").expect("a robot");
}

#[test]
fn one_coordinate_of_three_may_be_unknown() {
    let mut robot = minimal();
    let sd = json!([null, 0.0, 0.01]);
    robot["cables"][0]["pulley"]["entry_point_sd_m"] = sd.clone();
    assert!(validator("tautline-robot").is_valid(&robot));
    let loaded = parse_robot(robot.to_string().as_bytes(), "robot.json").expect("a robot");
    let read = loaded.value.cables[0].pulley.entry_point_sd_m.each();
    assert_eq!(read, [None, Some(0.0), Some(0.01)]);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("robot.json");
    write_robot(&path, &loaded.value).expect("written");
    let written = parsed(&std::fs::read_to_string(&path).expect("a file"));
    assert_eq!(written["cables"][0]["pulley"]["entry_point_sd_m"], sd);
    assert!(validator("tautline-robot").is_valid(&written));
}

#[test]
fn unknown_keys_of_a_robot_are_refused_with_the_nearest() {
    let refused = |key: &str, place: &str| {
        let mut robot = minimal();
        robot.pointer_mut(place).expect("an object")[key] = json!(0.05);
        let refused = parse_robot(robot.to_string().as_bytes(), "r.json");
        refused.expect_err("an unknown key").to_string()
    };
    assert_eq!(
        refused("radius", "/cables/0/pulley"),
        "r.json, /cables/0/pulley/radius: unknown key, did you mean \"radius_m\"?"
    );
    assert_eq!(
        refused("maker", ""),
        "r.json, /maker: unknown key, expected one of the format (tautline schemas --out DIR writes it)"
    );
    assert_eq!(
        refused("radius_m", ""),
        "r.json, /radius_m: unknown here, expected elsewhere in this file"
    );
    let mut robot = minimal();
    robot["$schema"] = json!("tautline-robot-1.schema.json");
    assert!(validator("tautline-robot").is_valid(&robot));
    let loaded = parse_robot(robot.to_string().as_bytes(), "r.json").expect("a robot");
    assert_eq!(loaded.notices, [""; 0]);
}

#[test]
fn broken_robots_violate_schema_and_reader() {
    let validator = validator("tautline-robot");
    for (pointer, value) in [
        ("/format", json!("tautline-session")),
        ("/version", json!(2)),
        ("/version", json!("1")),
        ("/name", json!(7)),
        ("/cables", json!([])),
        ("/cables", json!({})),
        ("/platform/free", json!(["q"])),
        ("/cables/0/pulley/entry_point_m", json!([1, 2])),
        ("/cables/0/pulley/radius_m", json!("0")),
        ("/cables/0/pulley/radius_m", Value::Null),
        ("/cables/0/winch", json!([])),
    ] {
        let mut robot = minimal();
        *robot.pointer_mut(pointer).expect("there") = value;
        assert!(!validator.is_valid(&robot), "schema accepts {robot}");
        let text = robot.to_string();
        assert!(
            parse_robot(text.as_bytes(), "r").is_err(),
            "reader accepts {text}"
        );
    }
    for key in ["format", "version", "name", "platform", "cables"] {
        let mut robot = minimal();
        robot.as_object_mut().expect("an object").remove(key);
        assert!(
            !validator.is_valid(&robot),
            "schema accepts a robot without {key}"
        );
        let text = robot.to_string();
        assert!(
            parse_robot(text.as_bytes(), "r").is_err(),
            "reader needs no {key}"
        );
    }
}

#[test]
fn sessions_satisfy_schema_and_reader() {
    let validator = validator("tautline-session");
    let session = parsed(SESSION);
    let errors: Vec<_> = validator
        .iter_errors(&session)
        .map(|e| e.to_string())
        .collect();
    assert!(errors.is_empty(), "{errors:?}");
    let loaded = parse_session(SESSION.as_bytes(), "small.json").expect("a session");
    assert!(loaded.notices.is_empty(), "{:?}", loaded.notices);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.json");
    write_session(&path, &loaded.value).expect("written");
    let written = parsed(&std::fs::read_to_string(&path).expect("a file"));
    assert!(validator.is_valid(&written), "{written}");
    for (pointer, value) in [
        ("/format", json!("tautline-robot")),
        ("/created", json!("yesterday")),
        ("/robot/cables", json!([])),
        ("/measurements/columns/rev_1/0", json!("x")),
        ("/settings/identification/method", json!("guess")),
        ("/log/0/phase", json!("lunch")),
        ("/excluded/0", json!("1")),
        ("/plan/0/position_m", json!([0, 0])),
        (
            "/settings/identification/effects/0/targets",
            json!("cable-1"),
        ),
        ("/simulator/seed", json!(-1)),
        ("/simulator/truth/cables", json!([])),
        ("/controller/0/value", json!("x")),
        ("/adjustments/0/outcome", json!("maybe")),
        ("/adjustments/1/outcome/failed", json!(7)),
        ("/verifications/0/stage", json!("during")),
        ("/results/0/basis", json!(7)),
    ] {
        let mut broken = session.clone();
        *broken.pointer_mut(pointer).expect("there") = value;
        assert!(!validator.is_valid(&broken), "schema accepts {pointer}");
        let text = broken.to_string();
        assert!(
            parse_session(text.as_bytes(), "s").is_err(),
            "reader accepts {pointer}"
        );
    }
}
