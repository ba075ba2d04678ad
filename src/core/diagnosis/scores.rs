//! The score test of every question at one solution.
//!
//! With the projected columns `C` of a cause (what it changes in the readings and nothing else could), the projected
//! residual `r` and the prior covariance `P` of its parameters, the gain of chi-square is
//! `s^T (I + P^-1)^-1 s`, `s = C^T r`, `I = C^T C`; without the cause `s^T I^-1 s` is chi-square distributed.
//! The evidence, twice its logarithm, is the gain less `ln det(1 + P I)` (Laplace), less twice the logarithm of the
//! number of poses for an event that could have been at any of them.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::fit::Fit;
use super::questions::{Question, asked, periods, questions_of};
use super::report::Cause;
use super::space::Space;
use crate::effect::{BoundEffect, Search};
use crate::estimation::{Linearisation, ParameterId, PoseBlock};
use crate::statistics::chi_square_survival;

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
    /// Number of directions that the data show.
    pub visible: usize,
    /// Probability of such a gain without the cause, not corrected.
    pub p_value: f64,
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
        let periods = match effect.search() {
            Search::Wave {
                period: Some(period),
                ..
            } => periods(effect.parameters()[period].typical, laser_range(fit)),
            _ => Vec::new(),
        };
        for question in questions_of(effect, &fit.problem.dataset.robot, &periods) {
            chunk.add(question);
            if chunk.columns >= CHUNK {
                std::mem::take(&mut chunk).answer(fit, &mut scan);
            }
        }
    }
    chunk.answer(fit, &mut scan);
    keep_best_periods(&mut scan.scored);
    scan
}

/// How far the laser's readings spread (m).
fn laser_range(fit: &Fit<'_>) -> f64 {
    let readings = fit.problem.dataset.measurements.laser_m.iter();
    let finite = readings.copied().filter(|d| d.is_finite());
    let (least, most) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), d| {
        (l.min(d), m.max(d))
    });
    (most - least).max(0.0)
}

