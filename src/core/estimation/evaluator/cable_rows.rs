//! Length, equilibrium and swivel equations of a packet of poses.
//!
//! Length row i: `L0_i(x) - s_i - paid_i` with `s_i` the unstrained length at home (or the run for
//! absolute readings). Tension is latent: its reading's error `eps`, of standard deviation `sd_T`, enters the
//! length row by `c = dL0/dT` and the equilibrium by the structure matrix `A`. Eliminating
//! it, the length rows have the variance `D = sd_l^2 + c^2 sd_T^2`, and given them the equilibrium
//! `A^T T + w` has the residual `z - A^T K e_l`, `K = c sd_T^2 / D`, of covariance
//! `E = sum_i (sd_T sd_l)^2 / D A_i A_i^T + S_w`. Its Cholesky factor whitens it. `L0` and `A` are linearised at
//! the estimated tensions, not at the readings: only then is the gradient that of the problem with
//! the tensions as unknowns, only then do motions that nothing determines stay undetermined, and only then is the noise of
//! the readings not in both the residuals and the derivatives by compliance and weight, whose products it would bias.

use super::LARGEST_ERROR;
use super::equations::Equations;
use super::inputs::Link;
use super::layout::Layout;
use crate::cable::{CableLaw, ElongationSurface, Unstrained};
use crate::effect::{CablePort, CablePorts};
use crate::geometry::PosePacket;
use crate::kinematics::{CablePath, PathChange, PulleyGeometry};
use crate::real::{Real, add_scaled, cross, difference, dot, scaled, unit_vector};
use crate::small_cholesky::{TRIANGLE, entry};
use crate::tolerances::{PARALLEL, SMALLEST_TENSION_N};

/// Constants of one cable, the same at all poses.
#[derive(Debug, Clone)]
pub(super) struct CableConstants {
    pub run: f64,
    pub length_sd: f64,
    pub tension_sd: f64,
    pub sags: bool,
    pub surface: Option<ElongationSurface>,
    pub swivel_zero: [f64; 3],
    pub swivel_sd: f64,
}

/// Inputs of one cable, for a packet of poses.
#[derive(Debug, Clone, Copy)]
pub(super) struct CableInputs<T> {
    pub entry: [T; 3],
    pub home_length: T,
    pub ports: CablePorts<T>,
    pub swivel: T,
    /// Estimated error of the tension reading (N), as of the last evaluation.
    pub tension_error: T,
}

/// Geometry and weights of one cable, kept for the equilibrium rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct CableState<T> {
    path: CablePath<T>,
    unstrained: Unstrained<T>,
    radius: T,
    tension: T,
    /// Tension at which the rows are linearised: its best estimate; with the reading instead, the minimum would
    /// differ from that of the true problem by a term of second order in the noise.
    expected: T,
    /// The same for the length, if even the largest error leaves the cable taut; else the reading, or a tension that is assumed.
    expected_load: T,
    /// Lever arm `R b`, base frame (m).
    lever: [T; 3],
    anchor: [T; 3],
    entry: [T; 3],
    /// `dL0/dB`.
    gradient: [T; 3],
    /// `K`, regression of the equilibrium on the length residual.
    regression: T,
    /// `(sd_T sd_l)^2 / D`: variance of the tension given the length.
    conditional_variance: T,
    /// `sd_T^2`.
    tension_variance: T,
    /// `sd_l^2 / D`: share of the length reading's own noise in the variance of its row.
    own_share: T,
    /// `1 / sqrt(D)`, or 0 where the length was not measured.
    weight: T,
    /// `A_i`, force and torque per tension.
    structure: [T; 6],
}

/// Change of a cable's predictions: length (m), wrench (N, N m), swivel angle (rad).
#[derive(Debug, Clone, Copy)]
struct PortChange<T> {
    length: T,
    wrench: [T; 6],
    swivel: T,
}

/// `[f; r x f]`.
#[inline(always)]
fn wrench<T: Real>(lever: [T; 3], force: [T; 3]) -> [T; 6] {
    let torque = cross(lever, force);
    [
        force[0], force[1], force[2], torque[0], torque[1], torque[2],
    ]
}

