//! Cables and pulleys: path over the wheel, sag.

use tautline_core::geometry::{Pose, Vec3};
use tautline_core::kinematics::{CableDetail, CableDrawing, cable_polyline};
use tautline_core::robot::{Cable, Robot};

use super::Wheel;

/// Path of a cable over its pulley at a pose.
pub struct CablePath {
    pub wheel: Wheel,
    /// Points from the winch's side to the platform (m).
    pub path: Vec<Vec3>,
    /// Straight length (m); `None` if there is no path over the pulley: then it is a line from entry point to platform.
    pub free_m: Option<f64>,
}

/// All cables of `robot` at `pose`; cables with a known tension (N) sag.
pub fn located(robot: &Robot, pose: &Pose, tensions_n: &[Option<f64>]) -> Vec<CablePath> {
    let radii = robot.cables.iter().map(|cable| cable.pulley.radius_m);
    let detail = CableDetail {
        // A short piece towards the winch shows where the cable comes from.
        lead_in_m: 2.0 * radii.fold(0.0, f64::max),
        ..CableDetail::default()
    };
    // A cable without tension is drawn straight.
    let taut: Vec<_> = tensions_n.iter().map(|t| t.filter(|t| *t > 0.0)).collect();
    let drawings = cable_polyline(robot, pose, &taut, &detail);
    let mut drawings = drawings.unwrap_or_default().into_iter();
    let cables = robot.cables.iter();
    cables
        .map(|cable| match drawings.next() {
            Some(Ok(drawing)) => drawn(drawing),
            _ => line(cable, pose),
        })
        .collect()
}

fn drawn(drawing: CableDrawing) -> CablePath {
    let ends = [drawing.points.get(drawing.exit), drawing.points.last()];
    let free_m = match ends {
        [Some(exit), Some(anchor)] => Some((anchor - exit).norm()),
        _ => None,
    };
    CablePath {
        wheel: Wheel {
            entry: drawing.entry,
            centre: drawing.pulley_centre,
            normal: drawing.pulley_axis,
            radius_m: drawing.radius_m,
        },
        path: drawing.points,
        free_m,
    }
}

fn line(cable: &Cable, pose: &Pose) -> CablePath {
    let entry = Vec3::from(cable.pulley.entry_point_m);
    let anchor = pose.transform(&cable.platform_anchor_m.into());
    let axis = Vec3::from(cable.pulley.swivel_axis);
    let across = axis.cross(&(anchor - entry)).try_normalize(1e-9);
    CablePath {
        wheel: Wheel {
            entry,
            centre: entry,
            normal: across.unwrap_or_else(|| axis.cross(&Vec3::ith(axis.iamin(), 1.0)).normalize()),
            radius_m: cable.pulley.radius_m,
        },
        path: vec![entry, anchor],
        free_m: None,
    }
}
