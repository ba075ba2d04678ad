//! Cable numbers beside their pulleys, placed so that they cover neither a pulley nor each other; a distant number has
//! a leader line.

use std::f64::consts::TAU;

use egui::{Pos2, Rect, Vec2, vec2};

use super::picking::Picture;
use super::scene::{Reference, Wheel};

/// Distances from the edge of a pulley that are tried for a label (points).
const REACHES: [f32; 9] = [2.0, 14.0, 28.0, 44.0, 62.0, 84.0, 110.0, 140.0, 175.0];
/// Smallest distance of a label with a leader line (points).
const LEADER: f32 = 40.0;
/// Directions that are tried, relative to the direction away from the cable (rad).
const TURNS: [f32; 12] = [
    0.0, 0.5, -0.5, 1.0, -1.0, 1.5, -1.5, 2.0, -2.0, 2.6, -2.6, 3.1,
];
/// Number of points on a wheel's circle for its outline on the screen.
const AROUND: usize = 24;
/// Half the width of a wheel, in its radii.
const HALF_WIDTH: f64 = 0.15;
/// Side of the boxes along an arrow (points).
const ARROW: f32 = 8.0;
/// Half the size of a pulley drawn as a disc (points).
const DISC: f32 = 5.0;

/// Label of a pulley with its position.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Index of the cable.
    pub cable: usize,
    pub text: String,
    /// Rectangle of the text (points).
    pub rect: Rect,
    /// Position of the pulley.
    pub at: Pos2,
    /// Whether a leader line connects it with the pulley.
    pub has_leader: bool,
}

/// Pulley to be labelled.
struct LabelRequest {
    cable: usize,
    text: String,
    /// Rectangle covered by the pulley.
    pulley: Rect,
    /// Direction away from the cable.
    away: Vec2,
}

/// Rectangle in `rect` that a pulley covers at most (points); `None` behind the eye.
pub fn covered(picture: &Picture<'_>, rect: Rect, wheel: &Wheel) -> Option<Rect> {
    let centre = on_screen(picture, rect, &wheel.centre)?;
    let mut covered = Rect::from_center_size(centre, Vec2::splat(2.0 * DISC));
    let axis = wheel.normal;
    let x = axis.cross(&super::scene::unlike(&axis)).normalize();
    let y = axis.cross(&x);
    for k in 0..AROUND {
        let (sin, cos) = (TAU * k as f64 / AROUND as f64).sin_cos();
        for side in [-HALF_WIDTH, HALF_WIDTH] {
            let p = wheel.centre + (x * cos + y * sin + axis * side) * wheel.radius_m;
            covered.extend_with(on_screen(picture, rect, &p)?);
        }
    }
    Some(covered)
}

fn on_screen(
    picture: &Picture<'_>,
    rect: Rect,
    point: &tautline_core::geometry::Vec3,
) -> Option<Pos2> {
    let seen = picture.on_screen(point)?;
    Some(rect.min + vec2(seen.x as f32, seen.y as f32))
}

/// Rectangles covered by all drawn pulleys (points).
pub fn pulleys(picture: &Picture<'_>, rect: Rect) -> Vec<Rect> {
    let cables = 0..picture.scene.cables.len();
    let wheels = cables.flat_map(|index| {
        let placed = picture.placed(index);
        let other = placed.other.filter(|_| picture.options.nominal);
        [Some(placed.wheel), other].into_iter().flatten()
    });
    wheels
        .filter_map(|wheel| covered(picture, rect, &wheel))
        .collect()
}

/// Boxes along the arrows of displacements (points).
fn arrows(picture: &Picture<'_>, rect: Rect) -> Vec<Rect> {
    let magnification = picture.options.exaggeration_of(picture.scene);
    let cables = picture.scene.cables.iter();
    let cables = cables.filter(|_| picture.options.arrows);
    let moved = cables.filter_map(|cable| cable.moved.as_ref());
    let along = moved.flat_map(|moved| {
        let place = |k: u8| moved.from + moved.by * (magnification * f64::from(k) / 8.0);
        (0..=8).map(place)
    });
    along
        .filter_map(|point| on_screen(picture, rect, &point))
        .map(|at| Rect::from_center_size(at, Vec2::splat(ARROW)))
        .collect()
}

