//! A scene in the colours of a theme: triangles, lines and points as the graphics card takes them. No camera.

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{Color32, Theme};
use nalgebra::{Matrix3, SymmetricEigen};
use tautline_core::geometry::Vec3;

use super::mesh::{Triangles, circle, rgba, single};
use super::scene::{CableView, Displacement, MeasuredPose, Scene, Wheel};
use crate::model::Selection;
use crate::theme::{self, Palette};

/// Opacity of the pulleys shown besides.
const GHOST: f32 = 0.3;
/// Opacity of ellipsoids.
const ELLIPSOID: f32 = 0.28;

/// Most poses that are drawn while the camera moves.
const COARSE: usize = 8000;

/// By what cables are coloured.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum CableColour {
    /// Every cable has its own.
    #[default]
    Own,
    /// By tension.
    Tension,
    /// By the residual of its length.
    Residual,
}

impl CableColour {
    /// All.
    pub const ALL: [Self; 3] = [Self::Own, Self::Tension, Self::Residual];

    /// Label in the window.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Own => "Cable",
            Self::Tension => "Tension",
            Self::Residual => "Residual",
        }
    }
}

/// What is drawn and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// By what cables are coloured.
    pub colour: CableColour,
    /// How many times larger than they are displacements and ellipsoids are drawn; by default as suits the scene.
    pub exaggeration: Option<f64>,
    /// Pulleys shown besides, of the drawing or another session.
    pub nominal: bool,
    /// How the two differ.
    pub arrows: bool,
    /// Where pulleys are with 95 % confidence.
    pub ellipsoids: bool,
    /// Measured and planned poses.
    pub poses: bool,
    /// Numbers of the cables.
    pub labels: bool,
    /// Whether what is pinned is shown.
    pub callouts: bool,
    /// Pulleys, by the index of their cable, whose coordinates are written beside them.
    pub pinned: BTreeSet<usize>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            colour: CableColour::Own,
            exaggeration: None,
            nominal: true,
            arrows: true,
            ellipsoids: true,
            poses: true,
            labels: true,
            callouts: true,
            pinned: BTreeSet::new(),
        }
    }
}

impl Options {
    /// Pins the coordinates of a pulley, or takes them away.
    pub fn pin(&mut self, cable: usize) {
        if !self.pinned.remove(&cable) {
            self.pinned.insert(cable);
            self.callouts = true;
        }
    }

    /// How many times larger than they are displacements and ellipsoids of a scene are drawn.
    #[must_use]
    pub fn exaggeration_of(&self, scene: &Scene) -> f64 {
        self.exaggeration
            .unwrap_or_else(|| scene.fitting_exaggeration())
    }

    /// Where the displacements of a scene end as they are drawn (m).
    #[must_use]
    pub fn tips(&self, scene: &Scene) -> Vec<Vec3> {
        let exaggeration = self.exaggeration_of(scene);
        let moved = scene.cables.iter().filter_map(|cable| cable.moved.as_ref());
        moved
            .filter(|_| self.arrows || self.ellipsoids)
            .map(|moved| moved.from + moved.by * exaggeration)
            .collect()
    }
}

/// Lines of constant width.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Lines {
    /// Begin (m).
    pub from: Vec<[f32; 3]>,
    /// End (m).
    pub to: Vec<[f32; 3]>,
    /// Colour.
    pub colours: Vec<[f32; 4]>,
    /// Width (points of the screen).
    pub widths: Vec<f32>,
}

impl Lines {
    fn push(&mut self, [from, to]: [Vec3; 2], colour: Color32, width: f32) {
        self.from.push(single(&from));
        self.to.push(single(&to));
        self.colours.push(rgba(colour, 1.0));
        self.widths.push(width);
    }
}

