//! The 3D view, driven by pointer and keys.

use egui::{Key, Pos2, Role, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tautline_core::geometry::{Pose, Vec3};
use tautline_core::robot::presets;
use tautline_core::simulation::{SimulationOptions, simulate};
use tautline_session::{PlannedPose, Session, Timestamp};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::link::LivePlatform;
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::model::{OpenSession, Selection};
use tautline_workbench::shell::App;
use tautline_workbench::views::robot_3d::camera::{Camera, Projection};
use tautline_workbench::views::robot_3d::drawing::{ArrowColour, FrameLook, Options};
use tautline_workbench::views::robot_3d::picking::Picture;
use tautline_workbench::views::robot_3d::scene::ShownPose;
use tautline_workflow::identification::{IdentificationRequest, identify};

use crate::support::{options, settle, workbench};

/// A simulated run of a preset in a session.
pub fn session_of(name: &str, poses: usize) -> Session {
    let preset = presets::find(name).expect("a preset");
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(poses, 5)
    };
    let run = simulate(&preset.robot, &options).expect("simulated");
    let now: Timestamp = "2026-01-05T08:00:00Z".parse().expect("a time");
    let mut session = Session::new(name, preset.robot, now);
    session.measurements = run.dataset.measurements;
    session
}

/// Opens a session in the measuring phase, identified or not.
pub fn open(harness: &mut Harness<'_, App>, session: Session, is_identified: bool) {
    let mut document = OpenSession::new(session, None);
    if is_identified {
        let request = IdentificationRequest::of_session(document.session()).expect("a request");
        let keep = &mut |_: &_| tautline_core::estimation::Control::Continue;
        let fit = identify(&request, keep).expect("a fit");
        let inputs = document.inputs();
        document.set_fit(fit, inputs);
    }
    harness.state_mut().state.model.open = Some(document);
    harness.state_mut().state.model.screen = Screen::Phase(Phase::Measuring);
    settle(harness);
}

/// Position of a point of the base frame in the window.
pub fn in_window(harness: &Harness<'_, App>, point: &Vec3) -> Pos2 {
    let rect = harness.get_by_label("3D view").rect();
    let view = &harness.state().state.views.robot_3d;
    let picture = Picture {
        scene: view.scene().expect("a scene"),
        options: &view.options,
        camera: view.camera().expect("a camera"),
        size: [rect.width(), rect.height()].map(f64::from),
    };
    let seen = picture.on_screen(point).expect("it is there");
    rect.min + vec2(seen.x as f32, seen.y as f32)
}

/// Drawn centre of a pulley, with its magnified displacement (m).
pub fn drawn(harness: &Harness<'_, App>, cable: usize) -> Vec3 {
    let view = &harness.state().state.views.robot_3d;
    let scene = view.scene().expect("a scene");
    let magnification = view.options.exaggeration_of(scene);
    scene.placed(cable, magnification).wheel.centre
}

fn click(harness: &mut Harness<'_, App>, at: Pos2) {
    harness.hover_at(at);
    harness.run_ok();
    harness.drag_at(at);
    harness.drop_at(at);
    harness.run_ok();
}

/// The present camera.
pub fn camera(harness: &Harness<'_, App>) -> Camera {
    let view = &harness.state().state.views.robot_3d;
    *view.camera().expect("it is there")
}

pub fn scene(
    harness: &Harness<'_, App>,
) -> std::sync::Arc<tautline_workbench::views::robot_3d::scene::Scene> {
    harness
        .state()
        .state
        .views
        .robot_3d
        .scene()
        .expect("it is there")
        .clone()
}

