//! Ready-made robots for simulation, demonstrations and validation: `robot.json` written in TOML, and what is known of them.
//!
//! `mini` is the robot of Jin et al. 2018: entry points from Table 1 (cable 7 with its signs repaired by
//! symmetry). The paper does not give platform anchors, pulley radius, drum, stiffness, mass or laser
//! mount; those values are assumed, see [`Preset::assumed`]. Cables of the spatial robots cross: with all anchors on the lines to
//! their pulleys, nothing would constrain the rotation about z.

use crate::robot::Robot;
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

/// The values that are assumed for a typical robot.
const EVERYTHING: &str = "everything: a typical robot of this size";

/// The preset called `name`.
#[must_use]
pub fn find(name: &str) -> Option<Preset> {
    let (name, summary, assumed, file) = match name {
        "mini" => (
            "mini",
            "eight cables, 1 m frame (Jin et al. 2018, Table 1)",
            "platform anchors, pulley radius, drum, cable stiffness, mass, laser mount and all noise",
            include_str!("mini.toml"),
        ),
        "hall" => (
            "hall",
            "eight cables, fully constrained, 16 m x 12 m x 6 m",
            EVERYTHING,
            include_str!("hall.toml"),
        ),
        "suspended" => (
            "suspended",
            "eight sagging cables, suspended, 30 m x 20 m x 11 m",
            EVERYTHING,
            include_str!("suspended.toml"),
        ),
        // Normal to the plane the pulleys are known, as no reading depends on these coordinates.
        "planar" => (
            "planar",
            "four cables in a vertical plane, 3 m x 2 m",
            EVERYTHING,
            include_str!("planar.toml"),
        ),
        _ => return None,
    };
    let robot: Robot = toml::from_str(file).ok()?;
    let metres = || MINI_MEASURED_MM.map(|point| point.map(|value| value / 1000.0));
    Some(Preset {
        name,
        summary,
        assumed,
        measured_entry_points_m: (name == "mini").then(|| metres().to_vec()),
        workspace: Workspace::of(&robot),
        tension: TensionRange::of(&robot),
        robot,
    })
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_possible_robots_whose_home_can_be_held() {
        for name in NAMES {
            let preset = find(name).unwrap();
            assert_eq!(preset.name, name);
            preset.robot.check().unwrap();
            let home = preset.robot.home.unwrap().pose();
            let tensions = preset.tension.tensions(&preset.robot, &home).unwrap();
            assert!(tensions.is_some(), "{name}");
        }
    }
}
