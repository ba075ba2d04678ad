//! Annotations over the picture: cable numbers, scale, axes, legends, highlights.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, Vec2, pos2, vec2};

use super::drawing::{Band, Options, is_drawn};
use super::picking::{OnScreen, Picture};
use super::scene::Reference;
use super::{labels, words};
use crate::model::Selection;
use crate::theme::{self, GRID, Palette};
use tautline_workflow::plot::round::round_down;
use tautline_workflow::wording::list;

/// Text size (points).
pub(super) const SMALL: f32 = 11.5;
/// Width of the picture (points) at which all annotations fit at its lower edge.
pub(super) const WIDE: f32 = 520.0;

/// Height of the picture (points) at which text fits above the robot.
const HIGH: f32 = 260.0;
/// Height of the picture (points) up to which there is no room for the axes below the text.
const LOW: f32 = 120.0;

/// What is drawn over the picture of the robot, and with what.
pub struct Overlay<'a> {
    pub painter: &'a Painter,
    pub rect: Rect,
    pub picture: &'a Picture<'a>,
    pub palette: &'a Palette,
}

impl Overlay<'_> {
    /// Muted text; returns its rectangle.
    pub(super) fn text(&self, at: Pos2, anchor: Align2, text: impl ToString) -> Rect {
        let palette = self.palette;
        let (colour, ground) = (palette.muted, behind(palette));
        text_on(self.painter, at, anchor, text.to_string(), colour, ground)
    }

    /// Draws the annotations over the picture in `rect`.
    pub fn paint(&self, hovered: Selection) {
        let (rect, picture) = (self.rect, self.picture);
        self.highlight(hovered);
        let mut taken = self.captions();
        if rect.height() > LOW {
            taken.push(self.triad());
        }
        taken.push(self.scale());
        taken.extend(self.legends());
        if picture.options.callouts && picture.options.inspected.is_none() {
            taken.extend(labels::pulleys(picture, rect));
            self.callouts(&mut taken);
        }
        if picture.options.labels {
            self.numbers(hovered, &taken);
        }
    }

    /// Highlights the cable and the pose under the pointer, in this or another view.
    fn highlight(&self, hovered: Selection) {
        let (painter, rect, picture, palette) =
            (self.painter, self.rect, self.picture, self.palette);
        if let Some(index) = hovered.cable {
            let placed = picture.placed(index);
            let points: Option<Vec<Pos2>> = placed
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

    /// Draws the cable numbers beside their pulleys; they hide nothing.
    fn numbers(&self, hovered: Selection, taken: &[Rect]) {
        let (painter, picture, palette) = (self.painter, self.picture, self.palette);
        let font = theme::strong(13.0);
        let galley =
            |text: &str, colour| painter.layout_no_wrap(text.to_owned(), font.clone(), colour);
        let size = |text: &str| galley(text, palette.text).size();
        for label in labels::labels(picture, self.rect, taken, size) {
            let is_hovered = hovered.cable == Some(label.cable);
            let fades = picture.options.fades(picture.scene, label.cable);
            let colour = match (is_hovered, fades) {
                (true, _) => palette.text,
                (false, true) => palette.muted,
                (false, false) => palette.cable(label.cable),
            };
            if label.has_leader {
                let from = label.rect.clamp(label.at);
                painter.line_segment([from, label.at], Stroke::new(1.0, colour));
            }
            painter.rect_filled(label.rect, 3.0, behind(palette));
            let galley = galley(&label.text, colour);
            let at = label.rect.center() - galley.size() / 2.0;
            painter.galley(at, galley, colour);
        }
    }

    /// Draws the shown pose and the exaggeration; returns the rectangles of the texts.
    fn captions(&self) -> Vec<Rect> {
        let (rect, picture) = (self.rect, self.picture);
        let at = rect.left_top() + vec2(3.0 * GRID, 2.0 * GRID);
        let Options {
            arrows, ellipsoids, ..
        } = *picture.options;
        let exaggeration = picture.options.exaggeration_of(picture.scene);
        let first = self.text(at, Align2::LEFT_TOP, words::shown(picture.scene));
        if picture.scene.reference == Reference::Nothing {
            return vec![first];
        }
        if picture.options.inspected.is_some() {
            let below = first.left_bottom() + vec2(0.0, 0.5 * GRID);
            let scale = "True to scale, nominal in grey";
            let second = self.text(below, Align2::LEFT_TOP, scale);
            return vec![first, second];
        }
        let mut parts = vec!["pulleys"];
        parts.extend(arrows.then_some("arrows"));
        parts.extend(ellipsoids.then_some("95 % ellipsoids"));
        let is_judged = is_drawn(Band::Tolerance, picture.scene, picture.options);
        parts.extend(is_judged.then_some("tolerances"));
        let parts = list(&parts);
        // In two lines if one would cover the robot.
        let after = if rect.width() < 2.0 * WIDE {
            ":\n"
        } else {
            ": "
        };
        let below = first.left_bottom() + vec2(0.0, 0.5 * GRID);
        let (mut size, short) = match exaggeration > 1.0 {
            true => (
                format!("Displacements magnified {exaggeration:.0}×{after}{parts}"),
                format!("Displacements {exaggeration:.0}×"),
            ),
            false => (
                format!("Displacements true to scale{after}{parts}"),
                "Displacements true to scale".to_owned(),
            ),
        };
        let font = FontId::proportional(SMALL);
        let words = self
            .painter
            .layout_no_wrap(size.clone(), font, self.palette.muted);
        let place = Rect::from_min_size(below, words.size());
        let mut pulleys = labels::pulleys(picture, rect).into_iter();
        // In a low picture, or over a pulley, only the factor without its subject.
        if rect.height() < HIGH || pulleys.any(|pulley| pulley.intersects(place)) {
            size = short;
        }
        let second = self.text(below, Align2::LEFT_TOP, size);
        vec![first, second]
    }

    /// Draws the axes of the base frame; returns their rectangle.
    fn triad(&self) -> Rect {
        let (painter, palette) = (self.painter, self.palette);
        let centre = self.rect.left_bottom() + vec2(9.0 * GRID, -9.0 * GRID);
        let [right, up, forward] = self.picture.camera.axes();
        let mut axes = [0, 1, 2];
        // Axes pointing away first, so that nearer ones cover them.
        axes.sort_by(|a, b| forward[*b].total_cmp(&forward[*a]));
        for axis in axes {
            let tip = vec2(right[axis] as f32, -up[axis] as f32) * 22.0;
            painter.line_segment([centre, centre + tip], Stroke::new(2.0, palette.axes[axis]));
            if tip.length() > 5.0 {
                let name = ["x", "y", "z"][axis];
                let at = centre + tip + tip.normalized() * 7.0;
                let (colour, ground) = (palette.text, Color32::TRANSPARENT);
                let anchor = Align2::CENTER_CENTER;
                text_on(painter, at, anchor, name.to_owned(), colour, ground);
            }
        }
        Rect::from_center_size(centre, Vec2::splat(64.0))
    }

    /// Draws a scale bar at the depth of the target point, and the spacing of the floor's grid; returns their rectangle.
    fn scale(&self) -> Rect {
        let (painter, rect, picture) = (self.painter, self.rect, self.picture);
        let per_metre = picture.size[1] / picture.camera.height_m();
        let length = round_down(110.0 / per_metre);
        let width = (length * per_metre) as f32;
        let left = rect.left_bottom() + vec2(19.0 * GRID, -3.0 * GRID);
        let right = left + vec2(width, 0.0);
        let stroke = Stroke::new(1.5, self.palette.muted);
        painter.line_segment([left, right], stroke);
        for end in [left, right] {
            painter.line_segment([end - vec2(0.0, 3.0), end + vec2(0.0, 3.0)], stroke);
        }
        let above = pos2((left.x + right.x) / 2.0, left.y - 5.0);
        let number = self.text(above, Align2::CENTER_BOTTOM, metres(length));
        let drawn = number.union(Rect::from_two_pos(left, right));
        // Legends are at the other end.
        if rect.width() < WIDE {
            return drawn;
        }
        let grid = format!("Grid {}", metres(picture.scene.frame.floor.spacing_m));
        let beside = right + vec2(4.0 * GRID, 4.0);
        let grid = self.text(beside, Align2::LEFT_BOTTOM, grid);
        drawn.union(grid)
    }
}

fn place(rect: Rect, seen: &OnScreen) -> Pos2 {
    rect.min + vec2(seen.x as f32, seen.y as f32)
}

/// Text on a ground of its own; returns its rectangle.
fn text_on(
    painter: &Painter,
    at: Pos2,
    anchor: Align2,
    text: String,
    colour: Color32,
    ground: Color32,
) -> Rect {
    let font = FontId::proportional(SMALL);
    let galley = painter.layout_no_wrap(text, font, colour);
    let rect = anchor.anchor_size(at, galley.size());
    painter.rect_filled(rect.expand2(vec2(2.0, 0.0)), 3.0, ground);
    painter.galley(rect.min, galley, colour);
    rect
}

fn behind(palette: &Palette) -> Color32 {
    palette.ground.gamma_multiply(0.72)
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

#[cfg(test)]
pub(super) mod tests {
    use std::sync::{Arc, Mutex};

    use egui_kittest::Harness;
    use tautline_core::geometry::Vec3;
    use tautline_core::measurement::Measurements;
    use tautline_core::robot::presets;

    use super::*;
    use crate::views::robot_3d::camera::{Camera, StandardView};
    use crate::views::robot_3d::scene::{MeasuredPose, MeasuredPoses, Scene, SceneInputs};

    /// MINI, identified, with a pose.
    fn scene() -> Scene {
        let robot = presets::find("mini").expect("a preset").robot;
        let mut scene = SceneInputs::new(&robot, &Measurements::default()).scene();
        scene.reference = Reference::Drawing;
        let pose = MeasuredPose {
            label: 1,
            position: Vec3::zeros(),
            residual: Some(1.0),
        };
        scene.measured = Arc::new(MeasuredPoses::new(vec![pose]));
        scene
    }

    /// Runs `draw` over a picture of this size (points).
    pub fn in_picture<T: Clone + Send + 'static>(
        [width, height]: [f32; 2],
        draw: impl Fn(&Overlay<'_>) -> T + 'static,
    ) -> T {
        let drawn = Arc::new(Mutex::new(None));
        let (seen, scene) = (Arc::clone(&drawn), scene());
        let show = move |ui: &mut egui::Ui| {
            if ui.ctx().cumulative_pass_nr() == 0 {
                // Fonts are available from the next frame on.
                theme::install(ui.ctx());
                return;
            }
            let (options, extent) = (Options::default(), scene.extent());
            let aspect = f64::from(width / height);
            let view = StandardView::Isometric;
            let picture = Picture {
                scene: &scene,
                options: &options,
                camera: &Camera::new(scene.directions, view, &extent, aspect),
                size: [width, height].map(f64::from),
            };
            let rect = ui.ctx().content_rect();
            let what = draw(&Overlay {
                painter: &ui.painter_at(rect),
                rect,
                picture: &picture,
                palette: theme::of(ui),
            });
            *seen.lock().expect("one thread") = Some(what);
        };
        let size = vec2(width, height);
        let mut harness = Harness::builder().with_size(size).build_ui(show);
        harness.run();
        let drawn = drawn.lock().expect("one thread").clone();
        drawn.expect("it is drawn")
    }

    #[test]
    fn words_cover_no_pulley() {
        for size in [
            [400.0, 140.0],
            [460.0, 300.0],
            [632.0, 376.0],
            [900.0, 600.0],
        ] {
            let (words, pulleys) = in_picture(size, |overlay| {
                let pulleys = labels::pulleys(overlay.picture, overlay.rect);
                (overlay.captions(), pulleys)
            });
            for pulley in &pulleys {
                let covers = |words: &Rect| words.intersects(*pulley);
                assert!(!words.iter().any(covers), "{size:?}: {words:?}, {pulley:?}");
            }
        }
    }

    #[test]
    fn lengths_have_the_unit_that_fits() {
        assert_eq!(metres(0.2), "200 mm");
        assert_eq!(metres(5.0), "5 m");
        assert_eq!(metres(0.0005), "0.5 mm");
    }
}