impl<T: Real> CableState<T> {
    #[inline(always)]
    pub fn new(
        constants: &CableConstants,
        inputs: &CableInputs<T>,
        pose: &PosePacket<T>,
        down: [f64; 3],
    ) -> Self {
        let p = &inputs.ports;
        let zero = p.radius.lift(0.0);
        let one = zero.lift(1.0);
        let entry = add_scaled(inputs.entry, one, p.entry_shift);
        let pulley = PulleyGeometry {
            entry,
            axis: p.axis,
            radius: p.radius,
        };
        let lever = pose.rotate(p.anchor);
        let anchor = add_scaled(lever, one, pose.position);
        let path = pulley.path_to(anchor);
        let (tension, has_tension) = p.tension.present();
        // Where no tension was read, any positive value serves: the row has no weight.
        let expected = tension - inputs.tension_error;
        let largest_error = zero.lift(LARGEST_ERROR * constants.tension_sd);
        let expected_load = (tension - largest_error).select_positive(expected, tension);
        let load = has_tension.select_positive(expected_load, one);
        let slack = zero.lift(SMALLEST_TENSION_N * SMALLEST_TENSION_N) - load * load;
        let load = slack.select_positive(zero.lift(SMALLEST_TENSION_N), load);
        let law = CableLaw {
            run: zero.lift(constants.run),
            tension: load,
            compliance: p.compliance,
            strain: p.strain,
            weight: constants.sags.then_some(p.weight),
            down,
            surface: constants.surface.as_ref(),
        };
        let unstrained = law.unstrained(&path);
        let gradient = unstrained.by_anchor(&path, pulley.radius, constants.sags);
        let tension_variance = zero.lift(constants.tension_sd * constants.tension_sd);
        let length_variance = zero.lift(constants.length_sd * constants.length_sd);
        let c = unstrained.by_tension;
        let precision = one / (c * c).mul_add(tension_variance, length_variance);
        Self {
            path,
            unstrained,
            radius: pulley.radius,
            tension,
            expected,
            expected_load,
            lever,
            anchor,
            entry,
            gradient,
            regression: c * tension_variance * precision,
            conditional_variance: tension_variance * length_variance * precision,
            tension_variance,
            own_share: length_variance * precision,
            weight: precision.sqrt() * has_tension,
            structure: wrench(lever, path.toward_exit),
        }
    }

    /// Geometric length from entry point to anchor (m).
    #[inline(always)]
    pub fn path_length(&self) -> T {
        self.path.length
    }

    /// `dL0/dT` (m/N).
    #[inline(always)]
    pub fn length_by_tension(&self) -> T {
        self.unstrained.by_tension
    }

    /// `A_i`: force and torque on the platform per tension.
    #[inline(always)]
    pub fn structure(&self) -> [T; 6] {
        self.structure
    }

    /// Length row of cable `index`.
    #[inline(always)]
    pub fn length_row(
        &self,
        index: usize,
        inputs: &CableInputs<T>,
        equations: &mut Equations<T>,
    ) -> T {
        let zero = self.tension.lift(0.0);
        let (paid, has_paid) = inputs.ports.paid.present();
        let weight = self.weight * has_paid;
        // Continued from the estimated tension to the reading, whose error is the unknown.
        let at_reading = (self.unstrained.by_tension)
            .mul_add(self.tension - self.expected_load, self.unstrained.length);
        let residual = (at_reading - inputs.home_length - paid) * has_paid;
        let g = scaled(self.gradient, weight);
        let torque = cross(self.lever, g);
        equations.residual[index] = residual * weight;
        equations.by_pose[index] = [g[0], g[1], g[2], torque[0], torque[1], torque[2]];
        equations.length_by_cable[index] = [-g[0], -g[1], -g[2], -weight];
        equations.present[index] = weight.select_positive(zero.lift(1.0), zero);
        residual
    }

    /// Swivel row of this cable: `atan2((z x z0).e, z0.e) + offset - reading`.
    #[inline(always)]
    pub fn swivel_row(
        &self,
        (row, index): (usize, usize),
        constants: &CableConstants,
        inputs: &CableInputs<T>,
        equations: &mut Equations<T>,
    ) {
        let zero = self.tension.lift(0.0);
        let (reading, present) = inputs.swivel.present();
        let origin = crate::real::constants(zero, constants.swivel_zero);
        let axis = inputs.ports.axis;
        let angle = dot(cross(axis, origin), self.path.facing).atan2(dot(origin, self.path.facing));
        let off = angle + inputs.ports.swivel_offset - reading;
        // Wrap the difference into (-pi, pi].
        let turn = zero.lift(std::f64::consts::TAU);
        let half = zero.lift(std::f64::consts::PI);
        let off = (off - half).select_positive(off - turn, off);
        let off = (-off - half).select_positive(off + turn, off);
        let weight = present * zero.lift(constants.swivel_sd.recip());
        let g = scaled(self.path.lateral, self.path.inverse_axis_distance * weight);
        let torque = cross(self.lever, g);
        equations.residual[row] = off * weight;
        equations.by_pose[row] = [g[0], g[1], g[2], torque[0], torque[1], torque[2]];
        equations.swivel_by_cable[index] = [-g[0], -g[1], -g[2], zero];
        equations.present[row] = present;
    }

