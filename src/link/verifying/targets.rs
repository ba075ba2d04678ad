//! Targets of a verification: the poses of ISO 9283 in three cubes, a circle and a line.

use tautline_core::geometry::{Pose, Vec3};
use tautline_core::robot::Robot;
use tautline_core::simulation::Workspace;
use tautline_session::CheckKind;

/// Edge of the full cube relative to the shortest extent of the workspace: 312 mm of 400 mm on the MINI robot (Jin et al.
/// 2018, section 6).
const CUBE: f64 = 0.78;
/// Edges of the cubes relative to the full cube.
const PARTS: [(f64, &str); 3] = [(1.0, "100 %"), (0.8, "80 %"), (0.5, "50 %")];
/// Distance of poses from the centre, relative to half the diagonal (ISO 9283: a tenth of the diagonal from its ends).
const ON_DIAGONAL: f64 = 0.8;
/// The five poses in a diagonal plane of the cube, with the last one first as in the standard.
const CORNERS: [(&str, [f64; 3]); 5] = [
    ("P5", [1.0, -1.0, -1.0]),
    ("P4", [-1.0, -1.0, -1.0]),
    ("P3", [-1.0, 1.0, 1.0]),
    ("P2", [1.0, 1.0, 1.0]),
    ("P1", [0.0, 0.0, 0.0]),
];

/// One commanded pose, or one point of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckTarget {
    /// Pose or path.
    pub kind: CheckKind,
    /// Name of the pose or path.
    pub target: String,
    /// Number of the point along the path; 0 for a pose.
    pub sample: i64,
    /// Commanded pose.
    pub pose: Pose,
}

/// Edges of the cubes of 100, 80 and 50 % (m): 312, 249.6 and 156 mm on the MINI robot.
#[must_use]
pub fn cube_edges_m(robot: &Robot, workspace: &Workspace) -> [f64; 3] {
    let extents = free_axes(robot).map(|k| 2.0 * workspace.half_extent_m[k]);
    let shortest = extents.fold(f64::INFINITY, f64::min);
    let edge = if shortest.is_finite() {
        CUBE * shortest
    } else {
        0.0
    };
    PARTS.map(|(part, _)| part * edge)
}

/// Axes along which the platform moves.
fn free_axes(robot: &Robot) -> impl Iterator<Item = usize> {
    let freedom = robot.platform.freedom();
    (0..3).filter(move |k| freedom.coordinates().iter().any(|c| c.index() == *k))
}

/// The centre of the workspace shifted along the free axes.
fn shifted(robot: &Robot, workspace: &Workspace, offset: [f64; 3]) -> Pose {
    let mut shift = Vec3::zeros();
    for axis in free_axes(robot) {
        shift[axis] = offset[axis];
    }
    Pose {
        position: workspace.centre.position + shift,
        ..workspace.centre
    }
}

/// The five poses of ISO 9283 in each cube around the centre of the workspace, with its orientation.
#[must_use]
pub fn cube_poses(robot: &Robot, workspace: &Workspace) -> Vec<CheckTarget> {
    let edges = cube_edges_m(robot, workspace);
    let cubes = PARTS.iter().zip(edges);
    cubes
        .flat_map(|((_, part), edge)| {
            CORNERS.iter().map(move |(name, corner)| {
                let offset = corner.map(|side| 0.5 * ON_DIAGONAL * edge * side);
                CheckTarget {
                    kind: CheckKind::Pose,
                    target: format!("{name} of {part}"),
                    sample: 0,
                    pose: shifted(robot, workspace, offset),
                }
            })
        })
        .collect()
}

/// A circle in the plane of the first two free axes, as wide as the cube of 50 %, at equally spaced points.
#[must_use]
pub fn circle(robot: &Robot, workspace: &Workspace, points: usize) -> Vec<CheckTarget> {
    let [_, _, edge] = cube_edges_m(robot, workspace);
    let axes: Vec<usize> = free_axes(robot).take(2).collect();
    let [first, second] = *axes else {
        return Vec::new();
    };
    let at = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / points as f64;
        let mut offset = [0.0; 3];
        offset[first] = 0.5 * edge * angle.cos();
        offset[second] = 0.5 * edge * angle.sin();
        offset
    };
    path("Circle", robot, workspace, (0..points).map(at))
}

/// A line along the first free axis, as long as the cube of 50 %, at equally spaced points.
#[must_use]
pub fn line(robot: &Robot, workspace: &Workspace, points: usize) -> Vec<CheckTarget> {
    let [_, _, edge] = cube_edges_m(robot, workspace);
    let Some(axis) = free_axes(robot).next() else {
        return Vec::new();
    };
    let at = |k: usize| {
        let mut offset = [0.0; 3];
        offset[axis] = edge * (k as f64 / (points.max(2) - 1) as f64 - 0.5);
        offset
    };
    path("Line", robot, workspace, (0..points).map(at))
}

fn path(
    name: &str,
    robot: &Robot,
    workspace: &Workspace,
    offsets: impl Iterator<Item = [f64; 3]>,
) -> Vec<CheckTarget> {
    let points = offsets.zip(1..);
    points
        .map(|(offset, sample)| CheckTarget {
            kind: CheckKind::Path,
            target: name.to_owned(),
            sample,
            pose: shifted(robot, workspace, offset),
        })
        .collect()
}
