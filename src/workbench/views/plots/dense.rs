//! Very many points, and lines that change all the time, as pictures that are made once per view: their squares and segments
//! one by one would be most of every frame.

use std::fmt;

use egui::{Color32, ColorImage, Context, Pos2, Rect, TextureHandle, TextureOptions, Vec2};

use tautline_workflow::plot::figure::Curve;
use tautline_workflow::plot::scale::Scale;
use tautline_workflow::plot::{Colours, Plot};

/// Points or curves of a figure, and nothing else, on a transparent ground.
pub struct Picture {
    /// Its pixels.
    pub image: ColorImage,
    /// Where it belongs; each of its pixels is one of the screen.
    pub rect: Rect,
}

/// A picture on the graphics card.
pub struct PictureTexture {
    /// Its pixels.
    pub texture: TextureHandle,
    /// Where it belongs.
    pub rect: Rect,
}

impl PictureTexture {
    /// Puts a picture there.
    pub fn new(context: &Context, Picture { image, rect }: Picture) -> Self {
        Self {
            texture: context.load_texture("plot", image, TextureOptions::NEAREST),
            rect,
        }
    }
}

impl fmt::Debug for PictureTexture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PictureTexture")
            .field("rect", &self.rect)
            .finish_non_exhaustive()
    }
}

/// The picture of a plot that has very many points in its view; none for one that is drawn point by point, or where a side
/// has more than `most` pixels.
#[must_use]
pub fn picture(plot: &Plot<'_>, pixels_per_point: f32, most: usize) -> Option<Picture> {
    if !plot.seen.is_dense() {
        return None;
    }
    let mut pixels = Pixels::of(&plot.layout.scale, pixels_per_point, most)?;
    for (index, is_dimmed) in plot.order() {
        plot.dots(index, is_dimmed, &mut |rect, colour| {
            pixels.fill(rect, colour);
        });
    }
    Some(pixels.picture())
}

/// The picture of curves whose x never falls, and is NaN where they are interrupted; none where a side has more than `most`
/// pixels.
#[must_use]
pub fn traces(
    scale: &Scale,
    curves: &[Curve],
    colours: &Colours,
    (pixels_per_point, most): (f32, usize),
) -> Option<Picture> {
    let mut pixels = Pixels::of(scale, pixels_per_point, most)?;
    for curve in curves {
        let places = curve.points.iter().map(|[x, y]| scale.place(*x, *y));
        pixels.trace(places, curve.ink.colour(colours));
    }
    Some(pixels.picture())
}

/// Width of a curve (points).
const WIDTH: f32 = 1.5;

struct Pixels {
    image: ColorImage,
    /// Upper left corner (pixels of the screen).
    first: Pos2,
    pixels_per_point: f32,
}

impl Pixels {
    /// Those of the area of the data.
    fn of(scale: &Scale, pixels_per_point: f32, most: usize) -> Option<Self> {
        let first = (scale.rect.min * pixels_per_point).floor();
        let end = (scale.rect.max * pixels_per_point).ceil();
        let [width, height] = [end.x - first.x, end.y - first.y].map(|side| side as usize);
        (width <= most && height <= most).then(|| Self {
            image: ColorImage::filled([width, height], Color32::TRANSPARENT),
            first,
            pixels_per_point,
        })
    }

    fn picture(self) -> Picture {
        let [width, height] = self.image.size;
        let size = Vec2::new(width as f32, height as f32) / self.pixels_per_point;
        Picture {
            rect: Rect::from_min_size(self.first / self.pixels_per_point, size),
            image: self.image,
        }
    }

    /// Draws a line along x: in each column from the least to the greatest height that it has there, with smooth ends.
    fn trace(&mut self, places: impl Iterator<Item = Pos2>, colour: Color32) {
        let [width, height] = self.image.size;
        let mut columns = vec![[f32::INFINITY, f32::NEG_INFINITY]; width];
        let mut before: Option<Pos2> = None;
        for place in places {
            let place = place * self.pixels_per_point - self.first.to_vec2();
            if !place.any_nan() {
                let from = before.unwrap_or(place);
                let slope = (place.y - from.y) / (place.x - from.x).max(f32::MIN_POSITIVE);
                let [first, last] = [from.x, place.x].map(|x| x.floor().max(0.0) as usize);
                for column in first..=last.min(width.saturating_sub(1)) {
                    // Where the segment enters and leaves the column.
                    let [left, right] = [column, column + 1].map(|edge| {
                        let x = (edge as f32).clamp(from.x, place.x);
                        if x >= place.x {
                            place.y
                        } else {
                            from.y + slope * (x - from.x)
                        }
                    });
                    let [low, high] = &mut columns[column];
                    *low = low.min(left).min(right);
                    *high = high.max(left).max(right);
                }
                before = Some(place);
            } else {
                before = None;
            }
        }
        let half = 0.5 * WIDTH * self.pixels_per_point;
        for (column, [low, high]) in columns.into_iter().enumerate() {
            let (top, bottom) = (low - half, high + half);
            let rows = top.max(0.0) as usize..(bottom.max(0.0).ceil() as usize).min(height);
            for row in rows {
                let (above, below) = (row as f32, row as f32 + 1.0);
                let covered = (bottom.min(below) - top.max(above)).clamp(0.0, 1.0);
                if let Some(pixel) = self.image.pixels.get_mut(row * width + column) {
                    *pixel = if covered < 1.0 {
                        pixel.blend(colour.gamma_multiply(covered))
                    } else {
                        colour
                    };
                }
            }
        }
    }

