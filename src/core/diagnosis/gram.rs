//! Scores and information of all candidates at given hyperparameters, and the rows of their Gram matrix.
//!
//! With `P = 1 - U U^T` of [`ReducedProblem`] and whitened columns `c`, the score is `c^T P r` and the Gram matrix
//! `c^T P d`. The Gram matrix is never formed as a whole: a set needs only its own rows, each of which costs one
//! product with the generators. Columns that act at one pose, or from one on, are sums of their generator over poses.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use std::rc::Rc;

use nalgebra::{DMatrix, DVector};

use super::budget::FEW_COLUMNS;
use super::candidates::{Candidate, CandidateColumn, PoseWeights};
use super::catalogue::Catalogue;
use super::hyperparameters::LinearProblem;
use super::reduced_problem::ReducedProblem;

/// Score and information of one candidate alone.
#[derive(Debug, Clone)]
pub(super) struct CandidateScore {
    pub score: DVector<f64>,
    pub information: DMatrix<f64>,
}

/// All candidates at given hyperparameters.
pub(super) struct Gram<'l> {
    pub candidates: &'l [Candidate],
    /// Number of cables with readings.
    pub cables: usize,
    pub base: ReducedProblem<'l>,
    linear: &'l LinearProblem,
    catalogue: &'l Catalogue,
    /// Whitened generators (conditions x generators), and `U^T` times them.
    generators: DMatrix<f64>,
    eliminated: DMatrix<f64>,
    pub scores: Vec<CandidateScore>,
    /// Index of the first column of each candidate, and the number of columns at the end.
    pub first: Vec<usize>,
    columns: Vec<CandidateColumn>,
    /// Generators that have columns acting at some poses only, with their indices among them.
    local: HashMap<usize, usize>,
    /// Weights at each pose, for each column of a wave.
    waves: Vec<DVector<f64>>,
    /// Known products of a column with all columns, and of pairs of columns, the smaller index first.
    rows: HashMap<usize, Rc<Vec<f64>>>,
    pairs: HashMap<(usize, usize), f64>,
}

impl<'l> Gram<'l> {
    /// `generators` are those of the catalogue as conditions.
    pub fn new(
        linear: &'l LinearProblem,
        base: ReducedProblem<'l>,
        catalogue: &'l Catalogue,
        generators: &DMatrix<f64>,
    ) -> Self {
        let mut whitened = generators.clone();
        base.noise.whiten(&mut whitened);
        let mut first = Vec::new();
        let mut columns: Vec<CandidateColumn> = Vec::new();
        for candidate in &catalogue.candidates {
            first.push(columns.len());
            columns.extend(&candidate.columns);
        }
        first.push(columns.len());
        let mut local = HashMap::new();
        let mut waves = Vec::new();
        for column in &columns {
            if column.pose_weights != PoseWeights::Everywhere {
                let next = local.len();
                local.entry(column.generator).or_insert(next);
            }
            if matches!(column.pose_weights, PoseWeights::Wave { .. }) {
                let poses = linear.conditions.poses;
                waves.push(DVector::from_fn(poses, |pose, _| {
                    catalogue.weight(column.pose_weights, pose)
                }));
            }
        }
        let mut gram = Self {
            candidates: &catalogue.candidates,
            cables: linear.cables(),
            linear,
            catalogue,
            eliminated: &base.eliminated * &whitened,
            base,
            generators: whitened,
            scores: Vec::new(),
            first,
            columns,
            local,
            waves,
            rows: HashMap::new(),
            pairs: HashMap::new(),
        };
        gram.scores = gram.all_scores();
        gram
    }

    fn all_scores(&self) -> Vec<CandidateScore> {
        let score = self.cross(&self.base.residual);
        let whole = self.generators.transpose() * &self.generators
            - self.eliminated.transpose() * &self.eliminated;
        let events = self.event_information();
        let mut scores = Vec::with_capacity(self.candidates.len());
        for (index, candidate) in self.candidates.iter().enumerate() {
            let generators = candidate.generators();
            let information = match candidate.columns[0].pose_weights {
                PoseWeights::Everywhere => {
                    whole.select_rows(&generators).select_columns(&generators)
                }
                PoseWeights::At(pose) => events[&generators][pose][0].clone(),
                PoseWeights::From(pose) => events[&generators][pose][1].clone(),
                PoseWeights::Wave { .. } => self.wave_information(index),
            };
            scores.push(CandidateScore {
                score: DVector::from_column_slice(&score[self.first[index]..self.first[index + 1]]),
                information,
            });
        }
        scores
    }

