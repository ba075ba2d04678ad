//! Tooltips of the 3D view.

use super::picking::Pickable;
use super::scene::{Reference, Residual, Scene, ShownPose, SideNames};
use tautline_core::geometry::Vec3;
use tautline_workflow::wording::units::{mm, signed};

/// Tooltip of an object.
#[must_use]
pub fn describe(scene: &Scene, thing: Pickable) -> String {
    match thing {
        Pickable::Cable(index) => cable(scene, index),
        Pickable::Pulley(index) => pulley(scene, index),
        Pickable::Platform => platform(scene),
        Pickable::Pose(label) => pose(scene, label),
        Pickable::LaserSpot => laser(scene),
    }
}

/// Name of the shown pose.
#[must_use]
pub fn shown(scene: &Scene) -> String {
    let shown = pose_shown(scene);
    match scene.reference {
        Reference::Other(SideNames { first, second }) => {
            format!("{shown}: {first} solid, {second} transparent")
        }
        Reference::Drawing | Reference::Nothing => shown,
    }
}

fn pose_shown(scene: &Scene) -> String {
    match scene.shown {
        ShownPose::Home => "Home pose".to_owned(),
        ShownPose::Fitted(0) => "Home pose, identified".to_owned(),
        ShownPose::Fitted(label) => format!("Pose {label}, identified"),
        ShownPose::Given(label) => format!("Pose {label}, commanded"),
        ShownPose::Live => "Current pose".to_owned(),
        ShownPose::Stopped => "Stopped here".to_owned(),
    }
}

fn cable(scene: &Scene, index: usize) -> String {
    let Some(cable) = scene.cables.get(index) else {
        return String::new();
    };
    let mut parts = match cable.free_m {
        Some(free_m) => vec![format!("free length {free_m:.4} m")],
        None => vec!["no path to the platform at this pose".to_owned()],
    };
    parts.extend(cable.tension_n.map(|tension| format!("{tension:.1} N")));
    parts.extend(cable.residual.map(residual));
    format!("Cable {}: {}", cable.label, parts.join(", "))
}

fn residual(residual: Residual) -> String {
    match residual {
        Residual::One(value) => format!("residual {} standard deviations", signed(value, 1)),
        Residual::Rms(value, count) => {
            format!("residual {value:.1} standard deviations (root mean square of {count})")
        }
    }
}

fn pulley(scene: &Scene, index: usize) -> String {
    let Some(cable) = scene.cables.get(index) else {
        return String::new();
    };
    let entry = place(&cable.wheel.entry);
    let radius = cable.wheel.radius_m * 1e3;
    let mut text = format!(
        "Pulley {}: radius {radius:.1} mm, entry point {entry}",
        cable.label
    );
    if let Some(moved) = &cable.moved {
        let length = moved.by.norm() * 1e3;
        text += &match scene.reference {
            Reference::Other(names) => format!("\n{length:.2} mm away in {}", names.second),
            Reference::Drawing | Reference::Nothing => {
                format!("\n{length:.2} mm from nominal")
            }
        };
        if let Some(covariance) = moved.covariance {
            let sd = covariance.diagonal().map(|v| v.max(0.0).sqrt() * 1e3);
            text += &format!(
                ", standard deviations ({:.2}, {:.2}, {:.2}) mm",
                sd.x, sd.y, sd.z
            );
        }
    }
    text
}

/// Coordinates of a position, in millimetres.
fn place(at: &Vec3) -> String {
    let [x, y, z] = <[f64; 3]>::from(*at).map(|metres| mm(metres, 1));
    format!("({x}, {y}, {z}) mm")
}

fn platform(scene: &Scene) -> String {
    let at = place(&scene.pose.position);
    let turned = scene.pose.orientation.angle().to_degrees();
    format!("Platform at {at}, rotated by {turned:.2}°")
}

fn pose(scene: &Scene, label: i64) -> String {
    let Some(pose) = scene.measured.iter().find(|pose| pose.label == label) else {
        return String::new();
    };
    let at = place(&pose.position);
    let name = if label == 0 {
        "Home pose".to_owned()
    } else {
        format!("Pose {label}")
    };
    let text = format!("{name}: {at}");
    match pose.residual {
        Some(value) => format!("{text}, residual {} standard deviations", signed(value, 1)),
        None => text,
    }
}

fn laser(scene: &Scene) -> String {
    let spot = scene.laser.and_then(|laser| Some((laser.spot?, laser)));
    spot.map_or_else(String::new, |(spot, laser)| {
        format!("Laser: {:.4} m to its target", (spot - laser.from).norm())
    })
}

#[cfg(test)]
mod tests {
    use tautline_core::measurement::{Grid, Measurements};
    use tautline_core::robot::presets;

    use super::*;
    use crate::views::robot_3d::scene::SceneInputs;

    #[test]
    fn a_cable_says_what_and_how_much() {
        let robot = presets::find("mini").unwrap().robot;
        let mut force_n = Grid::new(8);
        force_n.push_row(&[82.6; 8]);
        let data = Measurements {
            labels: vec![0],
            force_n,
            ..Measurements::default()
        };
        let mut scene = SceneInputs::new(&robot, &data).scene();
        scene.cables[2].residual = Some(Residual::One(2.06));
        scene.cables[2].free_m = Some(1.20337);
        assert_eq!(
            describe(&scene, Pickable::Cable(2)),
            "Cable 3: free length 1.2034 m, 41.3 N, residual +2.1 standard deviations"
        );
        assert_eq!(describe(&scene, Pickable::Cable(99)), "");
        assert_eq!(
            describe(&scene, Pickable::LaserSpot),
            "Laser: 0.4450 m to its target"
        );
    }
}