/// Discs and rings of constant size.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Points {
    /// Centre (m).
    pub centres: Vec<[f32; 3]>,
    /// Colour.
    pub colours: Vec<[f32; 4]>,
    /// Diameter and width of the ring, 0 for a disc (points of the screen); radius (m) that replaces the point once it
    /// is seen larger, 0 for none.
    pub looks: Vec<[f32; 3]>,
    /// Number of points, from the first, that are drawn while the camera moves, where these are poses.
    pub coarse: usize,
}

impl Points {
    /// The poses of a scene; those that are drawn while the camera moves come first.
    #[must_use]
    pub fn of_poses(scene: &Scene, selection: Selection, theme: Theme) -> Self {
        let palette = theme::palette(theme);
        let mut points = Self::default();
        for position in &scene.planned {
            points.push(position, palette.accent, [8.0, 1.5, 0.0]);
        }
        let size = pose_size(scene.measured.len());
        let selected = selection
            .pose
            .and_then(|label| scene.measured.iter().find(|pose| pose.label == label));
        if let Some(pose) = selected {
            let ring = [size + 8.0, 2.0, 0.0];
            points.push(&pose.position, palette.accent, ring);
        }
        let is_coarse = coarse(&scene.measured);
        for wanted in [true, false] {
            let poses = scene.measured.iter().zip(&is_coarse);
            for (pose, _) in poses.filter(|(_, is)| **is == wanted) {
                let colour = pose.residual.map_or(palette.ghost, |r| palette.residual(r));
                points.push(&pose.position, colour, [size, 0.0, 0.0]);
            }
            if wanted {
                points.coarse = points.centres.len();
            }
        }
        points
    }

    fn push(&mut self, centre: &Vec3, colour: Color32, look: [f32; 3]) {
        self.centres.push(single(centre));
        self.colours.push(rgba(colour, 1.0));
        self.looks.push(look);
    }
}

/// Diameter of a measured pose's point among so many (points of the screen).
#[must_use]
pub fn pose_size(count: usize) -> f32 {
    match count {
        0..=300 => 8.0,
        301..=3000 => 6.0,
        _ => 4.0,
    }
}

/// Everything to be drawn.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Drawing {
    /// Opaque parts.
    pub solids: Triangles,
    /// Parts to look through.
    pub glass: Triangles,
    /// Lines.
    pub lines: Lines,
    /// Points.
    pub points: Points,
    /// Planned and measured poses.
    pub poses: Arc<Points>,
    /// Colour behind everything.
    pub ground: Color32,
    /// Centre (m) and radius (m) of a sphere around everything.
    pub bounds: (Vec3, f64),
}

/// Width of a cable (points of the screen).
#[must_use]
pub fn cable_width(is_selected: bool) -> f32 {
    if is_selected { 4.0 } else { 2.2 }
}

impl Drawing {
    /// The scene in the colours of `theme`.
    #[must_use]
    pub fn new(scene: &Scene, options: &Options, selection: Selection, theme: Theme) -> Self {
        let points = || Points::of_poses(scene, selection, theme);
        let poses = options.poses.then(points).unwrap_or_default();
        Self::with_poses(Arc::new(poses), scene, options, selection, theme)
    }

    /// The scene in the colours of `theme`, with these points of its poses.
    #[must_use]
    pub fn with_poses(
        poses: Arc<Points>,
        scene: &Scene,
        options: &Options,
        selection: Selection,
        theme: Theme,
    ) -> Self {
        let palette = theme::palette(theme);
        let mut drawing = Self {
            poses,
            ground: palette.ground,
            bounds: scene.bounds(&options.tips(scene)),
            ..Self::default()
        };
        drawing.frame(scene, palette);
        drawing.platform(scene, palette);
        let range = tension_range(scene);
        let exaggeration = options.exaggeration_of(scene);
        for (index, cable) in scene.cables.iter().enumerate() {
            let is_selected = selection.cable == Some(index);
            let colour = cable_colour(cable, index, options.colour, range, palette);
            drawing.cable(cable, colour, is_selected);
            let size = (scene.frame.size_m, exaggeration);
            drawing.pulley(cable, options, size, palette);
        }
        drawing.instruments(scene, palette);
        drawing
    }

