//! Picture of the home platform's six sensors, in a parallel projection.

use egui::{
    Align2, Color32, Pos2, Rect, Role, Sense, Shape, Stroke, TextStyle, Ui, Vec2, WidgetInfo,
};
use tautline_core::geometry::{Pose, Vec3};
use tautline_core::robot::{HomePlatform, HomeSensor, Plane};

use crate::screens::bench_panel::Bench;
use crate::theme::{self, GRID};
use tautline_workflow::precalibration::home_start_in_reference;

/// Height of the picture (points).
const HEIGHT: f32 = 208.0;
/// Half the edge of a drawn plane, relative to the largest extent of the scene.
const PATCH: f64 = 0.16;

/// Scene in the reference frame (m).
struct Scene {
    /// Origin, hit point and index of the plane of each sensor.
    beams: Vec<(Vec3, Vec3, usize)>,
    /// Corners of the planes.
    patches: Vec<[Vec3; 4]>,
    platform: Pose,
}

/// Draws the sensors, their beams, the planes of the platform and its frame, at the measured pose, otherwise at home.
pub fn show(ui: &mut Ui, bench: &Bench<'_>, platform: &HomePlatform) {
    let size = Vec2::new(ui.available_width(), HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let name = "Picture of the six sensors";
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, name));
    let palette = theme::of(ui);
    ui.painter().rect_filled(rect, 4.0, palette.ground);
    let measured = bench.calibration.home.as_ref();
    let measured = measured.and_then(|home| home.as_ref().ok());
    let pose = measured.map_or_else(
        || home_start_in_reference(bench.robot(), platform),
        |home| home.fix.platform_in_reference,
    );
    let scene = Scene::new(platform, pose);
    let view = View::of(&scene, rect.shrink(6.0 * GRID));
    for (patch, tint) in scene.patches.iter().zip([0.20, 0.13, 0.27]) {
        let corners = patch.iter().map(|corner| view.at(corner)).collect();
        let fill = palette.platform.gamma_multiply(tint);
        let edge = Stroke::new(1.0, palette.ghost);
        ui.painter().add(Shape::convex_polygon(corners, fill, edge));
    }
    axes(ui, &view, &scene.platform);
    for (k, (origin, hit, _)) in scene.beams.iter().enumerate() {
        let in_range = measured.is_none_or(|m| m.sensors.get(k).is_none_or(|s| s.in_range));
        let colour = if in_range {
            palette.laser
        } else {
            palette.warning
        };
        beam(ui, [view.at(origin), view.at(hit)], k + 1, colour);
    }
    let hover = "Numbered circles: sensors on the reference. Lines: their beams. Faces: planes of the platform. Arrows: x, y and z of the platform.";
    response.on_hover_text(hover);
}

impl Scene {
    fn new(home: &HomePlatform, platform: Pose) -> Self {
        let beams: Vec<(Vec3, Vec3, usize)> = home
            .sensors
            .iter()
            .filter_map(|sensor| {
                let plane = home.planes.get(sensor.plane)?;
                let (origin, hit) = meet(sensor, plane, &platform)?;
                Some((origin, hit, sensor.plane))
            })
            .collect();
        let points = || beams.iter().flat_map(|(origin, hit, _)| [origin, hit]);
        let extent = points()
            .map(|point| (point - platform.position).norm())
            .fold(1e-3, f64::max);
        let patches = (0..home.planes.len())
            .filter_map(|k| {
                let normal = platform.orientation * Vec3::from(home.planes[k].normal);
                let hits = beams.iter().filter(|beam| beam.2 == k);
                let hits: Vec<Vec3> = hits.map(|beam| beam.1).collect();
                let middle = hits.iter().sum::<Vec3>() / hits.len().max(1) as f64;
                (!hits.is_empty()).then(|| patch(middle, normal, &hits, PATCH * extent))
            })
            .collect();
        Self {
            beams,
            patches,
            platform,
        }
    }
}

