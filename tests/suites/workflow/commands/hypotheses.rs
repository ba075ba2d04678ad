//! Effects of the user as text: the page, the files beside a dataset, model files and sessions, and refusals.

use serde_json::Value;
use tautline_core::effect::{EffectSetting, Hypothesis, every_effect};
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_session::{Session, Timestamp, write_session};
use tautline_validation::generators::hypotheses;
use tautline_validation::support::program::{command, run};

use super::program::{Answer, Folder, assert_valid, tautline};

/// The hypothesis files of the page, in a folder.
fn page_files(folder: &Folder) {
    let page = std::fs::read_to_string(hypotheses::page()).expect("the page");
    let files = hypotheses::files(&page);
    assert_eq!(files.len(), 2);
    for (name, content) in files {
        folder.write(&name, &content);
    }
}

/// A dataset with crosstalk of cable 3.
fn dataset(folder: &Folder) -> String {
    page_files(folder);
    let (file, out) = (folder.join("crosstalk.toml"), folder.join("bad"));
    let effect = "encoder_crosstalk:cable-3:share=0.01";
    let arguments = [
        "simulate", "--robot", "mini", "--poses", "40", "--seed", "4",
    ];
    let more = ["--hypothesis", &file, "--effect", effect, "-o", &out];
    tautline(&[&arguments[..], &more].concat()).succeeded();
    out
}

#[test]
fn the_page_is_as_the_program_answers() {
    let text = std::fs::read_to_string(hypotheses::page()).expect("the page");
    assert_eq!(
        hypotheses::with_outputs(&text).expect("outputs"),
        text,
        "validation hypotheses writes the page"
    );
}

#[test]
fn a_hypothesis_beside_a_dataset_is_named_and_models_carry_it() {
    let folder = Folder::new();
    let data = dataset(&folder);
    let without = tautline(&["diagnose", &data, "--json", "-", "--time-limit", "600"])
        .succeeded()
        .json();
    let effects = |document: &Value| -> Vec<String> {
        let findings = document["findings"].as_array().expect("findings");
        let names = findings.iter().filter_map(|f| f["effect"].as_str());
        names.map(str::to_owned).collect()
    };
    assert!(!effects(&without).contains(&"encoder_crosstalk".to_owned()));

    std::fs::create_dir(folder.path().join("bad/effects")).expect("a folder");
    let text = std::fs::read_to_string(folder.join("crosstalk.toml")).expect("a file");
    folder.write("bad/effects/crosstalk.toml", &text);
    let model = folder.join("model.json");
    let arguments = [
        "diagnose",
        &data,
        "--json",
        "-",
        "--time-limit",
        "600",
        "--model-out",
        &model,
    ];
    let found = tautline(&arguments).succeeded().json();
    assert_eq!(effects(&found), ["encoder_crosstalk"]);
    assert_eq!(
        found["findings"][0]["targets"],
        serde_json::json!(["cable-3"])
    );
    assert_valid(&found);

    let written = folder.json("model.json");
    assert_valid(&written);
    assert_eq!(written["hypotheses"], serde_json::json!([text]));
    assert_eq!(written["effects"][0]["effect"], "encoder_crosstalk");
    // The model opens where the file of the hypothesis is not.
    let elsewhere = Folder::new();
    let copy = elsewhere.write("model.json", &written.to_string());
    tautline(&["evaluate", &data, "--model", &copy]).succeeded();
}

#[test]
fn identification_and_plans_take_it() {
    let folder = Folder::new();
    let data = dataset(&folder);
    let file = folder.join("crosstalk.toml");
    let effect = "encoder_crosstalk:cable-3";
    let arguments = ["identify", &data, "--hypothesis", &file, "--effect", effect];
    let model = folder.join("identified.json");
    tautline(&[&arguments[..], &["--model-out", &model]].concat()).succeeded();
    let share = folder.json("identified.json")["effects"][0]["parameters"]["share"].as_f64();
    assert!((share.expect("a number") - 0.01).abs() < 3e-3);

    let plan = [
        "plan",
        "mini",
        "--poses",
        "12",
        "--candidates",
        "300",
        "--explain",
    ];
    let planned = tautline(&[&plan[..], &["--hypothesis", &file]].concat()).succeeded();
    assert!(
        planned
            .stdout
            .contains("Crosstalk between neighbouring encoders")
    );
}

#[test]
fn the_catalogue_can_be_written_and_read_again() {
    let folder = Folder::new();
    for effect in every_effect() {
        let answer = tautline(&["effects", "--as-text", effect.id()]);
        if answer.code != Some(0) {
            answer.refused(&[effect.id(), "cannot be written as text: it "]);
            continue;
        }
        let file = folder.write(&format!("{}.toml", effect.id()), &answer.stdout);
        let list = tautline(&["effects", "--hypothesis", &file])
            .succeeded()
            .stdout;
        assert!(list.contains(&format!("my_{}", effect.id())), "{list}");
    }
}

#[test]
fn mistakes_are_named_with_file_line_and_column() {
    let folder = Folder::new();
    let data = dataset(&folder);
    let text = std::fs::read_to_string(folder.join("crosstalk.toml")).expect("a file");
    let file = folder.write("wrong.toml", &text.replace("paid_of(next)", "tension"));
    let diagnose = ["diagnose", &data, "--hypothesis", &file];
    tautline(&diagnose).refused(&[&file, "line 13, column 16: found N, expected"]);
    let missing = folder.join("missing.toml");
    tautline(&["plan", "mini", "--hypothesis", &missing]).refused(&[&missing, "not found"]);
    // Two texts with one id.
    let right = folder.join("crosstalk.toml");
    let other = folder.write("other.toml", &text.replace("0.03]", "0.02]"));
    let both = [
        "check",
        &data,
        "--hypothesis",
        &right,
        "--hypothesis",
        &other,
    ];
    tautline(&both).refused(&[&other, "\"encoder_crosstalk\" with another text"]);
}

