//! Evaluates the equations of many poses at once, with one pose per SIMD lane.

mod cable_rows;
mod columns;
mod effects_on_ports;
mod equations;
mod inputs;
mod layout;
mod motion;
mod noise;
mod normal;
mod packing;
mod parts;
mod platform_rows;
mod rows;
mod span;
mod steps;

use cable_rows::CableConstants;
use columns::{ColumnStore, Packed, packed};
use inputs::{NoiseGain, PortInputs, Selection, contexts_of};
use noise::NoiseSizes;
use packing::{InstrumentInputs, constants_of, pack_instruments, pack_poses};
use steps::Eliminated;

pub(super) use equations::Equations;
pub(super) use layout::Layout;
pub(super) use noise::NoiseEstimate;
pub(super) use normal::{Elimination, Sums};
pub(super) use parts::Parts;

use std::sync::Arc;

use super::globals::Globals;
use super::problem::{Poses, Problem};
use crate::effect::{CablePort, PoseContexts};
use crate::geometry::{Pose, PosePacket};
use crate::measurement::Grid;
use crate::real::{Kernel, Packet};

/// Largest estimated error of a tension reading at which the equations are linearised, in its standard deviations.
const LARGEST_ERROR: f64 = 5.0;
/// Numbers per pose: position and quaternion.
const POSE_NUMBERS: usize = 7;

/// The equations of a set of poses, packed for evaluation.
#[derive(Clone)]
pub(super) struct Evaluator<'a, T: Packet> {
    token: T::Token,
    problem: &'a Problem<'a>,
    selection: Selection,
    /// Whether tensions are latent variables.
    is_latent: bool,
    pub layout: Layout,
    ports: PortInputs<T>,
    /// Values of the effects and deviations at which the ports were packed.
    packed_at: Vec<Vec<f64>>,
    readings: ColumnStore<T>,
    platform: InstrumentInputs,
    constants: Vec<CableConstants>,
    entry: Vec<[T; 3]>,
    home_length: Vec<T>,
    plane_offset: T,
    down: [f64; 3],
    gravity: [f64; 3],
    wrench_variance: [f64; 6],
    /// 1 for coordinates in which the poses are free, otherwise 0.
    free: [f64; 6],
    /// 1 for components of the wrench that are in equilibrium, otherwise 0.
    in_equilibrium: [f64; 6],
    /// Whether the equations include the details needed only by the home row and by reports.
    pub detailed: bool,
    /// Poses, packet by packet; the previous ones are kept so that a step can be undone.
    packed_poses: Packed,
    previous: Packed,
    /// Elimination of the poses by the last pass, from which their next step follows.
    eliminated: Eliminated,
    /// Estimated errors of the tension readings (N), by packet and cable.
    tension_errors: Packed,
    equations: Equations<T>,
    elimination: Elimination<T>,
    pub sums: Sums<T>,
}

impl<'a, T: Packet> Evaluator<'a, T> {
    /// Packs the poses of `rows`, starting from `start`.
    pub fn new(
        token: T::Token,
        problem: &'a Problem<'a>,
        globals: &Globals,
        rows: Vec<usize>,
        start: &[Pose],
    ) -> Self {
        let selection = Selection {
            noise_row: rows.first().copied(),
            rows,
            is_home: false,
            contexts: contexts_of(problem),
        };
        Self::build(token, problem, globals, selection, start)
    }

    /// Packs the home row: its lengths are predictions, its tensions not latent.
    pub fn home(token: T::Token, problem: &'a Problem<'a>, globals: &Globals, row: usize) -> Self {
        let selection = Selection {
            rows: vec![row],
            is_home: true,
            contexts: contexts_of(problem),
            noise_row: Some(row),
        };
        Self::build(token, problem, globals, selection, &[globals.home])
    }

