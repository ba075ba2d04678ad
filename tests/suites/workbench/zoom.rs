//! The mouse wheel: the camera approaches parts and never passes through them.

use egui::Theme;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tautline_core::geometry::Vec3;
use tautline_core::measurement::Measurements;
use tautline_core::robot::presets;
use tautline_workbench::model::Selection;
use tautline_workbench::views::robot_3d::camera::{Camera, StandardView};
use tautline_workbench::views::robot_3d::drawing::{Drawing, Options};
use tautline_workbench::views::robot_3d::picking::Picture;
use tautline_workbench::views::robot_3d::scene::{Scene, SceneInputs, Wheel};

/// Shape of a solid part, independent of the drawing.
enum Solid {
    /// Axes, with half the sides, about a centre.
    Cuboid(Vec3, [Vec3; 3], Vec3),
    /// A pulley, without its groove: a cylinder as wide as its hub.
    Cylinder(Wheel),
}

impl Solid {
    /// Whether a point is inside by more than the rounding to single precision.
    fn holds(&self, p: &Vec3) -> bool {
        const SKIN: f64 = 1e-5;
        match self {
            Self::Cuboid(centre, axes, half) => {
                (0..3).all(|k| (p - centre).dot(&axes[k]).abs() < half[k] - SKIN)
            }
            Self::Cylinder(wheel) => {
                let d = p - wheel.centre;
                let along = d.dot(&wheel.normal);
                let across = (d - wheel.normal * along).norm();
                // The web between hub and rim is the thinnest part.
                along.abs() < 0.05 * wheel.radius_m - SKIN && across < 0.74 * wheel.radius_m - SKIN
            }
        }
    }
}

fn solids(scene: &Scene) -> Vec<Solid> {
    let mut solids = Vec::new();
    for [from, to] in &scene.frame.members {
        let axis = (to - from).normalize();
        let x = axis.cross(&Vec3::ith(axis.iamin(), 1.0)).normalize();
        let width = scene.frame.member_m;
        let half = Vec3::new(((to - from).norm() + width) / 2.0, width / 2.0, width / 2.0);
        solids.push(Solid::Cuboid(
            (from + to) / 2.0,
            [axis, x, axis.cross(&x)],
            half,
        ));
    }
    let (low, high) = (scene.platform.low, scene.platform.high);
    let centre = scene.pose.transform(&((low + high) / 2.0));
    let axes = [0, 1, 2].map(|k| scene.pose.orientation * Vec3::ith(k, 1.0));
    solids.push(Solid::Cuboid(centre, axes, (high - low) / 2.0));
    solids.extend(
        scene
            .cables
            .iter()
            .map(|cable| Solid::Cylinder(cable.wheel)),
    );
    solids
}

#[test]
fn the_eye_passes_through_nothing_in_500_zooms() {
    let mut random = ChaCha8Rng::seed_from_u64(23);
    let mut close = 0;
    for number in 0..500 {
        let name = presets::NAMES[number % presets::NAMES.len()];
        let robot = presets::find(name).expect("a preset").robot;
        let scene = SceneInputs::new(&robot, &Measurements::default()).scene();
        let solids = solids(&scene);
        let options = Options::default();
        let drawing = Drawing::new(&scene, &options, Selection::default(), Theme::Dark);
        let aspect = 1.5;
        let mut camera = Camera::new(
            scene.directions,
            StandardView::Isometric,
            &scene.extent(),
            aspect,
        );
        camera.orbit(
            random.random_range(0.0..800.0),
            random.random_range(-200.0..200.0),
            None,
        );
        // Often over a thing, else anywhere.
        let at = match random.random_range(0..4) {
            0 => {
                let cable = random.random_range(0..scene.cables.len());
                let wheel = &scene.cables[cable].wheel;
                let aside = Vec3::from_fn(|_, _| random.random_range(-0.4..0.4));
                camera.project(&(wheel.centre + aside * wheel.radius_m), aspect)
            }
            1 => camera.project(&scene.pose.position, aspect),
            2 => {
                let member = random.random_range(0..scene.frame.members.len());
                let [from, to] = scene.frame.members[member];
                camera.project(&from.lerp(&to, random.random_range(0.1..0.9)), aspect)
            }
            _ => None,
        };
        let at = at.map_or_else(
            || (random.random_range(0.0..1.0), random.random_range(0.0..1.0)),
            |seen| (seen.u, seen.v),
        );
        let size = [900.0, 600.0];
        for _ in 0..12 {
            let picture = Picture {
                scene: &scene,
                options: &options,
                camera: &camera,
                size,
            };
            let under = picture.met(&drawing, at.0 * size[0], at.1 * size[1]);
            let before = camera.eye();
            camera.zoom(random.random_range(1.1..4.0), at, aspect, under);
            let after = camera.eye();
            for step in 0..=400 {
                let p = before.lerp(&after, f64::from(step) / 400.0);
                let inside = solids.iter().any(|solid| solid.holds(&p));
                assert!(!inside, "{name}, zoom {number} at {at:?}");
            }
            if let Some(under) = under {
                assert!((under - after).dot(&camera.axes()[2]) > 0.0, "it is passed");
                close += usize::from((under - after).norm() < 0.02 * scene.frame.size_m);
            }
        }
    }
    assert!(close > 500, "things are reached: {close}");
}
