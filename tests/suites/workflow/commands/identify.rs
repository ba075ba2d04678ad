//! simulate, identify, evaluate.

use serde_json::Value;
use tautline_session::read_robot;

use super::program::{Answer, Folder, assert_number, assert_valid, number, tautline};

fn simulate(folder: &Folder, robot: &str, poses: u32, more: &[&str]) -> String {
    let dataset = folder.join("data");
    let poses = poses.to_string();
    let mut arguments = vec!["simulate", "--robot", robot, "--poses", &poses];
    arguments.extend(["--seed", "7", "--out", &dataset]);
    arguments.extend(more);
    tautline(&arguments).succeeded();
    dataset
}

fn identify(dataset: &str, more: &[&str]) -> Answer {
    let mut arguments = vec!["identify", dataset, "--json", "-"];
    arguments.extend(more);
    tautline(&arguments).succeeded()
}

fn evaluate(dataset: &str, model: &str) -> Value {
    let arguments = ["evaluate", dataset, "--model", model, "--json", "-"];
    tautline(&arguments).succeeded().json()
}

/// Root mean square distance of entry points from the true ones (m).
fn error_m(points: &Value, truth: &Value) -> f64 {
    let cables = truth["cables"].as_array().expect("cables");
    let square = |(k, cable): (usize, &Value)| -> f64 {
        let axis = |axis: usize| {
            let found = points[k][axis].as_f64().expect("a number");
            found - number(cable, &format!("/pulley/entry_point_m/{axis}"))
        };
        (0..3).map(|k| axis(k).powi(2)).sum()
    };
    let squares: f64 = cables.iter().enumerate().map(square).sum();
    (squares / cables.len() as f64).sqrt()
}

fn entry_points(robot: &Value) -> Value {
    let cables = robot["cables"].as_array().expect("cables").iter();
    cables
        .map(|cable| cable["pulley"]["entry_point_m"].clone())
        .collect()
}

#[test]
fn simulated_entry_points_are_found_and_hold_in_evaluation() {
    let folder = Folder::new();
    let dataset = simulate(&folder, "mini", 25, &[]);
    let (json, model) = (folder.join("result.json"), folder.join("model.json"));
    let answer =
        tautline(&["identify", &dataset, "--json", &json, "--model-out", &model]).succeeded();
    assert!(answer.stdout.contains("joint method converged"));
    assert!(answer.stdout.contains("cable-8"));
    let result = folder.json("result.json");
    assert_valid(&result);
    assert_eq!(result["format"], "tautline-identification");
    assert!(number(&result, "/p_value") > 1e-3);
    let truth = folder.json("data/truth.json");
    let drawing = error_m(&entry_points(&folder.json("data/robot.json")), &truth);
    let found = error_m(&result["entry_points_m"], &truth);
    assert!(found < 0.5 * drawing, "{found} m, drawing {drawing} m");

    assert_valid(&folder.json("model.json"));
    let evaluation = evaluate(&dataset, &model);
    assert_valid(&evaluation);
    assert!(number(&evaluation, "/p_value") > 1e-3);
    assert!(number(&evaluation, "/chi2") < number(&result, "/chi2") + 1.0);
    assert_eq!(evaluation["entry_points_m"], result["entry_points_m"]);
    assert_eq!(evaluation["entry_points_sd_m"][0][0], 0.0);
    assert_eq!(evaluation["poses"].as_array().expect("poses").len(), 26);
}

