//! Sound machines of the study, as data sets: planar ones of our own geometry, and the simulated robots of the other studies.

use anyhow::{Context, Result};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use tautline_core::geometry::{Coordinate, Pose};
use tautline_core::measurement::{Dataset, DistanceReading, Grid, Measurements};
use tautline_core::robot::{
    Cable, CableMaterial, PartTolerances, PerAxis, Platform, Pulley, Robot, Tracker, Winch,
};
use tautline_core::simulation::{SimulationOptions, simulate};

use crate::tables::hidden::robots::{TestRobot, robots};

/// Standard deviations of the lengths, the instrument and the places of the pulleys (m).
const LENGTHS_SD_M: [f64; 2] = [2e-4, 5e-4];
const INSTRUMENT_SD_M: [f64; 2] = [5e-4, 1e-3];
const PLACES_SD_M: [f64; 3] = [3e-3, 5e-3, 1e-2];
/// Number of distances between poses, where there are some, and standard deviation of the tape (m).
pub(super) const DISTANCES: usize = 20;
const TAPE_SD_M: f64 = 5e-4;
/// The platform stands where it was sent to, within so much (m).
const COMMANDS_SD_M: f64 = 2e-3;
/// Three of so many machines are planar.
const MACHINES: u64 = 5;

/// Noise of a rough machine in that stated, and amplitude of a smooth error of its lengths in standard deviations.
const ROUGH_NOISE: f64 = 1.5;
const SMOOTH_ERROR: f64 = 2.0;

/// The sound machine of a seed; every second simulated one is exact, the parts of the others are within typical tolerances. The noise of a
/// rough machine is larger than stated, and its lengths have a smooth error that no cause describes.
///
/// # Errors
/// If a robot cannot be simulated.
pub fn sound(seed: u64, is_rough: bool, rng: &mut impl Rng) -> Result<Dataset> {
    match seed % MACHINES {
        0 => Ok(plotter(is_rough, rng)),
        1 | 2 => Ok(four_belts(is_rough, rng)),
        _ => simulated(seed, is_rough, rng),
    }
}

fn simulated(seed: u64, is_rough: bool, rng: &mut impl Rng) -> Result<Dataset> {
    let all = robots();
    let TestRobot { preset, poses, .. } = &all[rng.random_range(0..all.len())];
    let mut robot = preset.robot.clone();
    robot.tolerances = rng.random_bool(0.5).then(PartTolerances::typical);
    let options = SimulationOptions {
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..SimulationOptions::new(*poses, seed)
    };
    let run = simulate(&robot, &options).context("a sound machine")?;
    let mut dataset = run.dataset;
    for cable in 0..dataset.robot.cable_count() {
        if is_rough {
            roughen(&mut dataset, cable, rng);
        }
    }
    Ok(dataset)
}

/// Adds noise and a smooth error to the readings of a cable, but those at home.
fn roughen(dataset: &mut Dataset, cable: usize, rng: &mut impl Rng) {
    let smooth = Smooth::random(rng);
    let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
    wind(dataset, cable, |_, length| {
        (low, high) = (low.min(length), high.max(length));
        length
    });
    let sd_m = dataset.robot.cables[cable].winch.length_sd_m;
    let more = (ROUGH_NOISE * ROUGH_NOISE - 1.0).sqrt();
    let home = dataset.measurements.home_row();
    wind(dataset, cable, |row, length| {
        if Some(row) == home {
            return length;
        }
        let at = [(length - low) / (high - low), 0.0];
        length + sd_m * (smooth.at(at) + more * normal(rng))
    });
}

/// Adds distances between true places, at random; `read` is the reading of a tape for a distance with this number.
pub(super) fn tape(
    dataset: &mut Dataset,
    rng: &mut impl Rng,
    mut read: impl FnMut(usize, f64) -> f64,
) {
    let data = &mut dataset.measurements;
    for number in 1..=DISTANCES {
        let first = rng.random_range(1..data.len());
        let rows = [rng.random_range(0..first), first];
        let [a, b] = rows.map(|row| data.truth.poses[row].position);
        data.distances.push(DistanceReading {
            number,
            rows,
            point_m: [0.0; 3],
            distance_m: read(number, (a - b).norm()) + TAPE_SD_M * normal(rng),
            sd_m: TAPE_SD_M,
        });
    }
}

/// Changes the readings of a winch as lengths (m), which are absolute or count from home.
pub(super) fn wind(dataset: &mut Dataset, cable: usize, mut change: impl FnMut(usize, f64) -> f64) {
    let data = &mut dataset.measurements;
    let (grid, unit_m) = if data.revolutions.is_empty() {
        (&mut data.length_m, 1.0)
    } else {
        let winch = &dataset.robot.cables[cable].winch;
        (&mut data.revolutions, winch.cable_per_revolution_m())
    };
    for row in 0..grid.rows() {
        let value = unit_m * grid.get(row, cable);
        grid.set(row, cable, change(row, value) / unit_m);
    }
}

fn plotter(is_rough: bool, rng: &mut impl Rng) -> Dataset {
    let width_m = rng.random_range(1.0..6.0);
    let height_m = width_m * rng.random_range(0.5..0.9);
    let places = [[-0.5, 0.5], [0.5, 0.5]].map(|[x, y]| [x * width_m, y * height_m]);
    let centre = [0.0, -0.05 * height_m];
    let half = [0.35 * width_m, 0.3 * height_m];
    planar(&places, (centre, half), (true, is_rough), rng)
}

