//! The program itself, through real frames: the whole loop as a user runs it, and interruptions.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::Path;
use std::process::Stdio;

use serde_json::{Value, json};
use tautline_core::robot::presets;
use tautline_link::parameters::parameters_of;
use tautline_link::simulated::SimulatedTracker;
use tautline_link::{Controller, Instrument};
use tautline_session::{Outcome, Session, read_session, write_symbols};
use tautline_validation::support::program::{self, Folder, heard, on_disk, tautline};

use tautline_validation::support::ads::symbols::{Style, global, mapping};
use tautline_validation::support::ads::{Host, Plant, Protocol, User};

pub(super) fn controller(plant: &Plant) -> String {
    plant.server.choice()
}

pub(super) fn session(path: &str) -> Session {
    let read = read_session(Path::new(path));
    read.unwrap_or_else(|error| panic!("{error}")).value
}

/// Values of the controller, read by another client.
fn held(plant: &Plant) -> BTreeMap<String, f64> {
    let mut reader = plant.client();
    reader.connect().expect("connected");
    let parameters = reader.parameters().expect("parameters").into_iter();
    parameters.map(|p| (p.name, p.value)).collect()
}

/// Values of the description, as the controller held them at first.
fn drawn() -> BTreeMap<String, f64> {
    let robot = presets::find("mini").expect("a preset").robot;
    let parameters = parameters_of(&robot).into_iter();
    parameters.map(|p| (p.name, p.value)).collect()
}

/// Verifies, and types the poses of a tracker when the program asks for them; returns the largest AP (m).
fn verified(user: &User, words: &[&str], stage: &str, tracker: &mut SimulatedTracker) -> f64 {
    let mut typed = 0;
    let answer = heard(user.start(words), |line, child| {
        if line.ends_with("x y z [mm]?") {
            let [x, y, z] = tracker
                .measure()
                .expect("a reading")
                .position_m
                .map(|m| 1e3 * m);
            let input = child.stdin.as_mut().expect("a pipe");
            writeln!(input, "{x} {y} {z}").expect("it reads");
            typed += 1;
        }
    });
    let document = answer.succeeded().json();
    assert_eq!(typed, 30, "15 poses, twice");
    assert_eq!(document["stage"], stage);
    let ap = document[stage]["poses"]["largest_accuracy_m"].as_f64();
    ap.expect("a figure")
}

fn a_robot_is_measured_verified_adjusted_and_verified_again(protocol: Protocol) {
    let mut plant = Plant::fast(protocol, Style::Arrays);
    let mut tracker = plant.tracker();
    let user = User::of(&plant);
    let folder = Folder::new();
    let file = folder.join("s.json");
    let controller = controller(&plant);
    let real = [
        file.as_str(),
        "--controller",
        &controller,
        "--arm",
        "--json",
        "-",
    ];
    let measured = user.run(&[&["measure", "--robot", "mini"], real.as_slice()].concat());
    let measured = measured.succeeded().json();
    assert_eq!(measured["measured"].as_array().map(Vec::len), Some(26));
    assert_eq!(measured["enough"], true);
    assert_eq!(held(&plant), drawn());

    let verify = [
        &["verify", "--targets", "cube", "--cycles", "2"],
        real.as_slice(),
    ]
    .concat();
    let before = verified(&user, &verify, "before", &mut tracker);
    let adjusted = user
        .run(&[&["adjust"], real.as_slice()].concat())
        .succeeded()
        .json();
    assert_eq!(
        (&adjusted["outcome"], &adjusted["holds"]),
        (&"written".into(), &"new".into())
    );
    let held = held(&plant);
    let rows = adjusted["differences"].as_array().expect("rows").iter();
    let written: Vec<&Value> = rows.filter(|row| row["changes"] == true).collect();
    assert!(written.len() > 20, "{}", written.len());
    for row in written {
        let now = row["name"].as_str().and_then(|name| held.get(name));
        assert_eq!(now.copied(), row["identified"].as_f64(), "{}", row["name"]);
    }
    let after = verified(&user, &verify, "after", &mut tracker);
    println!("largest AP {:.3} -> {:.3} mm", 1e3 * before, 1e3 * after);
    assert!(before > 1e-3 && after < 0.5 * before, "{before} {after}");
    let again = user
        .run(&[&["adjust"], real.as_slice()].concat())
        .succeeded()
        .json();
    assert_eq!(again["outcome"], "nothing_to_write");
}

fn the_controller_dies_while_measuring(protocol: Protocol) {
    let plant = Plant::fast(protocol, Style::Arrays);
    let user = User::of(&plant);
    let folder = Folder::new();
    let file = folder.join("s.json");
    let controller = controller(&plant);
    let words = [
        "measure",
        &file,
        "--robot",
        "mini",
        "--poses",
        "12",
        "--controller",
        &controller,
        "--arm",
    ];
    let first = heard(user.start(&words), |line, _| {
        if line.starts_with("pose") && line.contains("(5 of 13)") {
            plant.server.order(json!({"restart": 0.5}));
        }
    });
    assert_eq!(first.code, Some(1), "{}", first.stderr);
    let last = first.stderr.lines().last().expect("a sentence");
    assert!(
        last.contains("the controller is lost") || last.contains("cannot be reached"),
        "{last}"
    );
    assert!(last.contains("the same command continues"), "{last}");
    let mut told = on_disk(&first.stderr);
    assert_eq!(told.len(), 5);
    assert_eq!(session(&file).measurements.labels, told);
    let second = user.run(&words).succeeded();
    told.extend(on_disk(&second.stderr));
    assert_eq!(session(&file).measurements.labels, told);
    let labels: BTreeSet<i64> = told.iter().copied().collect();
    assert_eq!((labels.len(), told.len()), (13, 13));
}