/// Labels of a picture in `rect`, none of them over a pulley or a `taken` rectangle; `size` returns the size of a text.
pub fn labels(
    picture: &Picture<'_>,
    rect: Rect,
    taken: &[Rect],
    size: impl Fn(&str) -> Vec2,
) -> Vec<Label> {
    let mut taken = taken.to_vec();
    taken.extend(pulleys(picture, rect));
    taken.extend(arrows(picture, rect));
    let mut labels = Vec::new();
    for wanted in wanted(picture, rect) {
        let size = size(&wanted.text) + vec2(4.0, 0.0);
        let Some((place, far)) = free_place(&wanted, size, rect, &taken) else {
            continue;
        };
        taken.push(place);
        labels.push(Label {
            cable: wanted.cable,
            text: wanted.text,
            rect: place,
            at: wanted.pulley.center(),
            has_leader: far >= LEADER,
        });
    }
    labels
}

/// Pulleys in the picture with their texts. A pulley that moved between two sessions is labelled at both positions.
fn wanted(picture: &Picture<'_>, rect: Rect) -> Vec<LabelRequest> {
    let scene = picture.scene;
    let mut all = Vec::new();
    let cables = scene.cables.iter().enumerate();
    // The inspected pulley is named in the header.
    for (cable, view) in cables.filter(|(cable, _)| picture.options.inspected != Some(*cable)) {
        let placed = picture.placed(cable);
        let number = view.label.clone();
        let has_moved = view.moved.and_then(|moved| moved.moved) == Some(true);
        let other = placed.other.filter(|_| picture.options.nominal);
        let wheels = match (other, scene.reference) {
            (Some(other), Reference::Other(names)) if has_moved => vec![
                (placed.wheel, format!("{number} {}", names.first)),
                (other, format!("{number} {}", names.second)),
            ],
            _ => vec![(placed.wheel, number)],
        };
        let anchor = placed.path.last();
        let anchor = anchor.and_then(|anchor| on_screen(picture, rect, anchor));
        for (wheel, text) in wheels {
            let Some(pulley) = covered(picture, rect, &wheel) else {
                continue;
            };
            let away = anchor.map_or(vec2(0.0, -1.0), |anchor| {
                (pulley.center() - anchor).normalized()
            });
            all.push(LabelRequest {
                cable,
                text,
                pulley,
                away,
            });
        }
    }
    all
}

/// Closest free rectangle for a text of `size` around a pulley, and its distance from the pulley's edge; `None` if the
/// pulley is not in the picture or nothing is free.
fn free_place(
    wanted: &LabelRequest,
    size: Vec2,
    inside: Rect,
    taken: &[Rect],
) -> Option<(Rect, f32)> {
    if !inside.contains(wanted.pulley.center()) {
        return None;
    }
    let half = 0.5 * (wanted.pulley.size() + size);
    let candidates = REACHES.into_iter().flat_map(|far| {
        TURNS.map(|turn| {
            let direction = egui::emath::Rot2::from_angle(turn) * wanted.away;
            // Distance to where the text touches the box around the pulley, plus `far`.
            let touches = (half.x / direction.x.abs()).min(half.y / direction.y.abs());
            let centre = wanted.pulley.center() + direction * (touches + far);
            (Rect::from_center_size(centre, size), far)
        })
    });
    let is_free = |(place, _): &(Rect, f32)| {
        inside.contains_rect(*place) && !taken.iter().any(|other| other.intersects(*place))
    };
    let mut candidates = candidates;
    candidates.find(is_free)
}

#[cfg(test)]
mod tests {
    use egui::pos2;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use tautline_core::geometry::Vec3;
    use tautline_core::measurement::Measurements;
    use tautline_core::robot::presets;
    use three_d::Srgba;

    use super::*;
    use crate::views::robot_3d::camera::{Camera, StandardView};
    use crate::views::robot_3d::drawing::Options;
    use crate::views::robot_3d::parts::SolidPart;
    use crate::views::robot_3d::scene::{Displacement, Scene, SceneInputs, SideNames};

    /// Scene of a preset whose pulleys are up to 5 mm from the drawing.
    fn scene_of(name: &str, random: &mut ChaCha8Rng) -> Scene {
        let robot = presets::find(name).unwrap().robot;
        let mut scene = SceneInputs::new(&robot, &Measurements::default()).scene();
        scene.reference = Reference::Drawing;
        for cable in &mut scene.cables {
            let by = Vec3::from_fn(|_, _| random.random_range(-5e-3..5e-3));
            cable.nominal = Some(cable.wheel);
            cable.wheel.entry += by;
            cable.wheel.centre += by;
            cable.moved = Some(Displacement {
                from: cable.wheel.entry - by,
                by,
                covariance: None,
                is_explained: true,
                moved: None,
            });
        }
        scene
    }

