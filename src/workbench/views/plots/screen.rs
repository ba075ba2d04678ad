//! Plots on the screen: a canvas that paints with egui, in the colours of the theme.

use std::sync::Arc;

use egui::{Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, TextureId};
use tautline_workflow::plot::draw::TEXT;
use tautline_workflow::plot::{Canvas, Colours, Stroke};

use super::straighten::straightened;
use crate::theme::Palette;

/// Colours of plots in a theme.
#[must_use]
pub fn colours(palette: &Palette) -> Colours {
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

/// Measures texts of plots.
pub fn text_width(painter: &Painter) -> impl Fn(&str) -> f32 + '_ {
    |text| {
        let font = FontId::proportional(TEXT);
        let galley = painter.layout_no_wrap(text.to_owned(), font, Color32::WHITE);
        galley.size().x
    }
}

/// By how much a line on the screen may differ from that of all its points (pixels).
const TOLERANCE: f32 = 0.3;

/// The screen. Rectangles that follow each other are one mesh: heat maps and dense data have thousands.
pub struct Screen {
    painter: Painter,
    whole: Rect,
    rects: Mesh,
}

impl Screen {
    /// Paints with a painter.
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
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        self.flushed().image(texture, rect, whole, Color32::WHITE);
    }

    /// The painter, once the rectangles so far are painted.
    fn flushed(&mut self) -> &mut Painter {
        if !self.rects.is_empty() {
            let rects = std::mem::take(&mut self.rects);
            self.painter.add(Shape::Mesh(Arc::new(rects)));
        }
        &mut self.painter
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        self.flushed();
    }
}

fn stroke(stroke: Stroke) -> egui::Stroke {
    egui::Stroke::new(stroke.width, stroke.colour)
}

impl Canvas for Screen {
    fn clip(&mut self, part: Option<Rect>) {
        let part = part.map_or(self.whole, |part| part.intersect(self.whole));
        self.flushed().set_clip_rect(part);
    }

    fn fill(&mut self, rect: Rect, colour: Color32) {
        self.rects.add_colored_rect(rect, colour);
    }

    fn line(&mut self, places: &[Pos2], line: Stroke, dashed: bool) {
        let (painter, line) = (self.flushed(), stroke(line));
        if dashed {
            painter.extend(Shape::dashed_line(places, line, 5.0, 4.0));
        } else {
            let tolerance = TOLERANCE / painter.pixels_per_point();
            painter.line(straightened(places, tolerance), line);
        }
    }

    fn polygon(&mut self, corners: Vec<Pos2>, colour: Color32) {
        self.flushed()
            .add(Shape::convex_polygon(corners, colour, egui::Stroke::NONE));
    }

    fn disc(&mut self, centre: Pos2, radius: f32, colour: Color32) {
        self.flushed().circle_filled(centre, radius, colour);
    }

    fn ring(&mut self, centre: Pos2, radius: f32, line: Stroke) {
        self.flushed().circle_stroke(centre, radius, stroke(line));
    }

    fn text(&mut self, at: Pos2, align: Align2, text: &str, size: f32, colour: Color32) {
        self.flushed()
            .text(at, align, text, FontId::proportional(size), colour);
    }
}
