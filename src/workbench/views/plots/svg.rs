//! A figure as SVG.

use std::fmt::Write;

use egui::{Align, Align2, Color32, Pos2, Rect, Stroke};

use super::canvas::{Canvas, corners, is_cross};
use crate::model::figure::Marker;

/// Collects drawings as SVG.
pub struct Svg {
    origin: Pos2,
    body: String,
    clips: usize,
    is_clipped: bool,
    head: String,
}

impl Svg {
    /// A picture of a part of the screen, on a ground.
    #[must_use]
    pub fn new(part: Rect, ground: Color32) -> Self {
        let (width, height) = (part.width(), part.height());
        let mut svg = Self {
            origin: part.min,
            body: String::new(),
            clips: 0,
            is_clipped: false,
            head: format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
                 viewBox=\"0 0 {width} {height}\" font-family=\"Inter, sans-serif\">\n"
            ),
        };
        svg.fill(part, ground);
        svg
    }

    /// The whole file.
    #[must_use]
    pub fn finish(mut self) -> String {
        self.clip(None);
        format!("{}{}</svg>\n", self.head, self.body)
    }

    fn at(&self, place: Pos2) -> String {
        format!(
            "{:.2},{:.2}",
            place.x - self.origin.x,
            place.y - self.origin.y
        )
    }

    fn places(&self, places: &[Pos2]) -> String {
        let places: Vec<String> = places.iter().map(|place| self.at(*place)).collect();
        places.join(" ")
    }

    fn add(&mut self, element: &str) {
        self.body.push_str(element);
        self.body.push('\n');
    }
}

/// Attributes of a colour under a name such as `fill`.
fn colour(name: &str, colour: Color32) -> String {
    let [r, g, b, alpha] = colour.to_srgba_unmultiplied();
    let mut text = format!("{name}=\"#{r:02x}{g:02x}{b:02x}\"");
    if alpha < 255 {
        // Writing to a string cannot fail.
        let _ = write!(text, " {name}-opacity=\"{:.3}\"", f32::from(alpha) / 255.0);
    }
    text
}

fn stroke(stroke: Stroke) -> String {
    format!(
        "{} stroke-width=\"{}\"",
        colour("stroke", stroke.color),
        stroke.width
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

impl Canvas for Svg {
    fn clip(&mut self, part: Option<Rect>) {
        if self.is_clipped {
            self.add("</g>");
        }
        self.is_clipped = part.is_some();
        if let Some(part) = part {
            self.clips += 1;
            let (id, min, size) = (self.clips, part.min - self.origin, part.size());
            self.add(&format!(
                "<clipPath id=\"c{id}\"><rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\"/></clipPath>\
                 <g clip-path=\"url(#c{id})\">",
                min.x, min.y, size.x, size.y
            ));
        }
    }

    fn fill(&mut self, rect: Rect, fill: Color32) {
        let min = rect.min - self.origin;
        self.add(&format!(
            "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\" {}/>",
            min.x,
            min.y,
            rect.width(),
            rect.height(),
            colour("fill", fill)
        ));
    }

    fn line(&mut self, places: &[Pos2], line: Stroke, dashed: bool) {
        let dashes = if dashed {
            " stroke-dasharray=\"5 4\""
        } else {
            ""
        };
        self.add(&format!(
            "<polyline points=\"{}\" fill=\"none\" {}{dashes}/>",
            self.places(places),
            stroke(line)
        ));
    }

    fn marker(&mut self, at: Pos2, marker: Marker, radius: f32, fill: Color32) {
        let places = corners(marker, at, radius);
        match places.as_slice() {
            [] => {
                let centre = at - self.origin;
                self.add(&format!(
                    "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{radius}\" {}/>",
                    centre.x,
                    centre.y,
                    colour("fill", fill)
                ));
            }
            [a, b, c, d] if is_cross(marker) => {
                let line = Stroke::new((0.5 * radius).max(1.0), fill);
                self.line(&[*a, *b], line, false);
                self.line(&[*c, *d], line, false);
            }
            _ => self.add(&format!(
                "<polygon points=\"{}\" {}/>",
                self.places(&places),
                colour("fill", fill)
            )),
        }
    }

    fn ring(&mut self, at: Pos2, radius: f32, line: Stroke) {
        let centre = at - self.origin;
        self.add(&format!(
            "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{radius}\" fill=\"none\" {}/>",
            centre.x,
            centre.y,
            stroke(line)
        ));
    }

    fn text(&mut self, at: Pos2, align: Align2, text: &str, size: f32, fill: Color32) {
        let anchor = match align.x() {
            Align::Min => "start",
            Align::Center => "middle",
            Align::Max => "end",
        };
        // Places are those of the box around a text, SVG wants the base line.
        let down = match align.y() {
            Align::Min => 0.95,
            Align::Center => 0.36,
            Align::Max => -0.24,
        };
        let place = at - self.origin;
        self.add(&format!(
            "<text x=\"{:.2}\" y=\"{:.2}\" font-size=\"{size}\" text-anchor=\"{anchor}\" {}>{}</text>",
            place.x,
            place.y + down * size,
            colour("fill", fill),
            escaped(text)
        ));
    }
}
