//! Scores and information of all candidates at given hyperparameters, and the rows of their Gram matrix.
//!
//! With `P = 1 - U U^T` of [`Base`] and whitened columns `c`, the score is `c^T P r` and the Gram matrix `c^T P d`. The
//! Gram matrix is never formed as a whole: a set needs only its own rows, each of which costs one product with the
//! generators. Columns that act at one pose, or from one on, are sums of their generator over poses.

use std::collections::HashMap;
use std::rc::Rc;

use nalgebra::{DMatrix, DVector};

use super::candidates::{Acts, Candidate, Column};
use super::catalogue::Catalogue;
use super::hyperparameters::{Base, Linear};

/// Score and information of one candidate alone.
#[derive(Debug, Clone)]
pub(super) struct Own {
    pub score: DVector<f64>,
    pub information: DMatrix<f64>,
}

/// All candidates at given hyperparameters.
pub(super) struct Gram<'l> {
    pub candidates: &'l [Candidate],
    /// Number of cables with readings.
    pub cables: usize,
    pub base: Base<'l>,
    linear: &'l Linear,
    catalogue: &'l Catalogue,
    /// Whitened generators (conditions x generators).
    generators: DMatrix<f64>,
    pub own: Vec<Own>,
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
        linear: &'l Linear,
        base: Base<'l>,
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
            if column.acts != Acts::Everywhere {
                let next = local.len();
                local.entry(column.generator).or_insert(next);
            }
            if matches!(column.acts, Acts::Wave { .. }) {
                let poses = linear.conditions.poses;
                waves.push(DVector::from_fn(poses, |pose, _| {
                    catalogue.weight(column.acts, pose)
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
            own: Vec::new(),
            first,
            columns,
            local,
            waves,
            rows: HashMap::new(),
        };
        gram.own = gram.own_of_all();
        gram
    }

    fn own_of_all(&self) -> Vec<Own> {
        let taken = &self.base.taken * &self.generators;
        let score = self.cross(&self.base.residual);
        let whole = self.generators.transpose() * &self.generators - taken.transpose() * &taken;
        let mut events: HashMap<Vec<usize>, Vec<[DMatrix<f64>; 2]>> = HashMap::new();
        let mut own = Vec::with_capacity(self.candidates.len());
        for (index, candidate) in self.candidates.iter().enumerate() {
            let columns = &candidate.columns;
            let generators: Vec<usize> = columns.iter().map(|c| c.generator).collect();
            let information = match columns[0].acts {
                Acts::Everywhere => whole.select_rows(&generators).select_columns(&generators),
                Acts::At(pose) | Acts::From(pose) => {
                    let from = matches!(columns[0].acts, Acts::From(_));
                    let known = events.entry(generators.clone());
                    let known = known.or_insert_with(|| self.event_information(&generators));
                    known[pose][usize::from(from)].clone()
                }
                Acts::Wave { .. } => self.wave_information(index),
            };
            own.push(Own {
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
        let mut taken = DMatrix::zeros(self.base.taken.nrows(), k);
        let blocks = &self.linear.conditions.blocks[..self.linear.conditions.poses];
        let mut found: Vec<_> = blocks
            .iter()
            .rev()
            .map(|block| {
                let (first, count) = (block.conditions.start, block.conditions.len());
                let own = columns.rows(first, count);
                let square = own.tr_mul(&own);
                let alone = self.base.taken.columns(first, count) * own;
                sum += &square;
                taken += &alone;
                [square - alone.tr_mul(&alone), &sum - taken.tr_mul(&taken)]
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
        let taken = &self.base.taken * &columns;
        columns.tr_mul(&columns) - taken.tr_mul(&taken)
    }

    /// Products of a column with all columns.
    pub fn row(&mut self, column: usize) -> Rc<Vec<f64>> {
        if let Some(known) = self.rows.get(&column) {
            return Rc::clone(known);
        }
        let values = self.column(column);
        let left = &values - self.base.taken.tr_mul(&(&self.base.taken * &values));
        let row = Rc::new(self.cross(&left));
        self.rows.insert(column, Rc::clone(&row));
        row
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
            match column.acts {
                Acts::Everywhere => whole[column.generator],
                Acts::At(pose) => by_pose[(pose, place())],
                Acts::From(pose) => from[(pose, place())],
                Acts::Wave { .. } => {
                    let values = by_pose.column(place());
                    waves.next().map_or(0.0, |w| w.dot(&values.rows(0, poses)))
                }
            }
        };
        self.columns.iter().map(product).collect()
    }
}
