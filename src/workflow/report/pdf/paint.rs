//! Shapes on a page.

use ecolor::Color32;
use krilla::color::rgb;
use krilla::geom::{Path, PathBuilder, Point, Rect, Size, Transform};
use krilla::image::Image;
use krilla::num::NormalizedF32;
use krilla::paint::{Fill, FillRule, Stroke, StrokeDash};
use krilla::surface::Surface;

use super::PdfError;
use super::faces::Faces;
use super::layout::PlacedPicture;
use crate::plot::drawing::{Anchor, Shape};

/// Control point distance of a cubic Bezier curve for a quarter circle.
const ARC: f64 = 0.552_284_75;

/// A colour and its opacity.
fn color(colour: Color32) -> (rgb::Color, NormalizedF32) {
    let [red, green, blue, alpha] = colour.to_srgba_unmultiplied();
    let opacity = NormalizedF32::new(f32::from(alpha) / 255.0).unwrap_or(NormalizedF32::ONE);
    (rgb::Color::new(red, green, blue), opacity)
}

fn fill(surface: &mut Surface<'_>, colour: Color32) {
    let (paint, opacity) = color(colour);
    surface.set_stroke(None);
    surface.set_fill(Some(Fill {
        paint: paint.into(),
        opacity,
        ..Fill::default()
    }));
}

fn stroke(surface: &mut Surface<'_>, width: f64, colour: Color32, dashed: bool) {
    let (paint, opacity) = color(colour);
    surface.set_fill(None);
    surface.set_stroke(Some(Stroke {
        paint: paint.into(),
        opacity,
        width: width as f32,
        dash: dashed.then(|| StrokeDash {
            array: vec![5.0, 4.0],
            offset: 0.0,
        }),
        ..Stroke::default()
    }));
}

/// A path through points.
fn path(places: &[[f64; 2]], is_closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    let ([x, y], rest) = places.split_first()?;
    path.move_to(*x as f32, *y as f32);
    for [x, y] in rest {
        path.line_to(*x as f32, *y as f32);
    }
    if is_closed {
        path.close();
    }
    path.finish()
}

fn rectangle([x, y]: [f64; 2], [w, h]: [f64; 2]) -> Option<Path> {
    let rect = Rect::from_xywh(x as f32, y as f32, w as f32, h as f32)?;
    let mut path = PathBuilder::new();
    path.push_rect(rect);
    path.finish()
}

fn circle([x, y]: [f64; 2], radius: f64) -> Option<Path> {
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
    path.finish()
}

/// Draws a shape.
pub fn shape(surface: &mut Surface<'_>, shape: &Shape, faces: &Faces) {
    let path = match shape {
        Shape::Clip(None) => return surface.pop(),
        Shape::Clip(Some([at, size])) => {
            // Without a path nothing is clipped, but the end of the clip needs a counterpart.
            match rectangle(*at, *size) {
                Some(path) => surface.push_clip_path(&path, &FillRule::NonZero),
                None => surface.push_transform(&Transform::identity()),
            }
            return;
        }
        Shape::Line {
            places,
            width,
            colour,
            dashed,
        } => {
            stroke(surface, *width, *colour, *dashed);
            path(places, false)
        }
        Shape::Area { at, size, colour } => {
            fill(surface, *colour);
            rectangle(*at, *size)
        }
        Shape::Polygon { corners, colour } => {
            fill(surface, *colour);
            path(corners, true)
        }
        Shape::Disc { at, radius, colour } => {
            fill(surface, *colour);
            circle(*at, *radius)
        }
        Shape::Ring {
            at,
            radius,
            width,
            colour,
        } => {
            stroke(surface, *width, *colour, false);
            circle(*at, *radius)
        }
        Shape::Text {
            at: [x, y],
            size,
            anchor,
            colour,
            bold,
            text,
        } => {
            fill(surface, *colour);
            let width = match anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => 0.5 * faces.width(text, *size, *bold),
                Anchor::End => faces.width(text, *size, *bold),
            };
            let face = faces.get(*bold);
            let glyphs = face.glyphs(text);
            let start = Point::from_xy((x - width) as f32, *y as f32);
            surface.draw_glyphs(start, &glyphs, face.font.clone(), text, *size as f32, false);
            return;
        }
    };
    if let Some(path) = path {
        surface.draw_path(&path);
    }
}

/// Draws a picture.
pub fn picture(surface: &mut Surface<'_>, placed: &PlacedPicture) -> Result<(), PdfError> {
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
