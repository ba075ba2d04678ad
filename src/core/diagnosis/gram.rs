//! Scores and information of all candidates at given hyperparameters, and the rows of their Gram matrix.
//!
//! With `P = 1 - U U^T` of [`ReducedProblem`] and whitened columns `c`, the score is `c^T P r` and the Gram matrix
//! `c^T P d`. The Gram matrix is never formed as a whole: a set needs only its own rows, each of which costs one
//! product with the generators. Columns that act at one pose, or from one on, are sums of their generator over poses.

use std::collections::HashMap;
use std::rc::Rc;

use nalgebra::{DMatrix, DVector};

use super::candidates::{Candidate, Column, PoseWeights};
use super::catalogue::Catalogue;
use super::hyperparameters::{LinearProblem, ReducedProblem};

/// Number of unknown rows above which only the products among the columns asked for are computed.
const MANY_ROWS: usize = 24;

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
    /// Whitened generators (conditions x generators).
    generators: DMatrix<f64>,
    pub scores: Vec<CandidateScore>,
    /// Index of the first column of each candidate, and the number of columns at the end.
    pub first: Vec<usize>,
    columns: Vec<Column>,
    /// Generators that have columns acting at some poses only, with their indices among them.
    local: HashMap<usize, usize>,
    /// Weights at each pose, for each column of a wave.
    waves: Vec<DVector<f64>>,
    rows: HashMap<usize, Rc<Vec<f64>>>,
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
        let mut columns: Vec<Column> = Vec::new();
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
            base,
            linear,
            catalogue,
            generators: whitened,
            scores: Vec::new(),
            first,
            columns,
            local,
            waves,
            rows: HashMap::new(),
        };
        gram.scores = gram.all_scores();
        gram
    }

    fn all_scores(&self) -> Vec<CandidateScore> {
        let eliminated = &self.base.eliminated * &self.generators;
        let score = self.cross(&self.base.residual);
        let whole =
            self.generators.transpose() * &self.generators - eliminated.transpose() * &eliminated;
        let mut events: HashMap<Vec<usize>, Vec<[DMatrix<f64>; 2]>> = HashMap::new();
        let mut own = Vec::with_capacity(self.candidates.len());
        for (index, candidate) in self.candidates.iter().enumerate() {
            let columns = &candidate.columns;
            let generators: Vec<usize> = columns.iter().map(|c| c.generator).collect();
            let information = match columns[0].pose_weights {
                PoseWeights::Everywhere => {
                    whole.select_rows(&generators).select_columns(&generators)
                }
                PoseWeights::At(pose) | PoseWeights::From(pose) => {
                    let from = matches!(columns[0].pose_weights, PoseWeights::From(_));
                    let known = events.entry(generators.clone());
                    let known = known.or_insert_with(|| self.event_information(&generators));
                    known[pose][usize::from(from)].clone()
                }
                PoseWeights::Wave { .. } => self.wave_information(index),
            };
            own.push(CandidateScore {
                score: DVector::from_column_slice(&score[self.first[index]..self.first[index + 1]]),
                information,
            });
        }
        own
    }

    /// Information of generators that act at each single pose, and from each pose on.
    fn event_information(&self, generators: &[usize]) -> Vec<[DMatrix<f64>; 2]> {
        let columns = self.generators.select_columns(generators);
        let k = generators.len();
        let mut sum = DMatrix::zeros(k, k);
        let mut eliminated = DMatrix::zeros(self.base.eliminated.nrows(), k);
        let blocks = &self.linear.conditions.blocks[..self.linear.conditions.poses];
        let mut found: Vec<_> = blocks
            .iter()
            .rev()
            .map(|block| {
                let (first, count) = (block.conditions.start, block.conditions.len());
                let own = columns.rows(first, count);
                let square = own.tr_mul(&own);
                let alone = self.base.eliminated.columns(first, count) * own;
                sum += &square;
                eliminated += &alone;
                [
                    square - alone.tr_mul(&alone),
                    &sum - eliminated.tr_mul(&eliminated),
                ]
            })
            .collect();
        found.reverse();
        found
    }

    /// A whitened column. Whitening works pose by pose, so it commutes with weighting the poses.
    fn column(&self, index: usize) -> DVector<f64> {
        self.catalogue.column(
            self.columns[index],
            &self.generators,
            &self.linear.conditions,
        )
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
        if let Some(known) = self.rows.get(&column) {
            return Rc::clone(known);
        }
        let values = self.column(column);
        let left = &values
            - self
                .base
                .eliminated
                .tr_mul(&(&self.base.eliminated * &values));
        let row = Rc::new(self.cross(&left));
        self.rows.insert(column, Rc::clone(&row));
        row
    }

    /// Products of some columns with each other.
    pub fn block(&mut self, columns: &[usize]) -> DMatrix<f64> {
        let unknown = columns.iter().filter(|c| !self.rows.contains_key(c));
        if unknown.count() <= MANY_ROWS {
            let mut block = DMatrix::zeros(columns.len(), columns.len());
            for (mut to, column) in block.column_iter_mut().zip(columns) {
                let row = self.row(*column);
                to.copy_from_slice(&columns.iter().map(|c| row[*c]).collect::<Vec<_>>());
            }
            return block;
        }
        let mut own = DMatrix::zeros(self.linear.conditions.count, columns.len());
        for (mut to, column) in own.column_iter_mut().zip(columns) {
            to.copy_from(&self.column(*column));
        }
        let eliminated = &self.base.eliminated * &own;
        own.transpose() * &own - eliminated.transpose() * &eliminated
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
        let product = |column: &Column| {
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
