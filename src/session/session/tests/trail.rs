use super::*;
use tautline_core::measurement::Measurements;

fn time(minute: i64) -> Timestamp {
    Timestamp::from_unix_seconds(1_532_340_000 + 60 * minute)
}

fn by(operator: &str) -> TrailAuthor<'_> {
    TrailAuthor {
        operator,
        program: "Tautline 0.1.0",
    }
}

fn log(session: &mut Session, minute: i64, text: &str) {
    session.record(LogEntry {
        time: time(minute),
        phase: Phase::Poses,
        text: text.to_owned(),
    });
}

fn row(session: &Session, text: &str) -> Measurements {
    let read = crate::read_poses(text.as_bytes(), "poses.csv", &session.robot);
    read.expect("a table").value
}

/// A session without a trail of its own so far.
fn fresh() -> Session {
    let robot = session().robot;
    Session::new("Tuesday", robot, time(0))
}

/// Two saved entries: a run with two poses, and an adjustment.
fn sealed() -> Session {
    let mut session = fresh();
    log(&mut session, 0, "Created.");
    for pose in [
        "pose,length_1_m,length_2_m\n1,1.1,0.30000000000000004\n",
        // The second pose has a column that the first one lacks.
        "pose,length_1_m,length_2_m,laser_m\n2,0.9,0.1,\n",
    ] {
        let readings = row(&session, pose);
        session.append_pose(&readings.into()).expect("a pose");
    }
    session.seal(&by("Ada"), time(1));
    session.add_adjustment(Adjustment {
        time: time(2),
        operator: "Ada".into(),
        controller: "PLC".into(),
        changes: vec![ValueChange {
            name: "a.pulley.radius_m".into(),
            unit: "m".into(),
            before: f64::NAN,
            after: 0.01,
        }],
        outcome: Outcome::Begun,
        read_back: Vec::new(),
        restores: false,
    });
    session.seal(&by("Ada"), time(2));
    let held = [("a.pulley.radius_m", 0.01), ("b.pulley.radius_m", 0.02)];
    let held = held.map(|(name, value)| NamedValue {
        name: name.into(),
        value,
    });
    assert!(session.conclude_adjustment(Outcome::Written, Some(&held), time(3)));
    log(&mut session, 3, "Written.");
    session.seal(&by("Ben"), time(3));
    session
}

fn json_of(session: &Session) -> Value {
    serde_json::to_value(SessionFile::of(session)).expect("JSON")
}

fn read(mut json: Value) -> Session {
    json["format"] = json!("tautline-session");
    json["version"] = json!(1);
    let read = parse_session(json.to_string().as_bytes(), "s.json");
    read.unwrap_or_else(|error| panic!("{error}")).value
}

#[test]
fn what_is_saved_is_a_chain_that_stays_intact() {
    let session = sealed();
    assert_eq!(session.audit(), []);
    let read = read(json_of(&session));
    assert_eq!(read.audit(), []);
    assert_eq!(json_of(&read), json_of(&session));
    let entries = read.trail().entries();
    let parts = |entry: &TrailEntry| -> Vec<TrailPart> {
        entry.records.iter().map(|record| record.part).collect()
    };
    assert_eq!(entries.len(), 3);
    let measured = [TrailPart::Log(0), TrailPart::Pose(1), TrailPart::Pose(2)];
    let state = [TrailPart::Robot, TrailPart::Tables, TrailPart::Imported];
    assert_eq!(parts(&entries[0]), [measured, state].concat());
    assert_eq!(parts(&entries[1]), [TrailPart::Adjustment(0)]);
    assert_eq!(
        parts(&entries[2]),
        [TrailPart::Adjustment(0), TrailPart::Log(1)]
    );
    assert_eq!(entries[2].operator, "Ben");
    assert_eq!(read.trail().last_hash(), Some(entries[2].hash.as_str()));
    assert!(entries.iter().all(|entry| !entry.found));
    // The values are confirmed by the values read back.
    let confirmed = &read.adjustments()[0].read_back;
    assert_eq!(confirmed.len(), 1);
    assert_eq!(confirmed[0].value, 0.01);
}

#[test]
fn saving_what_is_not_new_adds_nothing() {
    let mut session = sealed();
    assert!(session.is_sealed());
    session.seal(&by("Cyd"), time(9));
    assert_eq!(json_of(&session), json_of(&sealed()));
    log(&mut session, 10, "Renamed.");
    assert!(!session.is_sealed());
}

