//! Many calibration runs of one robot at the same commanded poses, each with new truth and new noise.
//!
//! The same as [`simulate`](super::simulate) at given poses for robots without effects and of exact parts, but much faster than
//! the identification. Tensions are the nominal ones `T0` with the smallest correction to the equilibrium of the true
//! geometry, `T = T0 - A (A^T A)^-1 (A^T T0 + w)`; and because readings enter the prediction of such a robot linearly, they
//! follow directly from lengths, tensions and distances: `rev = (L0 - L0(home)) / k`, `F = g T + f0`.

use nalgebra::{Matrix6, Vector6};
use rand_chacha::ChaCha8Rng;

use super::holding_tensions::Schedule;
use super::readings::{add_noise, blank};
use super::virtual_robot::{
    Simulated, SimulationError, SimulationOptions, TrueGeometry, displaced, draw_truth,
};
use super::workspace::TensionRange;
use crate::cable::CableLaw;
use crate::geometry::{Pose, Vec3};
use crate::kinematics::{CablePath, PulleyGeometry, applied_wrench, inverse_kinematics};
use crate::measurement::{Dataset, Grid, Measurements};
use crate::robot::{Cable, Robot};

/// Number of displacements drawn for a pose before the run is given up.
const TRIES: usize = 200;

/// A robot at commanded poses, prepared for repeated calibration runs.
#[derive(Debug, Clone)]
pub struct RepeatedRuns {
    robot: Robot,
    options: SimulationOptions,
    range: TensionRange,
    /// Commanded poses, home first if there is one.
    commanded: Vec<Pose>,
    /// Tensions of the nominal robot at these poses (N); zeros where tension is not modelled.
    tensions: Vec<Vec<f64>>,
}

/// The true robot at one pose.
struct Visit {
    pose: Pose,
    /// Path of every cable.
    paths: Vec<CablePath<f64>>,
    tensions_n: Vec<f64>,
}

impl RepeatedRuns {
    /// Prepares runs at commanded poses; truths are drawn from the priors that the robot states.
    ///
    /// # Errors
    /// If the nominal robot cannot be held at one of the poses.
    ///
    /// # Panics
    /// If the robot has effects, which only [`simulate`](super::simulate) can handle.
    pub fn new(
        robot: &Robot,
        poses: Vec<Pose>,
        tension: Option<TensionRange>,
    ) -> Result<Self, SimulationError> {
        assert!(robot.effects.is_empty(), "a robot without effects");
        let range = tension.unwrap_or_else(|| TensionRange::of(robot));
        let home = robot.home.map(|home| home.pose());
        let commanded: Vec<Pose> = home.into_iter().chain(poses.iter().copied()).collect();
        let hold = |pose: &Pose| {
            if !robot.has_tensions() || robot.hangs_freely() {
                return Ok(vec![0.0; robot.cable_count()]);
            }
            let held = range.tensions(robot, pose)?;
            held.ok_or_else(|| SimulationError::infeasible(&range, "a commanded pose"))
        };
        let tensions: Result<Vec<_>, SimulationError> = commanded.iter().map(hold).collect();
        Ok(Self {
            robot: robot.clone(),
            options: SimulationOptions {
                geometry: TrueGeometry::Drawn,
                tension: Some(range),
                ..SimulationOptions::new(0, 0).commanding(poses)
            },
            range,
            commanded,
            tensions: tensions?,
        })
    }

    /// Options with which [`simulate`](super::simulate) makes the same runs with effects.
    #[must_use]
    pub fn options(&self) -> &SimulationOptions {
        &self.options
    }

    /// Simulates the next run.
    ///
    /// # Errors
    /// If the true robot cannot be held at one of the poses, with any of the displacements drawn.
    ///
    /// # Panics
    /// If the robot states tolerances or hangs freely: only [`simulate`](super::simulate) makes parts deviate and lets a platform
    /// come to rest.
    pub fn simulate(&self, rng: &mut ChaCha8Rng) -> Result<Simulated, SimulationError> {
        assert!(self.robot.tolerances.is_none(), "a robot of exact parts");
        assert!(!self.robot.hangs_freely(), "a platform that is held");
        let truth = draw_truth(&self.robot, &self.options, rng);
        let visits: Result<Vec<Visit>, SimulationError> = (0..self.commanded.len())
            .map(|row| self.visit(&truth, row, rng))
            .collect();
        let visits = visits?;
        let poses: Vec<Pose> = visits.iter().map(|visit| visit.pose).collect();
        let mut tensions = Grid::new(self.robot.cable_count());
        (visits.iter()).for_each(|visit| tensions.push_row(&visit.tensions_n));
        let schedule = Schedule::of(&self.robot, poses.len() - 1);
        let at = (poses.as_slice(), self.commanded.as_slice());
        let mut measurements = blank(&self.robot, schedule, at, &tensions);
        read(&truth, &visits, &mut measurements)?;
        add_noise(&self.robot, &mut measurements, rng);
        Ok(Simulated {
            dataset: Dataset {
                robot: self.robot.clone(),
                measurements,
            },
            truth,
        })
    }

