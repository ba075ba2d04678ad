//! The score test of every question at one solution.
//!
//! With the projected columns `C` of a cause (what it changes in the readings and nothing else could), the projected
//! residual `r` and the prior covariance `P` of its parameters, the gain of chi-square is
//! `s^T (I + P^-1)^-1 s`, `s = C^T r`, `I = C^T C`; without the cause it is less than the chi-square distributed
//! `s^T I^-1 s`.
//! The evidence, twice its logarithm, is the gain less the logarithm of the number of readings for each direction that
//! the data show (Schwarz 1978), less twice the logarithm of the number of poses for an event that could have
//! been at any of them. Priors of typical sizes are too rough for the exact term `ln det(1 + P I)`, which structure
//! without a name uses, whose size is fitted.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::fit::Fit;
use super::moments::{Moments, PoseMoments};
use super::questions::{Question, asked, periods, prior_of, questions_of};
use super::report::Cause;
use super::space::Space;
use crate::effect::{BoundEffect, Search};
use crate::estimation::{Linearisation, ParameterId};

/// Columns that are linearised at once.
const CHUNK: usize = 48;
/// Information, in units of the prior's, from which a direction counts as visible.
const VISIBLE: f64 = 0.1;

/// How well one cause explains what is left.
#[derive(Debug, Clone)]
pub(super) struct Scored {
    /// The cause with a linear estimate of its values.
    pub cause: Cause,
    /// Gain of chi-square, linear.
    pub gain: f64,
    /// What its freedom is worth.
    pub freedom: f64,
    /// The part of it that the choice among poses is worth.
    pub places: f64,
    /// Number of directions that the data show.
    pub visible: usize,
    /// Standard deviation of its first parameter, if the data show it.
    pub sd: Option<f64>,
}

impl Scored {
    /// Twice the logarithm of the evidence.
    pub fn score(&self) -> f64 {
        self.gain - self.freedom
    }
}

/// All questions at one solution.
#[derive(Debug, Clone)]
pub(super) struct Scan {
    /// The answers, one per effect and target: events at their best pose, waves at their best period.
    pub scored: Vec<Scored>,
    /// Number of questions asked.
    pub questions: usize,
    /// What the solution leaves.
    pub space: Space,
    /// The solution's linearisation.
    pub linear: Linearisation,
}

impl Scan {
    /// What each direction that the data show is worth: the logarithm of the number of readings.
    pub fn price(&self) -> f64 {
        let readings = self.linear.rows.iter().filter(|row| row.row.is_some());
        (readings.count().max(2) as f64).ln()
    }
}

/// Asks every question at a fit.
pub(super) fn scan(fit: &Fit<'_>) -> Scan {
    let linear = Linearisation::new(&fit.problem, &fit.solution);
    let space = Space::new(&linear.design, &linear.residual);
    let mut scan = Scan {
        scored: Vec::new(),
        questions: 0,
        space,
        linear,
    };
    let mut chunk = Chunk::default();
    for effect in asked() {
        for question in questions_of(effect, &fit.problem.dataset.robot) {
            chunk.add(question);
            if chunk.columns >= CHUNK {
                std::mem::take(&mut chunk).answer(fit, &mut scan);
            }
        }
    }
    chunk.answer(fit, &mut scan);
    scan
}

/// Questions that are linearised together.
#[derive(Default)]
struct Chunk {
    questions: Vec<Question>,
    /// What is bound for them, each once.
    bounds: Vec<BoundEffect>,
    /// The columns of each question: index of the bound effect, of its parameter.
    uses: Vec<Vec<(usize, usize)>>,
    columns: usize,
}

/// Equal but for the values that are NaN in both.
fn is_same(one: &BoundEffect, other: &BoundEffect) -> bool {
    let bits = |bound: &BoundEffect| bound.values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    one.effect.id() == other.effect.id()
        && one.cables == other.cables
        && one.targeted == other.targeted
        && bits(one) == bits(other)
}

impl Chunk {
    fn add(&mut self, question: Question) {
        let mut uses = Vec::new();
        for (bound, parameter) in question.probes() {
            let known = self.bounds.iter().position(|other| is_same(other, &bound));
            let index = known.unwrap_or_else(|| {
                self.columns += bound.values.len();
                self.bounds.push(bound);
                self.bounds.len() - 1
            });
            uses.push((index, parameter));
        }
        self.uses.push(uses);
        self.questions.push(question);
    }

