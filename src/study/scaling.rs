//! Scaling of robots.
//!
//! Geometry grows with the factor `s`: frame, platform, pulleys, drums, workspace, home pose. Cables get `s` times as
//! thick, so that stiffness `EA`, weight per metre and permitted tension grow as `s^2`, and with them the payload: stress
//! and strain stay, and the sag `w^2 h^2 l / 24 T^2` grows as `s^3`. Tolerances of drawings, of how cable lies on drums and
//! of the target plane grow as `sqrt(s)`, the uncertainty of the home pose as `s` in position and not at all in
//! orientation; force sensors keep their part of the full scale.

use tautline_core::geometry::Vec3;
use tautline_core::robot::{PerAxis, Robot};

/// Largest side of the box around the entry points (m).
#[must_use]
pub fn size_m(robot: &Robot) -> f64 {
    let points = || {
        robot
            .cables
            .iter()
            .map(|cable| Vec3::from(cable.pulley.entry_point_m))
    };
    let infinite = Vec3::repeat(f64::INFINITY);
    let low = points().fold(infinite, |low, point| low.inf(&point));
    let high = points().fold(-infinite, |high, point| high.sup(&point));
    (high - low).max()
}

/// The robot, its frame `s` times as large.
#[must_use]
pub fn scaled(robot: &Robot, s: f64) -> Robot {
    let mut scaled = robot.clone();
    let (rough, area) = (s.sqrt(), s * s);
    let grow = |vector: &mut [f64; 3]| vector.iter_mut().for_each(|value| *value *= s);
    for cable in &mut scaled.cables {
        grow(&mut cable.pulley.entry_point_m);
        let grown = |sd: Option<f64>| sd.map(|sd| sd * rough);
        cable.pulley.entry_point_sd_m = match cable.pulley.entry_point_sd_m {
            PerAxis::Same(sd) => PerAxis::Same(grown(sd)),
            PerAxis::Each(sds) => PerAxis::Each(sds.map(grown)),
        };
        cable.pulley.radius_m *= s;
        grow(&mut cable.platform_anchor_m);
        cable.winch.drum_diameter_m *= s;
        cable.winch.drum_pitch_m *= s;
        cable.winch.length_to_pulley_m *= s;
        cable.winch.length_sd_m *= rough;
        cable.cable.axial_stiffness_n = cable
            .cable
            .axial_stiffness_n
            .map(|stiffness| stiffness * area);
        cable.cable.weight_n_per_m *= area;
        // A measured elongation curve applies to one cable only.
        cable.cable.elongation_surface = None;
        if let Some(sensor) = &mut cable.force_sensor {
            sensor.tension_sd_n *= area;
            sensor.bias_n *= area;
        }
    }
    scaled.platform.mass_kg = scaled.platform.mass_kg.map(|mass| mass * area);
    grow(&mut scaled.platform.center_of_mass_m);
    scaled.platform.wrench_sd = None;
    scaled.home_platform = None;
    if let Some(home) = &mut scaled.home {
        grow(&mut home.position_m);
        home.position_sd_m *= s;
        home.covariance = None;
    }
    if let Some(laser) = &mut scaled.laser {
        grow(&mut laser.origin_m);
        laser.target_plane.offset_m *= s;
        laser.target_plane.offset_sd_m = laser.target_plane.offset_sd_m.map(|sd| sd * rough);
    }
    if let Some(limits) = &mut scaled.limits {
        if let Some(workspace) = &mut limits.workspace {
            grow(&mut workspace.center.position_m);
            grow(&mut workspace.half_extent_m);
        }
        if let Some(tension) = &mut limits.tension {
            for force in [
                &mut tension.lower_n,
                &mut tension.reference_n,
                &mut tension.upper_n,
            ] {
                *force *= area;
            }
        }
    }
    scaled
}

#[cfg(test)]
mod tests {
    use tautline_core::planning::{PlanOptions, random_poses};
    use tautline_core::robot::presets;

    use super::*;

    #[test]
    fn robots_of_every_size_are_possible_and_can_be_held() {
        for name in presets::NAMES {
            let robot = presets::find(name).expect("there").robot;
            assert_eq!(scaled(&robot, 1.0).cables, robot.cables, "{name}");
            for size in [1.0, 10.0, 100.0] {
                let larger = scaled(&robot, size / size_m(&robot));
                assert!((size_m(&larger) - size).abs() < 1e-9);
                larger.check().expect("possible");
                let options = PlanOptions {
                    laser_range_m: [0.0, 1e3],
                    ..PlanOptions::new(5, 1)
                };
                random_poses(&larger, &options).expect("held");
            }
        }
    }
}