    /// Change of this cable's predictions per unit of a port.
    #[inline(always)]
    fn change_by_port(
        &self,
        port: CablePort,
        swivel_zero: [f64; 3],
        pose: &PosePacket<T>,
    ) -> PortChange<T> {
        let zero = self.tension.lift(0.0);
        let length_only = |length| PortChange {
            length,
            wrench: [zero; 6],
            swivel: zero,
        };
        match port {
            CablePort::Paid => length_only(zero.lift(-1.0)),
            CablePort::Strain => length_only(self.unstrained.by_strain),
            CablePort::Compliance => length_only(self.unstrained.by_compliance),
            CablePort::Weight => length_only(self.unstrained.by_weight),
            CablePort::Tension => PortChange {
                wrench: self.structure,
                ..length_only(self.unstrained.by_tension)
            },
            CablePort::SwivelOffset => PortChange {
                swivel: zero.lift(1.0),
                ..length_only(zero)
            },
            CablePort::Radius => self.by_path(&self.path.change_by_radius(self.radius), [zero; 3]),
            CablePort::EntryShift(axis) => {
                let step = scaled(unit_vector(zero, axis), zero.lift(-1.0));
                self.by_path(&self.path.change_by_anchor(self.radius, step), step)
            }
            CablePort::Axis(axis) => {
                let z = cross(self.path.facing, self.path.lateral);
                let rotation = cross(z, unit_vector(zero, axis));
                let offset = difference(self.anchor, self.entry);
                let path = self.path.change_by_axis(self.radius, offset, rotation);
                let mut change = self.by_path(&path, cross(offset, rotation));
                // The zero direction counts by its projection perpendicular to the axis, which changes as the axis tilts.
                let origin = crate::real::constants(zero, swivel_zero);
                let across = cross(z, origin);
                let square = dot(across, across).max(zero.lift(PARALLEL));
                change.swivel = change.swivel + dot(z, origin) * across[axis] / square;
                change
            }
            CablePort::Anchor(axis) => {
                let step = pose.rotate(unit_vector(zero, axis));
                let path = self.path.change_by_anchor(self.radius, step);
                let mut change = self.by_path(&path, step);
                let torque = scaled(cross(step, self.path.toward_exit), self.expected);
                for k in 0..3 {
                    change.wrench[3 + k] = change.wrench[3 + k] + torque[k];
                }
                change
            }
        }
    }

    /// Change due to a change of the path; `step` is the motion of the anchor relative to the pulley.
    #[inline(always)]
    fn by_path(&self, change: &PathChange<T>, step: [T; 3]) -> PortChange<T> {
        let force = scaled(change.toward_exit, self.expected);
        PortChange {
            length: self.unstrained.change(change),
            wrench: wrench(self.lever, force),
            swivel: dot(self.path.lateral, step) * self.path.inverse_axis_distance,
        }
    }

    /// Ratio of estimated tension to tension reading; 1 where none was read.
    #[inline(always)]
    fn estimate_over_reading(&self) -> T {
        let one = self.tension.lift(1.0);
        let square = self.tension * self.tension;
        square.select_positive(
            self.expected / square.select_positive(self.tension, one),
            one,
        )
    }

    /// Adds the effect derivatives of this cable's rows; those of the equilibrium are not yet whitened.
    #[inline(always)]
    pub fn link(
        &self,
        (link, slope): (&Link<CablePort>, T),
        (index, constants): (usize, &CableConstants),
        layout: &Layout,
        pose: &PosePacket<T>,
        equations: &mut Equations<T>,
    ) {
        let slope = if link.is_proportional {
            slope * self.estimate_over_reading()
        } else {
            slope
        };
        let change = self.change_by_port(link.port, constants.swivel_zero, pose);
        let present = equations.present[index];
        let length = change.length * slope * present;
        let entry = &mut equations.effects_of(layout, index)[link.own];
        *entry = length.mul_add(self.weight, *entry);
        if link.relative_noise != 0.0 {
            // What scales a reading scales its noise too, which changes the weight of the row.
            let whitened = equations.residual[index] * self.own_share;
            let entry = &mut equations.effects_of(layout, index)[link.own];
            *entry = *entry - whitened * whitened.lift(link.relative_noise);
        }
        if let Some(first) = layout.swivel {
            let row = first + index;
            let weight = equations.present[row] * slope.lift(constants.swivel_sd.recip());
            let entry = &mut equations.effects_of(layout, row)[link.own];
            *entry = (change.swivel * slope).mul_add(weight, *entry);
        }
        if layout.equilibrium.is_some() {
            let column =
                &mut equations.equilibrium_by_column[layout.effect_column() + link.parameter];
            let back = -(self.regression * length);
            for k in 0..6 {
                let by_length = self.structure[k] * back;
                column[k] = column[k] + change.wrench[k].mul_add(slope, by_length);
            }
        }
    }

