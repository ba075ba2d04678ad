//! Poses divided into parts, which are evaluated on separate threads and summed in order.
//!
//! The division depends on the numbers of poses and parameters only, so that any number of threads gives the same result to the last
//! bit. A small number of poses is one part and starts no thread.

use std::sync::Arc;

use super::inputs::{Selection, contexts_of};
use super::layout::Layout;
use super::normal::{Elimination, Sums};
use super::steps::LARGEST_STORE;
use super::{Evaluator, Globals, Pose, Problem};
use crate::estimation::options::Division;
use crate::measurement::Grid;
use crate::real::Packet;
use crate::threads;

/// Equations of a set of poses, with one evaluator per part.
#[derive(Clone)]
pub(in crate::estimation) struct Parts<'a, T: Packet> {
    /// At least one; the first holds the sums over all parts.
    parts: Vec<Evaluator<'a, T>>,
    poses_per_part: usize,
    threads: usize,
}

impl<'a, T: Packet> Parts<'a, T> {
    /// Packs the poses of `rows`, starting from `start`.
    pub fn new(
        token: T::Token,
        problem: &'a Problem<'a>,
        globals: &Globals,
        (rows, start): (&[usize], &[Pose]),
        division: Division,
    ) -> Self {
        let size = division.part_size(rows.len(), Layout::new(problem).columns);
        let count = rows.len().div_ceil(size).max(1);
        let threads = match (count, division.threads) {
            (1, _) => 1,
            (_, Some(most)) => most,
            (_, None) => threads::available(),
        };
        let contexts = contexts_of(problem);
        let part = |index: usize| {
            let range = index * size..rows.len().min((index + 1) * size);
            let selection = Selection {
                rows: rows[range.clone()].to_vec(),
                is_home: false,
                contexts: contexts.as_ref().map(Arc::clone),
                noise_row: rows.first().copied(),
            };
            let start = &start[range];
            let mut part = Evaluator::build(token, problem, globals, selection, start);
            // Distances act on the stored elimination.
            part.eliminated.largest_store = match problem.has_distances() {
                true => usize::MAX,
                false => LARGEST_STORE / count,
            };
            part
        };
        Self {
            parts: threads::map(count, threads, part),
            poses_per_part: size,
            threads,
        }
    }

    /// Applies `work` to every part.
    fn for_each(&mut self, work: impl Fn(&mut Evaluator<'a, T>) + Sync) {
        threads::for_each(&mut self.parts, self.threads, work);
    }

    /// Applies a function to every part, each with a value made by `with`; returns those values in the order of the parts.
    pub fn work_out<R: Send>(
        &mut self,
        with: impl FnMut() -> R,
        work: impl Fn(&mut Evaluator<'a, T>, &mut R) + Sync,
    ) -> Vec<R> {
        let made = std::iter::repeat_with(with);
        let mut pairs: Vec<_> = self.parts.iter_mut().zip(made).collect();
        threads::for_each(&mut pairs, self.threads, |(part, own)| work(part, own));
        pairs.into_iter().map(|(_, own)| own).collect()
    }

    /// The evaluator of the part that contains pose number `pose`, and the index of the pose there.
    pub fn part_with(&mut self, pose: usize) -> (&mut Evaluator<'a, T>, usize) {
        let size = self.poses_per_part;
        (&mut self.parts[pose / size], pose % size)
    }

    /// Elimination of pose number `pose` by the last pass, which has stored it.
    pub fn elimination(&self, pose: usize) -> Elimination<f64> {
        let size = self.poses_per_part;
        self.parts[pose / size].elimination_of(pose % size)
    }

    /// Adds to the eliminated residual of pose number `pose`, see [`Evaluator::add_to_residual`].
    pub fn add_to_residual(&mut self, pose: usize, more: &[f64; 6]) {
        let (part, index) = self.part_with(pose);
        part.add_to_residual(index, more);
    }

    /// Layout of rows and columns.
    pub fn layout(&self) -> &Layout {
        &self.parts[0].layout
    }

    /// Sums of the last [`assemble`](Self::assemble).
    pub fn sums(&self) -> &Sums<T> {
        &self.parts[0].sums
    }

    /// Number of poses.
    pub fn len(&self) -> usize {
        self.parts.iter().map(|part| part.rows().len()).sum()
    }

    /// The present poses with their rows of the measurements, in order.
    pub fn poses(&self) -> impl Iterator<Item = (usize, Pose)> {
        let parts = self.parts.iter();
        parts.flat_map(|part| part.rows().iter().copied().zip(part.poses()))
    }

    /// Estimated tensions (N) of all cables at all rows, from the last pass; NaN at rows that are not packed.
    pub fn tensions(&self, rows: usize) -> Grid {
        let mut all = Grid::missing(rows, self.layout().cables);
        for part in &self.parts {
            part.write_tensions(&mut all);
        }
        all
    }

    /// Makes the equations carry the details that only reports need.
    pub fn set_detailed(&mut self) {
        for part in &mut self.parts {
            part.detailed = true;
        }
    }

    /// Sets the common parameters, see [`Evaluator::set_globals`].
    pub fn set_globals(&mut self, globals: &Globals, home_lengths: &[f64]) {
        self.for_each(|part| part.set_globals(globals, Some(home_lengths)));
    }

    /// Finds the tensions at which the next pass linearises; each evaluation brings them closer.
    pub fn find_tensions(&mut self) {
        self.for_each(|part| {
            for batch in 0..part.batches() {
                part.equations_at(batch);
                part.equations_at(batch);
            }
        });
    }

    /// Moves the poses by the step taken last, evaluates all of them and accumulates the normal equations.
    pub fn assemble(&mut self, huber: Option<f64>, damping: f64) {
        self.for_each(|part| part.assemble(huber, damping));
        if let Some((first, rest)) = self.parts.split_first_mut() {
            for part in rest {
                first.sums.add_sums(&part.sums);
            }
        }
    }

    /// Moves all poses by their part of the common `step`, see [`Evaluator::take_step`].
    pub fn take_step(&mut self, step: &[f64]) {
        self.for_each(|part| part.take_step(step));
    }

    /// Goes back to the poses before the last step.
    pub fn undo_step(&mut self) {
        self.for_each(Evaluator::undo_step);
    }

    /// Moves all poses by their part of the common `step` now.
    pub fn move_poses(&mut self, step: &[f64]) {
        self.for_each(|part| part.move_poses(step));
    }
}
