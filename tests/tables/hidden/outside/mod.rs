//! Effects outside the catalogue, as different from it and from each other as possible: on each kind of reading, in
//! time, in space and under load. Each one changes the readings of a simulation.

mod kinds;

use anyhow::Result;
use rand::RngExt;
use tautline_core::estimation::Problem;
use tautline_core::geometry::Vec3;
use tautline_core::kinematics::{CableState, inverse_kinematics};
use tautline_core::measurement::{Dataset, Measurements};
use tautline_core::robot::Robot;
use tautline_core::simulation::Simulated;

use super::Setup;
use crate::tables::simulated::{solved, stream};

pub use kinds::OUTSIDE;

/// Serialisation of effects outside the catalogue by identifier.
pub(super) mod by_id {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    use super::{OUTSIDE, Outside};

    pub fn serialize<S: Serializer>(effect: &&'static Outside, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(effect.id)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<&'static Outside, D::Error> {
        let id = String::deserialize(from)?;
        let found = OUTSIDE.iter().find(|effect| effect.id == id);
        found.ok_or_else(|| Error::custom(format!("no effect {id} outside the catalogue")))
    }
}

/// An effect outside the catalogue.
pub struct Outside {
    /// Identifier in tables and commands.
    pub id: &'static str,
    /// Whether the robot has the readings that the effect changes.
    pub applies: fn(&Robot) -> bool,
    /// Start value of the search for a size.
    pub unit: f64,
    /// Changes the readings by an effect of the given size.
    pub change: fn(&Scene, f64, &mut Measurements),
}

impl std::fmt::Debug for Outside {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.id)
    }
}

impl PartialEq for Outside {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

/// Variables that an effect outside the catalogue may use, and random numbers drawn for it.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The true robot.
    pub truth: Robot,
    /// Target cable.
    pub cable: usize,
    /// A phase (rad).
    pub phase: f64,
    /// A direction in the base frame, horizontal where gravity is vertical.
    pub direction: Vec3,
}

impl Scene {
    /// Draws a scene from a seed.
    #[must_use]
    pub fn new(truth: &Robot, seed: u64) -> Self {
        let mut rng = stream(seed, 2);
        let phase = std::f64::consts::PI * rng.random_range(-1.0..1.0);
        let mut direction = Vec3::new(f64::cos(phase), f64::sin(phase), 0.0);
        if truth.platform.free.len() < 6 {
            direction = Vec3::x();
        }
        Self {
            truth: truth.clone(),
            cable: rng.random_range(0..truth.cable_count()),
            phase,
            direction,
        }
    }

    /// True states of the cables, by row.
    #[must_use]
    pub fn states(&self, data: &Measurements) -> Vec<Vec<CableState>> {
        let poses = data.truth.poses.iter();
        poses
            .map(|pose| inverse_kinematics(&self.truth, pose).unwrap_or_default())
            .collect()
    }

    /// True positions relative to their mean, in units of the largest excursion, by row.
    #[must_use]
    pub fn relative_positions(&self, data: &Measurements) -> Vec<Vec3> {
        let poses = &data.truth.poses;
        let from = poses.iter().map(|p| p.position).sum::<Vec3>() / poses.len() as f64;
        let offsets: Vec<Vec3> = poses.iter().map(|p| p.position - from).collect();
        let largest = offsets.iter().map(Vec3::amax).fold(1e-9, f64::max);
        offsets.iter().map(|o| o / largest).collect()
    }
}

/// Adds `error(row, cable)` metres to the length readings. Relative readings are zero at home, so they lose the error
/// there.
pub(super) fn add_length(
    scene: &Scene,
    data: &mut Measurements,
    error: impl Fn(usize, usize) -> f64,
) {
    let home = scene.truth.home.and(data.home_row());
    for row in 0..data.len() {
        for (index, cable) in scene.truth.cables.iter().enumerate() {
            if !data.revolutions.is_empty() {
                let change = error(row, index) - home.map_or(0.0, |home| error(home, index));
                let turns = change / cable.winch.cable_per_revolution_m();
                let value = data.revolutions.get(row, index) + turns;
                data.revolutions.set(row, index, value);
            }
            if !data.length_m.is_empty() {
                let value = data.length_m.get(row, index) + error(row, index);
                data.length_m.set(row, index, value);
            }
        }
    }
}

/// Adds `error(row, cable)` newtons of tension to the force readings.
pub(super) fn add_tension(
    scene: &Scene,
    data: &mut Measurements,
    error: impl Fn(usize, usize) -> f64,
) {
    for row in 0..data.force_n.rows() {
        for (index, cable) in scene.truth.cables.iter().enumerate() {
            let gain = cable.force_sensor.map_or(1.0, |s| s.tension_gain);
            let value = data.force_n.get(row, index) + gain * error(row, index);
            data.force_n.set(row, index, value);
        }
    }
}

/// Noise-free data changed by an effect outside the catalogue.
pub(super) fn changed(
    setup: &Setup,
    exact: &Simulated,
    (effect, size): (&Outside, f64),
) -> Dataset {
    let mut exact = exact.clone();
    let scene = Scene::new(&exact.truth, setup.seed);
    (effect.change)(&scene, size, &mut exact.dataset.measurements);
    setup.visibility_data(&exact)
}

/// Noncentrality of the effect: chi-square of the true description for noise-free data.
pub(super) fn noncentrality(
    setup: &Setup,
    exact: &Simulated,
    sized: (&Outside, f64),
) -> Result<f64> {
    let dataset = changed(setup, exact, sized);
    Ok(solved(&Problem::new(&dataset)?)?.chi2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::hidden::Conditions;
    use crate::tables::hidden::robots::robots;

    #[test]
    fn each_effect_shows_on_a_robot_and_only_where_it_applies() {
        for effect in &OUTSIDE {
            let mut seen = 0;
            for robot in robots() {
                let setup = Setup {
                    robot: robot.clone(),
                    seed: 2,
                    conditions: Conditions::default(),
                };
                let exact = setup.exact(&[]).unwrap();
                let at = |size| noncentrality(&setup, &exact, (effect, size)).unwrap();
                let shows = at(effect.unit) > 1e-3;
                if !(effect.applies)(&robot.preset.robot) {
                    assert!(!shows, "{} on {}", effect.id, robot.name);
                }
                assert!(at(0.0) < 1e-4, "{} on {}", effect.id, robot.name);
                seen += usize::from(shows);
            }
            assert!(seen > 0, "{}", effect.id);
        }
    }
}