#[test]
fn a_click_selects_and_the_pointer_is_told_what_it_is_over() {
    let mut harness = workbench();
    open(&mut harness, session_of("mini", 6), true);
    let at = in_window(&harness, &drawn(&harness, 1));
    harness.hover_at(at);
    harness.run_ok();
    assert_eq!(harness.state().state.views.hovered, Selection::cable(1));
    assert!(
        harness
            .query_by_label_contains("Pulley 2: radius 18.0 mm")
            .is_some()
    );
    click(&mut harness, at);
    assert_eq!(harness.state().state.model.selection, Selection::cable(1));
    let pose = scene(&harness).measured[3];
    let at = in_window(&harness, &pose.position);
    click(&mut harness, at);
    let selection = harness.state().state.model.selection;
    assert_eq!(selection.cable, Some(1), "a pose adds to the cable");
    let label = selection.pose.expect("it is there");
    assert_eq!(scene(&harness).shown, ShownPose::Fitted(label));
    assert!(scene(&harness).cables[0].residual.is_some());
    let corner = harness.get_by_label("3D view").rect().left_top() + vec2(12.0, 60.0);
    click(&mut harness, corner);
    assert!(harness.state().state.model.selection.is_empty());
    assert_eq!(scene(&harness).shown, ShownPose::Home);
}

#[test]
fn keys_and_buttons_turn_the_view() {
    let mut harness = workbench();
    open(&mut harness, session_of("hall", 3), false);
    let forward = |harness: &Harness<'_, App>| {
        harness
            .state()
            .state
            .views
            .robot_3d
            .camera()
            .expect("it is there")
            .axes()[2]
    };
    let middle = harness.get_by_label("3D view").rect().center();
    harness.hover_at(middle);
    harness.run_ok();
    for (key, direction) in [
        (Key::Num1, Vec3::y()),
        (Key::Num2, -Vec3::x()),
        (Key::Num3, -Vec3::z()),
    ] {
        harness.key_press(key);
        harness.run_ok();
        assert!((forward(&harness) - direction).norm() < 1e-9, "{key:?}");
    }
    harness.get_by_label("Isometric").click();
    harness.run_ok();
    assert!(forward(&harness).amax() < 0.9);
    for name in [
        "Fit view (Home)",
        "Front",
        "Side",
        "Top",
        "Colour: Cable",
        "Show",
    ] {
        assert!(harness.query_by_label(name).is_some(), "{name}");
    }
    assert!(
        harness.query_by_label("Magnification").is_none(),
        "nothing is identified"
    );
}

#[test]
fn a_live_pose_comes_before_everything_else_and_another_session_is_fitted() {
    let mut harness = workbench();
    open(&mut harness, session_of("mini", 3), false);
    let before = camera(&harness);
    let pose = Pose::from_parts([0.05, 0.0, 0.1], [1.0, 0.0, 0.0, 0.0]);
    let state = &mut harness.state_mut().state;
    state.model.live_platform = Some(LivePlatform {
        trail: std::sync::Arc::default(),
        is_stopped: false,
        pose,
        tensions_n: vec![25.0; 8],
    });
    let plan = vec![PlannedPose::new(9, &pose)];
    let document = state.model.open.as_mut().expect("a session");
    assert!(document.edit(Edit::SetPlan(plan, "plan".into())));
    harness.run_ok();
    assert_eq!(scene(&harness).shown, ShownPose::Live);
    assert_eq!(scene(&harness).cables[5].tension_n, Some(25.0));
    assert_eq!(scene(&harness).planned, [pose.position]);
    assert_eq!(camera(&harness), before);
    harness.state_mut().state.model.live_platform = None;
    open(&mut harness, session_of("planar", 3), false);
    assert_ne!(camera(&harness), before);
    assert_eq!(scene(&harness).cables.len(), 4);
}

#[test]
fn a_click_on_a_pulley_pins_its_coordinates_and_a_second_click_clears_them() {
    let mut harness = workbench();
    open(&mut harness, session_of("hall", 3), false);
    let centre = scene(&harness).cables[1].wheel.centre;
    let at = in_window(&harness, &centre);
    let pinned = |harness: &Harness<'_, App>| {
        let view = &harness.state().state.views.robot_3d;
        view.options.pinned.iter().copied().collect::<Vec<_>>()
    };
    click(&mut harness, at);
    assert_eq!(pinned(&harness), [1]);
    assert_eq!(harness.state().state.model.selection, Selection::cable(1));
    click(&mut harness, at);
    assert!(pinned(&harness).is_empty());
}

