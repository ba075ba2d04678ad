//! What a simulated robot is made of.

use tautline_core::robot::Robot;
use tautline_core::robot::presets::Preset;
use tautline_core::simulation::{
    SimulationOptions, TensionRange, TrueGeometry, Workspace, true_robot,
};

use crate::error::LinkError;

/// Fastest platform by default (m/s).
const FASTEST_M_S: f64 = 2.0;

/// Everything that makes a simulated robot.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedSetup {
    /// The description: what the controller believes at first, and whose standard deviations the noise has.
    /// Effects in it, neutral or not, are those that the controller can correct.
    pub nominal: Robot,
    /// The robot as it is, its effects included.
    pub truth: Robot,
    /// Seed of the noise.
    pub seed: u64,
    /// Values that the controller holds instead of those of the description, by name.
    pub parameters: Vec<(String, f64)>,
    /// Tensions that the controller distributes.
    pub tension: TensionRange,
    /// Simulated seconds per second of the clock.
    pub speed: f64,
    /// Fastest motion (m/s).
    pub velocity_m_s: f64,
    /// Fastest rotation (rad/s).
    pub turning_rad_s: f64,
    /// Strongest acceleration (m/s^2).
    pub acceleration_m_s2: f64,
    /// Whether readings have noise.
    pub noise: bool,
    /// Samples whose mean has the standard deviation of the description.
    pub averaged_samples: usize,
    /// Part of that variance which repeats in all samples of one pose: no averaging removes it.
    pub repeating_share: f64,
    /// Distances at which the laser has a return (m).
    pub laser_range_m: [f64; 2],
}

impl SimulatedSetup {
    /// A setup with defaults that suit the size of the robot.
    #[must_use]
    pub fn new(nominal: Robot, truth: Robot, seed: u64) -> Self {
        let reach = Workspace::of(&nominal).half_extent_m;
        let velocity_m_s = reach
            .into_iter()
            .fold(0.0, f64::max)
            .clamp(0.1, FASTEST_M_S);
        Self {
            tension: TensionRange::of(&nominal),
            nominal,
            truth,
            seed,
            parameters: Vec::new(),
            speed: 1.0,
            velocity_m_s,
            turning_rad_s: 0.5,
            acceleration_m_s2: 5.0 * velocity_m_s,
            noise: true,
            averaged_samples: 10,
            repeating_share: 0.5,
            laser_range_m: [0.0, f64::INFINITY],
        }
    }

    /// Whether such a robot can be simulated.
    pub(super) fn check(&self) -> Result<(), LinkError> {
        let refuse = |text: &str| Err(LinkError::Setup(text.to_owned()));
        if self.truth.cable_count() != self.nominal.cable_count() {
            return refuse("the true robot has another number of cables than the description");
        }
        let paces = [
            self.speed,
            self.velocity_m_s,
            self.turning_rad_s,
            self.acceleration_m_s2,
        ];
        if paces.iter().all(|pace| pace.is_finite() && *pace > 0.0) {
            Ok(())
        } else {
            refuse("a speed or acceleration of the simulated robot is not a positive number")
        }
    }

    /// A preset whose true geometry is the measured one where there is one, else drawn from its priors.
    #[must_use]
    pub fn of_preset(preset: &Preset, seed: u64) -> Self {
        let mut options = SimulationOptions::new(0, seed);
        if let Some(points) = &preset.measured_entry_points_m {
            options.geometry = TrueGeometry::EntryPoints(points.clone());
        }
        let truth = true_robot(&preset.robot, &options);
        let reach = preset
            .workspace
            .half_extent_m
            .into_iter()
            .fold(0.0, f64::max);
        let velocity_m_s = reach.clamp(0.1, FASTEST_M_S);
        Self {
            tension: preset.tension,
            velocity_m_s,
            acceleration_m_s2: 5.0 * velocity_m_s,
            ..Self::new(preset.robot.clone(), truth, seed)
        }
    }
}
