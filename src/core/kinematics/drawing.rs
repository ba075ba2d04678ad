//! Polylines of cables and pulleys for drawing them to scale.
//!
//! The pulley rotates about its centre `M = a + rp e`. The free part hangs below its chord in the
//! parabola whose extra length is the sag of [`crate::cable::CableLaw`]: at the fraction `x` of the chord from the
//! pulley to the platform, by `w l_f^2 / (2 T) x (1 - x)` times the component of gravity's direction normal to the chord.

use super::length_breakdown::{LengthBreakdownError, ModelledCable, down, modelled_cables};
use crate::geometry::{Pose, Vec3};
use crate::robot::Robot;

/// Resolution of the drawing of a cable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CableDetail {
    /// Length drawn on the winch side of the pulley (m).
    pub lead_in_m: f64,
    /// Largest angle between successive points on the pulley (rad).
    pub largest_turn_rad: f64,
    /// Number of segments of the free cable where it sags.
    pub span_parts: usize,
    /// Limit on the sag of a level cable relative to its length; an almost slack cable is not a parabola.
    pub largest_sag: f64,
}

impl Default for CableDetail {
    fn default() -> Self {
        Self {
            lead_in_m: 0.1,
            largest_turn_rad: 0.1,
            span_parts: 24,
            largest_sag: 0.3,
        }
    }
}

/// A cable from the winch side of its pulley to the platform; base frame.
#[derive(Debug, Clone, PartialEq)]
pub struct CableDrawing {
    /// Points of the cable (m), from the winch side to the anchor.
    pub points: Vec<Vec3>,
    /// Index of the point at which the cable leaves the pulley.
    pub exit: usize,
    /// Point at which the cable reaches the pulley (m).
    pub entry: Vec3,
    /// Centre of the pulley (m).
    pub pulley_centre: Vec3,
    /// Rotation axis of the pulley (unit vector).
    pub pulley_axis: Vec3,
    /// Swivel axis, in the direction of the cable's travel (unit vector).
    pub swivel_axis: Vec3,
    /// Radius of the pulley (m); 0: an eyelet.
    pub radius_m: f64,
}

/// Computes the polyline of every cable at `pose` under `tensions_n`, with the effects of the model, in the robot's order. A
/// cable of unknown tension is straight; a cable without a path, or with weight but no tension, is an error of its own.
///
/// # Errors
/// If an effect does not exist, or the number of tensions is not that of the cables.
pub fn cable_polyline(
    robot: &Robot,
    pose: &Pose,
    tensions_n: &[Option<f64>],
    detail: &CableDetail,
) -> Result<Vec<Result<CableDrawing, LengthBreakdownError>>, LengthBreakdownError> {
    let down = down(robot);
    let cables = modelled_cables(robot, pose, tensions_n)?.into_iter();
    Ok(cables
        .map(|cable| Ok(drawing(&cable?, down, detail)))
        .collect())
}

fn drawing(cable: &ModelledCable, down: Vec3, detail: &CableDetail) -> CableDrawing {
    let (pulley, path) = (cable.pulley(), cable.path());
    let [entry, axis] = [pulley.entry, pulley.axis].map(Vec3::from);
    let facing = Vec3::from(path.facing);
    let centre = entry + facing * pulley.radius;
    let mut points = vec![entry - axis * detail.lead_in_m];
    let turns = if pulley.radius > 0.0 {
        (path.wrap / detail.largest_turn_rad.max(1e-3)).ceil() as usize
    } else {
        0
    };
    for k in 0..=turns {
        let angle = path.wrap * k as f64 / turns.max(1) as f64;
        points.push(centre + (axis * angle.sin() - facing * angle.cos()) * pulley.radius);
    }
    let exit = points.len() - 1;
    let anchor = cable.located.anchor;
    let weight = cable.ports.weight.value;
    let from = points[exit];
    let chord = anchor - from;
    let along = -Vec3::from(path.toward_exit);
    let across = down - along * along.dot(&down);
    // Four times the sag at midspan.
    let sagging = |tension_n: f64| weight * path.free_length / (2.0 * tension_n);
    let sag = cable.tension_n.map_or(0.0, sagging);
    let most = 4.0 * detail.largest_sag;
    let depth = sag.clamp(-most, most) * path.free_length;
    let parts = if depth == 0.0 {
        1
    } else {
        detail.span_parts.max(2)
    };
    for k in 1..parts {
        let x = k as f64 / parts as f64;
        points.push(from + chord * x + across * (depth * x * (1.0 - x)));
    }
    points.push(anchor);
    CableDrawing {
        points,
        exit,
        entry,
        pulley_centre: centre,
        pulley_axis: path.lateral.into(),
        swivel_axis: axis,
        radius_m: pulley.radius,
    }
}
