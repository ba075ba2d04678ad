//! The robot in 3D: frame, pulleys, cables, platform, laser, poses.
//!
//! The picture is made in four steps, each repeated only when its inputs have changed: a [`Scene`] contains the
//! geometry in metres; a [`Drawing`] adds colours; the graphics card renders it for a [`Camera`]; and every frame
//! copies the picture and adds annotations.

mod callout;
pub mod camera;
mod canvas;
pub mod drawing;
mod framebuffer;
mod gpu;
mod keys;
mod labels;
mod legend;
mod navigation;
mod overlay;
mod parts;
pub mod picking;
mod picture;
pub mod scene;
mod surface;
mod toolbar;
mod words;

use std::sync::Arc;
use std::time::Duration;

use egui::{ColorImage, Frame, Margin, Response, Theme, Ui};

pub use canvas::Canvas;
pub use framebuffer::paint_picture;

use camera::{Camera, Projection};
use drawing::{Drawing, Options, Points};
use keys::{DrawingKey, PosesKey, SceneKey, planned};
use navigation::Navigation;
use picking::{Pickable, Picture};
use picture::{PictureRequest, Target};
use scene::{Scene, SceneInputs, ShownPose};

pub use toolbar::CameraRequest;

use crate::model::command::{Outbox, PlotCommand, PlotFile, ViewCommand};
use crate::model::link::LivePlatform;
use crate::model::part::ScreenPart;
use crate::model::phase::{Phase, Screen};
use crate::model::{Model, OpenSession, Selection};
use crate::theme::{self, GRID};
use crate::widgets::UiExt;

/// Time without motion of camera and platform before the picture is rendered in full quality (s).
const REST_S: f64 = 0.1;
/// Smallest interval between two positions of a moving platform with a software renderer (s), because each is a new
/// picture.
const FOLLOWED_S: f64 = 0.1;

/// State of the view between frames.
#[derive(Default)]
pub struct Robot3d {
    pub options: Options,
    navigation: Navigation,
    scene: Option<(SceneKey, Arc<Scene>)>,
    drawing: Option<(Arc<Scene>, DrawingKey, Arc<Drawing>)>,
    poses: Option<(PosesKey, Arc<Points>)>,
    drawings: u64,
    canvas: Canvas,
    hovers: bool,
    /// Number of the drawing in the last frame.
    shown: Option<u64>,
    /// Time of the last motion of camera or platform, in time of the window (s).
    moved_s: Option<f64>,
    /// Live platform, and the time of its last update in time of the window (s).
    followed: Option<(LivePlatform, f64)>,
    picture: PictureRequest,
}

impl Robot3d {
    /// Number of renderings of the picture; copies do not count.
    #[must_use]
    pub fn draws(&self) -> u64 {
        self.canvas.draws()
    }

