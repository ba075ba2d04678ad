//! Tests on which variables the residuals depend, without reference to any cause.
//!
//! For the readings `g` of one kind and cable and a variable `u`, smooth functions `Phi` of `u` represent any
//! dependence, monotonic or not. With the score `s = Phi^T r_g` and its covariance `I = Phi^T M_gg Phi`
//! ([`super::residual_space`]), `s^T I^-1 s` is chi-square distributed with `rank I` degrees of freedom if there is no
//! dependence. This is Rao's score test of an error `Phi c` in these readings, with all other parameters estimated.
//!
//! Where readings scatter more than described, any function would seem to explain some of the scatter, in these
//! readings and in others that they influence. Readings with significantly excessive scatter are therefore reweighted
//! ([`super::noise`]), and their test compares the explained with the remaining variance (Fisher's F test).

use std::f64::consts::{PI, TAU};

use nalgebra::{DMatrix, SymmetricEigen};

use super::adequacy::classes;
use super::budget::{MAX_REPORTED_VARIABLES, MIN_PLOTTED_REDUNDANCY, MIN_VISIBLE_SHARE};
use super::calibration::EXCESS_LEVEL;
use super::noise::excess_variances;
use super::priors::{MAX_SMOOTH_FUNCTIONS, READINGS_PER_SMOOTH_FUNCTION};
use super::reading_id::ReadingId;
use super::residual_space::{ClassSums, ResidualSpace, RowGroup, Score};
use super::variables::{Variables, varies};
use super::{Discrepancy, Quantity, Variable};
use crate::statistics::{chi_square_survival, f_survival};

/// Test of whether some readings depend on a variable.
#[derive(Debug, Clone)]
#[cfg_attr(
    not(test),
    expect(dead_code, reason = "tests compare all of it with dense algebra")
)]
pub(crate) struct DependenceTest {
    /// Kind of reading.
    pub quantity: Quantity,
    /// Cable, if the reading is a cable's.
    pub cable: Option<usize>,
    /// Axis or angle of a reading that has several.
    pub component: Option<usize>,
    /// The tested variable.
    pub variable: Variable,
    /// `s^T I^-1 s`, in the noise as described.
    pub chi2: f64,
    /// Rank of `I`.
    pub rank: usize,
    /// Variance of the remaining residuals over that of the noise as described; 1 where the difference is not significant.
    pub noise_factor: f64,
    /// Probability without a dependence, not corrected.
    pub p_value: f64,
    /// Rows of the linearisation, ascending.
    pub rows: Vec<usize>,
    /// The variable at these rows.
    pub values: Vec<f64>,
    /// `Phi`: the functions at these rows.
    pub functions: DMatrix<f64>,
}

/// Smooth functions of a variable at `values`, one row each, at most `most` functions; none if the variable
/// does not vary.
///
/// `cos(k pi u)`, `k = 1, 2, ...`, with `u` from 0 at the smallest value to 1 at the largest: together with a
/// constant they approximate any continuous function. For a fraction of a drum revolution sine and cosine of
/// the first harmonics; for the direction of travel the direction itself.
#[must_use]
pub fn smooth_functions(values: &[f64], variable: Variable, most: usize) -> DMatrix<f64> {
    let numbers = values.iter().copied();
    if !varies(numbers.clone(), variable) {
        return DMatrix::zeros(values.len(), 0);
    }
    let least = numbers.clone().fold(f64::INFINITY, f64::min);
    let spread = numbers.fold(f64::NEG_INFINITY, f64::max) - least;
    match variable {
        Variable::Direction => DMatrix::from_column_slice(values.len(), 1, values),
        Variable::DrumFraction => DMatrix::from_fn(values.len(), most.min(4), |row, k| {
            let angle = TAU * values[row] * (1 + k / 2) as f64;
            if k % 2 == 0 { angle.sin() } else { angle.cos() }
        }),
        _ => DMatrix::from_fn(values.len(), most.min(MAX_SMOOTH_FUNCTIONS), |row, k| {
            (PI * (k + 1) as f64 * (values[row] - least) / spread).cos()
        }),
    }
}