    /// Whether a triangle and a box intersect: no side of either separates them.
    fn meets(triangle: &[Pos2; 3], rect: &Rect) -> bool {
        let corners = [
            rect.left_top(),
            rect.right_top(),
            rect.right_bottom(),
            rect.left_bottom(),
        ];
        let sides = (0..3).map(|k| triangle[(k + 1) % 3] - triangle[k]);
        let mut axes = sides
            .map(|side| vec2(-side.y, side.x))
            .chain([Vec2::X, Vec2::Y]);
        !axes.any(|axis| {
            let span = |points: &[Pos2]| {
                let along = points.iter().map(|p| p.to_vec2().dot(axis));
                along.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| {
                    [low.min(v), high.max(v)]
                })
            };
            let ([a, b], [c, d]) = (span(triangle), span(&corners));
            b < c || d < a
        })
    }

    #[test]
    fn labels_cover_no_pulley_in_200_views() {
        let mut random = ChaCha8Rng::seed_from_u64(71);
        let rect = Rect::from_min_size(pos2(210.0, 60.0), vec2(640.0, 420.0));
        let (mut written, mut visible) = (0, 0);
        for view in 0..200 {
            let name = presets::NAMES[view % presets::NAMES.len()];
            let scene = scene_of(name, &mut random);
            let extent = scene.extent();
            let aspect = f64::from(rect.aspect_ratio());
            let side = StandardView::ALL[view % 4];
            let mut camera = Camera::new(scene.directions, side, &extent, aspect);
            camera.orbit(
                random.random_range(0.0..800.0),
                random.random_range(-200.0..200.0),
                None,
            );
            camera.zoom(random.random_range(0.7..2.5), (0.5, 0.5), aspect, None);
            let options = Options::default();
            let picture = Picture {
                scene: &scene,
                options: &options,
                camera: &camera,
                size: [rect.width(), rect.height()].map(f64::from),
            };
            let labels = labels(&picture, rect, &[], |text| {
                vec2(8.0 * text.len() as f32, 15.0)
            });
            written += labels.len();
            for index in 0..scene.cables.len() {
                let placed = picture.placed(index);
                let centre = on_screen(&picture, rect, &placed.wheel.centre);
                visible += usize::from(centre.is_some_and(|at| rect.shrink(20.0).contains(at)));
                let wheels = placed.other.iter().chain([&placed.wheel]);
                let parts = wheels.map(|wheel| SolidPart::wheel(wheel, Srgba::WHITE));
                for corners in parts.flat_map(|part| part.triangles()) {
                    let seen: Option<Vec<Pos2>> = corners
                        .iter()
                        .map(|p| on_screen(&picture, rect, p))
                        .collect();
                    let Some(triangle) = seen.and_then(|seen| <[Pos2; 3]>::try_from(seen).ok())
                    else {
                        continue;
                    };
                    for label in &labels {
                        let text = &label.text;
                        assert!(
                            !meets(&triangle, &label.rect),
                            "view {view}: {text} over {index}"
                        );
                    }
                }
            }
            for (k, label) in labels.iter().enumerate() {
                assert!(
                    rect.contains_rect(label.rect),
                    "view {view}: {}",
                    label.text
                );
                let others = labels[k + 1..].iter();
                assert!(
                    others
                        .clone()
                        .all(|other| !other.rect.intersects(label.rect))
                );
            }
        }
        assert!(
            10 * written > 8 * visible && visible > 300,
            "{written} labels of {visible}"
        );
    }

    #[test]
    fn both_places_of_a_pulley_that_moved_are_labelled() {
        let mut scene = scene_of("mini", &mut ChaCha8Rng::seed_from_u64(1));
        scene.reference = Reference::Other(SideNames {
            first: "A",
            second: "B",
        });
        for (index, cable) in scene.cables.iter_mut().enumerate() {
            if let Some(moved) = &mut cable.moved {
                moved.moved = Some(index == 4);
            }
        }
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(900.0, 600.0));
        let camera = Camera::new(
            scene.directions,
            StandardView::Isometric,
            &scene.extent(),
            1.5,
        );
        let options = Options::default();
        let picture = Picture {
            scene: &scene,
            options: &options,
            camera: &camera,
            size: [900.0, 600.0],
        };
        let labels = labels(&picture, rect, &[], |text| {
            vec2(8.0 * text.len() as f32, 15.0)
        });
        let texts: Vec<&str> = labels.iter().map(|label| label.text.as_str()).collect();
        assert_eq!(texts, ["1", "2", "3", "4", "5 A", "5 B", "6", "7", "8"]);
    }
}