    /// Whether a software renderer is used; known after the first rendering.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.canvas.is_software()
    }

    /// Camera, once the view was shown.
    #[must_use]
    pub fn camera(&self) -> Option<&Camera> {
        self.navigation.camera()
    }

    /// Scene, once the view was shown.
    #[must_use]
    pub fn scene(&self) -> Option<&Arc<Scene>> {
        self.scene.as_ref().map(|(_, scene)| scene)
    }

    /// Frees resources on the graphics card, while its context is current.
    pub fn destroy(&mut self) {
        self.canvas.destroy();
    }

    /// Scene of the open session; the camera is reset for another session.
    fn scene_of(&mut self, ui: &Ui, model: &Model, open: &OpenSession) -> Arc<Scene> {
        self.follow(ui, model.live_platform.as_ref());
        let live = self.followed.as_ref().map(|(live, _)| live);
        let key = SceneKey {
            session: (open.id(), open.revision()),
            fit: open.fit().cloned(),
            selection: model.selection,
            live: live.cloned(),
            shows_errors: model.screen == Screen::Phase(Phase::Adjustment),
            tolerance_m: open.tolerance_m(),
        };
        let known = self.scene.as_ref();
        if let Some((_, scene)) = known.filter(|(known, _)| known.is_same(&key)) {
            return Arc::clone(scene);
        }
        let session = open.session();
        // Poses are kept while the platform moves.
        let poses = known.filter(|(known, _)| known.has_poses_of(&key));
        let planned = poses.map_or_else(|| planned(session), |(_, scene)| scene.planned.clone());
        let errors = match (key.shows_errors, poses) {
            (true, Some((_, scene))) => scene.errors.clone(),
            (true, None) => scene::errors::of_session(session),
            (false, _) => Vec::new(),
        };
        let subject = SceneInputs {
            errors: &errors,
            robot: &session.robot,
            measurements: &session.measurements,
            fit: open.fit().map(AsRef::as_ref),
            selection: model.selection,
            live,
            planned: &planned,
        };
        let measured = poses.map(|(_, scene)| Arc::clone(&scene.measured));
        let mut scene = subject.scene_with(measured);
        scene.tolerance_m = key.tolerance_m;
        scene.decision_rule = session.settings.certificate.decision_rule;
        let scene = Arc::new(scene);
        if known.is_none_or(|(known, _)| known.session.0 != key.session.0) {
            self.navigation.start_anew();
            // The pinned pulleys belong to the other robot.
            self.options.pinned.clear();
        }
        self.scene = Some((key, Arc::clone(&scene)));
        scene
    }

    /// Takes over the live platform, at a limited rate with a software renderer.
    fn follow(&mut self, ui: &Ui, latest: Option<&LivePlatform>) {
        let now_s = ui.input(|input| input.time);
        if let (Some((shown, since_s)), Some(latest)) = (&self.followed, latest)
            && shown.is_stopped == latest.is_stopped
        {
            let left_s = since_s + FOLLOWED_S - now_s;
            if shown == latest {
                return;
            }
            if self.is_software() && left_s > 0.0 {
                let left = Duration::from_secs_f64(left_s);
                return ui.ctx().request_repaint_after(left);
            }
        }
        self.followed = latest.map(|latest| (latest.clone(), now_s));
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
        self.drawings += 1;
        let drawing = Arc::new(Drawing {
            number: self.drawings,
            ..Drawing::with_poses(poses, scene, options, selection, theme)
        });
        self.drawing = Some((Arc::clone(scene), key, Arc::clone(&drawing)));
        drawing
    }

    /// Points of the poses, kept while the platform moves.
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

/// Draws the robot of the open session with its toolbar; `hovered` is the selection under the pointer, in all views.
pub fn show(
    ui: &mut Ui,
    model: &Model,
    view: &mut Robot3d,
    hovered: &mut Selection,
    outbox: &mut Outbox,
) {
    let Some(open) = &model.open else {
        ui.empty("The robot appears here once a session, a robot or a dataset is open.");
        return;
    };
    view.inspect(None);
    let scene = view.scene_of(ui, model, open);
    let mut maximise = false;
    let button = model.maximised.is_none().then_some(&mut maximise);
    let aim = view.toolbar(ui, &scene, model.selection, button);
    if maximise {
        outbox.send(ViewCommand::Maximise(Some(ScreenPart::Robot)));
    }
    let touched = view.show(ui, &scene, aim, model.selection, hovered);
    send(touched, outbox);
}

/// Draws the inspected pulley, with everything else faded.
pub fn inspect(
    ui: &mut Ui,
    model: &Model,
    cable: usize,
    view: &mut Robot3d,
    hovered: &mut Selection,
    aim: Option<CameraRequest>,
    outbox: &mut Outbox,
) {
    let Some(open) = &model.open else {
        return;
    };
    view.inspect(Some(cable));
    let scene = view.scene_of(ui, model, open);
    let touched = view.show(ui, &scene, aim, model.selection, hovered);
    send(touched, outbox);
}