    /// Adds this cable to the equilibrium rows before whitening.
    #[inline(always)]
    pub fn add_to_equilibrium(
        &self,
        index: usize,
        residual: T,
        layout: &Layout,
        equilibrium: &mut EquilibriumRows<T>,
        equations: &mut Equations<T>,
    ) {
        let a = &self.structure;
        let zero = self.tension.lift(0.0);
        let present = equations.present[index];
        let regression = self.regression * present;
        let variance = present.select_positive(self.conditional_variance, self.tension_variance);
        let back = -(regression * residual);
        for k in 0..6 {
            equilibrium.residual[k] = a[k].mul_add(self.tension + back, equilibrium.residual[k]);
        }
        for k in 0..6 {
            let scaled = a[k] * variance;
            for q in 0..=k {
                let index = entry(k, q);
                equilibrium.covariance[index] = scaled.mul_add(a[q], equilibrium.covariance[index]);
            }
        }
        let first = layout.cable_column(index);
        let columns = &mut equations.equilibrium_by_column[first..first + 4];
        let mut moved = [[zero; 6]; 3];
        for axis in 0..3 {
            let turned = self.path.turn_along(axis, self.expected);
            let change = wrench(self.lever, turned);
            let back = -(regression * self.gradient[axis]);
            for k in 0..6 {
                moved[axis][k] = a[k].mul_add(back, change[k]);
                columns[axis][k] = -moved[axis][k];
                equilibrium.by_pose[axis][k] = equilibrium.by_pose[axis][k] + moved[axis][k];
            }
        }
        columns[3] = scaled(*a, regression);
        self.add_rotation(&moved, equilibrium);
    }

    /// A rotation about axis k moves the anchor by `e_k x lever` and rotates the lever arm.
    #[inline(always)]
    fn add_rotation(&self, moved: &[[T; 6]; 3], equilibrium: &mut EquilibriumRows<T>) {
        let [x, y, z] = self.lever;
        let steps = [(2, y, 1, z), (0, z, 2, x), (1, x, 0, y)];
        for (k, (plus, by_plus, minus, by_minus)) in steps.into_iter().enumerate() {
            let column = &mut equilibrium.by_pose[3 + k];
            for q in 0..6 {
                let change = moved[plus][q] * by_plus - moved[minus][q] * by_minus;
                column[q] = column[q] + change;
            }
        }
        add_lever_rotation(
            self.lever,
            scaled(self.path.toward_exit, self.expected),
            equilibrium,
        );
    }
}

/// Change of torque of a force whose lever arm rotates: `(e_k x r) x f = r f_k - e_k (r.f)`.
#[inline(always)]
pub(super) fn add_lever_rotation<T: Real>(
    lever: [T; 3],
    force: [T; 3],
    equilibrium: &mut EquilibriumRows<T>,
) {
    let along = dot(lever, force);
    for k in 0..3 {
        let column = &mut equilibrium.by_pose[3 + k];
        for q in 0..3 {
            column[3 + q] = lever[q].mul_add(force[k], column[3 + q]);
        }
        column[3 + k] = column[3 + k] - along;
    }
}

/// The equilibrium rows of a packet of poses during accumulation.
#[derive(Debug, Clone, Copy)]
pub(super) struct EquilibriumRows<T> {
    pub residual: [T; 6],
    /// Lower triangle of the covariance, row by row.
    pub covariance: [T; TRIANGLE],
    /// Derivative with respect to each pose coordinate, column by column.
    pub by_pose: [[T; 6]; 6],
    pub present: T,
}

impl<T: Real> EquilibriumRows<T> {
    #[inline(always)]
    pub fn new(zero: T) -> Self {
        Self {
            residual: [zero; 6],
            covariance: [zero; TRIANGLE],
            by_pose: [[zero; 6]; 6],
            present: zero.lift(1.0),
        }
    }
}