/// Tests every class of readings against every variable that applies to it.
pub(crate) fn dependence_tests(
    space: &ResidualSpace,
    variables: &Variables<'_>,
) -> Vec<DependenceTest> {
    let reweighted = ReweightedResiduals::new(space);
    let mut tests = Vec::new();
    for (class, id) in reweighted.ids.iter().enumerate() {
        let rows: Vec<usize> = (0..space.rows())
            .filter(|row| {
                reweighted.class_of[*row] == Some(class) && space.measured[*row].is_some()
            })
            .collect();
        let readings = reweighted.readings(class, rows);
        for variable in Variable::ALL {
            let Some(by_row) = variables.values(id.quantity, id.cable, variable) else {
                continue;
            };
            let value = |row: &usize| space.measured[*row].map_or(f64::NAN, |index| by_row[index]);
            let rows = readings.described.rows.iter().copied();
            let finite: Vec<usize> = rows.filter(|row| value(row).is_finite()).collect();
            let values: Vec<f64> = finite.iter().map(value).collect();
            let some = (finite.len() < readings.described.rows.len())
                .then(|| reweighted.readings(class, finite));
            tests.extend(some.as_ref().unwrap_or(&readings).test(variable, values));
        }
    }
    tests
}

/// Residuals with weights that match their actual scatter.
struct ReweightedResiduals<'a> {
    /// The residuals with the noise as described.
    described: &'a ResidualSpace,
    /// The reweighted residuals, if any weight differs.
    weighted: Option<ResidualSpace>,
    /// Variance of each class over the described one.
    variances: Vec<f64>,
    ids: Vec<ReadingId>,
    class_of: Vec<Option<usize>>,
    sums: ClassSums,
    redundancy: Vec<f64>,
}

impl<'a> ReweightedResiduals<'a> {
    fn new(described: &'a ResidualSpace) -> Self {
        let (ids, class_of) = classes(described, |id| *id);
        let variances = excess_variances(described, EXCESS_LEVEL);
        let is_other = variances.iter().any(|variance| *variance != 1.0);
        let weighted = is_other.then(|| described.with_variances(&variances));
        let reweighted = weighted.as_ref().unwrap_or(described);
        Self {
            sums: reweighted.class_sums(&class_of, ids.len()),
            redundancy: reweighted.redundancy(),
            described,
            weighted,
            variances,
            ids,
            class_of,
        }
    }

    fn readings(&self, class: usize, rows: Vec<usize>) -> TestedReadings {
        let scaled = self.sums.scaled_chi_square(class);
        TestedReadings {
            id: self.ids[class],
            trace: rows.iter().map(|row| self.redundancy[*row]).sum(),
            scaled: scaled.map(|(factor, _)| factor),
            variance: self.variances[class],
            weighted: self
                .weighted
                .as_ref()
                .map(|space| space.group(rows.clone())),
            described: self.described.group(rows),
        }
    }
}

/// The readings that one test is about.
struct TestedReadings {
    id: ReadingId,
    described: RowGroup,
    weighted: Option<RowGroup>,
    /// Variance in the weights over the described one.
    variance: f64,
    /// Sum of the redundancies with these weights.
    trace: f64,
    /// Factor of the scaled chi-square distribution of the sum of squared residuals, with these weights.
    scaled: Option<f64>,
}

impl TestedReadings {
    fn test(&self, variable: Variable, values: Vec<f64>) -> Option<DependenceTest> {
        let most = values.len() / READINGS_PER_SMOOTH_FUNCTION;
        let functions = smooth_functions(&values, variable, most);
        if functions.is_empty() {
            return None;
        }
        let score = self.described.score(&functions);
        let described = ScoreFit::new(&functions, &score);
        let reweighted = self.weighted.as_ref().map(|group| {
            let score = group.score(&functions);
            (group, ScoreFit::new(&functions, &score), score)
        });
        let (group, fit, score) = match &reweighted {
            Some((group, fit, score)) => (*group, fit, score),
            None => (&self.described, &described, &score),
        };
        let rank = fit.rank as f64;
        let (rest, p_value) = match self.residual_variance(group, score, fit) {
            Some((rest, freedom)) => {
                let ratio = fit.chi2 / rank / rest;
                (rest, f_survival(ratio, [rank, freedom])?)
            }
            None => (1.0, chi_square_survival(fit.chi2, rank)?),
        };
        Some(DependenceTest {
            quantity: self.id.quantity,
            cable: self.id.cable,
            component: self.id.component,
            variable,
            chi2: described.chi2,
            rank: described.rank,
            noise_factor: rest * self.variance,
            p_value,
            rows: self.described.rows.clone(),
            values,
            functions,
        })
    }

