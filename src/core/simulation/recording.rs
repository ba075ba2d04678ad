//! Simulated recording of a robot in motion: latencies and clock errors by reading it at other times, noise correlated from
//! sample to sample, and tensions that accelerate the platform.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::holding_tensions::{Epoch, Schedule, Visit, ambient_temperature_c, holding_tensions};
use super::inversion::invert_within;
use super::readings::{blank, normal, true_directions};
use super::trajectory::Trajectory;
use super::virtual_robot::{Simulated, SimulationError, SimulationOptions, bind, draw_truth};
use super::workspace::{TensionRange, Workspace};
use crate::effect::{BoundEffect, Delays};
use crate::geometry::{Pose, Twist};
use crate::kinematics::structure_matrix;
use crate::measurement::{Dataset, Grid, Measurements, Rates};
use crate::robot::Robot;

/// Largest number of inversion steps: a nanometre suffices for readings that are noisy and late.
const MAX_STEPS: usize = 40;
/// Factor by which a motion is reduced until the cables can hold the platform everywhere, and the number of attempts.
const SMALLER: f64 = 0.85;
const TRIES: usize = 12;

/// Parameters of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recording {
    /// Duration (s).
    pub duration_s: f64,
    /// Sampling rate (1/s).
    pub rate_hz: f64,
    /// Time in which the correlation of the noise falls to 1/e (s); 0: the noise of the samples is independent.
    pub correlation_s: f64,
}

/// Simulates a recording of a robot that moves smoothly through its workspace, from its home pose if it has one. The number
/// of poses in the options is ignored.
///
/// # Errors
/// If the robot cannot be held along its path, or an effect is unknown.
pub fn record(
    robot: &Robot,
    options: &SimulationOptions,
    recording: &Recording,
) -> Result<Simulated, SimulationError> {
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let truth = draw_truth(robot, options, &mut rng);
    let effects = bind(&truth)?;
    let count = (recording.duration_s * recording.rate_hz).round() as usize + 1;
    let times: Vec<f64> = (0..count).map(|k| k as f64 / recording.rate_hz).collect();
    let (late, prompt): (Vec<_>, Vec<_>) = effects.iter().cloned().partition(is_late);
    let mut prompt_truth = truth.clone();
    prompt_truth.deviations.clear();
    prompt_truth.effects = prompt.iter().map(|bound| bound.setting(&truth)).collect();
    let workspace = options.workspace.unwrap_or_else(|| Workspace::of(robot));
    let mut moving = Moving {
        robot,
        truth: &prompt_truth,
        effects: &prompt,
        range: options.tension.unwrap_or_else(|| TensionRange::of(robot)),
        start: truth.home.map_or(workspace.centre, |home| home.pose()),
        trajectory: Trajectory::draw(&workspace, robot.platform.freedom(), &mut rng),
    };
    let mut data = None;
    for _ in 0..TRIES {
        data = moving.readings(&times)?;
        if data.is_some() {
            break;
        }
        moving.trajectory = moving.trajectory.scaled(SMALLER);
    }
    let mut data =
        data.ok_or_else(|| SimulationError::infeasible(&moving.range, "the poses on its path"))?;
    moving.delay(&mut data, &late, &times)?;
    if options.noise {
        let noise = CorrelatedNoise {
            rho: match recording.correlation_s > 0.0 {
                true => (-1.0 / (recording.rate_hz * recording.correlation_s)).exp(),
                false => 0.0,
            },
        };
        noise.add(robot, &mut data, &mut rng);
    }
    for effect in &effects {
        effect.exchange_channels(&mut data);
    }
    Ok(Simulated {
        dataset: Dataset {
            robot: robot.clone(),
            measurements: data,
        },
        truth,
    })
}

/// Whether an effect delays readings, judged at a time of 1 s.
fn is_late(bound: &BoundEffect) -> bool {
    delays_at(std::slice::from_ref(bound), 1.0) != Delays::default()
}

