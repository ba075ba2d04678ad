//! Rendering without a window, through EGL, for reports and tests.
#![expect(
    unsafe_code,
    reason = "glutin marks everything that talks to a driver as unsafe"
)]

use std::sync::Arc;

use eframe::egui_glow::Painter;
use eframe::glow;
use egui::{FullOutput, Pos2, Rect, TexturesDelta, Theme, Ui, Vec2};
use glutin::api::egl::context::PossiblyCurrentContext;
use glutin::api::egl::device::Device;
use glutin::api::egl::display::Display;
use glutin::config::{Api, ConfigSurfaceTypes, ConfigTemplateBuilder};
use glutin::context::{ContextApi, ContextAttributesBuilder, Version};
use glutin::prelude::*;
use image::RgbaImage;

use super::robot_3d::camera::Camera;
use super::robot_3d::drawing::{Drawing, Options};
use super::robot_3d::picking::Picture;
use super::robot_3d::scene::Scene;
use super::robot_3d::{Canvas, paint_picture};
use crate::model::Selection;
use crate::theme;

/// Reason why a picture could not be rendered.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum OffscreenError {
    /// No driver was found.
    #[error(
        "no picture can be drawn without a window, because there is no OpenGL by way of EGL: {0}"
    )]
    NoGl(String),
    /// The driver reported an error.
    #[error("the picture could not be drawn: {0}")]
    Refused(String),
}

/// OpenGL context without a window.
pub struct HeadlessGl {
    gl: Arc<glow::Context>,
    context: PossiblyCurrentContext,
    _display: Display,
}

impl HeadlessGl {
    /// Creates a context on the first device with OpenGL.
    ///
    /// # Errors
    /// If no device has OpenGL.
    pub fn new() -> Result<Self, OffscreenError> {
        let devices =
            Device::query_devices().map_err(|error| OffscreenError::NoGl(error.to_string()))?;
        let mut last = "there is no device".to_owned();
        for device in devices {
            match Self::on(&device) {
                Ok(gl) => return Ok(gl),
                Err(error) => last = error.to_string(),
            }
        }
        Err(OffscreenError::NoGl(last))
    }

    fn on(device: &Device) -> Result<Self, glutin::error::Error> {
        let template = ConfigTemplateBuilder::new()
            .with_api(Api::OPENGL)
            .with_surface_type(ConfigSurfaceTypes::empty())
            .build();
        let attributes = ContextAttributesBuilder::new()
            .with_context_api(ContextApi::OpenGl(Some(Version::new(3, 3))))
            .build(None);
        // SAFETY: the device comes from the query, no native handle is passed, and the display outlives the context,
        // because both are stored together.
        unsafe {
            let display = Display::with_device(device, None)?;
            let config = display
                .find_configs(template)?
                .next()
                .ok_or(glutin::error::ErrorKind::BadConfig)?;
            let context = display.create_context(&config, &attributes)?;
            let context = context.make_current_surfaceless()?;
            let load = |name: &std::ffi::CStr| display.get_proc_address(name);
            Ok(Self {
                gl: Arc::new(glow::Context::from_loader_function_cstr(load)),
                context,
                _display: display,
            })
        }
    }

    /// OpenGL functions, for the thread on which [`Self::make_current`] was called last.
    #[must_use]
    pub fn gl(&self) -> &Arc<glow::Context> {
        &self.gl
    }

    /// Makes this the current context of the thread.
    ///
    /// # Errors
    /// If the driver reports an error.
    pub fn make_current(&self) -> Result<(), OffscreenError> {
        self.context
            .make_current_surfaceless()
            .map_err(|error| OffscreenError::Refused(error.to_string()))
    }
}

/// Renders the output of egui, including its 3D parts, without a window.
pub struct OffscreenPainter {
    painter: Painter,
    headless: HeadlessGl,
}

