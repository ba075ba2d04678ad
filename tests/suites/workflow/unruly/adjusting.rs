//! An adjustment that is interrupted half way is settled with the values from before, and nothing moves meanwhile.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use serde_json::{Value, json};
use tautline_link::Controller;
use tautline_session::Outcome;
use tautline_validation::support::ads::unruly::{Action, RequestKind};
use tautline_validation::support::ads::{Host, Plant};
use tautline_validation::support::program::{Folder, tautline};

use super::{
    RELEASE, client, controller, heard, held, last_outcome, measured, session, start, wait_until,
};

/// Values that an adjustment of the measured session changes.
const VALUES: u64 = 31;

/// The command that writes the values of a session to a controller.
fn armed<'a>(file: &'a str, controller: &'a str) -> [&'a str; 5] {
    ["adjust", file, "--controller", controller, "--arm"]
}

#[test]
fn a_half_written_adjustment_is_settled_before_anything_else() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = measured(&folder, "s.json");
    let controller = controller(&plant);
    let with =
        |words: &[&str]| tautline(&[words, &[file.as_str(), "--controller", &controller]].concat());
    let old = held(&plant);
    plant
        .server
        .fault(RequestKind::Write, 1, Action::DownAfterValues(9));
    let broken = with(&["adjust", "--arm", "--json", "-"]);
    assert_eq!(broken.code, Some(1), "{}", broken.stderr);
    assert!(broken.stderr.contains("not known"), "{}", broken.stderr);
    assert_eq!(broken.json()["outcome"], "unsettled");
    let mixed = held(&plant);
    assert_ne!(mixed, old);
    let record = session(&file).adjustments()[0].clone();
    assert!(
        matches!(record.outcome, Outcome::Unsettled(_)),
        "{record:?}"
    );
    assert_eq!(record.changes.len() as u64, VALUES);
    // Down or not: nothing moves, and without arming nothing is written.
    plant.server.up();
    for words in [&["measure", "--arm"][..], &["verify", "--arm"]] {
        with(words).refused(&[
            "an adjustment of the controller was interrupted",
            "tautline adjust",
        ]);
    }
    with(&["adjust", "--quiet"]).refused(&["--arm"]);
    let found = with(&["adjust", "--dry-run"]).succeeded().stdout;
    assert!(
        found.contains("9 of 31 values in the controller differed from before"),
        "{found}"
    );
    assert_eq!(held(&plant), mixed);
    let settled = with(&["adjust", "--arm", "--json", "-"]);
    assert_eq!(settled.code, Some(4), "{}", settled.stderr);
    let document = settled.json();
    assert_eq!(document["interrupted"], "mixed");
    assert_eq!(document["outcome"], "rolled_back");
    assert_eq!(held(&plant), old);
    let settled = session(&file).adjustments()[0].clone();
    assert_eq!(
        (settled.outcome, settled.changes),
        (Outcome::RolledBack, record.changes)
    );
    // Now the new values are written, and taken back.
    with(&["adjust", "--arm"]).succeeded();
    assert_ne!(held(&plant), old);
    with(&["adjust", "--arm", "--roll-back"]).succeeded();
    assert_eq!(held(&plant), old);
}

#[test]
fn a_roll_back_is_settled_and_finished_as_well() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = measured(&folder, "s.json");
    let controller = controller(&plant);
    let adjust = armed(&file, &controller);
    let roll_back = [adjust.as_slice(), &["--roll-back"]].concat();
    let old = held(&plant);
    tautline(&adjust).succeeded();
    let new = held(&plant);
    plant
        .server
        .fault(RequestKind::Write, 1, Action::DownAfterValues(5));
    let mut child = start(&roll_back);
    wait_until(&mut child, || plant.server.count(RequestKind::Write) >= 3);
    child.kill().expect("it runs");
    child.wait().expect("it ends");
    plant.server.up();
    let mixed = held(&plant);
    assert!(mixed != old && mixed != new);
    tautline(&roll_back).succeeded();
    assert_eq!(held(&plant), old);
    assert_eq!(last_outcome(&file), Outcome::RolledBack);
}

