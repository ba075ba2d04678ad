//! Steps of the poses once the common step is known.
//!
//! A pose moves by `-L^-T (y + Y dg)`, see [`super::normal`]. If there are few poses, the pass that eliminates them stores
//! `L`, `y` and `Y`: 1.8 kB for a pose of eight cables. If there are many, these exceed the caches of a processor, and
//! writing and reading them takes longer than the elimination itself, so the poses are eliminated again in the state in
//! which that pass found them.

use super::columns::{Packed, packed};
use super::normal::Elimination;
use super::{Evaluator, load_all, store_all};
use crate::geometry::PosePacket;
use crate::real::{Kernel, Packet};
use crate::small_cholesky::TRIANGLE;

/// Scalars per pose that a step needs, in addition to `Y`.
const FACTOR_AND_RESIDUAL: usize = TRIANGLE + 6;
/// Largest number of scalars stored: 16 MiB.
pub(super) const LARGEST_STORE: usize = 2 << 20;

/// Elimination of the poses by the last pass, or the state needed to repeat it.
#[derive(Clone)]
pub(super) struct Eliminated {
    /// Factor, residual and `Y` of every packet; empty if poses are eliminated again.
    stored: Packed,
    /// Largest number of scalars stored.
    pub largest_store: usize,
    /// Estimated errors of the tension readings at which the equilibrium was linearised (N).
    tension_errors: Packed,
    huber: Option<f64>,
    damping: f64,
    /// The common step (per column) by which the next pass moves the poses before it eliminates them.
    step: Option<Vec<f64>>,
}

impl Eliminated {
    pub fn nothing() -> Self {
        Self {
            stored: packed(0),
            largest_store: LARGEST_STORE,
            tension_errors: packed(0),
            huber: None,
            damping: 0.0,
            step: None,
        }
    }
}

impl<T: Packet> Evaluator<'_, T> {
    /// Schedules a move of all poses by their part of the common `step` (per column), made by the next
    /// [`assemble`](Self::assemble) at the latest. Call it before [`set_globals`](Self::set_globals) moves the common parameters.
    pub fn take_step(&mut self, step: &[f64]) {
        self.previous.clone_from(&self.packed_poses);
        if self.is_stored() {
            self.eliminated.step = Some(step.to_vec());
        } else {
            self.move_poses(step);
        }
    }

    /// Restores the poses before the last step.
    pub fn undo_step(&mut self) {
        std::mem::swap(&mut self.packed_poses, &mut self.previous);
    }

    /// Moves all poses by their part of the common `step` (per column) immediately.
    pub fn move_poses(&mut self, step: &[f64]) {
        let token = self.token;
        if self.is_stored() {
            let evaluator = self;
            return T::run(token, MovePoses { evaluator, step });
        }
        // The estimated errors of the last pass are used only once: the next pass replaces them.
        std::mem::swap(
            &mut self.tension_errors,
            &mut self.eliminated.tension_errors,
        );
        let evaluator = &mut *self;
        T::run(token, MovePosesAgain { evaluator, step });
        std::mem::swap(
            &mut self.tension_errors,
            &mut self.eliminated.tension_errors,
        );
    }

    /// Begins a pass that eliminates the poses; returns the step by which it moves them first.
    pub(super) fn begin_elimination(
        &mut self,
        huber: Option<f64>,
        damping: f64,
    ) -> Option<Vec<f64>> {
        (self.eliminated.huber, self.eliminated.damping) = (huber, damping);
        if self.is_stored() {
            let size = self.batches() * self.stored_per_packet();
            self.eliminated.stored.resize(size, 0.0);
        } else {
            let errors = &mut self.eliminated.tension_errors;
            errors.clone_from(&self.tension_errors);
        }
        self.eliminated.step.take()
    }

    /// Whether the pass that eliminates the poses stores the elimination for their steps; not if it were too large.
    pub(super) fn is_stored(&self) -> bool {
        self.batches() * self.stored_per_packet() <= self.eliminated.largest_store
    }

    /// Elimination of one pose by the last pass, which has stored it.
    pub fn elimination_of(&self, index: usize) -> Elimination<f64> {
        let at = |k: usize| self.eliminated.stored[self.stored_at(index, k)];
        let column = |c: usize| std::array::from_fn(|k| at(FACTOR_AND_RESIDUAL + 6 * c + k));
        Elimination {
            factor: std::array::from_fn(at),
            residual: std::array::from_fn(|k| at(TRIANGLE + k)),
            columns: (0..self.layout.columns).map(column).collect(),
        }
    }

    /// Adds to the stored `y` of one pose, from which its next step follows.
    pub fn add_to_residual(&mut self, index: usize, more: &[f64; 6]) {
        for (k, more) in more.iter().enumerate() {
            let at = self.stored_at(index, TRIANGLE + k);
            self.eliminated.stored[at] += more;
        }
    }

    fn stored_at(&self, index: usize, scalar: usize) -> usize {
        let (batch, lane) = (index / T::LANES, index % T::LANES);
        batch * self.stored_per_packet() + scalar * T::LANES + lane
    }

    fn stored_per_packet(&self) -> usize {
        (FACTOR_AND_RESIDUAL + 6 * self.layout.columns) * T::LANES
    }

    #[inline(always)]
    pub(super) fn move_packet(&mut self, batch: usize, step: &[f64]) -> PosePacket<T> {
        let pose = self.pose_packet(batch).moved(self.pose_step(batch, step));
        self.store_pose(batch, &pose);
        pose
    }

    #[inline(always)]
    pub(super) fn store_elimination(&mut self, batch: usize) {
        let size = self.stored_per_packet();
        let slot = &mut self.eliminated.stored[batch * size..(batch + 1) * size];
        store_all(&self.elimination.factor, slot, 0);
        store_all(&self.elimination.residual, slot, TRIANGLE);
        for (column, values) in self.elimination.columns.iter().enumerate() {
            store_all(values, slot, FACTOR_AND_RESIDUAL + 6 * column);
        }
    }

    #[inline(always)]
    fn pose_step(&self, batch: usize, step: &[f64]) -> [T; 6] {
        let size = self.stored_per_packet();
        let slot = &self.eliminated.stored[batch * size..(batch + 1) * size];
        let zero = T::splat(self.token, 0.0);
        let factor = load_all(self.token, slot, 0, zero);
        let residual = load_all(self.token, slot, TRIANGLE, zero);
        let mut moved = [zero; 6];
        for (column, delta) in step.iter().enumerate() {
            let delta = T::splat(self.token, *delta);
            for k in 0..6 {
                let y = T::load(self.token, slot, FACTOR_AND_RESIDUAL + 6 * column + k);
                moved[k] = y.mul_add(delta, moved[k]);
            }
        }
        Elimination::pose_step(&factor, residual, moved)
    }

    /// Repeats the elimination of the last pass for a packet, and moves its poses.
    #[inline(always)]
    fn move_packet_again(&mut self, batch: usize, step: &[f64]) {
        self.equations_at(batch);
        if let Some(limit) = self.eliminated.huber {
            self.equations.weigh_down_outliers(&self.layout, limit);
        }
        self.elimination
            .eliminate(&self.equations, &self.layout, self.eliminated.damping);
        let zero = T::splat(self.token, 0.0);
        let mut moved = [zero; 6];
        for (y, delta) in self.elimination.columns.iter().zip(step) {
            let delta = T::splat(self.token, *delta);
            for k in 0..6 {
                moved[k] = y[k].mul_add(delta, moved[k]);
            }
        }
        let (factor, residual) = (&self.elimination.factor, self.elimination.residual);
        let step = Elimination::pose_step(factor, residual, moved);
        let pose = self.pose_packet(batch).moved(step);
        self.store_pose(batch, &pose);
    }
}

