//! Evaluates all rows of one packet of poses.

use super::Evaluator;
use super::cable_rows::{CableInputs, CableState, EquilibriumRows, add_lever_rotation};
use super::motion::Lag;
use super::platform_rows::{self, LaserInputs};
use crate::effect::PlatformPort;
use crate::geometry::PosePacket;
use crate::real::{Packet, constants, scaled, unit_vector};
use crate::small_cholesky::{entry, factorise, forward_substitute};

impl<T: Packet> Evaluator<'_, T> {
    #[inline(always)]
    pub(super) fn evaluate(&mut self, batch: usize, pose: &PosePacket<T>) {
        let zero = T::splat(self.token, 0.0);
        self.equations.by_effect.fill(zero);
        let mut equilibrium = EquilibriumRows::new(zero);
        if self.layout.equilibrium.is_some() {
            let first = self.layout.plane_column();
            self.equations.equilibrium_by_column[first..].fill([zero; 6]);
        }
        for cable in 0..self.layout.cables {
            self.evaluate_cable(batch, cable, pose, &mut equilibrium);
        }
        if let Some(first) = self.layout.equilibrium {
            self.whiten_equilibrium(batch, first, pose, &mut equilibrium);
        }
        if self.is_latent {
            self.update_tension_errors(batch);
        }
        self.evaluate_platform(batch, pose);
        for k in 0..6 {
            if self.free[k] == 0.0 {
                for j in &mut self.equations.by_pose {
                    j[k] = zero;
                }
            }
        }
    }

    #[inline(always)]
    fn evaluate_cable(
        &mut self,
        batch: usize,
        cable: usize,
        pose: &PosePacket<T>,
        equilibrium: &mut EquilibriumRows<T>,
    ) {
        let columns = &self.ports.cables[cable];
        let swivel = self.platform.swivel.get(cable);
        let inputs = CableInputs {
            entry: self.entry[cable],
            home_length: self.home_length[cable],
            ports: self.ports.store.load_cable(&columns.ports, batch),
            swivel: match swivel {
                Some(column) => self.readings.load(*column, batch),
                None => T::splat(self.token, f64::NAN),
            },
            tension_error: self.tension_error(batch, cable),
        };
        let constants = &self.constants[cable];
        let state = CableState::new(constants, &inputs, pose, self.down);
        let residual = state.length_row(cable, &inputs, &mut self.equations);
        if let Some(first) = self.layout.swivel {
            let at = (first + cable, cable);
            state.swivel_row(at, constants, &inputs, &mut self.equations);
        }
        if self.layout.equilibrium.is_some() {
            state.add_to_equilibrium(
                cable,
                residual,
                &self.layout,
                equilibrium,
                &mut self.equations,
            );
            equilibrium.present = equilibrium.present * inputs.ports.tension.present().1;
        }
        if self.detailed || self.is_latent {
            self.equations.length_by_tension[cable] = state.length_by_tension();
            self.equations.structure[cable] = state.structure();
        }
        for link in &self.ports.cables[cable].links {
            let slope = self.ports.store.load(link.slope, batch);
            let at = (cable, constants);
            state.link((link, slope), at, &self.layout, pose, &mut self.equations);
        }
    }

    /// Adds gravity and inertia, whitens the rows, and drops coordinates that are not free.
    #[inline(always)]
    fn whiten_equilibrium(
        &mut self,
        batch: usize,
        first: usize,
        pose: &PosePacket<T>,
        equilibrium: &mut EquilibriumRows<T>,
    ) {
        let zero = T::splat(self.token, 0.0);
        self.add_gravity(batch, pose, equilibrium);
        for k in 0..6 {
            let diagonal = entry(k, k);
            if self.in_equilibrium[k] == 0.0 {
                for q in 0..6 {
                    let (row, column) = (k.max(q), k.min(q));
                    equilibrium.covariance[entry(row, column)] = zero;
                }
                equilibrium.covariance[diagonal] = zero.lift(1.0);
                equilibrium.residual[k] = zero;
                for column in &mut equilibrium.by_pose {
                    column[k] = zero;
                }
                for column in &mut self.equations.equilibrium_by_column {
                    column[k] = zero;
                }
            } else {
                let variance = zero.lift(self.wrench_variance[k]);
                equilibrium.covariance[diagonal] = equilibrium.covariance[diagonal] + variance;
            }
        }
        factorise(&mut equilibrium.covariance, 0.0);
        self.equations.equilibrium_factor = equilibrium.covariance;
        // Where a tension was not read, a zero inverse diagonal makes the whitened rows vanish.
        let mut factor = equilibrium.covariance;
        for k in 0..6 {
            let diagonal = entry(k, k);
            factor[diagonal] = factor[diagonal] * equilibrium.present;
        }
        forward_substitute(&factor, &mut equilibrium.residual);
        for column in &mut equilibrium.by_pose {
            forward_substitute(&factor, column);
        }
        for column in &mut self.equations.equilibrium_by_column {
            forward_substitute(&factor, column);
        }
        for k in 0..6 {
            let row = first + k;
            self.equations.residual[row] = equilibrium.residual[k];
            for q in 0..6 {
                self.equations.by_pose[row][q] = equilibrium.by_pose[q][k];
            }
            let counted = equilibrium.present * zero.lift(self.in_equilibrium[k]);
            self.equations.present[row] = counted;
        }
    }

    #[inline(always)]
    fn add_gravity(
        &mut self,
        batch: usize,
        pose: &PosePacket<T>,
        equilibrium: &mut EquilibriumRows<T>,
    ) {
        let ports = self.ports.store.load_platform(&self.ports.platform, batch);
        let mass = ports.mass;
        let mut per_kilogram = constants(mass, self.gravity);
        let mut spin = [mass.lift(0.0); 3];
        if let Some(motion) = &self.ports.motion {
            let acceleration = self.ports.store.load_three(&motion.inertia, batch);
            spin = self.ports.store.load_three(&motion.inertia[3..], batch);
            for k in 0..3 {
                per_kilogram[k] = per_kilogram[k] - acceleration[k];
            }
        }
        let weight = scaled(per_kilogram, mass);
        let lever = pose.rotate(ports.center_of_mass);
        let torque = crate::real::cross(lever, weight);
        for k in 0..3 {
            equilibrium.residual[k] = equilibrium.residual[k] + weight[k];
            equilibrium.residual[3 + k] = equilibrium.residual[3 + k] + torque[k] - spin[k];
        }
        add_lever_rotation(lever, weight, equilibrium);
        for link in &self.ports.platform_links {
            let slope = self.ports.store.load(link.slope, batch);
            let (force, lever) = match link.port {
                PlatformPort::Mass => (per_kilogram, lever),
                PlatformPort::CenterOfMass(axis) => (weight, pose.rotate(unit_vector(mass, axis))),
                _ => continue,
            };
            let column = self.layout.effect_column() + link.parameter;
            let column = &mut self.equations.equilibrium_by_column[column];
            let torque = crate::real::cross(lever, force);
            for k in 0..3 {
                if matches!(link.port, PlatformPort::Mass) {
                    column[k] = force[k].mul_add(slope, column[k]);
                }
                column[3 + k] = torque[k].mul_add(slope, column[3 + k]);
            }
        }
    }

    #[inline(always)]
    fn evaluate_platform(&mut self, batch: usize, pose: &PosePacket<T>) {
        let robot = &self.problem.dataset.robot;
        let zero = T::splat(self.token, 0.0);
        let ports = self.ports.store.load_platform(&self.ports.platform, batch);
        let mut links = Vec::with_capacity(self.ports.platform_links.len());
        for link in &self.ports.platform_links {
            let slope = self.ports.store.load(link.slope, batch);
            links.push((link.port, link.own, slope));
        }
        if let (Some(row), Some(laser)) = (self.layout.laser, &robot.laser) {
            let inputs = LaserInputs {
                reading: self.readings.load(self.platform.laser, batch),
                origin: constants(zero, laser.origin_m),
                offset: self.plane_offset,
                inverse_sd: zero.lift(laser.sd_m.recip()),
                ports,
            };
            inputs.row(row, &links, &self.layout, pose, &mut self.equations);
        }
        let lag = self.lag(batch, ports.tracker_delay);
        let seen = match &lag {
            Some(lag) => pose.moved(lag.step),
            None => *pose,
        };
        if let Some(first) = self.layout.tracker_position {
            let position = &self.platform.tracker_position;
            let reading = self.readings.load_three(position, batch);
            let weight = self
                .readings
                .load_three(&self.platform.tracker_inverse_sd, batch);
            platform_rows::tracker_position_rows(
                first,
                (reading, weight),
                &ports,
                &links,
                &self.layout,
                &seen,
                &mut self.equations,
            );
        }
        let tracker_sd = robot.tracker.and_then(|t| t.orientation_sd_rad);
        if let (Some(first), Some(sd)) = (self.layout.tracker_orientation, tracker_sd) {
            let columns = &self.platform.tracker_orientation;
            let [x, y, z] = self.readings.load_three(&columns[1..], batch);
            let reading = [self.readings.load(columns[0], batch), x, y, z];
            let weight = zero.lift(sd.recip());
            platform_rows::tracker_orientation_rows(
                first,
                (reading, weight),
                &ports,
                &links,
                &self.layout,
                &seen,
                &mut self.equations,
            );
        }
        if let Some(lag) = &lag {
            lag.complete(&links, &self.layout, &mut self.equations);
        }
        if let (Some(first), Some(sensor)) = (self.layout.inclination, robot.inclinometer) {
            let reading = self.readings.load_three(&self.platform.inclination, batch);
            platform_rows::inclination_rows(
                first,
                (reading, zero.lift(sensor.sd_rad.recip())),
                &ports,
                &links,
                &self.layout,
                pose,
                &mut self.equations,
            );
        }
    }

    /// Delay of the external instrument; `None` at rest or without one.
    #[inline(always)]
    fn lag(&self, batch: usize, delay: T) -> Option<Lag<T>> {
        let motion = self.ports.motion.as_ref()?;
        self.layout
            .tracker_position
            .or(self.layout.tracker_orientation)?;
        let zero = T::splat(self.token, 0.0);
        let mut twists = [[zero; 6]; 2];
        for k in 0..6 {
            twists[0][k] = self.ports.store.load(motion.velocity[k], batch);
            twists[1][k] = self.ports.store.load(motion.acceleration[k], batch);
        }
        Some(Lag::new(twists[0], twists[1], delay))
    }
}