#[test]
fn the_frame_steps_back_and_displacements_are_coloured_by_length() {
    let mut harness = workbench();
    open(&mut harness, session_of("mini", 4), true);
    for (name, is_done) in [
        (
            "Frame: Transparent",
            (|options| options.frame == FrameLook::Transparent) as fn(&Options) -> bool,
        ),
        ("Frame: Hidden", |options| {
            options.frame == FrameLook::Hidden
        }),
        ("Length", |options| {
            options.arrow_colour == ArrowColour::Length
        }),
        // There is no tolerance yet.
        ("Tolerance", |options| {
            options.arrow_colour == ArrowColour::Length
        }),
    ] {
        if harness.query_by_label(name).is_none() {
            harness.get_by_label("Show").click();
            harness.run_ok();
        }
        harness.get_by_label(name).click();
        harness.run_ok();
        let options = &harness.state().state.views.robot_3d.options;
        assert!(is_done(options), "{name}");
    }
    let model = &mut harness.state_mut().state.model;
    let open = model.open.as_mut().expect("a session");
    open.record(|session| session.settings.tolerance_m = Some(2e-3));
    harness.run_ok();
    assert_eq!(scene(&harness).tolerance_m, Some(2e-3));
    if harness.query_by_label("Tolerance").is_none() {
        harness.get_by_label("Show").click();
        harness.run_ok();
    }
    harness.get_by_label("Tolerance").click();
    harness.run_ok();
    let options = &harness.state().state.views.robot_3d.options;
    assert_eq!(options.arrow_colour, ArrowColour::Tolerance);
}

#[test]
fn depth_is_shown_as_was_chosen_and_what_is_selected_is_framed() {
    let mut harness = workbench();
    open(&mut harness, session_of("mini", 4), false);
    assert_eq!(camera(&harness).projection(), Projection::Perspective);
    harness.get_by_label("Projection: perspective").click();
    harness.run_ok();
    let orthographic = camera(&harness);
    assert_eq!(orthographic.projection(), Projection::Orthographic);
    assert_eq!(orthographic.axes(), camera(&harness).axes());
    let from = harness.get_by_label("3D view").rect().center() + vec2(60.0, 40.0);
    harness.hover_at(from);
    harness.drag_at(from);
    harness.run_ok();
    harness.hover_at(from + vec2(50.0, 10.0));
    harness.run_ok();
    harness.drop_at(from + vec2(50.0, 10.0));
    harness.run_ok();
    assert_ne!(camera(&harness).axes(), orthographic.axes(), "it is turned");
    assert_eq!(camera(&harness).projection(), Projection::Orthographic);
    harness.get_by_label("Projection: orthographic").click();
    harness.run_ok();
    assert_eq!(camera(&harness).projection(), Projection::Perspective);

    let height = |harness: &Harness<'_, App>| camera(harness).height_m();
    let whole = height(&harness);
    for selection in [Selection::cable(3), Selection::pose(2)] {
        harness.get_by_label("Fit view (Home)").click();
        harness.run_ok();
        harness.state_mut().state.model.selection = selection;
        harness.run_ok();
        harness.get_by_label("Frame selection (Shift+F)").click();
        // A step of the harness is a quarter of a second: the flight has ended.
        for _ in 0..6 {
            harness.step();
        }
        assert!(height(&harness) < 0.6 * whole, "{selection:?}");
    }
}

#[test]
fn what_was_pinned_belongs_to_its_session() {
    let mut harness = workbench();
    open(&mut harness, session_of("hall", 3), false);
    let options = &mut harness.state_mut().state.views.robot_3d.options;
    options.pin(1);
    open(&mut harness, session_of("planar", 3), false);
    let options = &harness.state().state.views.robot_3d.options;
    assert!(options.pinned.is_empty());
}

/// A workbench in which two clicks without a pause are a double-click.
pub fn quick_workbench() -> Harness<'static, App> {
    Harness::builder()
        .with_size(vec2(1280.0, 800.0))
        .with_step_dt(1.0 / 60.0)
        .with_max_steps(200)
        .build_eframe(|creation| App::new(creation, options()))
}