/// Draws the pulleys of two sessions with the toolbar; a request to inspect a pulley frames it instead.
pub fn show_beside(
    ui: &mut Ui,
    scene: &Arc<Scene>,
    selection: Selection,
    view: &mut Robot3d,
    hovered: &mut Selection,
    outbox: &mut Outbox,
) {
    let aim = view.toolbar(ui, scene, selection, None);
    let mut touched = view.show(ui, scene, aim, selection, hovered);
    if let Some(cable) = touched.inspected.take() {
        view.frame(cable);
    }
    send(touched, outbox);
}

fn send(touched: ViewResponse, outbox: &mut Outbox) {
    if let Some(selection) = touched.selection {
        outbox.send(ViewCommand::Select(selection));
    }
    if let Some(cable) = touched.inspected {
        outbox.send(ViewCommand::Inspect(Some(cable)));
    }
    if let Some(picture) = touched.picture {
        outbox.send(PlotCommand::AskSave(
            "robot.png".into(),
            PlotFile::Screenshot(picture),
        ));
    }
}

/// Interaction of the operator with the picture.
#[derive(Debug, Clone, Default)]
pub struct ViewResponse {
    /// Selection after a click.
    pub selection: Option<Selection>,
    /// Pulley to inspect.
    pub inspected: Option<usize>,
    /// Picture to save.
    pub picture: Option<Arc<ColorImage>>,
}

impl Robot3d {
    /// Resets the camera: the next scene is fitted to the view.
    pub fn look_anew(&mut self) {
        self.navigation.start_anew();
    }

    /// Moves the camera to a pulley among its neighbours.
    pub fn frame(&mut self, cable: usize) {
        self.navigation.frame(cable);
    }

    /// Moves the camera to inspect a pulley, or back to the view before.
    fn inspect(&mut self, cable: Option<usize>) {
        self.options.inspected = cable;
        self.navigation.inspect(cable);
    }

    /// Draws the toolbar, with a button that maximises the view if possible; returns a requested camera movement.
    pub fn toolbar(
        &mut self,
        ui: &mut Ui,
        scene: &Scene,
        selection: Selection,
        maximise: Option<&mut bool>,
    ) -> Option<CameraRequest> {
        let mut aim = None;
        let projection = self
            .camera()
            .map_or(Projection::Perspective, Camera::projection);
        let can_frame = !selection.is_empty();
        Frame::new()
            .fill(theme::of(ui).ground)
            .inner_margin(Margin::symmetric(2 * GRID as i8, GRID as i8))
            .show(ui, |ui| {
                ui.set_min_width(ui.available_width());
                let options = &mut self.options;
                aim = toolbar::show(ui, options, scene, projection, can_frame, maximise);
            });
        // The picture begins directly below the toolbar, without a strip of another colour.
        ui.add_space(-ui.spacing().item_spacing.y);
        aim
    }

