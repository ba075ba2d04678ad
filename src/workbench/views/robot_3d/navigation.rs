//! Navigation: automatic framing until the operator moves the camera, and transitions to pulleys and back.

use egui::{Response, Ui};
use tautline_core::geometry::Vec3;

use super::camera::{Camera, Flight, StandardView};
use super::canvas;
use super::scene::{Scene, Wheel};
use super::toolbar::CameraRequest;

/// Free space around an inspected pulley, in its radii.
const AROUND: f64 = 1.35;
/// Smallest share of the frame's size that is shown around a framed pulley.
const NEIGHBOURHOOD: f64 = 0.06;

/// Target of a camera movement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Goal {
    /// Close-up of a pulley at which its displacement is visible true to scale.
    Inspect(usize),
    /// Pulley among its neighbours.
    Frame(usize),
    Platform,
    /// View before pulleys were inspected.
    Back,
}

/// Aspect ratio and points framed automatically, until the operator moves the camera.
type Framed = Option<(f64, Vec<Vec3>)>;

/// Camera of a view with its movements.
#[derive(Debug, Default)]
pub struct Navigation {
    camera: Option<Camera>,
    /// Aspect ratio of the picture, and ends of displacements (m).
    framed: Framed,
    flight: Option<Flight>,
    goal: Option<Goal>,
    /// Inspected pulley, and camera before.
    inspected: Option<usize>,
    before: Option<(Camera, Framed)>,
    /// Point grabbed by the pointer.
    pivot: Option<Vec3>,
}

impl Navigation {
    /// Camera, once the view was shown.
    pub fn camera(&self) -> Option<&Camera> {
        self.camera.as_ref()
    }

    /// Resets the camera: the next scene is fitted to the view.
    pub fn start_anew(&mut self) {
        *self = Self {
            inspected: self.inspected,
            goal: self.inspected.map(Goal::Inspect),
            ..Self::default()
        };
    }

    /// Moves the camera to inspect a pulley, or back.
    pub fn inspect(&mut self, cable: Option<usize>) {
        if self.inspected == cable {
            return;
        }
        self.goal = Some(cable.map_or(Goal::Back, Goal::Inspect));
        if self.inspected.is_none() {
            self.before = self.camera.map(|camera| (camera, self.framed.take()));
        }
        self.inspected = cable;
    }

    /// Moves the camera to a pulley among its neighbours.
    pub fn frame(&mut self, cable: usize) {
        self.goal = Some(Goal::Frame(cable));
    }

    /// Moves the camera to the platform.
    pub fn frame_platform(&mut self) {
        self.goal = Some(Goal::Platform);
    }

    /// Camera of the present frame: turned on request, in transition, or refitted because picture or displacements have
    /// changed. `magnification` is that of displacements.
    pub fn aim(
        &mut self,
        ui: &Ui,
        scene: &Scene,
        magnification: f64,
        tips: Vec<Vec3>,
        aim: Option<CameraRequest>,
        aspect: f64,
    ) -> Camera {
        let mut extent = scene.extent();
        extent.extend(&tips);
        let now = (aspect, tips);
        let mut camera = self.camera.unwrap_or_else(|| {
            self.framed = Some(now.clone());
            Camera::new(scene.directions, StandardView::Isometric, &extent, aspect)
        });
        match aim {
            Some(CameraRequest::To(side)) => camera.turn_to(side),
            Some(CameraRequest::Project(projection)) => camera.set_projection(projection),
            Some(CameraRequest::Selected) => {
                self.goal = self.inspected.map(Goal::Inspect).or(self.goal);
            }
            Some(CameraRequest::All | CameraRequest::Frame) | None => {}
        }
        let is_other = self.framed.as_ref().is_some_and(|framed| *framed != now);
        let shows_all = matches!(aim, Some(CameraRequest::All | CameraRequest::To(_)));
        if shows_all || is_other {
            camera.fit(&extent, aspect);
            self.framed = Some(now).filter(|_| self.inspected.is_none());
            self.flight = None;
        }
        let time_s = ui.input(|input| input.time);
        if let Some(goal) = self.goal.take() {
            let end = self.end(goal, &camera, scene, magnification, aspect);
            self.flight = Some(Flight::new(camera, end, time_s));
        }
        if let Some(flight) = &self.flight {
            let (here, has_arrived) = flight.at(time_s);
            camera = here;
            if has_arrived {
                self.flight = None;
            } else {
                ui.ctx().request_repaint();
            }
        }
        self.camera = Some(camera);
        camera
    }