/// Of the waves with different periods only the best stays.
fn keep_best_periods(scored: &mut Vec<Scored>) {
    scored.sort_by(|a, b| b.score().total_cmp(&a.score()));
    let mut seen: Vec<(&'static str, Vec<usize>, usize)> = Vec::new();
    scored.retain(|s| {
        let key = (
            s.cause.effect().id(),
            s.cause.cables(),
            s.cause.instances.len(),
        );
        let is_new = !seen.contains(&key);
        if is_new {
            seen.push(key);
        }
        is_new
    });
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
                    self.bounds[*bound].effect.parameters()[*parameter].prior_sd
                })
                .collect();
            let (answer, asked) = match question.search() {
                Search::FromPose(_) | Search::AtPose(_) => {
                    let raw = design.columns.select_columns(&at);
                    answer_event(question, &raw, &prior, fit, scan)
                }
                _ => {
                    let columns = projected.select_columns(&at);
                    (answer_direct(question, &columns, &prior, &scan.space), 1)
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
    space: &Space,
) -> Option<Scored> {
    let block = Block::new(
        &columns.tr_mul(&space.residual),
        &columns.tr_mul(columns),
        prior,
    )?;
    Some(block.scored(question.estimated(&block.estimate, None), 0.0))
}

/// Sums over the poses at which an event acts.
struct EventSums {
    score: DVector<f64>,
    information: DMatrix<f64>,
    /// `V^T C`.
    explained: DMatrix<f64>,
}

impl EventSums {
    fn zero(columns: usize, taken: usize) -> Self {
        Self {
            score: DVector::zeros(columns),
            information: DMatrix::zeros(columns, columns),
            explained: DMatrix::zeros(taken, columns),
        }
    }

    fn add(&mut self, raw: &DMatrix<f64>, block: &PoseBlock, space: &Space) {
        let (first, count) = (block.rows.start, block.rows.len());
        let columns = raw.rows(first, count);
        self.score += columns.tr_mul(&space.residual.rows(first, count));
        self.information += columns.tr_mul(&columns);
        self.explained += space.basis().rows(first, count).tr_mul(&columns);
    }

    fn block(&self, prior: &[f64]) -> Option<Block> {
        let information = &self.information - self.explained.tr_mul(&self.explained);
        Block::new(&self.score, &information, prior)
    }
}

/// The best pose of an event, and the number of poses at which it was tried.
fn answer_event(
    question: &Question,
    raw: &DMatrix<f64>,
    prior: &[f64],
    fit: &Fit<'_>,
    scan: &Scan,
) -> (Option<Scored>, usize) {
    let labels = &fit.problem.dataset.measurements.labels;
    let mut blocks: Vec<&PoseBlock> = scan.linear.poses.iter().collect();
    blocks.sort_by_key(|block| std::cmp::Reverse(labels[block.row]));
    let accumulates = matches!(question.search(), Search::FromPose(_));
    if accumulates {
        // From the first pose on it would be no event but an offset.
        blocks.pop();
    }
    let zero = || EventSums::zero(raw.ncols(), scan.space.taken());
    let mut sums = zero();
    let mut best: Option<(Block, i64)> = None;
    for block in &blocks {
        if !accumulates {
            sums = zero();
        }
        sums.add(raw, block, &scan.space);
        let Some(found) = sums.block(prior) else {
            continue;
        };
        let score = |b: &Block| b.gain - b.freedom;
        if best.as_ref().is_none_or(|(b, _)| score(&found) > score(b)) {
            best = Some((found, labels[block.row]));
        }
    }
    let poses = blocks.len().max(1);
    let answer = best.map(|(block, label)| {
        let cause = question.estimated(&block.estimate, Some(label));
        block.scored(cause, 2.0 * (poses as f64).ln())
    });
    (answer, poses)
}

/// Score test of one block of columns.
pub(super) struct Block {
    pub gain: f64,
    pub freedom: f64,
    statistic: f64,
    visible: usize,
    /// Linear estimate of the parameters, priors included.
    pub estimate: Vec<f64>,
    sd: Option<f64>,
}

impl Block {
    /// From the score `C^T r`, the information `C^T C` and the standard deviations of the priors.
    pub fn new(score: &DVector<f64>, information: &DMatrix<f64>, prior: &[f64]) -> Option<Self> {
        let n = prior.len();
        let scaled = DMatrix::from_fn(n, n, |i, k| information[(i, k)] * prior[i] * prior[k]);
        if !scaled.iter().all(|v| v.is_finite()) {
            return None;
        }
        let score = DVector::from_fn(n, |k, _| score[k] * prior[k]);
        let eigen = SymmetricEigen::new(scaled.clone());
        let along = eigen.eigenvectors.tr_mul(&score);
        let (mut gain, mut freedom, mut statistic, mut visible) = (0.0, 0.0, 0.0, 0);
        let mut solved = DVector::zeros(n);
        for k in 0..n {
            let value = eigen.eigenvalues[k].max(0.0);
            solved[k] = -along[k] / (1.0 + value);
            gain += along[k].powi(2) / (1.0 + value);
            freedom += (1.0 + value).ln();
            if value > VISIBLE {
                statistic += along[k].powi(2) / value;
                visible += 1;
            }
        }
        let estimate = &eigen.eigenvectors * solved;
        Some(Self {
            gain,
            freedom,
            statistic,
            visible,
            estimate: estimate.iter().zip(prior).map(|(e, sd)| e * sd).collect(),
            sd: (scaled[(0, 0)] > VISIBLE * VISIBLE).then(|| prior[0] / scaled[(0, 0)].sqrt()),
        })
    }

    /// Probability of such a statistic without a cause.
    pub fn p_value(&self) -> f64 {
        chi_square_survival(self.statistic, self.visible as f64).unwrap_or(1.0)
    }

    fn scored(&self, cause: Cause, positions: f64) -> Scored {
        Scored {
            cause,
            gain: self.gain,
            freedom: self.freedom + positions,
            visible: self.visible,
            p_value: self.p_value(),
            sd: self.sd,
        }
    }
}