    /// Fills the pixels whose centres are inside, as the graphics card does.
    fn fill(&mut self, rect: Rect, colour: Color32) {
        let [width, height] = self.image.size;
        let first = self.first;
        let bound = |place: f32, first: f32, most: usize| {
            let place = (place * self.pixels_per_point - first - 0.5).ceil();
            (place.max(0.0) as usize).min(most)
        };
        let columns = bound(rect.min.x, first.x, width)..bound(rect.max.x, first.x, width);
        for row in bound(rect.min.y, first.y, height)..bound(rect.max.y, first.y, height) {
            let row = self.image.pixels.get_mut(row * width..(row + 1) * width);
            for pixel in row
                .and_then(|row| row.get_mut(columns.clone()))
                .into_iter()
                .flatten()
            {
                *pixel = pixel.blend(colour);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use egui::Theme;

    use super::*;
    use crate::model::Selection;
    use crate::theme;
    use crate::views::plots::screen::colours;
    use tautline_workflow::plot::figure::{Ink, Point, Series};
    use tautline_workflow::plot::{Figure, Layout, VisiblePoints};

    fn figure(count: i32) -> Figure {
        let point = |k: i32| Point::new(f64::from(k), (f64::from(k) * 0.7).sin());
        Figure {
            series: vec![Series::of_cable(
                0,
                "cable-1",
                (0..count).map(point).collect(),
            )],
            ..Figure::default()
        }
    }

    fn pictured(figure: &Figure, pixels_per_point: f32, most: usize) -> Option<Picture> {
        let whole = Rect::from_min_max(Pos2::new(10.25, 20.0), Pos2::new(2010.25, 140.0));
        let width = |text: &str| 6.0 * text.len() as f32;
        let layout = Layout::new(figure, figure.whole(), whole, &width);
        let selection = Selection::default();
        let plot = Plot {
            figure,
            layout: &layout,
            seen: &VisiblePoints::new(figure, &layout.scale, selection, pixels_per_point),
            selection,
            colours: &colours(theme::palette(Theme::Dark)),
        };
        picture(&plot, pixels_per_point, most)
    }

    #[test]
    fn a_trace_has_its_width_its_extremes_and_its_gaps() {
        let scale = Scale {
            view: [[0.0, 100.0], [0.0, 50.0]],
            rect: Rect::from_min_size(Pos2::new(7.0, 3.0), Vec2::new(100.0, 50.0)),
        };
        let curve = Curve {
            name: String::new(),
            ink: Ink::Cable(0),
            dashed: false,
            points: vec![
                [0.0, 10.0],
                [20.5, 10.0],
                [20.5, 40.0],
                [40.0, 10.0],
                [f64::NAN, f64::NAN],
                [60.0, 30.0],
                [99.0, 30.0],
            ],
        };
        let colours = colours(theme::palette(Theme::Dark));
        for pixels_per_point in [1.0, 2.0] {
            let curves = std::slice::from_ref(&curve);
            let picture =
                traces(&scale, curves, &colours, (pixels_per_point, 4096)).expect("small");
            let [width, height] = picture.image.size;
            let along = |x: f32| (x * pixels_per_point) as usize;
            let covered = |x: f32| {
                let rows = (0..height).map(|row| &picture.image.pixels[row * width + along(x)]);
                let alpha: f32 = rows.map(|pixel| f32::from(pixel.a()) / 255.0).sum();
                alpha / pixels_per_point
            };
            // As wide as a line, as high as the step, nothing in the gap.
            for x in [5.5, 15.5, 80.5] {
                assert!((covered(x) - WIDTH).abs() < 0.05, "{x}: {}", covered(x));
            }
            assert!(
                (covered(20.5) - 30.0 - WIDTH).abs() < 0.8,
                "{}",
                covered(20.5)
            );
            assert_eq!(covered(50.5), 0.0);
            let middle = |x: f32, y: f32| {
                picture.image.pixels[along(50.0 - y) * width + along(x)] == colours.cables[0]
            };
            assert!(middle(20.5, 25.5) && middle(30.0, 25.0));
            let most = along(100.0) - 1;
            assert!(traces(&scale, curves, &colours, (pixels_per_point, most)).is_none());
        }
    }

    #[test]
    fn few_points_and_pictures_that_are_too_large_are_drawn_otherwise() {
        assert!(pictured(&figure(900), 1.0, 4096).is_none());
        assert!(pictured(&figure(50_000), 1.0, 1024).is_none());
    }

    #[test]
    fn pixels_are_those_of_the_screen_and_every_outlier_has_some() {
        for pixels_per_point in [1.0, 1.5] {
            let mut many = figure(50_000);
            let alone = pictured(&many, pixels_per_point, 4096).expect("dense");
            let size = alone.image.size.map(|side| side as f32 / pixels_per_point);
            assert!((alone.rect.width() - size[0]).abs() < 1e-3);
            assert!((alone.rect.height() - size[1]).abs() < 1e-3);
            let corner = alone.rect.min * pixels_per_point;
            assert!((corner - corner.round()).length() < 1e-3, "{corner}");
            let mut points = many.series[0].points().to_vec();
            points[20_000].y = 40.0;
            many.series = vec![Series::of_cable(0, "cable-1", points)];
            let picture = pictured(&many, pixels_per_point, 4096).expect("dense");
            let [width, height] = picture.image.size;
            let of_outlier = &picture.image.pixels[..width * height / 2];
            let colour = theme::palette(Theme::Dark).cable(0);
            assert!(of_outlier.contains(&colour));
        }
    }
}
