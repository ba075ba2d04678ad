//! The robot in 3D: frame, pulleys, cables, platform, laser, poses.
//!
//! From the open session to the screen in four steps, each repeated only when what it depends on has changed: a
//! [`Scene`] says what there is, in metres; a [`Drawing`] gives it colours; the graphics card makes a picture of it for
//! a [`Camera`]; and every frame copies the picture and writes over it.

mod callout;
pub mod camera;
mod canvas;
pub mod drawing;
mod framebuffer;
mod gpu;
mod mesh;
mod overlay;
pub mod picking;
pub mod scene;
mod toolbar;
mod words;

use std::collections::HashSet;
use std::sync::Arc;
use std::time::Duration;

use egui::{Frame, Margin, Theme, Ui};
use tautline_core::geometry::Vec3;
use tautline_session::Session;

pub use canvas::Canvas;
pub use framebuffer::paint_picture;

use camera::{Camera, StandardView};
use drawing::{Drawing, Options, Points};
use scene::{MeasuredPoses, Scene, Shown, Subject};
use toolbar::Aim;

use crate::model::command::{Outbox, ViewCommand};
use crate::model::link::LivePlatform;
use crate::model::plot_preparation::same;
use crate::model::{Model, OpenSession, Selection};
use crate::theme::GRID;
use crate::widgets::empty;
use tautline_workflow::identification::Identification;

/// How long camera and platform rest before everything is drawn again (s).
const REST_S: f64 = 0.1;

/// State of the view between frames.
#[derive(Default)]
pub struct Robot3d {
    /// What is drawn and how.
    pub options: Options,
    camera: Option<Camera>,
    /// What the camera shows all of, until the operator moves it: shape of the picture, and ends of displacements (m).
    framed: Option<(f64, Vec<Vec3>)>,
    scene: Option<(SceneKey, Arc<Scene>)>,
    drawing: Option<(Arc<Scene>, DrawingKey, Arc<Drawing>)>,
    poses: Option<(PosesKey, Arc<Points>)>,
    drawings: u64,
    canvas: Canvas,
    hovers: bool,
    /// Number of the drawing in the last frame.
    shown: Option<u64>,
    /// When the camera or the platform moved last, in time of the window (s).
    moved_s: Option<f64>,
}

/// What a scene depends on.
#[derive(Clone)]
struct SceneKey {
    /// Id and revision of the session.
    session: (u64, u64),
    fit: Option<Arc<Identification>>,
    selection: Selection,
    live: Option<LivePlatform>,
}

/// What a drawing depends on, besides its scene.
#[derive(Clone, PartialEq)]
struct DrawingKey {
    theme: Theme,
    options: Options,
    selection: Selection,
}

/// What the points of the poses depend on.
#[derive(Clone)]
struct PosesKey {
    measured: Arc<MeasuredPoses>,
    planned: Vec<Vec3>,
    pose: Option<i64>,
    theme: Theme,
}

impl PartialEq for PosesKey {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.measured, &other.measured)
            && self.pose == other.pose
            && self.theme == other.theme
            && self.planned == other.planned
    }
}

impl SceneKey {
    /// Whether the measured poses are still these, wherever the platform is.
    fn has_poses_of(&self, other: &Self) -> bool {
        self.session == other.session
            && same(self.fit.as_ref(), other.fit.as_ref())
            && self.selection.cable == other.selection.cable
    }

    fn is_same(&self, other: &Self) -> bool {
        self.has_poses_of(other) && self.selection == other.selection && self.live == other.live
    }
}

impl Robot3d {
    /// How often the picture was drawn, not copied.
    #[must_use]
    pub fn draws(&self) -> u64 {
        self.canvas.draws()
    }

    /// The camera, once the view was shown.
    #[must_use]
    pub fn camera(&self) -> Option<&Camera> {
        self.camera.as_ref()
    }