/// Results are written all the same, and say so.
#[test]
fn a_fit_that_does_not_converge_has_an_exit_code_of_its_own() {
    let folder = Folder::new();
    let dataset = simulate(&folder, "mini", 12, &[]);
    let mut robot = folder.json("data/robot.json");
    // A valid number, with which the squares of residuals are not finite.
    robot["laser"]["sd_m"] = 1e-160.into();
    folder.write("data/robot.json", &robot.to_string());
    let answer = tautline(&["identify", &dataset]);
    assert_eq!(answer.code, Some(3), "{}", answer.stderr);
    assert!(
        answer
            .stdout
            .lines()
            .next()
            .is_some_and(|line| line.contains("did NOT converge")),
        "{}",
        answer.stdout
    );
    assert!(
        answer.stderr.contains("did not converge"),
        "{}",
        answer.stderr
    );
    let answer = tautline(&["identify", &dataset, "--json", "-"]);
    assert_eq!(answer.code, Some(3), "{}", answer.stderr);
    assert_eq!(answer.json()["converged"], false);
    let help = tautline(&["--help"]).succeeded();
    assert!(
        help.stdout
            .contains("3 identify or evaluate did not converge"),
        "{}",
        help.stdout
    );
}

#[test]
fn every_preset_is_identified() {
    for (preset, cables) in [("mini", 8), ("hall", 8), ("suspended", 8), ("planar", 4)] {
        let folder = Folder::new();
        let dataset = simulate(&folder, preset, 15, &[]);
        let result = identify(&dataset, &[]).json();
        assert_eq!(result["converged"], true, "{preset}");
        let points = result["entry_points_m"].as_array().expect("points");
        assert_eq!(points.len(), cables, "{preset}");
        assert!(number(&result, "/p_value") > 1e-4, "{preset}");
        let truth = folder.json("data/truth.json");
        let drawing = error_m(&entry_points(&folder.json("data/robot.json")), &truth);
        let found = error_m(&result["entry_points_m"], &truth);
        assert!(found < drawing, "{preset}: {found} m, drawing {drawing} m");
    }
}

#[test]
fn every_method_is_identified_in_its_name() {
    let folder = Folder::new();
    let dataset = simulate(&folder, "mini", 12, &[]);
    for method in ["joint", "simple", "published"] {
        let result = identify(&dataset, &["--method", method, "--repeat", "2"]).json();
        assert_valid(&result);
        assert_eq!(result["method"], method);
        assert!(number(&result, "/seconds") > 0.0);
    }
}

#[test]
fn what_the_published_method_lacks_is_refused() {
    let folder = Folder::new();
    let dataset = simulate(&folder, "mini", 12, &[]);
    for (option, lacks) in [
        (&["--effect", "winch_scale"][..], "no effects"),
        (&["--robust"], "no weights"),
        (&["--values", "-"], "no standard deviations"),
    ] {
        let words = [&["identify", &dataset, "--method", "published"], option].concat();
        tautline(&words).refused(&[option[0], lacks]);
    }
}

#[test]
fn a_hidden_effect_is_found_when_freed() {
    let folder = Folder::new();
    let hidden = ["--effect", "winch_scale:cable-3:scale=0.01"];
    let dataset = simulate(&folder, "mini", 25, &hidden);
    let blind = identify(&dataset, &[]).json();
    assert!(number(&blind, "/p_value") < 1e-4, "the base model explains");
    let model = folder.join("model.json");
    let freed = ["--effects", "winch_scale:cable-3", "--model-out", &model];
    let result = identify(&dataset, &freed).json();
    assert_valid(&result);
    assert_eq!(result["effects"][0]["effect"], "winch_scale");
    assert_eq!(result["effects"][0]["targets"][0], "cable-3");
    let sd = number(&result, "/effects/0/sd");
    assert!(sd > 0.0 && sd < 0.002, "sd {sd}");
    assert_number(&result, "/effects/0/value", 0.01, 5.0 * sd);
    assert!(number(&result, "/p_value") > 1e-4);

    let robot = read_robot(model.as_ref()).expect("a model").value;
    assert_eq!(robot.effects.len(), 1);
    let value = number(&result, "/effects/0/value");
    assert_eq!(robot.effects[0].parameters["scale"], value);
    let mut without = folder.json("model.json");
    without
        .as_object_mut()
        .expect("an object")
        .remove("effects");
    let without = folder.write("without.json", &without.to_string());
    let p_value = |model: &str| number(&evaluate(&dataset, model), "/p_value");
    assert!(p_value(&model) > 1e-4);
    assert!(p_value(&folder.join("data/truth.json")) > 1e-4);
    assert!(p_value(&without) < 1e-4);
}