    fn frame(&mut self, scene: &Scene, palette: &Palette) {
        let frame = &scene.frame;
        for member in &frame.members {
            self.solids
                .beam(*member, frame.member_m, rgba(palette.frame, 1.0));
        }
        for line in &frame.floor.lines {
            self.lines.push(*line, palette.line, 1.0);
        }
    }

    fn platform(&mut self, scene: &Scene, palette: &Palette) {
        let corners = scene.platform.corners(&scene.pose);
        self.solids.cuboid(&corners, rgba(palette.platform, 1.0));
        let edge = palette.platform.lerp_to_gamma(palette.ground, 0.5);
        for axis in 0..3 {
            for k in (0..8).filter(|k| k >> axis & 1 == 0) {
                self.lines
                    .push([corners[k], corners[k | 1 << axis]], edge, 1.0);
            }
        }
        let reach = 0.8 * (corners[7] - corners[0]).norm();
        for (axis, colour) in palette.axes.into_iter().enumerate() {
            let end = scene.pose.transform(&Vec3::ith(axis, reach));
            self.lines.push([scene.pose.position, end], colour, 2.0);
        }
    }

    fn cable(&mut self, cable: &CableView, colour: Color32, is_selected: bool) {
        for ends in cable.path.windows(2) {
            if let [from, to] = ends {
                self.lines
                    .push([*from, *to], colour, cable_width(is_selected));
            }
        }
        self.wheel(&cable.wheel, colour);
    }

    /// A pulley at its size; a disc stands for it where it would be too small to be seen.
    fn wheel(&mut self, wheel: &Wheel, colour: Color32) {
        if wheel.radius_m > 0.0 {
            self.solids.wheel(wheel, rgba(colour, 1.0));
        }
        self.points
            .push(&wheel.centre, colour, [9.0, 0.0, wheel.radius_m as f32]);
    }

    fn pulley(
        &mut self,
        cable: &CableView,
        options: &Options,
        (size_m, exaggeration): (f64, f64),
        palette: &Palette,
    ) {
        if let Some(nominal) = cable.nominal.filter(|_| options.nominal) {
            if nominal.radius_m > 0.0 {
                self.glass.wheel(&nominal, rgba(palette.ghost, GHOST));
                for side in circle(&nominal.centre, &nominal.normal, nominal.radius_m) {
                    self.lines.push(side, palette.ghost, 1.2);
                }
            }
            let look = [9.0, 1.5, nominal.radius_m as f32];
            self.points.push(&nominal.centre, palette.ghost, look);
        }
        let Some(moved) = &cable.moved else {
            return;
        };
        let tip = moved.from + moved.by * exaggeration;
        let ink = if moved.is_noise {
            palette.muted
        } else {
            palette.accent
        };
        if options.arrows {
            self.arrow(&moved.from, &tip, size_m, ink);
        }
        if options.ellipsoids
            && let Some(shape) = ellipsoid(moved, exaggeration)
        {
            let colour = rgba(ink, ELLIPSOID);
            self.glass.ellipsoid(&tip, &shape, colour);
        }
    }

    fn arrow(&mut self, from: &Vec3, tip: &Vec3, size_m: f64, colour: Color32) {
        let length = (tip - from).norm();
        let Some(direction) = (tip - from).try_normalize(1e-9) else {
            return;
        };
        let head = (0.4 * length).min(0.016 * size_m);
        let shaft = [*from, tip - direction * (0.8 * head)];
        self.lines.push(shaft, colour, 2.2);
        self.solids.cone(tip, &direction, head, rgba(colour, 1.0));
    }

