//! Many calibration runs of one robot at the same commanded poses, each with another truth and other noise.
//!
//! As [`simulate`](super::simulate) at given poses, for robots without effects, in a time that is short beside that of
//! the identification: tensions are the nominal ones, corrected to the equilibrium of the true geometry by as little
//! as possible, and the prediction is inverted in one step, because readings enter it linearly.

use nalgebra::DVector;
use rand_chacha::ChaCha8Rng;

use super::holding_tensions::Schedule;
use super::inversion::invert_within;
use super::readings::{add_noise, blank};
use super::virtual_robot::{
    Simulated, SimulationError, SimulationOptions, TrueGeometry, displaced, draw_truth,
};
use super::workspace::TensionRange;
use crate::geometry::Pose;
use crate::kinematics::{applied_wrench, structure_matrix};
use crate::measurement::{Dataset, Grid};
use crate::robot::Robot;

/// One step: without effects the readings that a prediction asks for do not depend on the readings.
const STEPS: [usize; 2] = [1, 1];
/// Displacements drawn for a pose before the run is given up.
const TRIES: usize = 200;

/// A robot at commanded poses, ready to be calibrated over and over.
#[derive(Debug, Clone)]
pub struct RepeatedRuns {
    robot: Robot,
    options: SimulationOptions,
    range: TensionRange,
    /// Home first where there is one.
    commanded: Vec<Pose>,
    /// Tensions of the nominal robot there; empty where tension is not modelled.
    tensions: Vec<Vec<f64>>,
}

impl RepeatedRuns {
    /// Runs at commanded poses; truths are drawn from the priors that the robot states.
    ///
    /// # Errors
    /// If the nominal robot cannot be held at one of the poses.
    ///
    /// # Panics
    /// If the robot has effects: [`simulate`](super::simulate) knows them.
    pub fn new(
        robot: &Robot,
        poses: Vec<Pose>,
        tension: Option<TensionRange>,
    ) -> Result<Self, SimulationError> {
        assert!(robot.effects.is_empty(), "a robot without effects");
        let range = tension.unwrap_or_else(|| TensionRange::of(robot));
        let home = robot.home.map(|home| home.pose());
        let commanded: Vec<Pose> = home.into_iter().chain(poses.iter().copied()).collect();
        let models_tension = robot.platform.mass_kg.is_some() && robot.has_force_sensors();
        let mut tensions = Vec::new();
        for pose in commanded.iter().filter(|_| models_tension) {
            let held = range.tensions(robot, pose)?;
            tensions
                .push(held.ok_or_else(|| SimulationError::infeasible(&range, "a commanded pose"))?);
        }
        Ok(Self {
            robot: robot.clone(),
            options: SimulationOptions {
                geometry: TrueGeometry::Drawn,
                tension: Some(range),
                ..SimulationOptions::new(0, 0).commanding(poses)
            },
            range,
            commanded,
            tensions,
        })
    }

    /// What [`simulate`](super::simulate) is to be asked for the same runs with effects.
    #[must_use]
    pub fn options(&self) -> &SimulationOptions {
        &self.options
    }

    /// The next run.
    ///
    /// # Errors
    /// If the true robot cannot be held at one of the poses, however it is displaced.
    pub fn simulate(&self, rng: &mut ChaCha8Rng) -> Result<Simulated, SimulationError> {
        let truth = draw_truth(&self.robot, &self.options, rng);
        let cables = self.robot.cable_count();
        let mut poses = Vec::with_capacity(self.commanded.len());
        let mut tensions = Grid::new(cables);
        for (row, commanded) in self.commanded.iter().enumerate() {
            let (pose, held) = self.visit(&truth, (row, commanded), rng)?;
            tensions.push_row(&held);
            poses.push(pose);
        }
        let schedule = Schedule::of(&self.robot, poses.len() - 1);
        let mut exact = Dataset {
            measurements: blank(&self.robot, schedule, (&poses, &self.commanded), &tensions),
            robot: truth,
        };
        // No effect asks for the direction of travel.
        let directions = Grid::missing(poses.len(), cables);
        invert_within(STEPS, &mut exact, (&poses, &tensions), &directions)?;
        add_noise(&self.robot, &mut exact.measurements, rng);
        Ok(Simulated {
            truth: exact.robot,
            dataset: Dataset {
                robot: self.robot.clone(),
                measurements: exact.measurements,
            },
        })
    }

    /// The true pose of a row and the tensions that hold the true robot there.
    fn visit(
        &self,
        truth: &Robot,
        (row, commanded): (usize, &Pose),
        rng: &mut ChaCha8Rng,
    ) -> Result<(Pose, Vec<f64>), SimulationError> {
        if let (0, Some(home)) = (row, &truth.home) {
            let pose = home.pose();
            let held = self.tensions_near(truth, row, &pose);
            let place = "the home pose";
            let held = held.ok_or_else(|| SimulationError::infeasible(&self.range, place));
            return Ok((pose, held?));
        }
        for _ in 0..TRIES {
            let pose = displaced(&self.robot, commanded, rng);
            if let Some(held) = self.tensions_near(truth, row, &pose) {
                return Ok((pose, held));
            }
        }
        Err(SimulationError::infeasible(&self.range, "a commanded pose"))
    }