    /// The true robot at a row: exactly at home, otherwise displaced from the commanded pose.
    fn visit(
        &self,
        truth: &Robot,
        row: usize,
        rng: &mut ChaCha8Rng,
    ) -> Result<Visit, SimulationError> {
        if let (0, Some(home)) = (row, &truth.home) {
            let visit = self.held(truth, row, home.pose());
            let place = "the home pose";
            return visit.ok_or_else(|| SimulationError::infeasible(&self.range, place));
        }
        let mut tried = (0..TRIES).filter_map(|_| {
            let pose = displaced(&self.robot, &self.commanded[row], rng);
            self.held(truth, row, pose)
        });
        let place = "a commanded pose";
        let found = tried.next();
        found.ok_or_else(|| SimulationError::infeasible(&self.range, place))
    }

    /// The true robot at a pose, with the balancing tensions closest to the nominal ones of a row; `None` if a
    /// cable has no path or no tensions balance it.
    fn held(&self, truth: &Robot, row: usize, pose: Pose) -> Option<Visit> {
        let paths: Vec<_> = truth
            .cables
            .iter()
            .map(|cable| path(cable, &pose))
            .collect();
        if paths.iter().any(|path| !has_path(path)) {
            return None;
        }
        let tensions_n = match self.robot.has_tensions() {
            true => self.tensions_near(truth, row, (&pose, &paths))?,
            false => self.tensions[row].clone(),
        };
        Some(Visit {
            pose,
            paths,
            tensions_n,
        })
    }

    fn tensions_near(
        &self,
        truth: &Robot,
        row: usize,
        (pose, paths): (&Pose, &[CablePath<f64>]),
    ) -> Option<Vec<f64>> {
        let freedom = truth.platform.freedom();
        let coordinates = freedom.coordinates();
        let mut missing = Vector6::zeros();
        let wrench = applied_wrench(truth, pose).ok()?;
        (0..coordinates.len()).for_each(|k| missing[k] = wrench[k]);
        // A coordinate in which the platform cannot move is in equilibrium by itself.
        let mut gram = Matrix6::zeros();
        (coordinates.len()..6).for_each(|k| gram[(k, k)] = 1.0);
        let rows: Vec<Vector6<f64>> = (truth.cables.iter().zip(paths))
            .map(|(cable, path)| {
                let force = Vec3::from(path.toward_exit);
                let arm = pose.orientation * Vec3::from(cable.platform_anchor_m);
                let torque = arm.cross(&force);
                let whole = [force.x, force.y, force.z, torque.x, torque.y, torque.z];
                Vector6::from_fn(|k, _| coordinates.get(k).map_or(0.0, |c| whole[c.index()]))
            })
            .collect();
        let nominal = &self.tensions[row];
        for (row, tension) in rows.iter().zip(nominal) {
            gram += row * row.transpose();
            missing += row * *tension;
        }
        let correction = gram.cholesky()?.solve(&missing);
        let held = rows
            .iter()
            .zip(nominal)
            .map(|(row, t)| t - row.dot(&correction));
        let held: Vec<f64> = held.collect();
        let range = self.range.lower_n..=self.range.upper_n;
        if held.iter().all(|tension| range.contains(tension)) {
            return Some(held);
        }
        // At a limit, the smallest correction is that of the distribution.
        self.range.tensions(truth, pose).ok().flatten()
    }
}

fn path(cable: &Cable, pose: &Pose) -> CablePath<f64> {
    let pulley = PulleyGeometry {
        entry: cable.pulley.entry_point_m,
        axis: cable.pulley.swivel_axis,
        radius: cable.pulley.radius_m,
    };
    pulley.path_to(pose.transform(&cable.platform_anchor_m.into()).into())
}

