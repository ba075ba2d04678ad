//! Very many points as a picture that is made once per view: their squares one by one would be most of every frame.

use egui::{Color32, ColorImage, Pos2, Rect, Vec2};

use tautline_workflow::plot::Plot;

/// Points of a figure, and nothing else, on a transparent ground.
pub struct Picture {
    /// Its pixels.
    pub image: ColorImage,
    /// Where it belongs; each of its pixels is one of the screen.
    pub rect: Rect,
}

/// The picture of a plot that has very many points in its view; none for one that is drawn point by point, or where a side
/// has more than `most` pixels.
#[must_use]
pub fn picture(plot: &Plot<'_>, pixels_per_point: f32, most: usize) -> Option<Picture> {
    if !plot.seen.is_dense() {
        return None;
    }
    let scale = &plot.layout.scale;
    let first = (scale.rect.min * pixels_per_point).floor();
    let end = (scale.rect.max * pixels_per_point).ceil();
    let [width, height] = [end.x - first.x, end.y - first.y].map(|side| side as usize);
    if width > most || height > most {
        return None;
    }
    let mut pixels = Pixels {
        image: ColorImage::filled([width, height], Color32::TRANSPARENT),
        first,
        pixels_per_point,
    };
    for (index, is_dimmed) in plot.order() {
        plot.dots(index, is_dimmed, &mut |rect, colour| {
            pixels.fill(rect, colour);
        });
    }
    let size = Vec2::new(width as f32, height as f32) / pixels_per_point;
    Some(Picture {
        image: pixels.image,
        rect: Rect::from_min_size(first / pixels_per_point, size),
    })
}

struct Pixels {
    image: ColorImage,
    /// Upper left corner (pixels of the screen).
    first: Pos2,
    pixels_per_point: f32,
}

impl Pixels {
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
    use tautline_workflow::plot::figure::{Point, Series};
    use tautline_workflow::plot::{Figure, Layout, Seen};

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
            seen: &Seen::new(figure, &layout.scale, selection, pixels_per_point),
            selection,
            colours: &colours(theme::palette(Theme::Dark)),
        };
        picture(&plot, pixels_per_point, most)
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
