//! Annotations over the picture: cable numbers, scale, axes, legends, highlights.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, Vec2, pos2, vec2};

use super::drawing::{CableColour, Options, tension_colour, tension_range};
use super::picking::{OnScreen, Picture};
use super::scene::{Besides, round_length};
use super::{callout, words};
use crate::model::Selection;
use crate::theme::{self, GRID, Palette};

const SMALL: f32 = 11.5;
/// Width of the picture (points) from which on there is room for everything at its lower edge.
const WIDE: f32 = 520.0;

/// Writes over the picture in `rect`.
pub fn paint(
    painter: &Painter,
    rect: Rect,
    picture: &Picture<'_>,
    hovered: Selection,
    palette: &Palette,
) {
    highlight(painter, rect, picture, hovered, palette);
    let mut taken = captions(painter, rect, picture, palette);
    taken.push(triad(painter, rect, picture, palette));
    taken.push(scale(painter, rect, picture, palette));
    taken.extend(legends(painter, rect, picture, palette));
    if picture.options.callouts {
        callout::paint(painter, rect, picture, &mut taken, palette);
    }
    if picture.options.labels {
        numbers(painter, rect, picture, (hovered, taken), palette);
    }
}

fn place(rect: Rect, seen: &OnScreen) -> Pos2 {
    rect.min + vec2(seen.x as f32, seen.y as f32)
}

/// Writes a text on a ground of its own, so that it can be read over the robot; gives where it is.
fn text(
    painter: &Painter,
    at: Pos2,
    anchor: Align2,
    text: impl ToString,
    (colour, ground): (Color32, Color32),
) -> Rect {
    let font = FontId::proportional(SMALL);
    let galley = painter.layout_no_wrap(text.to_string(), font, colour);
    let rect = anchor.anchor_size(at, galley.size());
    painter.rect_filled(rect.expand2(vec2(2.0, 0.0)), 3.0, ground);
    painter.galley(rect.min, galley, colour);
    rect
}

/// Colours of what is less important, and of its ground.
fn quiet(palette: &Palette) -> (Color32, Color32) {
    (palette.muted, behind(palette))
}

fn behind(palette: &Palette) -> Color32 {
    palette.ground.gamma_multiply(0.72)
}

/// The cable and the pose under the pointer, here or in another view.
fn highlight(
    painter: &Painter,
    rect: Rect,
    picture: &Picture<'_>,
    hovered: Selection,
    palette: &Palette,
) {
    if let Some(cable) = hovered
        .cable
        .and_then(|index| picture.scene.cables.get(index))
    {
        let points: Option<Vec<Pos2>> = cable
            .path
            .iter()
            .map(|p| Some(place(rect, &picture.on_screen(p)?)))
            .collect();
        let stroke = Stroke::new(1.5, palette.text);
        painter.extend(points.map(|points| Shape::line(points, stroke)));
    }
    let pose = |label| picture.scene.measured.iter().find(|p| p.label == label);
    if let Some(pose) = hovered.pose.and_then(pose)
        && let Some(seen) = picture.on_screen(&pose.position)
    {
        painter.circle_stroke(place(rect, &seen), 8.0, Stroke::new(1.5, palette.text));
    }
}

/// Numbers of the cables beside their pulleys, where they hide neither each other nor what is written elsewhere.
fn numbers(
    painter: &Painter,
    rect: Rect,
    picture: &Picture<'_>,
    (hovered, mut taken): (Selection, Vec<Rect>),
    palette: &Palette,
) {
    for (index, cable) in picture.scene.cables.iter().enumerate() {
        let Some(seen) = picture.on_screen(&cable.wheel.centre) else {
            continue;
        };
        let is_hovered = hovered.cable == Some(index);
        let colour = if is_hovered {
            palette.text
        } else {
            palette.cable(index)
        };
        let label = (index + 1).to_string();
        let galley = painter.layout_no_wrap(label, theme::strong(13.0), colour);
        let radius = cable.wheel.radius_m * picture.scale_at(seen.depth_m);
        let reach = (radius as f32).min(0.2 * rect.height()).max(5.0) + 2.0;
        let from_cable = cable
            .path
            .last()
            .and_then(|anchor| picture.on_screen(anchor));
        let at = place(rect, &seen);
        let away = from_cable.map_or(vec2(0.0, -1.0), |anchor| {
            (at - place(rect, &anchor)).normalized()
        });
        if let Some(found) = free_place(at, away, reach, galley.size(), rect, &taken) {
            taken.push(found);
            painter.rect_filled(found.expand2(vec2(2.0, 0.0)), 3.0, behind(palette));
            painter.galley(found.min, galley, colour);
        }
    }
}

