//! Which faults planned poses would show, and which of them could be told apart, before anything is measured.
//!
//! Isolability (Gertler, Fault Detection and Diagnosis in Engineering Systems, 1998; Isermann, Fault-Diagnosis Systems,
//! 2006) is a property of the poses and the sensors: with the linearisation of all candidates that the diagnosis uses, the
//! score of a candidate `c` in data with a fault `a` of size `phi` is normal,
//!
//! ```text
//! b_c ~ N(-G_ca phi, G_cc)
//! ```
//!
//! with the Gram matrix `G` of what the elimination of poses, tensions and geometry leaves of the columns; jointly for
//! two candidates with the corresponding blocks. `lambda = phi^T G_aa phi` is the noncentrality: the chi-square that a
//! model without the fault leaves of data without noise. The logarithm of the posterior odds of a candidate against no
//! cause is the evidence of [`super::evidence`] with the candidate's prior, a function `L_c(b_c)` of its score alone, so that
//!
//! - the **probability of detection** is `P(L_a >= ln 19)`: the odds at which the diagnosis names or lists something;
//! - the **probability of confusion** with `c` is `P(max(L_a, L_c) >= ln 19 and L_a - L_c < ln 19)`: something is seen, but
//!   `c` is not ruled out;
//! - the **expected logarithm of the Bayes factor** of `a` over `c` is `E[ln p(y | a) - ln p(y | c)]`, for which
//!   `E[b^T W b] = m^T W m + tr(W G)` with the mean `m`.
//!
//! Noise is taken as described and other causes as absent. Probabilities are means over a low-discrepancy sequence of normal
//! variables, of as many dimensions as the faults have parameters (Halton, Numerische Mathematik 2, 1960; Niederreiter,
//! Random Number Generation and Quasi-Monte Carlo Methods, 1992).

mod odds;
mod points;
#[cfg(test)]
mod tests;

use nalgebra::{DMatrix, DVector};

use super::DiagnosisOptions;
use super::candidates::{Candidate, is_alike};
use super::claims::SURE;
use super::doctor::based;
use super::fit::Fit;
use super::gram::{Gram, Own};
use super::linear_fit::{EXPECTED_PER_ALPHA, LinearFit};
use super::report::Cause;
use crate::effect::measurements_as_modelled;
use crate::estimation::EstimationError;
use crate::measurement::Dataset;
use odds::Evidence;
use points::{normal_points, root};

/// Points of the sequence for a fault alone, and for each pair.
const POINTS: [usize; 2] = [4096, 1024];
/// Noncentrality that a candidate leaves of a fault from which it is ruled out: the logarithm of the odds is then above 100
/// with a standard deviation of 14.
const RULED_OUT: f64 = 200.0;

/// A fault of typical size, and how well it would be seen.
#[derive(Debug, Clone)]
pub struct ExpectedFault {
    /// The effect on its targets; events at a pose in the middle, waves of a period in the middle of those tried.
    pub cause: Cause,
    /// `lambda`: the chi-square that a model without it leaves of data without noise.
    pub noncentrality: f64,
    /// Probability that it is named or listed.
    pub detection: f64,
}

/// How well a fault would be told from another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExpectedPair {
    /// Expected logarithm of the Bayes factor of the fault that is present over the other.
    pub log_bayes_factor: f64,
    /// Probability that something is seen, but the other is not ruled out.
    pub confusion: f64,
}

/// What planned poses would show.
#[derive(Debug, Clone)]
pub struct Isolability {
    /// Every fault on which a reading depends.
    pub faults: Vec<ExpectedFault>,
    pairs: Vec<ExpectedPair>,
}

impl Isolability {
    /// How well the fault with the index `present` would be told from that with the index `other`.
    #[must_use]
    pub fn pair(&self, present: usize, other: usize) -> ExpectedPair {
        self.pairs[present * self.faults.len() + other]
    }

    /// The faults with which one would be confused, by falling probability; from `least` on.
    #[must_use]
    pub fn rivals(&self, present: usize, least: f64) -> Vec<usize> {
        let confusion = |other: &usize| self.pair(present, *other).confusion;
        let others = (0..self.faults.len()).filter(|other| *other != present);
        let mut found: Vec<usize> = others.filter(|other| confusion(other) >= least).collect();
        found.sort_by(|a, b| confusion(b).total_cmp(&confusion(a)).then(a.cmp(b)));
        found
    }
}

