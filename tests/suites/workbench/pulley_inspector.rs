//! The pulley inspector: ways to open it, its texts, and its pixels.

use egui::{Key, Rect, Role, ThemePreference};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use image::RgbaImage;
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_session::Session;
use tautline_validation::support::harness::GlowTestRenderer;
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::{IdentificationCommand, ViewCommand};
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::App;
use tautline_workbench::views::robot_3d::scene::Significance;

use crate::measured::{Measured, give, press};
use crate::robot_3d::{camera, drawn, in_window, open, quick_workbench, scene, session_of};
use crate::support::{settle, workbench};

fn inspected(harness: &Harness<'_, App>) -> Option<usize> {
    harness.state().state.model.inspected
}

/// A run of MINI whose third pulley is `moved_m` from the drawing along x.
fn with_moved_pulley(moved_m: f64) -> Session {
    let preset = presets::find("mini").expect("a preset");
    let mut truth = preset.robot.clone();
    truth.cables[2].pulley.entry_point_m[0] += moved_m;
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(40, 9)
    };
    let mut session = session_of("mini", 2);
    let simulated = simulate(&truth, &options).expect("measurements");
    session.measurements = simulated.dataset.measurements;
    session
}

/// The text of the only node whose name begins so.
fn line(harness: &Harness<'_, App>, start: &str) -> String {
    let found = harness.get_by_label_contains(start);
    let node = found.accesskit_node();
    node.label().or(node.value()).unwrap_or_default()
}

#[test]
fn a_double_click_a_key_and_the_table_lead_to_a_pulley() {
    let mut harness = quick_workbench();
    open(&mut harness, session_of("mini", 6), true);
    let before = camera(&harness);
    let at = in_window(&harness, &drawn(&harness, 1));
    harness.hover_at(at);
    harness.run_ok();
    for _ in 0..2 {
        harness.drag_at(at);
        harness.drop_at(at);
    }
    harness.run_ok();
    assert_eq!(inspected(&harness), Some(1));
    assert_eq!(harness.state().state.model.selection.cable, Some(1));
    harness.get_by_label("Pulley of cable-2");
    let there = camera(&harness);
    let scene = scene(&harness);
    let centre = scene.cables[1].wheel.centre;
    let rect = harness.get_by_label("3D view").rect();
    assert!(rect.shrink(40.0).contains(in_window(&harness, &centre)));
    let size = |camera: &tautline_workbench::views::robot_3d::camera::Camera| camera.height_m();
    assert!(size(&there) < 0.25 * size(&before), "it is close");
    let options = &harness.state().state.views.robot_3d.options;
    assert_eq!(options.exaggeration_of(&scene), 1.0, "true to scale");
    harness.key_press(Key::Escape);
    harness.run_ok();
    assert_eq!(inspected(&harness), None);
    let back = camera(&harness);
    assert_eq!(back, before, "back to where one came from");
    // The key, with the pulley still selected and the pointer elsewhere.
    harness.hover_at(egui::pos2(4.0, 400.0));
    harness.key_press(Key::F);
    harness.run_ok();
    assert_eq!(inspected(&harness), Some(1));
    press(&mut harness, "Close inspector (Escape)");
    // The table.
    give(
        &mut harness,
        ViewCommand::Go(Screen::Phase(Phase::Identification)),
    );
    give(&mut harness, ViewCommand::Select(Selection::cable(4)));
    press(&mut harness, "Inspect the pulley of cable-5");
    assert_eq!(inspected(&harness), Some(4));
    give(
        &mut harness,
        ViewCommand::Go(Screen::Phase(Phase::Measuring)),
    );
    assert_eq!(inspected(&harness), None, "another phase shows the robot");
}

#[test]
fn keys_and_buttons_go_through_the_pulleys_and_home_shows_all() {
    let mut harness = workbench();
    open(&mut harness, session_of("mini", 6), true);
    give(&mut harness, ViewCommand::Inspect(Some(7)));
    harness.get_by_label("Pulley of cable-8");
    press(&mut harness, "Next pulley (Page down)");
    harness.get_by_label("Pulley of cable-1");
    press(&mut harness, "Previous pulley (Page up)");
    harness.key_press(Key::PageUp);
    harness.run_ok();
    harness.get_by_label("Pulley of cable-7");
    assert_eq!(harness.state().state.model.selection, Selection::cable(6));
    let height = |harness: &Harness<'_, App>| {
        let view = &harness.state().state.views.robot_3d;
        view.camera().expect("a camera").height_m()
    };
    let close = height(&harness);
    press(&mut harness, "Show the whole robot (Home)");
    assert!(height(&harness) > 3.0 * close);
    press(&mut harness, "Show the pulley (F)");
    assert!((height(&harness) / close - 1.0).abs() < 0.05);
    // The inspector follows a selection elsewhere.
    give(&mut harness, ViewCommand::Select(Selection::cable(2)));
    harness.get_by_label("Pulley of cable-3");
    // Another session has other pulleys.
    open(&mut harness, session_of("planar", 3), false);
    give(&mut harness, ViewCommand::Inspect(Some(7)));
    assert!(harness.query_by_label_contains("Pulley of cable").is_none());
}

