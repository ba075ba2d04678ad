//! The whole demonstration, from the start screen to the verified controller, by the names that a newcomer sees.

use std::path::Path;

use egui::Role;
use egui_kittest::kittest::Queryable;
use tautline_session::Stage;
use tautline_validation::support::harness::words;
use tautline_workbench::model::command::{Answer, CompareCommand, FileCommand};

use crate::demo::Bench;
use crate::support::type_into;

/// A demonstration whose fault is found by name.
const SEED: u64 = 3;

#[test]
fn a_newcomer_walks_through_all_phases() {
    let mut bench = Bench::new(Some(SEED));
    bench.press("Try the demo robot");
    bench.wait("the demonstration", |state| state.model.open.is_some());

    bench.press("Phase 1: Pre-calibration");
    bench.press("Apply values");
    assert_eq!(
        bench.session().log().len(),
        1,
        "an edit is no entry of the log"
    );
    bench.press("Phase 2: Modeling");

    bench.press("Phase 3: Measuring");
    bench.press("Plan poses");
    bench.settle("a plan");
    bench.connect_and_arm();
    bench.press("Start measuring");
    bench.wait("all poses", |state| !state.model.link.is_measuring());
    assert_eq!(
        bench.session().measurements.len(),
        26,
        "25 poses and the home pose"
    );

    bench.press("Next: Identify the pulleys");
    bench.settle("an identification");
    bench
        .harness
        .get_by_label("The model does not explain the data.");
    bench.press("Diagnose model");
    bench.settle("a diagnosis");
    let hidden = &bench
        .session()
        .simulator
        .as_ref()
        .expect("a simulated robot")
        .truth
        .effects[0];
    let hidden = (hidden.effect.clone(), hidden.targets.clone());
    bench.press("Add to model: Winch scale (cable-3)");
    bench.settle("the identification with the cause");
    let added = &bench.session().settings.identification.effects[0];
    assert_eq!((added.effect.clone(), added.targets.clone()), hidden);
    let fit = bench
        .state()
        .model
        .open
        .as_ref()
        .and_then(|document| document.fit())
        .expect("a fit");
    // Rejects a right model once in a thousand times.
    assert!(
        fit.solution.p_value().is_some_and(|p| p > 1e-3),
        "{:?}",
        fit.solution.p_value()
    );

    bench.press("Phase 5: Adjustment");
    bench.press("Measure before");
    bench.wait("a verification", |state| verified(state) == 1);
    bench.write_values();
    bench.press("Measure after");
    bench.wait("another verification", |state| verified(state) == 2);
    let stages: Vec<Stage> = bench
        .session()
        .verifications()
        .iter()
        .map(|run| run.stage)
        .collect();
    assert_eq!(stages, [Stage::Before, Stage::After]);

    save_and_open_again(&mut bench);
    compare_with_a_clean_session(&mut bench);
}

/// The session compared with one of a robot without a fault: they differ by the hidden effect.
fn compare_with_a_clean_session(bench: &mut Bench) {
    let clean = Path::new(env!("CARGO_MANIFEST_DIR")).join("../sessions/clean-mini/session.json");
    bench.give(CompareCommand::Show);
    bench.settle("the comparison");
    bench.give(CompareCommand::Drop(clean));
    bench.settle("the comparison");
    bench.harness.run_ok();
    let plot = "Plot: residuals of both sessions";
    assert!(bench.harness.query_by_label(plot).is_some(), "comparable");
    let said = words(&bench.harness);
    assert!(
        said.iter().any(|text| text.contains("Winch scale")),
        "{said:?}"
    );
}

fn verified(state: &tautline_workbench::shell::AppState) -> usize {
    state
        .model
        .open
        .as_ref()
        .map_or(0, |document| document.session().verifications().len())
}

fn save_and_open_again(bench: &mut Bench) {
    let path = bench.folder.path().join("walked.json");
    bench
        .harness
        .key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::S);
    bench.harness.step();
    bench.harness.step();
    let (name, text) = ("Path of the file", path.display().to_string());
    type_into(&mut bench.harness, Role::TextInput, name, &text);
    bench.press("Save");
    bench.settle("the saved session");
    let before = bench.session().clone();
    assert!(
        !bench
            .state()
            .model
            .open
            .as_ref()
            .expect("a session")
            .is_unsaved()
    );

    bench.give(FileCommand::Close);
    bench.give(FileCommand::Answer(Answer::Discard));
    bench.wait("the start screen", |state| state.model.open.is_none());
    bench.harness.get_by_label("Demo robot").click_accesskit();
    bench.wait("the session again", |state| state.model.open.is_some());
    bench.settle("its identification");
    assert_eq!(
        format!("{:?}", bench.session().measurements),
        format!("{:?}", before.measurements)
    );
    assert_eq!(bench.session().results().len(), before.results().len());
    assert!(
        bench
            .state()
            .model
            .open
            .as_ref()
            .expect("a session")
            .fit_is_current()
    );
}
