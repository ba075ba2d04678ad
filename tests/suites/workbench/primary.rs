//! The primary button of phase 4: it is there in every state, alone it leads to the true causes, and it never leads past a
//! red sign.

use std::collections::BTreeSet;

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_core::diagnosis::{
    Cause, ErrorForm, Finding, Quantity, ReadingId, Subject, UnmodelledError, Variable,
};
use tautline_core::effect::{BoundEffect, Effect, EffectSetting, find};
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_session::{Session, Timestamp, read_session, write_session};
use tautline_validation::generators::sessions::RECIPES;
use tautline_workbench::model::command::{
    Command, FileCommand, IdentificationCommand, ViewCommand,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::next_step::{self, Action};
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::App;
use tautline_workflow::diagnosis::Diagnosed;
use tautline_workflow::identification::FitVerdict;
use tautline_workflow::samples::demo;

use crate::measured::{Measured, document, give, press};
use crate::red_signs::is_the_remedy;
use crate::support::{settle, type_into, workbench};

/// Poses of the plan of a demonstration.
const POSES: usize = 25;
/// Presses after which the button leads nowhere.
const MOST_PRESSES: usize = 8;

/// The primary button of phase 4.
fn action(harness: &Harness<'_, App>) -> Action {
    let model = &harness.state().state.model;
    let step = next_step::of(model, Phase::Identification, POSES).expect("a session");
    step.action.expect("a primary action")
}

/// Its title.
fn primary(harness: &Harness<'_, App>) -> String {
    action(harness).title
}

/// The effects that a primary button says are repaired.
fn repaired(harness: &Harness<'_, App>) -> Vec<EffectSetting> {
    match action(harness).commands.remove(0) {
        Command::File(FileCommand::NewSeries(effects)) => effects,
        _ => Vec::new(),
    }
}

/// Presses the primary button of phase 4 until it leads to another phase or series; returns its labels.
fn press_on(harness: &mut Harness<'_, App>) -> Vec<String> {
    give(
        harness,
        ViewCommand::Go(Screen::Phase(Phase::Identification)),
    );
    let mut pressed = Vec::new();
    while pressed.len() < MOST_PRESSES {
        is_the_remedy(harness, Phase::Identification);
        let title = primary(harness);
        if title.starts_with("Go to ") || title.ends_with("easure again") {
            break;
        }
        press(harness, &format!("Next: {title}"));
        pressed.push(title);
    }
    pressed
}

/// Effects with their cables, one by one: an effect on each cable is the same as one on all of them.
fn causes(effects: &[EffectSetting], cables: usize) -> BTreeSet<String> {
    let mut causes = BTreeSet::new();
    for id in effects.iter().map(|one| &one.effect) {
        let of_it = effects.iter().filter(|one| one.effect == *id);
        let targets: BTreeSet<_> = of_it.flat_map(|one| one.targets.clone()).collect();
        match targets.len() {
            0 => drop(causes.insert(id.clone())),
            all if all == cables => drop(causes.insert(id.clone())),
            _ => causes.extend(targets.iter().map(|cable| format!("{id} {cable}"))),
        }
    }
    causes
}

/// Fault of the model at the end; `None` if it explains the readings with these causes alone, or will after the repair.
fn wrong(harness: &Harness<'_, App>, truth: &[EffectSetting]) -> Option<String> {
    let open = document(harness);
    let model = &open.session().settings.identification.effects;
    let cables = open.session().robot.cable_count();
    let repaired = repaired(harness);
    let is_damage = |one: &EffectSetting| find(&one.effect).is_some_and(Effect::is_damage);
    let all: Vec<EffectSetting> = model.iter().chain(&repaired).cloned().collect();
    let (found, true_causes) = (causes(&all, cables), causes(truth, cables));
    let verdict = open.fit().map(|fit| FitVerdict::of(fit.solution.p_value()));
    let is_right = open.fit_is_current()
        && found == true_causes
        && truth.iter().filter(|one| is_damage(one)).count() == repaired.len()
        && (verdict == Some(FitVerdict::Adequate) || !repaired.is_empty());
    (!is_right).then(|| format!("{verdict:?} with {found:?} instead of {true_causes:?}"))
}

#[test]
fn alone_it_leads_from_every_sample_to_the_true_causes() {
    for recipe in RECIPES {
        let mut harness = workbench();
        let path = std::path::Path::new("sessions").join(recipe.file);
        give(&mut harness, FileCommand::Open(path));
        let pressed = press_on(&mut harness);
        let truth: Vec<EffectSetting> = recipe
            .hidden
            .iter()
            .map(|(effect, cable, _)| EffectSetting {
                effect: (*effect).to_owned(),
                targets: cable.iter().map(|cable| (*cable).to_owned()).collect(),
                parameters: Default::default(),
            })
            .collect();
        let wrong = wrong(&harness, &truth);
        assert_eq!(wrong, None, "{}: {pressed:?}", recipe.file);
    }
}

#[test]
fn alone_it_leads_from_an_error_without_a_name_to_a_pattern() {
    let measured = Measured::unnamed();
    let mut harness = measured.opened();
    let pressed = press_on(&mut harness);
    let asked = pressed
        .iter()
        .position(|title| title == "What does it look like?");
    let then = asked.and_then(|place| pressed.get(place + 1));
    let pattern = "Extend the model by the likeliest pattern";
    assert_eq!(then.map(String::as_str), Some(pattern), "{pressed:?}");
    let effects = &document(&harness).session().settings.identification.effects;
    assert!(effects.iter().any(|one| one.effect.starts_with("pattern_")));
    assert_eq!(primary(&harness), "Go to adjustment", "{pressed:?}");
}

/// A demonstration whose poses are measured, and its hidden effects.
fn measured_demo(seed: u64) -> (Session, Vec<EffectSetting>) {
    let mut session = demo(seed, Timestamp::from_unix_seconds(0)).expect("a session");
    let truth = &session.simulator.as_ref().expect("a virtual robot").truth;
    let preset = presets::find("mini").expect("a preset");
    let entry_points = truth.cables.iter().map(|c| c.pulley.entry_point_m);
    let options = SimulationOptions {
        geometry: TrueGeometry::EntryPoints(entry_points.collect()),
        effects: truth.effects.clone(),
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(POSES, seed)
    };
    let hidden = truth.effects.clone();
    let run = simulate(&session.robot, &options).expect("simulated");
    session.measurements = run.dataset.measurements;
    (session, hidden)
}

/// Whether the true cause is one of several alternatives, and the poses that separate them are planned.
fn is_listed(harness: &Harness<'_, App>, truth: &[EffectSetting]) -> bool {
    let diagnosed = document(harness).diagnosis().expect("a diagnosis");
    let is_true = |cause: &Cause| cause.effect().id() == truth[0].effect;
    let mut findings = diagnosed.diagnosis.findings.iter();
    let is_planned = primary(harness) == "Go to measuring";
    is_planned && findings.any(|finding| finding.causes().any(is_true))
}

/// One demonstration may need the poses that separate its cause from another.
#[test]
fn alone_it_leads_from_demonstrations_to_the_true_cause() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut missed, mut listed) = (Vec::new(), 0);
    for seed in 0..6 {
        let (session, truth) = measured_demo(seed);
        let path = folder.path().join(format!("demo-{seed}.json"));
        write_session(&path, &session).expect("written");
        let mut harness = workbench();
        give(&mut harness, FileCommand::Open(path));
        let pressed = press_on(&mut harness);
        if let Some(wrong) = wrong(&harness, &truth) {
            if is_listed(&harness, &truth) {
                listed += 1;
                continue;
            }
            missed.push(format!("{seed}: {wrong}, after {pressed:?}"));
        }
    }
    assert!(missed.is_empty() && listed <= 1, "{listed}, {missed:#?}");
}

