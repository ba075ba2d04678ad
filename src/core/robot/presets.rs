//! Ready-made robots for simulation, demonstrations and validation.
//!
//! `mini` is the robot of Jin et al. 2018: entry points from Table 1 (cable 7 with its signs repaired by
//! symmetry). The paper does not give platform anchors, pulley radius, drum, stiffness, mass or laser
//! mount; those values are assumed, see [`Preset::assumed`].

use super::{
    Cable, CableMaterial, ForceSensor, FrameTransform, Home, Laser, Limits, PerAxis, Platform,
    Pulley, Robot, TargetPlane, TensionLimits, Winch, WorkspaceLimits,
};
use crate::geometry::{Coordinate, Pose};
use crate::simulation::{TensionRange, Workspace};

/// A robot with its workspace and tension limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Preset {
    /// Name in commands.
    pub name: &'static str,
    /// Summary in one line.
    pub summary: &'static str,
    /// The values that are assumed rather than published.
    pub assumed: &'static str,
    /// The nominal robot.
    pub robot: Robot,
    /// Entry points measured by an instrument more accurate than the drawing (m), if any.
    pub measured_entry_points_m: Option<Vec<[f64; 3]>>,
    /// Workspace of the platform.
    pub workspace: Workspace,
    /// Tension limits of the cables.
    pub tension: TensionRange,
}

/// Names of the presets.
pub const NAMES: [&str; 4] = ["mini", "hall", "suspended", "planar"];

/// The preset called `name`.
#[must_use]
pub fn find(name: &str) -> Option<Preset> {
    let preset = match name {
        "mini" => mini(),
        "hall" => hall(),
        "suspended" => suspended(),
        "planar" => planar(),
        _ => return None,
    };
    Some(preset.with_stated_limits())
}

impl Preset {
    /// Writes the limits into the description of the robot, where files keep them.
    fn with_stated_limits(mut self) -> Self {
        let (workspace, tension) = (&self.workspace, self.tension);
        self.robot.limits = Some(Limits {
            workspace: Some(WorkspaceLimits {
                center: FrameTransform {
                    position_m: workspace.centre.position.into(),
                    orientation_wxyz: workspace.centre.orientation_wxyz(),
                },
                half_extent_m: workspace.half_extent_m,
                half_rotation_rad: workspace.half_rotation_rad,
            }),
            tension: Some(TensionLimits {
                lower_n: tension.lower_n,
                reference_n: tension.reference_n,
                upper_n: tension.upper_n,
            }),
        });
        self
    }
}

/// Table 1, first column (mm): drawing.
const MINI_DRAWING_MM: [[f64; 3]; 8] = [
    [500.0, -378.0, -441.5],
    [-500.0, -378.0, -441.5],
    [-500.0, 378.0, -441.5],
    [500.0, 378.0, -441.5],
    [531.5, -345.0, 441.5],
    [-531.5, -345.0, 441.5],
    [-531.5, 345.0, 441.5],
    [531.5, 345.0, 441.5],
];

/// Table 1, second column (mm): measured with a coordinate measuring arm.
const MINI_MEASURED_MM: [[f64; 3]; 8] = [
    [506.40, -373.00, -453.20],
    [-488.87, -374.26, -453.20],
    [-491.89, 381.46, -453.20],
    [503.63, 382.76, -453.20],
    [539.36, -339.62, 430.26],
    [-520.95, -341.69, 430.64],
    [-524.15, 347.90, 429.68],
    [536.57, 348.86, 430.48],
];

/// Properties that the cables of a preset have in common.
struct CableKind {
    radius_m: f64,
    entry_point_sd_m: PerAxis<Option<f64>>,
    winch: Winch,
    material: CableMaterial,
    tension_sd_n: f64,
}

impl CableKind {
    fn cable(&self, index: usize, entry: [f64; 3], axis: [f64; 3], anchor: [f64; 3]) -> Cable {
        Cable {
            name: format!("cable-{}", index + 1),
            pulley: Pulley {
                entry_point_m: entry,
                entry_point_sd_m: self.entry_point_sd_m,
                swivel_axis: axis,
                swivel_zero: None,
                swivel_sd_rad: None,
                radius_m: self.radius_m,
            },
            platform_anchor_m: anchor,
            winch: self.winch,
            cable: self.material.clone(),
            force_sensor: Some(ForceSensor {
                tension_gain: 2.0,
                bias_n: 0.0,
                tension_sd_n: self.tension_sd_n,
            }),
        }
    }
}

fn downward_laser(origin_z_m: f64, sd_m: f64, offset_m: f64, offset_sd_m: f64) -> Laser {
    Laser {
        origin_m: [0.0, 0.0, origin_z_m],
        direction: [0.0, 0.0, -1.0],
        sd_m,
        target_plane: TargetPlane {
            normal: [0.0, 0.0, 1.0],
            offset_m,
            offset_sd_m: Some(offset_sd_m),
        },
    }
}

