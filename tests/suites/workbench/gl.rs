//! The 3D view, down to its pixels.

use egui::{Color32, Theme, ThemePreference, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use image::RgbaImage;
use tautline_core::geometry::{Pose, Vec3};
use tautline_core::measurement::Measurements;
use tautline_core::robot::{Robot, presets};
use tautline_validation::support::harness::GlowTestRenderer;
use tautline_workbench::model::link::LivePlatform;
use tautline_workbench::shell::App;
use tautline_workbench::theme;
use tautline_workbench::views::offscreen::render_scene;
use tautline_workbench::views::robot_3d::camera::{Camera, StandardView};
use tautline_workbench::views::robot_3d::drawing::Options;
use tautline_workbench::views::robot_3d::picking::{Pickable, Picture};
use tautline_workbench::views::robot_3d::scene::{CableView, Scene, SceneInputs};

use crate::robot_3d::{in_window, open, session_of};
use crate::support::options;

const SIZE: [u32; 2] = [900, 600];

fn scene_of(robot: &Robot) -> Scene {
    SceneInputs::new(robot, &Measurements::default()).scene()
}

fn preset(name: &str) -> Robot {
    presets::find(name).expect("a preset").robot
}

fn bare() -> Options {
    Options {
        labels: false,
        ..Options::default()
    }
}

fn draw(scene: &Scene, camera: &Camera, theme: Theme) -> RgbaImage {
    render_scene(scene, &bare(), camera, (SIZE, 1.0), theme).expect("a picture")
}

fn rgb(image: &RgbaImage, x: u32, y: u32) -> [i32; 3] {
    let [r, g, b, _] = image.get_pixel(x, y).0;
    [r, g, b].map(i32::from)
}

fn colour(colour: Color32) -> [i32; 3] {
    [colour.r(), colour.g(), colour.b()].map(i32::from)
}

/// Points along a cable and around its wheel.
fn outline(cable: &CableView) -> Vec<Vec3> {
    let pieces = cable.path.windows(2);
    let along =
        pieces.flat_map(|ends| (0..=200).map(|k| ends[0].lerp(&ends[1], f64::from(k) / 200.0)));
    let wheel = &cable.wheel;
    let reach = wheel.radius_m;
    let around = [Vec3::x(), Vec3::y(), Vec3::z()].map(|v| v * reach);
    let wheel = around
        .into_iter()
        .flat_map(|v| [wheel.centre + v, wheel.centre - v]);
    along.chain(wheel).collect()
}

#[test]
fn a_pulley_moved_by_a_centimetre_changes_the_picture_there_and_only_there() {
    let robot = preset("mini");
    let before = scene_of(&robot);
    let mut moved = robot;
    moved.cables[4].pulley.entry_point_m[0] -= 0.01;
    let after = scene_of(&moved);
    assert_eq!(before.frame, after.frame, "inwards: the frame stays");
    let camera = Camera::new(
        before.directions,
        StandardView::Isometric,
        &before.extent(),
        1.5,
    );
    let pictures = [&before, &after].map(|scene| draw(scene, &camera, Theme::Dark));
    let options = bare();
    let mut changes = Vec::new();
    for scene in [&before, &after] {
        let picture = Picture {
            scene,
            options: &options,
            camera: &camera,
            size: SIZE.map(f64::from),
        };
        let outline = outline(&scene.cables[4]);
        changes.extend(outline.iter().filter_map(|p| picture.on_screen(p)));
    }
    let mut count = 0;
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            if rgb(&pictures[0], x, y) == rgb(&pictures[1], x, y) {
                continue;
            }
            count += 1;
            let (px, py) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            let near = changes.iter().any(|p| (p.x - px).hypot(p.y - py) < 10.0);
            assert!(near, "changed at {x}, {y}");
        }
    }
    assert!(count > 200, "{count} pixels changed");
}

