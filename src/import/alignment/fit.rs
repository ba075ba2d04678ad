//! Clock offset and drift by least squares, together with the polynomial that maps one recording to the other.

use std::ops::Range;

use nalgebra::{DMatrix, DVector, Matrix2, SymmetricEigen, Vector2};

use super::coarse::Sampler;
use super::{ClockFit, Recording};

/// Maximum number of samples of the second recording; longer ones are thinned.
const SAMPLES: usize = 6000;
/// Maximum number of principal directions in the polynomial: a platform has six degrees of freedom.
const DIRECTIONS: usize = 6;
/// Minimum variance of a principal direction relative to the largest.
const VARIANCE: f64 = 1e-5;
/// Number of blocks that the jackknife leaves out in turn.
const PARTS: usize = 12;
/// Maximum number of Gauss-Newton steps.
const STEPS: usize = 30;
/// Minimum fraction of the variance that the fit must explain.
const EXPLAINED: f64 = 0.8;

/// Both recordings at those samples of the second that lie within the first.
struct Rows {
    /// Times of the samples on their own clock, relative to the middle (s).
    time_s: Vec<f64>,
    /// Terms of the polynomial, one row per sample.
    terms: DMatrix<f64>,
    /// Time derivatives of the terms by central differences (1/s).
    rates: DMatrix<f64>,
    /// Channels of the second recording, one per column.
    values: DMatrix<f64>,
}

/// Fits the clock of `other`, starting from the coarse lag (s).
pub(super) fn refine(reference: &Recording, other: &Recording, lag_s: f64) -> Option<ClockFit> {
    let basis = Basis::of(reference);
    let every = other.time_s.len().div_ceil(SAMPLES);
    let range = [
        reference.time_s[0],
        reference.time_s[reference.time_s.len() - 1],
    ];
    let inside = |time: f64| time + lag_s >= range[0] && time + lag_s <= range[1];
    let kept: Vec<usize> = (0..other.time_s.len())
        .step_by(every)
        .filter(|row| inside(other.time_s[*row]))
        .collect();
    let (first, last) = (*kept.first()?, *kept.last()?);
    let middle_s = f64::midpoint(other.time_s[first], other.time_s[last]);
    let mut clock = Vector2::new(lag_s, 0.0);
    let mut solved = None;
    for _ in 0..STEPS {
        let rows = rows(reference, other, &basis, (&kept, middle_s), clock)?;
        let step = Step::of(&rows)?;
        let half_s = 0.5 * (other.time_s[last] - other.time_s[first]);
        let moved = step.change[0].abs() + step.change[1].abs() * half_s;
        clock += step.change;
        let is_done = moved < 1e-3 * step.sd()[0].max(1e-9);
        solved = Some(step);
        if is_done {
            break;
        }
    }
    let step = solved?;
    let [offset_sd_s, drift_sd] = step.sd();
    let is_found = step.explained > EXPLAINED && offset_sd_s.is_finite() && drift_sd.is_finite();
    is_found.then_some(ClockFit {
        offset_s: clock[0],
        offset_sd_s,
        drift: clock[1],
        drift_sd,
        middle_s,
        explained: step.explained,
    })
}

/// Principal directions of the channels of the first recording, scaled to a variance of about 1.
struct Basis {
    mean: DVector<f64>,
    /// One direction per row.
    directions: DMatrix<f64>,
}