#[test]
fn a_double_click_beside_a_pulley_finds_it_and_one_far_from_all_shows_everything() {
    let mut harness = quick_workbench();
    open(&mut harness, session_of("mini", 6), true);
    let rect = harness.get_by_label("3D view").rect();
    let at = in_window(&harness, &drawn(&harness, 1));
    // Away from the robot, where nothing is drawn.
    let outwards = vec2((at.x - rect.center().x).signum() * 20.0, 0.0);
    for (place, expected) in [
        (at + outwards, Some(1)),
        (rect.left_bottom() + vec2(30.0, -60.0), None),
    ] {
        harness.state_mut().state.model.inspected = None;
        harness.run_ok();
        harness.hover_at(place);
        harness.run_ok();
        for _ in 0..2 {
            harness.drag_at(place);
            harness.drop_at(place);
        }
        harness.run_ok();
        assert_eq!(harness.state().state.model.inspected, expected, "{place}");
    }
}

#[test]
fn escape_clears_the_selection_unless_something_else_uses_it() {
    let mut harness = workbench();
    open(&mut harness, session_of("mini", 4), true);
    let selected = Selection {
        cable: Some(2),
        pose: Some(3),
    };
    let selection = |harness: &Harness<'_, App>| harness.state().state.model.selection;
    harness.state_mut().state.model.selection = selected;
    harness.run_ok();
    for open in ["View", "Command palette"] {
        harness.get_by_label(open).click();
        harness.run_ok();
        harness.key_press(Key::Escape);
        harness.run_ok();
        assert_eq!(selection(&harness), selected, "{open} closes instead");
    }
    harness.state_mut().state.model.screen = Screen::Phase(Phase::Modeling);
    harness.run_ok();
    harness.get_by_role_and_label(Role::Tab, "Pulleys").click();
    settle(&mut harness);
    harness
        .get_by_role_and_label(Role::TextInput, "Pulley radius")
        .focus();
    harness.run_ok();
    harness.key_press(Key::Escape);
    harness.run_ok();
    assert_eq!(selection(&harness), selected, "the field is left instead");
    harness.key_press(Key::Escape);
    harness.run_ok();
    assert_eq!(selection(&harness), Selection::default());
}

/// The answer of a window to a request for its picture: blue inside `rect`, black around it.
fn answer_screenshot(harness: &mut Harness<'_, App>, rect: egui::Rect) {
    let viewports = harness.output().viewport_output.values();
    let mut commands = viewports.flat_map(|viewport| viewport.commands.iter());
    let callback = commands.find_map(|command| match command {
        egui::ViewportCommand::Screenshot(callback) => Some(callback.clone()),
        _ => None,
    });
    let mut window = egui::ColorImage::filled([1280, 800], egui::Color32::BLACK);
    for y in rect.top() as usize..rect.bottom() as usize {
        for x in rect.left() as usize..rect.right() as usize {
            window[(x, y)] = egui::Color32::BLUE;
        }
    }
    callback.expect("a request").complete(window.into());
}

#[test]
fn the_menu_of_the_picture_resets_the_view_and_copies_the_picture() {
    let mut harness = workbench();
    open(&mut harness, session_of("mini", 4), false);
    let before = camera(&harness);
    let rect = harness.get_by_label("3D view").rect();
    let choose = |harness: &mut Harness<'_, App>, name: &str| {
        harness.get_by_label("3D view").click_secondary();
        harness.run_ok();
        harness.get_by_label(name).click();
        harness.step();
    };
    harness.get_by_label("Projection: perspective").click();
    harness.run_ok();
    assert_ne!(camera(&harness), before);
    choose(&mut harness, "Reset view");
    harness.run_ok();
    assert_eq!(camera(&harness), before);
    choose(&mut harness, "Copy picture");
    answer_screenshot(&mut harness, rect);
    harness.step();
    let commands = &harness.output().platform_output.commands;
    let copied = commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyImage(image) => Some(image),
        _ => None,
    });
    let picture = copied.expect("a picture");
    assert!(picture.pixels.iter().all(|c| *c == egui::Color32::BLUE));
    let [width, height] = picture.size.map(|side| side as f32);
    assert!((vec2(width, height) - rect.size()).abs().max_elem() <= 1.0);
}