#[test]
fn killed_after_the_last_value_a_roll_back_still_rolls_back() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let controller = controller(&plant);
    let old = held(&plant);
    for rolls_back in [true, false] {
        let file = measured(&folder, "s.json");
        let adjust = armed(&file, &controller);
        // The answer to the last block is late: all values are there, and the program does not know.
        plant
            .server
            .fault(RequestKind::Write, 2, Action::Late(60_000));
        let before = plant.server.values();
        let mut child = start(&adjust);
        wait_until(&mut child, || plant.server.values() >= before + VALUES);
        child.kill().expect("it runs");
        child.wait().expect("it ends");
        let new = held(&plant);
        assert_ne!(new, old);
        assert_eq!(last_outcome(&file), Outcome::Begun);
        if rolls_back {
            tautline(&[adjust.as_slice(), &["--roll-back"]].concat()).succeeded();
        } else {
            let settled = tautline(&adjust);
            assert_eq!(settled.code, Some(4), "{}", settled.stderr);
            assert_eq!(held(&plant), new);
            assert_eq!(last_outcome(&file), Outcome::Written);
            tautline(&[adjust.as_slice(), &["--roll-back"]].concat()).succeeded();
        }
        assert_eq!(held(&plant), old);
    }
}

#[test]
fn a_switch_that_is_off_keeps_the_old_values() {
    for cycle_ms in [10, 100] {
        let plant = Plant::unruly();
        let folder = Folder::new();
        let file = measured(&folder, "s.json");
        let controller = controller(&plant);
        let old = held(&plant);
        // The program revokes the release in each of its cycles.
        let (orders, ends) = (plant.server.orders(), Arc::new(AtomicBool::new(false)));
        let end = Arc::clone(&ends);
        let program = std::thread::spawn(move || {
            while !end.load(Ordering::SeqCst) {
                orders.give(&json!({"set": {RELEASE: [false]}}));
                std::thread::sleep(Duration::from_millis(cycle_ms));
            }
        });
        let answer = tautline(&["adjust", &file, "--controller", &controller, "--arm"]);
        ends.store(true, Ordering::SeqCst);
        program.join().expect("it ends");
        assert_eq!(answer.code, Some(1), "{}", answer.stderr);
        assert!(
            answer.stderr.contains("turn on the switch at the robot"),
            "{}",
            answer.stderr
        );
        assert_eq!(plant.server.values(), 0);
        assert_eq!(held(&plant), old);
        assert!(session(&file).adjustments().is_empty());
    }
}

#[test]
fn nothing_is_written_once_the_release_is_gone() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = measured(&folder, "s.json");
    let controller = controller(&plant);
    let adjust = armed(&file, &controller);
    let old = held(&plant);
    // The switch at the robot is turned while the first values are written.
    plant.server.before_value(|written, memory| {
        if written == 5 {
            memory.variable(RELEASE).set(&[json!(false)]);
        }
    });
    let answer = tautline(&adjust);
    assert_eq!(answer.code, Some(1), "{}", answer.stderr);
    assert!(
        answer.stderr.contains("it revoked the release"),
        "{}",
        answer.stderr
    );
    // The request in progress, and none after it.
    assert!(plant.server.values() <= 16, "{}", plant.server.values());
    assert!(matches!(last_outcome(&file), Outcome::Unsettled(_)));
    assert_eq!(
        plant.server.numbers(RELEASE),
        [0.0],
        "only the operator arms it again"
    );
    plant.server.before_value(|_, _| ());
    let settled = tautline(&adjust);
    assert_eq!(settled.code, Some(4), "{}", settled.stderr);
    assert_eq!(held(&plant), old);
}

#[test]
fn nothing_is_written_to_a_controller_that_faults_moves_or_stops() {
    let plant = Plant::unruly();
    let old = held(&plant);
    let values = [("home.x_m".to_owned(), 0.01)];
    for (order, expected) in [
        (
            json!({"set": {"GVL_Tautline.fault": [3]}}),
            "reports a fault: code 3",
        ),
        (
            json!({"set": {"GVL_Tautline.moving": [true]}}),
            "stands still",
        ),
        (json!({"set": {RELEASE: [false]}}), "revoked the release"),
        (json!({"state": 6}), "does not run"),
    ] {
        let mut robot = client(&plant);
        robot.arm().expect("armed");
        std::thread::sleep(Duration::from_millis(60));
        plant.server.carry_out(order.clone());
        let told = robot.write(&values).expect_err("it must not").to_string();
        assert!(told.contains(expected), "{order}: {told}");
        assert_eq!(held(&plant), old);
        let well =
            json!({"set": {"GVL_Tautline.fault": [0], "GVL_Tautline.moving": [false]}, "state": 5});
        plant.server.carry_out(well);
    }
}

