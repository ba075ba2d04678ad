//! Equations of the instruments on the platform: laser, external instrument, inclinometer.

use super::equations::Equations;
use super::layout::Layout;
use crate::effect::{PlatformPort, PlatformPorts};
use crate::geometry::PosePacket;
use crate::real::{Real, add_scaled, cross, dot, scaled, unit_vector};

/// Laser reading of a packet of poses: distance `(h - n.o) / (n.q)` from the origin
/// `o = r + R o_L` along `q = R q_L` to the plane `n.x = h` (Jin et al. 2018, equation 8).
#[derive(Debug, Clone, Copy)]
pub(super) struct LaserInputs<T> {
    pub reading: T,
    pub origin: [T; 3],
    pub offset: T,
    pub inverse_sd: T,
    pub ports: PlatformPorts<T>,
}

impl<T: Real> LaserInputs<T> {
    /// Writes the laser row and its effect derivatives.
    #[inline(always)]
    pub fn row(
        &self,
        row: usize,
        links: &[(PlatformPort, usize, T)],
        layout: &Layout,
        pose: &PosePacket<T>,
        equations: &mut Equations<T>,
    ) {
        let p = &self.ports;
        let (gain, bias, normal) = (p.laser_gain, p.laser_bias, p.target_normal);
        let lever = pose.rotate(self.origin);
        let origin = add_scaled(lever, gain.lift(1.0), pose.position);
        let direction = pose.rotate(p.laser_direction);
        let inverse = gain.lift(1.0) / dot(normal, direction);
        let distance = (self.offset - dot(normal, origin)) * inverse;
        let (reading, present) = self.reading.present();
        let weight = self.inverse_sd * present;
        let slope = gain * inverse * weight;
        // Origin and direction of the beam both move: d dist = -n.(d o + dist d q) / (n.q).
        let g = scaled(normal, -slope);
        let end = add_scaled(lever, distance, direction);
        let torque = cross(end, g);
        equations.residual[row] = (distance.mul_add(gain, bias) - reading) * weight;
        equations.by_pose[row] = [g[0], g[1], g[2], torque[0], torque[1], torque[2]];
        equations.laser_by_plane = slope;
        equations.present[row] = present;
        for (port, parameter, by_parameter) in links {
            let change = match port {
                PlatformPort::LaserGain => distance * weight,
                PlatformPort::LaserBias => weight,
                PlatformPort::LaserDirection(k) => {
                    dot(pose.rotate(unit_vector(gain, *k)), g) * distance
                }
                PlatformPort::TargetNormal(k) => {
                    let at = add_scaled(origin, distance, direction);
                    -(at[*k] * slope)
                }
                _ => continue,
            };
            let entry = &mut equations.effects_of(layout, row)[*parameter];
            *entry = change.mul_add(*by_parameter, *entry);
        }
    }
}

/// Three rows of the external instrument's position: that of the point `r + R p` of the platform, plus its shift.
#[inline(always)]
pub(super) fn tracker_position_rows<T: Real>(
    first: usize,
    (reading, inverse_sd): ([T; 3], [T; 3]),
    ports: &PlatformPorts<T>,
    links: &[(PlatformPort, usize, T)],
    layout: &Layout,
    pose: &PosePacket<T>,
    equations: &mut Equations<T>,
) {
    let lever = pose.rotate(ports.tracker_point);
    let zero = lever[0].lift(0.0);
    // d(R p) = phi x R p.
    let [x, y, z] = lever;
    let by_rotation = [[zero, z, -y], [-z, zero, x], [y, -x, zero]];
    for k in 0..3 {
        let (value, present) = reading[k].present();
        let weight = inverse_sd[k].present().0 * present;
        let row = first + k;
        let predicted = pose.position[k] + lever[k] + ports.tracker_shift[k];
        let [a, b, c] = scaled(by_rotation[k], weight);
        equations.residual[row] = (predicted - value) * weight;
        equations.by_pose[row] = [zero, zero, zero, a, b, c];
        equations.by_pose[row][k] = weight;
        equations.present[row] = present;
        for (port, parameter, by_parameter) in links {
            let change = match port {
                PlatformPort::TrackerPoint(axis) => pose.rotation[k][*axis] * weight,
                PlatformPort::TrackerShift(axis) if *axis == k => weight,
                _ => continue,
            };
            let entry = &mut equations.effects_of(layout, row)[*parameter];
            *entry = change.mul_add(*by_parameter, *entry);
        }
    }
}