    fn instruments(&mut self, scene: &Scene, palette: &Palette) {
        if let Some(laser) = &scene.laser {
            let size = scene.frame.size_m;
            let end = laser.spot.unwrap_or(laser.from + laser.direction * size);
            self.lines.push([laser.from, end], palette.laser, 1.6);
            if let Some(spot) = &laser.spot {
                let target = rgba(palette.laser, 0.18);
                self.glass.disc(spot, &laser.normal, 0.022 * size, target);
                for side in circle(spot, &laser.normal, 0.022 * size) {
                    self.lines.push(side, palette.laser, 1.2);
                }
                self.points.push(spot, palette.laser, [7.0, 0.0, 0.0]);
            }
        }
        for beam in &scene.home_beams {
            self.lines.push(*beam, palette.muted, 1.2);
            self.points.push(&beam[0], palette.muted, [7.0, 1.5, 0.0]);
        }
    }
}

/// Which poses are drawn while the camera moves: all if they are few, else those with the largest residuals and every
/// so many of the others.
fn coarse(poses: &[MeasuredPose]) -> Vec<bool> {
    if poses.len() <= COARSE {
        return vec![true; poses.len()];
    }
    let size = |pose: &MeasuredPose| pose.residual.map_or(0.0, f64::abs);
    let mut sizes: Vec<f64> = poses.iter().map(size).collect();
    let place = sizes.len() - COARSE / 2;
    let (_, least, _) = sizes.select_nth_unstable_by(place, f64::total_cmp);
    let (least, stride) = (*least, poses.len().div_ceil(COARSE / 2));
    let poses = poses.iter().enumerate();
    poses
        .map(|(k, pose)| k % stride == 0 || (size(pose) > 0.0 && size(pose) >= least))
        .collect()
}

/// Colour of a cable.
#[must_use]
pub fn cable_colour(
    cable: &CableView,
    index: usize,
    by: CableColour,
    range: Option<[f64; 2]>,
    palette: &Palette,
) -> Color32 {
    match by {
        CableColour::Own => palette.cable(index),
        CableColour::Tension => match (cable.tension_n, range) {
            (Some(tension), Some([low, high])) => {
                let span = (high - low).max(f64::MIN_POSITIVE);
                tension_colour(((tension - low) / span) as f32, palette)
            }
            _ => palette.ghost,
        },
        CableColour::Residual => cable
            .residual
            .map_or(palette.ghost, |r| palette.residual(r.value())),
    }
}

/// Colour at a share of the range of tensions.
#[must_use]
pub fn tension_colour(share: f32, palette: &Palette) -> Color32 {
    palette
        .ghost
        .lerp_to_gamma(palette.warning, share.clamp(0.0, 1.0))
}

/// Smallest and largest tension (N), if any is known.
#[must_use]
pub fn tension_range(scene: &Scene) -> Option<[f64; 2]> {
    let tensions = scene.cables.iter().filter_map(|cable| cable.tension_n);
    let (low, high) = tensions.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| {
        (low.min(t), high.max(t))
    });
    (low <= high).then_some([low, high])
}

/// Takes the unit sphere to the ellipsoid in which the pulley is with 95 % probability, so many times too large.
///
/// `d^T P^-1 d = q` with the 95 % point `q` of chi-square for as many coordinates as were estimated.
#[must_use]
pub fn ellipsoid(moved: &Displacement, exaggeration: f64) -> Option<Matrix3<f64>> {
    let covariance = moved.covariance?;
    let coordinates = (0..3).filter(|k| covariance[(*k, *k)] > 0.0).count();
    let quantile: f64 = match coordinates {
        1 => 3.841,
        2 => 5.991,
        _ => 7.815,
    };
    let eigen = SymmetricEigen::new(covariance);
    let scale = exaggeration * quantile.sqrt();
    let axes = eigen.eigenvalues.map(|v| scale * v.max(0.0).sqrt());
    // A flat ellipsoid is drawn with a thickness.
    let least = 0.02 * axes.max();
    (axes.max() > 0.0 && axes.iter().all(|a| a.is_finite()))
        .then(|| eigen.eigenvectors * Matrix3::from_diagonal(&axes.map(|a| a.max(least))))
}