    /// Draws a scene and returns the interaction. `hovered` is the selection under the pointer, in all views.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        scene: &Arc<Scene>,
        aim: Option<CameraRequest>,
        selection: Selection,
        hovered: &mut Selection,
    ) -> ViewResponse {
        let drawing = self.drawing_of(scene, selection, ui.theme());
        let size = ui.available_size().max(egui::Vec2::splat(16.0));
        let (rect, response) = ui.allocate_exact_size(size, egui::Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, "3D view"));
        let aim = aim.or_else(|| canvas::keys(ui, &response));
        let mut touched = ViewResponse::default();
        match (aim, selection.cable) {
            (Some(CameraRequest::Selected), cable) => touched.inspected = cable,
            (Some(CameraRequest::Frame), Some(cable)) => self.navigation.frame(cable),
            (Some(CameraRequest::Frame), None) if selection.pose.is_some() => {
                self.navigation.frame_platform();
            }
            _ => {}
        }
        let aim = aim.map(|aim| match (aim, selection.cable) {
            (CameraRequest::Selected, None) => CameraRequest::All,
            _ => aim,
        });
        let flies = self.camera_for(ui, scene, aim, &response, &drawing);
        let Some(camera) = self.navigation.camera().copied() else {
            return touched;
        };
        let left_s = self.rest(ui, scene, &drawing, flies);
        let picture = Picture {
            scene,
            options: &self.options,
            camera: &camera,
            size: [rect.width(), rect.height()].map(f64::from),
        };
        let thing = canvas::under_pointer(&response, &picture);
        let found = canvas::found_pulley(&response, &picture);
        let moves = left_s.is_some();
        self.canvas
            .paint(ui, rect, &drawing, moves, &picture, *hovered);
        if let Some(thing) = thing {
            response
                .clone()
                .on_hover_text_at_pointer(words::describe(scene, thing));
        }
        let picked = thing.map(canvas::selection_of).unwrap_or_default();
        if thing.is_some() || self.hovers {
            // The hovered selection of another view stays until the pointer enters this one.
            *hovered = picked;
            self.hovers = thing.is_some();
        }
        if let (Some(Pickable::Pulley(index)), true) = (thing, response.clicked()) {
            self.options.pin(index);
        }
        touched.inspected = touched.inspected.or(found);
        if found.is_none() && response.clicked() {
            touched.selection = Some(canvas::clicked(picked, selection));
        }
        touched.picture = self.menu(&response);
        touched
    }

    /// Context menu of the picture; returns a picture to save.
    fn menu(&mut self, response: &Response) -> Option<Arc<ColorImage>> {
        response.context_menu(|ui| {
            if ui.button("Reset view").clicked() {
                self.look_anew();
                ui.close();
            }
            for (name, to) in [
                ("Copy picture", Target::Clipboard),
                ("Save picture…", Target::File),
            ] {
                if ui.button(name).clicked() {
                    self.picture.send(ui.ctx(), response.rect, to);
                    ui.close();
                }
            }
        });
        self.picture.receive(&response.ctx)
    }

    /// Moves the camera by keys, buttons and pointer; returns whether it moves.
    fn camera_for(
        &mut self,
        ui: &Ui,
        scene: &Scene,
        aim: Option<CameraRequest>,
        response: &Response,
        drawing: &Drawing,
    ) -> bool {
        let aspect = f64::from(response.rect.aspect_ratio());
        let before = self.navigation.camera().copied();
        let tips = self.options.tips(scene);
        let magnification = self.options.exaggeration_of(scene);
        let navigation = &mut self.navigation;
        let camera = navigation.aim(ui, scene, magnification, tips, aim, aspect);
        let picture = Picture {
            scene,
            options: &self.options,
            camera: &camera,
            size: [response.rect.width(), response.rect.height()].map(f64::from),
        };
        let at = canvas::takes_hold(ui, response);
        let under = at.and_then(|[x, y]| picture.met(drawing, x, y));
        let is_empty = || {
            let thing = canvas::under_pointer(response, &picture);
            thing.is_none() && canvas::found_pulley(response, &picture).is_none()
        };
        if response.double_clicked() && is_empty() {
            let tips = self.options.tips(scene);
            let all = Some(CameraRequest::All);
            navigation.aim(ui, scene, magnification, tips, all, aspect);
        } else {
            navigation.steer(ui, response, under);
        }
        before.is_some_and(|before| navigation.camera() != Some(&before))
    }

    /// Remaining time without motion until the picture is rendered in full quality (s); `None` if it is already.
    fn rest(&mut self, ui: &Ui, scene: &Scene, drawing: &Drawing, flies: bool) -> Option<f64> {
        let has_more = drawing.poses.coarse < drawing.poses.centres.len();
        let is_rough = has_more || self.is_software();
        let now_s = ui.input(|input| input.time);
        let has_new_platform = matches!(scene.shown, ShownPose::Live | ShownPose::Stopped)
            && self.shown != Some(self.drawings);
        if flies || has_new_platform {
            self.moved_s = Some(now_s);
        }
        self.shown = Some(self.drawings);
        let rests_s = self.moved_s.map(|moved_s| moved_s + REST_S - now_s);
        let left_s = rests_s.filter(|left_s| is_rough && *left_s > 0.0)?;
        ui.ctx()
            .request_repaint_after(Duration::from_secs_f64(left_s));
        Some(left_s)
    }
}