    /// Residual variance after fitting the functions, relative to the weights, with its degrees of freedom; `None` if
    /// it is not significantly larger than the described noise. The remaining sum of squares is taken as scaled
    /// chi-square with the same factor as the total.
    fn residual_variance(
        &self,
        group: &RowGroup,
        score: &Score,
        fit: &ScoreFit,
    ) -> Option<(f64, f64)> {
        let remaining = &group.residual - &score.projected * &fit.coefficients;
        let squares = score.projected.tr_mul(&score.projected);
        let trace = self.trace - squares.dot(&fit.inverse);
        let freedom = trace / self.scaled?;
        let factor = remaining.norm_squared() / trace;
        let p = chi_square_survival(factor * freedom, freedom)?;
        (self.variance != 1.0 || p < EXCESS_LEVEL).then_some((factor, freedom))
    }
}

/// Least squares fit of functions to a score.
struct ScoreFit {
    chi2: f64,
    rank: usize,
    coefficients: nalgebra::DVector<f64>,
    /// Pseudo-inverse of the information.
    inverse: DMatrix<f64>,
}

impl ScoreFit {
    fn new(functions: &DMatrix<f64>, score: &Score) -> Self {
        let count = functions.ncols();
        let norms: Vec<f64> = functions
            .column_iter()
            .map(|f| f.norm().max(f64::MIN_POSITIVE))
            .collect();
        let scaled = DMatrix::from_fn(count, count, |i, k| {
            score.information[(i, k)] / (norms[i] * norms[k])
        });
        let eigen = SymmetricEigen::new(scaled);
        let mut fit = Self {
            chi2: 0.0,
            rank: 0,
            coefficients: nalgebra::DVector::zeros(count),
            inverse: DMatrix::zeros(count, count),
        };
        for (direction, value) in eigen.eigenvectors.column_iter().zip(&eigen.eigenvalues) {
            if *value <= MIN_VISIBLE_SHARE {
                continue;
            }
            let direction = direction.map_with_location(|k, _, d| d / norms[k]);
            let amount = direction.dot(&score.score);
            fit.chi2 += amount * amount / value;
            fit.rank += 1;
            fit.coefficients.axpy(amount / value, &direction, 1.0);
            fit.inverse.ger(value.recip(), &direction, &direction, 1.0);
        }
        fit
    }
}

/// The dependences that are significant at level `alpha` over all tests (Bonferroni), in order of the chi-square that
/// they explain less two per function. At most three variables are reported for the readings of one kind and cable.
pub(crate) fn discrepancies(
    space: &ResidualSpace,
    tests: &[DependenceTest],
    alpha: f64,
) -> Vec<Discrepancy> {
    let test_count = tests.len() as f64;
    let mut significant: Vec<&DependenceTest> = tests
        .iter()
        .filter(|test| test.p_value * test_count < alpha)
        .collect();
    // Sorting by p-value would be useless for large errors, whose p-values all underflow.
    let gain = |t: &DependenceTest| t.chi2 - 2.0 * t.rank as f64;
    significant.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
    let redundancy = space.redundancy();
    let mut kept: Vec<Discrepancy> = Vec::new();
    for test in significant {
        let same = |d: &&Discrepancy| (d.quantity, d.cable) == (test.quantity, test.cable);
        if kept.iter().filter(same).count() < MAX_REPORTED_VARIABLES {
            kept.push(to_discrepancy(space, &redundancy, test, test_count));
        }
    }
    kept
}

fn to_discrepancy(
    space: &ResidualSpace,
    redundancy: &[f64],
    test: &DependenceTest,
    test_count: f64,
) -> Discrepancy {
    let squares: f64 = test
        .rows
        .iter()
        .map(|row| space.residual[*row].powi(2))
        .sum();
    let trace: f64 = test.rows.iter().map(|row| redundancy[*row]).sum();
    let point = |(row, value): (&usize, &f64)| {
        let share = Some(redundancy[*row]).filter(|share| *share > MIN_PLOTTED_REDUNDANCY)?;
        Some((
            space.measured[*row]?,
            *value,
            space.residual[*row] / share.sqrt(),
        ))
    };
    Discrepancy {
        quantity: test.quantity,
        cable: test.cable,
        variable: test.variable,
        rms_over_sd: (squares / trace).sqrt(),
        p_value: (test.p_value * test_count).min(1.0),
        points: test
            .rows
            .iter()
            .zip(&test.values)
            .filter_map(point)
            .collect(),
    }
}
