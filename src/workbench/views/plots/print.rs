//! Rendering of a plot for print.

use egui::{Rect, Theme, vec2};
use tautline_workflow::plot::Layout;
use tautline_workflow::plot::draw::{self, TEXT};

use super::screen::{Screen, colours, text_width};
use crate::model::command::PlotPicture;
use crate::theme;
use crate::views::offscreen;

/// Width on paper (m): an A4 page without its margins.
const WIDTH_M: f64 = 0.160;
/// Size of the text on paper (pt).
const PRINTED_TEXT: f64 = 8.0;
/// Pixels per metre, at 300 per inch.
const RESOLUTION: f64 = 300.0 / 0.0254;
/// Typographic points per metre.
const POINTS: f64 = 72.0 / 0.0254;
/// Space around the plot (points of the screen).
const MARGIN: f32 = 8.0;

/// Plot as PNG, 160 mm wide at 300 dots per inch, on white.
///
/// # Errors
/// An error message, if there is no OpenGL.
pub(crate) fn png(picture: &PlotPicture) -> Result<Vec<u8>, String> {
    // Text of the screen size gets the printed size.
    let width = (WIDTH_M * POINTS * f64::from(TEXT) / PRINTED_TEXT) as f32;
    let size = vec2(width, width / picture.aspect.clamp(0.5, 4.0));
    let scale = (WIDTH_M * RESOLUTION) as f32 / width;
    let palette = theme::palette(Theme::Light);
    let colours = colours(palette);
    let image = offscreen::render(size, scale, Theme::Light, |ui, rect| {
        ui.painter().rect_filled(rect, 0.0, palette.raised);
        paint(ui, rect.shrink(MARGIN), picture, &colours);
    });
    let image = image.map_err(|error| format!("{error}; save the plot as SVG instead"))?;
    let image = image::DynamicImage::ImageRgba8(image).to_rgb8();
    encoded(&image).map_err(|error| error.to_string())
}

fn paint(
    ui: &egui::Ui,
    whole: Rect,
    picture: &PlotPicture,
    colours: &tautline_workflow::plot::Colours,
) {
    let (figure, selection) = (&*picture.figure, picture.selection);
    let painter = ui.painter().clone();
    let layout = Layout::new(figure, picture.view, whole, &text_width(&painter));
    let mut canvas = Screen::new(painter);
    let resolution = ui.pixels_per_point();
    draw::draw(&mut canvas, figure, &layout, selection, colours, resolution);
}

/// PNG with its resolution in dots per metre.
fn encoded(image: &image::RgbImage) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let dots = RESOLUTION.round() as u32;
    let mut info = png::Info::with_size(image.width(), image.height());
    info.color_type = png::ColorType::Rgb;
    info.bit_depth = png::BitDepth::Eight;
    info.pixel_dims = Some(png::PixelDimensions {
        xppu: dots,
        yppu: dots,
        unit: png::Unit::Meter,
    });
    let encoder = png::Encoder::with_info(&mut bytes, info)?;
    encoder.write_header()?.write_image_data(image)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use tautline_workflow::plot::Figure;
    use tautline_workflow::plot::figure::{Axis, Point, Series};

    use super::*;
    use crate::model::Selection;

    #[test]
    fn a_printed_plot_is_160_mm_wide_on_white() {
        let points = (1..=9).map(|k| Point::new(f64::from(k), f64::from(k % 3)));
        let figure = Figure {
            x: Axis::new("Pose", ""),
            y: Axis::new("Residual", "mm"),
            series: vec![Series::of_cable(1, "cable-2", points.collect())],
            ..Figure::default()
        };
        let picture = PlotPicture {
            view: figure.whole(),
            figure: Arc::new(figure),
            selection: Selection::default(),
            aspect: 2.0,
            render: png,
        };
        let bytes = png(&picture).expect("a picture");
        let decoder = png::Decoder::new(std::io::Cursor::new(&bytes));
        let reader = decoder.read_info().expect("a PNG");
        let dims = reader.info().pixel_dims.expect("its size");
        let width_m = f64::from(reader.info().width) / f64::from(dims.xppu);
        assert!((width_m - 0.16).abs() < 2e-4, "{width_m}");
        let image = image::load_from_memory(&bytes).expect("a PNG").to_rgb8();
        assert_eq!(image.get_pixel(0, 0).0, [255; 3]);
        let is_ink = |pixel: &&image::Rgb<u8>| pixel.0.iter().any(|value| *value < 200);
        let ink = image.pixels().filter(is_ink).count();
        assert!(ink > 2000, "{ink}");
    }
}
