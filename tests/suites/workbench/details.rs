//! Details that operators have stumbled over.

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_core::simulation::{SimulationOptions, TensionRange, simulate};
use tautline_session::{PlannedPose, Session, Timestamp};
use tautline_validation::support::harness::words;
use tautline_workbench::model::OpenSession;
use tautline_workbench::model::command::{
    Command, FileCommand, IdentificationCommand, ViewCommand,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::phase::{Phase, Progress, Screen};
use tautline_workbench::model::phase_status;
use tautline_workbench::shell::App;
use tautline_workflow::identification::{all_readings, reading_statistics};
use tautline_workflow::templates::Template;

use crate::measured::{Measured, document, give, press};
use crate::robot_3d::{open, session_of};
use crate::support::{settle, workbench};

fn is_said(harness: &Harness<'_, App>, words: &str) -> bool {
    harness.query_all_by_label_contains(words).next().is_some()
}

#[test]
fn undo_back_to_the_saved_state_leaves_nothing_to_save() {
    let measured = Measured::mini(4, &[]);
    let mut harness = measured.opened();
    let path = measured.beside("session.json");
    give(&mut harness, FileCommand::SaveAs(path));
    assert!(!is_said(&harness, "not saved"));
    give(&mut harness, Edit::Rename("Another name".into()));
    assert!(is_said(&harness, "not saved"));
    give(&mut harness, Command::Undo);
    assert!(!is_said(&harness, "not saved"));
    assert!(!document(&harness).is_unsaved());
}

#[test]
fn a_plan_that_is_partly_measured_is_not_done() {
    let mut session = session_of("mini", 3);
    let planned = (1..=25).map(|label| PlannedPose {
        label,
        position_m: [0.0; 3],
        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
    });
    session.plan = planned.collect();
    let (harness, open) = (workbench(), OpenSession::new(session, None));
    let status = phase_status::of(&harness.state().state.model, &open, Phase::Measuring);
    assert_eq!(status.progress, Progress::InProgress);
    assert_eq!(status.line, "3 of 25 poses measured");
}

/// Names and rectangles of all buttons.
fn buttons(harness: &Harness<'_, App>) -> Vec<(String, egui::Rect)> {
    let nodes = harness.root().children_recursive();
    let buttons = nodes.filter(|node| node.accesskit_node().role() == egui::Role::Button);
    buttons
        .map(|node| {
            (
                node.accesskit_node().label().unwrap_or_default(),
                node.rect(),
            )
        })
        .collect()
}

#[test]
fn an_error_lies_over_the_window_until_it_was_read_and_moves_nothing() {
    let mut harness = Measured::mini(4, &[]).opened();
    let before = buttons(&harness);
    let text = "The file cannot be written: the disk is full.";
    harness.state_mut().state.model.messages.error(text);
    harness.run_ok();
    assert!(is_said(&harness, "the disk is full"));
    let with = buttons(&harness);
    let moved = before.iter().filter(|button| !with.contains(button));
    assert_eq!(moved.count(), 0, "{before:?} {with:?}");
    give(
        &mut harness,
        ViewCommand::Go(Screen::Phase(Phase::Measuring)),
    );
    press(&mut harness, "Dismiss");
    assert!(harness.query_by_label("Dismiss").is_none());
}

#[test]
fn an_error_goes_with_its_cause() {
    let measured = Measured::mini(4, &[]);
    let mut harness = measured.opened();
    let wrong = Command::Refuse("found \"x\", expected a number.".into());
    give(&mut harness, wrong.clone());
    harness.get_by_label("Dismiss");
    give(&mut harness, Edit::Rename("A number".into()));
    assert!(harness.query_by_label("Dismiss").is_none(), "it was typed");
    give(&mut harness, FileCommand::Open("nowhere.json".into()));
    harness.get_by_label("Dismiss");
    give(&mut harness, Edit::Rename("Another name".into()));
    harness.get_by_label("Dismiss");
    let path = measured.beside("kept.json");
    give(&mut harness, FileCommand::SaveAs(path.clone()));
    give(&mut harness, FileCommand::Open(path));
    assert!(harness.query_by_label("Dismiss").is_none(), "it was opened");
}

#[test]
fn cables_with_letters_have_them_everywhere_and_no_laser_is_spoken_of_where_there_is_none() {
    let template = Template::Hangprinter;
    let mut robot = template.robot(template.usual_size_m());
    for (cable, name) in robot.cables.iter_mut().zip(["A", "B", "C", "D"]) {
        name.clone_into(&mut cable.name);
    }
    let options = SimulationOptions {
        tension: Some(TensionRange::of(&robot)),
        ..SimulationOptions::new(14, 2)
    };
    let run = simulate(&robot, &options).expect("measurements");
    let mut session = Session::new("printer", robot, Timestamp::from_unix_seconds(0));
    session.measurements = run.dataset.measurements;
    let mut harness = workbench();
    open(&mut harness, session.clone(), true);
    give(
        &mut harness,
        ViewCommand::Go(Screen::Phase(Phase::Identification)),
    );
    let scene = harness
        .state()
        .state
        .views
        .robot_3d
        .scene()
        .expect("a scene");
    let labels: Vec<&str> = scene
        .cables
        .iter()
        .map(|cable| cable.label.as_str())
        .collect();
    assert_eq!(labels, ["A", "B", "C", "D"]);
    for words in ["target plane", "Target plane", "laser", "cable-1"] {
        assert!(!is_said(&harness, words), "{words}");
    }
    // The tracked position of the platform is plotted like any other reading.
    if harness.query_by_label("Tracker").is_none() {
        press(&mut harness, "More plots");
    }
    press(&mut harness, "Tracker");
    harness.get_by_label("Plot: Tracker");
    // A robot without a tracker has no such plot: its residuals are shown instead, and the plot returns later.
    open(&mut harness, session_of("mini", 12), true);
    harness.get_by_label("Plot: Residuals");
    assert!(harness.query_by_label("Plot: Tracker").is_none());
    open(&mut harness, session, true);
    harness.get_by_label("Plot: Tracker");
}

#[test]
fn what_rounds_to_zero_has_no_sign() {
    let mut session = session_of("mini", 12);
    let close = -1e-6;
    session.plan = vec![PlannedPose {
        label: 90,
        position_m: [close; 3],
        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
    }];
    let mut harness = workbench();
    open(&mut harness, session, true);
    for phase in Phase::ALL {
        give(&mut harness, ViewCommand::Go(Screen::Phase(phase)));
        for text in words(&harness) {
            let parts = text.split(|part: char| !(part.is_ascii_digit() || "-.".contains(part)));
            for part in parts {
                let is_zero = part.parse::<f64>().is_ok_and(|number| number == 0.0);
                assert!(!(is_zero && part.starts_with('-')), "{phase:?}: {text:?}");
            }
        }
    }
}

#[test]
fn histogram_and_table_have_the_same_readings() {
    let mut harness = Measured::mini(12, &[]).opened();
    give(&mut harness, IdentificationCommand::Identify);
    let fit = document(&harness).fit().expect("a fit");
    let plotted = all_readings(&fit.analysis).count();
    assert_eq!(plotted, reading_statistics(fit).len());
}

#[test]
fn the_palette_lists_every_match() {
    let mut harness = Measured::mini(4, &[]).opened();
    give(&mut harness, ViewCommand::Palette(true));
    let field = harness.get_by_role_and_label(egui::Role::TextInput, "Command");
    field.type_text("go to");
    harness.run_ok();
    settle(&mut harness);
    for phase in Phase::ALL {
        let title = format!("Go to {}. {}", phase.number(), phase.title());
        let found = harness.query_all_by_label_contains(&title);
        assert!(found.count() > 0, "{title}");
    }
    let entry = harness.get_by_label_contains("Go to 5. Adjustment");
    assert!(!entry.accesskit_node().is_disabled());
}
