//! Simulated calibration tables, as measured by an operator on a workbench.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use tautline_core::effect::EffectSetting;
use tautline_core::geometry::Pose;
use tautline_core::robot::{ForceSensor, FrameTransform, HomePlatform, HomeSensor, Plane, Robot};
use tautline_session::{ElongationPoint, ForcePair, HomeReading, PhaseData, WinchPair};

/// Noise of the calliper on the cable paid out (m).
const WINCH_SD_M: f64 = 3e-5;
/// Noise of a force sensor reading on the bench (N).
const FORCE_SD_N: f64 = 0.15;
/// Noise of the elongation bench (m).
const ELONGATION_SD_M: f64 = 2e-5;
/// Noise of the sensors of the home platform (m).
const HOME_SD_M: f64 = 1e-4;
/// Number of readings of each of these sensors.
const HOME_REPEATS: usize = 8;

fn normal(rng: &mut ChaCha8Rng, sd: f64) -> f64 {
    sd * rng.sample::<f64, _>(StandardNormal)
}

/// Tables of a robot before any fault: its winches and force sensors deviate from the description within their tolerances.
/// The platform of the home reading is at `home`.
pub fn bench(
    robot: &Robot,
    (deviations, home): (&[EffectSetting], &Pose),
    rng: &mut ChaCha8Rng,
) -> PhaseData {
    PhaseData {
        winch: winches(robot, deviations, rng),
        force: forces(robot, deviations, rng),
        home: home_readings(robot, home, rng),
        elongation: elongation(robot, rng),
        ..PhaseData::default()
    }
}

fn deviation(deviations: &[EffectSetting], (effect, parameter): (&str, &str), cable: &str) -> f64 {
    let is_it = |one: &&EffectSetting| {
        one.effect == effect && one.targets.iter().any(|target| target == cable)
    };
    let values = deviations.iter().filter(is_it);
    values.filter_map(|one| one.parameters.get(parameter)).sum()
}

fn winches(robot: &Robot, deviations: &[EffectSetting], rng: &mut ChaCha8Rng) -> Vec<WinchPair> {
    let mut pairs = Vec::new();
    for (cable, description) in robot.cables.iter().enumerate() {
        let scale = deviation(deviations, ("winch_scale", "scale"), &description.name);
        for step in 0..=12 {
            let revolutions = f64::from(step) * 0.5;
            let exact = revolutions * description.winch.cable_per_revolution_m() * (1.0 + scale);
            let length_m = exact + normal(rng, WINCH_SD_M);
            pairs.push(WinchPair {
                cable,
                revolutions,
                length_m,
                tension_n: None,
            });
        }
    }
    pairs
}

fn forces(robot: &Robot, deviations: &[EffectSetting], rng: &mut ChaCha8Rng) -> Vec<ForcePair> {
    let mut pairs = Vec::new();
    for (cable, description) in robot.cables.iter().enumerate() {
        let Some(sensor) = description.force_sensor else {
            continue;
        };
        let of = |effect| deviation(deviations, effect, &description.name);
        let sensor = ForceSensor {
            tension_gain: sensor.tension_gain * (1.0 + of(("force_gain", "change"))),
            bias_n: sensor.bias_n + of(("force_bias", "bias")),
            ..sensor
        };
        for step in 0..=8 {
            let load_n = f64::from(step) * 10.0;
            let reading_n = sensor.reading_n(load_n) + normal(rng, FORCE_SD_N);
            pairs.push(ForcePair {
                cable,
                reading_n,
                load_n,
            });
        }
    }
    pairs
}

fn elongation(robot: &Robot, rng: &mut ChaCha8Rng) -> Vec<ElongationPoint> {
    let stiffness = robot
        .cables
        .iter()
        .find_map(|cable| cable.cable.axial_stiffness_n);
    let Some(stiffness_n) = stiffness else {
        return Vec::new();
    };
    let mut points = Vec::new();
    for length_m in (0..8).map(|k| 0.1 + 0.25 * f64::from(k)) {
        for tension_n in (0..9).map(|k| 2.0 + 21.0 * f64::from(k)) {
            let elongation_m = length_m * tension_n / stiffness_n + normal(rng, ELONGATION_SD_M);
            points.push(ElongationPoint {
                length_m,
                tension_n,
                elongation_m,
            });
        }
    }
    points
}

/// Six sensors around the platform of MINI: three from below, two from the front, one from the side.
pub fn home_platform() -> HomePlatform {
    let sensor = |origin_m, direction, plane| HomeSensor {
        origin_m,
        direction,
        plane,
        sd_m: HOME_SD_M,
        curve: None,
    };
    let (up, along_y, along_x) = ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]);
    HomePlatform {
        base_from_reference: FrameTransform {
            position_m: [0.0, 0.0, -0.25],
            orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
        },
        sensors: vec![
            sensor([-0.04, -0.03, 0.05], up, 0),
            sensor([0.04, -0.03, 0.05], up, 0),
            sensor([0.0, 0.03, 0.05], up, 0),
            sensor([-0.04, -0.2, 0.25], along_y, 1),
            sensor([0.04, -0.2, 0.25], along_y, 1),
            sensor([-0.2, 0.0, 0.25], along_x, 2),
        ],
        planes: vec![
            Plane {
                normal: up,
                offset_m: -0.05,
            },
            Plane {
                normal: along_y,
                offset_m: -0.045,
            },
            Plane {
                normal: along_x,
                offset_m: -0.06,
            },
        ],
    }
}

/// Distances that the sensors read with the platform at `home` (base frame).
fn home_readings(robot: &Robot, home: &Pose, rng: &mut ChaCha8Rng) -> Vec<HomeReading> {
    let Some(platform) = &robot.home_platform else {
        return Vec::new();
    };
    let base_from_reference = platform.base_from_reference.pose();
    let reference_from_base = base_from_reference.orientation.inverse();
    let position = reference_from_base * (home.position - base_from_reference.position);
    let rotation = reference_from_base * home.orientation;
    let mut readings = Vec::new();
    for _ in 0..HOME_REPEATS {
        for (index, sensor) in platform.sensors.iter().enumerate() {
            let plane = &platform.planes[sensor.plane];
            let normal_in_reference = rotation * nalgebra::Vector3::from(plane.normal);
            let to_plane = plane.offset_m
                + normal_in_reference.dot(&(position - nalgebra::Vector3::from(sensor.origin_m)));
            let distance =
                to_plane / normal_in_reference.dot(&nalgebra::Vector3::from(sensor.direction));
            readings.push(HomeReading {
                sensor: index,
                reading: distance + normal(rng, sensor.sd_m),
            });
        }
    }
    readings
}