fn delays_at(effects: &[BoundEffect], time_s: f64) -> Delays {
    let mut delays = Delays::default();
    for bound in effects {
        (bound.effect.delays)(&bound.values, time_s, &mut delays);
    }
    delays
}

/// A robot on its path.
struct Moving<'r> {
    robot: &'r Robot,
    truth: &'r Robot,
    effects: &'r [BoundEffect],
    range: TensionRange,
    start: Pose,
    trajectory: Trajectory,
}

impl Moving<'_> {
    /// Exact readings at given times (s); `None` if the platform cannot be held.
    fn readings(&self, times_s: &[f64]) -> Result<Option<Measurements>, SimulationError> {
        let poses: Vec<Pose> = times_s
            .iter()
            .map(|time| self.trajectory.pose(&self.start, *time))
            .collect();
        let first_label = i64::from(self.robot.home.is_none());
        let mut tensions = Grid::new(self.robot.cable_count());
        let mut rates = Grid::new(self.robot.cable_count());
        let epoch = |row: usize| Epoch {
            label: first_label + row as i64,
            time_s: times_s[row],
            temperature_c: ambient_temperature_c(times_s[row]),
        };
        for (row, pose) in poses.iter().enumerate() {
            let motion = self.trajectory.twists(&self.start, times_s[row]);
            let visit = Visit {
                first: (row > 0).then(|| (epoch(0), &poses[0])),
                epoch: epoch(row),
                pose,
                motion,
            };
            let held = holding_tensions(self.truth, self.effects, &visit, &self.range)?;
            let Some(held) = held else {
                return Ok(None);
            };
            tensions.push_row(&held);
            rates.push_row(&self.length_rates(pose, &motion[0])?);
        }
        let nominal = self.robot.home.map_or(self.start, |home| home.pose());
        let commanded: Vec<Pose> = times_s
            .iter()
            .map(|time| self.trajectory.pose(&nominal, *time))
            .collect();
        let schedule = Schedule {
            labels: (0..poses.len()).map(|row| epoch(row).label).collect(),
            time_s: times_s.to_vec(),
            temperature_c: (0..poses.len())
                .map(|row| epoch(row).temperature_c)
                .collect(),
        };
        let mut exact = Dataset {
            robot: self.truth.clone(),
            measurements: blank(self.robot, schedule, (&poses, &commanded), &tensions),
        };
        if self.effects.iter().any(|bound| bound.effect.is_in_motion()) {
            let none = Grid::missing(poses.len(), self.robot.cable_count());
            exact.measurements.rates = Some(Rates {
                length: [rates, none],
                ..Rates::default()
            });
        }
        let directions = true_directions(self.truth, &poses)?;
        invert_within(MAX_STEPS, &mut exact, (&poses, &tensions), &directions)?;
        exact.measurements.rates = None;
        Ok(Some(exact.measurements))
    }

    /// Rates of the length readings for a velocity of the platform: `-A v`, in revolutions where those are read.
    fn length_rates(&self, pose: &Pose, velocity: &Twist) -> Result<Vec<f64>, SimulationError> {
        let freedom = self.truth.platform.freedom();
        let free = freedom.coordinates().iter().map(|c| velocity[c.index()]);
        let free = nalgebra::DVector::from_iterator(freedom.count(), free);
        let rates = structure_matrix(self.truth, pose)? * -free;
        let cables = self.truth.cables.iter().zip(rates.iter());
        let per_reading = |cable: &crate::robot::Cable| match self.robot.home {
            Some(_) => cable.winch.cable_per_revolution_m(),
            None => 1.0,
        };
        Ok(cables
            .map(|(cable, rate)| rate / per_reading(cable))
            .collect())
    }

    /// Replaces the readings of each device by those at the time when it actually read.
    fn delay(
        &self,
        data: &mut Measurements,
        late: &[BoundEffect],
        times_s: &[f64],
    ) -> Result<(), SimulationError> {
        type Choose = fn(&Delays) -> f64;
        type Take = fn(&mut Measurements, Measurements);
        let devices: [(Choose, Take); 4] = [
            (
                |d| d.length,
                |to, from| {
                    to.revolutions = from.revolutions;
                    to.length_m = from.length_m;
                },
            ),
            (|d| d.force, |to, from| to.force_n = from.force_n),
            (|d| d.laser, |to, from| to.laser_m = from.laser_m),
            (
                |d| d.tracker,
                |to, from| {
                    to.tracked_position_m = from.tracked_position_m;
                    to.tracked_orientation_wxyz = from.tracked_orientation_wxyz;
                },
            ),
        ];
        for (choose, take) in devices {
            let delays = times_s.iter().map(|time| choose(&delays_at(late, *time)));
            let seen: Vec<f64> = times_s.iter().zip(delays).map(|(t, d)| t - d).collect();
            if seen != times_s {
                let readings = self.readings(&seen)?;
                let failed = || SimulationError::infeasible(&self.range, "the poses on its path");
                take(data, readings.ok_or_else(failed)?);
            }
        }
        Ok(())
    }
}