#[test]
fn short_answers_never_become_values() {
    let folder = Folder::new();
    let untouched = Plant::unruly();
    let measured_file = measured(&folder, "s.json");
    let [old, new] = {
        let controller = controller(&untouched);
        let old = held(&untouched);
        tautline(&armed(&measured_file, &controller)).succeeded();
        [old, held(&untouched)]
    };
    for number in 1..=5 {
        let plant = Plant::unruly();
        let file = measured(&folder, "s.json");
        let controller = controller(&plant);
        let adjust = armed(&file, &controller);
        // These readings would be the values for rolling back.
        plant
            .server
            .fault(RequestKind::Read, number, Action::Short(64));
        tautline(&adjust);
        plant.server.forgive();
        tautline(&[adjust.as_slice(), &["--roll-back"]].concat());
        for (symbol, values) in held(&plant) {
            for (at, value) in values.iter().enumerate() {
                let known = [old[symbol][at], new[symbol][at]].contains(value);
                assert!(known, "read {number}, {symbol}: {value}");
            }
        }
    }
}

#[test]
fn a_single_wrong_reading_is_never_an_old_value() {
    let folder = Folder::new();
    let place = ("GVL_Tautline.entry_point", 4);
    for (number, value) in (1..=7).flat_map(|number| [(number, f64::NAN), (number, 0.0)]) {
        let plant = Plant::unruly();
        let file = measured(&folder, "s.json");
        let controller = controller(&plant);
        let adjust = ["adjust", file.as_str(), "--controller", &controller];
        let adjust = [adjust.as_slice(), &["--arm"]].concat();
        let old = held(&plant);
        plant.server.wrong_reading(place, value, number);
        // Where the new values were read back wrongly they were taken back at once.
        tautline(&adjust);
        plant.server.forgive();
        let record = session(&file).adjustments()[0].clone();
        let mut changes = record.changes.iter();
        let misread = changes.find(|change| change.name == "cable-2.entry_point.y_m");
        let before = misread.map(|change| change.before);
        assert_eq!(before, Some(old[place.0][place.1]), "reading {number}");
        assert_eq!(record.changes.len() as u64, VALUES, "reading {number}");
        if record.outcome == Outcome::Written {
            let back = tautline(&[adjust.as_slice(), &["--roll-back"]].concat()).succeeded();
            let expected = "The previous values were restored (31 changed).";
            assert!(back.stdout.contains(expected), "{}", back.stdout);
        }
        assert_eq!(held(&plant), old, "reading {number}");
    }
}

#[test]
fn values_that_read_differently_each_time_are_named_and_not_overwritten() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = measured(&folder, "s.json");
    let controller = controller(&plant);
    let old = held(&plant);
    for number in [1, 3, 5] {
        plant
            .server
            .wrong_reading(("GVL_Tautline.entry_point", 4), f64::NAN, number);
    }
    let answer = tautline(&["adjust", &file, "--controller", &controller, "--arm"]);
    assert_eq!(answer.code, Some(1), "{}", answer.stderr);
    for part in [
        "differ from one reading to the next",
        "cable-2.entry_point.y_m = ",
        "NaN",
    ] {
        assert!(answer.stderr.contains(part), "{}", answer.stderr);
    }
    assert_eq!(plant.server.values(), 0);
    assert_eq!(held(&plant), old);
}