#[cfg(test)]
mod tests {
    use super::super::scene::MeasuredPoses;
    use super::*;

    #[test]
    fn ellipsoid_has_the_semi_axes_of_the_covariance() {
        let moved = |diagonal| Displacement {
            from: Vec3::zeros(),
            by: Vec3::zeros(),
            covariance: Some(Matrix3::from_diagonal(&diagonal)),
            is_noise: false,
        };
        let shape = ellipsoid(&moved(Vec3::new(4e-6, 1e-6, 9e-6)), 10.0).unwrap();
        let mut axes: Vec<f64> = (0..3).map(|k| shape.column(k).norm()).collect();
        axes.sort_by(f64::total_cmp);
        for (axis, sd) in axes.iter().zip([1e-3, 2e-3, 3e-3]) {
            assert!((axis - 10.0 * sd * 7.815_f64.sqrt()).abs() < 1e-12);
        }
        let flat = ellipsoid(&moved(Vec3::new(1e-6, 1e-6, 0.0)), 1.0).unwrap();
        let largest = (0..3).map(|k| flat.column(k).norm()).fold(0.0, f64::max);
        assert!((largest - 1e-3 * 5.991_f64.sqrt()).abs() < 1e-12);
        assert!(ellipsoid(&moved(Vec3::zeros()), 1.0).is_none());
    }

    fn poses(count: i64) -> Vec<MeasuredPose> {
        let pose = |label: i64| MeasuredPose {
            label,
            position: Vec3::new(label as f64 * 1e-6, 0.0, 0.0),
            residual: Some((label as f64 * 0.7).sin()),
        };
        (0..count).map(pose).collect()
    }

    #[test]
    fn while_the_camera_moves_few_poses_are_drawn_and_every_outlier() {
        let mut many = poses(100_000);
        many[43_211].residual = Some(-40.0);
        let is_coarse = coarse(&many);
        let count = is_coarse.iter().filter(|is| **is).count();
        assert!(count <= COARSE && count > COARSE / 2, "{count}");
        assert!(is_coarse[43_211]);
        let size = |pose: &MeasuredPose| pose.residual.map_or(0.0, f64::abs);
        let left_out = many.iter().zip(&is_coarse).filter(|(_, is)| !**is);
        let largest_left_out = left_out.map(|(pose, _)| size(pose)).fold(0.0, f64::max);
        let larger = many.iter().filter(|pose| size(pose) > largest_left_out);
        assert!(larger.count() >= COARSE / 2 - 1, "the largest are there");
        let few = poses(COARSE as i64);
        assert!(coarse(&few).iter().all(|is| *is));
    }

    #[test]
    fn once_the_camera_rests_every_pose_is_drawn() {
        let robot = tautline_core::robot::presets::find("mini").unwrap().robot;
        let nothing = tautline_core::measurement::Measurements::default();
        let mut scene = super::super::scene::Subject::new(&robot, &nothing).scene();
        let draw = |scene: &Scene| {
            let drawing = Drawing::new(
                scene,
                &Options::default(),
                Selection::pose(20_000),
                Theme::Dark,
            );
            drawing.poses
        };
        assert!(draw(&scene).centres.is_empty());
        scene.measured = Arc::new(MeasuredPoses::new(poses(50_000)));
        let points = draw(&scene);
        let ring = 1;
        assert_eq!(points.centres.len(), ring + 50_000);
        assert!(points.coarse <= ring + COARSE);
        let mut places: Vec<f32> = points.centres[ring..]
            .iter()
            .map(|centre| centre[0])
            .collect();
        places.sort_by(f32::total_cmp);
        places.dedup();
        assert_eq!(places.len(), 50_000, "each once");
    }
}
