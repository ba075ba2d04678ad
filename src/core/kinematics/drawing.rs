//! Points of a cable and its pulley, to draw them at scale.
//!
//! The pulley turns about its centre `M = a + rp e`, across its plane. The free part hangs below its chord by the
//! parabola that belongs to the extra length by sag of [`crate::cable::CableLaw`]: at the part `x` of the chord from the
//! pulley to the platform, `w l_f^2 / (2 T) x (1 - x)` times gravity's direction across the chord.

use super::length_breakdown::{LengthBreakdownError, ModelledCable, down, modelled_cables};
use crate::geometry::{Pose, Vec3};
use crate::robot::Robot;

/// How finely a cable is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CableDetail {
    /// Length drawn on the winch's side of the pulley (m).
    pub lead_in_m: f64,
    /// Largest angle between neighbouring points on the pulley (rad).
    pub largest_turn_rad: f64,
    /// Parts of the free cable where it sags.
    pub span_parts: usize,
    /// Limit on the depth in the middle of a level cable, over its length: an almost slack cable is no parabola.
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

/// A cable from the winch's side of its pulley to the platform; base frame.
#[derive(Debug, Clone, PartialEq)]
pub struct CableDrawing {
    /// Points of the cable (m), from the winch's side to the anchor.
    pub points: Vec<Vec3>,
    /// Index of the point at which it leaves the pulley.
    pub exit: usize,
    /// Where it reaches the pulley (m).
    pub entry: Vec3,
    /// Centre of the pulley (m).
    pub pulley_centre: Vec3,
    /// Axis about which the pulley turns (unit vector).
    pub pulley_axis: Vec3,
    /// Axis about which it swivels, in the direction of the cable (unit vector).
    pub swivel_axis: Vec3,
    /// Radius of the pulley (m); 0: an eyelet.
    pub radius_m: f64,
}

/// Draws every cable at `pose` under `tensions_n`, as the model with its effects has them, in the robot's order. A cable
/// whose tension is not known is straight; an error stands for each that has no path, or weight but no tension.
///
/// # Errors
/// An effect that does not exist, or tensions that are not one for each cable.
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
    // Four times the depth in the middle.
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
