//! Where a figure is drawn: the screen or a file.

use std::sync::Arc;

use egui::{Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, TextureId, Vec2};

use crate::model::figure::Marker;

/// Takes drawings in their order; places are points of the screen.
pub trait Canvas {
    /// Limits what follows to a part, or not any more.
    fn clip(&mut self, part: Option<Rect>);
    /// A filled rectangle.
    fn fill(&mut self, rect: Rect, colour: Color32);
    /// A line through places.
    fn line(&mut self, places: &[Pos2], stroke: Stroke, dashed: bool);
    /// A filled point.
    fn marker(&mut self, at: Pos2, marker: Marker, radius: f32, colour: Color32);
    /// A circle around a point.
    fn ring(&mut self, at: Pos2, radius: f32, stroke: Stroke);
    /// A text at a place.
    fn text(&mut self, at: Pos2, align: Align2, text: &str, size: f32, colour: Color32);
}

/// Corners of a marker; none for a disc, pairs of ends for crosses.
#[must_use]
pub fn corners(marker: Marker, at: Pos2, radius: f32) -> Vec<Pos2> {
    let place = |(x, y): (f32, f32)| at + radius * Vec2::new(x, y);
    let regular = |count: usize, start: f32, size: f32| {
        (0..count)
            .map(|k| {
                let angle = start + std::f32::consts::TAU * k as f32 / count as f32;
                at + size * radius * Vec2::angled(angle)
            })
            .collect()
    };
    let up = -std::f32::consts::FRAC_PI_2;
    match marker {
        Marker::Circle => Vec::new(),
        Marker::Square => [(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]
            .map(place)
            .into(),
        Marker::Diamond => regular(4, up, 1.25),
        Marker::Triangle => regular(3, up, 1.25),
        Marker::Wedge => regular(3, -up, 1.25),
        Marker::Pentagon => regular(5, up, 1.1),
        Marker::Plus => [(-1.2, 0.0), (1.2, 0.0), (0.0, -1.2), (0.0, 1.2)]
            .map(place)
            .into(),
        Marker::Cross => [(-0.9, -0.9), (0.9, 0.9), (-0.9, 0.9), (0.9, -0.9)]
            .map(place)
            .into(),
    }
}

/// Whether a marker is drawn with two lines instead of an area.
#[must_use]
pub fn is_cross(marker: Marker) -> bool {
    matches!(marker, Marker::Plus | Marker::Cross)
}

/// The screen. Rectangles that follow each other are one mesh: heat maps and dense data have thousands.
pub struct Screen {
    painter: Painter,
    whole: Rect,
    rects: Mesh,
}

impl Screen {
    /// Draws with a painter.
    #[must_use]
    pub fn new(painter: Painter) -> Self {
        Self {
            whole: painter.clip_rect(),
            painter,
            rects: Mesh::default(),
        }
    }

    /// A picture that fills a rectangle.
    pub fn picture(&mut self, texture: TextureId, rect: Rect) {
        self.flush();
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        self.painter.image(texture, rect, whole, Color32::WHITE);
    }

    fn flush(&mut self) {
        if !self.rects.is_empty() {
            self.painter
                .add(Shape::Mesh(Arc::new(std::mem::take(&mut self.rects))));
        }
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        self.flush();
    }
}

impl Canvas for Screen {
    fn clip(&mut self, part: Option<Rect>) {
        self.flush();
        let part = part.map_or(self.whole, |part| part.intersect(self.whole));
        self.painter.set_clip_rect(part);
    }

    fn fill(&mut self, rect: Rect, colour: Color32) {
        self.rects.add_colored_rect(rect, colour);
    }

    fn line(&mut self, places: &[Pos2], stroke: Stroke, dashed: bool) {
        self.flush();
        if dashed {
            self.painter
                .extend(Shape::dashed_line(places, stroke, 5.0, 4.0));
        } else {
            self.painter.line(places.to_vec(), stroke);
        }
    }

    fn marker(&mut self, at: Pos2, marker: Marker, radius: f32, colour: Color32) {
        self.flush();
        let places = corners(marker, at, radius);
        match places.as_slice() {
            [] => {
                self.painter.circle_filled(at, radius, colour);
            }
            [a, b, c, d] if is_cross(marker) => {
                let stroke = Stroke::new((0.5 * radius).max(1.0), colour);
                self.painter.line_segment([*a, *b], stroke);
                self.painter.line_segment([*c, *d], stroke);
            }
            _ => {
                self.painter
                    .add(Shape::convex_polygon(places, colour, Stroke::NONE));
            }
        }
    }

    fn ring(&mut self, at: Pos2, radius: f32, stroke: Stroke) {
        self.flush();
        self.painter.circle_stroke(at, radius, stroke);
    }

    fn text(&mut self, at: Pos2, align: Align2, text: &str, size: f32, colour: Color32) {
        self.flush();
        self.painter
            .text(at, align, text, FontId::proportional(size), colour);
    }
}
