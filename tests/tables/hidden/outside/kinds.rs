//! The individual effects outside the catalogue.

use std::f64::consts::TAU;

use tautline_core::geometry::Vec3;
use tautline_core::measurement::Measurements;
use tautline_core::robot::Robot;

use super::{Outside, Scene, add_length, add_tension};

/// All effects outside the catalogue.
pub static OUTSIDE: [Outside; 16] = [
    // The laser's target is no plane: error quadratic in the lateral position.
    outside("curved_target", has_laser, 1e-3, curved_target),
    // The laser reads wrong at slanting incidence: error with the square of the angle.
    outside("laser_incidence", has_laser, 0.1, laser_incidence),
    // The laser's error swings in time.
    outside("laser_hum", has_laser, 1e-3, |scene, size, data| {
        let wave = waves(data, 350.0, scene.phase);
        (data.laser_m.iter_mut().zip(wave)).for_each(|(d, w)| *d += size * w);
    }),
    // The zero of an encoder swings in time, as with an air conditioner.
    outside("thermal_cycle", any_robot, 1e-3, |scene, size, data| {
        let wave = waves(data, 400.0, scene.phase);
        one_cable_length(scene, data, |row| size * wave[row]);
    }),
    // A gear's teeth: an error periodic in 0.297 of a drum revolution.
    outside("gear_ripple", has_home, 1e-3, gear_ripple),
    // A guide lengthens the cable with the third harmonic of the swivel angle.
    outside("guide_eyelet", any_robot, 1e-3, guide_eyelet),
    // A platform's bracket bends sideways with tension.
    outside("soft_bracket", has_forces, 1e-3, soft_bracket),
    // The whole frame sways sideways, ever more.
    outside("frame_sway", any_robot, 1e-3, frame_sway),
    // A cable rubs at an obstacle in one corner of the workspace.
    outside("obstacle", any_robot, 1e-3, obstacle),
    // A force sensor with a quadratic term.
    outside("force_square", has_forces, 1.0, |scene, size, data| {
        let loads = relative_loads(scene, data, scene.cable);
        one_cable_tension(scene, data, |row| size * loads[row].powi(2));
    }),
    // A force sensor that saturates above the mean load.
    outside("force_saturation", has_forces, 1.0, |scene, size, data| {
        let loads = relative_loads(scene, data, scene.cable);
        one_cable_tension(scene, data, |row| -size * loads[row].max(0.0));
    }),
    // The zero of all force amplifiers wanders in time.
    outside("force_wander", has_forces, 1.0, |scene, size, data| {
        let wave = waves(data, 700.0, scene.phase);
        add_tension(scene, data, |row, _| size * wave[row]);
    }),
    // A force channel picks up the signal of the next one.
    outside("force_crosstalk", has_forces, 1.0, |scene, size, data| {
        let next = (scene.cable + 1) % scene.truth.cable_count();
        let loads = relative_loads(scene, data, next);
        one_cable_tension(scene, data, |row| size * loads[row]);
    }),
    // The yaw reading turns with the tension of a cable.
    outside(
        "loaded_compass",
        |robot| robot.inclinometer.is_some(),
        1e-2,
        |scene, size, data| {
            let loads = relative_loads(scene, data, scene.cable);
            for (angles, load) in data.inclination_rad.iter_mut().zip(loads) {
                angles[2] += size * load;
            }
        },
    ),
    // The tracker's beam bends: height error quadratic in the lateral position.
    outside(
        "refraction",
        |robot| robot.tracker.is_some(),
        1e-3,
        |scene, size, data| {
            let places = scene.relative_positions(data);
            for (position, place) in data.tracked_position_m.iter_mut().zip(places) {
                position[2] += size * place.dot(&scene.direction).powi(2);
            }
        },
    ),
    // The zero of a swivel sensor wanders in time.
    outside(
        "swivel_wander",
        |robot| robot.cables.iter().all(|c| c.pulley.swivel_zero.is_some()),
        1e-2,
        |scene, size, data| {
            let wave = waves(data, 500.0, scene.phase);
            for row in 0..data.swivel_rad.rows() {
                let angle = data.swivel_rad.get(row, scene.cable) + size * wave[row];
                data.swivel_rad.set(row, scene.cable, angle);
            }
        },
    ),
];

const fn outside(
    id: &'static str,
    applies: fn(&Robot) -> bool,
    unit: f64,
    change: fn(&Scene, f64, &mut Measurements),
) -> Outside {
    Outside {
        id,
        applies,
        unit,
        change,
    }
}

fn any_robot(_: &Robot) -> bool {
    true
}

fn has_home(robot: &Robot) -> bool {
    robot.home.is_some()
}

fn has_laser(robot: &Robot) -> bool {
    robot.laser.is_some()
}

fn has_forces(robot: &Robot) -> bool {
    robot.has_force_sensors()
}

/// A wave over time, by row.
fn waves(data: &Measurements, period_s: f64, phase: f64) -> Vec<f64> {
    let times = data.time_s.iter();
    times.map(|t| (TAU * t / period_s + phase).sin()).collect()
}