    /// Information of the generators of each event, for an event at each single pose and one from each pose on.
    fn event_information(&self) -> HashMap<Vec<usize>, Vec<[DMatrix<f64>; 2]>> {
        let events = self.candidates.iter().filter(|c| c.is_event());
        let groups: BTreeSet<Vec<usize>> = events.map(Candidate::generators).collect();
        let generators: Vec<usize> = groups.iter().flatten().copied().collect();
        let columns = self.generators.select_columns(&generators);
        let poses = self.linear.conditions.poses;
        let mut information = vec![Vec::with_capacity(poses); groups.len()];
        let empty = |group: &Vec<usize>| DMatrix::zeros(group.len(), group.len());
        let mut sums: Vec<DMatrix<f64>> = groups.iter().map(empty).collect();
        let mut eliminated = DMatrix::zeros(self.base.eliminated.nrows(), generators.len());
        for block in self.linear.conditions.blocks[..poses].iter().rev() {
            let (first, count) = (block.conditions.start, block.conditions.len());
            let rows = columns.rows(first, count);
            let alone = self.base.eliminated.columns(first, count) * rows;
            eliminated += &alone;
            let mut start = 0;
            for (sum, by_pose) in sums.iter_mut().zip(&mut information) {
                let k = sum.nrows();
                let square = rows.columns(start, k).tr_mul(&rows.columns(start, k));
                *sum += &square;
                let remaining = |square: &DMatrix<f64>, eliminated: &DMatrix<f64>| {
                    let part = eliminated.columns(start, k);
                    square - part.tr_mul(&part)
                };
                by_pose.push([remaining(&square, &alone), remaining(sum, &eliminated)]);
                start += k;
            }
        }
        for by_pose in &mut information {
            by_pose.reverse();
        }
        groups.into_iter().zip(information).collect()
    }

    /// A whitened column. Whitening works pose by pose, so it commutes with weighting the poses.
    fn column(&self, index: usize) -> DVector<f64> {
        self.catalogue.column(
            self.columns[index],
            &self.generators,
            &self.linear.conditions,
        )
    }

    /// `U^T` times the whitened values of a column.
    fn eliminated_part(&self, column: usize, values: &DVector<f64>) -> DVector<f64> {
        let column = &self.columns[column];
        let first = |pose: usize| self.linear.conditions.blocks[pose].conditions.start;
        let affected = match column.pose_weights {
            PoseWeights::Everywhere => {
                return self.eliminated.column(column.generator).into_owned();
            }
            PoseWeights::At(pose) => self.linear.conditions.blocks[pose].conditions.clone(),
            PoseWeights::From(pose) => first(pose)..values.len(),
            PoseWeights::Wave { .. } => 0..values.len(),
        };
        let (first, count) = (affected.start, affected.len());
        self.base.eliminated.columns(first, count) * values.rows(first, count)
    }

    fn wave_information(&self, index: usize) -> DMatrix<f64> {
        let mut columns = DMatrix::zeros(self.linear.conditions.count, 2);
        for k in 0..2 {
            columns.set_column(k, &self.column(self.first[index] + k));
        }
        let eliminated = &self.base.eliminated * &columns;
        columns.tr_mul(&columns) - eliminated.tr_mul(&eliminated)
    }

    /// Products of a column with all columns.
    pub fn row(&mut self, column: usize) -> Rc<Vec<f64>> {
        if let Some(row) = self.rows.get(&column) {
            return Rc::clone(row);
        }
        let values = self.column(column);
        let eliminated = self.eliminated_part(column, &values);
        let residual = &values - self.base.eliminated.tr_mul(&eliminated);
        let row = Rc::new(self.cross(&residual));
        self.rows.insert(column, Rc::clone(&row));
        row
    }

