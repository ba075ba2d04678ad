//! Rendering on the graphics card, with three-d.

use std::sync::Arc;

use three_d::context as gl;
use three_d::{
    Blend, ClearState, Context, EffectMaterialId, InstanceBuffer, InstancedMesh, Instances, Light,
    Mat4, Material, MaterialType, Program, RenderStates, RenderTarget, Vec2, Vec3, Viewer,
    Viewport, WriteMask, vec2, vec3,
};

use super::camera::Camera;
use super::drawing::{Drawing, Lines, Points};
use super::framebuffer::{Framebuffer, PixelBox, is_software};
use super::parts::{Shape, SolidPart};

/// Inputs of a rendered picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureKey {
    pub drawing: u64,
    pub camera: Camera,
    /// Size in pixels.
    pub size: [u32; 2],
    /// Pixels per point of the screen.
    pub scale: f32,
    /// Whether camera or platform moves: then some of very many poses are omitted, and a software renderer does not
    /// smooth edges.
    pub moves: bool,
}

/// Instances of the parts, by shape.
struct PartBuffers([InstancedMesh; Shape::ALL.len()]);

impl PartBuffers {
    fn new(context: &Context) -> Self {
        let none = Instances::default();
        Self(Shape::ALL.map(|shape| InstancedMesh::new(context, &none, shape.mesh())))
    }

    fn fill(&mut self, parts: &[SolidPart]) {
        for (shape, mesh) in Shape::ALL.into_iter().zip(&mut self.0) {
            let parts = parts.iter().filter(|part| part.shape == shape);
            let (places, colours) = parts.map(|part| (single(part), part.colour)).unzip();
            mesh.set_instances(&Instances {
                transformations: places,
                colors: Some(colours),
                ..Instances::default()
            });
        }
    }
}

/// Matt paint under ambient light and one lamp. three-d's lit material takes 1.5 times as long on llvmpipe.
struct Paint {
    lamp: Vec3,
    is_transparent: bool,
}

impl Material for Paint {
    fn fragment_shader_source(&self, _: &[&dyn Light]) -> String {
        include_str!("shaders/solid.frag").to_owned()
    }

    fn id(&self) -> EffectMaterialId {
        EffectMaterialId(0)
    }

    fn use_uniforms(&self, program: &Program, viewer: &dyn Viewer, _: &[&dyn Light]) {
        program.use_uniform("eye", viewer.position());
        program.use_uniform("lamp", self.lamp);
    }

    fn render_states(&self) -> RenderStates {
        if !self.is_transparent {
            return RenderStates::default();
        }
        RenderStates {
            write_mask: WriteMask::COLOR,
            blend: Blend::TRANSPARENCY,
            ..RenderStates::default()
        }
    }

    fn material_type(&self) -> MaterialType {
        match self.is_transparent {
            true => MaterialType::Transparent,
            false => MaterialType::Opaque,
        }
    }
}

/// Transformation of a part, for the graphics card.
fn single(part: &SolidPart) -> Mat4 {
    let columns: [[f32; 4]; 4] = part.base_from_shape.cast::<f32>().into();
    columns.into()
}

struct LineBuffers {
    from: InstanceBuffer<[f32; 3]>,
    to: InstanceBuffer<[f32; 3]>,
    colours: InstanceBuffer<[f32; 4]>,
    widths: InstanceBuffer<f32>,
}

impl LineBuffers {
    fn new(context: &Context, lines: &Lines) -> Self {
        Self {
            from: InstanceBuffer::new_with_data(context, &lines.from),
            to: InstanceBuffer::new_with_data(context, &lines.to),
            colours: InstanceBuffer::new_with_data(context, &lines.colours),
            widths: InstanceBuffer::new_with_data(context, &lines.widths),
        }
    }
}

struct PointBuffers {
    centres: InstanceBuffer<[f32; 3]>,
    colours: InstanceBuffer<[f32; 4]>,
    looks: InstanceBuffer<[f32; 3]>,
}

impl PointBuffers {
    fn new(context: &Context, points: &Points) -> Self {
        Self {
            centres: InstanceBuffer::new_with_data(context, &points.centres),
            colours: InstanceBuffer::new_with_data(context, &points.colours),
            looks: InstanceBuffer::new_with_data(context, &points.looks),
        }
    }

    fn count(&self) -> u32 {
        self.centres.instance_count()
    }
}