#[test]
fn nothing_is_between_the_row_of_buttons_and_the_picture() {
    for theme in [ThemePreference::Dark, ThemePreference::Light] {
        let renderer = GlowTestRenderer::new().expect("a picture");
        let mut harness = harness(&renderer, 1.0);
        harness.ctx.set_theme(theme);
        open(&mut harness, session_of("mini", 3), false);
        let image = renderer.picture(&harness).expect("a picture");
        harness.state_mut().state.views.destroy();
        let [button, view] =
            ["Fit view (Home)", "3D view"].map(|name| harness.get_by_label(name).rect());
        let ground = colour(theme::palette(harness.ctx.theme()).ground);
        for y in button.top() as u32..view.top() as u32 + 8 {
            let seen = rgb(&image, view.left() as u32 + 3, y);
            assert_eq!(seen, ground, "{theme:?}, {y}");
        }
    }
}

#[test]
fn what_is_picked_is_what_is_drawn() {
    for name in presets::NAMES {
        let scene = scene_of(&preset(name));
        for (view, theme) in [
            (StandardView::Isometric, Theme::Dark),
            (StandardView::Front, Theme::Light),
            (StandardView::Top, Theme::Dark),
        ] {
            let camera = Camera::new(scene.directions, view, &scene.extent(), 1.5);
            let image = draw(&scene, &camera, theme);
            assert_eq!(rgb(&image, 2, 2), colour(theme::palette(theme).ground));
            let options = bare();
            let picture = Picture {
                scene: &scene,
                options: &options,
                camera: &camera,
                size: SIZE.map(f64::from),
            };
            let seen = check_cables(&picture, &image, theme);
            assert!(
                seen >= scene.cables.len() / 2,
                "{name} {view:?}: {seen} cables"
            );
        }
    }
}

/// Checks that pixels at which a cable is picked have its colour; returns the number of cables found.
fn check_cables(picture: &Picture<'_>, image: &RgbaImage, theme: Theme) -> usize {
    let palette = theme::palette(theme);
    let mut found = std::collections::BTreeSet::new();
    for cable in &picture.scene.cables {
        let ends = &cable.path[cable.path.len() - 2..];
        for share in [0.3, 0.5, 0.7] {
            let at = picture
                .on_screen(&ends[0].lerp(&ends[1], share))
                .expect("a place on the screen");
            let Some(Pickable::Cable(index)) = picture.pick(at.x, at.y) else {
                continue;
            };
            let wanted = colour(palette.cable(index));
            let near = (0..9).map(|k| {
                let (x, y) = (at.x as u32 + k % 3, at.y as u32 + k / 3);
                let pixel = rgb(image, x.saturating_sub(1), y.saturating_sub(1));
                (0..3)
                    .map(|c| (pixel[c] - wanted[c]).abs())
                    .max()
                    .unwrap_or(255)
            });
            // Members of the frame are not picked and may be in front.
            if near.min().unwrap_or(255) < 40 {
                found.insert(index);
            }
        }
    }
    found.len()
}

/// The workbench, with pictures of what it draws.
pub fn harness(renderer: &GlowTestRenderer, scale: f32) -> Harness<'static, App> {
    Harness::builder()
        .with_size(vec2(1280.0, 800.0))
        .with_pixels_per_point(scale)
        .with_max_steps(60)
        .renderer(renderer.clone())
        .build_eframe(|creation| App::new(creation, options()))
}

fn draws(harness: &Harness<'_, App>) -> u64 {
    harness.state().state.views.robot_3d.draws()
}

