//! plan: its poses, its predictions, and its refusals.

use super::program::{Folder, assert_valid, number, tautline};

#[test]
fn a_plan_is_written_in_the_order_of_measurement() {
    let folder = Folder::new();
    let out = folder.join("plan.csv");
    let arguments = [
        "plan",
        "mini",
        "--poses",
        "12",
        "--candidates",
        "300",
        "--seed",
        "4",
    ];
    let machine = [arguments.as_slice(), &["--out", &out, "--json", "-"]].concat();
    let answer = tautline(&machine).succeeded();
    assert_eq!(answer.stderr, "");
    let plan = answer.json();
    assert_valid(&plan);
    assert_eq!(plan["format"], "tautline-plan");
    assert_eq!(plan["version"], 1);
    assert_eq!(
        plan["entry_point_sd_after_m"].as_array().map(Vec::len),
        Some(13)
    );
    assert!(number(&plan, "/expected/mean_m") < number(&plan, "/random/mean_m"));
    assert!(number(&plan, "/expected/log_det") > number(&plan, "/random/log_det"));
    let text = std::fs::read_to_string(&out).expect("a file");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        (lines[0], lines.len()),
        ("pose,x_m,y_m,z_m,qw,qx,qy,qz", 13)
    );
    for (k, line) in lines[1..].iter().enumerate() {
        let cells: Vec<f64> = line
            .split(',')
            .map(|c| c.parse().expect("a number"))
            .collect();
        assert_eq!((cells.len(), cells[0]), (8, (k + 1) as f64));
        assert_eq!(cells[1], number(&plan, &format!("/poses/{k}/position_m/0")));
    }
    let readable = tautline(&arguments).succeeded().stdout;
    for part in [
        "12 poses for mini, chosen for the geometry",
        "cable-1 entry point x",
        "at random poses",
    ] {
        assert!(readable.contains(part), "{readable} lacks {part}");
    }
}

#[test]
fn impossible_plans_are_refused() {
    tautline(&["plan", "no-such-robot"]).refused(&["no-such-robot", "mini"]);
    tautline(&["plan", "mini", "--poses", "0"]).refused(&["--poses", "at least 1"]);
    tautline(&["plan", "mini", "--effects", "gremlins"])
        .refused(&["--effect gremlins", "unknown effect"]);
}

#[test]
fn a_plan_is_for_something_and_explains_itself() {
    let small = ["plan", "planar", "--poses", "8", "--candidates", "60"];
    let with = |more: &[&'static str]| [small.as_slice(), more].concat();
    let volume = [
        "--for",
        "accuracy",
        "--volume",
        "-0.2,0.2,-0.1,0.1,0,0",
        "--json",
        "-",
    ];
    let accuracy = tautline(&with(&volume)).succeeded().json();
    assert_valid(&accuracy);
    assert_eq!(accuracy["goal"], "accuracy");
    let faults = tautline(&with(&["--for", "faults", "--explain", "--json", "-"]))
        .succeeded()
        .json();
    assert_valid(&faults);
    assert_eq!(faults["goal"], "faults");
    let shown = faults["isolability"]["faults"].as_array().expect("faults");
    assert!(shown.iter().all(|fault| {
        fault["detection"]
            .as_f64()
            .is_some_and(|p| (0.0..=1.0).contains(&p))
    }));
    let text = tautline(&with(&["--for", "both", "--explain"]))
        .succeeded()
        .stdout;
    for part in [
        "chosen for geometry and faults",
        "could be confused with",
        "Winch scale of cable-1",
    ] {
        assert!(text.contains(part), "{text} lacks {part}");
    }
    tautline(&with(&["--for", "accuracy"])).refused(&["--volume", "X0,X1,Y0,Y1,Z0,Z1"]);
    tautline(&with(&["--for", "accuracy", "--volume", "1,0,0,1,0,1"]))
        .refused(&["--volume", "found \"1,0,0,1,0,1\""]);
}

#[test]
fn what_cannot_be_checked_is_said() {
    let folder = Folder::new();
    let robot = folder.join("robot.json");
    tautline(&["new", "mini", "-o", &robot]).succeeded();
    let text = std::fs::read_to_string(&robot).expect("a robot");
    let mut json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    json["platform"]
        .as_object_mut()
        .expect("a platform")
        .remove("mass_kg");
    std::fs::write(&robot, json.to_string()).expect("written");
    let said = "Nothing checks before a motion whether the cables can hold the platform: robot.json states no mass.";
    let plan = ["plan", &robot, "--poses", "9", "--candidates", "60"];
    let planned = tautline(&plan).succeeded();
    assert!(planned.stdout.contains(said), "{}", planned.stdout);
    let json = tautline(&[&plan[..], &["--json", "-"]].concat())
        .succeeded()
        .json();
    assert_eq!(json["unchecked_tensions"], said);
    let file = folder.join("s.json");
    let sim = ["--controller", "sim", "--arm"];
    let measure = ["measure", &file, "--robot", &robot, "--poses", "9"];
    let driven = tautline(&[&measure[..], &sim].concat());
    assert!(driven.stderr.contains(said), "{}", driven.stderr);
}
