//! Optimal selection: greedy, then exchanges as long as they improve the criterion (Fedorov, Theory of Optimal Experiments, 1972).
//!
//! With the covariance `C` of the design, a pose with rows `R` raises `ln det I` by `ln det(1 + R C R^T)`, and lowers the mean
//! square error `tr(S^T C S)` by `|L^-1 R C S|^2` with `L L^T = 1 + R C R^T`. Adding or removing a pose changes `C` by a
//! low-rank product, and with it `R C R^T` and `R C S` of all others.

use nalgebra::{DMatrix, DMatrixView};

use super::goal::{Criterion, Term, TermKind};
use super::{PlanError, PlanProgress};
use crate::estimation::{Control, ExpectedInformation};

/// Standard deviation (m, rad, ...) assumed for parameters without a prior while poses are selected: it keeps the
/// information regular before the data determine them.
const VAGUE_SD: f64 = 10.0;
/// Number of candidates that take part in exchanges: those that would add most to the greedy selection.
const EXCHANGE_CANDIDATES: usize = 400;
/// Smallest gain worth an exchange.
const MIN_GAIN: f64 = 1e-6;
/// Largest number of rounds of exchanges.
const MAX_ROUNDS: usize = 30;

/// Indices of the selected candidates, in no particular order.
pub(super) fn choose(
    criterion: &Criterion,
    candidates: usize,
    count: usize,
    observer: &mut dyn FnMut(&PlanProgress) -> Control,
) -> Result<Vec<usize>, PlanError> {
    let mut pool = Pool::new(criterion, (0..candidates).collect());
    for poses in 0..count {
        report(observer, PlanProgress::Chosen { poses })?;
        let Some(best) = pool.best() else { break };
        pool.change(best, true);
    }
    let mut short = Pool::new(criterion, pool.most_useful(EXCHANGE_CANDIDATES + count));
    for place in 0..short.members.len() {
        if pool.chosen[short.members[place]] {
            short.change(place, true);
        }
    }
    exchange(&mut short, observer)?;
    let chosen = (0..short.members.len()).filter(|place| short.chosen[*place]);
    Ok(chosen.map(|place| short.members[place]).collect())
}

fn report(
    observer: &mut dyn FnMut(&PlanProgress) -> Control,
    progress: PlanProgress,
) -> Result<(), PlanError> {
    match observer(&progress) {
        Control::Continue => Ok(()),
        Control::Cancel => Err(PlanError::Cancelled),
    }
}

fn exchange(
    pool: &mut Pool<'_>,
    observer: &mut dyn FnMut(&PlanProgress) -> Control,
) -> Result<(), PlanError> {
    let mut exchanges = 0;
    for _ in 0..MAX_ROUNDS {
        report(observer, PlanProgress::Exchanged { exchanges })?;
        let before = exchanges;
        pool.refresh();
        let chosen = (0..pool.members.len()).filter(|place| pool.chosen[*place]);
        for out in chosen.collect::<Vec<_>>() {
            pool.change(out, false);
            let kept = pool.gain(out);
            let better = pool.best().filter(|b| pool.gain(*b) > kept + MIN_GAIN);
            exchanges += usize::from(better.is_some());
            pool.change(better.unwrap_or(out), true);
        }
        if exchanges == before {
            break;
        }
    }
    Ok(())
}

/// Candidates and the design selected from them.
struct Pool<'a> {
    /// Indices of the candidates in the information.
    members: Vec<usize>,
    chosen: Vec<bool>,
    terms: Vec<DesignTerm<'a>>,
}

impl<'a> Pool<'a> {
    fn new(criterion: &'a Criterion, members: Vec<usize>) -> Self {
        let terms = criterion.terms.iter();
        let mut pool = Self {
            terms: terms.map(|term| DesignTerm::new(term, &members)).collect(),
            chosen: vec![false; members.len()],
            members,
        };
        pool.refresh();
        pool
    }

    /// Recomputes everything from the design, as updates accumulate rounding errors.
    fn refresh(&mut self) {
        let chosen = (0..self.members.len()).filter(|place| self.chosen[*place]);
        let picked: Vec<usize> = chosen.map(|place| self.members[place]).collect();
        self.terms.iter_mut().for_each(|term| term.refresh(&picked));
    }

    /// Adds a member to the design or removes it.
    fn change(&mut self, place: usize, add: bool) {
        self.chosen[place] = add;
        self.terms
            .iter_mut()
            .for_each(|term| term.change(place, add));
    }

    /// Increase of the criterion by a member outside the design.
    fn gain(&self, place: usize) -> f64 {
        self.terms.iter().map(|term| term.gain(place)).sum()
    }