/// Effect, target, and values of the parameters.
type Hidden = (&'static str, &'static str, &'static [(&'static str, f64)]);

/// The length readings of cable-3.
const LENGTH: (Quantity, Option<usize>) = (Quantity::Length, Some(2));

/// Two causes that are found by name.
const TWO: [Hidden; 2] = [
    ("winch_scale", "cable-3", &[("scale", 0.02)]),
    ("cable_slip", "cable-5", &[("step", 0.02), ("pose", 17.0)]),
];

/// The finding as it is reported if no effect explains the readings, of this kind.
fn without_cause(finding: &Finding, (quantity, cable): (Quantity, Option<usize>)) -> Finding {
    Finding {
        subject: Subject::UnmodelledError(UnmodelledError {
            readings: ReadingId {
                quantity,
                cable,
                component: None,
            },
            form: ErrorForm::Smooth(Variable::CableLength),
            rms: Some(0.001),
        }),
        parameters: Vec::new(),
        ..finding.clone()
    }
}

/// Replaces the findings of the diagnosis of the present model.
fn replace_findings(harness: &mut Harness<'_, App>, change: impl FnOnce(&mut Vec<Finding>)) {
    let open = harness.state_mut().state.model.open.as_mut();
    let open = open.expect("a session");
    let known = open.diagnosis().expect("a diagnosis");
    let mut diagnosis = known.diagnosis.clone();
    change(&mut diagnosis.findings);
    let (dataset, [alpha, seconds, limit_s]) = (
        known.dataset.clone(),
        [known.alpha, known.seconds, known.limit_s],
    );
    let changed = Diagnosed {
        mistakes: Vec::new(),
        measured: dataset.measurements.len(),
        dataset,
        diagnosis,
        alpha,
        seconds,
        limit_s,
        ended_at_limit: known.ended_at_limit,
    };
    let effects = open.session().settings.identification.effects.clone();
    open.set_diagnosis(changed.into(), open.inputs(), effects);
    harness.run_ok();
}

