//! Drawing of a scene in the colours of a theme: triangles, lines and points for the graphics card, independent of the
//! camera.

mod bands;
mod colours;
mod options;
mod path;
mod points;

use std::sync::Arc;

use egui::{Color32, Theme};
use nalgebra::{Matrix3, SymmetricEigen};
use tautline_core::geometry::Vec3;

pub use bands::{Band, band_colour, is_drawn};
pub use colours::{
    arrow_colour, cable_colour, conformity_colour, error_colour, length_colour, longest_m,
    significance_colour, tension_colour, tension_range,
};
pub use options::{ArrowColour, CableColour, FrameLook, Options};
pub use points::{Lines, Points, pose_size};

use super::parts::{SolidPart, paint};
use super::scene::{CableView, Displacement, PlacedCable, Reference, Scene, Wheel};
use crate::model::Selection;
use crate::theme::{self, Palette};

/// Opacity of the second set of pulleys.
const GHOST: f32 = 0.3;
/// Opacity of the inspected pulley, and of one that moved in the other session.
const INSPECTED: f32 = 0.55;
/// Largest length of an arrow's head, in sizes of the frame.
const ARROW: f64 = 0.016;
/// Opacity of ellipsoids.
const ELLIPSOID: f32 = 0.28;
/// Opacity of parts for orientation only.
const THIN: f32 = 0.13;

/// All parts of a drawing.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Drawing {
    /// Number by which the graphics card knows it.
    pub number: u64,
    /// Opaque parts.
    pub solids: Vec<SolidPart>,
    /// Translucent parts.
    pub glass: Vec<SolidPart>,
    pub lines: Lines,
    pub points: Points,
    /// Planned and measured poses.
    pub poses: Arc<Points>,
    /// Background colour.
    pub ground: Color32,
    /// Centre (m) and radius (m) of a sphere around everything.
    pub bounds: (Vec3, f64),
}

/// Appearance of a cable and its pulley.
#[derive(Debug, Clone, Copy)]
struct CableLook {
    colour: Color32,
    fades: bool,
    is_selected: bool,
    is_inspected: bool,
}

/// Faded colour.
fn faded(colour: Color32, palette: &Palette) -> Color32 {
    colour.lerp_to_gamma(palette.ground, 0.72)
}

/// Width of a cable (points of the screen).
#[must_use]
pub fn cable_width(is_selected: bool) -> f32 {
    if is_selected { 4.0 } else { 2.2 }
}

impl Drawing {
    /// Drawing of the scene in the colours of `theme`.
    #[must_use]
    pub fn new(scene: &Scene, options: &Options, selection: Selection, theme: Theme) -> Self {
        let points = || Points::of_poses(scene, selection, theme);
        let poses = options.poses.then(points).unwrap_or_default();
        Self::with_poses(Arc::new(poses), scene, options, selection, theme)
    }