/// Drawing on the graphics card.
struct LoadedDrawing {
    number: u64,
    lines: LineBuffers,
    points: PointBuffers,
}

/// Points of the poses on the graphics card, kept while the rest of the drawing changes.
struct LoadedPoses {
    points: Arc<Points>,
    buffers: PointBuffers,
}

/// Resources on the graphics card.
struct Card {
    context: Context,
    is_software: bool,
    solids: PartBuffers,
    glass: PartBuffers,
    line: Program,
    point: Program,
    loaded: Option<LoadedDrawing>,
    poses: Option<LoadedPoses>,
    framebuffer: Option<Framebuffer>,
    shown: Option<PictureKey>,
}

/// Renderer of the robot; created on first use, with the context that paints.
#[derive(Default)]
pub struct Gpu {
    card: Option<Card>,
    failure: Option<String>,
    draws: u64,
}

/// State shared by all shader programs of a picture.
struct FrameUniforms {
    camera: three_d::Camera,
    eye: Vec3,
    lamp: Vec3,
    size: Vec2,
    scale: f32,
    moves: bool,
    lift: f32,
    opening: f32,
}

impl FrameUniforms {
    fn new(key: &PictureKey, drawing: &Drawing) -> Self {
        let [width, height] = key.size;
        let (centre, radius) = &drawing.bounds;
        let viewport = Viewport::new_at_origo(width, height);
        let [right, up, forward] = key.camera.axes();
        let lamp = (up * 0.75 - forward * 0.6 - right * 0.3).normalize();
        let single = |v: nalgebra::Vector3<f64>| vec3(v.x as f32, v.y as f32, v.z as f32);
        Self {
            camera: key.camera.on_card(centre, *radius, viewport),
            eye: single(key.camera.eye()),
            lamp: single(lamp),
            size: vec2(width as f32, height as f32),
            scale: key.scale,
            moves: key.moves,
            lift: (1e-3 * key.camera.height_m()) as f32,
            opening: key.camera.height_at(1.0) as f32,
        }
    }
}

impl Card {
    fn new(gl: &Arc<gl::Context>) -> Result<Self, String> {
        let context = Context::from_gl_context(Arc::clone(gl)).map_err(|e| e.to_string())?;
        let program = |vertex: &str, fragment: &str| {
            Program::from_source(&context, vertex, fragment).map_err(|e| e.to_string())
        };
        Ok(Self {
            solids: PartBuffers::new(&context),
            glass: PartBuffers::new(&context),
            line: program(
                include_str!("shaders/line.vert"),
                include_str!("shaders/line.frag"),
            )?,
            point: program(
                include_str!("shaders/point.vert"),
                include_str!("shaders/point.frag"),
            )?,
            is_software: is_software(gl),
            context,
            loaded: None,
            poses: None,
            framebuffer: None,
            shown: None,
        })
    }

    fn loaded(&mut self, drawing: &Drawing, number: u64) {
        if self.loaded.as_ref().is_some_and(|l| l.number == number) {
            return;
        }
        self.solids.fill(&drawing.solids);
        self.glass.fill(&drawing.glass);
        self.loaded = Some(LoadedDrawing {
            number,
            lines: LineBuffers::new(&self.context, &drawing.lines),
            points: PointBuffers::new(&self.context, &drawing.points),
        });
        let points = &drawing.poses;
        if !self
            .poses
            .as_ref()
            .is_some_and(|poses| Arc::ptr_eq(&poses.points, points))
        {
            self.poses = Some(LoadedPoses {
                points: Arc::clone(points),
                buffers: PointBuffers::new(&self.context, points),
            });
        }
    }

    /// Renders the picture of `key` unless it exists; returns whether it was rendered.
    fn picture(&mut self, drawing: &Drawing, key: PictureKey) -> Result<bool, String> {
        if self.shown == Some(key) && self.framebuffer.is_some() {
            return Ok(false);
        }
        self.loaded(drawing, key.drawing);
        let fits = |f: &Framebuffer| f.size() == key.size;
        if !self.framebuffer.as_ref().is_some_and(fits) {
            self.framebuffer = Some(Framebuffer::new(&self.context, key.size)?);
        }
        if let Some(framebuffer) = &self.framebuffer {
            let look = FrameUniforms::new(&key, drawing);
            framebuffer.draw(&self.context, self.is_software && key.moves, |target| {
                self.draw(target, &look, drawing.ground);
            });
        }
        self.shown = Some(key);
        Ok(true)
    }

