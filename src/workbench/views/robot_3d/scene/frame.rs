//! Frame that carries the pulleys, and the floor below it.

use tautline_core::geometry::Vec3;
use tautline_core::robot::Robot;

use super::{bounds, corners};
use crate::views::robot_3d::camera::Directions;
use tautline_workflow::plot::round::round_down;

/// Floor with a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Floor {
    /// Corners (m).
    pub corners: [Vec3; 4],
    /// Grid lines (m).
    pub lines: Vec<[Vec3; 2]>,
    /// Spacing of the grid lines (m).
    pub spacing_m: f64,
}

/// Box of members around the pulleys, down to the floor.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameBox {
    /// Axes of the members (m).
    pub members: Vec<[Vec3; 2]>,
    /// Width of a member (m).
    pub member_m: f64,
    /// Corners of the box (m).
    pub corners: Vec<Vec3>,
    /// Diagonal of the box (m).
    pub size_m: f64,
    pub floor: Floor,
}

/// Width of a member, as a share of the diagonal.
const MEMBER: f64 = 0.006;

impl FrameBox {
    /// Frame of a robot with the pulleys of the drawing.
    #[must_use]
    pub fn of(robot: &Robot, directions: &Directions) -> Self {
        let local = directions.transpose();
        let cables = robot.cables.iter();
        let entries: Vec<Vec3> = cables
            .map(|cable| local * Vec3::from(cable.pulley.entry_point_m))
            .collect();
        let [mut low, mut high] = bounds(entries.iter());
        if !low.iter().chain(&high).all(|v| v.is_finite()) {
            [low, high] = [-0.5, 0.5].map(Vec3::repeat);
        }
        let extent = high - low;
        let member_m = (MEMBER * extent.norm()).max(1e-3);
        let radius = robot
            .cables
            .iter()
            .fold(0.0, |r: f64, c| r.max(c.pulley.radius_m));
        let clear = 2.2 * radius + member_m;
        for axis in 0..3 {
            if extent[axis] > 1e-3 * extent.norm() {
                low[axis] -= clear;
                high[axis] += clear;
            } else if axis == 1 {
                // The frame of a planar robot has no depth; it is behind the pulleys.
                low[axis] += clear;
                high[axis] += clear;
            }
        }
        low.z = low.z.min(floor_height(robot, directions).unwrap_or(low.z));
        let size_m = (high - low).norm().max(1e-3);
        let at = |p: Vec3| directions * p;
        let members = members(&low, &high).into_iter().map(|ends| ends.map(at));
        Self {
            members: members.collect(),
            member_m,
            corners: corners(&low, &high).map(at).to_vec(),
            size_m,
            floor: floor(&low, &high, directions),
        }
    }
}

/// Height of a target plane that lies on the floor.
fn floor_height(robot: &Robot, directions: &Directions) -> Option<f64> {
    let plane = robot.laser?.target_plane;
    let along = Vec3::from(plane.normal).dot(&directions.column(2));
    (along.abs() > 0.999).then(|| plane.offset_m / along)
}

/// Edges of the box, without those of zero length and duplicates.
fn members(low: &Vec3, high: &Vec3) -> Vec<[Vec3; 2]> {
    let corners = corners(low, high);
    let mut members: Vec<[Vec3; 2]> = Vec::new();
    for axis in 0..3 {
        for k in (0..8).filter(|k| k >> axis & 1 == 0) {
            let ends = [corners[k], corners[k | 1 << axis]];
            if (ends[1] - ends[0]).norm() > 1e-9 && !members.contains(&ends) {
                members.push(ends);
            }
        }
    }
    members
}

fn floor(low: &Vec3, high: &Vec3, directions: &Directions) -> Floor {
    let extent = high - low;
    let longest = extent.x.max(extent.y).max(0.2 * extent.z).max(1e-3);
    let spacing_m = round_down(longest / 14.0);
    // Some floor beyond the frame, also if the frame has no depth, in whole cells.
    let reach = |axis: usize| {
        let beyond = (0.14 * longest).max(0.5 * (0.4 * longest - extent[axis]));
        let from = ((low[axis] - beyond) / spacing_m).floor();
        let to = ((high[axis] + beyond) / spacing_m).ceil();
        (from as i64, to as i64)
    };
    let ((x0, x1), (y0, y1)) = (reach(0), reach(1));
    let at =
        |x: i64, y: i64| directions * Vec3::new(x as f64 * spacing_m, y as f64 * spacing_m, low.z);
    let along = (x0..=x1).map(|x| [at(x, y0), at(x, y1)]);
    let across = (y0..=y1).map(|y| [at(x0, y), at(x1, y)]);
    Floor {
        corners: [at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)],
        lines: along.chain(across).collect(),
        spacing_m,
    }
}
