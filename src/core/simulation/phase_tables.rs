//! Simulated calibration tables of phases 1 and 2.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::readings::normal;
use super::virtual_robot::perturbed;
use crate::cable::ElongationTriple;
use crate::geometry::{Pose, Twist, Vec3};
use crate::instrument::{ForcePair, WinchPair};
use crate::robot::{FrameTransform, HomePlatform, HomeSensor, Plane, Robot, Tracker};

/// Drum revolutions at which a winch is read, in each direction.
const WINCH_TURNS: [f64; 7] = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0];
/// Standard deviation of the reference length with which a winch is compared (m).
const WINCH_SD_M: f64 = 2e-5;
/// Loads hung from a force sensor (N).
const LOADS_N: [f64; 6] = [5.0, 10.0, 20.0, 40.0, 60.0, 80.0];
/// Standard deviation of an elongation (m).
const ELONGATION_SD_M: f64 = 5e-6;
/// Standard deviation of a position that is approached again (m): a controller returns to the same lengths.
const REPEATED_SD_M: f64 = 5e-5;
/// Number of readings of each sensor of the home platform.
const HOME_REPEATS: usize = 5;

/// Calibration tables, with cables by index.
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseTables {
    /// Winch readings, each with the index of its cable.
    pub winch: Vec<(usize, WinchPair)>,
    /// Force sensor readings, each with the index of its cable.
    pub force: Vec<(usize, ForcePair)>,
    /// The home platform, and its readings (m) with the index of the sensor; `None` if the robot has no home pose.
    pub home: Option<(HomePlatform, Vec<(usize, f64)>)>,
    /// Elongations of the first elastic cable.
    pub elongation: Vec<ElongationTriple>,
}

/// Simulates the tables of the robot `truth`, which is described as `robot`. Only those of its effects show that change the
/// ratio of winches or the gain and bias of force sensors; the others act on poses. Without `noise` the readings are exact.
#[must_use]
pub fn phase_tables(robot: &Robot, truth: &Robot, seed: u64, noise: bool) -> PhaseTables {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut error = |sd: f64| if noise { normal(&mut rng, sd) } else { 0.0 };
    let mut tables = PhaseTables {
        winch: Vec::new(),
        force: Vec::new(),
        home: None,
        elongation: Vec::new(),
    };
    for (index, cable) in truth.cables.iter().enumerate() {
        let of = |effect: &str, parameter: &str| effect_on(truth, &cable.name, effect, parameter);
        let scale = (1.0 + of("winch_scale", "scale")) * (1.0 + of("winch_scale_common", "scale"));
        for turns in WINCH_TURNS {
            let revolutions = turns * cable.winch.gear_ratio;
            let length_m =
                cable.winch.cable_per_revolution_m() * scale * revolutions + error(WINCH_SD_M);
            tables.winch.push((
                index,
                WinchPair {
                    revolutions,
                    length_m,
                    tension_n: None,
                },
            ));
        }
        let Some(sensor) = cable.force_sensor else {
            continue;
        };
        for load_n in LOADS_N {
            let gain = sensor.tension_gain * (1.0 + of("force_gain", "change"));
            let bias = sensor.bias_n + of("force_bias", "bias");
            let reading_n =
                gain * load_n + bias + error(0.1 * sensor.tension_gain.abs() * sensor.tension_sd_n);
            tables.force.push((index, ForcePair { reading_n, load_n }));
        }
    }
    if let Some(stiffness_n) = truth
        .cables
        .iter()
        .find_map(|cable| cable.cable.axial_stiffness_n)
    {
        for length_m in [1.0, 1.5, 2.0, 2.5, 3.0, 3.5] {
            for tension_n in LOADS_N {
                let elongation_m = length_m * tension_n / stiffness_n + error(ELONGATION_SD_M);
                tables.elongation.push(ElongationTriple {
                    length_m,
                    tension_n,
                    elongation_m,
                });
            }
        }
    }
    if let Some(home) = truth.home {
        // The sensors are placed around the described home pose; the true platform is elsewhere.
        let described = robot.home.unwrap_or(home).pose();
        let platform = robot
            .home_platform
            .clone()
            .unwrap_or_else(|| home_platform(robot, &described));
        let readings = (0..HOME_REPEATS).flat_map(|_| {
            distances(&platform, &home.pose())
                .into_iter()
                .enumerate()
                .collect::<Vec<_>>()
        });
        let readings: Vec<(usize, f64)> = readings
            .map(|(sensor, distance)| (sensor, distance + error(platform.sensors[sensor].sd_m)))
            .collect();
        tables.home = Some((platform, readings));
    }
    tables
}