/// Autoregressive noise: each sample keeps a fraction of the previous one.
struct CorrelatedNoise {
    /// Correlation of neighbouring samples.
    rho: f64,
}

impl CorrelatedNoise {
    /// A series of noise with a standard deviation `sd`.
    fn series(&self, rng: &mut ChaCha8Rng, sd: f64, count: usize) -> Vec<f64> {
        let mut state = normal(rng, sd);
        let fresh = sd * (1.0 - self.rho * self.rho).sqrt();
        let mut next = |_| {
            let value = state;
            state = self.rho * state + normal(rng, fresh);
            value
        };
        (0..count).map(&mut next).collect()
    }

    fn add(&self, robot: &Robot, data: &mut Measurements, rng: &mut ChaCha8Rng) {
        let count = data.len();
        let home = robot.home.and(data.home_row());
        for (index, cable) in robot.cables.iter().enumerate() {
            let mut add = |grid: &mut Grid, sd: f64, but: Option<usize>| {
                let noise = self.series(rng, sd, count);
                for row in (0..grid.rows()).filter(|row| Some(*row) != but) {
                    grid.set(row, index, grid.get(row, index) + noise[row]);
                }
            };
            let sd = cable.winch.length_sd_m;
            let turns = sd / cable.winch.cable_per_revolution_m();
            add(&mut data.revolutions, turns, home);
            add(&mut data.length_m, sd, None);
            if let Some(sensor) = cable.force_sensor {
                let sd = sensor.tension_gain.abs() * sensor.tension_sd_n;
                add(&mut data.force_n, sd, None);
            }
            add(
                &mut data.swivel_rad,
                cable.pulley.swivel_sd_rad.unwrap_or(0.0),
                None,
            );
        }
        if let Some(laser) = &robot.laser {
            let noise = self.series(rng, laser.sd_m, count);
            data.laser_m
                .iter_mut()
                .zip(noise)
                .for_each(|(d, e)| *d += e);
        }
        for k in 0..3 {
            if let Some(sensor) = &robot.inclinometer {
                let noise = self.series(rng, sensor.sd_rad, count);
                data.inclination_rad
                    .iter_mut()
                    .zip(noise)
                    .for_each(|(a, e)| a[k] += e);
            }
            if let Some(tracker) = &robot.tracker {
                let noise = self.series(rng, tracker.position_sd_m.each()[k], count);
                data.tracked_position_m
                    .iter_mut()
                    .zip(noise)
                    .for_each(|(p, e)| p[k] += e);
                let sd = tracker.orientation_sd_rad.unwrap_or(0.0);
                let noise = self.series(rng, sd, count);
                for (q, e) in data.tracked_orientation_wxyz.iter_mut().zip(noise) {
                    let mut turn = Twist::zeros();
                    turn[3 + k] = e;
                    *q = Pose::from_parts([0.0; 3], *q)
                        .perturbed(&turn)
                        .orientation_wxyz();
                }
            }
        }
    }
}