/// Whether the anchor is outside the pulley and the cable leaves it towards the anchor; false for NaN.
fn has_path(path: &CablePath<f64>) -> bool {
    path.clearance > 0.0 && path.wrap >= 0.0 && path.inverse_axis_distance.is_finite()
}

/// Exact readings of lengths, distance and angles; forces and tracker readings are filled in already.
fn read(truth: &Robot, visits: &[Visit], data: &mut Measurements) -> Result<(), SimulationError> {
    let down = truth.gravity().try_normalize(0.0).unwrap_or_default();
    let mut at_home = None;
    for (row, visit) in visits.iter().enumerate() {
        let lengths = unstrained(truth, visit, down);
        let from = at_home.get_or_insert_with(|| lengths.clone());
        for (index, cable) in truth.cables.iter().enumerate() {
            let winch = &cable.winch;
            if !data.revolutions.is_empty() {
                let paid = lengths[index] - from[index];
                (data.revolutions).set(row, index, paid / winch.cable_per_revolution_m());
            }
            if !data.length_m.is_empty() {
                let length = lengths[index] - winch.length_to_pulley_m;
                data.length_m.set(row, index, length);
            }
        }
        if let (Some(laser), Some(reading)) = (&truth.laser, data.laser_m.get_mut(row)) {
            let normal = Vec3::from(laser.target_plane.normal);
            let towards = normal.dot(&(visit.pose.orientation * Vec3::from(laser.direction)));
            let origin = visit.pose.transform(&laser.origin_m.into());
            *reading = (laser.target_plane.offset_m - normal.dot(&origin)) / towards;
        }
        if let Some(angles) = data.inclination_rad.get_mut(row) {
            let r = visit.pose.orientation.to_rotation_matrix();
            let pitch = r[(0, 2)].atan2(r[(1, 2)].hypot(r[(2, 2)]));
            let roll = (-r[(1, 2)]).atan2(r[(2, 2)]);
            *angles = [roll, pitch, (-r[(0, 1)]).atan2(r[(0, 0)])];
        }
        if !data.swivel_rad.is_empty() {
            let states = inverse_kinematics(truth, &visit.pose)?;
            for (index, state) in states.iter().enumerate() {
                let angle = state.swivel_rad.unwrap_or(f64::NAN);
                data.swivel_rad.set(row, index, angle);
            }
        }
    }
    Ok(())
}

/// Unstrained length of every cable, including the run from the drum (m).
fn unstrained(truth: &Robot, visit: &Visit, down: Vec3) -> Vec<f64> {
    let cables = truth.cables.iter().zip(&visit.paths).zip(&visit.tensions_n);
    cables
        .map(|((cable, path), tension)| {
            let material = &cable.cable;
            let law = CableLaw {
                run: cable.winch.length_to_pulley_m,
                tension: *tension,
                compliance: material.axial_stiffness_n.map_or(0.0, f64::recip),
                strain: 0.0,
                weight: (material.weight_n_per_m != 0.0).then_some(material.weight_n_per_m),
                down: down.into(),
                surface: material.elongation_surface.as_ref(),
            };
            law.unstrained(path).length
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::super::inversion::invert_within;
    use super::super::simulate;
    use super::*;
    use crate::estimation::{Control, Options, Problem, solve};
    use crate::kinematics::equilibrium_residual;
    use crate::planning::{PlanOptions, random_poses};
    use crate::robot::{Inclinometer, presets};

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
            // Noise far below what is compared; none at all would divide by zero.
            for cable in &mut runs.robot.cables {
                cable.winch.length_sd_m = 1e-14;
                cable.force_sensor.as_mut().unwrap().tension_sd_n = 1e-12;
            }
            runs.robot.laser.as_mut().unwrap().sd_m = 1e-14;
            runs.robot.inclinometer = Some(Inclinometer { sd_rad: 1e-9 });
            let run = runs.simulate(&mut ChaCha8Rng::seed_from_u64(7)).unwrap();
            let truth = &run.dataset.measurements.truth;
            let mut exact = Dataset {
                robot: run.truth.clone(),
                measurements: run.dataset.measurements.clone(),
            };
            let directions = Grid::missing(truth.poses.len(), run.truth.cable_count());
            invert_within(
                12,
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
                let off = one.laser_m[row] - many.laser_m[row];
                assert!(off.abs() < 1e-12, "{name} {off}");
                for k in 0..3 {
                    let off = one.inclination_rad[row][k] - many.inclination_rad[row][k];
                    assert!(off.abs() < 1e-8, "{name} {off}");
                }
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
