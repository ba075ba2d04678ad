//! `measure --until`: poses are decided on one by one, also by a run that is killed, and impossible requests are refused.

use std::path::Path;
use std::time::Instant;

use tautline_core::geometry::Pose;
use tautline_core::sequential::NextStep;
use tautline_session::PlannedPose;
use tautline_validation::generators::hypotheses;
use tautline_validation::support::decisions::check_decisions;
use tautline_workflow::sequential::{UntilRequest, planned_label};

use super::{beside, killed, session};
use crate::commands::program::{Folder, assert_valid, tautline};

const GOAL: &str = "accuracy=2.4mm";

fn arguments(file: &str) -> [&str; 11] {
    [
        "measure",
        file,
        "--controller",
        "sim",
        "--robot",
        "mini",
        "--until",
        GOAL,
        "--at-most",
        "40",
        "--arm",
    ]
}

fn request() -> UntilRequest {
    UntilRequest {
        goals: vec![GOAL.parse().expect("a goal")],
        at_most: 40,
        seed: 1,
        among: None,
    }
}

#[test]
fn a_goal_ends_the_run_and_every_pose_has_its_reason() {
    let folder = Folder::new();
    let file = folder.join("run.json");
    let answer = tautline(&[&arguments(&file)[..], &["--json", "-"]].concat()).succeeded();
    let document = answer.json();
    assert_valid(&document);
    assert_eq!(document["end"], "decided");
    assert_eq!(document["until"]["end"], "reached");
    assert_eq!(document["until"]["goals"][0]["goal"], GOAL);
    assert_eq!(document["until"]["goals"][0]["reached"], true);
    let poses = document["until"]["poses"].as_array().expect("poses");
    let measured = document["measured"].as_array().expect("labels");
    assert_eq!(measured.len(), poses.len() + 1, "home and the poses chosen");
    assert!(poses.len() > 8 && poses.len() < 40, "{}", poses.len());
    assert_eq!(
        poses[0]["reason"],
        "is one of the 8 poses that fix the geometry"
    );
    let last = poses[poses.len() - 1]["reason"].as_str().expect("a reason");
    assert!(last.starts_with("narrows the pulley of cable-"), "{last}");
    let label = &poses[poses.len() - 1]["pose"];
    assert!(
        answer
            .stderr
            .contains(&format!("next: pose {label} {last}"))
    );
    let ended = session(&file);
    let log = ended.log();
    let told = format!("Pose {label} was chosen: it {last}.");
    assert!(log.iter().any(|entry| entry.text == told));
    let ended = log.last().expect("an entry");
    assert!(ended.text.contains("all goals reached"), "{}", ended.text);
    // The goal is reached, so that the same command measures nothing more.
    let again = tautline(&[&arguments(&file)[..], &["--json", "-"]].concat()).succeeded();
    assert_eq!(again.json()["measured_now"], serde_json::json!([]));
}

#[test]
fn a_killed_run_goes_on_with_the_same_decisions() {
    let folder = Folder::new();
    let begun = Instant::now();
    tautline(&arguments(&folder.join("whole.json"))).succeeded();
    let takes = begun.elapsed();
    let file = folder.join("run.json");
    let words = arguments(&file);
    let mut kills = 0;
    let mut told = String::new();
    for share in [0.4, 0.6, 0.7] {
        let (text, ran) = killed(&words, |elapsed| elapsed >= takes.mul_f64(share));
        kills += usize::from(ran);
        told.push_str(&text);
        if Path::new(&file).exists() {
            session(&file);
        }
    }
    let answer = tautline(&words).succeeded();
    told.push_str(&answer.stderr);
    let measured = session(&file);
    let labels = &measured.measurements.labels;
    let mut once = labels.clone();
    once.sort_unstable();
    once.dedup();
    assert_eq!(once.len(), labels.len(), "a pose is measured twice");
    let on_disk = told.lines().filter(|line| line.contains(" is on disk"));
    assert!(on_disk.count() <= labels.len(), "a reported pose is lost");
    assert_eq!(measured.audit(), []);
    assert!(beside(&file).is_empty());
    assert!(kills > 0, "no kill came in time");
    let last = check_decisions(&measured, &request());
    assert!(matches!(last.step, NextStep::Reached), "{:?}", last.step);
}

#[test]
fn a_hypothesis_takes_part() {
    let folder = Folder::new();
    let page = std::fs::read_to_string(hypotheses::page()).expect("the page");
    for (name, content) in hypotheses::files(&page) {
        folder.write(&name, &content);
    }
    let file = folder.join("run.json");
    let hypothesis = folder.join("crosstalk.toml");
    let effect = "encoder_crosstalk:cable-3:share=0.01";
    let answer = tautline(&[
        "measure",
        &file,
        "--controller",
        "sim",
        "--robot",
        "mini",
        "--hypothesis",
        &hypothesis,
        "--effect",
        effect,
        "--until",
        "cause=80%",
        "--at-most",
        "30",
        "--arm",
        "--json",
        "-",
    ]);
    let document = answer.json();
    let sets = document["until"]["sets"].as_array().expect("sets");
    let first = sets[0]["causes"].as_str().expect("causes");
    assert!(first.to_lowercase().contains("crosstalk"), "{sets:?}");
    assert!(first.contains("cable-3"), "{sets:?}");
}

#[test]
fn what_cannot_be_decided_is_refused_before_the_robot_moves() {
    let folder = Folder::new();
    let file = folder.join("run.json");
    let with = |more: &[&str]| {
        let begin = ["measure", &file, "--controller", "sim", "--robot", "mini"];
        tautline(&[&begin[..], more, &["--arm"]].concat())
    };
    for (more, parts) in [
        (&["--until", "accuracy=0.3"][..], ["\"0.3\"", "0.3mm"]),
        (&["--until", "cause=95"], ["\"95\"", "95%"]),
        (
            &["--until", "cause=95%", "--at-most", "0"],
            ["--at-most", "at least 1"],
        ),
        (
            &["--until", "cause=95%", "--stop-at", "1"],
            ["--until", "--stop-at"],
        ),
        (&["--at-most", "20"], ["--at-most", "--until"]),
    ] {
        let answer = with(more);
        assert_eq!(answer.code, Some(2), "{more:?}: {}", answer.stderr);
        assert!(
            parts.iter().all(|part| answer.stderr.contains(part)),
            "{}",
            answer.stderr
        );
    }
    assert!(!Path::new(&file).exists());
    let data = folder.join("data");
    tautline(&["simulate", "--robot", "mini", "--poses", "5", "-o", &data]).succeeded();
    let replay = format!("replay:{data}");
    tautline(&[
        "measure",
        &file,
        "--controller",
        &replay,
        "--until",
        "cause=95%",
        "--arm",
    ])
    .refused(&["--until", "a recording, which cannot go to new poses"]);
}

#[test]
fn a_pose_that_was_decided_on_keeps_its_label() {
    let folder = Folder::new();
    let file = folder.join("run.json");
    tautline(&arguments(&file)).succeeded();
    let mut measured = session(&file);
    let next = Pose::from_parts([0.01, 0.02, 0.03], [1.0, 0.0, 0.0, 0.0]);
    let label = planned_label(&mut measured, &next);
    assert!(!measured.measurements.labels.contains(&label));
    assert_eq!(measured.plan.last(), Some(&PlannedPose::new(label, &next)));
    let plan = measured.plan.clone();
    assert_eq!(planned_label(&mut measured, &next), label);
    assert_eq!(measured.plan, plan);
}