/// The program with a settings folder.
fn with_settings(settings: &str, arguments: &[&str]) -> Answer {
    run(command(arguments).env("TAUTLINE_HOME", settings))
}

#[test]
fn hypotheses_in_the_settings_folder_are_found_and_a_broken_one_stops_nothing() {
    let folder = Folder::new();
    let data = dataset(&folder);
    let settings = folder.join("settings");
    std::fs::create_dir_all(folder.path().join("settings/effects")).expect("a folder");
    let text = std::fs::read_to_string(folder.join("crosstalk.toml")).expect("a file");
    let own = folder.write("settings/effects/crosstalk.toml", &text);
    let wrong = text
        .replace("encoder_crosstalk", "wrong")
        .replace("paid_of(next)", "tension");
    let broken = folder.write("settings/effects/wrong.toml", &wrong);

    let list = with_settings(&settings, &["effects"]).succeeded();
    assert!(
        list.stdout.contains(&format!("encoder_crosstalk: {own}")),
        "{}",
        list.stdout
    );
    let said: Vec<&str> = list.stderr.lines().collect();
    let [said] = said[..] else {
        panic!("{said:?}");
    };
    assert!(
        said.starts_with(&format!("{broken}, line 13, column 16: found N")),
        "{said}"
    );
    assert!(
        !tautline(&["effects"])
            .succeeded()
            .stdout
            .contains("encoder_crosstalk")
    );

    let diagnose = ["diagnose", &data, "--json", "-", "--time-limit", "600"];
    let found = with_settings(&settings, &diagnose).succeeded().json();
    assert_eq!(found["findings"][0]["effect"], "encoder_crosstalk");

    // The file beside the dataset takes precedence.
    std::fs::create_dir(folder.path().join("bad/effects")).expect("a folder");
    let nearer = text.replace("0.03]", "0.02]");
    let nearer = folder.write("bad/effects/crosstalk.toml", &nearer);
    let list = with_settings(&settings, &["effects", &data]).succeeded();
    assert!(
        list.stdout
            .contains(&format!("encoder_crosstalk: {nearer}")),
        "{}",
        list.stdout
    );
    assert!(
        list.stderr
            .contains(&format!("{own}: found the hypothesis")),
        "{}",
        list.stderr
    );
}

#[test]
fn the_gallery_has_one_entry_for_each_effect() {
    let folder = Folder::new();
    let data = dataset(&folder);
    let file = folder.join("crosstalk.toml");
    let out = folder.join("gallery.html");
    let arguments = ["effects", &data, "--hypothesis", &file, "--gallery", &out];
    tautline(&arguments).succeeded();
    let page = std::fs::read_to_string(&out).expect("a page");
    let entries = page.matches("<h2>").count();
    // One more is the legend, and one is the hypothesis.
    assert_eq!(entries, every_effect().count() + 2);
    for effect in every_effect() {
        let title = effect.title().replace('\'', "&#39;");
        assert!(page.contains(&format!("<h2>{title}</h2>")), "{title}");
        assert!(page.contains(effect.id()), "{}", effect.id());
    }
    assert!(page.contains("Crosstalk between neighbouring encoders"));
    assert!(page.contains("Separate the two encoder cables and ground their shields."));
    let pictures = page.matches("<svg").count();
    assert!(pictures >= 35, "{pictures}");
    tautline(&arguments).refused(&[&out, "already exists"]);
    let text = folder.join("gallery.txt");
    tautline(&["effects", "--gallery", &text]).refused(&["--gallery", ".html"]);
}

/// A session of MINI whose model has the crosstalk of cable 3, which is `share` in truth.
fn session(folder: &Folder, name: &str, share: f64, seed: u64) {
    let text = std::fs::read_to_string(folder.join("crosstalk.toml")).expect("a file");
    let mut robot = presets::find("mini").expect("a preset").robot;
    let hypothesis = Hypothesis::parse(&text).expect("a hypothesis");
    robot.add_hypothesis(&hypothesis).expect("known");
    let setting = |share: f64| EffectSetting {
        effect: "encoder_crosstalk".into(),
        targets: vec!["cable-3".into()],
        parameters: [("share".to_owned(), share)].into(),
    };
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        effects: vec![setting(share)],
        ..SimulationOptions::new(40, seed)
    };
    let run = simulate(&robot, &options).expect("a run");
    let mut session = Session::new(name, robot, Timestamp::from_unix_seconds(0));
    session.measurements = run.dataset.measurements;
    session.settings.identification.effects = vec![setting(0.0)];
    let path = folder.path().join("life").join(format!("{name}.tautline"));
    write_session(&path, &session).expect("written");
}

#[test]
fn history_says_when_a_hypothesis_changed() {
    let folder = Folder::new();
    page_files(&folder);
    std::fs::create_dir(folder.path().join("life")).expect("a folder");
    for (k, share) in [0.0, 0.0, 0.03, 0.03].into_iter().enumerate() {
        session(&folder, &format!("session-{k}"), share, 20 + k as u64);
    }
    let life = folder.join("life");
    let found = tautline(&["history", &life, "--json", "-"])
        .succeeded()
        .json();
    assert_valid(&found);
    let changes = found["changes"].as_array().expect("changes");
    let first = &changes[0];
    assert!(first["probability"].as_f64() > Some(0.95), "{changes:?}");
    assert!(first.to_string().contains("encoder_crosstalk"), "{first}");
    assert_eq!(first["targets"], serde_json::json!(["cable-3"]));
}
