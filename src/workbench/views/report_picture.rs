//! Picture of the robot on the first page of a report.

use std::collections::BTreeSet;
use std::io::Cursor;

use egui::Theme;
use tautline_session::Session;

use super::offscreen::render_scene;
use super::robot_3d::camera::{Camera, StandardView};
use super::robot_3d::drawing::Options;
use super::robot_3d::scene::SceneInputs;
use tautline_workflow::identification::Identification;

/// Width and height (points of the screen).
const SIZE: [u32; 2] = [840, 560];
/// Pixels per point.
const SCALE: f32 = 2.0;

/// Robot with its cables as PNG; with an identification also the displacements of the pulleys. Coordinates of the
/// pulleys in `pinned` are written beside them.
///
/// # Errors
/// An error message, if there is no OpenGL.
pub fn report_picture(
    session: &Session,
    fit: Option<&Identification>,
    pinned: &BTreeSet<usize>,
) -> Result<Vec<u8>, String> {
    let subject = SceneInputs {
        fit,
        ..SceneInputs::new(&session.robot, &session.measurements)
    };
    let scene = subject.scene();
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let options = Options {
        pinned: pinned.clone(),
        ..Options::default()
    };
    let mut extent = scene.extent();
    extent.extend(options.tips(&scene));
    let camera = Camera::new(scene.directions, StandardView::Isometric, &extent, aspect);
    let image = render_scene(&scene, &options, &camera, (SIZE, SCALE), Theme::Light)
        .map_err(|error| error.to_string())?;
    let mut png = Cursor::new(Vec::new());
    // Reports have no transparency.
    image::DynamicImage::ImageRgba8(image)
        .to_rgb8()
        .write_to(&mut png, image::ImageFormat::Png)
        .map_err(|error| error.to_string())?;
    Ok(png.into_inner())
}
