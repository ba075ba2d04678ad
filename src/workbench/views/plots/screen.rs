//! Canvas for plots that paints with egui, in the colours of the theme.

use std::sync::Arc;

use egui::{Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape};
use tautline_workflow::plot::draw::TEXT;
use tautline_workflow::plot::{Canvas, Colours, Stroke};

use crate::theme::Palette;

/// Colours of plots in a theme.
pub(crate) fn colours(palette: &Palette) -> Colours {
    let [below, _, above] = palette.diverging;
    Colours {
        ground: palette.ground,
        line: palette.line,
        text: palette.text,
        muted: palette.muted,
        accent: palette.accent,
        good: palette.good,
        warning: palette.warning,
        diverging: [below, above],
        cables: palette.cables,
    }
}

/// Measures the width of texts in plots.
pub(crate) fn text_width(painter: &Painter) -> impl Fn(&str) -> f32 + '_ {
    |text| {
        let font = FontId::proportional(TEXT);
        let galley = painter.layout_no_wrap(text.to_owned(), font, Color32::WHITE);
        galley.size().x
    }
}

/// Canvas on the screen. Consecutive rectangles form one mesh, because heat maps and dense data have thousands.
pub(crate) struct Screen {
    painter: Painter,
    whole: Rect,
    rects: Mesh,
    shapes: Vec<Shape>,
}

impl Screen {
    pub(crate) fn new(painter: Painter) -> Self {
        Self {
            whole: painter.clip_rect(),
            painter,
            rects: Mesh::default(),
            shapes: Vec::new(),
        }
    }

    /// Returns the shapes instead of painting them.
    pub(crate) fn into_shapes(mut self) -> Vec<Shape> {
        self.end_mesh();
        std::mem::take(&mut self.shapes)
    }

    fn end_mesh(&mut self) {
        if !self.rects.is_empty() {
            let rects = std::mem::take(&mut self.rects);
            self.shapes.push(Shape::Mesh(Arc::new(rects)));
        }
    }

    fn add(&mut self, shape: impl Into<Shape>) {
        self.end_mesh();
        self.shapes.push(shape.into());
    }

    fn paint(&mut self) {
        self.end_mesh();
        self.painter.extend(self.shapes.drain(..));
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        self.paint();
    }
}

fn stroke(stroke: Stroke) -> egui::Stroke {
    egui::Stroke::new(stroke.width, stroke.colour)
}

impl Canvas for Screen {
    fn clip(&mut self, part: Option<Rect>) {
        self.paint();
        let part = part.map_or(self.whole, |part| part.intersect(self.whole));
        self.painter.set_clip_rect(part);
    }

    fn fill(&mut self, rect: Rect, colour: Color32) {
        self.rects.add_colored_rect(rect, colour);
    }

    fn line(&mut self, places: &[Pos2], line: Stroke, dashed: bool) {
        let line = stroke(line);
        if dashed {
            self.end_mesh();
            self.shapes
                .extend(Shape::dashed_line(places, line, 5.0, 4.0));
        } else {
            self.add(Shape::line(places.to_vec(), line));
        }
    }

    fn polygon(&mut self, corners: Vec<Pos2>, colour: Color32) {
        self.add(Shape::convex_polygon(corners, colour, egui::Stroke::NONE));
    }

    fn disc(&mut self, centre: Pos2, radius: f32, colour: Color32) {
        self.add(Shape::circle_filled(centre, radius, colour));
    }

    fn ring(&mut self, centre: Pos2, radius: f32, line: Stroke) {
        self.add(Shape::circle_stroke(centre, radius, stroke(line)));
    }

    fn text(&mut self, at: Pos2, align: Align2, text: &str, size: f32, colour: Color32) {
        let font = FontId::proportional(size);
        let galley = self.painter.layout_no_wrap(text.to_owned(), font, colour);
        let rect = align.anchor_size(at, galley.size());
        self.add(Shape::galley(rect.min, galley, colour));
    }
}
