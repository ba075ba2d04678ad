//! Picking: the object under the pointer.

use tautline_core::geometry::Vec3;

use super::camera::{Camera, Ray};
use super::drawing::{Drawing, Options, cable_width, pose_size};
use super::scene::{PlacedCable, Scene, Wheel};
use super::surface;

/// Largest distance of the pointer from an object (points of the screen).
const TOLERANCE: f64 = 6.0;

/// Largest distance of a double-click from a pulley (points of the screen).
const NEAR_PULLEY: f64 = 24.0;

/// Object that can be picked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pickable {
    /// Cable, by its index.
    Cable(usize),
    /// Pulley of a cable.
    Pulley(usize),
    Platform,
    /// Measured pose, by its label.
    Pose(i64),
    LaserSpot,
}

/// Scene, options and camera of a picture.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    pub scene: &'a Scene,
    pub options: &'a Options,
    pub camera: &'a Camera,
    /// Width and height (points of the screen).
    pub size: [f64; 2],
}

/// Object near the pointer.
#[derive(Debug, Clone, Copy)]
struct Hit {
    thing: Pickable,
    /// Distance to the drawn object (points of the screen); 0 if it is hit.
    beside: f64,
    depth_m: f64,
}

/// Projected point, in points of the screen, with its depth (m).
#[derive(Debug, Clone, Copy)]
pub struct OnScreen {
    /// Distance from the left.
    pub x: f64,
    /// Distance from the top.
    pub y: f64,
    /// Distance along the direction of view (m).
    pub depth_m: f64,
}