impl Basis {
    fn of(reference: &Recording) -> Self {
        let (rows, columns) = (reference.time_s.len(), reference.channels.len());
        let mean = DVector::from_iterator(
            columns,
            reference
                .channels
                .iter()
                .map(|one| one.iter().sum::<f64>() / rows as f64),
        );
        let sd: Vec<f64> = reference
            .channels
            .iter()
            .zip(mean.iter())
            .map(|(one, mean)| {
                let squares = one.iter().map(|value| (value - mean).powi(2));
                (squares.sum::<f64>() / rows as f64).sqrt()
            })
            .collect();
        let covariance = DMatrix::from_fn(columns, columns, |i, k| {
            let (a, b) = (&reference.channels[i], &reference.channels[k]);
            let products = a.iter().zip(b).map(|(a, b)| (a - mean[i]) * (b - mean[k]));
            products.sum::<f64>() / (rows as f64 * sd[i] * sd[k])
        });
        let eigen = SymmetricEigen::new(covariance);
        let mut order: Vec<usize> = (0..columns).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let largest = eigen.eigenvalues[order[0]];
        order.retain(|k| eigen.eigenvalues[*k] > VARIANCE * largest);
        order.truncate(DIRECTIONS);
        let directions = DMatrix::from_fn(order.len(), columns, |row, column| {
            let k = order[row];
            eigen.eigenvectors[(column, k)] / (sd[column] * eigen.eigenvalues[k].sqrt())
        });
        Self { mean, directions }
    }

    /// Terms of the second-degree polynomial: 1, the coordinates, their pairwise products.
    fn terms(&self, channels: &DVector<f64>) -> Vec<f64> {
        let x = &self.directions * (channels - &self.mean);
        let mut terms = vec![1.0];
        terms.extend(x.iter());
        for i in 0..x.len() {
            terms.extend((0..=i).map(|k| x[i] * x[k]));
        }
        terms
    }
}

/// Evaluates both recordings at the samples `kept` of the second for a given clock.
fn rows(
    reference: &Recording,
    other: &Recording,
    basis: &Basis,
    (kept, middle_s): (&[usize], f64),
    clock: Vector2<f64>,
) -> Option<Rows> {
    let usual = (reference.time_s[reference.time_s.len() - 1] - reference.time_s[0])
        / reference.time_s.len() as f64;
    let half = 2.0 * usual;
    let samplers = || -> Vec<Sampler<'_>> {
        let channels = reference.channels.iter();
        channels
            .map(|channel| Sampler::new(&reference.time_s, channel))
            .collect()
    };
    let (mut now, mut before, mut after) = (samplers(), samplers(), samplers());
    let at = |samplers: &mut Vec<Sampler<'_>>, time: f64| {
        let values = samplers.iter_mut().map(|sampler| sampler.value(time));
        basis.terms(&DVector::from_iterator(reference.channels.len(), values))
    };
    let range = [
        reference.time_s[0] + half,
        reference.time_s[reference.time_s.len() - 1] - half,
    ];
    let (mut time_s, mut terms, mut rates, mut values) = (vec![], vec![], vec![], vec![]);
    for row in kept {
        let own = other.time_s[*row] - middle_s;
        let time = other.time_s[*row] + clock[0] + clock[1] * own;
        if !(range[0]..=range[1]).contains(&time) {
            continue;
        }
        time_s.push(own);
        terms.extend(at(&mut now, time));
        let (earlier, later) = (at(&mut before, time - half), at(&mut after, time + half));
        rates.extend(
            later
                .iter()
                .zip(&earlier)
                .map(|(b, a)| (b - a) / (2.0 * half)),
        );
        values.extend(other.channels.iter().map(|channel| channel[*row]));
    }
    let count = time_s.len();
    let width = terms.len() / count.max(1);
    (count > width + 2 * PARTS).then(|| Rows {
        terms: DMatrix::from_row_slice(count, width, &terms),
        rates: DMatrix::from_row_slice(count, width, &rates),
        values: DMatrix::from_row_slice(count, other.channels.len(), &values),
        time_s,
    })
}

/// Contribution of one block to the normal equations of a channel: products of the polynomial's terms, of the slopes by
/// offset and drift, and of the residuals of the polynomial.
struct Products {
    mixed: DMatrix<f64>,
    slopes: Matrix2<f64>,
    terms_left: DVector<f64>,
    slopes_left: Vector2<f64>,
}

