//! Hypotheses of the user in the window, and the gallery of effects.

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_core::effect::{EffectSetting, Hypothesis, MAX_HYPOTHESIS_BYTES, every_effect};
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_session::{PhaseData, Session, Timestamp, write_dataset, write_session};
use tautline_workbench::model::command::{Command, FileCommand, HypothesisCommand, ViewCommand};
use tautline_workbench::model::hypothesis::HypothesisDraft;
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::App;

use crate::measured::{document, give, press};
use crate::support::{settle, workbench};

/// Physics that no effect of the catalogue has.
const CROSSTALK: &str = include_str!("../fuzz/seeds/hypothesis/crosstalk.toml");

/// The field with the text.
const TEXT: &str = "Text";

/// A workbench with a session of MINI, where cable 3 has crosstalk that its robot does not know.
fn hidden(folder: &std::path::Path) -> Harness<'static, App> {
    let robot = presets::find("mini").expect("a preset").robot;
    let mut truth = robot.clone();
    let hypothesis = Hypothesis::parse(CROSSTALK).expect("a hypothesis");
    truth.add_hypothesis(&hypothesis).expect("known");
    truth.effects.push(EffectSetting {
        effect: "encoder_crosstalk".into(),
        targets: vec!["cable-3".into()],
        parameters: [("share".to_owned(), 0.015)].into(),
    });
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        ..SimulationOptions::new(40, 4)
    };
    let run = simulate(&truth, &options).expect("a run");
    let path = folder.join("bad.tautline");
    let mut session = Session::new("bad", robot, Timestamp::from_unix_seconds(0));
    session.measurements = run.dataset.measurements;
    write_session(&path, &session).expect("written");
    let mut harness = workbench();
    settle(&mut harness);
    give(&mut harness, FileCommand::Open(path));
    harness
}

/// Replaces the text of the editor.
fn type_text(harness: &mut Harness<'_, App>, text: &str) {
    harness
        .get_by_role_and_label(Role::MultilineTextInput, TEXT)
        .focus();
    harness.step();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.step();
    harness
        .get_by_role_and_label(Role::MultilineTextInput, TEXT)
        .type_text(text);
    harness.step();
    harness.step();
    settle(harness);
    // Its effect on the residuals is computed after the text was accepted.
    settle(harness);
}

fn draft<'h>(harness: &'h Harness<'_, App>) -> &'h HypothesisDraft {
    let draft = harness.state().state.model.hypothesis.draft.as_ref();
    draft.expect("a draft")
}

#[test]
fn what_no_catalogue_has_is_typed_and_named_by_the_doctor() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = hidden(folder.path());
    press(&mut harness, "Identify");
    give(&mut harness, HypothesisCommand::Show);
    // The template is right, and nothing is lost with it.
    harness.get_by_label("The text is a hypothesis; its units fit.");
    assert!(!draft(&harness).is_unsaved());

    // A mistake has its line and column while one types.
    type_text(&mut harness, &CROSSTALK.replace("paid_of(next)", "tension"));
    harness.get_by_label_contains("Line 10, column 16: found N, expected");
    harness.get_by_label("Appears here once the text has no error.");

    type_text(&mut harness, CROSSTALK);
    harness.get_by_label_contains("Size on cable-3: ");
    harness.get_by_label_contains("It explains ");
    harness.get_by_label("Residuals: Length readings of cable-3");
    press(&mut harness, "Ask the doctor");
    let screen = harness.state().state.model.screen;
    assert_eq!(screen, Screen::Phase(Phase::Identification));
    harness.get_by_label("1. Crosstalk between neighbouring encoders (cable-3)");
    press(
        &mut harness,
        "Add to model: Crosstalk between neighbouring encoders (cable-3)",
    );
    let effects = &document(&harness).session().settings.identification.effects;
    assert_eq!(effects[0].effect, "encoder_crosstalk");
    harness.get_by_label("The model explains the data.");
    // Both are edits.
    give(&mut harness, Command::Undo);
    assert_eq!(document(&harness).session().robot.hypotheses, [CROSSTALK]);
    give(&mut harness, Command::Undo);
    assert!(document(&harness).session().robot.hypotheses.is_empty());
}

#[test]
fn malformed_and_endless_text_is_answered_in_one_sentence() {
    let mut harness = workbench();
    settle(&mut harness);
    give(&mut harness, HypothesisCommand::Show);
    let long = "#".repeat(2 * MAX_HYPOTHESIS_BYTES);
    let deep = CROSSTALK.replace("share *", &"(".repeat(20_000));
    for text in [" ", "\u{202e}[[[", "id = 3", &deep, &long] {
        let began = std::time::Instant::now();
        type_text(&mut harness, text);
        assert!(began.elapsed().as_secs() < 20, "it blocks");
        assert!(draft(&harness).text().len() <= MAX_HYPOTHESIS_BYTES);
        let error = draft(&harness)
            .checked()
            .expect_err("a mistake")
            .to_string();
        assert!(error.starts_with("line "), "{error}");
        harness.get_by_label_contains("Line ");
    }
    // Without a session it is shown on a robot of the program.
    type_text(&mut harness, CROSSTALK);
    harness.get_by_label("Residuals: Length readings");
}