fn robot(name: &str, home: Home, platform: Platform, laser: Laser, cables: Vec<Cable>) -> Robot {
    Robot {
        name: name.to_owned(),
        home: Some(home),
        gravity_m_s2: [0.0, 0.0, -9.80665],
        platform,
        limits: None,
        laser: Some(laser),
        inclinometer: None,
        tracker: None,
        cables,
        home_platform: None,
        tolerances: None,
        hypotheses: Vec::new(),
        deviations: Vec::new(),
        effects: Vec::new(),
    }
}

fn home(position_m: [f64; 3], position_sd_m: f64, orientation_sd_rad: f64) -> Home {
    Home {
        position_m,
        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
        position_sd_m,
        orientation_sd_rad,
        covariance: None,
    }
}

fn around(position_m: [f64; 3], half_extent_m: [f64; 3], half_rotation_rad: f64) -> Workspace {
    Workspace {
        centre: Pose::from_parts(position_m, [1.0, 0.0, 0.0, 0.0]),
        half_extent_m,
        half_rotation_rad,
    }
}

/// The MINI robot of the paper.
fn mini() -> Preset {
    let kind = CableKind {
        radius_m: 0.018,
        entry_point_sd_m: PerAxis::known(8e-3),
        winch: Winch {
            drum_diameter_m: 0.04,
            drum_pitch_m: 0.002,
            gear_ratio: 1.0,
            length_to_pulley_m: 0.6,
            length_sd_m: 5e-5,
        },
        material: CableMaterial {
            axial_stiffness_n: Some(4e4),
            ..CableMaterial::default()
        },
        tension_sd_n: 1.0,
    };
    let metres = |points: [[f64; 3]; 8]| points.map(|p| p.map(|v| v / 1000.0));
    let cables = metres(MINI_DRAWING_MM)
        .into_iter()
        .enumerate()
        .map(|(index, entry)| {
            let vertical = entry[2].signum();
            // The upper cables cross: with all anchors on the lines to their pulleys, nothing would constrain the
            // rotation about z.
            let anchor = [
                -0.06 * entry[0].signum() * vertical,
                0.045 * entry[1].signum(),
                -0.05 * vertical,
            ];
            kind.cable(index, entry, [0.0, 0.0, vertical], anchor)
        })
        .collect();
    Preset {
        name: "mini",
        summary: "eight cables, 1 m frame (Jin et al. 2018, Table 1)",
        assumed: "platform anchors, pulley radius, drum, cable stiffness, mass, laser mount and all noise",
        robot: robot(
            "mini",
            home([0.0; 3], 1e-4, 5e-4),
            Platform::spatial(Some(2.5)),
            downward_laser(-0.055, 3e-4, -0.5, 5e-3),
            cables,
        ),
        measured_entry_points_m: Some(metres(MINI_MEASURED_MM).to_vec()),
        workspace: around([0.0; 3], [0.2; 3], 0.3),
        tension: TensionRange {
            lower_n: 10.0,
            reference_n: 40.0,
            upper_n: 150.0,
        },
    }
}

