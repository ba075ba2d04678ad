//! Very many points as a picture, rendered once for a view: drawing their squares in every frame would dominate the
//! frame time.

use egui::{Color32, ColorImage, Context, Pos2, Rect, Shape, TextureHandle, TextureOptions, Vec2};

/// Pixels of a part of the screen, transparent where nothing was filled.
pub(crate) struct Picture {
    image: ColorImage,
    /// Upper left corner (pixels of the screen).
    first: Pos2,
    pixels_per_point: f32,
}

/// Picture on the graphics card.
pub(crate) struct PictureTexture {
    texture: TextureHandle,
    rect: Rect,
}

impl Picture {
    /// Empty picture; `None` if a side has more than `most` pixels.
    pub(crate) fn new(part: Rect, pixels_per_point: f32, most: usize) -> Option<Self> {
        let first = (part.min * pixels_per_point).floor();
        let end = (part.max * pixels_per_point).ceil();
        let [width, height] = [end.x - first.x, end.y - first.y].map(|side| side as usize);
        (width <= most && height <= most).then(|| Self {
            image: ColorImage::filled([width, height], Color32::TRANSPARENT),
            first,
            pixels_per_point,
        })
    }

    /// Fills the pixels whose centres are inside, like the graphics card.
    pub(crate) fn fill(&mut self, rect: Rect, colour: Color32) {
        let [width, height] = self.image.size;
        let bound = |place: f32, first: f32, most: usize| {
            let place = (place * self.pixels_per_point - first - 0.5).ceil();
            (place.max(0.0) as usize).min(most)
        };
        let [left, right] = [rect.min.x, rect.max.x].map(|x| bound(x, self.first.x, width));
        let [top, bottom] = [rect.min.y, rect.max.y].map(|y| bound(y, self.first.y, height));
        for row in top..bottom {
            for pixel in &mut self.image.pixels[row * width + left..row * width + right.max(left)] {
                *pixel = pixel.blend(colour);
            }
        }
    }

    /// Uploads the picture as a texture.
    pub(crate) fn upload(self, context: &Context) -> PictureTexture {
        let [width, height] = self.image.size;
        let size = Vec2::new(width as f32, height as f32) / self.pixels_per_point;
        PictureTexture {
            texture: context.load_texture("points of a plot", self.image, TextureOptions::NEAREST),
            rect: Rect::from_min_size(self.first / self.pixels_per_point, size),
        }
    }
}

impl PictureTexture {
    /// Shape of the picture at its position, pixel by pixel.
    pub(crate) fn shape(&self) -> Shape {
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        Shape::image(self.texture.id(), self.rect, whole, Color32::WHITE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_those_of_the_screen_and_are_blended() {
        for pixels_per_point in [1.0, 1.5] {
            let part = Rect::from_min_max(Pos2::new(10.25, 20.0), Pos2::new(60.25, 40.0));
            let mut picture = Picture::new(part, pixels_per_point, 4096).expect("small");
            let corner = picture.first;
            assert_eq!(corner, corner.round());
            let square = Rect::from_center_size(Pos2::new(30.0, 30.0), Vec2::splat(2.0));
            picture.fill(square, Color32::RED);
            picture.fill(square, Color32::from_white_alpha(128));
            let filled = picture.image.pixels.iter().filter(|pixel| pixel.a() > 0);
            let side = 2.0 * pixels_per_point;
            assert_eq!(filled.clone().count(), (side * side) as usize);
            assert!(
                filled
                    .clone()
                    .all(|pixel| pixel.g() > 100 && pixel.r() == 255)
            );
            // Rectangles partly or completely outside are clipped.
            picture.fill(
                Rect::from_center_size(part.min, Vec2::splat(4.0)),
                Color32::RED,
            );
            picture.fill(
                Rect::from_center_size(Pos2::ZERO, Vec2::splat(4.0)),
                Color32::RED,
            );
        }
    }

    #[test]
    fn a_picture_larger_than_a_texture_is_none() {
        let part = Rect::from_min_size(Pos2::ZERO, Vec2::new(2000.0, 20.0));
        assert!(Picture::new(part, 1.0, 1999).is_none());
    }
}