impl Picture<'_> {
    fn aspect(&self) -> f64 {
        self.size[0] / self.size[1]
    }

    /// Projection of `point` (m); `None` behind the eye.
    #[must_use]
    pub fn on_screen(&self, point: &Vec3) -> Option<OnScreen> {
        let seen = self.camera.project(point, self.aspect())?;
        Some(OnScreen {
            x: seen.u * self.size[0],
            y: seen.v * self.size[1],
            depth_m: seen.depth_m,
        })
    }

    /// Points of the screen per metre at a depth (m).
    #[must_use]
    pub fn scale_at(&self, depth_m: f64) -> f64 {
        self.size[1] / self.camera.height_at(depth_m)
    }

    /// Cable and its pulleys as drawn.
    #[must_use]
    pub fn placed(&self, cable: usize) -> PlacedCable {
        let magnification = self.options.exaggeration_of(self.scene);
        self.scene.placed(cable, magnification)
    }

    /// Nearest point of the drawing at `(x, y)` (m).
    #[must_use]
    pub fn met(&self, drawing: &Drawing, x: f64, y: f64) -> Option<Vec3> {
        let (u, v) = (x / self.size[0], y / self.size[1]);
        let ray = self.camera.ray(u, v, self.aspect());
        let steepness = ray.direction.dot(&self.camera.axes()[2]);
        let surface = surface::met(drawing, &ray).map(|point| (point - ray.origin).norm());
        // Cables and poses have no surface.
        let thin = self.nearest(x, y).map(|hit| hit.depth_m / steepness);
        let nearest = surface.into_iter().chain(thin).min_by(f64::total_cmp)?;
        Some(ray.origin + ray.direction * nearest)
    }

    /// Object at `(x, y)`: of the objects hit the nearest to the eye, otherwise the closest beside.
    #[must_use]
    pub fn pick(&self, x: f64, y: f64) -> Option<Pickable> {
        self.nearest(x, y).map(|hit| hit.thing)
    }

    /// Pulley at `(x, y)`, otherwise the closest beside.
    pub(crate) fn pulley_near(&self, x: f64, y: f64) -> Option<usize> {
        if let Some(Pickable::Pulley(index)) = self.pick(x, y) {
            return Some(index);
        }
        let beside = |index| {
            let wheel = self.placed(index).wheel;
            let seen = self.on_screen(&wheel.centre)?;
            let radius = wheel.radius_m * self.scale_at(seen.depth_m);
            Some((index, (seen.x - x).hypot(seen.y - y) - radius))
        };
        (0..self.scene.cables.len())
            .filter_map(beside)
            .filter(|(_, distance)| *distance <= NEAR_PULLEY)
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(index, _)| index)
    }

    fn nearest(&self, x: f64, y: f64) -> Option<Hit> {
        let (u, v) = (x / self.size[0], y / self.size[1]);
        let ray = self.camera.ray(u, v, self.aspect());
        let forward = self.camera.axes()[2];
        let mut hits = Vec::new();
        self.pick_platform(&ray, &forward, &mut hits);
        for index in 0..self.scene.cables.len() {
            let placed = self.placed(index);
            let wheels = [
                Some(placed.wheel),
                placed.other.filter(|_| self.options.nominal),
            ];
            for wheel in wheels.iter().flatten() {
                hits.extend(self.pick_wheel(wheel, index, &ray, &forward, [x, y]));
            }
            hits.extend(self.pick_path(&placed.path, index, [x, y]));
        }
        if self.options.poses {
            hits.extend(self.pick_poses([x, y]));
        }
        let spot = self.scene.laser.and_then(|laser| laser.spot);
        hits.extend(spot.and_then(|spot| self.pick_point(&spot, 3.5, Pickable::LaserSpot, [x, y])));
        let order = |a: &Hit, b: &Hit| {
            let beside = a.beside.total_cmp(&b.beside);
            beside.then(a.depth_m.total_cmp(&b.depth_m))
        };
        hits.into_iter().min_by(order)
    }

    fn pick_platform(&self, ray: &Ray, forward: &Vec3, hits: &mut Vec<Hit>) {
        let pose = &self.scene.pose;
        let turn = pose.orientation.inverse();
        let local = Ray {
            origin: turn * (ray.origin - pose.position),
            direction: turn * ray.direction,
        };
        let platform = &self.scene.platform;
        if let Some(distance) = ray_box(&local, &platform.low, &platform.high) {
            hits.push(Hit {
                thing: Pickable::Platform,
                beside: 0.0,
                depth_m: distance * ray.direction.dot(forward),
            });
        }
    }

    fn pick_wheel(
        &self,
        wheel: &Wheel,
        index: usize,
        ray: &Ray,
        forward: &Vec3,
        at: [f64; 2],
    ) -> Option<Hit> {
        // The disc through its centre, or the sphere of its thickness if seen edge-on.
        let away = wheel.centre - ray.origin;
        let distance = away.dot(&wheel.normal) / ray.direction.dot(&wheel.normal);
        let met = ray.origin + ray.direction * distance;
        if distance > 0.0 && (met - wheel.centre).norm() <= 0.96 * wheel.radius_m {
            return Some(Hit {
                thing: Pickable::Pulley(index),
                beside: 0.0,
                depth_m: distance * ray.direction.dot(forward),
            });
        }
        let depth = away.dot(forward);
        let radius = (0.13 * wheel.radius_m * self.scale_at(depth)).max(4.5);
        self.pick_point(&wheel.centre, radius, Pickable::Pulley(index), at)
    }

    fn pick_path(&self, path: &[Vec3], index: usize, [x, y]: [f64; 2]) -> Option<Hit> {
        let half = f64::from(cable_width(false)) / 2.0;
        let seen: Vec<Option<OnScreen>> = path.iter().map(|p| self.on_screen(p)).collect();
        let pieces = seen.windows(2).filter_map(|ends| match ends {
            [Some(from), Some(to)] => Some(closest(from, to, x, y)),
            _ => None,
        });
        let (distance, depth_m) = pieces.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let beside = (distance - half).max(0.0);
        (beside <= TOLERANCE).then_some(Hit {
            thing: Pickable::Cable(index),
            beside,
            depth_m,
        })
    }

    fn pick_poses(&self, at: [f64; 2]) -> Option<Hit> {
        let poses = &self.scene.measured;
        let radius = f64::from(pose_size(poses.len())) / 2.0;
        let hits = poses.iter().filter_map(|pose| {
            self.pick_point(&pose.position, radius, Pickable::Pose(pose.label), at)
        });
        hits.min_by(|a, b| {
            let beside = a.beside.total_cmp(&b.beside);
            beside.then(a.depth_m.total_cmp(&b.depth_m))
        })
    }

    fn pick_point(
        &self,
        point: &Vec3,
        radius: f64,
        thing: Pickable,
        [x, y]: [f64; 2],
    ) -> Option<Hit> {
        let seen = self.on_screen(point)?;
        let beside = ((seen.x - x).hypot(seen.y - y) - radius).max(0.0);
        (beside <= TOLERANCE).then_some(Hit {
            thing,
            beside,
            depth_m: seen.depth_m,
        })
    }
}