#[test]
fn every_state_has_one() {
    let measured = Measured::mini(40, &TWO);
    let mut harness = measured.opened();
    assert_eq!(primary(&harness), "Identify the pulleys");
    give(&mut harness, IdentificationCommand::Identify);
    assert_eq!(primary(&harness), "Diagnose model");
    give(&mut harness, IdentificationCommand::Diagnose);
    let lasting = "Add to model: Winch scale (cable-3)";
    assert_eq!(primary(&harness), lasting);
    press(&mut harness, lasting);
    // The diagnosis still proposes the other one, which happened only once.
    harness.get_by_label("In the model");
    assert_eq!(primary(&harness), "Repaired: measure again");
    assert_eq!(repaired(&harness)[0].effect, "cable_slip");
    press(
        &mut harness,
        "Add to model: Cable slip on the drum (cable-5, from pose 17)",
    );
    assert_eq!(primary(&harness), "Go to adjustment");
    give(&mut harness, Command::Undo);
    give(&mut harness, Command::Undo);
    assert_eq!(primary(&harness), lasting);
    give(&mut harness, Edit::Exclude(9));
    assert_eq!(primary(&harness), "Diagnose model");
    give(&mut harness, Command::Undo);
    replace_findings(&mut harness, |findings| {
        *findings = vec![without_cause(&findings[0], LENGTH)];
    });
    assert_eq!(primary(&harness), "What does it look like?");
    replace_findings(&mut harness, Vec::clear);
    assert_eq!(primary(&harness), "Plan 25 poses");
    give(&mut harness, Edit::SetAlpha(0.02));
    assert!(!primary(&harness).is_empty());
    let empty = Session::new(
        "empty",
        presets::find("mini").expect("a preset").robot,
        Timestamp::from_unix_seconds(0),
    );
    let path = measured.beside("empty.json");
    write_session(&path, &empty).expect("written");
    let mut harness = workbench();
    give(&mut harness, FileCommand::Open(path));
    assert_eq!(primary(&harness), "Go to measuring");
}

