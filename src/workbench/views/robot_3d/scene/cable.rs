//! Cables and pulleys: the path over the wheel, the sag.

use tautline_core::effect::BoundEffect;
use tautline_core::geometry::{Pose, Vec3};
use tautline_core::kinematics::{CablePath, PulleyGeometry, check_path_at};
use tautline_core::robot::{Cable, Robot};

use super::Wheel;

/// Pieces of an arc or of a sagging span.
const PIECES: usize = 24;

/// Where a cable runs at a pose.
pub struct Path {
    /// Points from the winch's side to the platform (m).
    pub points: Vec<Vec3>,
    /// Straight part (m).
    pub free_m: f64,
}

fn located(cable: &Cable, pose: &Pose) -> (PulleyGeometry<f64>, CablePath<f64>, Vec3) {
    let pulley = PulleyGeometry {
        entry: cable.pulley.entry_point_m,
        axis: cable.pulley.swivel_axis,
        radius: cable.pulley.radius_m,
    };
    let anchor = pose.transform(&Vec3::from(cable.platform_anchor_m));
    (pulley, pulley.path_to(anchor.into()), anchor)
}

/// The pulley of `cable`, facing the platform at `pose`.
pub fn wheel(cable: &Cable, pose: &Pose) -> Wheel {
    let (pulley, path, _) = located(cable, pose);
    let entry = Vec3::from(pulley.entry);
    let facing = Vec3::from(path.facing);
    Wheel {
        entry,
        centre: entry + facing * pulley.radius,
        normal: path.lateral.into(),
        radius_m: pulley.radius,
    }
}

/// The path of `cable` at `pose`; `drop_m` is the sag in the middle of the free part, downwards. `None` where
/// the cable has none.
pub fn path(cable: &Cable, pose: &Pose, drop_m: Vec3) -> Option<Path> {
    check_path_at(cable, pose).ok()?;
    let (pulley, path, anchor) = located(cable, pose);
    let axis = Vec3::from(pulley.axis);
    let facing = Vec3::from(path.facing);
    let entry = Vec3::from(pulley.entry);
    // A short piece of the run from the winch tells from where the cable comes.
    let mut points = vec![entry - axis * (2.0 * pulley.radius)];
    if pulley.radius > 0.0 {
        let centre = entry + facing * pulley.radius;
        points.extend((0..PIECES).map(|k| {
            let (sin, cos) = (path.wrap * k as f64 / PIECES as f64).sin_cos();
            centre + (axis * sin - facing * cos) * pulley.radius
        }));
    }
    let exit = Vec3::from(pulley.exit_point(&path));
    points.push(exit);
    if drop_m.norm() > 0.0 {
        points.extend((1..PIECES).map(|k| {
            let s = k as f64 / PIECES as f64;
            exit.lerp(&anchor, s) + drop_m * (4.0 * s * (1.0 - s))
        }));
    }
    points.push(anchor);
    Some(Path {
        points,
        free_m: path.free_length,
    })
}

/// Sag of every cable in the middle of its free part (m): `w l_f^2 / (8 T)` downwards, the parabola whose extra length
/// is that of the model; none where weight or tension is not known.
pub fn drops(robot: &Robot, pose: &Pose, tensions_n: &[Option<f64>]) -> Vec<Vec3> {
    let gravity = robot.gravity();
    let down = gravity.try_normalize(0.0).unwrap_or_default();
    let weights = weights(robot);
    let cables = robot.cables.iter().zip(weights).enumerate();
    cables
        .map(|(index, (cable, weight))| {
            let tension = tensions_n.get(index).copied().flatten();
            let Some(tension) = tension.filter(|t| *t > 0.0 && weight > 0.0) else {
                return Vec3::zeros();
            };
            let (_, path, _) = located(cable, pose);
            let sag = weight * path.free_length * path.free_length / (8.0 * tension);
            // A slack cable is no parabola any more; it is drawn hanging, not falling.
            down * sag.min(0.3 * path.free_length)
        })
        .collect()
}

/// Weight per metre of every cable (N/m), with what was found to differ.
fn weights(robot: &Robot) -> Vec<f64> {
    let stated = robot.cables.iter().map(|c| c.cable.weight_n_per_m);
    let mut weights: Vec<f64> = stated.collect();
    for setting in robot.effects.iter().filter(|e| e.effect == "cable_sag") {
        let Ok(bound) = BoundEffect::from_setting(setting, robot) else {
            continue;
        };
        for cable in &bound.cables {
            if let (Some(weight), Some(found)) = (weights.get_mut(*cable), bound.values.first()) {
                *weight += found;
            }
        }
    }
    weights
}