fn one_cable_length(scene: &Scene, data: &mut Measurements, error: impl Fn(usize) -> f64) {
    let cable = scene.cable;
    let of_one = |row, index| if index == cable { error(row) } else { 0.0 };
    add_length(scene, data, of_one);
}

fn one_cable_tension(scene: &Scene, data: &mut Measurements, error: impl Fn(usize) -> f64) {
    let cable = scene.cable;
    let of_one = |row, index| if index == cable { error(row) } else { 0.0 };
    add_tension(scene, data, of_one);
}

/// Standardised tension of a cable, by row.
fn relative_loads(scene: &Scene, data: &Measurements, cable: usize) -> Vec<f64> {
    if !scene.truth.has_force_sensors() {
        return vec![0.0; data.len()];
    }
    let loads: Vec<f64> = (0..data.len())
        .map(|row| data.truth.tension_n.get(row, cable))
        .collect();
    let count = loads.len() as f64;
    let mean = loads.iter().sum::<f64>() / count;
    let variance = loads.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / count;
    let sd = variance.sqrt().max(1e-9);
    loads.iter().map(|l| (l - mean) / sd).collect()
}

fn curved_target(scene: &Scene, size: f64, data: &mut Measurements) {
    let places = scene.relative_positions(data);
    for (distance, place) in data.laser_m.iter_mut().zip(places) {
        *distance += size * place.dot(&scene.direction).powi(2);
    }
}

fn laser_incidence(scene: &Scene, size: f64, data: &mut Measurements) {
    let Some(laser) = scene.truth.laser else {
        return;
    };
    let normal = Vec3::from(laser.target_plane.normal);
    for (distance, pose) in data.laser_m.iter_mut().zip(&data.truth.poses) {
        let beam = pose.orientation * Vec3::from(laser.direction);
        *distance += size * beam.cross(&normal).norm_squared();
    }
}

fn gear_ripple(scene: &Scene, size: f64, data: &mut Measurements) {
    let cable = scene.cable;
    let ratio = scene.truth.cables[cable].winch.gear_ratio;
    let turns: Vec<f64> = (0..data.revolutions.rows())
        .map(|row| data.revolutions.get(row, cable) / ratio)
        .collect();
    let wave = |row: usize| {
        let at = turns.get(row).copied().unwrap_or_default();
        (TAU * 3.37 * at + scene.phase).sin()
    };
    if !turns.is_empty() {
        one_cable_length(scene, data, |row| size * wave(row));
    }
}

fn guide_eyelet(scene: &Scene, size: f64, data: &mut Measurements) {
    let axis = Vec3::from(scene.truth.cables[scene.cable].pulley.swivel_axis);
    let across = axis.cross(&Vec3::x());
    let first = across
        .try_normalize(0.1)
        .unwrap_or_else(|| axis.cross(&Vec3::y()).normalize());
    let second = axis.cross(&first);
    // On a planar robot pulleys do not swivel, so the direction of the cable is used instead.
    let planar = scene.truth.platform.free.len() < 6;
    let angles: Vec<f64> = scene
        .states(data)
        .iter()
        .map(|states| {
            let pull = states[scene.cable].toward_exit;
            if planar {
                pull.y.atan2(pull.x)
            } else {
                pull.dot(&second).atan2(pull.dot(&first))
            }
        })
        .collect();
    one_cable_length(scene, data, |row| {
        size * (3.0 * angles[row] + scene.phase).sin()
    });
}

fn soft_bracket(scene: &Scene, size: f64, data: &mut Measurements) {
    let states = scene.states(data);
    let loads = relative_loads(scene, data, scene.cable);
    let shift = scene.direction * size;
    let poses = data.truth.poses.clone();
    one_cable_length(scene, data, |row| {
        let pull = states[row][scene.cable].toward_exit;
        -(poses[row].orientation * shift).dot(&pull) * loads[row]
    });
}

fn frame_sway(scene: &Scene, size: f64, data: &mut Measurements) {
    let states = scene.states(data);
    let wave = waves(data, 170.0, scene.phase);
    let last = data.time_s.last().copied().unwrap_or(1.0).max(1.0);
    let shift: Vec<f64> = (data.time_s.iter().zip(&wave))
        .map(|(t, w)| size * w * t / last)
        .collect();
    // Only every second pulley moves: if all did, the platform would simply move with them.
    add_length(scene, data, |row, cable| {
        let moves = f64::from(u8::from(cable % 2 == 0));
        let pull = states[row][cable].toward_exit;
        moves * shift[row] * pull.dot(&scene.direction)
    });
}

fn obstacle(scene: &Scene, size: f64, data: &mut Measurements) {
    let places = scene.relative_positions(data);
    let corner = scene.direction * 0.6;
    one_cable_length(scene, data, |row| {
        let distance = (places[row] - corner).norm();
        size * (-0.5 * (distance / 0.35).powi(2)).exp()
    });
}