/// A place for a text of `size` around `at`, away from its cable if that is free; `None` if `at` is not in the picture.
fn free_place(
    at: Pos2,
    away: Vec2,
    reach: f32,
    size: Vec2,
    inside: Rect,
    taken: &[Rect],
) -> Option<Rect> {
    if !inside.contains(at) {
        return None;
    }
    let candidate = |turn: f32, far: f32| {
        let direction = egui::emath::Rot2::from_angle(turn) * away;
        let centre = at + direction * far + vec2(direction.x * size.x, direction.y * size.y) * 0.6;
        Rect::from_center_size(centre, size)
    };
    let turns = [0.0, 0.7, -0.7, 1.4, -1.4, 2.1, -2.1, 3.1];
    let places = [reach, reach + 14.0, reach + 28.0];
    let all = places
        .into_iter()
        .flat_map(|far| turns.map(|turn| candidate(turn, far)));
    let is_free = |place: &Rect| {
        inside.contains_rect(*place) && !taken.iter().any(|other| other.intersects(*place))
    };
    all.into_iter().find(is_free)
}

/// Which pose is shown, and what is larger than it is; gives where that is written.
fn captions(painter: &Painter, rect: Rect, picture: &Picture<'_>, palette: &Palette) -> Vec<Rect> {
    let at = rect.left_top() + vec2(3.0 * GRID, 2.0 * GRID);
    let Options {
        arrows, ellipsoids, ..
    } = *picture.options;
    let exaggeration = picture.options.exaggeration_of(picture.scene);
    let first = text(
        painter,
        at,
        Align2::LEFT_TOP,
        words::shown(picture.scene),
        quiet(palette),
    );
    let parts = match (arrows, ellipsoids) {
        (true, true) => "Displacements and 95 % ellipsoids",
        (true, false) => "Displacements",
        (false, true) => "95 % ellipsoids",
        (false, false) => return vec![first],
    };
    if picture.scene.besides != Besides::Nothing {
        let size = if exaggeration > 1.0 {
            format!("{parts}, magnified {exaggeration:.0}×")
        } else {
            format!("{parts}, true to scale")
        };
        let below = first.left_bottom() + vec2(0.0, 0.5 * GRID);
        let second = text(painter, below, Align2::LEFT_TOP, size, quiet(palette));
        return vec![first, second];
    }
    vec![first]
}

/// Directions of the base frame; gives where they are drawn.
fn triad(painter: &Painter, rect: Rect, picture: &Picture<'_>, palette: &Palette) -> Rect {
    let centre = rect.left_bottom() + vec2(9.0 * GRID, -9.0 * GRID);
    let [right, up, forward] = picture.camera.axes();
    let mut axes = [0, 1, 2];
    // Those that point away first: the nearer ones cover them.
    axes.sort_by(|a, b| forward[*b].total_cmp(&forward[*a]));
    for axis in axes {
        let tip = vec2(right[axis] as f32, -up[axis] as f32) * 22.0;
        painter.line_segment([centre, centre + tip], Stroke::new(2.0, palette.axes[axis]));
        if tip.length() > 5.0 {
            let name = ["x", "y", "z"][axis];
            let at = centre + tip + tip.normalized() * 7.0;
            let colours = (palette.text, Color32::TRANSPARENT);
            text(painter, at, Align2::CENTER_CENTER, name, colours);
        }
    }
    Rect::from_center_size(centre, Vec2::splat(64.0))
}

/// A length at the depth of the point that is orbited, and the distance of the floor's lines; gives where they are.
fn scale(painter: &Painter, rect: Rect, picture: &Picture<'_>, palette: &Palette) -> Rect {
    let per_metre = picture.size[1] / picture.camera.height_m();
    let length = round_length(110.0 / per_metre);
    let width = (length * per_metre) as f32;
    let left = rect.left_bottom() + vec2(19.0 * GRID, -3.0 * GRID);
    let right = left + vec2(width, 0.0);
    let stroke = Stroke::new(1.5, palette.muted);
    painter.line_segment([left, right], stroke);
    for end in [left, right] {
        painter.line_segment([end - vec2(0.0, 3.0), end + vec2(0.0, 3.0)], stroke);
    }
    let above = pos2((left.x + right.x) / 2.0, left.y - 5.0);
    let number = text(
        painter,
        above,
        Align2::CENTER_BOTTOM,
        metres(length),
        quiet(palette),
    );
    let drawn = number.union(Rect::from_two_pos(left, right));
    // Legends stand at the other end.
    if rect.width() < WIDE {
        return drawn;
    }
    let grid = format!("Grid {}", metres(picture.scene.frame.floor.spacing_m));
    let beside = right + vec2(4.0 * GRID, 4.0);
    let grid = text(painter, beside, Align2::LEFT_BOTTOM, grid, quiet(palette));
    drawn.union(grid)
}