#[test]
fn a_killed_adjustment_is_settled_by_the_next_command() {
    let plant = Plant::fast(Protocol::Ads, Style::Arrays);
    let folder = Folder::new();
    let measured = folder.join("measured.json");
    let controller = controller(&plant);
    let real = ["--controller", &controller, "--arm", "--json", "-"];
    let measure = ["measure", &measured, "--robot", "mini", "--poses", "12"];
    tautline(&[measure.as_slice(), &real].concat()).succeeded();
    // One write for each value, and time between them.
    plant.server.order(json!({"sums": false, "delay_s": 0.02}));
    let old = held(&plant);
    let mut found = BTreeSet::new();
    // The first writes are the release and the watchdog while it is confirmed.
    for writes in [0, 1, 2, 5, 9, 14, 20, 26, 1000] {
        let file = folder.join(&format!("{writes}.json"));
        std::fs::copy(&measured, &file).expect("copied");
        let adjust = [&["adjust", file.as_str()], real.as_slice()].concat();
        let before = plant.server.count("write");
        let mut child = program::start(&adjust, Stdio::piped());
        let mut is_over = || child.try_wait().expect("a state").is_some();
        while !is_over() && plant.server.count("write") < before + writes {}
        child.kill().expect("it can be killed");
        child.wait().expect("it ends");
        let amid = held(&plant);
        let last = session(&file)
            .adjustments()
            .last()
            .map(|last| last.outcome.clone());
        let answer = tautline(&adjust);
        let settles = last == Some(Outcome::Begun);
        let expected = if settles { 4 } else { 0 };
        assert_eq!(answer.code, Some(expected), "{writes}: {}", answer.stderr);
        let answer = answer.json();
        let now = held(&plant);
        if settles {
            let word = answer["interrupted"].as_str().expect("what was found");
            assert_eq!(word == "old", amid == old, "{writes}: {word}");
            assert_eq!(now == old, word != "new", "{writes}: {word}");
            found.insert(word.to_owned());
        } else {
            assert!(
                last.is_some() || amid == old,
                "{writes}: values without a record"
            );
            assert_ne!(now, old, "{writes}");
        }
        let settled = session(&file);
        let last = settled.adjustments().last().map(|last| &last.outcome);
        assert!(
            !matches!(last, None | Some(Outcome::Begun)),
            "{writes}: {last:?}"
        );
        if now != old {
            let back = tautline(&[adjust.as_slice(), &["--roll-back"]].concat());
            assert_eq!(back.succeeded().json()["outcome"], "rolled_back");
        }
        assert_eq!(held(&plant), old, "{writes}");
    }
    println!("found after kills: {found:?}");
    assert!(found.contains("mixed"), "{found:?}");
}

#[test]
fn missing_symbols_are_named_before_anything_starts() {
    let folder = Folder::new();
    let file = folder.join("s.json");
    let refused = |order: Value, parts: &[&str]| {
        let plant = Plant::start(Style::Arrays);
        plant.server.order(order);
        let controller = controller(&plant);
        let words = [
            "measure",
            &file,
            "--robot",
            "mini",
            "--poses",
            "8",
            "--controller",
            &controller,
            "--arm",
        ];
        let answer = tautline(&words);
        assert_eq!(answer.code, Some(2), "{}", answer.stderr);
        let last = answer.stderr.lines().last().expect("a sentence");
        for part in parts {
            assert!(last.contains(part), "{last} lacks {part}");
        }
        assert_eq!(plant.server.count("write"), 0);
        assert!(!Path::new(&file).exists());
    };
    refused(
        json!({"remove": [global("force")]}),
        &["does not have 1 of the symbols", "GVL_Tautline.force"],
    );
    refused(
        json!({"declare": [[global("moving"), "LREAL", 1, [0]]]}),
        &["GVL_Tautline.moving is of type LREAL, expected BOOL"],
    );
}

#[test]
fn symbols_read_from_a_file_are_stored_in_the_session() {
    let plant = Plant::fast(Protocol::Ads, Style::Single);
    let folder = Folder::new();
    let (file, symbols) = (folder.join("s.json"), folder.join("symbols.json"));
    let own = mapping(&plant.preset.robot, Style::Single);
    write_symbols(Path::new(&symbols), &own).expect("written");
    let controller = controller(&plant);
    let real = ["--controller", &controller, "--arm", "--json", "-"];
    let measure = ["measure", &file, "--robot", "mini", "--poses", "12"];
    let without = tautline(&[measure.as_slice(), &real].concat());
    assert_eq!(without.code, Some(2), "{}", without.stderr);
    let with = [measure.as_slice(), &real, &["--symbols", &symbols]].concat();
    let measured = tautline(&with).succeeded().json();
    assert_eq!(measured["measured"].as_array().map(Vec::len), Some(13));
    assert_eq!(session(&file).connection.ads, Some(own));
    let foreseen = tautline(&[&["adjust", &file, "--dry-run"], real.as_slice()].concat());
    assert_eq!(foreseen.succeeded().json()["outcome"], "not_written");
}

super::over_all! {
    a_robot_is_measured_verified_adjusted_and_verified_again,
    the_controller_dies_while_measuring,
}
