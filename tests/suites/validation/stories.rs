//! Public bug reports of cable robots, re-created as data with the right answer. They are looked for next to the repository.
//!
//! An answer is right if the cause is named or listed, or the mistake is said, and no other cause is named.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tautline_core::diagnosis::{DrawingPattern, Finding, Verdict};
use tautline_core::estimation::Control;
use tautline_session::read_dataset;
use tautline_workflow::diagnosis::{Diagnosed, TIME_LIMIT_S, diagnose_dataset};

/// What a README says, as data.
#[derive(Debug, Clone, Copy)]
enum Right {
    /// Causes by effect and cables, counted from 1; an empty list stands for any cables.
    Causes(&'static [(&'static str, &'static [usize])]),
    /// Columns in which there is a mistake, beside which nothing is named but an offset.
    Mistake(&'static [&'static str]),
    /// Cable and poses at which it is slack.
    Slack(usize, &'static [i64]),
    /// The places of the pulleys.
    Drawing(Option<DrawingPattern>),
    /// Nothing is wrong, or nothing that these readings say.
    Nothing,
    /// Something remains, and one of these may be named.
    AtMost(&'static [&'static str]),
}

const BOTH: &[usize] = &[];

const STORIES: &[(&str, Right)] = &[
    (
        "01-mural-belt-zero",
        Right::Causes(&[("winch_offset", BOTH)]),
    ),
    (
        "03-maslow-chain-pitch",
        Right::Causes(&[("winch_scale_common", BOTH)]),
    ),
    ("05-webcontrol-anchors-tight-prior", Right::Drawing(None)),
    (
        "06-penplotter-width",
        Right::Drawing(Some(DrawingPattern::Extent(0))),
    ),
    (
        "07-maslow-chain-tolerance-sign",
        Right::Causes(&[("winch_scale", &[1])]),
    ),
    ("09-maslow4-extension-1m", Right::Mistake(&["length_4_m"])),
    (
        "10-maslow4-upside-down",
        Right::Mistake(&["length_1_m", "length_2_m", "length_3_m", "length_4_m"]),
    ),
    ("11-maslow4-raised-z", Right::Nothing),
    (
        "11b-maslow4-raised-z-unrecorded",
        Right::Causes(&[("cable_slip", &[1, 2, 3, 4])]),
    ),
    (
        "13-maslow-banner-scale",
        Right::Causes(&[("tracker_scale", BOTH)]),
    ),
    (
        "15-maslow-frame-flex",
        Right::Causes(&[("frame_compliance", BOTH)]),
    ),
    (
        "17-encoder-1000-for-1024",
        Right::Causes(&[("winch_scale", &[5])]),
    ),
    ("19-encoder-15-16", Right::Causes(&[("winch_scale", &[5])])),
    ("21-microsteps-factor-2", Right::Mistake(&["rev_2"])),
    (
        "22-two-pairs-exchanged",
        Right::Mistake(&["rev_1", "rev_2", "rev_3", "rev_4"]),
    ),
    (
        "23-hangprinter-tilt-spool",
        Right::Causes(&[("drum_growth", &[5])]),
    ),
    ("24-encoder-cable-off", Right::Mistake(&["rev_6"])),
    ("25-lost-turn-twice", Right::Mistake(&["rev_4"])),
    ("27-maslow4-slack-belt", Right::Slack(2, &[3, 4, 5, 6])),
    (
        "29-maslow4-one-pair-swapped",
        Right::Mistake(&["length_1_m", "length_4_m"]),
    ),
    ("31-stewart-leg-homing", Right::Nothing),
    (
        "33-maslow4-retracted-belts",
        Right::Causes(&[("cable_slip", &[1, 2, 3, 4])]),
    ),
    (
        "35-maslow-chain-tolerance-3145",
        Right::Causes(&[("winch_scale_common", BOTH)]),
    ),
    (
        "36-tape-misread-one",
        Right::Causes(&[("tracker_outlier", BOTH)]),
    ),
    (
        "37-camera-bumped",
        Right::Causes(&[("tracker_moved", BOTH)]),
    ),
    ("38-top-left-y-down", Right::Mistake(&["meas_y_m"])),
    (
        "38c-frame-shifted",
        Right::Mistake(&["meas_x_m", "meas_y_m"]),
    ),
    (
        "39-hangprinter-config-g",
        Right::Causes(&[("drum_growth", BOTH), ("winch_scale", BOTH)]),
    ),
    (
        "41-real-maslow-optical-thin",
        Right::AtMost(&[
            "winch_offset",
            "winch_scale",
            "winch_scale_common",
            "tracker_scale",
            "tracker_axes",
        ]),
    ),
    ("43-real-maslow4-pr427", Right::AtMost(&[])),
    ("45-mini-home-6mm-low", Right::Nothing),
    (
        "46-hall-slack-cable-3",
        Right::Slack(3, &[4, 24, 26, 29, 38]),
    ),
    ("47-suspended-sound", Right::Nothing),
    ("48-planar-no-z", Right::Causes(&[("winch_offset", BOTH)])),
];

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