/// Moves poses whose elimination is stored.
struct MovePoses<'e, 'a, T: Packet> {
    evaluator: &'e mut Evaluator<'a, T>,
    step: &'e [f64],
}

impl<T: Packet> Kernel for MovePoses<'_, '_, T> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        for batch in 0..self.evaluator.batches() {
            self.evaluator.move_packet(batch, self.step);
        }
    }
}

/// Moves poses by repeating their elimination.
struct MovePosesAgain<'e, 'a, T: Packet> {
    evaluator: &'e mut Evaluator<'a, T>,
    step: &'e [f64],
}

impl<T: Packet> Kernel for MovePosesAgain<'_, '_, T> {
    type Output = ();
    #[inline(always)]
    fn call(self) {
        for batch in 0..self.evaluator.batches() {
            self.evaluator.move_packet_again(batch, self.step);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::Problem;
    use crate::estimation::globals::Globals;
    use crate::robot::presets;
    use crate::simulation::{SimulationOptions, simulate};

    #[test]
    fn poses_that_are_eliminated_again_move_as_those_whose_elimination_is_stored() {
        let preset = presets::find("mini").unwrap();
        let run = simulate(&preset.robot, &SimulationOptions::new(11, 4)).unwrap();
        let problem = Problem::new(&run.dataset).unwrap();
        let globals = Globals::nominal(&problem);
        let rows = problem.pose_rows();
        let start = vec![globals.home; rows.len()];
        for huber in [None, Some(1.5)] {
            let mut stored = Evaluator::<f64>::new((), &problem, &globals, rows.clone(), &start);
            let mut again = stored.clone();
            again.eliminated.largest_store = 0;
            for damping in [1e-2, 0.0, 0.0] {
                for evaluator in [&mut stored, &mut again] {
                    evaluator.assemble(huber, damping);
                    let columns = evaluator.layout.columns;
                    let step: Vec<f64> = (0..columns).map(|k| 1e-4 * (k as f64 - 7.0)).collect();
                    evaluator.take_step(&step);
                    let mut moved = globals.clone();
                    moved.plane_offset_m += 1e-3;
                    evaluator.set_globals(&moved, None);
                }
            }
            // With a stored elimination, the poses move in the next pass.
            stored.assemble(huber, 0.0);
            again.assemble(huber, 0.0);
            assert!(again.eliminated.stored.is_empty());
            assert_eq!(stored.packed_poses, again.packed_poses);
            assert_eq!(stored.sums.information(), again.sums.information());
            assert_eq!(stored.sums.gradient(), again.sums.gradient());
            let moved = stored.poses()[3].difference(&start[3]);
            assert!(moved.norm() > 1e-3, "they moved: {moved}");
        }
    }
}