#[test]
fn what_is_no_number_is_shown_overwritten_and_recorded() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = measured(&folder, "s.json");
    let controller = controller(&plant);
    let adjust = ["adjust", file.as_str(), "--controller", &controller];
    let mut drums = plant.server.numbers("GVL_Tautline.drum_diameter");
    let drum = drums[2];
    drums[2] = f64::NAN;
    let values_of = |values: &[f64]| -> Vec<Value> { values.iter().map(|v| json!(v)).collect() };
    plant
        .server
        .carry_out(json!({"set": {"GVL_Tautline.drum_diameter": values_of(&drums)}}));
    let shown = tautline(&[adjust.as_slice(), &["--dry-run", "--json", "-"]].concat());
    let shown = shown.succeeded().json();
    let row = |document: &Value| {
        let rows = document["differences"].as_array().expect("rows").clone();
        let named = |row: &&Value| row["name"] == "cable-3.winch.drum_diameter_m";
        rows.iter().find(named).expect("the drum").clone()
    };
    assert_eq!(row(&shown)["not_a_number"], "NaN");
    assert_eq!(row(&shown)["changes"], true);
    let text = tautline(&[adjust.as_slice(), &["--dry-run"]].concat())
        .succeeded()
        .stdout;
    let line = text
        .lines()
        .find(|line| line.contains("cable-3.winch.drum"));
    assert!(line.is_some_and(|line| line.contains("NaN")), "{text}");
    let written = tautline(&[adjust.as_slice(), &["--arm"]].concat()).succeeded();
    let expected =
        "cannot restore those that were not numbers before: cable-3.winch.drum_diameter_m.";
    assert!(written.stdout.contains(expected), "{}", written.stdout);
    assert_eq!(plant.server.numbers("GVL_Tautline.drum_diameter")[2], drum);
    let record = session(&file).adjustments()[0].clone();
    let change = record
        .changes
        .iter()
        .find(|c| c.name.starts_with("cable-3.winch"));
    assert!(change.is_some_and(|change| change.before.is_nan()));
    let back = [adjust.as_slice(), &["--arm", "--roll-back", "--json", "-"]].concat();
    let back = tautline(&back);
    assert_eq!(back.code, Some(1), "a value is not restored");
    assert!(back.stderr.contains("was NaN and keeps"), "{}", back.stderr);
    let back = back.json();
    assert_eq!(
        back["not_restored"],
        json!(["cable-3.winch.drum_diameter_m"])
    );
    let text = back["text"].as_str().expect("a text");
    for part in ["31 of the previous", "was NaN and keeps", "by hand"] {
        assert!(text.contains(part), "{text}");
    }
    assert_eq!(plant.server.numbers("GVL_Tautline.drum_diameter")[2], drum);
}

#[test]
fn a_record_that_cannot_be_written_is_missed_aloud() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let place = folder.join("place");
    std::fs::create_dir(&place).expect("a folder");
    let file = measured(&folder, "place/s.json");
    let controller = controller(&plant);
    let space = std::path::PathBuf::from(format!("{file}.unsaved/space"));
    let size = std::fs::metadata(&file).expect("a file").len();
    let (moved, kept) = (folder.join("moved"), Arc::new(AtomicBool::new(false)));
    let (place_moves, space_kept) = (place.clone(), Arc::clone(&kept));
    plant.server.before_value(move |written, _| {
        if written == 3 {
            let space = std::fs::metadata(&space);
            space_kept.store(
                space.is_ok_and(|space| space.len() > size),
                Ordering::SeqCst,
            );
            // Nothing can be written there any more.
            std::fs::rename(&place_moves, &moved).expect("moved away");
        }
    });
    let answer = tautline(&["adjust", &file, "--controller", &controller, "--arm"]);
    assert_eq!(answer.code, Some(1), "{}", answer.stderr);
    assert!(
        kept.load(Ordering::SeqCst),
        "space is kept before anything is written"
    );
    for part in [
        "written and read back",
        "does not record this outcome, only that",
        &file,
    ] {
        assert!(answer.stderr.contains(part), "{}", answer.stderr);
    }
    let there = folder.join("moved/s.json");
    assert_eq!(last_outcome(&there), Outcome::Begun);
    let settled = tautline(&["adjust", &there, "--controller", &controller, "--arm"]);
    assert_eq!(settled.code, Some(4), "{}", settled.stderr);
    assert_eq!(last_outcome(&there), Outcome::Written);
}

