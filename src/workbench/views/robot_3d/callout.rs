//! Callouts: coordinates pinned beside their pulleys.

use egui::{FontId, Pos2, Rect, Stroke, StrokeKind, Vec2, vec2};

use super::overlay::Overlay;
use super::scene::{CableView, Displacement};
use crate::theme::GRID;
use tautline_workflow::wording::units::{fixed, signed};

const SIZE: f32 = 11.5;
/// Distances from the pulley that are tried for a callout (points).
const REACHES: [f32; 4] = [28.0, 56.0, 84.0, 120.0];
/// Number of directions tried at each distance.
const TURNS: usize = 12;

impl Overlay<'_> {
    /// Draws the callouts and adds their rectangles to `taken`.
    pub fn callouts(&self, taken: &mut Vec<Rect>) {
        let (painter, rect, picture, palette) =
            (self.painter, self.rect, self.picture, self.palette);
        for index in &picture.options.pinned {
            let Some(cable) = picture.scene.cables.get(*index) else {
                continue;
            };
            let Some(seen) = picture.on_screen(&picture.placed(*index).wheel.entry) else {
                continue;
            };
            let at = rect.min + vec2(seen.x as f32, seen.y as f32);
            if !rect.contains(at) {
                continue;
            }
            let font = FontId::proportional(SIZE);
            let galley = painter.layout_no_wrap(words(cable), font, palette.text);
            let size = galley.size() + Vec2::splat(2.0 * GRID);
            let place = place(at, size, rect.shrink(GRID), taken);
            let colour = palette.cable(*index);
            let from = place.clamp(at);
            painter.line_segment([from, at], Stroke::new(1.0, colour));
            painter.rect_filled(place, 4.0, palette.panel);
            painter.rect_stroke(place, 4.0, Stroke::new(1.0, colour), StrokeKind::Inside);
            painter.galley(place.min + Vec2::splat(GRID), galley, palette.text);
            taken.push(place);
        }
    }
}

/// Free rectangle near `at` and inside; if there is none, the nearest one inside.
fn place(at: Pos2, size: Vec2, inside: Rect, taken: &[Rect]) -> Rect {
    let candidates = REACHES.into_iter().flat_map(|reach| {
        (0..TURNS).map(move |turn| {
            let angle = std::f32::consts::TAU * turn as f32 / TURNS as f32;
            let direction = Vec2::angled(angle);
            Rect::from_center_size(at + direction * (0.5 * size + Vec2::splat(reach)), size)
        })
    });
    let is_free = |place: &Rect| {
        inside.contains_rect(*place) && !taken.iter().any(|other| other.intersects(*place))
    };
    let mut free = candidates.filter(is_free);
    free.next().unwrap_or_else(|| {
        let corner = at + vec2(REACHES[0], -REACHES[0] - size.y);
        let least = inside.min;
        let most = (inside.max - size).max(least);
        Rect::from_min_size(corner.clamp(least, most), size)
    })
}

/// Entry point of the cable, and its displacement from the drawing with standard deviation (mm).
fn words(cable: &CableView) -> String {
    let moved = cable.moved.as_ref();
    let mut text = format!("Pulley {}", cable.label);
    if moved.is_some() {
        text += ": entry point and displacement, mm";
    } else {
        text += ": entry point, mm";
    }
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let at = cable.wheel.entry[axis] * 1e3;
        text += &match moved {
            Some(moved) => line(name, at, moved, axis),
            None => format!("\n{name}  {}", fixed(at, 1)),
        };
    }
    text
}

fn line(name: &str, at: f64, moved: &Displacement, axis: usize) -> String {
    let variance = moved.covariance.map(|c| c[(axis, axis)].max(0.0));
    let sd = variance.map(|v| v.sqrt() * 1e3).filter(|sd| *sd > 0.0);
    let by = moved.by[axis] * 1e3;
    match sd {
        Some(sd) => {
            // Two digits of the standard deviation.
            let decimals = (1.0 - sd.log10().floor()).clamp(0.0, 4.0) as usize;
            let [at, sd] = [at, sd].map(|value| fixed(value, decimals));
            format!("\n{name}  {at}   {} ± {sd}", signed(by, decimals))
        }
        None => format!("\n{name}  {}   {}", fixed(at, 2), signed(by, 2)),
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;
    use tautline_core::geometry::Vec3;
    use tautline_core::measurement::Measurements;
    use tautline_core::robot::presets;

    use super::*;
    use crate::views::robot_3d::scene::SceneInputs;

    #[test]
    fn a_callout_says_where_and_how_far_with_its_standard_deviation() {
        let robot = presets::find("mini").expect("a preset").robot;
        let data = Measurements::default();
        let mut cable = SceneInputs::new(&robot, &data).scene().cables[0].clone();
        cable.wheel.entry = Vec3::new(0.5012, -0.378, 0.4415);
        assert_eq!(
            words(&cable),
            "Pulley 1: entry point, mm\nx  501.2\ny  -378.0\nz  441.5"
        );
        cable.moved = Some(Displacement {
            from: Vec3::zeros(),
            by: Vec3::new(1.2e-3, -4e-4, 0.0),
            covariance: Some(Matrix3::from_diagonal(&Vec3::new(1.44e-8, 4e-6, 0.0))),
            is_explained: true,
            moved: None,
        });
        assert_eq!(
            words(&cable),
            "Pulley 1: entry point and displacement, mm\nx  501.20   +1.20 ± 0.12\ny  -378.0   -0.4 ± 2.0\nz  441.50   0.00"
        );
    }

    #[test]
    fn callouts_stay_inside_and_apart() {
        let inside = Rect::from_min_size(Pos2::ZERO, vec2(600.0, 400.0));
        let size = vec2(120.0, 60.0);
        let mut taken = Vec::new();
        for at in [[10.0, 10.0], [30.0, 20.0], [590.0, 390.0], [300.0, 200.0]] {
            let found = place(at.into(), size, inside, &taken);
            assert!(inside.contains_rect(found), "{found:?}");
            assert!(!taken.iter().any(|other: &Rect| other.intersects(found)));
            taken.push(found);
        }
    }
}