#[test]
fn the_robot_is_drawn_again_only_when_something_changed() {
    let renderer = GlowTestRenderer::new().expect("a picture");
    let mut harness = harness(&renderer, 1.0);
    open(&mut harness, session_of("mini", 4), true);
    let first = renderer.picture(&harness).expect("a picture");
    assert_eq!(draws(&harness), 1);
    let at = in_window(&harness, &Vec3::zeros());
    for step in 0..5 {
        harness.hover_at(at + vec2(step as f32, 0.0));
        harness.run_ok();
        renderer.picture(&harness).expect("a picture");
    }
    assert_eq!(draws(&harness), 1, "the pointer alone changes nothing");
    harness.hover_at(at - vec2(0.0, 400.0));
    harness.run_ok();
    assert!(
        renderer.picture(&harness).expect("a picture") == first,
        "the copy is the picture"
    );
    harness.drag_at(at + vec2(150.0, 60.0));
    harness.run_ok();
    harness.hover_at(at + vec2(200.0, 60.0));
    harness.run_ok();
    harness.drop_at(at + vec2(200.0, 60.0));
    harness.run_ok();
    renderer.picture(&harness).expect("a picture");
    let turned = draws(&harness);
    assert!(turned > 1, "it was turned");
    harness
        .state_mut()
        .state
        .model
        .context
        .set_theme(ThemePreference::Light);
    harness.run_ok();
    let light = renderer.picture(&harness).expect("a picture");
    assert_eq!(draws(&harness), turned + 1, "another theme");
    let rect = harness.get_by_label("3D view").rect();
    let corner = rect.left_center() + vec2(4.0, 0.0);
    let pixel = rgb(&light, corner.x as u32, corner.y as u32);
    assert_eq!(pixel, colour(theme::palette(Theme::Light).ground));
    harness.state_mut().state.views.destroy();
}

#[test]
fn where_the_processor_draws_a_platform_that_moves_is_drawn_ten_times_a_second() {
    let renderer = GlowTestRenderer::new().expect("a picture");
    let mut harness = Harness::builder()
        .with_size(vec2(1280.0, 800.0))
        // Every fifth frame is more than a tenth of a second later.
        .with_step_dt(1.0 / 47.0)
        .renderer(renderer.clone())
        .build_eframe(|creation| App::new(creation, options()));
    open(&mut harness, session_of("mini", 4), true);
    let mut show = |step: u32, is_stopped: bool| {
        let at = Vec3::new(1e-3 * f64::from(step), 0.0, 0.0);
        let live = LivePlatform {
            pose: Pose::from_parts(at.into(), [1.0, 0.0, 0.0, 0.0]),
            trail: std::sync::Arc::default(),
            is_stopped,
            tensions_n: Vec::new(),
        };
        harness.state_mut().state.model.live_platform = Some(live);
        harness.step();
        renderer.picture(&harness).expect("a picture");
        let view = &harness.state().state.views.robot_3d;
        let shown = view.scene().expect("a scene").pose.position;
        (view.draws(), view.is_software(), shown)
    };
    let (before, is_software, _) = show(0, false);
    let mut after = before;
    for step in 1..=100 {
        after = show(step, false).0;
    }
    let drawn = after - before;
    let expected = if is_software { 20..=21 } else { 100..=101 };
    assert!(expected.contains(&drawn), "{drawn} in 100 frames");
    // Where it stopped is shown at once.
    let (last, _, shown) = show(103, true);
    assert!(last > after && (shown.x - 0.103).abs() < 1e-12, "{shown}");
    harness.state_mut().state.views.destroy();
}

#[test]
fn at_twice_the_scale_lines_are_twice_as_wide() {
    let area = |scale: f32| {
        let renderer = GlowTestRenderer::new().expect("a picture");
        let mut harness = harness(&renderer, scale);
        open(&mut harness, session_of("planar", 3), false);
        let image = renderer.picture(&harness).expect("a picture");
        assert_eq!(image.width(), (1280.0 * scale) as u32);
        let wanted = colour(theme::palette(harness.ctx.theme()).cable(1));
        let count = image.pixels().filter(|p| {
            let found = [p.0[0], p.0[1], p.0[2]].map(i32::from);
            (0..3).all(|k| (found[k] - wanted[k]).abs() < 30)
        });
        let count = count.count() as f32;
        harness.state_mut().state.views.destroy();
        count
    };
    let ratio = area(2.0) / area(1.0);
    assert!((3.0..6.0).contains(&ratio), "{ratio}");
}