    /// The scene, once the view was shown.
    #[must_use]
    pub fn scene(&self) -> Option<&Arc<Scene>> {
        self.scene.as_ref().map(|(_, scene)| scene)
    }

    /// Frees what lies on the graphics card, while its context is current.
    pub fn destroy(&mut self) {
        self.canvas.destroy();
    }

    /// The scene of the open session; the camera starts anew for another session.
    fn scene_of(&mut self, model: &Model, open: &OpenSession) -> Arc<Scene> {
        let key = SceneKey {
            session: (open.id(), open.revision()),
            fit: open.fit().cloned(),
            selection: model.selection,
            live: model.live_platform.clone(),
        };
        let known = self.scene.as_ref();
        if let Some((_, scene)) = known.filter(|(known, _)| known.is_same(&key)) {
            return Arc::clone(scene);
        }
        let session = open.session();
        // They stay while the platform moves.
        let poses = known.filter(|(known, _)| known.has_poses_of(&key));
        let planned = poses.map_or_else(|| planned(session), |(_, scene)| scene.planned.clone());
        let subject = Subject {
            robot: &session.robot,
            measurements: &session.measurements,
            fit: open.fit().map(AsRef::as_ref),
            selection: model.selection,
            live: model.live_platform.as_ref(),
            planned: &planned,
        };
        let measured = poses.map(|(_, scene)| Arc::clone(&scene.measured));
        let scene = Arc::new(subject.scene_with(measured));
        if known.is_none_or(|(known, _)| known.session.0 != key.session.0) {
            self.camera = None;
        }
        self.scene = Some((key, Arc::clone(&scene)));
        scene
    }

    fn drawing_of(
        &mut self,
        scene: &Arc<Scene>,
        selection: Selection,
        theme: Theme,
    ) -> Arc<Drawing> {
        let key = DrawingKey {
            theme,
            options: self.options.clone(),
            selection,
        };
        if let Some((of, with, drawing)) = &self.drawing
            && Arc::ptr_eq(of, scene)
            && *with == key
        {
            return Arc::clone(drawing);
        }
        let poses = if self.options.poses {
            self.poses_of(scene, selection, theme)
        } else {
            Arc::default()
        };
        let options = &self.options;
        let drawing = Arc::new(Drawing::with_poses(poses, scene, options, selection, theme));
        self.drawings += 1;
        self.drawing = Some((Arc::clone(scene), key, Arc::clone(&drawing)));
        drawing
    }

    /// The points of the poses; they stay while the platform moves.
    fn poses_of(&mut self, scene: &Scene, selection: Selection, theme: Theme) -> Arc<Points> {
        let key = PosesKey {
            measured: Arc::clone(&scene.measured),
            planned: scene.planned.clone(),
            pose: selection.pose,
            theme,
        };
        if let Some((of, points)) = &self.poses
            && *of == key
        {
            return Arc::clone(points);
        }
        let points = Arc::new(Points::of_poses(scene, selection, theme));
        self.poses = Some((key, Arc::clone(&points)));
        points
    }
}

/// Positions of the poses that are still to be measured (m).
fn planned(session: &Session) -> Vec<Vec3> {
    let measured: HashSet<i64> = session.measurements.labels.iter().copied().collect();
    let planned = session.plan.iter();
    let planned = planned.filter(|pose| !measured.contains(&pose.label));
    planned.map(|pose| pose.pose().position).collect()
}

/// Draws the robot of the open session; `hovered` is what is under the pointer, in all views.
pub fn show(
    ui: &mut Ui,
    model: &Model,
    (view, hovered): (&mut Robot3d, &mut Selection),
    outbox: &mut Outbox,
) {
    let Some(open) = &model.open else {
        empty(
            ui,
            "The robot appears here once a session, a robot or a dataset is open.",
        );
        return;
    };
    let scene = view.scene_of(model, open);
    if let Some(selection) = view.show(ui, &scene, model.selection, hovered) {
        outbox.send(ViewCommand::Select(selection));
    }
}