#[test]
fn a_list_leads_to_the_poses_that_decide_and_without_them_to_the_likeliest() {
    let slip: &[(&str, f64)] = &[("step", 0.02), ("pose", 25.0)];
    let measured = Measured::mini(25, &[("cable_slip", "cable-3", slip)]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    give(&mut harness, IdentificationCommand::Diagnose);
    let title = primary(&harness);
    assert!(
        title.starts_with("Add ") && title.ends_with(" poses to the plan"),
        "{title}"
    );
    press(&mut harness, &format!("Next: {title}"));
    assert_eq!(primary(&harness), "Go to measuring");
    replace_findings(&mut harness, |findings| findings[0].separation = None);
    let title = primary(&harness);
    assert!(title.starts_with("Add to model: "), "{title}");
    press(&mut harness, &format!("Next: {title}"));
    assert_eq!(primary(&harness), "Go to adjustment");
}

#[test]
fn a_probable_cause_without_alternatives_has_a_card_of_its_own() {
    let measured = Measured::mini(40, &TWO[..1]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    give(&mut harness, IdentificationCommand::Diagnose);
    replace_findings(&mut harness, |findings| {
        findings[0].probability = 0.93;
        findings[0].alternatives.clear();
    });
    harness.get_by_label("1. Probably winch scale (cable-3), 93 %");
    harness.get_by_label("7 % for something that is not in the catalogue.");
    harness.get_by_label("To be sure");
    assert!(
        harness
            .query_by_label_contains("which exclude each other")
            .is_none()
    );
    press(&mut harness, "Add to model: Winch scale (cable-3)");
    assert_eq!(primary(&harness), "Go to adjustment");
}

#[test]
fn an_unknown_cause_is_neither_certain_nor_added() {
    let measured = Measured::mini(40, &TWO[..1]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    give(&mut harness, IdentificationCommand::Diagnose);
    replace_findings(&mut harness, |findings| {
        findings[0] = without_cause(&findings[0], LENGTH);
    });
    harness.get_by_label_contains("Unexplained error in the length readings of cable-3");
    for text in [
        "almost certainly",
        "Add to model",
        "unexplained pattern",
        "Check in the workshop",
    ] {
        let found = harness.query_by_label_contains(text);
        assert!(
            found.is_none(),
            "{:?}",
            found.map(|node| node.accesskit_node().label())
        );
    }
}

#[test]
fn an_error_without_a_name_has_one_card_with_its_own_readings() {
    let measured = Measured::mini(40, &TWO[..1]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    give(&mut harness, IdentificationCommand::Diagnose);
    replace_findings(&mut harness, |findings| {
        let mut laser = without_cause(&findings[0], (Quantity::Laser, None));
        laser.evidence.delta_chi2 = 1.0;
        *findings = vec![laser, without_cause(&findings[0], LENGTH)];
    });
    assert_eq!(
        harness
            .query_all_by_label("What does it look like?")
            .count(),
        1
    );
    harness.get_by_label_contains("Unexplained error in the length readings of cable-3");
    harness.get_by_label_contains("Evidence of finding 2: The length readings of cable-3 against");
    let symptom = "Evidence of finding 1: ";
    assert!(harness.query_by_label_contains(symptom).is_none());
    press(&mut harness, "Other readings that show it (1)");
    let plot = harness.get_by_label_contains(symptom);
    let name = plot.accesskit_node().label().expect("a name");
    assert!(name.contains("laser") && !name.contains("cable"), "{name}");
}

#[test]
fn an_add_that_fails_is_undone_and_the_card_says_why() {
    let measured = Measured::mini(40, &TWO[..1]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    give(&mut harness, IdentificationCommand::Diagnose);
    // The robot has no inclinometer.
    replace_findings(&mut harness, |findings| {
        let heading = BoundEffect {
            effect: find("heading_offset").expect("an effect"),
            cables: (0..8).collect(),
            targeted: false,
            values: vec![0.01],
        };
        findings[0].subject = Subject::Cause(Cause {
            instances: vec![heading],
        });
    });
    let before = document(&harness).inputs();
    let title = primary(&harness);
    press(&mut harness, &format!("Next: {title}"));
    assert!(
        document(&harness)
            .session()
            .settings
            .identification
            .effects
            .is_empty()
    );
    assert_eq!(document(&harness).inputs(), before);
    assert!(document(&harness).fit_is_current());
    harness.get_by_label_contains("Not added, because");
}

#[test]
fn a_repair_begins_a_new_series_without_what_was_repaired() {
    let measured = Measured::mini(40, &TWO);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    give(&mut harness, IdentificationCommand::Diagnose);
    press(&mut harness, "Next: Add to model: Winch scale (cable-3)");
    let slip = "Cable slip on the drum (cable-5, from pose 17)";
    press(&mut harness, &format!("Repaired: measure again: {slip}"));
    // The present readings are saved first, and cannot be lost.
    assert!(harness.query_by_label("Do not save").is_none());
    let path = measured.beside("kept.json");
    let typed = path.display().to_string();
    type_into(&mut harness, Role::TextInput, "Path of the file", &typed);
    harness
        .get_all_by_label("Save")
        .last()
        .expect("a button")
        .click_accesskit();
    harness.step();
    settle(&mut harness);
    let kept = read_session(&path).expect("the file").value;
    assert_eq!(kept.measurements.len(), 41);
    let session = document(&harness).session();
    assert!(session.measurements.is_empty());
    let planned: Vec<i64> = session.plan.iter().map(|pose| pose.label).collect();
    assert_eq!(planned, kept.measurements.labels);
    let screen = harness.state().state.model.screen;
    assert_eq!(screen, Screen::Phase(Phase::Measuring));
    let effects = &session.settings.identification.effects;
    assert!(effects.iter().all(|one| one.effect == "winch_scale") && effects.len() == 1);
}
