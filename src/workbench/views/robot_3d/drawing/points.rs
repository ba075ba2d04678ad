//! Lines, discs and rings of constant screen size; points of the poses.

use egui::{Color32, Theme};
use tautline_core::geometry::Vec3;

use crate::model::Selection;
use crate::theme;
use crate::views::robot_3d::scene::{MeasuredPose, Scene};

/// Largest number of poses drawn while the camera moves.
const COARSE: usize = 3000;

/// Vector for the graphics card.
fn single(v: &Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// Opaque colour for the graphics card.
fn rgba(colour: Color32) -> [f32; 4] {
    let [r, g, b, _] = colour.to_array().map(|c| f32::from(c) / 255.0);
    [r, g, b, 1.0]
}

/// Lines of constant width.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Lines {
    /// Start points (m).
    pub from: Vec<[f32; 3]>,
    /// End points (m).
    pub to: Vec<[f32; 3]>,
    pub colours: Vec<[f32; 4]>,
    /// Width (points of the screen).
    pub widths: Vec<f32>,
}

impl Lines {
    pub(super) fn push(&mut self, [from, to]: [Vec3; 2], colour: Color32, width: f32) {
        self.from.push(single(&from));
        self.to.push(single(&to));
        self.colours.push(rgba(colour));
        self.widths.push(width);
    }
}

/// Discs and rings of constant screen size.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Points {
    /// Centre (m).
    pub centres: Vec<[f32; 3]>,
    pub colours: Vec<[f32; 4]>,
    /// Diameter and width of the ring, 0 for a disc (points of the screen); radius (m) of the object that replaces the
    /// point once it appears larger, 0 for none.
    pub looks: Vec<[f32; 3]>,
    /// Number of points, from the first, that are drawn while the camera moves, if these are poses.
    pub coarse: usize,
}

impl Points {
    /// Points of the poses of a scene; those drawn while the camera moves come first.
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

    pub(super) fn push(&mut self, centre: &Vec3, colour: Color32, look: [f32; 3]) {
        self.centres.push(single(centre));
        self.colours.push(rgba(colour));
        self.looks.push(look);
    }
}

/// Diameter of the point of a measured pose, for a number of poses (points of the screen).
#[must_use]
pub fn pose_size(count: usize) -> f32 {
    match count {
        0..=300 => 8.0,
        301..=3000 => 6.0,
        _ => 4.0,
    }
}

/// Selects the poses drawn while the camera moves: all if they are few, otherwise those with the largest residuals and
/// every n-th of the others.
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::views::robot_3d::drawing::{Drawing, Options};
    use crate::views::robot_3d::scene::{MeasuredPoses, SceneInputs};

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
        let mut scene = SceneInputs::new(&robot, &nothing).scene();
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