fn metres(length: f64) -> String {
    if length < 0.9995 {
        let mm = length * 1e3;
        let decimals = (-mm.log10().floor()).max(0.0) as usize;
        format!("{mm:.decimals$} mm")
    } else {
        format!("{length:.0} m")
    }
}

/// What colours mean; gives where that is drawn.
fn legends(painter: &Painter, rect: Rect, picture: &Picture<'_>, palette: &Palette) -> Vec<Rect> {
    let scene = picture.scene;
    let mut drawn = Vec::new();
    let mut at = rect.right_bottom() - vec2(4.0 * GRID, 5.0 * GRID);
    let has_residuals = scene.measured.iter().any(|pose| pose.residual.is_some());
    let of_poses = picture.options.poses && has_residuals;
    let of_cables = picture.options.colour == CableColour::Residual;
    if of_poses || of_cables {
        let title = match (of_cables, of_poses) {
            (true, true) => "Cable and pose residuals (standard deviations)",
            (true, false) => "Cable residuals (standard deviations)",
            _ => "Pose residuals (standard deviations)",
        };
        let colour = |share: f32| palette.residual(f64::from(share) * 6.0 - 3.0);
        let marks = ["-3", "0", "+3"];
        drawn.push(ramp(painter, at, title, marks, colour, palette));
        at.y -= 11.0 * GRID;
    }
    if picture.options.colour == CableColour::Tension {
        let Some([low, high]) = tension_range(scene) else {
            let nothing = "No tensions known at this pose";
            drawn.push(text(
                painter,
                at,
                Align2::RIGHT_BOTTOM,
                nothing,
                quiet(palette),
            ));
            return drawn;
        };
        let marks = [low, (low + high) / 2.0, high].map(|t| format!("{t:.0}"));
        let marks = marks.each_ref().map(String::as_str);
        let colour = |share: f32| tension_colour(share, palette);
        drawn.push(ramp(painter, at, "Tension (N)", marks, colour, palette));
    }
    drawn
}

/// A scale of colours whose lower right corner is at `at`; gives where it and what is written at it are.
fn ramp(
    painter: &Painter,
    at: Pos2,
    title: &str,
    marks: [&str; 3],
    colour: impl Fn(f32) -> Color32,
    palette: &Palette,
) -> Rect {
    const WIDTH: f32 = 160.0;
    const STEPS: usize = 40;
    let left = at.x - WIDTH;
    for step in 0..STEPS {
        let share = |k: usize| k as f32 / STEPS as f32;
        let corners = [
            pos2(left + WIDTH * share(step), at.y - 6.0),
            pos2(left + WIDTH * share(step + 1), at.y),
        ];
        let middle = (share(step) + share(step + 1)) / 2.0;
        painter.rect_filled(Rect::from_points(&corners), 0.0, colour(middle));
    }
    let anchors = [Align2::LEFT_TOP, Align2::CENTER_TOP, Align2::RIGHT_TOP];
    for (k, (mark, anchor)) in marks.into_iter().zip(anchors).enumerate() {
        let x = left + WIDTH * 0.5 * k as f32;
        text(painter, pos2(x, at.y + 1.0), anchor, mark, quiet(palette));
    }
    let above = pos2(at.x, at.y - 9.0);
    let title = text(painter, above, Align2::RIGHT_BOTTOM, title, quiet(palette));
    title.union(Rect::from_two_pos(
        pos2(left, at.y - 6.0),
        at + vec2(0.0, SMALL + 3.0),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_do_not_cover_each_other() {
        let inside = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 300.0));
        let mut taken = Vec::new();
        for _ in 0..8 {
            let at = pos2(200.0, 150.0);
            let size = vec2(9.0, 15.0);
            let place = free_place(at, vec2(0.0, -1.0), 8.0, size, inside, &taken).unwrap();
            assert!(!taken.iter().any(|other: &Rect| other.intersects(place)));
            taken.push(place);
        }
        let outside = free_place(pos2(-5.0, 9.0), Vec2::X, 8.0, Vec2::splat(9.0), inside, &[]);
        assert!(outside.is_none());
    }

    #[test]
    fn lengths_have_the_unit_that_fits() {
        assert_eq!(metres(0.2), "200 mm");
        assert_eq!(metres(5.0), "5 m");
        assert_eq!(metres(0.0005), "0.5 mm");
    }
}
