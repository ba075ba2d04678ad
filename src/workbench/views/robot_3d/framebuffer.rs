//! Multisampled framebuffer on the graphics card. The only module of the views that calls OpenGL directly: three-d
//! cannot copy a multisampled picture to a framebuffer bound by another library.
#![expect(unsafe_code, reason = "glow marks every call of OpenGL as unsafe")]

use std::sync::Arc;

use three_d::context as gl;
use three_d::{HasContext, RenderTarget};

type Gl = Arc<gl::Context>;

/// Samples per pixel.
const SAMPLES: i32 = 4;

/// Rectangle of a window (pixels, from the lower left corner).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PixelBox {
    /// Left edge.
    pub left: i32,
    /// Lower edge.
    pub bottom: i32,
    pub width: i32,
    pub height: i32,
}

/// Multisampled picture that is kept between frames.
///
/// OpenGL: all methods must be called on the thread on which the context of `new` is current.
pub struct Framebuffer {
    gl: Gl,
    size: [u32; 2],
    samples: FramebufferObject,
    resolved: FramebufferObject,
}

/// Framebuffer object with its attachments.
struct FramebufferObject {
    framebuffer: gl::Framebuffer,
    renderbuffers: Vec<gl::Renderbuffer>,
}

impl FramebufferObject {
    /// Creates colour and depth buffer; `samples` is 0 for one sample per pixel.
    fn new(gl: &Gl, size: [u32; 2], samples: i32) -> Result<Self, String> {
        let [width, height] = size.map(|side| side as i32);
        // SAFETY: the context is current (see `Framebuffer`); only objects created here are changed, and the previous
        // bindings are restored.
        unsafe {
            let before = gl.get_parameter_framebuffer(gl::DRAW_FRAMEBUFFER_BINDING);
            let mut attached = Self {
                framebuffer: gl.create_framebuffer()?,
                renderbuffers: Vec::new(),
            };
            gl.bind_framebuffer(gl::FRAMEBUFFER, Some(attached.framebuffer));
            let colour = (gl::RGBA8, gl::COLOR_ATTACHMENT0);
            let depth = (gl::DEPTH_COMPONENT24, gl::DEPTH_ATTACHMENT);
            for (format, place) in [colour, depth] {
                let buffer = gl.create_renderbuffer()?;
                attached.renderbuffers.push(buffer);
                gl.bind_renderbuffer(gl::RENDERBUFFER, Some(buffer));
                gl.renderbuffer_storage_multisample(
                    gl::RENDERBUFFER,
                    samples,
                    format,
                    width,
                    height,
                );
                gl.framebuffer_renderbuffer(gl::FRAMEBUFFER, place, gl::RENDERBUFFER, Some(buffer));
            }
            let status = gl.check_framebuffer_status(gl::FRAMEBUFFER);
            gl.bind_renderbuffer(gl::RENDERBUFFER, None);
            gl.bind_framebuffer(gl::FRAMEBUFFER, before);
            if status == gl::FRAMEBUFFER_COMPLETE {
                return Ok(attached);
            }
            attached.delete(gl);
            Err(format!(
                "the graphics card refuses a picture of {width} x {height}"
            ))
        }
    }

    fn delete(&mut self, gl: &Gl) {
        // SAFETY: the context is current; the objects belong to this value and are not used afterwards.
        unsafe {
            gl.delete_framebuffer(self.framebuffer);
            for buffer in self.renderbuffers.drain(..) {
                gl.delete_renderbuffer(buffer);
            }
        }
    }
}

impl Framebuffer {
    /// Creates a picture of `size` pixels.
    ///
    /// # Errors
    /// If the driver reports an error.
    pub fn new(gl: &Gl, size: [u32; 2]) -> Result<Self, String> {
        // SAFETY: reads a limit of the current context.
        let most = unsafe { gl.get_parameter_i32(gl::MAX_SAMPLES) };
        let mut samples = FramebufferObject::new(gl, size, SAMPLES.min(most))?;
        let resolved = FramebufferObject::new(gl, size, 0).inspect_err(|_| samples.delete(gl))?;
        Ok(Self {
            gl: Arc::clone(gl),
            size,
            samples,
            resolved,
        })
    }