impl Robot3d {
    /// Turns the camera as it was asked to; while nobody has moved it, it goes on showing everything. Gives what
    /// everything is (m).
    fn aim(&mut self, scene: &Scene, aim: Option<Aim>, aspect: f64) -> Vec<Vec3> {
        let tips = self.options.tips(scene);
        let mut extent = scene.extent();
        extent.extend(&tips);
        let Some(camera) = &mut self.camera else {
            self.framed = Some((aspect, tips));
            return extent;
        };
        if let Some(Aim::To(side)) = aim {
            camera.turn_to(side);
        }
        let now = (aspect, tips);
        let is_other = self.framed.as_ref().is_some_and(|framed| *framed != now);
        if aim.is_some() || is_other {
            camera.fit(&extent, aspect);
            self.framed = Some(now);
        }
        extent
    }

    /// Resets the camera: the next scene is fitted to the view.
    pub fn look_anew(&mut self) {
        self.camera = None;
    }

    /// Draws a scene with its toolbar; gives what a click selects. `hovered` is what is under the pointer, in all views.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        scene: &Arc<Scene>,
        selection: Selection,
        hovered: &mut Selection,
    ) -> Option<Selection> {
        let mut aim = None;
        let width = ui.available_width();
        Frame::new()
            .inner_margin(Margin::symmetric(2 * GRID as i8, GRID as i8))
            .show(ui, |ui| {
                aim = toolbar::show(ui, &mut self.options, scene);
            });
        let drawing = self.drawing_of(scene, selection, ui.theme());
        let size = egui::vec2(width, ui.available_height()).max(egui::Vec2::splat(16.0));
        let (rect, response) = ui.allocate_exact_size(size, egui::Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, "3D view"));
        let aspect = f64::from(rect.aspect_ratio());
        let aim = aim.or_else(|| canvas::keys(ui, &response));
        let extent = self.aim(scene, aim, aspect);
        let start = || Camera::new(scene.directions, StandardView::Isometric, &extent, aspect);
        let camera = self.camera.get_or_insert_with(start);
        let before = *camera;
        canvas::steer(ui, &response, camera, &extent);
        // Few points are drawn while camera or platform move, all once they rest.
        let has_more = drawing.poses.coarse < drawing.poses.centres.len();
        let now_s = ui.input(|input| input.time);
        if *camera != before {
            self.moved_s = Some(now_s);
            if !response.double_clicked() {
                self.framed = None;
            }
        }
        if scene.shown == Shown::Live && self.shown != Some(self.drawings) {
            // The platform moves.
            self.moved_s = Some(now_s);
        }
        self.shown = Some(self.drawings);
        let rests_s = self.moved_s.map(|moved_s| moved_s + REST_S - now_s);
        let left_s = rests_s.filter(|left_s| has_more && *left_s > 0.0);
        if let Some(left_s) = left_s {
            ui.ctx()
                .request_repaint_after(Duration::from_secs_f64(left_s));
        }
        let picture = picking::Picture {
            scene,
            options: &self.options,
            camera,
            size: [rect.width(), rect.height()].map(f64::from),
        };
        let thing = canvas::under_pointer(&response, &picture);
        self.canvas.paint(
            ui,
            rect,
            &drawing,
            (self.drawings, left_s.is_some()),
            &picture,
            *hovered,
        );
        if let Some(thing) = thing {
            response
                .clone()
                .on_hover_text_at_pointer(words::describe(scene, thing));
        }
        let picked = thing.map(canvas::selection_of).unwrap_or_default();
        if thing.is_some() || self.hovers {
            // What another view hovers stays until the pointer is here.
            *hovered = picked;
            self.hovers = thing.is_some();
        }
        if let (Some(picking::Thing::Pulley(index)), true) = (thing, response.clicked()) {
            self.options.pin(index);
        }
        response
            .clicked()
            .then(|| canvas::clicked(picked, selection))
    }
}
