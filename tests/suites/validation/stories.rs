//! Public bug reports of cable robots, re-created as data with the right answer, in a folder next to the repository.
//!
//! An answer is right if the cause is named or listed, or the mistake is reported, and no other cause is named. No part may be far
//! outside its tolerance in the model without being a cause.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tautline_core::diagnosis::{DrawingPattern, Finding};
use tautline_core::estimation::{Control, Parameter, ParameterId};
use tautline_session::read_dataset;
use tautline_validation::tables::field::answer::{Answer, Right, judged};
use tautline_workflow::diagnosis::{Diagnosed, TIME_LIMIT_S, diagnose_dataset};

/// The right answer of each README.
fn stories() -> Vec<(&'static str, Right)> {
    let both = Vec::new;
    vec![
        (
            "01-mural-belt-zero",
            Right::Causes(vec![("winch_offset", both())]),
        ),
        (
            "03-maslow-chain-pitch",
            Right::Causes(vec![("winch_scale_common", both())]),
        ),
        ("05-webcontrol-anchors-tight-prior", Right::Drawing(None)),
        (
            "06-penplotter-width",
            Right::Drawing(Some(DrawingPattern::Extent(0))),
        ),
        (
            "07-maslow-chain-tolerance-sign",
            Right::Causes(vec![("winch_scale", vec![1])]),
        ),
        ("09-maslow4-extension-1m", mistake(&["length_4_m"])),
        (
            "10-maslow4-upside-down",
            mistake(&["length_1_m", "length_2_m", "length_3_m", "length_4_m"]),
        ),
        ("11-maslow4-raised-z", Right::Nothing),
        (
            "11b-maslow4-raised-z-unrecorded",
            Right::Causes(vec![("cable_slip", vec![1, 2, 3, 4])]),
        ),
        (
            "13-maslow-banner-scale",
            Right::Causes(vec![("tracker_scale", both())]),
        ),
        (
            "15-maslow-frame-flex",
            Right::Causes(vec![("frame_compliance", both())]),
        ),
        (
            "17-encoder-1000-for-1024",
            Right::Causes(vec![("winch_scale", vec![5])]),
        ),
        (
            "19-encoder-15-16",
            Right::Causes(vec![("winch_scale", vec![5])]),
        ),
        ("21-microsteps-factor-2", mistake(&["rev_2"])),
        (
            "22-two-pairs-exchanged",
            mistake(&["rev_1", "rev_2", "rev_3", "rev_4"]),
        ),
        (
            "23-hangprinter-tilt-spool",
            Right::Causes(vec![("drum_growth", vec![5])]),
        ),
        ("24-encoder-cable-off", mistake(&["rev_6"])),
        ("25-lost-turn-twice", mistake(&["rev_4"])),
        ("27-maslow4-slack-belt", Right::Slack(2, vec![3, 4, 5, 6])),
        (
            "29-maslow4-one-pair-swapped",
            mistake(&["length_1_m", "length_4_m"]),
        ),
        ("31-stewart-leg-homing", Right::Nothing),
        (
            "33-maslow4-retracted-belts",
            Right::Causes(vec![("cable_slip", vec![1, 2, 3, 4])]),
        ),
        (
            "35-maslow-chain-tolerance-3145",
            Right::Causes(vec![("winch_scale_common", both())]),
        ),
        (
            "36-tape-misread-one",
            Right::Causes(vec![("tracker_outlier", both())]),
        ),
        (
            "37-camera-bumped",
            Right::Causes(vec![("tracker_moved", both())]),
        ),
        ("38-top-left-y-down", mistake(&["meas_y_m"])),
        ("38c-frame-shifted", mistake(&["meas_x_m", "meas_y_m"])),
        (
            "39-hangprinter-config-g",
            Right::Causes(vec![("drum_growth", both()), ("winch_scale", both())]),
        ),
        (
            "41-real-maslow-optical-thin",
            Right::AtMost(vec![
                "winch_offset",
                "winch_scale",
                "winch_scale_common",
                "tracker_scale",
                "tracker_axes",
            ]),
        ),
        ("43-real-maslow4-pr427", Right::AtMost(vec![])),
        ("45-mini-home-6mm-low", Right::Nothing),
        (
            "46-hall-slack-cable-3",
            Right::Slack(3, vec![4, 24, 26, 29, 38]),
        ),
        ("47-suspended-sound", Right::Nothing),
        (
            "48-planar-no-z",
            Right::Causes(vec![("winch_offset", both())]),
        ),
    ]
}

fn mistake(columns: &[&str]) -> Right {
    Right::Mistake(columns.iter().map(|column| (*column).to_owned()).collect())
}

fn folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/stories");
    if folder.exists() {
        return Some(folder);
    }
    println!("ABSENT: the stories are not beside this repository; nothing was compared");
    None
}

fn told(folder: &Path) -> Diagnosed {
    let dataset = read_dataset(folder).expect("a dataset").dataset;
    let options = (0.01, TIME_LIMIT_S);
    diagnose_dataset(Arc::new(dataset), options, &mut |_| Control::Continue).expect("a diagnosis")
}

/// Standard deviations of its prior from which a part is outside its tolerance.
const OUTSIDE: f64 = 4.0;

/// Parts outside their tolerances in the reported model that no finding has among its causes.
fn parts_in_no_finding(told: &Diagnosed) -> Vec<String> {
    let diagnosis = &told.diagnosis;
    let solution = &diagnosis.extended_solution;
    let all = &solution.globals.deviations;
    let held = all.len() - solution.deviation_count();
    let part = |p: &Parameter| {
        let ParameterId::Deviation {
            deviation,
            parameter,
        } = p.id
        else {
            return None;
        };
        let bound = &all[held + deviation];
        let value = bound.values[parameter] - bound.effect.parameters()[parameter].neutral;
        let ratio = value.abs() / p.prior_sd?;
        let causes = diagnosis.findings.iter().flat_map(Finding::causes);
        let is_found = causes
            .into_iter()
            .any(|one| std::ptr::eq(one.effect(), bound.effect));
        (ratio > OUTSIDE && !is_found).then(|| format!("{}: {ratio:.1}", p.name))
    };
    solution.parameters.iter().filter_map(part).collect()
}

#[test]
fn stories_get_the_right_answer() {
    let Some(folder) = folder() else {
        return;
    };
    let stories = stories();
    let mut wrong = Vec::new();
    for (name, right) in &stories {
        let told = told(&folder.join(name));
        let answer = judged(&told, right);
        if !matches!(answer, Answer::Right | Answer::Listed) {
            wrong.push(format!("{name}: {answer:?}, expected {right:?}"));
        }
        let parts = parts_in_no_finding(&told);
        wrong.extend(
            parts
                .iter()
                .map(|part| format!("{name}: in no finding: {part}")),
        );
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let there = std::fs::read_dir(&folder).expect("a folder").count();
    assert_eq!(there, stories.len(), "a story has no answer here");
}