/// Poses that an external instrument measures where a platform is brought to each of these true poses again and again: the
/// targets in order, `cycles` times. Without `noise` each is attained and measured exactly.
#[must_use]
pub fn approaches(
    robot: &Robot,
    (targets, cycles): (&[Pose], usize),
    instrument: &Tracker,
    seed: u64,
    noise: bool,
) -> Vec<Pose> {
    if !noise {
        return (0..cycles).flat_map(|_| targets.iter().copied()).collect();
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let sd_m = instrument.position_sd_m.each();
    let sd_rad = instrument.orientation_sd_rad.unwrap_or(0.0);
    let mut measured = Vec::with_capacity(cycles * targets.len());
    for target in (0..cycles).flat_map(|_| targets) {
        let attained = perturbed(robot, target, REPEATED_SD_M, &mut rng);
        let error = Twist::from_fn(|k, _| match sd_m.get(k) {
            Some(sd) => normal(&mut rng, *sd),
            None => normal(&mut rng, sd_rad),
        });
        measured.push(attained.perturbed(&error));
    }
    measured
}

/// Sum of a parameter over the settings of an effect that apply to a cable.
fn effect_on(robot: &Robot, cable: &str, effect: &str, parameter: &str) -> f64 {
    let settings = robot.effects_and_deviations().filter(|setting| {
        setting.effect == effect
            && (setting.targets.is_empty() || setting.targets.iter().any(|target| target == cable))
    });
    settings
        .filter_map(|setting| setting.parameters.get(parameter))
        .sum()
}

/// Six sensors around the platform at home: three look up, two along x and one along y, 0.1 m from its faces.
fn home_platform(robot: &Robot, home: &Pose) -> HomePlatform {
    let size = robot
        .cables
        .iter()
        .map(|cable| Vec3::from(cable.platform_anchor_m).norm())
        .fold(0.05, f64::max);
    let away = size + 0.1;
    let sensor = |origin_m: [f64; 3], direction: [f64; 3], plane: usize| HomeSensor {
        origin_m,
        direction,
        plane,
        sd_m: 2e-4,
        curve: None,
    };
    let plane = |normal: [f64; 3]| Plane {
        normal,
        offset_m: size,
    };
    let (x, y, up) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    HomePlatform {
        base_from_reference: FrameTransform {
            position_m: home.position.into(),
            orientation_wxyz: home.orientation_wxyz(),
        },
        sensors: vec![
            sensor([0.5 * size, 0.4 * size, -away], up, 0),
            sensor([-0.5 * size, 0.4 * size, -away], up, 0),
            sensor([0.0, -0.6 * size, -away], up, 0),
            sensor([-away, 0.5 * size, 0.0], x, 1),
            sensor([-away, -0.5 * size, 0.0], x, 1),
            sensor([0.1 * size, -away, 0.0], y, 2),
        ],
        planes: vec![
            plane([0.0, 0.0, -1.0]),
            plane([-1.0, 0.0, 0.0]),
            plane([0.0, -1.0, 0.0]),
        ],
    }
}

/// Distances that the sensors read at a pose of the platform in the base frame, `(h + N.(r - o)) / (N.q)`; volts for
/// a sensor with a curve, by its inverse.
fn distances(home: &HomePlatform, pose: &Pose) -> Vec<f64> {
    let reference = home.base_from_reference.pose();
    let turn = reference.orientation.inverse() * pose.orientation;
    let place = reference.orientation.inverse() * (pose.position - reference.position);
    let distance = |sensor: &HomeSensor| {
        let plane = &home.planes[sensor.plane];
        let normal = turn * Vec3::from(plane.normal);
        let away = plane.offset_m + normal.dot(&(place - Vec3::from(sensor.origin_m)));
        let distance = away / normal.dot(&Vec3::from(sensor.direction));
        sensor.curve.map_or(distance, |curve| {
            (1.0 / (distance - curve.c) - curve.b) / curve.a
        })
    };
    home.sensors.iter().map(distance).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::EffectSetting;
    use crate::instrument::{calibrate_force_sensor, calibrate_winch, locate_platform};
    use crate::robot::{PerAxis, presets};

    fn truth() -> Robot {
        let mut robot = presets::find("mini").expect("a preset").robot;
        let setting = |effect: &str, parameter: &str, value: f64| EffectSetting {
            effect: effect.into(),
            targets: vec!["cable-3".into()],
            parameters: [(parameter.to_owned(), value)].into(),
        };
        robot.effects = vec![
            setting("winch_scale", "scale", 0.01),
            setting("force_gain", "change", 0.05),
        ];
        if let Some(home) = &mut robot.home {
            home.position_m = [0.001, -0.002, 0.0005];
        }
        robot
    }

    #[test]
    fn exact_tables_give_back_the_robot() {
        let robot = truth();
        let tables = phase_tables(&robot, &robot, 1, false);
        for (index, cable) in robot.cables.iter().enumerate() {
            let winch: Vec<WinchPair> = tables
                .winch
                .iter()
                .filter(|(of, _)| *of == index)
                .map(|(_, pair)| *pair)
                .collect();
            let scale = if index == 2 { 1.01 } else { 1.0 };
            let found = calibrate_winch(&winch)
                .expect("a fit")
                .cable_per_revolution_m;
            assert!((found - cable.winch.cable_per_revolution_m() * scale).abs() < 1e-12);
            let force: Vec<ForcePair> = tables
                .force
                .iter()
                .filter(|(of, _)| *of == index)
                .map(|(_, pair)| *pair)
                .collect();
            let gain = cable.force_sensor.expect("a sensor").tension_gain
                * if index == 2 { 1.05 } else { 1.0 };
            assert!((calibrate_force_sensor(&force).expect("a fit").gain - gain).abs() < 1e-9);
        }
    }

    #[test]
    fn the_home_platform_is_found_where_it_stands() {
        let robot = truth();
        let drawn = presets::find("mini").expect("a preset").robot;
        let (platform, readings) = phase_tables(&drawn, &robot, 1, false)
            .home
            .expect("readings");
        let distances: Vec<f64> = readings[..6]
            .iter()
            .map(|(_, distance)| *distance)
            .collect();
        let fix =
            locate_platform(&platform, &distances, &[1e-4; 6], &Pose::identity()).expect("a pose");
        let truth = robot.home.expect("a home").pose();
        assert!(fix.platform_in_base.difference(&truth).norm() < 1e-10);
    }

    #[test]
    fn a_pose_that_is_approached_again_is_where_it_was() {
        let robot = presets::find("planar").expect("a preset").robot;
        let targets = [
            Pose::identity(),
            Pose::from_parts([0.1, 0.2, 0.0], [1.0, 0.0, 0.0, 0.0]),
        ];
        let instrument = Tracker {
            position_sd_m: PerAxis::Same(5e-5),
            orientation_sd_rad: Some(1e-4),
        };
        let measured = approaches(&robot, (&targets, 50), &instrument, 3, true);
        assert_eq!(measured.len(), 100);
        let off = measured.iter().zip(targets.iter().cycle());
        let squares = off.map(|(pose, target)| (pose.position - target.position).norm_squared());
        // Two directions of the approach and three of the instrument.
        let expected = (2.0 * REPEATED_SD_M.powi(2) + 3.0 * 5e-5_f64.powi(2)).sqrt();
        let rms = (squares.sum::<f64>() / 100.0).sqrt();
        assert!((rms / expected - 1.0).abs() < 0.2, "{rms} {expected}");
        let exact = approaches(&robot, (&targets, 2), &instrument, 3, false);
        assert_eq!(exact, [targets, targets].concat());
    }
}
