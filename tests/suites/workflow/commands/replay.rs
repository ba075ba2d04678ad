//! replay. Its figures are checked with MuJoCo in `tests/suites/python/test_simulators.py`.

use std::fs;

use super::program::{Folder, assert_valid, number, tautline};

fn dataset(folder: &Folder) -> String {
    let out = folder.join("machine");
    let effect = "winch_scale:cable-2:scale=0.01";
    let arguments = [
        "simulate", "--robot", "planar", "--poses", "30", "--seed", "3",
    ];
    tautline(&[&arguments[..], &["--effect", effect, "--out", &out]].concat()).succeeded();
    out
}

/// A simulator with the readings of the machine at its true poses is the machine.
#[test]
fn the_readings_of_the_machine_itself_are_no_error() {
    let folder = Folder::new();
    let machine = dataset(&folder);
    let poses = fs::read_to_string(folder.join("machine/poses.csv")).expect("readings");
    let (header, rows) = poses.split_once('\n').expect("a header");
    let header = header
        .replace(",x_m,", ",cmd_x_m,")
        .replace("true_x_m", "x_m");
    let header = ["y_m", "z_m", "qw", "qx", "qy", "qz"]
        .iter()
        .fold(header, |text, name| {
            let commanded = text.replace(&format!(",{name},"), &format!(",cmd_{name},"));
            commanded.replace(&format!("true_{name}"), name)
        });
    let simulated = folder.write("simulated.csv", &[&header, rows].join("\n"));
    let picture = folder.join("replay.svg");
    let arguments = [
        "replay",
        &machine,
        "--simulated",
        &simulated,
        "--picture",
        &picture,
    ];
    let answer = tautline(&[&arguments[..], &["--json", "-"]].concat()).succeeded();
    let document = answer.json();
    assert_valid(&document);
    assert_eq!(
        (document["format"].as_str(), &document["poses"]),
        (Some("tautline-replay"), &30.into())
    );
    // The identified frame differs from the true one by the uncertainty of the home pose.
    let length = &document["readings"][0];
    let drawing = number(length, "/drawing_rms");
    assert!(number(length, "/simulator_rms") < 0.2 * drawing, "{length}");
    assert!(
        number(length, "/identified_rms") < 0.05 * drawing,
        "{length}"
    );
    let causes = document["readings"][0]["causes"]
        .as_array()
        .expect("causes");
    assert!(
        causes
            .iter()
            .any(|one| one["cause"] == "Winch scale (cable-2)"),
        "{causes:?}"
    );
    assert!(
        fs::read_to_string(&picture)
            .expect("a picture")
            .starts_with("<svg")
    );
    let printed = tautline(&arguments[..4]).succeeded().stdout;
    assert!(printed.contains("Length explained by: "), "{printed}");
}

#[test]
fn wrong_files_get_one_sentence() {
    let folder = Folder::new();
    let machine = dataset(&folder);
    let replay = |text: &str| {
        let simulated = folder.write("simulated.csv", text);
        let answer = tautline(&["replay", &machine, "--simulated", &simulated]);
        assert_eq!(answer.code, Some(2), "{}", answer.stderr);
        answer.stderr
    };
    let said = replay("pose,change_1_m\n0,0\n1,0.1\n");
    assert!(said.contains("simulated.csv"), "{said}");
    let lengths = "length_1_m,length_2_m,length_3_m,length_4_m";
    let said = replay(&format!("pose,{lengths}\n90,1,1,1,1\n"));
    assert!(
        said.contains("found no pose that was measured, expected the labels 0 to 30"),
        "{said}"
    );
    let said = replay(&format!("pose,{lengths}\n1,1,x,1,1\n"));
    assert!(
        said.contains("simulated.csv, line 2, column \"length_2_m\": found \"x\""),
        "{said}"
    );
}
