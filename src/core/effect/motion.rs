//! Time derivatives of the readings of a row, and velocity and acceleration of the platform from them.
//!
//! With the structure matrix `A` of the free coordinates (rows `[u; (R b) x u]`), the lengths obey `l' = -A v` and
//! `l'' = -A a - A' v`, which is solved for the twists `v` and `a` by least squares; `A'` is the change of `A` along `v`.
//! A cable under the tension `T` is `1 + T c` times its unstrained length, with its compliance `c = 1/EA`, so the lengths also
//! change with the tensions. Where cables are too few or a reading is missing, the derivatives are
//! those of the external instrument, else 0.

use nalgebra::{DMatrix, DVector};

use super::Dual;
use super::context::or_zero;
use crate::geometry::{Pose, Twist, Vec3};
use crate::kinematics::{inverse_kinematics, structure_matrix};
use crate::measurement::{Grid, Measurements, Rates};
use crate::robot::{Cable, Robot};

/// Time step over which the change of the structure matrix is differenced (s).
const STEP_S: f64 = 1e-4;
/// Smallest singular value of the structure matrix, relative to the largest, at which lengths determine velocities.
const REGULAR: f64 = 1e-3;

/// Change within a delay of a quantity with these first and second time derivatives, to second order:
/// `delay q' + delay^2 q''/2`.
pub(super) fn change_within(delay: Dual, [rate, change]: [f64; 2]) -> Dual {
    delay * rate + delay * delay * (0.5 * change)
}

/// The values, or 0 if they are unknown.
pub(super) fn finite(values: Option<[f64; 2]>) -> [f64; 2] {
    values.unwrap_or_default().map(|value| or_zero(Some(value)))
}

/// First and second time derivative of the cable paid out, or the length, at a `(row, cable)` (m/s, m/s^2).
pub(super) fn paid_rates(cable: &Cable, data: &Measurements, at: (usize, usize)) -> [f64; 2] {
    let rates = data.rates.as_ref();
    finite(
        rates.map(|rates| [0, 1].map(|order| length_rate(cable, data, &rates.length[order], at))),
    )
}

/// One of these derivatives, from the grid of its kind; NaN where unknown.
fn length_rate(cable: &Cable, data: &Measurements, rates: &Grid, at: (usize, usize)) -> f64 {
    let per_reading = match data.revolutions.is_empty() {
        true => 1.0,
        false => cable.winch.cable_per_revolution_m(),
    };
    per_reading * rates.get(at.0, at.1)
}

/// First and second time derivative of the tension (N/s, N/s^2).
pub(super) fn tension_rates(cable: &Cable, data: &Measurements, at: (usize, usize)) -> [f64; 2] {
    let gain = cable.force_sensor.map(|sensor| sensor.tension_gain);
    let rates = data.rates.as_ref().zip(gain);
    finite(rates.map(|(rates, gain)| [0, 1].map(|k| rates.force[k].get(at.0, at.1) / gain)))
}

/// First and second derivative of the length (m/s, m/s^2) of a cable of loaded length `loaded_m`, from those of the length paid out:
/// with `L = L0 (1 + T c)`, `L' = L0' (1 + T c) + L0 T' c`, and so on.
fn length_rates(
    cable: &Cable,
    data: &Measurements,
    at: (usize, usize),
    (paid, loaded_m): ([f64; 2], f64),
) -> [f64; 2] {
    let compliance = cable.cable.axial_stiffness_n.map_or(0.0, f64::recip);
    let (Some(sensor), false) = (cable.force_sensor, data.force_n.is_empty()) else {
        return paid;
    };
    let strain = compliance * or_zero(Some(sensor.tension_n(data.force_n.get(at.0, at.1))));
    let [change, second] = tension_rates(cable, data, at).map(|rate| compliance * rate);
    let unstrained_m = loaded_m / (1.0 + strain);
    [
        paid[0] * (1.0 + strain) + unstrained_m * change,
        paid[1] * (1.0 + strain) + 2.0 * paid[0] * change + unstrained_m * second,
    ]
}

/// Velocity and acceleration at a row, near a pose (m, rad, s; base frame).
pub(super) fn twists(
    robot: &Robot,
    data: &Measurements,
    rates: &Rates,
    row: usize,
    pose: &Pose,
) -> [Twist; 2] {
    let by_lengths = from_lengths(robot, data, rates, row, pose);
    by_lengths.unwrap_or_else(|| match rates.tracked.get(row) {
        Some(tracked) if tracked.iter().all(|t| t.iter().all(|v| v.is_finite())) => *tracked,
        _ => Default::default(),
    })
}

fn from_lengths(
    robot: &Robot,
    data: &Measurements,
    rates: &Rates,
    row: usize,
    pose: &Pose,
) -> Option<[Twist; 2]> {
    let freedom = robot.platform.freedom();
    if robot.cable_count() < freedom.count() {
        return None;
    }
    let states = inverse_kinematics(robot, pose).ok()?;
    let cables = || robot.cables.iter().zip(&states).enumerate();
    let stretched = cables().map(|(index, (cable, state))| {
        let at = (row, index);
        let paid = [0, 1].map(|order| length_rate(cable, data, &rates.length[order], at));
        let loaded_m = cable.winch.length_to_pulley_m + state.length_m;
        length_rates(cable, data, at, (paid, loaded_m))
    });
    let stretched: Vec<[f64; 2]> = stretched.collect();
    let [first, second] = [0, 1]
        .map(|order| DVector::from_iterator(stretched.len(), stretched.iter().map(|l| l[order])));
    if first
        .iter()
        .chain(second.iter())
        .any(|rate| !rate.is_finite())
    {
        return None;
    }
    let structure = structure_matrix(robot, pose).ok()?;
    let svd = structure.clone().svd(true, true);
    let least = REGULAR * svd.singular_values.max();
    if svd.singular_values.min() < least {
        return None;
    }
    let solve = |lengths: &DVector<f64>| svd.solve(&-lengths, 0.0).ok();
    let full = |free: &DVector<f64>| {
        let mut twist = Twist::zeros();
        let coordinates = freedom.coordinates().iter();
        coordinates
            .zip(free.iter())
            .for_each(|(c, value)| twist[c.index()] = *value);
        twist
    };
    let velocity = solve(&first)?;
    let next = structure_matrix(robot, &pose.perturbed(&(full(&velocity) * STEP_S))).ok()?;
    let change: DMatrix<f64> = (next - structure) / STEP_S;
    let acceleration = solve(&(second + change * &velocity))?;
    Some([full(&velocity), full(&acceleration)])
}

/// Acceleration of the centre of mass and torque `I alpha + w x I w` about it (m/s^2, N m; base frame), for a platform
/// with this velocity and acceleration.
pub(crate) fn inertia(robot: &Robot, pose: &Pose, [velocity, acceleration]: &[Twist; 2]) -> Twist {
    let linear = |twist: &Twist| twist.fixed_rows::<3>(0).into_owned();
    let angular = |twist: &Twist| twist.fixed_rows::<3>(3).into_owned();
    let (spin, turning): (Vec3, Vec3) = (angular(velocity), angular(acceleration));
    let lever = pose.orientation * Vec3::from(robot.platform.center_of_mass_m);
    let center = linear(acceleration) + turning.cross(&lever) + spin.cross(&spin.cross(&lever));
    let turn = pose.orientation.to_rotation_matrix();
    let own = turn * robot.platform.inertia() * turn.inverse();
    let torque = own * turning + spin.cross(&(own * spin));
    Twist::new(center.x, center.y, center.z, torque.x, torque.y, torque.z)
}
