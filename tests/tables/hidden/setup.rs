//! Setup of a dataset: robot, seed and imperfections of the measurements.

use anyhow::{Context, Result};
use rand_chacha::ChaCha8Rng;
use tautline_core::effect::EffectSetting;
use tautline_core::measurement::Dataset;
use tautline_core::robot::{PerAxis, Robot};
use tautline_core::simulation::{Simulated, simulate};

use super::conditions::{add_model_error, add_noise, add_shared_errors, empty_cells, repeated};
use super::outside::{self, Scene};
use super::robots::{TestRobot, Truth, robot};
use super::{Circumstances, Conditions, Hidden, Plan, Wanted, hanging};
use crate::tables::simulated::{preset_options, stream};

/// Streams of random numbers. The simulation uses stream 0 of the same seed, other modules use streams 1 and 2.
const HANGING: u64 = 3;
const NOISE: u64 = 4;
const HOLES: u64 = 5;
/// Number of poses if several effects are hidden at once.
const SEVERAL_POSES: usize = 60;
/// Number of poses if each has several rows.
const STANDSTILLS: usize = 24;
/// Standard deviation of unknown entry points (m).
const UNMEASURED_M: f64 = 0.02;

/// Robot, seed and imperfections that all fits of a case share.
#[derive(Debug, Clone)]
pub struct Setup {
    /// The robot.
    pub robot: TestRobot,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Imperfections of the measurements.
    pub conditions: Conditions,
}

impl Setup {
    /// Creates the setup of a plan.
    ///
    /// # Errors
    /// If the robot does not exist.
    pub fn new(plan: &Plan, conditions: Conditions) -> Result<Self> {
        let mut robot = robot(plan.robot).with_context(|| format!("no robot {}", plan.robot))?;
        if plan.wanted == Wanted::Several {
            robot.poses = SEVERAL_POSES;
        }
        if plan.circumstances == Circumstances::Standstills {
            robot.poses = STANDSTILLS;
        }
        Ok(Self {
            robot,
            seed: plan.seed,
            conditions,
        })
    }

    fn stream(&self, number: u64) -> ChaCha8Rng {
        stream(self.seed, number)
    }

    /// Simulates the robot with effects of the catalogue, without noise.
    ///
    /// # Errors
    /// If the effects break the robot.
    pub fn exact(&self, effects: &[EffectSetting]) -> Result<Simulated> {
        let mut options = preset_options(&self.robot.preset, self.robot.poses, self.seed);
        options.effects = effects.to_vec();
        options.noise = false;
        let description = &self.robot.preset.robot;
        let mut run = match self.robot.truth {
            Truth::AsStated => simulate(description, &options)?,
            Truth::AnchorsUnknown => {
                let mut run = simulate(&measured_roughly(description), &options)?;
                run.dataset.robot = description.clone();
                for (cable, stated) in run.truth.cables.iter_mut().zip(&description.cables) {
                    cable.pulley.entry_point_sd_m = stated.pulley.entry_point_sd_m;
                }
                run
            }
            Truth::Hanging => hanging::simulated(&self.robot, &options, &mut self.stream(HANGING))?,
        };
        if self.conditions.shared > 0.0 {
            run.dataset.measurements = repeated(&run.dataset.measurements);
        }
        Ok(run)
    }

    /// Noise-free data with a description whose noise corresponds to the imperfections and whose priors are centred on
    /// the truth. Chi-square is then zero for the true model and the noncentrality for any other.
    pub(super) fn visibility_data(&self, exact: &Simulated) -> Dataset {
        let plain = Robot {
            effects: Vec::new(),
            ..exact.truth.clone()
        };
        let mut measurements = exact.dataset.measurements.clone();
        if self.conditions.holes {
            empty_cells(&plain, &mut measurements, &mut self.stream(HOLES));
        }
        Dataset {
            robot: self.conditions.equivalent_noise().of(&plain),
            measurements,
        }
    }

    /// Noise-free data of a machine with something hidden, described so that only what is hidden is unexplained.
    ///
    /// # Errors
    /// If the effects break the robot.
    pub fn without_noise(&self, hidden: &Hidden) -> Result<Dataset> {
        let exact = self.exact(hidden.effects())?;
        Ok(match hidden {
            Hidden::Outside(effect, size) => outside::changed(self, &exact, (effect, *size)),
            _ => self.visibility_data(&exact),
        })
    }

    /// Simulates the measured data of a case, before cells are emptied.
    ///
    /// # Errors
    /// If the effects break the robot.
    pub fn measured(&self, hidden: &Hidden) -> Result<Simulated> {
        let settings = hidden.effects();
        let mut run = self.exact(settings)?;
        let data = &mut run.dataset.measurements;
        if let Hidden::Outside(effect, size) = hidden {
            (effect.change)(&Scene::new(&run.truth, self.seed), *size, data);
        }
        let stated = &run.dataset.robot;
        let mut rng = self.stream(NOISE);
        if self.conditions.model_error > 0.0 {
            add_model_error(&run.truth, data, self.conditions.model_error, &mut rng);
        }
        if self.conditions.shared > 0.0 {
            add_shared_errors(stated, data, self.conditions.shared, &mut rng);
        }
        let actual = self.conditions.noise.of(stated);
        add_noise(&actual, data, self.conditions.tails, &mut rng);
        if let Hidden::Exchanged(channels, cables) = hidden {
            channels.exchange(*cables, data);
        }
        Ok(run)
    }

    /// Empties cells of a simulated dataset.
    pub fn lose_cells(&self, run: &mut Simulated) {
        let data = &mut run.dataset;
        empty_cells(&data.robot, &mut data.measurements, &mut self.stream(HOLES));
    }
}

/// The description with a standard deviation for entry points that it leaves unknown.
fn measured_roughly(description: &Robot) -> Robot {
    let mut robot = description.clone();
    for cable in &mut robot.cables {
        let sd = cable.pulley.entry_point_sd_m.each();
        let sd = sd.map(|sd| Some(sd.unwrap_or(UNMEASURED_M)));
        cable.pulley.entry_point_sd_m = PerAxis::Each(sd);
    }
    robot
}