/// What the poses of a dataset would show; its readings are those expected there without noise, or any others: only where
/// they were read, and at which poses, matters.
///
/// # Errors
/// If the readings cannot be used with the robot.
pub fn isolability(
    dataset: &Dataset,
    options: &DiagnosisOptions,
) -> Result<Isolability, EstimationError> {
    let problem = based(dataset)?;
    let fit = Fit::new(&problem, &[])?;
    let at = LinearFit::new(&fit, EXPECTED_PER_ALPHA * options.alpha, true);
    let mut gram = at.gram(&at.linear.described());
    let asked: Vec<Asked> = representatives(gram.candidates)
        .into_iter()
        .map(|index| Asked::new(&gram, index))
        .collect();
    Ok(Expected::new(&mut gram, asked).isolability())
}

/// Logarithms of the posterior odds of single causes against none in the readings of a dataset, noise as described:
/// what [`isolability`] predicts. Minus infinity for what no reading depends on.
///
/// # Errors
/// If the readings cannot be used with the robot.
pub fn log_odds(
    dataset: &Dataset,
    causes: &[Cause],
    options: &DiagnosisOptions,
) -> Result<Vec<f64>, EstimationError> {
    let measurements = measurements_as_modelled(&dataset.robot, &dataset.measurements)?;
    let dataset = Dataset {
        robot: dataset.robot.clone(),
        measurements: measurements.into_owned(),
    };
    let problem = based(&dataset)?;
    let fit = Fit::new(&problem, &[])?;
    let at = LinearFit::new(&fit, EXPECTED_PER_ALPHA * options.alpha, true);
    let gram = at.gram(&at.linear.described());
    let of = |cause: &Cause| {
        let index = gram.candidates.iter().position(|c| c.is_of(cause));
        index.map_or(f64::NEG_INFINITY, |index| {
            let Own { score, information } = &gram.own[index];
            Evidence::new(&gram.candidates[index], information).log_odds(score.as_slice())
        })
    };
    Ok(causes.iter().map(of).collect())
}

/// One candidate for each effect and its targets: of events that in the middle of the poses, of waves that in the middle of
/// the periods. Values of each cable's own are no further fault.
fn representatives(candidates: &[Candidate]) -> Vec<usize> {
    let mut found = Vec::new();
    let mut first = 0;
    for until in 1..=candidates.len() {
        if until < candidates.len() && is_alike(&candidates[until].cause, &candidates[first].cause)
        {
            continue;
        }
        let middle = usize::midpoint(first, until - 1);
        if !candidates[middle].is_family() {
            found.push(middle);
        }
        first = until;
    }
    found
}

/// A candidate that is asked about.
struct Asked {
    cause: Cause,
    evidence: Evidence,
    /// First of its columns among all.
    first: usize,
    /// Its parameters at typical size.
    size: DVector<f64>,
}

impl Asked {
    fn new(gram: &Gram<'_>, index: usize) -> Self {
        let candidate = &gram.candidates[index];
        let cause = candidate.typical();
        Self {
            evidence: Evidence::new(candidate, &gram.own[index].information),
            first: gram.first[index],
            size: DVector::from_vec(candidate.coordinates(&cause)),
            cause,
        }
    }
}

/// All that is asked about, with the Gram matrix of its columns.
struct Expected {
    asked: Vec<Asked>,
    /// First column of each in `gram`.
    first: Vec<usize>,
    gram: DMatrix<f64>,
    /// `G phi` for every fault: one column each.
    means: DMatrix<f64>,
    /// Normal points by number of dimensions, for pairs.
    points: Vec<DMatrix<f64>>,
}

impl Expected {
    fn new(gram: &mut Gram<'_>, asked: Vec<Asked>) -> Self {
        let mut columns = Vec::new();
        let mut first = Vec::new();
        for one in &asked {
            first.push(columns.len());
            columns.extend(one.first..one.first + one.size.len());
        }
        let mut all = DMatrix::zeros(columns.len(), columns.len());
        for (at, column) in columns.iter().enumerate() {
            let row = gram.row(*column);
            for (to, other) in columns.iter().enumerate() {
                all[(at, to)] = row[*other];
            }
        }
        let all = (&all + all.transpose()) * 0.5;
        let mut means = DMatrix::zeros(columns.len(), asked.len());
        for (index, one) in asked.iter().enumerate() {
            let own = all.columns(first[index], one.size.len());
            // Residuals are predictions less readings.
            means.set_column(index, &(own * &one.size * -1.0));
        }
        let most = asked.iter().map(|one| one.size.len()).max().unwrap_or(0);
        let points = (0..=2 * most)
            .map(|count| normal_points(count, POINTS[1]))
            .collect();
        Self {
            asked,
            first,
            gram: all,
            means,
            points,
        }
    }

