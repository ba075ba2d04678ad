//! A virtual robot in static equilibrium: the pose of its platform at given motor revolutions, and the readings there.

use nalgebra::{DMatrix, DVector};

use super::holding_tensions::{Epoch, Schedule, Visit, holding_tensions};
use super::inversion::invert;
use super::readings::{blank, true_directions};
use super::virtual_robot::{SimulationError, bind};
use super::workspace::TensionRange;
use crate::effect::BoundEffect;
use crate::estimation::EstimationError;
use crate::geometry::{Pose, Twist};
use crate::kinematics::length_gradients;
use crate::measurement::{Dataset, Grid, Measurements};
use crate::robot::Robot;

/// Largest number of Gauss-Newton steps to the pose at rest.
const MAX_STEPS: usize = 40;
/// Largest component of the step at which the platform counts as at rest (m, rad).
const STEP_TOLERANCE: f64 = 1e-10;

/// A robot with effects and a tension distribution within a range, whose encoders were zeroed at home.
#[derive(Debug, Clone)]
pub struct QuasiStaticRobot {
    truth: Robot,
    effects: Vec<BoundEffect>,
    range: TensionRange,
    home: Pose,
    zeroed_at: Epoch,
    home_tensions_n: Vec<f64>,
}

/// State of the robot with the platform at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct RestState {
    /// Pose of the platform.
    pub pose: Pose,
    /// Tensions (N).
    pub tensions_n: Vec<f64>,
    /// One row of noise-free readings, each cable on its own channel.
    pub readings: Measurements,
}

impl QuasiStaticRobot {
    /// Zeroes the encoders of a robot at its home pose at the given epoch.
    ///
    /// # Errors
    /// If it has no home pose or cannot be held there, or an effect is unknown.
    pub fn new(
        truth: Robot,
        range: TensionRange,
        zeroed_at: Epoch,
    ) -> Result<Self, SimulationError> {
        let home = truth.home.ok_or(EstimationError::NoHome)?.pose();
        let effects = bind(&truth)?;
        let visit = Visit {
            first: None,
            epoch: zeroed_at,
            pose: &home,
            motion: [Twist::zeros(); 2],
        };
        let infeasible = SimulationError::infeasible(&range, "the home pose");
        let home_tensions_n =
            holding_tensions(&truth, &effects, &visit, &range)?.ok_or(infeasible)?;
        Ok(Self {
            truth,
            effects,
            range,
            home,
            zeroed_at,
            home_tensions_n,
        })
    }

    /// The true robot.
    #[must_use]
    pub fn truth(&self) -> &Robot {
        &self.truth
    }

    /// State at home, when the encoders were zeroed.
    ///
    /// # Errors
    /// If the kinematics has no solution there.
    pub fn at_home(&self) -> Result<RestState, SimulationError> {
        let mut exact = self.exact(&[(self.zeroed_at, self.home, &self.home_tensions_n)]);
        self.invert(&mut exact, None)?;
        Ok(RestState {
            pose: self.home,
            tensions_n: self.home_tensions_n.clone(),
            readings: exact.measurements,
        })
    }

    /// State at a pose reached from the pose `before`.
    ///
    /// # Errors
    /// If the kinematics has no solution or no tensions within the range balance the platform there.
    pub fn at(&self, at: Epoch, before: &Pose, pose: &Pose) -> Result<RestState, SimulationError> {
        let visit = Visit {
            first: Some((self.zeroed_at, &self.home)),
            epoch: at,
            pose,
            motion: [Twist::zeros(); 2],
        };
        let held = holding_tensions(&self.truth, &self.effects, &visit, &self.range)?;
        let infeasible = SimulationError::infeasible(&self.range, "the commanded pose");
        let tensions_n = held.ok_or(infeasible)?;
        let visits = [
            (self.zeroed_at, self.home, &self.home_tensions_n),
            (at, *pose, &tensions_n),
        ];
        let mut exact = self.exact(&visits);
        self.invert(&mut exact, Some(before))?;
        Ok(RestState {
            pose: *pose,
            readings: exact.measurements.select(&[1]),
            tensions_n,
        })
    }

    /// State in which the platform rests when the motors are commanded to these revolutions, searched from `start`.
    ///
    /// With more cables than degrees of freedom, no pose has all the lengths. The drives are assumed to regulate the lengths
    /// where they move the platform and, by their own force sensors, the tensions in the directions
    /// that do not: so the platform rests where the sum of squared length errors is smallest, and the
    /// tensions are the distribution within the range.
    ///
    /// # Errors
    /// As [`Self::at`], and if there is no such state.
    pub fn at_revolutions(
        &self,
        at: Epoch,
        before: &Pose,
        (revolutions, start): (&[f64], &Pose),
    ) -> Result<RestState, SimulationError> {
        let mut pose = *start;
        for _ in 0..MAX_STEPS {
            let rest = self.at(at, before, &pose)?;
            let step = self.step(&rest, revolutions)?;
            if step.amax() < STEP_TOLERANCE {
                return Ok(rest);
            }
            pose = pose.perturbed(&step);
        }
        Err(SimulationError::NoEquilibrium)
    }