    /// Camera at the end of a transition.
    fn end(
        &mut self,
        goal: Goal,
        camera: &Camera,
        scene: &Scene,
        magnification: f64,
        aspect: f64,
    ) -> Camera {
        let mut end = *camera;
        match goal {
            Goal::Back => {
                if let Some((before, framed)) = self.before.take() {
                    self.framed = framed;
                    return before;
                }
                end.fit(&scene.extent(), aspect);
            }
            Goal::Inspect(cable) => {
                self.framed = None;
                if let Some(direction) = towards(scene, cable, &camera.axes()[2]) {
                    end.look_along(&direction);
                }
                end.frame(&around(scene, cable, 1.0, 0.0), aspect);
            }
            Goal::Frame(cable) => {
                self.framed = None;
                let least_m = NEIGHBOURHOOD * scene.frame.size_m;
                end.frame(&around(scene, cable, magnification, least_m), aspect);
            }
            Goal::Platform => {
                self.framed = None;
                end.frame(&beside_platform(scene), aspect);
            }
        }
        end
    }

    /// Follows the pointer; `under` is the point under it (m). Returns whether the camera was moved.
    pub fn steer(&mut self, ui: &Ui, response: &Response, under: Option<Vec3>) -> bool {
        let Some(camera) = &mut self.camera else {
            return false;
        };
        let before = *camera;
        if response.drag_started() {
            self.pivot = under;
        }
        canvas::steer(ui, response, camera, self.pivot, under);
        let is_moved = *camera != before;
        if is_moved {
            self.flight = None;
            self.framed = None;
        }
        is_moved
    }
}

/// Direction of view for inspecting a pulley: perpendicular to its plane and slightly from above, on the side that is
/// visible now. `forward` is the present direction of view.
fn towards(scene: &Scene, cable: usize, forward: &Vec3) -> Option<Vec3> {
    let normal = scene.cables.get(cable)?.wheel.normal;
    let facing = if normal.dot(forward) > 0.0 {
        normal
    } else {
        -normal
    };
    let up = scene.directions.column(2).into_owned();
    let beside = up.cross(&facing);
    (facing - up * 0.4 + beside * 0.35).try_normalize(1e-6)
}

/// Points around the platform (m).
fn beside_platform(scene: &Scene) -> Vec<Vec3> {
    let middle = scene.pose.position;
    let corners = scene.platform.corners(&scene.pose);
    corners
        .map(|corner| middle + 1.5 * (corner - middle))
        .into()
}

/// Points around both pulleys of a cable as drawn (m): their wheels, the displacement with its uncertainty, and at
/// least `least_m` to every side.
fn around(scene: &Scene, cable: usize, magnification: f64, least_m: f64) -> Vec<Vec3> {
    let placed = scene.placed(cable, magnification);
    let moved = scene.cables.get(cable).and_then(|cable| cable.moved);
    let reach_m = moved.map_or(0.0, |moved| moved.reach_m()) * magnification;
    let wheels: Vec<&Wheel> = placed.other.iter().chain([&placed.wheel]).collect();
    let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
    let mut points = Vec::new();
    for wheel in wheels {
        let radius_m = (AROUND * wheel.radius_m)
            .max(least_m)
            .max(1e-3 * scene.frame.size_m);
        for axis in axes {
            points.extend([-1.0, 1.0].map(|side| wheel.centre + axis * (side * radius_m)));
            points.extend([-1.0, 1.0].map(|side| wheel.entry + axis * (side * reach_m)));
        }
    }
    points
}