    /// Products of a range of columns with some columns.
    pub fn products(&mut self, range: Range<usize>, with: &[usize]) -> DMatrix<f64> {
        if range.is_empty() {
            return DMatrix::zeros(0, with.len());
        }
        let is_known = |column: &usize| self.rows.contains_key(column);
        if range.len() <= FEW_COLUMNS && !with.iter().all(is_known) {
            let columns: Vec<usize> = with.iter().copied().chain(range.clone()).collect();
            let block = self.block(&columns);
            return block
                .view((with.len(), 0), (range.len(), with.len()))
                .into_owned();
        }
        let mut products = DMatrix::zeros(range.len(), with.len());
        for (mut to, column) in products.column_iter_mut().zip(with) {
            to.copy_from_slice(&self.row(*column)[range.clone()]);
        }
        products
    }

    /// Products of some columns with each other.
    pub fn block(&mut self, columns: &[usize]) -> DMatrix<f64> {
        if columns.len() > FEW_COLUMNS {
            return self.products_among(columns);
        }
        let product = |i: usize, k: usize| {
            let (one, other) = (columns[i], columns[k]);
            let row = self.rows.get(&one).map(|row| row[other]);
            row.or_else(|| self.pairs.get(&(one.min(other), one.max(other))).copied())
        };
        let mut block = DMatrix::zeros(columns.len(), columns.len());
        for i in 0..columns.len() {
            for k in 0..=i {
                let Some(value) = product(i, k) else {
                    return self.remember(columns);
                };
                (block[(i, k)], block[(k, i)]) = (value, value);
            }
        }
        block
    }

    /// Computes the products of some columns with each other and keeps them.
    fn remember(&mut self, columns: &[usize]) -> DMatrix<f64> {
        let block = self.products_among(columns);
        for (i, one) in columns.iter().enumerate() {
            for (k, other) in columns[..=i].iter().enumerate() {
                let pair = (*one.min(other), *one.max(other));
                self.pairs.insert(pair, block[(i, k)]);
            }
        }
        block
    }

    fn products_among(&self, columns: &[usize]) -> DMatrix<f64> {
        let mut whitened = DMatrix::zeros(self.linear.conditions.count, columns.len());
        let mut eliminated = DMatrix::zeros(self.eliminated.nrows(), columns.len());
        for (k, column) in columns.iter().enumerate() {
            let values = self.column(*column);
            eliminated.set_column(k, &self.eliminated_part(*column, &values));
            whitened.set_column(k, &values);
        }
        whitened.transpose() * &whitened - eliminated.transpose() * &eliminated
    }

    /// Products of all columns with whitened conditions.
    fn cross(&self, with: &DVector<f64>) -> Vec<f64> {
        let whole = self.generators.tr_mul(with);
        let poses = self.linear.conditions.poses;
        let mut by_pose = DMatrix::zeros(poses + 1, self.local.len());
        for (generator, place) in &self.local {
            let column = self.generators.column(*generator);
            for (pose, block) in self.linear.conditions.blocks[..poses].iter().enumerate() {
                let (first, count) = (block.conditions.start, block.conditions.len());
                by_pose[(pose, *place)] = column.rows(first, count).dot(&with.rows(first, count));
            }
        }
        let mut from = by_pose.clone();
        for pose in (0..poses).rev() {
            for place in 0..self.local.len() {
                from[(pose, place)] += from[(pose + 1, place)];
            }
        }
        let mut waves = self.waves.iter();
        let product = |column: &CandidateColumn| {
            let place = || self.local[&column.generator];
            match column.pose_weights {
                PoseWeights::Everywhere => whole[column.generator],
                PoseWeights::At(pose) => by_pose[(pose, place())],
                PoseWeights::From(pose) => from[(pose, place())],
                PoseWeights::Wave { .. } => {
                    let values = by_pose.column(place());
                    waves.next().map_or(0.0, |w| w.dot(&values.rows(0, poses)))
                }
            }
        };
        self.columns.iter().map(product).collect()
    }
}