#[test]
fn an_unsaved_text_is_asked_about_before_it_is_lost() {
    let mut harness = workbench();
    settle(&mut harness);
    give(&mut harness, HypothesisCommand::Show);
    type_text(&mut harness, CROSSTALK);
    for loses in [
        Command::from(FileCommand::Quit),
        HypothesisCommand::New.into(),
    ] {
        give(&mut harness, loses);
        harness.get_by_label("Save the hypothesis?");
        press(&mut harness, "Cancel");
        assert_eq!(draft(&harness).text(), CROSSTALK);
    }
    // There is no session: it goes into a file of the user, where later sessions find it.
    give(&mut harness, HypothesisCommand::New);
    press(&mut harness, "Save as…");
    harness.get_by_label("Save the hypothesis as");
    press(&mut harness, "Save");
    let folder = harness.state().state.model.folders.effects();
    let saved = std::fs::read_to_string(folder.join("encoder_crosstalk.toml"));
    assert_eq!(saved.expect("a file"), CROSSTALK);
    // And then the new one begins.
    assert!(draft(&harness).text().contains("my_hypothesis"));
    assert!(!draft(&harness).is_unsaved());
}

#[test]
fn the_folder_of_the_user_is_known_to_new_sessions() {
    let mut harness = workbench();
    settle(&mut harness);
    let effects = harness.state().state.model.folders.effects();
    std::fs::create_dir_all(&effects).expect("a folder");
    std::fs::write(effects.join("a.toml"), CROSSTALK).expect("written");
    std::fs::write(
        effects.join("b.toml"),
        CROSSTALK.replace("paid +", "paid *"),
    )
    .expect("written");
    let folder = tempfile::tempdir().expect("a folder");
    let robot = presets::find("mini").expect("a preset").robot;
    let run = simulate(&robot, &SimulationOptions::new(12, 1)).expect("a run");
    let data = folder.path().join("mini");
    write_dataset(&data, &run.dataset, &PhaseData::default()).expect("written");
    give(&mut harness, FileCommand::Open(data));
    assert_eq!(document(&harness).session().robot.hypotheses, [CROSSTALK]);
    let messages = &harness.state().state.model.messages;
    let said = messages.last().map(|message| message.text.clone());
    let warned = messages.all().iter().any(|message| {
        message.text.contains("b.toml, line 10, column ") && message.text.contains("left out")
    });
    assert!(warned, "{said:?}");
    // Each can be taken out of the session again, which can be undone.
    give(
        &mut harness,
        HypothesisCommand::Remove("encoder_crosstalk".into()),
    );
    assert!(document(&harness).session().robot.hypotheses.is_empty());
    give(&mut harness, Command::Undo);
    assert_eq!(document(&harness).session().robot.hypotheses, [CROSSTALK]);
}

#[test]
fn the_gallery_has_one_card_for_each_effect() {
    let mut harness = workbench();
    settle(&mut harness);
    give(&mut harness, ViewCommand::Go(Screen::Gallery));
    settle(&mut harness);
    settle(&mut harness);
    let gallery = harness.state().state.model.hypothesis.gallery.as_ref();
    let gallery = gallery.expect("a gallery").1.as_ref().expect("drawn");
    assert_eq!(gallery.signatures.len(), every_effect().count());
    // All are found, though only those are drawn that are seen.
    for effect in every_effect() {
        let field = harness.get_by_role_and_label(Role::TextInput, "Search effects");
        field.focus();
        harness.step();
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
        harness.step();
        let field = harness.get_by_role_and_label(Role::TextInput, "Search effects");
        field.type_text(effect.title());
        harness.step();
        harness.step();
        let name = format!("Effect: {}", effect.title());
        assert!(harness.query_all_by_label(&name).count() > 0, "{name}");
    }
    let first = every_effect().next().expect("an effect");
    let field = harness.get_by_role_and_label(Role::TextInput, "Search effects");
    field.focus();
    harness.step();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.step();
    let field = harness.get_by_role_and_label(Role::TextInput, "Search effects");
    field.type_text(first.title());
    harness.step();
    let name = format!("Effect: {}", first.title());
    harness
        .query_all_by_label(&name)
        .next()
        .expect("a card")
        .click_accesskit();
    harness.step();
    settle(&mut harness);
    harness.get_by_label("Workshop");
    press(&mut harness, "Start a hypothesis from it");
    assert_eq!(harness.state().state.model.screen, Screen::Hypothesis);
    let id = format!("id = \"my_{}\"", first.id());
    assert!(draft(&harness).text().contains(&id));
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("gallery.html");
    give(&mut harness, HypothesisCommand::SaveGallery(path.clone()));
    let page = std::fs::read_to_string(path).expect("a page");
    assert_eq!(page.matches("<h2>").count(), every_effect().count() + 1);
    let node = harness.get_by_label("Hypothesis");
    assert!(node.accesskit_node().value().is_some());
}