    /// Drawing of the scene in the colours of `theme`, with existing points for its poses.
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
        drawing.frame(scene, options, palette);
        drawing.platform(scene, options, palette);
        let range = tension_range(scene);
        for (index, cable) in scene.cables.iter().enumerate() {
            let colour = cable_colour(cable, index, options.colour, range, palette);
            let fades = options.fades(scene, index);
            let look = CableLook {
                colour: if fades {
                    faded(colour, palette)
                } else {
                    colour
                },
                fades,
                is_selected: selection.cable == Some(index),
                is_inspected: options.inspected == Some(index),
            };
            let placed = scene.placed(index, options.exaggeration_of(scene));
            drawing.cable(&placed, look);
            drawing.pulley(cable, &placed, look, scene, options, palette);
            drawing.bands(scene, index, options, palette);
        }
        if options.inspected.is_none() {
            drawing.trail(scene, palette);
            drawing.path(scene, options, selection, palette);
            drawing.errors(scene, options, palette);
            drawing.instruments(scene, palette);
        }
        drawing
    }

    fn frame(&mut self, scene: &Scene, options: &Options, palette: &Palette) {
        let frame = &scene.frame;
        let look = match options.inspected {
            Some(_) if options.frame == FrameLook::Solid => FrameLook::Transparent,
            _ => options.frame,
        };
        for member in &frame.members {
            match look {
                FrameLook::Solid => {
                    let colour = paint(palette.frame, 1.0);
                    self.solids
                        .extend(SolidPart::beam(*member, frame.member_m, colour));
                }
                FrameLook::Transparent => {
                    let colour = paint(palette.frame, THIN);
                    self.glass
                        .extend(SolidPart::beam(*member, frame.member_m, colour));
                }
                FrameLook::Hidden => {}
            }
        }
        for line in &frame.floor.lines {
            self.lines.push(*line, palette.line, 1.0);
        }
    }

    fn platform(&mut self, scene: &Scene, options: &Options, palette: &Palette) {
        let corners = scene.platform.corners(&scene.pose);
        if options.inspected.is_some() {
            self.glass
                .push(SolidPart::cuboid(&corners, paint(palette.platform, THIN)));
            return;
        }
        self.solids
            .push(SolidPart::cuboid(&corners, paint(palette.platform, 1.0)));
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

    fn cable(&mut self, placed: &PlacedCable, look: CableLook) {
        for ends in placed.path.windows(2) {
            if let [from, to] = ends {
                let width = cable_width(look.is_selected);
                self.lines.push([*from, *to], look.colour, width);
            }
        }
        let wheel = &placed.wheel;
        if look.is_inspected {
            self.glass_wheel(wheel, look.colour, INSPECTED);
        } else {
            self.wheel(wheel, look.colour);
        }
    }

    /// Draws a pulley to scale, or a disc if it would be too small to see.
    fn wheel(&mut self, wheel: &Wheel, colour: Color32) {
        if wheel.radius_m > 0.0 {
            self.solids
                .push(SolidPart::wheel(wheel, paint(colour, 1.0)));
        }
        self.points
            .push(&wheel.centre, colour, [9.0, 0.0, wheel.radius_m as f32]);
    }

    /// Draws a translucent pulley with its outline.
    fn glass_wheel(&mut self, wheel: &Wheel, colour: Color32, opacity: f32) {
        if wheel.radius_m > 0.0 {
            let ink = paint(colour, opacity);
            self.glass.push(SolidPart::wheel(wheel, ink));
            let outline = SolidPart::disc(&wheel.centre, &wheel.normal, wheel.radius_m, ink);
            for side in outline.rim() {
                self.lines.push(side, colour, 1.2);
            }
        }
        let look = [9.0, 1.5, wheel.radius_m as f32];
        self.points.push(&wheel.centre, colour, look);
    }

    fn pulley(
        &mut self,
        cable: &CableView,
        placed: &PlacedCable,
        look: CableLook,
        scene: &Scene,
        options: &Options,
        palette: &Palette,
    ) {
        let tone = |colour: Color32| {
            if look.fades {
                faded(colour, palette)
            } else {
                colour
            }
        };
        if let Some(other) = placed.other.filter(|_| options.nominal) {
            match scene.reference {
                Reference::Other(_) if !look.fades => {
                    self.glass_wheel(&other, look.colour, INSPECTED);
                }
                _ => self.glass_wheel(&other, tone(palette.ghost), GHOST),
            }
        }
        let Some(moved) = &cable.moved else {
            return;
        };
        let exaggeration = options.exaggeration_of(scene);
        let tip = moved.from + moved.by * exaggeration;
        let colour = options.arrow_colour_of(scene);
        let ink = tone(arrow_colour(moved, colour, scene, palette));
        // The path of a pulley replaces the straight displacement between two dates.
        let has_path = look.is_selected && scene.paths.is_some();
        if options.arrows && !has_path {
            let most_m = match look.is_inspected {
                true => 0.3 * placed.wheel.radius_m.max(0.2 * ARROW * scene.frame.size_m),
                false => ARROW * scene.frame.size_m,
            };
            self.arrow(&moved.from, &tip, most_m, ink);
        }
        if options.ellipsoids
            && let Some(shape) = ellipsoid(moved, exaggeration)
        {
            let ink = if look.is_inspected { look.colour } else { ink };
            let colour = paint(ink, ELLIPSOID);
            self.glass.push(SolidPart::ellipsoid(&tip, &shape, colour));
        }
    }

    /// Draws an arrow with this largest length of its head.
    fn arrow(&mut self, from: &Vec3, tip: &Vec3, head_m: f64, colour: Color32) {
        let length = (tip - from).norm();
        let Some(direction) = (tip - from).try_normalize(1e-9) else {
            return;
        };
        let head = (0.4 * length).min(head_m);
        let shaft = [*from, tip - direction * (0.8 * head)];
        self.lines.push(shaft, colour, 2.2);
        self.solids
            .extend(SolidPart::cone(tip, &direction, head, paint(colour, 1.0)));
    }

    /// Draws the trail of the platform, older parts fainter.
    fn trail(&mut self, scene: &Scene, palette: &Palette) {
        let last = scene.trail.len().saturating_sub(1).max(1) as f32;
        let now = scene.pose.position;
        let to_now = scene.trail.last().map(|place| [*place, now]);
        let ways = scene.trail.windows(2).map(|pair| [pair[0], pair[1]]);
        for (number, way) in ways.chain(to_now).enumerate() {
            let age = 1.0 - number as f32 / last;
            let colour = palette.accent.lerp_to_gamma(palette.ground, 0.75 * age);
            self.lines.push(way, colour, 1.6);
        }
    }

    /// Draws arrows from the commanded to the measured positions.
    fn errors(&mut self, scene: &Scene, options: &Options, palette: &Palette) {
        let exaggeration = options.exaggeration_of(scene);
        for error in scene.errors.iter().filter(|_| options.errors) {
            let colour = error_colour(error.stage, palette);
            let tip = error.commanded + error.by * exaggeration;
            self.points.push(&error.commanded, colour, [5.0, 0.0, 0.0]);
            let most_m = ARROW * scene.frame.size_m;
            self.arrow(&error.commanded, &tip, most_m, colour);
        }
    }

    fn instruments(&mut self, scene: &Scene, palette: &Palette) {
        if let Some(laser) = &scene.laser {
            let size = scene.frame.size_m;
            let end = laser.spot.unwrap_or(laser.from + laser.direction * size);
            self.lines.push([laser.from, end], palette.laser, 1.6);
            if let Some(spot) = &laser.spot {
                let target = paint(palette.laser, 0.18);
                let target = SolidPart::disc(spot, &laser.normal, 0.022 * size, target);
                self.glass.push(target);
                for side in target.rim() {
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

/// Transformation from the unit sphere to the 95 % ellipsoid of a pulley, exaggerated by a factor.
#[must_use]
pub fn ellipsoid(moved: &Displacement, exaggeration: f64) -> Option<Matrix3<f64>> {
    region(&moved.covariance?, exaggeration)
}

/// Transformation from the unit sphere to the 95 % region of a covariance (m^2), exaggerated by a factor:
/// `d^T P^-1 d = q` with the 95 % point `q` of chi-square for as many coordinates as have a variance.
fn region(covariance: &Matrix3<f64>, exaggeration: f64) -> Option<Matrix3<f64>> {
    let known = covariance.diagonal().iter().filter(|v| **v > 0.0).count();
    let quantile: f64 = match known {
        1 => 3.841,
        2 => 5.991,
        _ => 7.815,
    };
    let eigen = SymmetricEigen::new(*covariance);
    let scale = exaggeration * quantile.sqrt();
    let axes = eigen.eigenvalues.map(|v| scale * v.max(0.0).sqrt());
    // A flat ellipsoid gets a thickness.
    let least = 0.02 * axes.max();
    (axes.max() > 0.0 && axes.iter().all(|a| a.is_finite()))
        .then(|| eigen.eigenvectors * Matrix3::from_diagonal(&axes.map(|a| a.max(least))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ellipsoid_has_the_semi_axes_of_the_covariance() {
        let moved = |diagonal| Displacement {
            from: Vec3::zeros(),
            by: Vec3::zeros(),
            covariance: Some(Matrix3::from_diagonal(&diagonal)),
            is_explained: true,
            moved: None,
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
}