/// Step of offset and drift from all blocks but one, with the polynomial of each channel adjusted jointly.
fn solve(
    grams: &[DMatrix<f64>],
    channels: &[(f64, Vec<Products>)],
    without: Option<usize>,
) -> Option<Vector2<f64>> {
    let kept = || (0..grams.len()).filter(|part| Some(*part) != without);
    let width = grams.first()?.nrows();
    let gram = kept().fold(DMatrix::zeros(width, width), |sum, part| sum + &grams[part]);
    let inverse = gram.cholesky()?;
    let (mut matrix, mut vector) = (Matrix2::zeros(), Vector2::zeros());
    for (noise, parts) in channels {
        let mut mixed = DMatrix::zeros(width, 2);
        let mut terms_left = DVector::zeros(width);
        for products in kept().map(|part| &parts[part]) {
            mixed += &products.mixed;
            terms_left += &products.terms_left;
            matrix += products.slopes / *noise;
            vector += products.slopes_left / *noise;
        }
        let reduced = inverse.solve(&mixed);
        matrix -= mixed.tr_mul(&reduced).fixed_view::<2, 2>(0, 0).into_owned() / *noise;
        vector -= reduced.tr_mul(&terms_left).fixed_rows::<2>(0).into_owned() / *noise;
    }
    matrix.try_inverse().map(|inverse| inverse * vector)
}

/// Gauss-Newton step with its leave-one-block-out replicates.
struct Step {
    /// Step of offset (s) and drift (s/s).
    change: Vector2<f64>,
    /// The same step with each block left out in turn.
    without: Vec<Vector2<f64>>,
    explained: f64,
}

impl Step {
    fn of(rows: &Rows) -> Option<Self> {
        let (q, r) = rows.terms.clone().qr().unpack();
        let coefficients = r.solve_upper_triangular(&(q.transpose() * &rows.values))?;
        let count = rows.time_s.len();
        let parts: Vec<Range<usize>> = (0..PARTS)
            .map(|part| part * count / PARTS..(part + 1) * count / PARTS)
            .collect();
        let grams: Vec<DMatrix<f64>> = parts
            .iter()
            .map(|part| {
                q.rows_range(part.clone())
                    .tr_mul(&q.rows_range(part.clone()))
            })
            .collect();
        let mut channels = Vec::new();
        let (mut left, mut whole) = (0.0, 0.0);
        for k in 0..rows.values.ncols() {
            let values = rows.values.column(k).into_owned();
            let residual = &values - &q * q.tr_mul(&values);
            let variance = values.add_scalar(-values.mean()).norm_squared();
            let noise = residual.norm_squared() / (count - rows.terms.ncols()) as f64;
            if !(variance > 0.0 && noise > 0.0) {
                continue;
            }
            left += residual.norm_squared() / variance;
            whole += 1.0;
            let rate = &rows.rates * coefficients.column(k);
            let timed = rate.component_mul(&DVector::from_column_slice(&rows.time_s));
            let slopes = DMatrix::from_columns(&[rate, timed]);
            let of_part = |part: &Range<usize>| {
                let q = q.rows_range(part.clone());
                let slopes = slopes.rows_range(part.clone());
                let residual = residual.rows_range(part.clone());
                Products {
                    mixed: q.tr_mul(&slopes),
                    slopes: slopes.tr_mul(&slopes).fixed_view::<2, 2>(0, 0).into_owned(),
                    terms_left: q.tr_mul(&residual),
                    slopes_left: slopes.tr_mul(&residual).fixed_rows::<2>(0).into_owned(),
                }
            };
            channels.push((noise, parts.iter().map(of_part).collect::<Vec<_>>()));
        }
        let solve = |without: Option<usize>| solve(&grams, &channels, without);
        Some(Self {
            change: solve(None)?,
            without: (0..PARTS)
                .map(|part| solve(Some(part)))
                .collect::<Option<_>>()?,
            explained: 1.0 - left / f64::max(whole, 1.0),
        })
    }

    /// Standard deviations of offset and drift.
    fn sd(&self) -> [f64; 2] {
        let count = self.without.len() as f64;
        let mean = self.without.iter().sum::<Vector2<f64>>() / count;
        let squares = self
            .without
            .iter()
            .fold(Vector2::zeros(), |sum: Vector2<f64>, one| {
                sum + (one - mean).component_mul(&(one - mean))
            });
        let variance = squares * (count - 1.0) / count;
        [variance[0].sqrt(), variance[1].sqrt()]
    }
}