/// Effect and cables, counted from 1.
fn causes(finding: &Finding) -> impl Iterator<Item = (&'static str, Vec<usize>)> {
    finding.causes().map(|cause| {
        let cables = cause.cables().into_iter().map(|cable| cable + 1);
        (cause.effect().id(), cables.collect())
    })
}

/// What is wrong with an answer; empty if it is right.
fn faults(told: &Diagnosed, right: Right) -> String {
    let findings = &told.diagnosis.findings;
    let named: Vec<(&str, Vec<usize>)> = findings
        .iter()
        .filter(|finding| finding.verdict() == Verdict::Named)
        .flat_map(causes)
        .collect();
    let listed: Vec<(&str, Vec<usize>)> = findings.iter().flat_map(causes).collect();
    let is = |(id, cables): &(&str, Vec<usize>), wanted: &(&str, &[usize])| {
        *id == wanted.0 && (wanted.1.is_empty() || cables == wanted.1)
    };
    let said: Vec<&str> = told
        .mistakes
        .iter()
        .flat_map(|one| &one.columns)
        .map(String::as_str)
        .collect();
    let allowed = |effects: &[&str]| named.iter().all(|(id, _)| effects.contains(id));
    let is_right = match right {
        Right::Causes(wanted) => {
            wanted
                .iter()
                .all(|wanted| listed.iter().any(|one| is(one, wanted)))
                && named
                    .iter()
                    .all(|one| wanted.iter().any(|wanted| is(one, wanted)))
                && said.is_empty()
        }
        Right::Mistake(columns) => {
            columns.iter().all(|column| said.contains(column))
                && allowed(&["winch_offset", "cable_swap"])
        }
        Right::Slack(cable, poses) => {
            let slack = told.diagnosis.slack.as_ref();
            slack.is_some_and(|slack| slack.cable + 1 == cable && slack.poses == poses)
                && allowed(&[])
        }
        Right::Drawing(pattern) => {
            let drawing = told.diagnosis.drawing.as_ref();
            drawing.is_some_and(|found| pattern.is_none_or(|p| p == found.pattern)) && allowed(&[])
        }
        Right::Nothing => {
            findings.is_empty() && told.diagnosis.drawing.is_none() && said.is_empty()
        }
        Right::AtMost(effects) => allowed(effects),
    };
    match is_right {
        true => String::new(),
        false => format!(
            "{:?}, {:?}, mistakes {said:?}, expected {right:?}",
            named, listed
        ),
    }
}

#[test]
fn stories_get_the_right_answer() {
    let Some(folder) = folder() else {
        return;
    };
    let wrong: Vec<String> = STORIES
        .iter()
        .map(|(name, right)| (name, faults(&told(&folder.join(name)), *right)))
        .filter(|(_, faults)| !faults.is_empty())
        .map(|(name, faults)| format!("{name}: {faults}"))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let there = std::fs::read_dir(&folder).expect("a folder").count();
    assert_eq!(there, STORIES.len(), "a story has no answer here");
}