/// A hall-size constrained robot.
fn hall() -> Preset {
    let kind = CableKind {
        radius_m: 0.06,
        entry_point_sd_m: PerAxis::known(0.015),
        winch: Winch {
            drum_diameter_m: 0.2,
            drum_pitch_m: 0.008,
            gear_ratio: 12.0,
            length_to_pulley_m: 5.0,
            length_sd_m: 2e-4,
        },
        material: CableMaterial {
            axial_stiffness_n: Some(8e5),
            weight_n_per_m: 0.25,
            elongation_surface: None,
        },
        tension_sd_n: 4.0,
    };
    let mut cables = Vec::new();
    for (level, vertical) in [(0.3, -1.0), (6.0, 1.0)] {
        for (x, y) in [(1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            let entry = [8.0 * x, 6.0 * y, level];
            let anchor = [-0.5 * x * vertical, 0.4 * y, -0.35 * vertical];
            cables.push(kind.cable(cables.len(), entry, [0.0, 0.0, vertical], anchor));
        }
    }
    Preset {
        name: "hall",
        summary: "eight cables, fully constrained, 16 m x 12 m x 6 m",
        assumed: "everything: a typical robot of this size",
        robot: robot(
            "hall",
            home([0.0, 0.0, 3.0], 1e-3, 1e-3),
            Platform::spatial(Some(60.0)),
            downward_laser(-0.4, 1e-3, 0.0, 0.01),
            cables,
        ),
        measured_entry_points_m: None,
        workspace: around([0.0, 0.0, 3.0], [4.0, 3.0, 1.2], 0.1),
        tension: TensionRange {
            lower_n: 300.0,
            reference_n: 1000.0,
            upper_n: 3000.0,
        },
    }
}

/// A large suspended robot whose steel cables sag.
fn suspended() -> Preset {
    let kind = CableKind {
        radius_m: 0.08,
        entry_point_sd_m: PerAxis::known(0.02),
        winch: Winch {
            drum_diameter_m: 0.25,
            drum_pitch_m: 0.009,
            gear_ratio: 15.0,
            length_to_pulley_m: 11.0,
            length_sd_m: 4e-4,
        },
        material: CableMaterial {
            axial_stiffness_n: Some(1.2e6),
            weight_n_per_m: 1.2,
            elongation_surface: None,
        },
        tension_sd_n: 3.0,
    };
    // Two cables per corner, crossed so that they also constrain the platform's orientation.
    let corners = [(1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
    let mut cables = Vec::new();
    for (x, y) in corners {
        let first = ([15.0 * x, 9.4 * y, 11.0], [0.6 * x, -0.5 * y, 0.5]);
        let second = ([14.4 * x, 10.0 * y, 11.0], [-0.6 * x, 0.5 * y, -0.5]);
        for (entry, anchor) in [first, second] {
            cables.push(kind.cable(cables.len(), entry, [0.0, 0.0, 1.0], anchor));
        }
    }
    Preset {
        name: "suspended",
        summary: "eight sagging cables, suspended, 30 m x 20 m x 11 m",
        assumed: "everything: a typical robot of this size",
        robot: robot(
            "suspended",
            home([0.0, 0.0, 3.0], 2e-3, 1e-3),
            Platform::spatial(Some(300.0)),
            downward_laser(-0.6, 1e-3, 0.0, 0.02),
            cables,
        ),
        measured_entry_points_m: None,
        workspace: around([0.0, 0.0, 3.0], [6.0, 4.0, 1.8], 0.05),
        tension: TensionRange {
            lower_n: 150.0,
            reference_n: 900.0,
            upper_n: 6000.0,
        },
    }
}

/// A planar robot in a vertical plane; x and y of its base frame lie in that plane.
fn planar() -> Preset {
    let kind = CableKind {
        radius_m: 0.025,
        // Normal to the plane the pulleys are known, as no reading depends on these coordinates.
        entry_point_sd_m: PerAxis::Each([4e-3, 4e-3, 0.0].map(Some)),
        winch: Winch {
            drum_diameter_m: 0.06,
            drum_pitch_m: 0.003,
            gear_ratio: 4.0,
            length_to_pulley_m: 0.8,
            length_sd_m: 1e-4,
        },
        material: CableMaterial {
            axial_stiffness_n: Some(1e5),
            ..CableMaterial::default()
        },
        tension_sd_n: 1.0,
    };
    let corners = [(1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
    let cables = corners
        .into_iter()
        .enumerate()
        .map(|(index, (x, y))| {
            let entry = [1.5 * x, y, 0.0];
            kind.cable(index, entry, [0.0, y, 0.0], [0.12 * x, -0.08 * y, 0.0])
        })
        .collect();
    let mut robot = robot(
        "planar",
        home([0.0; 3], 2e-4, 5e-4),
        Platform {
            free: vec![Coordinate::X, Coordinate::Y, Coordinate::Rz],
            ..Platform::spatial(Some(4.0))
        },
        Laser {
            origin_m: [0.0, -0.1, 0.0],
            direction: [0.0, -1.0, 0.0],
            sd_m: 3e-4,
            target_plane: TargetPlane {
                normal: [0.0, 1.0, 0.0],
                offset_m: -1.1,
                offset_sd_m: Some(5e-3),
            },
        },
        cables,
    );
    robot.gravity_m_s2 = [0.0, -9.80665, 0.0];
    Preset {
        name: "planar",
        summary: "four cables in a vertical plane, 3 m x 2 m",
        assumed: "everything: a typical robot of this size",
        robot,
        measured_entry_points_m: None,
        workspace: around([0.0; 3], [0.7, 0.45, 0.0], 0.15),
        tension: TensionRange {
            lower_n: 15.0,
            reference_n: 60.0,
            upper_n: 300.0,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_possible_robots_whose_home_can_be_held() {
        for name in NAMES {
            let preset = find(name).unwrap();
            assert_eq!(preset.name, name);
            preset.robot.check().unwrap();
            assert_eq!(Workspace::of(&preset.robot), preset.workspace);
            assert_eq!(TensionRange::of(&preset.robot), preset.tension);
            let home = preset.robot.home.unwrap().pose();
            let tensions = preset.tension.tensions(&preset.robot, &home).unwrap();
            assert!(tensions.is_some(), "{name}");
        }
    }
}