    fn answer(self, fit: &Fit<'_>, scan: &mut Scan) {
        if self.questions.is_empty() {
            return;
        }
        let design = Design::new(fit, &self.bounds, scan.linear.rows.len());
        let projected = scan.space.project(&design.columns);
        for (question, uses) in self.questions.iter().zip(&self.uses) {
            let at: Vec<usize> = uses.iter().map(|(b, p)| design.column_of(*b, *p)).collect();
            let prior: Vec<f64> = uses
                .iter()
                .map(|(bound, parameter)| {
                    prior_of(&self.bounds[*bound].effect.parameters()[*parameter])
                })
                .collect();
            let (answer, asked) = match question.search() {
                Search::Direct | Search::Exchange | Search::Wave { period: None, .. } => {
                    let columns = projected.select_columns(&at);
                    (answer_direct(question, &columns, &prior, scan), 1)
                }
                Search::Wave { .. } => {
                    let moments = Moments::new(&design.columns.select_columns(&at), scan);
                    answer_wave(question, &moments, prior[0], (fit, scan.price()))
                }
                Search::FromPose(_) | Search::AtPose(_) => {
                    let moments = Moments::new(&design.columns.select_columns(&at), scan);
                    answer_event(question, &moments, &prior, (fit, scan.price()))
                }
            };
            scan.questions += asked;
            scan.scored.extend(answer);
        }
    }
}

/// Columns of bound effects in the rows of a fit.
pub(super) struct Design {
    /// Rows of the fit x columns, poses and tensions eliminated.
    pub columns: DMatrix<f64>,
    indices: Vec<(usize, usize)>,
}

impl Design {
    /// Linearises `bounds` on top of a fit whose linearisation has `rows` rows.
    pub fn new(fit: &Fit<'_>, bounds: &[BoundEffect], rows: usize) -> Self {
        let mut problem = fit.problem.clone();
        let present = problem.free_effects.len();
        problem.free_effects.extend(bounds.iter().cloned());
        let mut solution = fit.solution.clone();
        solution.globals.effects.extend(bounds.iter().cloned());
        solution.parameters = problem.parameters();
        let linear = Linearisation::new(&problem, &solution);
        let mut indices = Vec::new();
        let mut wanted = Vec::new();
        for (column, parameter) in linear.parameters.iter().enumerate() {
            if let ParameterId::Effect { effect, parameter } = parameter.id
                && effect >= present
            {
                indices.push((effect - present, parameter));
                wanted.push(column);
            }
        }
        let columns = linear.design.rows(0, rows).select_columns(&wanted);
        Self { columns, indices }
    }

    /// Column of a parameter of a bound effect.
    pub fn column_of(&self, bound: usize, parameter: usize) -> usize {
        let found = self.indices.iter().position(|k| *k == (bound, parameter));
        found.unwrap_or_default()
    }
}

fn answer_direct(
    question: &Question,
    columns: &DMatrix<f64>,
    prior: &[f64],
    scan: &Scan,
) -> Option<Scored> {
    let (space, price) = (&scan.space, scan.price());
    let block = Block::new(
        &columns.tr_mul(&space.residual),
        &columns.tr_mul(columns),
        prior,
    )?;
    let cause = question.estimated(&block.estimate, f64::NAN);
    Some(block.scored(cause, block.visible as f64 * price, 0.0))
}

