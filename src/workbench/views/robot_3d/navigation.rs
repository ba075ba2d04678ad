//! Where the camera is and where it goes: what it shows until the operator moves it, flights to pulleys and back.

use egui::{Response, Ui};
use tautline_core::geometry::Vec3;

use super::camera::{Camera, Flight, StandardView};
use super::canvas;
use super::scene::{Scene, Wheel};
use super::toolbar::Aim;

/// Free space around a pulley that is inspected, in its radii.
const AROUND: f64 = 1.35;
/// Least part of the frame's size that is shown around a pulley that is framed among others.
const NEIGHBOURHOOD: f64 = 0.06;

/// Where the camera is asked to go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Goal {
    /// So close to a pulley that its displacement is seen true to scale.
    Inspect(usize),
    /// To a pulley among its neighbours.
    Frame(usize),
    Platform,
    /// To where it was before pulleys were inspected.
    Back,
}

/// What the camera shows all of until the operator moves it.
type Framed = Option<(f64, Vec<Vec3>)>;

/// The camera of a view with where it goes.
#[derive(Debug, Default)]
pub struct Navigation {
    camera: Option<Camera>,
    /// Shape of the picture, and ends of displacements (m).
    framed: Framed,
    flight: Option<Flight>,
    goal: Option<Goal>,
    /// The pulley that is inspected, and how everything was seen before.
    inspected: Option<usize>,
    before: Option<(Camera, Framed)>,
    /// What the pointer took hold of.
    pivot: Option<Vec3>,
}

impl Navigation {
    /// The camera, once the view was shown.
    pub fn camera(&self) -> Option<&Camera> {
        self.camera.as_ref()
    }

    /// Forgets where it was: the next scene is fitted to the view.
    pub fn start_anew(&mut self) {
        *self = Self {
            inspected: self.inspected,
            goal: self.inspected.map(Goal::Inspect),
            ..Self::default()
        };
    }

    /// Flies to a pulley to inspect it, to another one, or back.
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

    /// Flies to a pulley among its neighbours.
    pub fn frame(&mut self, cable: usize) {
        self.goal = Some(Goal::Frame(cable));
    }

    /// Flies to the platform.
    pub fn frame_platform(&mut self) {
        self.goal = Some(Goal::Platform);
    }

    /// The camera in the present frame: turned as was asked, on its way, or showing everything anew because the picture or
    /// the displacements have changed. `magnification` is that of displacements.
    pub fn aim(
        &mut self,
        ui: &Ui,
        (scene, magnification): (&Scene, f64),
        tips: Vec<Vec3>,
        aim: Option<Aim>,
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
            Some(Aim::To(side)) => camera.turn_to(side),
            Some(Aim::Project(projection)) => camera.set_projection(projection),
            Some(Aim::Selected) => {
                self.goal = self.inspected.map(Goal::Inspect).or(self.goal);
            }
            Some(Aim::All | Aim::Frame) | None => {}
        }
        let is_other = self.framed.as_ref().is_some_and(|framed| *framed != now);
        let shows_all = matches!(aim, Some(Aim::All | Aim::To(_)));
        if shows_all || is_other {
            camera.fit(&extent, aspect);
            self.framed = Some(now).filter(|_| self.inspected.is_none());
            self.flight = None;
        }
        let time_s = ui.input(|input| input.time);
        if let Some(goal) = self.goal.take() {
            let end = self.end(goal, &camera, (scene, magnification), aspect);
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

    /// Where a flight ends.
    fn end(
        &mut self,
        goal: Goal,
        camera: &Camera,
        (scene, magnification): (&Scene, f64),
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

    /// Follows the pointer; `under` is what it is over (m). Says whether the camera was moved.
    pub fn steer(&mut self, ui: &Ui, response: &Response, under: Option<Vec3>) -> bool {
        let Some(camera) = &mut self.camera else {
            return false;
        };
        let before = *camera;
        if response.drag_started() {
            self.pivot = under;
        }
        canvas::steer(ui, response, camera, (self.pivot, under));
        let is_moved = *camera != before;
        if is_moved {
            self.flight = None;
            self.framed = None;
        }
        is_moved
    }
}

/// From where a pulley is looked at: across its plane and a little from above, from the side that is seen now. `forward`
/// is the present direction of view.
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

/// Points around both pulleys of a cable where they are drawn (m): all of their wheels, the displacement with its
/// uncertainty, and at least `least_m` to every side.
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
