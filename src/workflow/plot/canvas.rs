//! Drawing surface of figures: the screen, or a [`Drawing`](super::drawing::Drawing) for files.

use ecolor::Color32;
use emath::{Align2, Pos2, Rect, Vec2};

use super::figure::Marker;

/// Width and colour of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Width (points).
    pub width: f32,
    /// Colour.
    pub colour: Color32,
}

impl Stroke {
    /// A stroke of this width and colour.
    #[must_use]
    pub fn new(width: f32, colour: Color32) -> Self {
        Self { width, colour }
    }
}

/// Receives shapes in painting order; positions and sizes are in points, y downwards.
pub trait Canvas {
    /// Clips everything that follows to a rectangle, or ends clipping.
    fn clip(&mut self, part: Option<Rect>);
    /// A filled rectangle.
    fn fill(&mut self, rect: Rect, colour: Color32);
    /// A line through points.
    fn line(&mut self, places: &[Pos2], stroke: Stroke, dashed: bool);
    /// A filled convex polygon.
    fn polygon(&mut self, corners: Vec<Pos2>, colour: Color32);
    /// A filled disc.
    fn disc(&mut self, centre: Pos2, radius: f32, colour: Color32);
    /// A circle.
    fn ring(&mut self, centre: Pos2, radius: f32, stroke: Stroke);
    /// A line of text in a box that is aligned to a point.
    fn text(&mut self, at: Pos2, align: Align2, text: &str, size: f32, colour: Color32);

    /// A marker of about this radius.
    fn marker(&mut self, at: Pos2, marker: Marker, radius: f32, colour: Color32) {
        let place = |(x, y): (f32, f32)| at + radius * Vec2::new(x, y);
        let regular = |count: usize, start: f32, size: f32| -> Vec<Pos2> {
            (0..count)
                .map(|k| {
                    let angle = start + std::f32::consts::TAU * k as f32 / count as f32;
                    at + size * radius * Vec2::angled(angle)
                })
                .collect()
        };
        let up = -std::f32::consts::FRAC_PI_2;
        let corners = match marker {
            Marker::Circle => return self.disc(at, radius, colour),
            Marker::Plus | Marker::Cross => {
                let (a, b) = match marker {
                    Marker::Plus => ((1.2, 0.0), (0.0, 1.2)),
                    _ => ((0.9, 0.9), (-0.9, 0.9)),
                };
                let stroke = Stroke::new((0.5 * radius).max(1.0), colour);
                for (x, y) in [a, b] {
                    self.line(&[place((-x, -y)), place((x, y))], stroke, false);
                }
                return;
            }
            Marker::Square => [(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]
                .map(place)
                .into(),
            Marker::Diamond => regular(4, up, 1.25),
            Marker::Triangle => regular(3, up, 1.25),
            Marker::Wedge => regular(3, -up, 1.25),
            Marker::Pentagon => regular(5, up, 1.1),
        };
        self.polygon(corners, colour);
    }
}
