//! The plots below the 3D view.

use egui::{Pos2, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, simulate};
use tautline_session::Session;
use tautline_workbench::model::command::{IdentificationCommand, ViewCommand};
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::model::{OpenSession, Selection};
use tautline_workbench::shell::App;

use crate::support::{settle, type_into, workbench};

/// A workbench with twelve measured poses of the planar robot.
fn measured() -> Harness<'static, App> {
    let preset = presets::find("planar").expect("a preset");
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(12, 3)
    };
    let simulated = simulate(&preset.robot, &options).expect("measurements");
    let now = tautline_session::Timestamp::from_unix_seconds(0);
    let mut session = Session::new("planar", simulated.dataset.robot, now);
    session.measurements = simulated.dataset.measurements;
    let mut harness = workbench();
    let state = &mut harness.state_mut().state;
    state.model.open = Some(OpenSession::new(session, None));
    let go = ViewCommand::Go(Screen::Phase(Phase::Identification));
    state.outbox.send(go);
    settle(&mut harness);
    harness
}

/// The same, identified.
fn identified() -> Harness<'static, App> {
    let mut harness = measured();
    harness
        .state_mut()
        .state
        .outbox
        .send(IdentificationCommand::Identify);
    settle(&mut harness);
    settle(&mut harness);
    assert!(
        harness
            .state()
            .state
            .model
            .open
            .as_ref()
            .is_some_and(|d| d.fit().is_some())
    );
    harness
}

fn open(harness: &mut Harness<'_, App>, tab: &str) {
    if harness.query_by_role_and_label(Role::Button, tab).is_none() {
        harness.get_by_label("More plots").click();
        harness.run_ok();
    }
    harness.get_by_role_and_label(Role::Button, tab).click();
    harness.step();
    settle(harness);
}

#[test]
fn without_an_identification_the_plots_say_how_to_get_them() {
    let harness = measured();
    harness.get_by_label_contains("appear here after identification");
    let tab = harness.get_by_role_and_label(Role::Button, "Tensions");
    assert!(tab.accesskit_node().is_disabled());
}

#[test]
fn every_plot_of_an_identification_is_drawn() {
    let mut harness = identified();
    for tab in ["Residuals", "By variable", "Convergence", "Correlation"] {
        open(&mut harness, tab);
        let name = format!("Plot: {tab}");
        let rect = harness.get_by_label(&name).rect();
        assert!(rect.height() > 60.0, "{tab}: {rect:?}");
    }
    harness.get_by_label("More plots").click();
    harness.run_ok();
    let before = harness.get_by_role_and_label(Role::Button, "Before and after");
    assert!(
        before.accesskit_node().is_disabled(),
        "nothing is diagnosed"
    );
}

#[test]
fn a_click_on_a_residual_selects_its_cable_and_pose() {
    let mut harness = identified();
    let plot = harness.get_by_label("Plot: Residuals").rect();
    // Residuals lie about zero, in the middle: a search along it hits a point.
    let mut place = Pos2::new(plot.min.x + 30.0, plot.center().y);
    while harness.state().state.model.selection.is_empty() && place.x < plot.max.x {
        harness.hover_at(place);
        harness.drag_at(place);
        harness.drop_at(place);
        harness.run_ok();
        place.x += 7.0;
    }
    let Selection { cable, pose } = harness.state().state.model.selection;
    assert!(cable.is_some_and(|cable| cable < 4), "{cable:?}");
    assert!(
        pose.is_some_and(|pose| (1..=12).contains(&pose)),
        "{pose:?}"
    );
}

#[test]
fn what_is_visible_is_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = identified();
    for (format, ending) in [("Table (CSV)", "csv"), ("Drawing (SVG)", "svg")] {
        let path = folder.path().join(format!("residuals.{ending}"));
        harness.get_by_label("Save plot").click();
        harness.run_ok();
        harness.get_by_label(format).click();
        harness.run_ok();
        let name = path.display().to_string();
        type_into(&mut harness, Role::TextInput, "Path of the file", &name);
        harness.get_by_label("Save").click();
        harness.step();
        settle(&mut harness);
        let text = std::fs::read_to_string(&path).expect("the file");
        if ending == "csv" {
            let fit = harness
                .state()
                .state
                .model
                .open
                .as_ref()
                .and_then(|d| d.fit().cloned());
            let fit = fit.expect("a fit");
            let is_shown = |r: &&tautline_core::estimation::Observation| {
                let is_length = matches!(
                    r.kind,
                    tautline_core::estimation::ObservationKind::Length(_)
                );
                is_length && r.normalised().is_some()
            };
            let readings = fit.analysis.observations.iter().filter(is_shown).count();
            assert_eq!(text.lines().count(), 1 + readings, "all are in the view");
            assert!(text.starts_with("name,pose,"));
        } else {
            assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"));
            assert!(
                text.contains(">cable-1</text>"),
                "the legend names the cables"
            );
            assert!(text.contains("Prediction minus reading"));
        }
    }
}