/// Three rows of the external instrument's orientation: twice the vector part of
/// `q q_measured^-1`, the rotation vector up to third order, plus the offset of the orientation reading.
#[inline(always)]
pub(super) fn tracker_orientation_rows<T: Real>(
    first: usize,
    (reading, inverse_sd): ([T; 4], T),
    ports: &PlatformPorts<T>,
    links: &[(PlatformPort, usize, T)],
    layout: &Layout,
    pose: &PosePacket<T>,
    equations: &mut Equations<T>,
) {
    let (w0, present) = reading[0].present();
    let v0 = [
        reading[1].present().0,
        reading[2].present().0,
        reading[3].present().0,
    ];
    let zero = w0.lift(0.0);
    let two = w0.lift(2.0);
    let [w, x, y, z] = pose.quaternion;
    let v = [x, y, z];
    // q q0^-1 with q0^-1 = (w0, -v0).
    let scalar = w.mul_add(w0, dot(v, v0));
    let c = cross(v0, v);
    let sign = scalar.select_positive(zero.lift(1.0), zero.lift(-1.0));
    let mut vector = c;
    for k in 0..3 {
        vector[k] = (v[k] * w0 - v0[k] * w + c[k]) * sign;
    }
    let weight = inverse_sd * present;
    let (scalar, half) = (scalar * sign * weight, scaled(vector, weight));
    // d(2 vec) = w phi + phi x vec.
    let by_rotation = [
        [scalar, half[2], -half[1]],
        [-half[2], scalar, half[0]],
        [half[1], -half[0], scalar],
    ];
    for k in 0..3 {
        let [a, b, c] = by_rotation[k];
        let row = first + k;
        equations.residual[row] = half[k].mul_add(two, ports.tracker_turn[k] * weight);
        equations.by_pose[row] = [zero, zero, zero, a, b, c];
        equations.present[row] = present;
        for (port, parameter, by_parameter) in links {
            if *port == PlatformPort::TrackerTurn(k) {
                let entry = &mut equations.effects_of(layout, row)[*parameter];
                *entry = weight.mul_add(*by_parameter, *entry);
            }
        }
    }
}

/// Roll, pitch and yaw of `R = Rx(roll) Ry(pitch) Rz(yaw)`.
#[inline(always)]
pub(super) fn inclination_rows<T: Real>(
    first: usize,
    (reading, inverse_sd): ([T; 3], T),
    ports: &PlatformPorts<T>,
    links: &[(PlatformPort, usize, T)],
    layout: &Layout,
    pose: &PosePacket<T>,
    equations: &mut Equations<T>,
) {
    let r = &pose.rotation;
    let zero = inverse_sd.lift(0.0);
    let one = inverse_sd.lift(1.0);
    let cosine = (r[1][2] * r[1][2]).mul_add(one, r[2][2] * r[2][2]).sqrt();
    let per_square = one / (cosine * cosine);
    let angles = [
        (-r[1][2]).atan2(r[2][2]),
        r[0][2].atan2(cosine),
        (-r[0][1]).atan2(r[0][0]),
    ];
    // With dR = [phi] R: third column (a, b, c) turns by phi x column, first row by its neighbours.
    let (a, b, c) = (r[0][2], r[1][2], r[2][2]);
    let gradients = [
        [one, -(a * b) * per_square, -(a * c) * per_square],
        [zero, c / cosine, -b / cosine],
        [zero, b * per_square, c * per_square],
    ];
    let turn = zero.lift(std::f64::consts::TAU);
    let half = zero.lift(std::f64::consts::PI);
    for k in 0..3 {
        let row = first + k;
        let (value, present) = reading[k].present();
        let weight = inverse_sd * present;
        let off = angles[k] + ports.inclination_offset[k] - value;
        let off = (off - half).select_positive(off - turn, off);
        let off = (-off - half).select_positive(off + turn, off);
        let [x, y, z] = scaled(gradients[k], weight);
        equations.residual[row] = off * weight;
        equations.by_pose[row] = [zero, zero, zero, x, y, z];
        equations.present[row] = present;
        for (port, parameter, by_parameter) in links {
            if *port == PlatformPort::InclinationOffset(k) {
                let entry = &mut equations.effects_of(layout, row)[*parameter];
                *entry = weight.mul_add(*by_parameter, *entry);
            }
        }
    }
}