/// Origin of a sensor and intersection of its beam with its plane, for the platform at `pose`.
fn meet(sensor: &HomeSensor, plane: &Plane, pose: &Pose) -> Option<(Vec3, Vec3)> {
    let (origin, direction) = (Vec3::from(sensor.origin_m), Vec3::from(sensor.direction));
    let normal = pose.orientation * Vec3::from(plane.normal);
    let along = normal.dot(&direction);
    let distance = (plane.offset_m + normal.dot(&(pose.position - origin))) / along;
    let hit = origin + direction * distance;
    hit.iter().all(|v| v.is_finite()).then_some((origin, hit))
}

/// Square in the plane through `middle` that contains all `hits`.
fn patch(middle: Vec3, normal: Vec3, hits: &[Vec3], margin: f64) -> [Vec3; 4] {
    let helper = if normal.z.abs() < 0.9 {
        Vec3::z()
    } else {
        Vec3::x()
    };
    let u = normal.cross(&helper).normalize();
    let v = normal.cross(&u);
    let reach = |axis: &Vec3| {
        let far = hits.iter().map(|hit| (hit - middle).dot(axis).abs());
        far.fold(0.0, f64::max) + margin
    };
    let (u, v) = (u * reach(&u), v * reach(&v));
    [
        middle - u - v,
        middle + u - v,
        middle + u + v,
        middle - u + v,
    ]
}

/// Parallel projection: x to the lower right, y to the upper right, z up.
struct View {
    scale: f64,
    middle: [f64; 2],
    centre: Pos2,
}

fn project(point: &Vec3) -> [f64; 2] {
    [
        0.82 * point.x + 0.57 * point.y,
        0.30 * point.x - 0.42 * point.y - 0.86 * point.z,
    ]
}

impl View {
    fn of(scene: &Scene, rect: Rect) -> Self {
        let beams = scene
            .beams
            .iter()
            .flat_map(|(origin, hit, _)| [origin, hit]);
        let points = beams.chain(scene.patches.iter().flatten());
        let points = points.chain([&scene.platform.position]).map(project);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points {
            for k in 0..2 {
                low[k] = low[k].min(point[k]);
                high[k] = high[k].max(point[k]);
            }
        }
        let size = [rect.width(), rect.height()];
        let fit = |k: usize| f64::from(size[k]) / (high[k] - low[k]).max(1e-6);
        Self {
            scale: fit(0).min(fit(1)),
            middle: [0, 1].map(|k| 0.5 * (low[k] + high[k])),
            centre: rect.center(),
        }
    }

    fn at(&self, point: &Vec3) -> Pos2 {
        let flat = project(point);
        let [x, y] = [0, 1].map(|k| ((flat[k] - self.middle[k]) * self.scale) as f32);
        self.centre + Vec2::new(x, y)
    }
}

fn axes(ui: &Ui, view: &View, pose: &Pose) {
    let palette = theme::of(ui);
    let origin = view.at(&pose.position);
    let length = 40.0 / view.scale;
    let font = TextStyle::Small.resolve(ui.style());
    for (axis, name) in [(Vec3::x(), "x"), (Vec3::y(), "y"), (Vec3::z(), "z")] {
        let tip = view.at(&(pose.position + pose.orientation * axis * length));
        let stroke = Stroke::new(1.5, palette.muted);
        ui.painter().arrow(origin, tip - origin, stroke);
        let place = tip + (tip - origin).normalized() * 7.0;
        ui.painter().text(
            place,
            Align2::CENTER_CENTER,
            name,
            font.clone(),
            palette.muted,
        );
    }
}

fn beam(ui: &Ui, [from, to]: [Pos2; 2], number: usize, colour: Color32) {
    let palette = theme::of(ui);
    let painter = ui.painter();
    painter.line_segment([from, to], Stroke::new(1.5, colour));
    painter.circle_filled(to, 2.5, colour);
    painter.circle(from, 8.0, palette.raised, Stroke::new(1.0, palette.muted));
    let font = TextStyle::Small.resolve(ui.style());
    let text = number.to_string();
    painter.text(from, Align2::CENTER_CENTER, text, font, palette.text);
}