#[test]
fn the_same_seed_makes_the_same_files() {
    let (one, two) = (Folder::new(), Folder::new());
    for folder in [&one, &two] {
        simulate(folder, "planar", 5, &[]);
    }
    for name in ["robot.json", "poses.csv", "truth.json"] {
        let read = |folder: &Folder| std::fs::read(folder.path().join("data").join(name));
        assert_eq!(read(&one).expect(name), read(&two).expect(name));
    }
}

#[test]
fn every_effect_of_the_catalogue_is_listed() {
    let list = tautline(&["effects"]).succeeded().stdout;
    for effect in tautline_core::effect::CATALOGUE {
        let listed = list
            .lines()
            .any(|line| line.split_whitespace().next() == Some(effect.id()));
        assert!(listed, "{}", effect.id());
    }
}

#[test]
fn statistics_are_written_reading_by_reading_and_value_by_value() {
    let folder = Folder::new();
    let dataset = simulate(&folder, "mini", 15, &[]);
    let (readings, values) = (folder.join("readings.csv"), folder.join("values.csv"));
    let written = ["--statistics", &readings, "--values", &values];
    let result = identify(&dataset, &written).json();
    let table = |path: &str| -> Vec<Vec<String>> {
        let text = std::fs::read_to_string(path).expect("a table");
        let cells = |line: &str| line.split(',').map(str::to_owned).collect();
        text.lines().map(cells).collect()
    };
    let (readings, values) = (table(&readings), table(&values));
    assert_eq!(readings[0][5], "redundancy");
    // 15 poses and home: lengths, tensions and the laser, at home no lengths.
    assert_eq!(readings.len(), 1 + 15 * 17 + 9);
    // Redundancies of equations and priors are not in the table.
    let sum: f64 = readings[1..]
        .iter()
        .map(|line| line[5].parse::<f64>().expect("a number"))
        .sum();
    let freedom = number(&result, "/dof");
    assert!(sum > 0.3 * freedom && sum < freedom, "{sum} of {freedom}");
    let x = values
        .iter()
        .find(|line| line[0] == "cable-3 entry point x")
        .expect("there");
    assert_number(
        &result,
        "/entry_points_m/2/0",
        x[3].parse().expect("a number"),
        1e-12,
    );
    let refused = [
        "identify",
        &dataset,
        "--method",
        "published",
        "--values",
        "x.csv",
    ];
    let answer = tautline(&refused);
    assert_eq!(answer.code, Some(2));
    assert!(
        answer.stderr.contains("standard deviations"),
        "{}",
        answer.stderr
    );
}

/// Commands that take a dataset also take a session, with its method and effects.
#[test]
fn sessions_are_taken_wherever_datasets_are() {
    let folder = Folder::new();
    let sample = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../sessions/mini-winch-scale/session.json"
    );
    let mut session: Value =
        serde_json::from_slice(&std::fs::read(sample).expect("a session")).expect("JSON");
    session["settings"]["identification"]["effects"] =
        serde_json::json!([{"effect": "winch_scale", "targets": ["cable-3"], "parameters": {}}]);
    let session = folder.write("session.json", &session.to_string());
    let model = folder.join("model.json");
    let document = identify(&session, &["--model-out", &model]).json();
    assert!(number(&document, "/p_value") > 1e-3);
    assert_eq!(document["effects"][0]["effect"], "winch_scale");
    // The deviations of the parts, which the session's robot may have, are held at their identified values.
    let evaluated = evaluate(&session, &model);
    assert!(number(&evaluated, "/p_value") > 1e-3);
    assert!((number(&evaluated, "/chi2") / number(&document, "/chi2") - 1.0).abs() < 0.3);
    assert_eq!(tautline(&["check", &session]).code, Some(0));
    let values = tautline(&["export", &session, "--table", "values", "-o", "-"]).succeeded();
    assert!(values.stdout.contains("Winch scale"), "{}", values.stdout);
    let dataset = simulate(&folder, "mini", 20, &[]);
    for subject in [&session, &dataset] {
        let (text, table) = (folder.join("out.st"), folder.join("out.csv"));
        let files = ["--structured-text", &text, "--csv", &table, "--replace"];
        tautline(&[&["adjust", subject][..], &files].concat()).succeeded();
        let exported = tautline(&["export", subject, "--for", "structured-text"]).succeeded();
        let written = std::fs::read_to_string(&text).expect("constants");
        assert_eq!(written.trim_end(), exported.stdout.trim_end());
        let table = std::fs::read_to_string(&table).expect("a table");
        assert!(table.starts_with("name,unit,controller,identified,difference,sd"));
    }
    // Options for a controller are refused without one.
    let table = folder.join("unarmed.csv");
    for more in [
        &[][..],
        &["--csv", &table, "--arm"],
        &["--csv", &table, "--roll-back"],
    ] {
        tautline(&[&["adjust", &dataset], more].concat()).refused(&["--controller: "]);
    }
}