#[test]
fn numbers_and_words_are_those_of_the_identification() {
    let mut harness = workbench();
    open(&mut harness, with_moved_pulley(5e-3), true);
    give(&mut harness, ViewCommand::Inspect(Some(2)));
    let said = line(&harness, "mm from the drawing");
    assert!(said.contains("more than its uncertainty"), "{said}");
    let dx = line(&harness, "dx: ");
    let (value, rest) = dx["dx: ".len()..]
        .split_once(" ± ")
        .expect("a standard deviation");
    let (sd, _) = rest.split_once(';').expect("the drawing");
    let [value, sd] = [value, sd].map(|text| text.parse::<f64>().expect("a number"));
    let fit = harness
        .state()
        .state
        .model
        .open
        .as_ref()
        .and_then(|open| open.fit().cloned());
    let fit = fit.expect("a fit");
    let found = fit.solution.globals.entry_points[2][0];
    let drawn = fit.dataset.robot.cables[2].pulley.entry_point_m[0];
    assert!((value - 1e3 * (found - drawn)).abs() < 0.06, "{dx}");
    // Beyond six standard deviations less than twice in a thousand million times.
    assert!((value - 5.0).abs() < 6.0 * sd.max(0.05), "{dx}");
    for side in ["Front", "Side", "Top"] {
        let name = format!("{side} view of the pulley of cable-3, grid ");
        assert!(line(&harness, &name).ends_with(" mm"));
        let image = harness.get_by_label_contains(&name);
        assert_eq!(image.accesskit_node().role(), Role::Image);
        assert!(image.rect().width() > 100.0);
    }
    harness.get_by_label("Strongest correlations with other pulleys");
    let scene = scene(&harness);
    let moved = scene.cables[2].moved.expect("a displacement");
    assert_eq!(moved.significance(), Significance::Clear);
}

#[test]
fn without_an_identification_it_says_how_to_get_one() {
    let mut harness = workbench();
    open(&mut harness, session_of("mini", 3), false);
    give(&mut harness, ViewCommand::Inspect(Some(0)));
    harness.get_by_label_contains("Nothing is identified yet");
    harness.get_by_label_contains("Identify in phase 4");
}

#[test]
fn a_finding_leads_to_the_pulley_of_its_cable() {
    let measured = Measured::mini(40, &[("winch_scale", "cable-3", &[("scale", 0.02)])]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    give(&mut harness, IdentificationCommand::Diagnose);
    press(&mut harness, "Inspect the pulley of cable-3");
    assert_eq!(inspected(&harness), Some(2));
}

#[test]
fn a_small_window_shows_the_inspector_alone() {
    let mut harness = workbench();
    open(&mut harness, session_of("mini", 6), true);
    for size in [[640.0, 400.0], [800.0, 700.0], [1024.0, 640.0]] {
        harness.set_size(size.into());
        harness.run_ok();
        give(&mut harness, ViewCommand::Inspect(Some(3)));
        let rect = harness
            .get_by_role_and_label(Role::Canvas, "3D view")
            .rect();
        assert!(
            rect.height() > 60.0 && rect.width() > 200.0,
            "{size:?}: {rect:?}"
        );
        harness.get_by_label("Pulley of cable-4");
        press(&mut harness, "Close inspector (Escape)");
    }
}

/// Pictures of a part of the window with a pulley where it is and where the drawing has it.
fn pictures(theme: ThemePreference, part: &str) -> [RgbaImage; 2] {
    [0.0, 5e-3].map(|moved_m| {
        let renderer = GlowTestRenderer::new().expect("a picture");
        let mut harness = crate::gl::harness(&renderer, 1.0);
        harness.ctx.set_theme(theme);
        open(&mut harness, with_moved_pulley(moved_m), true);
        give(&mut harness, ViewCommand::Inspect(Some(2)));
        settle(&mut harness);
        let rect: Rect = harness.get_by_label_contains(part).rect();
        let image = renderer.picture(&harness).expect("a picture");
        harness.state_mut().state.views.destroy();
        let corner = [rect.left(), rect.top()].map(|v| v.ceil() as u32);
        let size = [rect.width(), rect.height()].map(|v| v.floor() as u32);
        image::imageops::crop_imm(&image, corner[0], corner[1], size[0], size[1]).to_image()
    })
}

/// Share of the pixels that differ clearly.
fn changed(pictures: &[RgbaImage; 2]) -> f64 {
    let [a, b] = pictures;
    assert_eq!(a.dimensions(), b.dimensions());
    let differs =
        |(a, b): (&image::Rgba<u8>, &image::Rgba<u8>)| (0..3).any(|k| a.0[k].abs_diff(b.0[k]) > 24);
    let count = a.pixels().zip(b.pixels()).filter(|pair| differs(*pair));
    count.count() as f64 / f64::from(a.width() * a.height())
}

#[test]
fn a_pulley_moved_by_5_mm_is_seen() {
    for theme in [ThemePreference::Dark, ThemePreference::Light] {
        for (part, least) in [("3D view", 0.02), ("Front view of the pulley", 0.02)] {
            let share = changed(&pictures(theme, part));
            assert!(share > least, "{theme:?}, {part}: {share}");
        }
    }
}