    fn draw(&self, target: &RenderTarget<'_>, look: &FrameUniforms, ground: egui::Color32) {
        let [r, g, b, _] = ground.to_array().map(|c| f32::from(c) / 255.0);
        target.clear(ClearState::color_and_depth(r, g, b, 1.0, 1.0));
        let Some(loaded) = &self.loaded else {
            return;
        };
        let paint = |is_transparent| Paint {
            lamp: look.lamp,
            is_transparent,
        };
        target.render_with_material(&paint(false), &look.camera, &self.solids.0, &[]);
        self.draw_lines(&loaded.lines, look);
        self.draw_points(&loaded.points, look, loaded.points.count());
        if let Some(LoadedPoses { points, buffers }) = &self.poses {
            let all = buffers.count();
            let coarse = u32::try_from(points.coarse).unwrap_or(u32::MAX);
            let count = if look.moves { all.min(coarse) } else { all };
            self.draw_points(buffers, look, count);
        }
        target.render_with_material(&paint(true), &look.camera, &self.glass.0, &[]);
    }

    fn share(program: &Program, look: &FrameUniforms) {
        program.use_uniform(
            "clip_from_base",
            look.camera.projection() * look.camera.view(),
        );
        program.use_uniform("eye", look.eye);
        program.use_uniform("size", look.size);
        program.use_uniform("scale", look.scale);
        program.use_uniform("lift", look.lift);
    }

    fn draw_lines(&self, buffers: &LineBuffers, look: &FrameUniforms) {
        let count = buffers.from.instance_count();
        if count == 0 {
            return;
        }
        let program = &self.line;
        Self::share(program, look);
        program.use_instance_attribute("begin", &buffers.from);
        program.use_instance_attribute("end", &buffers.to);
        program.use_instance_attribute("colour", &buffers.colours);
        program.use_instance_attribute("width", &buffers.widths);
        program.draw_arrays_instanced(RenderStates::default(), look.camera.viewport(), 6, count);
    }

    fn draw_points(&self, buffers: &PointBuffers, look: &FrameUniforms, count: u32) {
        if count == 0 {
            return;
        }
        let program = &self.point;
        Self::share(program, look);
        program.use_uniform("opening", look.opening);
        program.use_instance_attribute("centre", &buffers.centres);
        program.use_instance_attribute("colour", &buffers.colours);
        program.use_instance_attribute("look", &buffers.looks);
        let states = RenderStates {
            blend: Blend::TRANSPARENCY,
            ..RenderStates::default()
        };
        program.draw_arrays_instanced(states, look.camera.viewport(), 3, count);
    }
}

impl Gpu {
    /// Copies the picture of `key` to `place` of the bound framebuffer, clipped to `clip`; renders it first if
    /// necessary.
    pub fn paint(
        &mut self,
        gl: &Arc<gl::Context>,
        drawing: &Drawing,
        key: PictureKey,
        [place, clip]: [PixelBox; 2],
    ) {
        if self.failure.is_some() {
            return;
        }
        if let Err(message) = self.try_paint(gl, drawing, key, [place, clip]) {
            self.failure = Some(message);
        }
    }

    fn try_paint(
        &mut self,
        gl: &Arc<gl::Context>,
        drawing: &Drawing,
        key: PictureKey,
        [place, clip]: [PixelBox; 2],
    ) -> Result<(), String> {
        let card = match self.card.take() {
            Some(card) => self.card.insert(card),
            None => self.card.insert(Card::new(gl)?),
        };
        self.draws += u64::from(card.picture(drawing, key)?);
        if let Some(framebuffer) = &card.framebuffer {
            framebuffer.show(place, clip);
        }
        Ok(())
    }

    /// Number of renderings of the picture; copies do not count.
    #[must_use]
    pub fn draws(&self) -> u64 {
        self.draws
    }

    /// Whether a software renderer is used; known after the first rendering.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.card.as_ref().is_some_and(|card| card.is_software)
    }

    /// Reason why there is no picture, if rendering failed.
    #[must_use]
    pub fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    /// Frees resources on the graphics card, while its context is current.
    pub fn destroy(&mut self) {
        self.card = None;
    }
}