/// Places of the platform in a table with true poses, by label.
fn true_places(folder: &Folder) -> Vec<(i64, [f64; 3])> {
    let table = std::fs::read_to_string(folder.join("data/poses.csv")).expect("a table");
    let mut lines = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let names = lines.next().expect("a header");
    let column = |name: &str| names.iter().position(|own| *own == name).expect("a column");
    let places = ["true_x_m", "true_y_m", "true_z_m"].map(column);
    let label = column("pose");
    let number = |text: &str| text.parse().expect("a number");
    lines
        .map(|cells| {
            let place = places.map(|column| number(cells[column]));
            (number(cells[label]) as i64, place)
        })
        .collect()
}

/// The distances are computed here from the true poses, to tenths of a millimetre as a tape is read.
#[test]
fn a_tape_tells_the_size_that_lengths_alone_do_not() {
    let folder = Folder::new();
    let path = folder.join("robot.json");
    tautline(&["new", "planar", "-o", &path]).succeeded();
    let mut robot = folder.json("robot.json");
    let fields = robot.as_object_mut().expect("an object");
    fields.remove("laser");
    fields.remove("limits");
    for cable in robot["cables"].as_array_mut().expect("cables") {
        cable["pulley"]["entry_point_sd_m"] = serde_json::json!([0.03, 0.03, 0.0]);
        cable["cable"] = serde_json::json!({});
        cable
            .as_object_mut()
            .expect("an object")
            .remove("force_sensor");
    }
    std::fs::write(&path, robot.to_string()).expect("written");
    let scale = 0.004;
    let effect = format!("winch_scale_common:scale={scale}");
    let more = ["--tolerances", "none", "--effect", &effect];
    let dataset = simulate(&folder, &path, 12, &more);
    let found = || {
        let result = identify(&dataset, &["--effects", "winch_scale_common"]).json();
        ["/effects/0/value", "/effects/0/sd"].map(|pointer| number(&result, pointer))
    };
    let [_, alone] = found();
    let places = true_places(&folder);
    let mut table = "pose_a,pose_b,distance_m,sd_m\n".to_owned();
    for ((a, from), (b, to)) in places.iter().zip(&places[3..]) {
        let squares = from.iter().zip(to).map(|(a, b)| (a - b).powi(2));
        let distance = squares.sum::<f64>().sqrt();
        table += &format!("{a},{b},{distance:.4},0.0002\n");
    }
    let path = folder.join("data/distances.csv");
    std::fs::write(&path, &table).expect("written");
    let [value, sd] = found();
    assert!(sd < 0.1 * alone, "{sd} instead of {alone}");
    // Five standard deviations: below 1e-6.
    assert!((value - scale).abs() < 5.0 * sd, "{value} ± {sd}");
    for (from, to, place) in [("1,4", "1,99", "pose_b"), (",0.0002", ",0", "sd_m")] {
        std::fs::write(&path, table.replacen(from, to, 1)).expect("written");
        tautline(&["identify", &dataset])
            .refused(&["distances.csv, line", &format!("column {place:?}")]);
    }
}