    /// The tensions closest to the nominal ones of a row that balance the true platform at a pose.
    fn tensions_near(&self, truth: &Robot, row: usize, pose: &Pose) -> Option<Vec<f64>> {
        let structure = structure_matrix(truth, pose).ok()?;
        let Some(nominal) = self.tensions.get(row) else {
            return Some(vec![0.0; truth.cable_count()]);
        };
        let nominal = DVector::from_column_slice(nominal);
        let missing = applied_wrench(truth, pose).ok()? + structure.tr_mul(&nominal);
        let correction = structure.tr_mul(&structure).cholesky()?.solve(&missing);
        let held = nominal - structure * correction;
        let range = self.range.lower_n..=self.range.upper_n;
        if held.iter().all(|tension| range.contains(tension)) {
            return Some(held.as_slice().to_vec());
        }
        // At a limit the least correction is that of the distribution.
        self.range.tensions(truth, pose).ok().flatten()
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::super::simulate;
    use super::*;
    use crate::estimation::{Control, Options, Problem, solve};
    use crate::kinematics::equilibrium_residual;
    use crate::planning::{PlanOptions, random_poses};
    use crate::robot::presets;

    fn runs(name: &str) -> RepeatedRuns {
        let robot = presets::find(name).unwrap().robot;
        let poses = random_poses(&robot, &PlanOptions::new(20, 4)).unwrap();
        RepeatedRuns::new(&robot, poses, None).unwrap()
    }

    /// The slow way knows nothing of the shortcuts: the same truth, poses and tensions read the same.
    #[test]
    fn readings_are_those_of_the_full_inversion() {
        for name in presets::NAMES {
            let mut runs = runs(name);
            // Without noise, and the pulleys where they are known: the run is what it says.
            for cable in &mut runs.robot.cables {
                cable.winch.length_sd_m = 0.0;
                cable.force_sensor.as_mut().unwrap().tension_sd_n = 0.0;
            }
            runs.robot.laser.as_mut().unwrap().sd_m = 0.0;
            let run = runs.simulate(&mut ChaCha8Rng::seed_from_u64(7)).unwrap();
            let truth = &run.dataset.measurements.truth;
            let mut exact = Dataset {
                robot: run.truth.clone(),
                measurements: run.dataset.measurements.clone(),
            };
            let directions = Grid::missing(truth.poses.len(), run.truth.cable_count());
            invert_within(
                [12, 12],
                &mut exact,
                (&truth.poses, &truth.tension_n),
                &directions,
            )
            .unwrap();
            let (one, many) = (&run.dataset.measurements, &exact.measurements);
            for row in 0..one.len() {
                for cable in 0..run.truth.cable_count() {
                    let per_revolution = run.truth.cables[cable].winch.cable_per_revolution_m();
                    let off = one.revolutions.get(row, cable) - many.revolutions.get(row, cable);
                    assert!((off * per_revolution).abs() < 1e-12, "{name} {off}");
                    let off = one.force_n.get(row, cable) - many.force_n.get(row, cable);
                    assert!(off.abs() < 1e-9, "{name} {off}");
                }
                assert!((one.laser_m[row] - many.laser_m[row]).abs() < 1e-12);
                let held = truth.tension_n.row(row);
                let left = equilibrium_residual(&run.truth, &truth.poses[row], held).unwrap();
                assert!(left.norm() < 1e-6, "{name} {left}");
            }
        }
    }

    /// Chi-square of 200 runs has the mean of its degrees of freedom; its mean is off by 4 standard errors with a
    /// probability of 6e-5.
    #[test]
    fn chi_square_is_as_described() {
        let runs = runs("mini");
        let (mut sum, mut dof) = (0.0, 0.0);
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        for _ in 0..200 {
            let run = runs.simulate(&mut rng).unwrap();
            let problem = Problem::new(&run.dataset).unwrap();
            let quiet = &mut |_: &_| Control::Continue;
            let solution = solve(&problem, &Options::default(), quiet).unwrap();
            assert!(solution.converged());
            sum += solution.chi2;
            dof += solution.degrees_of_freedom;
        }
        assert!((sum - dof).abs() < 4.0 * (2.0 * dof).sqrt(), "{sum} {dof}");
    }

    #[test]
    fn poses_are_commanded_as_given() {
        let runs = runs("planar");
        let run = runs.simulate(&mut ChaCha8Rng::seed_from_u64(1)).unwrap();
        let slow = simulate(&runs.robot, runs.options()).unwrap();
        let commanded = |run: &Simulated| run.dataset.measurements.commanded.clone();
        assert_eq!(commanded(&run), commanded(&slow));
        assert_eq!(run.dataset.robot, slow.dataset.robot);
        assert_ne!(run.truth, slow.truth);
    }
}