#[test]
fn a_changed_reading_operator_or_log_is_said() {
    use TrailFault::{Changed, Hash, Missing, Uncovered};
    type Change = fn(&mut Value);
    let cases: [(&str, Change, Vec<TrailFault>); 9] = [
        (
            "a reading",
            |json| json["measurements"]["columns"]["length_2_m"][0] = json!(0.3),
            vec![Changed(TrailPart::Pose(1), 0)],
        ),
        (
            "a reading that was not there",
            |json| json["measurements"]["columns"]["laser_m"] = json!([null, 0.5]),
            vec![Changed(TrailPart::Pose(2), 0)],
        ),
        (
            "the label of a pose",
            |json| json["measurements"]["pose"][1] = json!(7),
            vec![
                Missing(TrailPart::Pose(2), 0),
                Changed(TrailPart::Imported, 0),
            ],
        ),
        (
            "the operator of an adjustment",
            |json| json["adjustments"][0]["operator"] = json!("Eve"),
            vec![Changed(TrailPart::Adjustment(0), 2)],
        ),
        (
            "the reading that confirms it",
            |json| json["adjustments"][0]["read_back"][0]["value"] = json!(0.02),
            vec![Changed(TrailPart::Adjustment(0), 2)],
        ),
        (
            "a step of the log",
            |json| json["log"][1]["text"] = json!("Nothing."),
            vec![Changed(TrailPart::Log(1), 2)],
        ),
        (
            "a step more",
            |json| {
                let step = json["log"][0].clone();
                json["log"].as_array_mut().expect("a list").push(step);
            },
            vec![Uncovered(TrailPart::Log(2))],
        ),
        (
            "the operator of an entry",
            |json| json["trail"]["entries"][1]["operator"] = json!("Eve"),
            vec![Hash(1)],
        ),
        (
            "an entry less",
            |json| {
                json["trail"]["entries"]
                    .as_array_mut()
                    .expect("a list")
                    .remove(1);
            },
            vec![Hash(1)],
        ),
    ];
    for (what, change, expected) in cases {
        let mut json = json_of(&sealed());
        change(&mut json);
        let mut changed = read(json);
        assert_eq!(changed.audit(), expected, "{what}");
        // Saving again does not repair the trail.
        log(&mut changed, 20, "Opened.");
        changed.seal(&by("Eve"), time(20));
        assert_eq!(changed.audit(), expected, "{what}, saved");
        assert_eq!(read(json_of(&changed)).audit(), expected, "{what}, read");
    }
}

#[test]
fn the_last_entry_cannot_be_cut_off_without_its_steps() {
    let mut json = json_of(&sealed());
    json["trail"]["entries"]
        .as_array_mut()
        .expect("a list")
        .pop();
    let parts = [TrailPart::Adjustment(0), TrailPart::Log(1)];
    let expected = [
        TrailFault::Changed(parts[0], 1),
        TrailFault::Uncovered(parts[1]),
    ];
    assert_eq!(read(json).audit(), expected);
}

#[test]
fn a_session_of_an_earlier_version_opens_and_its_trail_begins_with_what_it_has() {
    let mut json = json_of(&session());
    json.as_object_mut().expect("a session").remove("trail");
    let mut old = read(json);
    assert!(old.trail().is_empty());
    let steps = old.log().len();
    log(&mut old, 1, "Opened by a later version.");
    old.seal(&by("Ada"), time(1));
    assert_eq!(old.audit(), []);
    let [found, new] = old.trail().entries() else {
        panic!("{:?}", old.trail());
    };
    assert!(found.found && !new.found);
    let records = &found.records;
    assert!(records.len() > steps, "adjustments and runs, too");
    assert_eq!(new.records[0].part, TrailPart::Log(steps));
    assert_eq!(new.records.len(), 4, "and robot, tables and poses");
    // The poses may have been imported, and may be imported again.
    assert_eq!(old.imported_poses(), old.measurements.labels);
}