    /// Width and height (pixels).
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Draws the picture, with one sample per pixel if `is_rough`; the previous framebuffer is bound again afterwards.
    pub fn draw(
        &self,
        context: &three_d::Context,
        is_rough: bool,
        draw: impl FnOnce(&RenderTarget<'_>),
    ) {
        let [width, height] = self.size;
        let [w, h] = self.size.map(|side| side as i32);
        // SAFETY: the context is current; the framebuffers belong to this value, and the previous binding is restored.
        unsafe {
            let before = self
                .gl
                .get_parameter_framebuffer(gl::DRAW_FRAMEBUFFER_BINDING);
            let framebuffer = match is_rough {
                true => self.resolved.framebuffer,
                false => self.samples.framebuffer,
            };
            let target = RenderTarget::from_framebuffer(context, width, height, framebuffer);
            draw(&target);
            // Dropping the target would delete the framebuffer.
            target.into_framebuffer();
            if !is_rough {
                self.gl.disable(gl::SCISSOR_TEST);
                self.gl
                    .bind_framebuffer(gl::READ_FRAMEBUFFER, Some(framebuffer));
                self.gl
                    .bind_framebuffer(gl::DRAW_FRAMEBUFFER, Some(self.resolved.framebuffer));
                let whole = [0, 0, w, h];
                self.copy(whole, whole);
            }
            self.gl.bind_framebuffer(gl::FRAMEBUFFER, before);
        }
    }

    /// Copies the picture to the bound framebuffer, with its lower left corner at that of `place`, clipped to `clip`.
    pub fn show(&self, place: PixelBox, clip: PixelBox) {
        let [w, h] = self.size.map(|side| side as i32);
        // SAFETY: as in `draw`; the copy stays within the scissor, which egui sets anew for what it draws next.
        unsafe {
            let before = self
                .gl
                .get_parameter_framebuffer(gl::DRAW_FRAMEBUFFER_BINDING);
            self.gl.enable(gl::SCISSOR_TEST);
            self.gl
                .scissor(clip.left, clip.bottom, clip.width, clip.height);
            self.gl
                .bind_framebuffer(gl::READ_FRAMEBUFFER, Some(self.resolved.framebuffer));
            let (x, y) = (place.left, place.bottom);
            self.copy([0, 0, w, h], [x, y, x + w, y + h]);
            self.gl.bind_framebuffer(gl::FRAMEBUFFER, before);
        }
    }

    /// Copies colours from the framebuffer bound for reading to the one bound for drawing.
    ///
    /// # Safety
    /// The context must be current.
    unsafe fn copy(&self, from: [i32; 4], to: [i32; 4]) {
        // SAFETY: the context is current.
        unsafe {
            self.gl.blit_framebuffer(
                from[0],
                from[1],
                from[2],
                from[3],
                to[0],
                to[1],
                to[2],
                to[3],
                gl::COLOR_BUFFER_BIT,
                gl::NEAREST,
            );
        }
    }
}

impl Drop for Framebuffer {
    fn drop(&mut self) {
        self.samples.delete(&self.gl);
        self.resolved.delete(&self.gl);
    }
}

/// Whether the renderer is software, without a graphics card.
#[must_use]
pub fn is_software(gl: &Gl) -> bool {
    // SAFETY: reads a name of the current context.
    let name = unsafe { gl.get_parameter_string(gl::RENDERER) };
    ["llvmpipe", "softpipe", "SwiftShader"]
        .iter()
        .any(|software| name.contains(software))
}

/// Binds a framebuffer of `size` while `paint` runs, and returns the painted picture from the upper left corner.
///
/// # Errors
/// If the driver reports an error.
pub fn paint_picture(
    gl: &Gl,
    size: [u32; 2],
    paint: impl FnOnce(),
) -> Result<image::RgbaImage, String> {
    let mut attached = FramebufferObject::new(gl, size, 0)?;
    let [width, height] = size;
    let mut bytes = vec![0; width as usize * height as usize * 4];
    // SAFETY: the caller's context is current; the framebuffer is created here, and `bytes` has room for all pixels.
    unsafe {
        gl.bind_framebuffer(gl::FRAMEBUFFER, Some(attached.framebuffer));
        paint();
        gl.bind_framebuffer(gl::FRAMEBUFFER, Some(attached.framebuffer));
        gl.read_pixels(
            0,
            0,
            width as i32,
            height as i32,
            gl::RGBA,
            gl::UNSIGNED_BYTE,
            gl::PixelPackData::Slice(Some(&mut bytes)),
        );
        gl.bind_framebuffer(gl::FRAMEBUFFER, None);
    }
    attached.delete(gl);
    let row = width as usize * 4;
    let from_top = bytes.chunks_exact(row).rev().flatten().copied().collect();
    let mut picture = image::RgbaImage::from_raw(width, height, from_top)
        .ok_or_else(|| "the picture has another size than asked for".to_owned())?;
    for pixel in picture.pixels_mut() {
        pixel.0[3] = 255;
    }
    Ok(picture)
}
