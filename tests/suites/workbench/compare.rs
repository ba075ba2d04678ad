//! Two sessions side by side.

use std::path::Path;

use egui::{Role, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_session::{Session, Timestamp, write_session};
use tautline_validation::support::harness::GlowTestRenderer;
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::{CompareCommand, FileCommand};
use tautline_workbench::shell::App;
use tautline_workbench::views::robot_3d::scene::SceneInputs;

use crate::measured::{give, press};
use crate::support::{options, settle, type_into, workbench};

/// Writes a session of a preset whose fifth pulley has moved by `moved_m` along y.
pub fn write(path: &Path, preset: &str, moved_m: f64, seed: u64) {
    let preset = presets::find(preset).expect("a preset");
    let mut truth = preset.robot.clone();
    if let Some(cable) = truth.cables.get_mut(4) {
        cable.pulley.entry_point_m[1] += moved_m;
    }
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(40, seed)
    };
    let simulated = simulate(&truth, &options).expect("measurements");
    let name = path.file_stem().expect("a name").to_string_lossy();
    let now = Timestamp::from_unix_seconds(0);
    let mut session = Session::new(name, preset.robot, now);
    session.measurements = simulated.dataset.measurements;
    write_session(path, &session).expect("written");
}

/// Types a path and takes it.
pub fn take(harness: &mut Harness<'_, App>, side: &str, path: &Path) {
    let field = format!("Path of {side}");
    let text = path.display().to_string();
    type_into(harness, Role::TextInput, &field, &text);
    press(harness, &format!("Use {side}"));
}

/// The row of a cable in the table of pulleys.
fn row(harness: &Harness<'_, App>, cable: &str) -> String {
    let start = format!("{cable},");
    let found = harness.get_by_label_contains(&start);
    found.accesskit_node().label().unwrap_or_default()
}

#[test]
fn a_moved_pulley_is_distinguished_from_noise_and_the_sessions_are_swapped() {
    let folder = tempfile::tempdir().expect("a folder");
    let [before, after] = ["before.json", "after.json"].map(|name| folder.path().join(name));
    write(&before, "mini", 0.0, 1);
    write(&after, "mini", -0.01, 3);
    let mut harness = workbench();
    settle(&mut harness);
    press(&mut harness, "Compare two sessions");
    harness.get_by_label_contains("Choose two sessions of the same robot");
    take(&mut harness, "A", &before);
    take(&mut harness, "B", &after);
    let verdict = "1 pulley has moved: cable-5. The rest agrees within the noise.";
    harness.get_by_label(verdict);
    for cable in 1..=8 {
        let text = row(&harness, &format!("cable-{cable}"));
        let expected = if cable == 5 { "moved" } else { "unchanged" };
        assert!(text.contains(expected), "{text}");
    }
    let along_y = |harness: &Harness<'_, App>| {
        let text = row(harness, "cable-5");
        let y = text.split(", ").nth(2).and_then(|y| y.parse::<f64>().ok());
        y.unwrap_or_else(|| panic!("no number in {text}"))
    };
    assert!((along_y(&harness) + 10.0).abs() < 5.0);
    for part in ["3D view", "Plot: residuals of both sessions"] {
        let rect = harness.get_by_label(part).rect();
        assert!(
            rect.height() > 60.0 && rect.width() > 300.0,
            "{part} {rect:?}"
        );
    }
    harness.get_by_label_contains("cable-5,").click_accesskit();
    settle(&mut harness);
    assert_eq!(harness.state().state.model.selection, Selection::cable(4));
    press(&mut harness, "Swap A and B");
    harness.get_by_label(verdict);
    assert!((along_y(&harness) - 10.0).abs() < 5.0);
    press(&mut harness, "Back");
    harness.get_by_label("Try the demo robot");
}

/// A workbench of a size that compares two sessions, drawn on a graphics card.
fn compared(renderer: &GlowTestRenderer, runs: &[&Path; 2]) -> Harness<'static, App> {
    let mut harness = Harness::builder()
        .with_size(vec2(1280.0, 800.0))
        .with_max_steps(60)
        .renderer(renderer.clone())
        .build_eframe(|creation| App::new(creation, options()));
    give(&mut harness, CompareCommand::Show);
    for run in runs {
        give(&mut harness, CompareCommand::Drop(run.to_path_buf()));
    }
    harness
}

#[test]
fn a_row_frames_its_pulley_and_those_that_did_not_move_fade() {
    let folder = tempfile::tempdir().expect("a folder");
    let [before, after] = ["before.json", "after.json"].map(|name| folder.path().join(name));
    write(&before, "mini", 0.0, 1);
    write(&after, "mini", -0.01, 3);
    let renderer = GlowTestRenderer::new().expect("a picture");
    let mut harness = compared(&renderer, &[&before, &after]);
    let view = |harness: &Harness<'_, App>| {
        let view = &harness.state().state.views.compared_3d;
        (view.options.clone(), *view.camera().expect("a camera"))
    };
    let (_, whole) = view(&harness);
    harness.get_by_label_contains("cable-5,").click_accesskit();
    harness.step();
    settle(&mut harness);
    let (options, close) = view(&harness);
    assert!(close.height_m() < 0.5 * whole.height_m());
    let fades = {
        let state = &harness.state().state;
        let compared = state.model.comparison.known().expect("a comparison");
        let [first, _] = compared.runs.each_ref().map(|run| run.fit.as_ref());
        let subject = SceneInputs {
            fit: Some(first),
            ..SceneInputs::new(&first.dataset.robot, &first.dataset.measurements)
        };
        let scene = subject.scene().compared(&compared.comparison);
        (0..8)
            .filter(|cable| options.fades(&scene, *cable))
            .collect::<Vec<_>>()
    };
    assert_eq!(fades, [0, 1, 2, 3, 5, 6, 7]);
    harness.state_mut().state.views.destroy();
}