#[test]
fn a_changed_robot_table_result_or_import_is_said() {
    use TrailFault::{Changed, Missing, Uncovered};
    type Change = fn(&mut Value);
    let mut saved = session();
    saved.seal(&by("Ada"), time(1));
    // The program records its own changes, including an import that is undone.
    saved.robot.name = "another".into();
    let more = "pose,length_1_m,length_2_m\n8,1,1\n";
    let before = saved.measurements.clone();
    saved.measurements.append(row(&saved, more));
    assert!(!saved.is_sealed());
    saved.seal(&by("Ada"), time(2));
    saved.measurements = before;
    saved.seal(&by("Ada"), time(3));
    let json = json_of(&saved);
    assert_eq!(read(json.clone()).audit(), []);
    assert!(read(json.clone()).is_sealed());
    let cases: [(&str, Change, Vec<TrailFault>); 6] = [
        (
            "the robot",
            |json| json["robot"]["name"] = json!("mine"),
            vec![Changed(TrailPart::Robot, 1)],
        ),
        (
            "a table",
            |json| json["phases"]["winch"] = json!([]),
            vec![Changed(TrailPart::Tables, 0)],
        ),
        (
            "a result",
            |json| json["results"][0]["title"] = json!("Last try"),
            vec![Changed(TrailPart::Result(0), 0)],
        ),
        (
            "a result less",
            |json| json["results"] = json!([]),
            vec![Missing(TrailPart::Result(0), 0)],
        ),
        (
            "a result more",
            |json| {
                let result = json["results"][0].clone();
                json["results"].as_array_mut().expect("a list").push(result);
            },
            vec![Uncovered(TrailPart::Result(1))],
        ),
        (
            "an imported pose",
            |json| {
                let columns = json["measurements"]["columns"].as_object_mut();
                let mut columns = columns.expect("columns").values_mut();
                let cell = columns.find_map(|cells| {
                    let cells = cells.as_array_mut()?.iter_mut();
                    cells.into_iter().find(|cell| cell.is_number())
                });
                *cell.expect("a number") = json!(0.987);
            },
            vec![Changed(TrailPart::Imported, 2)],
        ),
    ];
    for (what, change, expected) in cases {
        let mut changed = json.clone();
        change(&mut changed);
        let mut changed = read(changed);
        assert_eq!(changed.audit(), expected, "{what}");
        // Saving again does not repair the trail, even several times or after a kill.
        changed.seal(&by("Eve"), time(20));
        let mut changed = read(json_of(&changed));
        if !matches!(expected[0], Uncovered(_)) {
            changed.cover_rest();
        }
        changed.robot.serial_number = Some("7".into());
        changed.seal(&by("Eve"), time(21));
        let after = read(json_of(&changed)).audit();
        assert!(
            expected.iter().all(|fault| after.contains(fault)),
            "{what}: {after:?}"
        );
    }
}

/// A trail of a version that recorded only motions and written values.
#[test]
fn a_trail_of_an_earlier_version_is_intact_and_covers_more_from_then_on() {
    let mut json = json_of(&sealed());
    let entries = json["trail"]["entries"].as_array_mut().expect("entries");
    let mut before = String::new();
    for entry in entries {
        let records = entry["records"].as_array_mut().expect("records");
        records.retain(|record| record["part"].is_object());
        entry["hash"] = json!(before);
        before = crate::fingerprint::sha256(entry);
        entry["hash"] = json!(before);
    }
    let mut old = read(json);
    assert_eq!(old.audit(), []);
    assert!(!old.trail().has_state());
    old.seal(&by("Ada"), time(9));
    assert!(old.trail().has_state());
    let mut json = json_of(&old);
    assert_eq!(read(json.clone()).audit(), []);
    json["robot"]["name"] = json!("mine");
    let faults = read(json).audit();
    assert_eq!(faults, [TrailFault::Changed(TrailPart::Robot, 3)]);
}

#[test]
fn later_poses_and_exclusion_change_no_pose() {
    let mut session = sealed();
    session.exclude(2).expect("a pose");
    let later = "pose,length_1_m,length_2_m,time_s,group,note\n3,1,1,7,b,x\n";
    let readings = row(&session, later);
    session.append_pose(&readings.into()).expect("a pose");
    assert_eq!(session.audit(), []);
    session.seal(&by("Ada"), time(5));
    assert_eq!(read(json_of(&session)).audit(), []);
}

#[test]
fn what_was_concluded_before_a_kill_is_covered_after_it() {
    let mut begun = sealed();
    begun.add_adjustment(Adjustment {
        outcome: Outcome::Begun,
        read_back: Vec::new(),
        ..sealed().adjustments()[0].clone()
    });
    begun.seal(&by("Ada"), time(4));
    assert!(begun.conclude_adjustment(Outcome::RolledBack, None, time(5)));
    log(&mut begun, 5, "Rolled back.");
    // Records for the next entry are not in the file.
    let mut left = read(json_of(&begun));
    let expected = [
        TrailFault::Changed(TrailPart::Adjustment(1), 3),
        TrailFault::Uncovered(TrailPart::Log(2)),
    ];
    assert_eq!(left.audit(), expected);
    left.cover_rest();
    assert_eq!(left.audit(), []);
    left.seal(&by("Ben"), time(6));
    assert_eq!(read(json_of(&left)).audit(), []);
    // It repairs no other fault.
    let mut json = json_of(&sealed());
    json["adjustments"][0]["operator"] = json!("Eve");
    let mut changed = read(json);
    changed.cover_rest();
    assert_eq!(
        changed.audit(),
        [TrailFault::Changed(TrailPart::Adjustment(0), 2)]
    );
}

#[test]
fn the_hash_of_an_entry_is_that_of_its_values() {
    // The chain can be computed by another program: keys in order, numbers as doubles, lengths before texts and lists.
    let entry = &sealed().trail().entries()[1].clone();
    let mut json = serde_json::to_value(entry).expect("JSON");
    json["hash"] = json!(sealed().trail().entries()[0].hash);
    assert_eq!(crate::fingerprint::sha256(&json), entry.hash);
}