#[test]
fn nothing_is_written_whose_result_cannot_be_written() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = measured(&folder, "s.json");
    let controller = controller(&plant);
    let old = held(&plant);
    let adjust = ["adjust", &file, "--controller", &controller, "--arm"];
    let nowhere = folder.join("nowhere/result.json");
    let with = |words: &[&str]| tautline(&[adjust.as_slice(), words].concat());
    let answer = with(&["--json", &nowhere]);
    assert_eq!(answer.code, Some(1), "{}", answer.stderr);
    assert!(answer.stderr.contains(&nowhere), "{}", answer.stderr);
    assert_eq!(plant.server.values(), 0);
    assert_eq!(held(&plant), old);
    // Of a device it shows only when it is written to; then the message says what the controller holds.
    if cfg!(target_os = "linux") {
        let answer = with(&["--json", "/dev/full"]);
        assert_eq!(answer.code, Some(1), "{}", answer.stderr);
        for part in [
            "31 values written and read back.",
            "/dev/full: cannot be written",
        ] {
            assert!(answer.stderr.contains(part), "{}", answer.stderr);
        }
        assert_eq!(last_outcome(&file), Outcome::Written);
    }
    let result = folder.join("result.json");
    with(&["--roll-back", "--json", &result]).succeeded();
    assert_eq!(folder.json("result.json")["outcome"], "rolled_back");
    assert_eq!(held(&plant), old);
}

#[test]
fn the_timeout_is_an_option_that_the_session_keeps() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = measured(&folder, "s.json");
    let controller = controller(&plant);
    let with = |words: &[&str]| {
        let adjust = armed(&file, &controller);
        tautline(&[adjust.as_slice(), words].concat())
    };
    let old = held(&plant);
    for (timeout, found) in [
        ("90", "found 90, expected 0.05 s to 60 s"),
        ("0", "found 0"),
    ] {
        with(&["--timeout", timeout]).refused(&["--timeout", found]);
    }
    let sim = ["adjust", &file, "--controller", "sim", "--timeout", "2"];
    tautline(&sim).refused(&["--timeout: found the controller sim"]);
    // The first symbol is looked up too slowly.
    plant
        .server
        .fault(RequestKind::Lookup, 1, Action::Late(900));
    let late = with(&["--timeout", "0.3"]);
    assert_eq!(late.code, Some(1), "{}", late.stderr);
    let expected = "did not answer within 0.3 s when asked for the symbol GVL_Tautline.";
    assert!(late.stderr.contains(expected), "{}", late.stderr);
    assert_eq!(held(&plant), old);
    plant.server.forgive();
    with(&["--timeout", "21.5"]).succeeded();
    let place = session(&file).connection.place;
    assert_eq!(place.map(|place| place.timeout_s), Some(21.5));
}

#[test]
fn doubtful_values_are_written_only_by_name() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = measured(&folder, "s.json");
    // One encoder lost its zero half way, as after a restart that nobody noticed.
    let mut session: Value =
        serde_json::from_str(&std::fs::read_to_string(&file).expect("text")).expect("JSON");
    for cable in 1..=8 {
        let column = &mut session["measurements"]["columns"][format!("rev_{cable}")];
        for row in 13..26 {
            column[row] = json!(column[row].as_f64().expect("a number") + 0.05);
        }
    }
    std::fs::write(&file, session.to_string()).expect("written");
    let controller = controller(&plant);
    let adjust = armed(&file, &controller);
    let old = held(&plant);
    let mut allowed: Vec<&str> = Vec::new();
    for (doubt, flag) in [
        (
            "The model does not explain the readings",
            "--allow-unexplained",
        ),
        (
            "from the description, whose standard deviation is",
            "--allow-implausible",
        ),
    ] {
        let answer = tautline(&[adjust.as_slice(), &allowed].concat());
        assert_eq!(answer.code, Some(1), "{}", answer.stderr);
        assert!(
            answer.stderr.contains(doubt) && answer.stderr.contains(flag),
            "{}",
            answer.stderr
        );
        assert_eq!(held(&plant), old);
        allowed.push(flag);
    }
    let dry = tautline(&["adjust", &file, "--controller", &controller, "--dry-run"]).succeeded();
    assert!(
        dry.stderr.contains("does not explain the readings"),
        "{}",
        dry.stderr
    );
    let answer = heard(start(&[adjust.as_slice(), &allowed].concat()), |_, _| ());
    answer.succeeded();
    assert_ne!(held(&plant), old);
}
