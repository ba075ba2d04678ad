//! Shapes on a page.

use krilla::color::rgb;
use krilla::geom::{PathBuilder, Point, Rect, Size, Transform};
use krilla::image::Image;
use krilla::paint::{Fill, Stroke};
use krilla::surface::Surface;

use super::PdfError;
use super::faces::Faces;
use super::layout::Placed;
use crate::report::drawing::{Anchor, Ink, Shape};

/// Handle of a quarter of a circle as a cubic curve.
const ARC: f64 = 0.552_284_75;

fn point([x, y]: [f64; 2]) -> Point {
    Point::from_xy(x as f32, y as f32)
}

fn color(ink: Ink) -> rgb::Color {
    let [red, green, blue] = ink.rgb();
    rgb::Color::new(red, green, blue)
}

fn fill(surface: &mut Surface<'_>, ink: Ink) {
    surface.set_stroke(None);
    surface.set_fill(Some(Fill {
        paint: color(ink).into(),
        ..Fill::default()
    }));
}

/// Draws a shape.
pub fn shape(surface: &mut Surface<'_>, shape: &Shape, faces: &Faces) {
    match shape {
        Shape::Line {
            from,
            to,
            ink,
            width,
        } => {
            surface.set_fill(None);
            surface.set_stroke(Some(Stroke {
                paint: color(*ink).into(),
                width: *width as f32,
                ..Stroke::default()
            }));
            let mut path = PathBuilder::new();
            path.move_to(from[0] as f32, from[1] as f32);
            path.line_to(to[0] as f32, to[1] as f32);
            if let Some(path) = path.finish() {
                surface.draw_path(&path);
            }
        }
        Shape::Area { at, size, ink } => {
            fill(surface, *ink);
            let [x, y, w, h] = [at[0], at[1], size[0], size[1]].map(|v| v as f32);
            let mut path = PathBuilder::new();
            if let Some(area) = Rect::from_xywh(x, y, w, h) {
                path.push_rect(area);
            }
            if let Some(path) = path.finish() {
                surface.draw_path(&path);
            }
        }
        Shape::Dot { at, radius, ink } => {
            fill(surface, *ink);
            disc(surface, *at, *radius);
        }
        Shape::Text {
            at,
            size,
            anchor,
            ink,
            bold,
            text,
        } => {
            fill(surface, *ink);
            let width = match anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => 0.5 * faces.width(text, *size, *bold),
                Anchor::End => faces.width(text, *size, *bold),
            };
            let face = faces.get(*bold);
            let glyphs = face.glyphs(text);
            let start = point([at[0] - width, at[1]]);
            surface.draw_glyphs(start, &glyphs, face.font.clone(), text, *size as f32, false);
        }
    }
}

fn disc(surface: &mut Surface<'_>, [x, y]: [f64; 2], radius: f64) {
    let at = |dx: f64, dy: f64| [(x + dx * radius) as f32, (y + dy * radius) as f32];
    let mut path = PathBuilder::new();
    let [sx, sy] = at(1.0, 0.0);
    path.move_to(sx, sy);
    for (cos, sin) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
        // From (cos, sin) to (-sin, cos), a quarter further.
        let [x1, y1] = at(cos - ARC * sin, sin + ARC * cos);
        let [x2, y2] = at(-sin + ARC * cos, cos + ARC * sin);
        let [x3, y3] = at(-sin, cos);
        path.cubic_to(x1, y1, x2, y2, x3, y3);
    }
    path.close();
    if let Some(path) = path.finish() {
        surface.draw_path(&path);
    }
}

/// Draws a picture.
pub fn picture(surface: &mut Surface<'_>, placed: &Placed) -> Result<(), PdfError> {
    let image = Image::from_png(placed.png.clone().into(), true).map_err(PdfError::Picture)?;
    let [width, height] = placed.size.map(|v| v as f32);
    if let Some(size) = Size::from_wh(width, height) {
        let at = Transform::from_translate(placed.at[0] as f32, placed.at[1] as f32);
        surface.push_transform(&at);
        surface.draw_image(image, size);
        surface.pop();
    }
    Ok(())
}
