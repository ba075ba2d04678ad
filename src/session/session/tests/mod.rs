use super::*;
use crate::phases::{CheckKind, CheckPose, CheckRow, PoseDistance, WinchPair};
use serde_json::{Value, json};
use tautline_core::effect::EffectSetting;

mod poses;
mod trail;

pub(crate) fn session() -> Session {
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
    session.settings.identification.effects = vec![EffectSetting {
        effect: "winch_scale".into(),
        targets: vec!["b".into()],
        parameters: [("scale".into(), 1e-3)].into(),
    }];
    session.record(LogEntry {
        time: Timestamp::from_unix_seconds(1_532_336_800),
        phase: Phase::Poses,
        text: "Imported poses.csv.".into(),
    });
    session.add_result(ResultRecord {
        time: Timestamp::from_unix_seconds(1_532_336_900),
        title: "First try".into(),
        document: ResultDocument::of(
            &json!({"format": "tautline-identification", "version": 9, "chi2": 0.1}),
        )
        .expect("JSON"),
        basis: Some("85944171f73967e8".into()),
    });
    session.exclude(3).expect("a measured pose");
    with_the_later_steps(session)
}

/// Adds a plan, the simulated robot of a demonstration, and the outcome of adjustments.
fn with_the_later_steps(mut session: Session) -> Session {
    session.plan = vec![PlannedPose {
        label: 4,
        position_m: [0.1, 0.2, 0.0],
        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
    }];
    let laser = r"serial:COM3:19200?pattern=^D(?<distance>\d+)$&no_return=E255&scale=0.1";
    session.laser_source = laser.parse().expect("settings");
    session.simulator = Some(Simulator {
        truth: session.robot.clone(),
        seed: u64::MAX,
        revealed: true,
    });
    session.controller = vec![NamedValue {
        name: "a.drum".into(),
        value: 0.1,
    }];
    session.add_adjustment(Adjustment {
        time: Timestamp::from_unix_seconds(1_532_336_850),
        operator: "B. Smith".into(),
        controller: "simulated".into(),
        changes: vec![ValueChange {
            name: "a.drum".into(),
            unit: "m".into(),
            before: 0.1,
            after: 0.101,
        }],
        outcome: Outcome::Failed("The controller did not answer.".into()),
        read_back: Vec::new(),
        restores: false,
    });
    let at_origin = CheckPose {
        position_m: [0.0; 3],
        orientation_wxyz: None,
    };
    session.add_verification(Verification {
        time: Timestamp::from_unix_seconds(1_532_336_860),
        title: "Circle".into(),
        stage: Stage::After,
        rows: vec![CheckRow {
            kind: CheckKind::Path,
            target: "circle".into(),
            cycle: 1,
            sample: 0,
            time_s: None,
            commanded: at_origin,
            attained: at_origin,
        }],
        accepted: None,
    });
    session.add_stopped_verification(StoppedVerification {
        time: Timestamp::from_unix_seconds(1_532_336_870),
        stage: Stage::After,
        rows: session.verifications()[0].rows.clone(),
        planned: 100,
        reason: "stopped by the operator".into(),
    });
    session.add_measuring_warnings([MeasuringWarning {
        pose: 1,
        text: "cable-1: it is slack: 0.1 N (at pose 1).".into(),
    }]);
    session.accept("Ada", Timestamp::from_unix_seconds(1_532_336_900));
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

/// Sessions of earlier versions could hold a pattern without a name as an effect of the model.
#[test]
fn a_model_with_an_unexplained_pattern_reads_without_it() {
    let mut document = saved();
    let effects = &mut document["settings"]["identification"]["effects"];
    let known = effects.clone();
    let pattern = json!({"effect": "unknown", "targets": ["b"], "parameters": {"reading": 0.0}});
    effects.as_array_mut().expect("effects").push(pattern);
    let loaded = parse_session(document.to_string().as_bytes(), "s.json").expect("a session");
    let read = json!(loaded.value.settings.identification.effects);
    assert_eq!(read, known);
}

#[test]
fn an_acceptance_ends_when_the_controller_gets_other_values() {
    let mut session = session();
    let is_accepted = |session: &Session| session.acceptance(&session.verifications[0]).is_some();
    assert!(is_accepted(&session), "nothing was written");
    let adjustment = |minutes: i64, after: f64, outcome: Outcome| Adjustment {
        time: Timestamp::from_unix_seconds(1_532_337_000 + 60 * minutes),
        operator: "Ada".into(),
        controller: "simulated".into(),
        changes: vec![ValueChange {
            name: "a.drum".into(),
            unit: "m".into(),
            before: 0.1,
            after,
        }],
        outcome,
        read_back: Vec::new(),
        restores: false,
    };
    let mut written = session.clone();
    written.add_adjustment(adjustment(0, 0.102, Outcome::Written));
    assert_eq!(written.controller_values()["a.drum"], 0.102);
    assert!(!is_accepted(&written));
    written.add_adjustment(adjustment(1, 0.102, Outcome::RolledBack));
    assert!(is_accepted(&written), "the accepted values again");
    written.add_adjustment(adjustment(2, 0.102, Outcome::Unsettled("lost".into())));
    assert!(!is_accepted(&written), "nobody knows");
    // Earlier versions did not store the values that were accepted.
    session.verifications[0]
        .accepted
        .as_mut()
        .expect("accepted")
        .values = None;
    session.add_adjustment(adjustment(0, 0.102, Outcome::Written));
    assert!(is_accepted(&session));
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
fn what_is_empty_is_not_written_and_older_files_read() {
    let session = session();
    let empty = Session::new("Monday", session.robot, session.created);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.json");
    write_session(&path, &empty).expect("written");
    let text = std::fs::read_to_string(&path).expect("a file");
    for key in [
        "excluded",
        "plan",
        "effects",
        "simulator",
        "controller",
        "adjustments",
        "verifications",
    ] {
        assert!(!text.contains(&format!("\"{key}\"")), "{key}");
    }
    assert_eq!(read_session(&path).expect("a session").value, empty);
}

#[test]
fn the_basis_changes_with_the_inputs_and_with_nothing_else() {
    let basis = session().basis();
    assert_eq!(
        basis, "194776c4327b378b",
        "the same in every version of the program"
    );
    let same = |change: fn(&mut Session)| {
        let mut changed = session();
        change(&mut changed);
        changed.basis() == basis
    };
    assert!(same(|s| s.name = "Tuesday".into()));
    assert!(same(|s| s.plan.clear()));
    assert!(same(|s| s.settings.diagnosis.alpha = 0.05));
    assert!(same(|s| s.settings.until.enabled = true));
    assert!(!same(|s| s.robot.cables[0].pulley.radius_m = 1e-3));
    assert!(!same(|s| s.measurements.length_m.set(1, 0, 0.91)));
    assert!(!same(|s| s.phases.distances.push(PoseDistance {
        poses: [1, 2],
        distance_m: 0.3,
        sd_m: 1e-3,
        point_m: [0.0; 3],
    })));
    assert!(!same(|s| assert!(s.include(3))));
    assert!(!same(|s| s.settings.identification.method = Method::Simple));
    assert!(!same(|s| s.settings.identification.effects.clear()));
    let read = parse_session(saved().to_string().as_bytes(), "s.json").expect("a session");
    assert_eq!(read.value.basis(), basis);
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
    let zero = error(|s| s["excluded"] = json!([0]));
    assert!(zero.contains("/excluded: found 0, the home pose"), "{zero}");
    let twice = error(|s| s["plan"] = json!([s["plan"][0], s["plan"][0]]));
    assert!(
        twice.contains("/plan/1/label: found 4 again, expected each label once"),
        "{twice}"
    );
    let effect = error(|s| s["settings"]["identification"]["effects"][0]["targets"] = json!(["c"]));
    assert!(
        effect.contains("/settings/identification/effects/0/targets/0: found \"c\", expected"),
        "{effect}"
    );
    let goal = error(|s| s["settings"]["until"] = json!({"goals": ["cause=95"]}));
    assert!(
        goal.contains("/settings/until/goals/0: found \"cause=95\", expected 50 to 98%"),
        "{goal}"
    );
    let none = error(|s| s["settings"]["until"] = json!({"at_most": 0}));
    assert!(
        none.contains("/settings/until/at_most: found 0, expected at least 1 pose"),
        "{none}"
    );
    let truth = error(|s| s["simulator"]["truth"]["name"] = json!(""));
    assert!(truth.contains("s.json, /simulator/truth/name"), "{truth}");
    let baud = error(|s| s["laser_source"]["port"]["serial"]["baud"] = json!(7));
    let at = "/laser_source/port/serial/baud: found 7, expected 50";
    assert!(baud.contains(at), "{baud}");
    let kind = error(|s| s["laser_source"]["kind"] = json!("radar"));
    assert!(kind.contains("/laser_source"), "{kind}");
    let key = error(|s| s["laser_source"]["units"] = json!("m"));
    assert!(
        key.contains("/laser_source") && key.contains("expected one of \"port\""),
        "{key}"
    );
    let outcome = error(|s| s["adjustments"][0]["outcome"] = json!("lost"));
    assert!(outcome.contains("/adjustments/0/outcome"), "{outcome}");
    let attained = "/verifications/0/rows/0/attained/orientation_wxyz";
    let turned = error(|s| {
        s["verifications"][0]["rows"][0]["attained"]["orientation_wxyz"] = json!([2, 0, 0, 0]);
    });
    assert!(turned.contains(attained), "{turned}");
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
    let mut infinite = session();
    infinite.measurements.time_s = vec![f64::INFINITY, 0.0];
    let mut unknown = session();
    let mut change = unknown.adjustments()[0].clone();
    change.changes[0].after = f64::NAN;
    unknown.add_adjustment(change);
    let mut without_length = session();
    without_length.phases.winch[0].length_m = f64::NAN;
    let mut unclear = session();
    if let LaserSettings::Line(line) = &mut unclear.laser_source {
        line.pattern = Some("[0-9]+".into());
    }
    for (broken, pointer) in [
        (infinite, "/measurements/columns/time_s"),
        (unknown, "/adjustments/1/changes/0/after"),
        (without_length, "/phases/winch/0/length_m"),
        (unclear, "/laser_source/pattern"),
    ] {
        let error = write_session(&path, &broken).expect_err("cannot be read again");
        assert!(error.to_string().contains(pointer), "{error}");
    }
    assert_eq!(std::fs::read_to_string(&path).expect("a file"), "kept");
    let left: Vec<_> = std::fs::read_dir(folder.path())
        .expect("a folder")
        .collect();
    assert_eq!(left.len(), 1, "no temporary file stays");
}

#[test]
fn only_an_open_adjustment_is_concluded() {
    let mut session = session();
    let now = session.modified;
    assert!(!session.conclude_adjustment(Outcome::Written, None, now));
    let begun = Adjustment {
        outcome: Outcome::Begun,
        ..session.adjustments()[0].clone()
    };
    session.add_adjustment(begun);
    let document = serde_json::to_value(SessionFile::of(&session)).expect("JSON");
    assert_eq!(document["adjustments"][1]["outcome"], "begun");
    let unsettled = Outcome::Unsettled("The line broke.".into());
    assert!(session.conclude_adjustment(unsettled.clone(), None, now));
    assert_eq!(session.adjustments()[1].outcome, unsettled);
    assert!(session.conclude_adjustment(Outcome::Written, None, now));
    assert_eq!(session.adjustments()[1].outcome, Outcome::Written);
    assert!(matches!(
        session.adjustments()[0].outcome,
        Outcome::Failed(_)
    ));
}

#[test]
fn what_is_no_number_at_the_controller_reads_back() {
    let mut session = session();
    session.controller[0].value = f64::INFINITY;
    let mut odd = session.adjustments()[0].clone();
    odd.changes[0].before = f64::NAN;
    session.add_adjustment(odd);
    let document = serde_json::to_value(SessionFile::of(&session)).expect("JSON");
    assert_eq!(document["controller"][0]["value"], Value::Null);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.json");
    write_session(&path, &session).expect("written");
    let read = read_session(&path).expect("a session").value;
    assert!(read.controller[0].value.is_nan());
    assert!(read.adjustments()[1].changes[0].before.is_nan());
    assert_eq!(read.adjustments()[1].changes[0].after, 0.101);
}