    fn build(
        token: T::Token,
        problem: &'a Problem<'a>,
        globals: &Globals,
        selection: Selection,
        start: &[Pose],
    ) -> Self {
        let is_home = selection.is_home;
        let robot = &problem.dataset.robot;
        let zero = T::splat(token, 0.0);
        let layout = Layout::new(problem);
        let mut readings = ColumnStore::new(token);
        let platform = pack_instruments(&mut readings, problem, &layout, &selection.rows);
        let ports = PortInputs::build(token, problem, globals, &selection, &layout);
        let packed_at = values_of(globals);
        let gravity = robot.gravity();
        let down = gravity.try_normalize(0.0).unwrap_or_default().into();
        let moving = problem.poses == Poses::Estimated || is_home;
        let mut in_equilibrium = [0.0; 6];
        for coordinate in robot.platform.freedom().coordinates() {
            in_equilibrium[coordinate.index()] = 1.0;
        }
        let free = if moving { in_equilibrium } else { [0.0; 6] };
        let wrench = robot.wrench_sd();
        let wrench_variance = std::array::from_fn(|k| {
            wrench.map_or(1.0, |sd| {
                if k < 3 { sd.force_n } else { sd.torque_nm }.powi(2)
            })
        });
        let constants = constants_of(problem, is_home);
        let packets = selection.rows.len().div_ceil(T::LANES);
        let mut evaluator = Self {
            tension_errors: packed(packets * robot.cable_count() * T::LANES),
            constants,
            entry: Vec::new(),
            home_length: vec![zero; robot.cable_count()],
            plane_offset: zero,
            down,
            gravity: gravity.into(),
            wrench_variance,
            free,
            in_equilibrium,
            detailed: is_home,
            packed_poses: pack_poses::<T>(start),
            previous: packed(0),
            eliminated: Eliminated::nothing(),
            equations: Equations::new(&layout, zero),
            elimination: Elimination::new(&layout, zero),
            sums: Sums::new(token, &layout),
            token,
            problem,
            selection,
            is_latent: problem.has_latent_tension() && !is_home,
            layout,
            ports,
            packed_at,
            readings,
            platform,
        };
        evaluator.set_globals(globals, None);
        evaluator
    }

    /// Replaces the contexts; takes effect with the next `set_globals`.
    pub fn set_contexts(&mut self, contexts: Arc<PoseContexts>) {
        self.selection.contexts = Some(contexts);
        self.packed_at.clear();
    }

    /// Number of packets.
    pub fn batches(&self) -> usize {
        self.selection.rows.len().div_ceil(T::LANES)
    }

    /// Packed rows of the measurements, in order.
    pub fn rows(&self) -> &[usize] {
        &self.selection.rows
    }

    /// Sets the common parameters; `home_lengths` are the unstrained lengths at home, or the
    /// run-in lengths from drum to pulley where readings are absolute.
    pub fn set_globals(&mut self, globals: &Globals, home_lengths: Option<&[f64]>) {
        let splat = |v: f64| T::splat(self.token, v);
        self.entry = globals.entry_points.iter().map(|p| p.map(splat)).collect();
        self.plane_offset = splat(globals.plane_offset_m);
        for (cable, constants) in self.constants.iter().enumerate() {
            self.home_length[cable] = splat(match home_lengths {
                Some(lengths) => lengths[cable],
                None if self.selection.is_home => 0.0,
                None => constants.run,
            });
        }
        let values = values_of(globals);
        // The tensions at home are parameters of their own.
        if values != self.packed_at || self.selection.is_home {
            let (selection, layout) = (&self.selection, &self.layout);
            self.ports = PortInputs::build(self.token, self.problem, globals, selection, layout);
            self.packed_at = values;
        }
        if !self.selection.is_home && !self.packed_at.is_empty() {
            self.scale_noise(globals);
        }
    }

    fn scale_noise(&mut self, globals: &Globals) {
        let nominal = constants_of(self.problem, false);
        for (index, (constants, nominal)) in self.constants.iter_mut().zip(&nominal).enumerate() {
            let gain = NoiseGain::of(self.problem, globals, &self.selection, index);
            constants.length_sd = nominal.length_sd * gain.length;
            constants.tension_sd = nominal.tension_sd * gain.tension;
        }
    }