    /// The member outside the design that would add most.
    fn best(&self) -> Option<usize> {
        (0..self.members.len())
            .filter(|place| !self.chosen[*place])
            .map(|place| (place, self.gain(place)))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(place, _)| place)
    }

    /// The selected candidates and the others that would add most.
    fn most_useful(&self, count: usize) -> Vec<usize> {
        let mut order: Vec<(bool, f64, usize)> = (0..self.members.len())
            .map(|place| (self.chosen[place], self.gain(place), place))
            .collect();
        order.sort_by(|a, b| b.0.cmp(&a.0).then(b.1.total_cmp(&a.1)));
        order.truncate(count);
        order
            .into_iter()
            .map(|(.., place)| self.members[place])
            .collect()
    }
}

/// A term of the criterion for the present design, and the change by each candidate.
struct DesignTerm<'a> {
    information: &'a ExpectedInformation,
    kind: &'a TermKind,
    /// `R` of all members, stacked.
    rows: DMatrix<f64>,
    first_row: Vec<usize>,
    covariance: DMatrix<f64>,
    /// `R C R^T` of each member.
    own: Vec<DMatrix<f64>>,
    /// `R C S` of all members.
    error: DMatrix<f64>,
    /// `tr(S^T C S)`.
    mean_square: f64,
}

impl<'a> DesignTerm<'a> {
    fn new(term: &'a Term, members: &[usize]) -> Self {
        let information = &term.information;
        let mut first_row = vec![0];
        for member in members {
            first_row.push(first_row[first_row.len() - 1] + information.poses[*member].nrows());
        }
        let parameters = information.parameters.len();
        let mut rows = DMatrix::zeros(first_row[members.len()], parameters);
        for (place, member) in members.iter().enumerate() {
            let block = &information.poses[*member];
            rows.rows_mut(first_row[place], block.nrows())
                .copy_from(block);
        }
        Self {
            information,
            kind: &term.kind,
            own: Vec::new(),
            covariance: DMatrix::zeros(parameters, parameters),
            error: DMatrix::zeros(0, 0),
            mean_square: 0.0,
            rows,
            first_row,
        }
    }

    fn block<'m>(&self, of: &'m DMatrix<f64>, place: usize) -> DMatrixView<'m, f64> {
        let (from, to) = (self.first_row[place], self.first_row[place + 1]);
        of.rows(from, to - from)
    }

    fn refresh(&mut self, picked: &[usize]) {
        let mut total = self.information.of(picked.iter().copied());
        for k in 0..total.nrows() {
            total[(k, k)] += VAGUE_SD.powi(-2);
        }
        let Some(factor) = total.cholesky() else {
            return;
        };
        self.covariance = factor.inverse();
        let product = &self.rows * &self.covariance;
        if let TermKind::Error(root) = self.kind {
            self.error = &product * root;
            self.mean_square = (&self.covariance * root).dot(root);
        }
        self.own = (0..self.first_row.len() - 1)
            .map(|place| self.block(&product, place) * self.block(&self.rows, place).transpose())
            .collect();
    }

    /// Adds a member to the design or removes it, by a low-rank update.
    fn change(&mut self, place: usize, add: bool) {
        let sign = if add { 1.0 } else { -1.0 };
        let own = &self.own[place];
        let inner = DMatrix::identity(own.nrows(), own.nrows()) + own * sign;
        let Some(factor) = inner.cholesky() else {
            return;
        };
        // W^T = L^-1 R C.
        let mut root = self.block(&self.rows, place) * &self.covariance;
        factor.l_dirty().solve_lower_triangular_mut(&mut root);
        self.covariance.gemm_tr(-sign, &root, &root, 1.0);
        let seen = &self.rows * root.transpose();
        for other in 0..self.own.len() {
            let (from, to) = (self.first_row[other], self.first_row[other + 1]);
            let view = seen.rows(from, to - from);
            self.own[other].gemm(-sign, &view, &view.transpose(), 1.0);
        }
        if let TermKind::Error(weights) = self.kind {
            let along = root * weights;
            self.error.gemm(-sign, &seen, &along, 1.0);
            self.mean_square -= sign * along.norm_squared();
        }
    }

    /// Increase of the term by a member outside the design.
    fn gain(&self, place: usize) -> f64 {
        let own = &self.own[place];
        let inner = DMatrix::identity(own.nrows(), own.nrows()) + own;
        let Some(factor) = inner.cholesky() else {
            return f64::NEG_INFINITY;
        };
        match self.kind {
            TermKind::Determinant(weight) => {
                let pivots = factor.l_dirty().diagonal();
                weight * 2.0 * pivots.iter().map(|pivot| pivot.ln()).sum::<f64>()
            }
            TermKind::Error(_) => {
                let before = self.mean_square;
                let mut less = self.block(&self.error, place).into_owned();
                factor.l_dirty().solve_lower_triangular_mut(&mut less);
                let after = (before - less.norm_squared()).max(f64::MIN_POSITIVE);
                (before / after).ln()
            }
        }
    }
}
