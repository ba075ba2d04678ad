//! How much of the length of every cable is free span, wrap, elongation, sag.

use tautline_core::cable::CableLaw;
use tautline_core::geometry::{Pose, Vec3};
use tautline_core::kinematics::{KinematicsError, PulleyGeometry, check_path_at};
use tautline_core::robot::{Cable, Robot};

/// The length of one cable at a pose, part by part.
#[derive(Debug, Clone, PartialEq)]
pub struct CableShares {
    /// From drum to pulley (m).
    pub run_m: f64,
    /// Around the pulley (m).
    pub wrapped_m: f64,
    /// Straight line from the pulley to the platform (m).
    pub free_m: f64,
    /// Wrap angle (rad).
    pub wrap_rad: f64,
    /// What its tension makes of it, where that is known and its elongation was measured there; else
    /// one sentence.
    pub under_load: Result<UnderLoad, String>,
}

/// What a tension makes of a cable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnderLoad {
    /// Tension (N).
    pub tension_n: f64,
    /// Stretched by it (m).
    pub elastic_m: f64,
    /// Longer than the straight line because it sags (m).
    pub sag_m: f64,
}

/// The length of every cable at `pose`; `tensions_n` where they are known.
///
/// # Errors
/// The first cable that has no path at this pose.
pub fn cable_shares(
    robot: &Robot,
    pose: &Pose,
    tensions_n: Option<&[f64]>,
) -> Result<Vec<CableShares>, KinematicsError> {
    let down = robot.gravity().try_normalize(0.0).unwrap_or_default();
    let cables = robot.cables.iter().enumerate();
    cables
        .map(|(k, cable)| {
            let tension = tensions_n.and_then(|tensions| tensions.get(k).copied());
            shares(cable, pose, tension, down)
        })
        .collect()
}

fn shares(
    cable: &Cable,
    pose: &Pose,
    tension_n: Option<f64>,
    down: Vec3,
) -> Result<CableShares, KinematicsError> {
    check_path_at(cable, pose)?;
    let pulley = PulleyGeometry {
        entry: cable.pulley.entry_point_m,
        axis: cable.pulley.swivel_axis,
        radius: cable.pulley.radius_m,
    };
    let path = pulley.path_to(pose.transform(&cable.platform_anchor_m.into()).into());
    let run_m = cable.winch.length_to_pulley_m;
    let loaded = |tension_n: f64| {
        let material = &cable.cable;
        let surface = material.elongation_surface.as_ref();
        if let Some(surface) = surface {
            let inside = surface.evaluate(run_m + path.length, tension_n);
            inside.map_err(|outside| format!("Elongation is not known, {outside}"))?;
        }
        let law = CableLaw {
            run: run_m,
            tension: tension_n,
            compliance: material.axial_stiffness_n.map_or(0.0, f64::recip),
            strain: 0.0,
            weight: Some(material.weight_n_per_m).filter(|weight| *weight != 0.0),
            down: down.into(),
            surface,
        };
        let unstrained = law.unstrained(&path);
        Ok(UnderLoad {
            tension_n,
            elastic_m: run_m + path.length + unstrained.sag - unstrained.length,
            sag_m: unstrained.sag,
        })
    };
    Ok(CableShares {
        run_m,
        wrapped_m: pulley.radius * path.wrap,
        free_m: path.free_length,
        wrap_rad: path.wrap,
        under_load: match tension_n.filter(|tension| *tension > 0.0) {
            Some(tension) => loaded(tension),
            None => Err("Elongation and sag are not known, no tension was measured here".into()),
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use tautline_core::kinematics::inverse_kinematics;
    use tautline_core::robot::presets::find;

    #[test]
    fn parts_add_up_to_the_length() {
        let robot = find("mini").expect("the preset").robot;
        let pose = robot.home.expect("home").pose();
        let tensions = vec![50.0; robot.cable_count()];
        let shares = cable_shares(&robot, &pose, Some(&tensions)).expect("paths");
        let states = inverse_kinematics(&robot, &pose).expect("paths");
        for (share, state) in shares.iter().zip(states) {
            assert!((share.wrapped_m + share.free_m - state.length_m).abs() < 1e-12);
            let load = share.under_load.as_ref().expect("tension is given");
            let span = share.run_m + state.length_m;
            // L0 (1 + T/EA) = span, so that the stretched part is span (1 - 1/(1 + T/EA)).
            let stretched = span * (1.0 - 1.0 / (1.0 + 50.0 / 4e4));
            assert!((load.elastic_m - stretched).abs() < 1e-12);
        }
        let unknown = cable_shares(&robot, &pose, None).expect("paths");
        assert!(unknown[0].under_load.is_err());
    }
}