    /// Gauss-Newton step of the platform that minimises the length errors.
    fn step(&self, rest: &RestState, revolutions: &[f64]) -> Result<Twist, SimulationError> {
        let gradients = length_gradients(&self.truth, &rest.pose)?;
        let freedom = self.truth.platform.freedom();
        let jacobian = DMatrix::from_fn(gradients.len(), freedom.count(), |i, k| {
            gradients[i].pose[freedom.coordinates()[k].index()]
        });
        let errors = self.truth.cables.iter().enumerate().map(|(i, cable)| {
            let commanded = revolutions.get(i).copied().unwrap_or(f64::NAN);
            let now = rest.readings.revolutions.get(0, i);
            (commanded - now) * cable.winch.cable_per_revolution_m()
        });
        let errors = DVector::from_iterator(gradients.len(), errors);
        let normal = jacobian.tr_mul(&jacobian).cholesky();
        let step = normal.map(|normal| normal.solve(&jacobian.tr_mul(&errors)));
        let step = step.filter(|step| step.iter().all(|v| v.is_finite()));
        let step = step.ok_or(SimulationError::NoEquilibrium)?;
        Ok(freedom.expand(step.as_slice()))
    }

    /// The readings with channels exchanged as the effects state.
    #[must_use]
    pub fn as_read(&self, rest: &RestState) -> Measurements {
        let mut data = rest.readings.clone();
        for effect in &self.effects {
            effect.exchange_channels(&mut data);
        }
        data
    }

    fn exact(&self, visits: &[(Epoch, Pose, &Vec<f64>)]) -> Dataset {
        let mut tensions = Grid::new(self.truth.cable_count());
        for (_, _, row) in visits {
            tensions.push_row(row);
        }
        let schedule = Schedule {
            labels: visits.iter().map(|(at, ..)| at.label).collect(),
            time_s: visits.iter().map(|(at, ..)| at.time_s).collect(),
            temperature_c: visits.iter().map(|(at, ..)| at.temperature_c).collect(),
        };
        let poses: Vec<Pose> = visits.iter().map(|(_, pose, _)| *pose).collect();
        Dataset {
            measurements: blank(&self.truth, schedule, (&poses, &poses), &tensions),
            robot: self.truth.clone(),
        }
    }

    fn invert(&self, exact: &mut Dataset, before: Option<&Pose>) -> Result<(), SimulationError> {
        let poses = exact.measurements.truth.poses.clone();
        let tensions = exact.measurements.truth.tension_n.clone();
        let mut directions = Grid::new(self.truth.cable_count());
        directions.push_row(&vec![0.0; self.truth.cable_count()]);
        if let (Some(before), Some(pose)) = (before, poses.get(1)) {
            let travelled = true_directions(&self.truth, &[*before, *pose])?;
            directions.push_row(travelled.row(1));
        }
        Ok(invert(exact, (&poses, &tensions), &directions)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::presets;
    use crate::simulation::{SimulationOptions, ambient_temperature_c, simulate};

    fn epoch(row: usize) -> Epoch {
        let time_s = 30.0 * row as f64;
        Epoch {
            label: row as i64,
            time_s,
            temperature_c: ambient_temperature_c(time_s),
        }
    }

    #[test]
    fn reads_what_a_simulated_run_reads() {
        for (name, effect) in [
            ("mini", "winch_backlash"),
            ("hall", "frame_compliance"),
            ("planar", "cable_creep"),
        ] {
            let preset = presets::find(name).unwrap();
            let mut options = SimulationOptions::new(3, 5);
            options.noise = false;
            options.tension = Some(preset.tension);
            options.effects = vec![crate::effect::EffectSetting {
                effect: effect.into(),
                targets: Vec::new(),
                parameters: crate::effect::find(effect)
                    .unwrap()
                    .parameters()
                    .iter()
                    .map(|p| (p.name.to_owned(), p.typical[0]))
                    .collect(),
            }];
            let run = simulate(&preset.robot, &options).unwrap();
            let data = &run.dataset.measurements;
            let robot = QuasiStaticRobot::new(run.truth, preset.tension, epoch(0)).unwrap();
            let poses = &data.truth.poses;
            for row in 1..poses.len() {
                let rest = robot.at(epoch(row), &poses[row - 1], &poses[row]).unwrap();
                for cable in 0..preset.robot.cable_count() {
                    let read = rest.readings.revolutions.get(0, cable);
                    let expected = data.revolutions.get(row, cable);
                    assert!((read - expected).abs() < 1e-10, "{name}");
                }
                assert!((rest.readings.laser_at(0) - data.laser_at(row)).abs() < 1e-11);
            }
        }
    }

    #[test]
    fn rests_where_it_would_read_the_commanded_revolutions() {
        let preset = presets::find("mini").unwrap();
        let robot = QuasiStaticRobot::new(preset.robot.clone(), preset.tension, epoch(0)).unwrap();
        let home = preset.robot.home.unwrap().pose();
        let target = home.perturbed(&Twist::new(0.1, -0.05, 0.08, 0.1, 0.0, -0.2));
        let there = robot.at(epoch(1), &home, &target).unwrap();
        let revolutions = there.readings.revolutions.row(0);
        let rest = robot
            .at_revolutions(epoch(1), &home, (revolutions, &home))
            .unwrap();
        assert!(rest.pose.difference(&target).amax() < 1e-9);
    }
}