impl OffscreenPainter {
    /// Creates the painter.
    ///
    /// # Errors
    /// If there is no OpenGL.
    pub fn new() -> Result<Self, OffscreenError> {
        let headless = HeadlessGl::new()?;
        let painter = Painter::new(Arc::clone(headless.gl()), "", None, false)
            .map_err(|error| OffscreenError::Refused(error.to_string()))?;
        Ok(Self { painter, headless })
    }

    /// OpenGL context of the painter.
    #[must_use]
    pub fn headless(&self) -> &HeadlessGl {
        &self.headless
    }

    /// Uploads or frees textures of egui.
    ///
    /// # Errors
    /// If the driver reports an error.
    pub fn take_textures(&mut self, delta: &mut TexturesDelta) -> Result<(), OffscreenError> {
        self.headless.make_current()?;
        for (id, images) in delta.set.drain() {
            for image in images {
                self.painter.set_texture(id, &image);
            }
        }
        for id in delta.free.drain() {
            self.painter.free_texture(id);
        }
        Ok(())
    }

    /// Renders a frame.
    ///
    /// # Errors
    /// If the driver reports an error.
    pub fn picture(
        &mut self,
        context: &egui::Context,
        output: &FullOutput,
    ) -> Result<RgbaImage, OffscreenError> {
        self.headless.make_current()?;
        let scale = context.pixels_per_point();
        let size = context.content_rect().size() * scale;
        let size = [size.x, size.y].map(|side| side.round().max(1.0) as u32);
        let primitives = context.tessellate(output.shapes.clone(), scale);
        let style = context.global_style();
        let ground = style.visuals.panel_fill.to_normalized_gamma_f32();
        let painter = &mut self.painter;
        paint_picture(self.headless.gl(), size, || {
            painter.clear(size, ground);
            painter.paint_primitives(size, scale, &primitives);
        })
        .map_err(OffscreenError::Refused)
    }
}

impl Drop for OffscreenPainter {
    fn drop(&mut self) {
        if self.headless.make_current().is_ok() {
            self.painter.destroy();
        }
    }
}

/// Renders a scene like the 3D view, with labels and legends: `size` points large, with `scale` pixels per point.
///
/// # Errors
/// If there is no OpenGL, or the driver reports an error.
pub fn render_scene(
    scene: &Scene,
    options: &Options,
    camera: &Camera,
    (size, scale): ([u32; 2], f32),
    theme: Theme,
) -> Result<RgbaImage, OffscreenError> {
    let canvas = Canvas::default();
    let selection = Selection::default();
    let drawing = Arc::new(Drawing::new(scene, options, selection, theme));
    let size = size.map(|side| side.max(1) as f32);
    let picture = Picture {
        scene,
        options,
        camera,
        size: size.map(f64::from),
    };
    render(size.into(), scale, theme, move |ui, rect| {
        canvas.paint(ui, rect, &drawing, false, &picture, selection);
    })
}

/// Renders what `draw` paints into a rectangle of `size` points, with `scale` pixels per point.
///
/// # Errors
/// If there is no OpenGL, or the driver reports an error.
pub fn render(
    size: Vec2,
    scale: f32,
    theme: Theme,
    draw: impl FnMut(&mut Ui, Rect),
) -> Result<RgbaImage, OffscreenError> {
    let mut painter = OffscreenPainter::new()?;
    // Dropped before the painter, because its resources on the graphics card need the painter's context.
    let mut draw = draw;
    let context = egui::Context::default();
    theme::install(&context);
    context.set_theme(theme);
    let rect = Rect::from_min_size(Pos2::ZERO, size);
    let mut input = egui::RawInput {
        screen_rect: Some(rect),
        ..Default::default()
    };
    if let Some(viewport) = input.viewports.get_mut(&egui::ViewportId::ROOT) {
        viewport.native_pixels_per_point = Some(scale);
    }
    // Fonts requested in the first pass are available in the second.
    let mut output = FullOutput::default();
    for _ in 0..2 {
        output = context.run_ui(input.clone(), |ui| draw(ui, rect));
        painter.take_textures(&mut output.textures_delta)?;
    }
    painter.picture(&context, &output)
}