    fn isolability(&self) -> Isolability {
        let count = self.asked.len();
        let mut pairs = Vec::with_capacity(count * count);
        for present in 0..count {
            pairs.extend((0..count).map(|other| self.pair(present, other)));
        }
        let fault = |index: usize| ExpectedFault {
            cause: self.asked[index].cause.clone(),
            noncentrality: self.noncentrality(index),
            detection: self.detection(index),
        };
        Isolability {
            faults: (0..count).map(fault).collect(),
            pairs,
        }
    }

    fn block(&self, one: usize, other: usize) -> DMatrix<f64> {
        let [a, b] = [one, other].map(|k| (self.first[k], self.asked[k].size.len()));
        self.gram.view((a.0, b.0), (a.1, b.1)).into_owned()
    }

    /// Mean of the score of `of` where `present` is.
    fn mean(&self, present: usize, of: usize) -> DVector<f64> {
        let own = self.means.column(present);
        own.rows(self.first[of], self.asked[of].size.len())
            .into_owned()
    }

    fn noncentrality(&self, index: usize) -> f64 {
        -self.mean(index, index).dot(&self.asked[index].size)
    }

    fn detection(&self, index: usize) -> f64 {
        let points = normal_points(self.asked[index].size.len(), POINTS[0]);
        let mut scores = root(&self.block(index, index)) * points;
        let mean = self.mean(index, index);
        let evidence = &self.asked[index].evidence;
        let seen = scores.column_iter_mut().filter_map(|mut score| {
            score += &mean;
            is_seen(evidence.log_odds(score.as_slice())).then_some(())
        });
        seen.count() as f64 / POINTS[0] as f64
    }

    fn pair(&self, present: usize, other: usize) -> ExpectedPair {
        let [one, rival] = [present, other].map(|k| &self.asked[k].evidence);
        let [own, far] = [present, other].map(|k| self.mean(present, k));
        let (within, beside) = (self.block(present, present), self.block(other, other));
        ExpectedPair {
            log_bayes_factor: one.expected(&own, &within) - rival.expected(&far, &beside),
            confusion: self.confusion(present, other, (&own, &within), (&far, &beside)),
        }
    }

    fn confusion(
        &self,
        present: usize,
        other: usize,
        (own, within): (&DVector<f64>, &DMatrix<f64>),
        (far, beside): (&DVector<f64>, &DMatrix<f64>),
    ) -> f64 {
        if present == other || self.left_by(present, far, beside) > RULED_OUT {
            return 0.0;
        }
        let count = own.len();
        let both = count + far.len();
        let mut covariance = DMatrix::zeros(both, both);
        let cross = self.block(present, other);
        covariance
            .view_mut((0, 0), within.shape())
            .copy_from(within);
        covariance
            .view_mut((count, count), beside.shape())
            .copy_from(beside);
        covariance
            .view_mut((0, count), cross.shape())
            .copy_from(&cross);
        covariance
            .view_mut((count, 0), (far.len(), count))
            .copy_from(&cross.transpose());
        let mut mean = DVector::zeros(both);
        mean.rows_mut(0, count).copy_from(own);
        mean.rows_mut(count, far.len()).copy_from(far);
        let mut scores = root(&covariance) * &self.points[both];
        let [one, rival] = [present, other].map(|k| &self.asked[k].evidence);
        let confused = scores.column_iter_mut().filter_map(|mut score| {
            score += &mean;
            let (first, second) = score.as_slice().split_at(count);
            let (first, second) = (one.log_odds(first), rival.log_odds(second));
            is_confused(first, second).then_some(())
        });
        confused.count() as f64 / POINTS[1] as f64
    }

    /// Noncentrality that another candidate leaves of a fault.
    fn left_by(&self, present: usize, far: &DVector<f64>, beside: &DMatrix<f64>) -> f64 {
        let total = self.noncentrality(present);
        let explained = beside.clone().cholesky();
        total - explained.map_or(0.0, |factor| far.dot(&factor.solve(far)))
    }
}

/// Logarithm of the odds at which something is said.
fn sure() -> f64 {
    (SURE / (1.0 - SURE)).ln()
}

/// Whether something with this logarithm of its posterior odds against no cause is named or listed.
#[must_use]
pub fn is_seen(log_odds: f64) -> bool {
    log_odds >= sure()
}

/// Whether something is seen, but `other` is not ruled out against the fault that is `present`: both are logarithms of
/// posterior odds against no cause.
#[must_use]
pub fn is_confused(present: f64, other: f64) -> bool {
    is_seen(present.max(other)) && present - other < sure()
}