/// The best pose of an event, and the number of poses at which it was tried.
fn answer_event(
    question: &Question,
    moments: &Moments,
    prior: &[f64],
    (fit, price): (&Fit<'_>, f64),
) -> (Option<Scored>, usize) {
    let labels = &fit.problem.dataset.measurements.labels;
    let accumulates = matches!(question.search(), Search::FromPose(_));
    let mut order: Vec<&PoseMoments> = moments.poses.iter().collect();
    order.sort_by_key(|pose| std::cmp::Reverse(labels[pose.row]));
    if accumulates {
        // From the first pose on it would be no event but an offset.
        order.pop();
    }
    let mut sums: Option<PoseMoments> = None;
    let mut best: Option<(Block, f64)> = None;
    for pose in &order {
        match &mut sums {
            Some(sums) if accumulates => sums.add(pose),
            _ => sums = Some((*pose).clone()),
        }
        let Some(found) = sums.as_ref().and_then(|sums| sums.block(prior)) else {
            continue;
        };
        if best.as_ref().is_none_or(|(b, _)| found.gain > b.gain) {
            best = Some((found, labels[pose.row] as f64));
        }
    }
    let poses = order.len().max(1);
    let answer = best.map(|(block, label)| {
        let cause = question.estimated(&block.estimate, label);
        let freedom = block.visible as f64 * price;
        block.scored(cause, freedom, 2.0 * (poses as f64).ln())
    });
    (answer, poses)
}

/// The best period of a wave in the laser's distance, and the number of periods that were tried.
fn answer_wave(
    question: &Question,
    moments: &Moments,
    prior: f64,
    (fit, price): (&Fit<'_>, f64),
) -> (Option<Scored>, usize) {
    let effect = question.cause.effect();
    let Search::Wave {
        period: Some(period),
        ..
    } = effect.search()
    else {
        return (None, 0);
    };
    let readings = &fit.problem.dataset.measurements.laser_m;
    let read = |pose: &PoseMoments| readings.get(pose.row).copied().filter(|d| d.is_finite());
    let distances: Vec<Option<f64>> = moments.poses.iter().map(read).collect();
    let finite = || distances.iter().flatten().copied();
    let range = finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min);
    let periods = periods(effect.parameters()[period].typical, range);
    let mut best: Option<(Block, f64)> = None;
    for period in &periods {
        let weights = DMatrix::from_fn(distances.len(), 2, |j, k| {
            let turn = distances[j].map(|d| std::f64::consts::TAU * d / period);
            turn.map_or(0.0, |turn| if k == 0 { turn.sin() } else { turn.cos() })
        });
        let (score, information) = moments.weighted(&weights);
        let Some(found) = Block::new(&score, &information, &[prior; 2]) else {
            continue;
        };
        if best.as_ref().is_none_or(|(b, _)| found.gain > b.gain) {
            best = Some((found, *period));
        }
    }
    let answer = best.map(|(block, period)| {
        let cause = question.estimated(&block.estimate, period);
        // The period is one parameter more, where there is a wave at all.
        let visible = block.visible + usize::from(block.visible > 0);
        Scored {
            visible,
            ..block.scored(cause, visible as f64 * price, 0.0)
        }
    });
    (answer, periods.len())
}

/// Score test of one block of columns.
pub(super) struct Block {
    pub gain: f64,
    pub freedom: f64,
    visible: usize,
    /// Linear estimate of the parameters, priors included.
    pub estimate: Vec<f64>,
    sd: Option<f64>,
}

impl Block {
    /// From the score `C^T r`, the information `C^T C` and the standard deviations of the priors.
    pub fn new(score: &DVector<f64>, information: &DMatrix<f64>, prior: &[f64]) -> Option<Self> {
        Some(Directions::new(score, information, prior)?.block(1.0))
    }

    /// Twice the logarithm of the evidence.
    pub fn score(&self) -> f64 {
        self.gain - self.freedom
    }

    /// The answer for a cause whose freedom is worth this much.
    pub fn scored(&self, cause: Cause, freedom: f64, places: f64) -> Scored {
        Scored {
            cause,
            gain: self.gain,
            freedom: freedom + places,
            places,
            visible: self.visible,
            sd: self.sd,
        }
    }
}

/// The score along the principal directions of the information in units of the prior.
pub(super) struct Directions<'p> {
    prior: &'p [f64],
    values: DVector<f64>,
    vectors: DMatrix<f64>,
    along: DVector<f64>,
    /// Information of the first parameter.
    first: f64,
}

impl<'p> Directions<'p> {
    pub fn new(score: &DVector<f64>, information: &DMatrix<f64>, prior: &'p [f64]) -> Option<Self> {
        let n = prior.len();
        let scaled = DMatrix::from_fn(n, n, |i, k| information[(i, k)] * prior[i] * prior[k]);
        if !scaled.iter().all(|v| v.is_finite()) {
            return None;
        }
        let score = DVector::from_fn(n, |k, _| score[k] * prior[k]);
        let first = information[(0, 0)];
        let eigen = SymmetricEigen::new(scaled);
        Some(Self {
            along: eigen.eigenvectors.tr_mul(&score),
            values: eigen.eigenvalues,
            vectors: eigen.eigenvectors,
            prior,
            first,
        })
    }

    /// Gain, freedom and number of visible directions if all priors are `size` times as wide.
    fn worth(&self, size: f64) -> (f64, f64, usize) {
        let (mut gain, mut freedom, mut visible) = (0.0, 0.0, 0);
        for (along, value) in self.along.iter().zip(&self.values) {
            let (along, value) = (along * size, value.max(0.0) * size * size);
            gain += along * along / (1.0 + value);
            freedom += (1.0 + value).ln();
            visible += usize::from(value > VISIBLE);
        }
        (gain, freedom, visible)
    }

    /// The size among `sizes` with the largest evidence.
    pub fn best_size(&self, sizes: &[f64]) -> f64 {
        let score = |size: f64| {
            let (gain, freedom, _) = self.worth(size);
            gain - freedom
        };
        let best = sizes
            .iter()
            .copied()
            .max_by(|a, b| score(*a).total_cmp(&score(*b)));
        best.unwrap_or(1.0)
    }

    /// The score test with all priors `size` times as wide.
    pub fn block(&self, size: f64) -> Block {
        let (gain, freedom, visible) = self.worth(size);
        let solved = DVector::from_fn(self.along.len(), |k, _| {
            -self.along[k] * size / (1.0 + self.values[k].max(0.0) * size * size)
        });
        let estimate = &self.vectors * solved;
        let scaled = self.first * (self.prior[0] * size).powi(2);
        Block {
            gain,
            freedom,
            visible,
            estimate: estimate
                .iter()
                .zip(self.prior)
                .map(|(e, sd)| e * sd * size)
                .collect(),
            sd: (scaled > VISIBLE * VISIBLE).then(|| self.first.sqrt().recip()),
        }
    }
}