    /// Moves the poses by the step taken last, evaluates all packets there and accumulates the normal equations.
    pub fn assemble(&mut self, huber: Option<f64>, damping: f64) {
        self.sums.clear();
        let step = self.begin_elimination(huber, damping);
        let token = self.token;
        T::run(
            token,
            Assemble {
                stores: self.is_stored(),
                evaluator: self,
                step: step.as_deref(),
                huber,
                damping,
            },
        );
    }

    #[inline(always)]
    fn assemble_batch(
        &mut self,
        batch: usize,
        pose: &PosePacket<T>,
        huber: Option<f64>,
        damping: f64,
    ) {
        self.evaluate(batch, pose);
        let loss = match huber {
            Some(limit) => self.equations.weigh_down_outliers(&self.layout, limit),
            None => self.equations.square_sum(),
        };
        self.sums.loss += loss.sum();
        self.elimination
            .eliminate(&self.equations, &self.layout, damping);
        self.sums
            .add(&self.equations, &self.elimination, &self.layout);
    }

    /// The poses of a packet.
    #[inline(always)]
    pub fn pose_packet(&self, batch: usize) -> PosePacket<T> {
        let zero = T::splat(self.token, 0.0);
        let first = batch * POSE_NUMBERS;
        PosePacket::new(
            load_all(self.token, &self.packed_poses, first, zero),
            load_all(self.token, &self.packed_poses, first + 3, zero),
        )
    }

    #[inline(always)]
    fn store_pose(&mut self, batch: usize, pose: &PosePacket<T>) {
        store_all(&pose.position, &mut self.packed_poses, batch * POSE_NUMBERS);
        store_all(
            &pose.quaternion,
            &mut self.packed_poses,
            batch * POSE_NUMBERS + 3,
        );
    }

    /// The present poses, in the order of the rows.
    pub fn poses(&self) -> Vec<Pose> {
        let at = |index: usize, k: usize| {
            let (batch, lane) = (index / T::LANES, index % T::LANES);
            self.packed_poses[(batch * POSE_NUMBERS + k) * T::LANES + lane]
        };
        let pose = |index: usize| {
            Pose::from_parts(
                std::array::from_fn(|k| at(index, k)),
                std::array::from_fn(|k| at(index, 3 + k)),
            )
        };
        (0..self.selection.rows.len()).map(pose).collect()
    }

    /// Sets the pose of the only packed row.
    pub fn set_single_pose(&mut self, pose: &Pose) {
        self.packed_poses = pack_poses::<T>(std::slice::from_ref(pose));
    }

    /// Estimated error of a cable's tension reading (N) from the last evaluation of the packet. Far from the solution the
    /// estimates are meaningless, so they are limited.
    #[inline(always)]
    fn tension_error(&self, batch: usize, cable: usize) -> T {
        let at = batch * self.layout.cables + cable;
        let limit = T::splat(self.token, LARGEST_ERROR * self.constants[cable].tension_sd);
        T::load(self.token, &self.tension_errors, at)
            .min(limit)
            .max(-limit)
    }

    /// Writes the estimated tensions (N) at the packed rows into a grid of all rows.
    pub fn write_tensions(&self, to: &mut Grid) {
        let mut lanes = vec![0.0; T::LANES];
        for (index, row) in self.selection.rows.iter().enumerate() {
            let batch = index / T::LANES;
            for cable in 0..self.layout.cables {
                let read = self.cable_port(batch, cable, CablePort::Tension);
                (read - self.tension_error(batch, cable)).store(&mut lanes, 0);
                to.set(*row, cable, lanes[index % T::LANES]);
            }
        }
    }

    /// Updates the estimated errors of the tension readings from the present equations.
    #[inline(always)]
    fn update_tension_errors(&mut self, batch: usize) {
        let first = batch * self.layout.cables;
        let lambda = self.equations.equilibrium_multipliers(&self.layout);
        for (cable, constants) in self.constants.iter().enumerate() {
            let variance = constants.tension_sd * constants.tension_sd;
            let error = self.equations.tension_error(cable, variance, &lambda);
            error.store(&mut self.tension_errors, first + cable);
        }
    }

