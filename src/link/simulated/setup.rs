//! Setup of a simulated robot.

use tautline_core::robot::Robot;
use tautline_core::robot::presets::Preset;
use tautline_core::simulation::{
    SimulationOptions, TensionRange, TrueGeometry, Workspace, true_robot,
};

use crate::error::LinkError;

/// Default of the highest speed (m/s).
const FASTEST_M_S: f64 = 2.0;

/// Setup of a simulated robot.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedSetup {
    /// The description: initial parameters of the controller, and standard deviations of the noise.
    /// Its effects, neutral or not, are those that the controller can correct.
    pub nominal: Robot,
    /// The true robot, including its effects.
    pub truth: Robot,
    /// Seed of the noise.
    pub seed: u64,
    /// Values of the controller that replace those of the description, by name.
    pub parameters: Vec<(String, f64)>,
    /// Tension limits of the controller's distribution.
    pub tension: TensionRange,
    /// Simulated seconds per second of the clock.
    pub speed: f64,
    /// Highest speed (m/s).
    pub velocity_m_s: f64,
    /// Highest angular speed (rad/s).
    pub turning_rad_s: f64,
    /// Largest acceleration (m/s^2).
    pub acceleration_m_s2: f64,
    /// Whether readings have noise.
    pub noise: bool,
    /// Number of samples whose mean has the standard deviation of the description.
    pub averaged_samples: usize,
    /// Fraction of the noise variance that is common to all samples at one pose and is not removed by averaging.
    pub repeating_share: f64,
    /// Range of distances with a laser return (m).
    pub laser_range_m: [f64; 2],
}

impl SimulatedSetup {
    /// A setup with defaults for the size of the robot.
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

    /// Checks that such a robot can be simulated.
    pub(super) fn check(&self) -> Result<(), LinkError> {
        let refuse = |text: &str| Err(LinkError::Setup(text.to_owned()));
        if self.truth.cable_count() != self.nominal.cable_count() {
            return refuse("the true robot and its description have different numbers of cables");
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

    /// A preset whose true geometry is the measured one if there is one, else drawn from its priors.
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
