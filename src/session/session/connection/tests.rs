use serde_json::{Value, json};

use super::super::tests::session;
use super::*;
use crate::session::{parse_session, write_session};

fn mapping() -> Value {
    json!({"readings": {
            "revolutions": {"symbol": "Winch[{n}].turns", "scale": -0.5},
            "force": {"symbol": ["A.force", "B.force"], "offset": 3.0},
            "pose": {"symbol": "Ref", "rotation": "roll_pitch_yaw", "length_scale": 1e-3}},
        "state": {"moving": "Busy"},
        "command": {"target": {"symbol": "Target"}, "kind": "K", "number": "N", "acknowledged": "A"},
        "parameters": [{"name": "{cable}.pulley.radius_m", "symbol": "{cable}.radius"}]})
}

fn document(ads: &Value) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.json");
    write_session(&path, &session()).expect("written");
    let bytes = std::fs::read(&path).expect("a file");
    let mut document: Value = serde_json::from_slice(&bytes).expect("JSON");
    assert!(document.get("connection").is_none(), "nothing is set");
    document["connection"] = json!({ "ads": ads });
    document
}

fn error(pointer: &str, value: Value) -> String {
    let mut ads = mapping();
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
    ads.pointer_mut(parent).expect("a place")[key] = value;
    let text = document(&ads).to_string();
    let error = parse_session(text.as_bytes(), "s.json").expect_err("a broken mapping");
    error.to_string()
}

#[test]
fn a_mapping_reads_back() {
    let text = document(&mapping()).to_string();
    let loaded = parse_session(text.as_bytes(), "s.json").expect("a session");
    assert!(loaded.notices.is_empty(), "{:?}", loaded.notices);
    let ads = loaded.value.connection.ads.clone().expect("a mapping");
    assert_eq!(ads.readings.revolutions.scale, -0.5);
    assert_eq!(ads.parameters[0].stride, 1);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.json");
    write_session(&path, &loaded.value).expect("written");
    let again = crate::read_session(&path).expect("read").value;
    assert_eq!(again.connection.ads, Some(ads));
}

#[test]
fn the_default_passes_its_check() {
    use tautline_core::robot::presets::{NAMES, find};
    for preset in NAMES.into_iter().filter_map(find) {
        let mapping = SymbolMapping::default_for(&preset.robot);
        mapping.check(&preset.robot).expect("a good mapping");
        assert_eq!(
            mapping.readings.laser.is_some(),
            preset.robot.laser.is_some()
        );
        let text = serde_json::to_string(&mapping).expect("JSON");
        assert_eq!(
            serde_json::from_str::<SymbolMapping>(&text).expect("read"),
            mapping
        );
    }
}

#[test]
fn a_name_per_cable_has_its_number_and_name() {
    assert_eq!(
        name_of_cable("W{n}.{cable}.x", "left {n}", 2),
        "W3.left {n}.x"
    );
    assert!(is_per_cable("a[{n}]") && !is_per_cable("a[1]"));
}

#[test]
fn faults_of_a_mapping_are_told_with_their_place() {
    let cases = [
        (
            "/readings/revolutions/scale",
            json!(0),
            "/connection/ads/readings/revolutions/scale",
        ),
        ("/readings/revolutions/symbol", json!("W{m}"), "{n} its"),
        ("/readings/force/symbol", json!(["A"]), "expected 2"),
        ("/readings/force/symbol", json!(3), "or a list of names"),
        ("/readings/pose/symbol", json!(["A"]), "expected 6"),
        (
            "/readings/pose/rotation",
            json!("euler"),
            "/connection/ads/readings/pose/rotation",
        ),
        (
            "/readings/laser",
            json!({"symbol": "two words"}),
            "/readings/laser/symbol",
        ),
        ("/state", json!({}), "has to report when it moves"),
        ("/release", json!(""), "/connection/ads/release"),
        ("/parameters/0/name", json!("home.x_m"), "one per cable"),
        ("/parameters/0/stride", json!(0), "/parameters/0/stride"),
    ];
    for (pointer, value, expected) in cases {
        let told = error(pointer, value);
        assert!(told.contains(expected), "{pointer}: {told}");
    }
}

#[test]
fn a_parameter_is_named_once() {
    let again =
        json!([{"name": "{cable}.x", "symbol": "{cable}.x"}, {"name": "b.x", "symbol": "s"}]);
    let told = error("/parameters", again);
    assert!(
        told.contains("/parameters/1/name") && told.contains("again"),
        "{told}"
    );
}

#[test]
fn where_a_controller_is_found_reads_back_and_is_checked() {
    let mut document = document(&mapping());
    document["connection"]["controller"] = json!("ads");
    let parse = |document: &Value| parse_session(document.to_string().as_bytes(), "s.json");
    let error = |document: &Value| parse(document).expect_err("no place").to_string();
    let told = error(&document);
    assert!(told.contains("/connection/place"), "{told}");
    document["connection"]["place"] = json!({"host": "plc", "net_id": [5, 23, 9, 1, 1, 1]});
    let read = parse(&document).expect("a session").value.connection;
    let place = read.place.expect("a place");
    assert_eq!((read.controller, place.port), (ControllerKind::Ads, 48898));
    assert_eq!((place.ams_port, place.timeout_s), (851, 1.0));
    for (key, value) in [
        ("host", json!("a b")),
        ("host", json!("user:secret@plc")),
        ("port", json!(0)),
        ("ams_port", json!(0)),
        ("timeout_s", json!(0)),
    ] {
        let mut wrong = document.clone();
        wrong["connection"]["place"][key] = value;
        let told = error(&wrong);
        assert!(told.contains(&format!("/connection/place/{key}")), "{told}");
        assert!(!told.contains("secret"), "{told}");
    }
    document["connection"]["controller"] = json!("recording");
    assert!(error(&document).contains("/connection/recording"));
    for (folder, speed) in [("", 1.0), ("runs/one", 0.0), ("runs/one", 1e9)] {
        document["connection"]["recording"] = json!({"folder": folder, "speed": speed});
        assert!(error(&document).contains("/connection/recording/"));
    }
    document["connection"]["recording"] = json!({"folder": "runs/one"});
    let read = parse(&document).expect("a session").value.connection;
    assert_eq!(read.recording.map(|place| place.speed), Some(1.0));
}