    /// Standard deviation of a length (m), with the scaling by effects.
    pub fn length_sd(&self, cable: usize) -> f64 {
        self.constants[cable].length_sd
    }

    /// Standard deviation of a tension (N), with the scaling by effects; 0 where tensions are exact.
    pub fn tension_sd(&self, cable: usize) -> f64 {
        self.constants[cable].tension_sd
    }

    /// Variance of a component of the unexplained wrench (N^2, N^2 m^2).
    pub fn wrench_variance(&self, coordinate: usize) -> f64 {
        self.wrench_variance[coordinate]
    }

    /// Estimated noise of each reading as a function of the equations evaluated last.
    #[inline(always)]
    pub fn noise_estimates(&self) -> Vec<NoiseEstimate<T>> {
        let tensions = self.constants.iter().filter(|_| self.is_latent);
        let sizes = NoiseSizes {
            length_m: self.constants.iter().map(|c| c.length_sd).collect(),
            tension_n: tensions.map(|c| c.tension_sd).collect(),
            wrench: self.wrench_variance.map(f64::sqrt),
        };
        self.equations.noise_estimates(&self.layout, &sizes)
    }

    /// The equations evaluated last.
    pub fn equations(&self) -> &Equations<T> {
        &self.equations
    }

    /// Value of a port of a cable.
    pub fn cable_port(&self, batch: usize, cable: usize, port: CablePort) -> T {
        let column = self.ports.cables[cable].ports.get(port);
        self.ports.store.load(column, batch)
    }

    /// Equations of a packet at its present poses.
    ///
    /// A kernel of its own, so that the evaluation is compiled once per instruction set instead of
    /// once per use.
    #[inline(never)]
    pub fn equations_at(&mut self, batch: usize) -> &mut Equations<T> {
        let token = self.token;
        T::run(
            token,
            Evaluate {
                evaluator: self,
                batch,
            },
        );
        &mut self.equations
    }
}

/// Values of everything that changes the prediction.
fn values_of(globals: &Globals) -> Vec<Vec<f64>> {
    let values = globals.acting().map(|bound| bound.values.clone());
    values.collect()
}

#[inline(always)]
fn load_all<T: Packet, const N: usize>(
    token: T::Token,
    slice: &[f64],
    first: usize,
    zero: T,
) -> [T; N] {
    let mut values = [zero; N];
    for (k, value) in values.iter_mut().enumerate() {
        *value = T::load(token, slice, first + k);
    }
    values
}

#[inline(always)]
fn store_all<T: Packet>(values: &[T], slice: &mut [f64], first: usize) {
    for (k, value) in values.iter().enumerate() {
        value.store(slice, first + k);
    }
}

/// One pass over all packets.
struct Assemble<'e, 'a, T: Packet> {
    evaluator: &'e mut Evaluator<'a, T>,
    step: Option<&'e [f64]>,
    huber: Option<f64>,
    damping: f64,
    /// Whether the pass stores the elimination.
    stores: bool,
}

impl<T: Packet> Kernel for Assemble<'_, '_, T> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let evaluator = self.evaluator;
        for batch in 0..evaluator.batches() {
            let pose = match self.step {
                Some(step) => evaluator.move_packet(batch, step),
                None => evaluator.pose_packet(batch),
            };
            evaluator.assemble_batch(batch, &pose, self.huber, self.damping);
            if self.stores {
                evaluator.store_elimination(batch);
            }
        }
    }
}

/// Evaluation of one packet at its present poses.
struct Evaluate<'e, 'a, T: Packet> {
    evaluator: &'e mut Evaluator<'a, T>,
    batch: usize,
}

impl<T: Packet> Kernel for Evaluate<'_, '_, T> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        let pose = self.evaluator.pose_packet(self.batch);
        self.evaluator.evaluate(self.batch, &pose);
    }
}
