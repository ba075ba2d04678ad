//! Every edit is undone and done again, by keys and by the menu.

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tautline_core::effect::{EffectSetting, Hypothesis};
use tautline_session::{
    Connection, LaserSettings, Method, PhaseData, PlannedPose, UntilSettings, WinchPair,
};
use tautline_workbench::model::edit::{Edit, Editable};
use tautline_workbench::shell::App;

use crate::measured::{Measured, document, give, press};
use crate::support::settle;

const REDO: Modifiers = Modifiers {
    shift: true,
    ..Modifiers::COMMAND
};
/// Kinds of edits.
const KINDS: usize = 15;

/// Hypothesis into which a pattern of unexplained errors is turned.
const PATTERN: &str = r#"
id = "pattern"
title = "Pattern"
scope = "cable"
cause = "{cable}: {size}"
workshop = "None."
[parameters.size]
unit = "1"
typical = [1e-3, 1e-1]
[change]
paid = "paid + size * position_x"
"#;

/// Number of the kind; a new kind does not compile before it has one here, and one in the list below.
fn kind(edit: &Edit) -> usize {
    match edit {
        Edit::Rename(_) => 0,
        Edit::SetMethod(_) => 1,
        Edit::SetAlpha(_) => 2,
        Edit::AddEffects(..) => 3,
        Edit::RemoveEffects(..) => 4,
        Edit::Exclude(_) => 5,
        Edit::Include(_) => 6,
        Edit::SetPlan(..) => 7,
        Edit::SetRobot(..) => 8,
        Edit::SetPhases(..) => 9,
        Edit::SetConnection(_) => 10,
        Edit::AddPattern { .. } => 11,
        Edit::SetHypothesis(_) => 12,
        Edit::RemoveHypothesis(_) => 13,
        Edit::SetUntil(_) => 14,
        // It needs a session without poses: the tests of importing undo it.
        Edit::Import(..) => KINDS,
    }
}

/// One edit of each kind; each changes the state left by the previous ones.
fn edits(harness: &Harness<'_, App>) -> Vec<Edit> {
    let effect = || EffectSetting {
        effect: "winch_scale".into(),
        targets: vec!["cable-3".into()],
        parameters: [("scale".into(), 0.01)].into(),
    };
    let session = document(harness).session();
    let mut robot = session.robot.clone();
    robot.cables[0].pulley.radius_m += 1e-3;
    let planned = PlannedPose {
        label: 99,
        position_m: [0.1, 0.0, 0.0],
        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
    };
    let phases = PhaseData {
        winch: vec![WinchPair {
            cable: 0,
            revolutions: 1.0,
            length_m: 0.1,
            tension_n: None,
        }],
        ..PhaseData::default()
    };
    vec![
        Edit::Rename("Monday".into()),
        Edit::SetMethod(Method::Simple),
        Edit::SetAlpha(0.05),
        Edit::AddEffects(vec![effect()], "add winch scale".into()),
        Edit::RemoveEffects(vec![effect()], "remove winch scale".into()),
        Edit::Exclude(2),
        Edit::Include(2),
        Edit::SetUntil(UntilSettings {
            enabled: true,
            ..UntilSettings::default()
        }),
        Edit::SetPlan(vec![planned], "add a pose".into()),
        Edit::SetRobot(Box::new(robot), "change a radius".into()),
        Edit::SetPhases(Box::new(phases), "add a pair".into()),
        Edit::AddPattern {
            hypothesis: PATTERN.into(),
            effect: Box::new(EffectSetting {
                effect: "pattern".into(),
                targets: vec!["cable-3".into()],
                parameters: [("size".into(), 0.01)].into(),
            }),
            name: "a pattern".into(),
        },
        Edit::SetHypothesis(Box::new(
            Hypothesis::parse(&PATTERN.replace("position_x", "position_y")).expect("a hypothesis"),
        )),
        Edit::RemoveHypothesis("pattern".into()),
        Edit::SetConnection(Box::new((Connection::default(), LaserSettings::Manual))),
    ]
}

fn now(harness: &Harness<'_, App>) -> Editable {
    Editable::of(document(harness).session())
}

fn keys(harness: &mut Harness<'_, App>, modifiers: Modifiers) {
    harness.key_press_modifiers(modifiers, Key::Z);
    harness.step();
    settle(harness);
}

/// Presses a line of the menu; the bar has a button of the same name before it.
fn menu(harness: &mut Harness<'_, App>, line: &str) {
    press(harness, "Edit");
    let found = harness.get_all_by_label(line).last();
    found.expect("a line of the menu").click();
    harness.run_ok();
    settle(harness);
}

#[test]
fn every_edit_is_undone_and_redone_by_keys_and_menu() {
    let mut harness = Measured::mini(6, &[]).opened();
    let measured = document(&harness).session().measurements.len();
    let edits = edits(&harness);
    let mut kinds: Vec<usize> = edits.iter().map(kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    assert_eq!(kinds.len(), KINDS, "one of each kind");
    for edit in edits {
        let (name, before) = (edit.name(), now(&harness));
        give(&mut harness, edit);
        let after = now(&harness);
        assert_ne!(after, before, "{name}");
        keys(&mut harness, Modifiers::COMMAND);
        assert_eq!(now(&harness), before, "{name}: undone by keys");
        keys(&mut harness, REDO);
        assert_eq!(now(&harness), after, "{name}: done again by keys");
        menu(&mut harness, &format!("Undo: {name}"));
        assert_eq!(now(&harness), before, "{name}: undone by the menu");
        menu(&mut harness, &format!("Redo: {name}"));
        assert_eq!(now(&harness), after, "{name}: done again by the menu");
        assert_eq!(
            document(&harness).session().measurements.len(),
            measured,
            "{name}: what was measured stays"
        );
    }
    // Without an edit to redo, the keys do not undo instead.
    let last = now(&harness);
    keys(&mut harness, REDO);
    assert_eq!(now(&harness), last);
}