#[test]
fn a_pulley_moved_by_5_mm_is_seen_in_both_places() {
    let folder = tempfile::tempdir().expect("a folder");
    let [before, after] = ["before.json", "after.json"].map(|name| folder.path().join(name));
    write(&before, "mini", 0.0, 1);
    write(&after, "mini", -0.005, 3);
    let renderer = GlowTestRenderer::new().expect("a picture");
    let mut harness = compared(&renderer, &[&before, &after]);
    harness.get_by_label_contains("cable-5,").click_accesskit();
    harness.step();
    settle(&mut harness);
    let mut picture = |with_second: bool| {
        harness.state_mut().state.views.compared_3d.options.nominal = with_second;
        harness.run_ok();
        renderer.picture(&harness).expect("a picture")
    };
    let [with, without] = [true, false].map(&mut picture);
    let rect = harness.get_by_label("3D view").rect();
    let differs = |(x, y, pixel): &(u32, u32, &image::Rgba<u8>)| {
        let other = without.get_pixel(*x, *y);
        rect.contains(egui::pos2(*x as f32, *y as f32))
            && (0..3).any(|k| pixel.0[k].abs_diff(other.0[k]) > 24)
    };
    let changed = with.enumerate_pixels().filter(differs).count() as f32;
    harness.state_mut().state.views.destroy();
    let share = changed / rect.area();
    assert!(share > 0.002, "{share}");
}

#[test]
fn a_session_that_cannot_be_compared_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let [mini, planar] = ["mini.json", "planar.json"].map(|name| folder.path().join(name));
    write(&mini, "mini", 0.0, 1);
    write(&planar, "planar", 0.0, 1);
    let mut harness = workbench();
    give(&mut harness, CompareCommand::Show);
    take(&mut harness, "A", &mini);
    take(&mut harness, "B", &folder.path().join("nowhere.json"));
    let state = &harness.state().state;
    let last = state
        .model
        .messages
        .last()
        .map(|message| message.text.clone());
    assert!(last.is_some_and(|text| text.contains("nowhere.json")));
    press(&mut harness, "Change B");
    harness
        .state_mut()
        .state
        .outbox
        .send(CompareCommand::Choose(
            tautline_workbench::model::comparison::Side::B,
            tautline_workbench::model::comparison::SessionSource::File(planar),
        ));
    settle(&mut harness);
    settle(&mut harness);
    let told = harness
        .get_all_by_label_contains("The two cannot be compared")
        .count();
    assert!(told > 0, "on the screen");
}

#[test]
fn the_open_session_is_compared_first_and_again_after_a_change() {
    let folder = tempfile::tempdir().expect("a folder");
    let [open, other] = ["open.json", "other.json"].map(|name| folder.path().join(name));
    write(&open, "mini", 0.0, 1);
    write(&other, "mini", 0.0, 2);
    let mut harness = workbench();
    give(&mut harness, FileCommand::Open(open));
    give(&mut harness, CompareCommand::Show);
    take(&mut harness, "B", &other);
    let same = "No pulley has moved: all values agree within the noise.";
    harness.get_by_label(same);
    assert!(harness.query_by_label("Compare again").is_none());
    give(
        &mut harness,
        tautline_workbench::model::edit::Edit::Exclude(5),
    );
    harness.get_by_label("The open session was changed since it was compared.");
    press(&mut harness, "Compare again");
    harness.get_by_label(same);
    assert!(harness.query_by_label("Compare again").is_none());
}

#[test]
fn a_small_window_shows_one_part_at_a_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let [open, other] = ["open.json", "other.json"].map(|name| folder.path().join(name));
    write(&open, "mini", 0.0, 1);
    write(&other, "mini", 0.0, 2);
    let mut harness = workbench();
    give(&mut harness, FileCommand::Open(open));
    give(&mut harness, CompareCommand::Show);
    give(&mut harness, CompareCommand::Drop(other));
    for size in [[640.0, 400.0], [1280.0, 200.0], [640.0, 160.0]] {
        harness.set_size(size.into());
        harness.run_ok();
        for part in ["3D view", "Residuals", "Differences"] {
            if size[0] < 900.0 {
                let found = harness.get_all_by_role_and_label(Role::Button, part).next();
                found.expect("a part").click();
                harness.run_ok();
            }
        }
        assert!(
            harness.state().state.model.caught_panic.is_none(),
            "{size:?}"
        );
    }
    harness.set_size([640.0, 400.0].into());
    harness.run_ok();
    harness.get_by_label_contains("No pulley has moved");
}