fn four_belts(is_rough: bool, rng: &mut impl Rng) -> Dataset {
    let width_m = rng.random_range(1.5..8.0);
    let height_m = width_m * rng.random_range(0.5..0.9);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let places = corners.map(|corner: [f64; 2]| {
        let [x, y] = corner.map(|share| share + 0.02 * normal(rng));
        [x * width_m, y * height_m]
    });
    let half = [0.33 * width_m, 0.33 * height_m];
    let is_tracked = rng.random_bool(0.5);
    let centre = [0.5 * width_m, 0.5 * height_m];
    planar(&places, (centre, half), (is_tracked, is_rough), rng)
}

/// A smooth error over the place, in standard deviations of a length.
struct Smooth {
    waves: [f64; 2],
    phase: f64,
}

impl Smooth {
    fn random(rng: &mut impl Rng) -> Self {
        Self {
            waves: [0, 1].map(|_| rng.random_range(1.0..3.0)),
            phase: rng.random_range(0.0..std::f64::consts::TAU),
        }
    }

    fn at(&self, [x, y]: [f64; 2]) -> f64 {
        SMOOTH_ERROR * (self.waves[0] * x + self.waves[1] * y + self.phase).sin()
    }
}

fn normal(rng: &mut impl Rng) -> f64 {
    StandardNormal.sample(rng)
}

fn chosen(rng: &mut impl Rng, values: &[f64]) -> f64 {
    values[rng.random_range(0..values.len())]
}

/// A pen in a vertical plane of x and y on cables from fixed points, whose lengths are read as such.
fn planar(
    places: &[[f64; 2]],
    (centre, half): ([f64; 2], [f64; 2]),
    (is_tracked, is_rough): (bool, bool),
    rng: &mut impl Rng,
) -> Dataset {
    let poses = rng.random_range(24..42_usize);
    let length_sd_m = chosen(rng, &LENGTHS_SD_M);
    let instrument_sd_m = chosen(rng, &INSTRUMENT_SD_M);
    let places_sd_m = chosen(rng, &PLACES_SD_M);
    let side = (poses as f64).sqrt().ceil() as usize;
    let share = |step: usize| 2.0 * step as f64 / (side - 1) as f64 - 1.0;
    let commanded = (0..poses).map(|k| [share(k % side), share(k / side)]);
    let commanded: Vec<[f64; 2]> = commanded
        .map(|at| [0, 1].map(|axis| centre[axis] + half[axis] * at[axis]))
        .collect();
    let noise = if is_rough { ROUGH_NOISE } else { 1.0 };
    let smooth: Vec<Smooth> = places.iter().map(|_| Smooth::random(rng)).collect();
    let mut around = |at: &[f64; 2], sd_m: f64| at.map(|value| value + sd_m * normal(rng));
    let pulleys: Vec<[f64; 2]> = places.iter().map(|at| around(at, places_sd_m)).collect();
    let mut measurements = Measurements {
        length_m: Grid::new(places.len()),
        ..Measurements::default()
    };
    for (row, command) in commanded.iter().enumerate() {
        let at = around(command, COMMANDS_SD_M);
        let lengths = pulleys.iter().map(|[x, y]| (x - at[0]).hypot(y - at[1]));
        let lengths: Vec<f64> = lengths.collect();
        let place = [0, 1].map(|axis| (command[axis] - centre[axis]) / half[axis]);
        let read = lengths.iter().zip(&smooth).map(|(length, smooth)| {
            let error = if is_rough { smooth.at(place) } else { 0.0 };
            around(&[length + length_sd_m * error; 2], noise * length_sd_m)[0]
        });
        let read: Vec<f64> = read.collect();
        measurements.length_m.push_row(&read);
        let truth = Pose::from_parts([at[0], at[1], 0.0], [1.0, 0.0, 0.0, 0.0]);
        measurements.truth.poses.push(truth);
        measurements.labels.push(row as i64 + 1);
        let [x, y] = *command;
        let pose = Pose::from_parts([x, y, 0.0], [1.0, 0.0, 0.0, 0.0]);
        measurements.commanded.push(Some(pose));
        if is_tracked {
            let [x, y] = around(&at, noise * instrument_sd_m);
            measurements.tracked_position_m.push([x, y, f64::NAN]);
        }
    }
    let cable = |(index, [x, y]): (usize, &[f64; 2])| Cable {
        name: format!("belt-{}", index + 1),
        pulley: Pulley {
            entry_point_sd_m: PerAxis::known(places_sd_m),
            ..Pulley::new([*x, *y, 0.0], [0.0, 0.0, 1.0], 0.0)
        },
        platform_anchor_m: [0.0; 3],
        winch: Winch {
            drum_diameter_m: 0.05,
            drum_pitch_m: 0.0,
            gear_ratio: 1.0,
            length_to_pulley_m: 0.0,
            length_sd_m,
        },
        cable: CableMaterial {
            axial_stiffness_n: None,
            weight_n_per_m: 0.0,
            elongation_surface: None,
        },
        force_sensor: None,
    };
    let [along_x, along_y, ..] = Coordinate::ALL;
    let platform = Platform {
        free: vec![along_x, along_y],
        ..Platform::spatial(None)
    };
    let cables = places.iter().enumerate().map(cable).collect();
    let mut robot = Robot::new("planar".to_owned(), platform, cables);
    robot.gravity_m_s2 = [0.0, -9.80665, 0.0];
    robot.tracker = is_tracked.then_some(Tracker {
        position_sd_m: PerAxis::Same(instrument_sd_m),
        orientation_sd_rad: None,
    });
    Dataset {
        robot,
        measurements,
    }
}