/// Distance of `(x, y)` from the segment between two points, and the depth there (m).
fn closest(from: &OnScreen, to: &OnScreen, x: f64, y: f64) -> (f64, f64) {
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let square = dx * dx + dy * dy;
    let share = if square > 0.0 {
        (((x - from.x) * dx + (y - from.y) * dy) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let distance = (from.x + share * dx - x).hypot(from.y + share * dy - y);
    // Along a line, the reciprocal of the depth is linear in the picture.
    let inverse = (1.0 - share) / from.depth_m + share / to.depth_m;
    (distance, 1.0 / inverse)
}

/// Distance along the ray to its entry into the box (m).
fn ray_box(ray: &Ray, low: &Vec3, high: &Vec3) -> Option<f64> {
    let (mut enters, mut leaves) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let inverse = 1.0 / ray.direction[axis];
        let a = (low[axis] - ray.origin[axis]) * inverse;
        let b = (high[axis] - ray.origin[axis]) * inverse;
        enters = enters.max(a.min(b));
        leaves = leaves.min(a.max(b));
    }
    (enters <= leaves).then_some(enters)
}

#[cfg(test)]
mod tests {
    use tautline_core::measurement::Measurements;
    use tautline_core::robot::presets;

    use super::*;
    use crate::views::robot_3d::camera::StandardView;
    use crate::views::robot_3d::scene::SceneInputs;

    fn with_picture(name: &str, check: impl Fn(&Picture<'_>)) {
        let robot = presets::find(name).unwrap().robot;
        let scene = SceneInputs::new(&robot, &Measurements::default()).scene();
        let size = [900.0, 600.0];
        let options = Options::default();
        for view in StandardView::ALL {
            let extent = scene.extent();
            let camera = Camera::new(scene.directions, view, &extent, 1.5);
            check(&Picture {
                scene: &scene,
                options: &options,
                camera: &camera,
                size,
            });
        }
    }

    #[test]
    fn the_middle_of_a_free_cable_is_that_cable_or_something_before_it() {
        for name in presets::NAMES {
            with_picture(name, |picture| {
                for (index, cable) in picture.scene.cables.iter().enumerate() {
                    let ends = &cable.path[cable.path.len() - 2..];
                    let middle = picture.on_screen(&ends[0].lerp(&ends[1], 0.5)).unwrap();
                    let thing = picture.pick(middle.x, middle.y).unwrap();
                    if thing == Pickable::Cable(index) {
                        continue;
                    }
                    // In views along an axis, cables cover each other; the picked one must be drawn at this position,
                    // too.
                    let covers = match thing {
                        Pickable::Cable(other) => picture
                            .pick_path(
                                &picture.scene.cables[other].path,
                                other,
                                [middle.x, middle.y],
                            )
                            .is_some_and(|hit| hit.beside == 0.0),
                        Pickable::Platform | Pickable::LaserSpot | Pickable::Pulley(_) => true,
                        Pickable::Pose(_) => false,
                    };
                    assert!(covers, "{name}: {thing:?} instead of {index}");
                }
            });
        }
    }

    #[test]
    fn pulleys_are_picked_and_empty_space_is_not() {
        let robot = presets::find("mini").unwrap().robot;
        let scene = SceneInputs::new(&robot, &Measurements::default()).scene();
        let camera = Camera::new(
            scene.directions,
            StandardView::Isometric,
            &scene.extent(),
            1.5,
        );
        let picture = Picture {
            scene: &scene,
            options: &Options::default(),
            camera: &camera,
            size: [900.0, 600.0],
        };
        for (index, cable) in scene.cables.iter().enumerate() {
            let seen = picture.on_screen(&cable.wheel.centre).unwrap();
            assert_eq!(picture.pick(seen.x, seen.y), Some(Pickable::Pulley(index)));
        }
        let middle = picture.on_screen(&scene.pose.position).unwrap();
        assert_eq!(picture.pick(middle.x, middle.y), Some(Pickable::Platform));
        assert_eq!(picture.pick(5.0, 5.0), None);
        assert_eq!(picture.pulley_near(5.0, 5.0), None);
    }
}
