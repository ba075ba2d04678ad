//! Fit of the elongation surface and choice of its degree.

use nalgebra::DMatrix;
use rand::SeedableRng;
use rand::seq::SliceRandom;

use super::elongation_surface::{ElongationSurface, MAX_DEGREE, exponents, term_count};
use crate::fitting::{FitStatistics, fit_linear};

/// Number of folds of the cross-validation.
const FOLDS: usize = 10;

/// Seed of the random division into folds; fixed so that the same data always give the same degree. The data are
/// sorted on a grid: without shuffling, a fold would hold out a whole length or tension.
const FOLD_SEED: u64 = 2392;

/// One elongation measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElongationTriple {
    /// Cable length (m).
    pub length_m: f64,
    /// Cable tension (N).
    pub tension_n: f64,
    /// Elongation (m).
    pub elongation_m: f64,
}

/// Errors of fitting an elongation surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ElongationFitError {
    /// The degree is not 1 to 5.
    #[error("degree {0} is not between 1 and 5")]
    Degree(usize),
    /// A value is NaN or infinite.
    #[error("measurement {0} holds a value that is not a finite number")]
    NotFinite(usize),
    /// There are no more measurements than coefficients.
    #[error("degree {degree} has {terms} coefficients: {given} measurements are too few")]
    TooFew {
        /// The degree.
        degree: usize,
        /// Number of its coefficients.
        terms: usize,
        /// Number of measurements.
        given: usize,
    },
    /// The measurements do not determine all coefficients.
    #[error("the measurements do not determine a surface of degree {degree}: {reason}")]
    RankDeficient {
        /// The degree.
        degree: usize,
        /// Reason, as a clause.
        reason: String,
    },
}

/// Cross-validation result of one degree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DegreeScore {
    /// Total degree.
    pub degree: usize,
    /// Root mean square error at the held-out measurements (m); `None` if some fold leaves too few
    /// measurements to fit this degree.
    pub error_m: Option<f64>,
    /// Mean square error over all held-out measurements (m^2), the square of `error_m`.
    pub mean_square_m2: Option<f64>,
    /// Standard error of the mean square, from its spread over the folds (m^2).
    pub standard_error_m2: Option<f64>,
}

/// The chosen surface and the cross-validation scores of all degrees.
#[derive(Debug, Clone, PartialEq)]
pub struct DegreeChoice {
    /// The surface of the chosen degree, fitted to all measurements.
    pub surface: ElongationSurface,
    /// Degrees 1 to 5.
    pub scores: Vec<DegreeScore>,
}

/// Fits the least-squares surface of the given total degree; see [`ElongationSurface`].
///
/// Centre and scale come from the range of the data, so that they lie in `[-1, 1]`.
///
/// # Errors
/// If the degree is out of range, or number or arrangement of the measurements do not determine the surface.
pub fn fit_elongation_surface(
    triples: &[ElongationTriple],
    degree: usize,
) -> Result<ElongationSurface, ElongationFitError> {
    let mut surface = empty_surface(triples, degree)?;
    let fit = fit_terms(&surface, triples.iter());
    if !fit.is_full_rank() {
        return Err(ElongationFitError::RankDeficient {
            degree,
            reason: "lengths and tensions were not varied independently".to_owned(),
        });
    }
    surface.coefficients = fit.parameters;
    surface.residual_sd_m = fit.residual_sd;
    Ok(surface)
}

/// Fits degrees 1 to 5 with ten-fold cross-validation and chooses the smallest degree whose mean square
/// error is within one standard error of the minimum (Hastie, Tibshirani, Friedman, *The Elements
/// of Statistical Learning*, section 7.10): a higher degree must earn its coefficients.
///
/// # Errors
/// If not even degree 1 can be fitted.
pub fn choose_elongation_degree(
    triples: &[ElongationTriple],
) -> Result<DegreeChoice, ElongationFitError> {
    let mut fold_of: Vec<usize> = (0..triples.len()).map(|i| i % FOLDS).collect();
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(FOLD_SEED);
    fold_of.shuffle(&mut random);
    let scores: Vec<DegreeScore> = (1..=MAX_DEGREE)
        .map(|degree| score(triples, &fold_of, degree))
        .collect();
    let bound = scores
        .iter()
        .filter_map(|s| Some((s.mean_square_m2?, s.standard_error_m2?)))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(0.0, |(least, standard_error)| least + standard_error);
    let chosen = scores
        .iter()
        .find(|s| s.mean_square_m2.is_some_and(|square| square <= bound))
        .map_or(1, |s| s.degree);
    Ok(DegreeChoice {
        surface: fit_elongation_surface(triples, chosen)?,
        scores,
    })
}

/// Returns a surface with centre, scale and degree but no coefficients, once the data are known to determine it.
fn empty_surface(
    triples: &[ElongationTriple],
    degree: usize,
) -> Result<ElongationSurface, ElongationFitError> {
    if !(1..=MAX_DEGREE).contains(&degree) {
        return Err(ElongationFitError::Degree(degree));
    }
    for (index, t) in triples.iter().enumerate() {
        let values = [t.length_m, t.tension_n, t.elongation_m];
        if !values.iter().all(|v| v.is_finite()) {
            return Err(ElongationFitError::NotFinite(index + 1));
        }
    }
    let terms = term_count(degree);
    if triples.len() <= terms {
        let given = triples.len();
        return Err(ElongationFitError::TooFew {
            degree,
            terms,
            given,
        });
    }
    let lengths: Vec<f64> = triples.iter().map(|t| t.length_m).collect();
    let tensions: Vec<f64> = triples.iter().map(|t| t.tension_n).collect();
    let (length_center_m, length_scale_m) = range(lengths, "lengths", degree)?;
    let (tension_center_n, tension_scale_n) = range(tensions, "tensions", degree)?;
    Ok(ElongationSurface {
        degree,
        length_center_m,
        length_scale_m,
        tension_center_n,
        tension_scale_n,
        coefficients: Vec::new(),
        residual_sd_m: 0.0,
    })
}

/// Midpoint and half-width of the values; a polynomial needs one more distinct value than its degree.
fn range(
    mut values: Vec<f64>,
    name: &str,
    degree: usize,
) -> Result<(f64, f64), ElongationFitError> {
    values.sort_by(f64::total_cmp);
    values.dedup();
    if values.len() <= degree {
        let (needed, given) = (degree + 1, values.len());
        return Err(ElongationFitError::RankDeficient {
            degree,
            reason: format!("it needs {needed} different {name}, there are {given}"),
        });
    }
    let (lowest, highest) = (values[0], values[values.len() - 1]);
    Ok((0.5 * (lowest + highest), 0.5 * (highest - lowest)))
}

fn fit_terms<'a>(
    surface: &ElongationSurface,
    triples: impl Iterator<Item = &'a ElongationTriple>,
) -> FitStatistics {
    let triples: Vec<&ElongationTriple> = triples.collect();
    let terms: Vec<(i32, i32)> = exponents(surface.degree).collect();
    let design = DMatrix::from_fn(triples.len(), terms.len(), |i, k| {
        let x = (triples[i].length_m - surface.length_center_m) / surface.length_scale_m;
        let y = (triples[i].tension_n - surface.tension_center_n) / surface.tension_scale_n;
        x.powi(terms[k].0) * y.powi(terms[k].1)
    });
    let elongations: Vec<f64> = triples.iter().map(|t| t.elongation_m).collect();
    fit_linear(&design, &elongations, None)
}

fn score(triples: &[ElongationTriple], fold_of: &[usize], degree: usize) -> DegreeScore {
    let squares: Option<Vec<(f64, usize)>> = empty_surface(triples, degree).ok().and_then(|s| {
        (0..FOLDS.min(triples.len()))
            .map(|fold| left_out_square(&s, triples, fold_of, fold))
            .collect()
    });
    let Some(squares) = squares else {
        return DegreeScore {
            degree,
            error_m: None,
            mean_square_m2: None,
            standard_error_m2: None,
        };
    };
    let mean = squares.iter().map(|(sum, _)| sum).sum::<f64>() / triples.len() as f64;
    let count = squares.len() as f64;
    let spread: f64 = squares
        .iter()
        .map(|(sum, left_out)| (sum / *left_out as f64 - mean).powi(2))
        .sum();
    DegreeScore {
        degree,
        error_m: Some(mean.sqrt()),
        mean_square_m2: Some(mean),
        standard_error_m2: Some((spread / (count - 1.0) / count).sqrt()),
    }
}

/// Sum of squared errors at the measurements of one fold under a fit to all others, and their number.
fn left_out_square(
    template: &ElongationSurface,
    triples: &[ElongationTriple],
    fold_of: &[usize],
    fold: usize,
) -> Option<(f64, usize)> {
    let of_fold = |inside: bool| {
        let folds = triples.iter().zip(fold_of);
        folds
            .filter(move |(_, f)| (**f == fold) == inside)
            .map(|(t, _)| t)
    };
    let fit = fit_terms(template, of_fold(false));
    if !fit.is_full_rank() {
        return None;
    }
    let surface = ElongationSurface {
        coefficients: fit.parameters,
        ..template.clone()
    };
    let errors = of_fold(true).map(|t| {
        let value = surface.evaluate_unchecked(t.length_m, t.tension_n);
        value.elongation_m - t.elongation_m
    });
    let squares: Vec<f64> = errors.map(|e| e * e).collect();
    Some((squares.iter().sum(), squares.len()))
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// A grid of 8 lengths and 9 tensions on a surface cubic in tension and linear in length.
    fn measurements(noise_m: f64, seed: u64) -> Vec<ElongationTriple> {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let grid = (0..8).flat_map(|i| (0..9).map(move |j| (f64::from(i), f64::from(j))));
        grid.map(|(i, j)| {
            let (length_m, tension_n) = (0.5 + 0.4 * i, 5.0 + 12.0 * j);
            let stiffening = tension_n - 0.004 * tension_n * tension_n + 1.5e-5 * tension_n.powi(3);
            let noise: f64 = StandardNormal.sample(&mut random);
            ElongationTriple {
                length_m,
                tension_n,
                elongation_m: 1e-4 * stiffening * (1.0 + 0.3 * length_m) + noise_m * noise,
            }
        })
        .collect()
    }

    #[test]
    fn reproduces_a_polynomial_exactly() {
        let exact = measurements(0.0, 1);
        let surface = fit_elongation_surface(&exact, 4).unwrap();
        assert_eq!(surface.check(), None);
        for t in &exact {
            let value = surface.evaluate(t.length_m, t.tension_n).unwrap();
            assert!((value.elongation_m - t.elongation_m).abs() < 1e-14);
        }
    }

    #[test]
    fn residual_sd_is_that_of_the_noise() {
        // 72 - 15 = 57 degrees of freedom, 200 trials: the mean variance has a relative sd of 1.3 %;
        // 5 sd: false failure 6e-7 (fixed seeds).
        let variance: f64 = (0..200)
            .map(|seed| fit_elongation_surface(&measurements(2e-5, seed), 4).unwrap())
            .map(|surface| (surface.residual_sd_m / 2e-5).powi(2) / 200.0)
            .sum();
        assert!((variance - 1.0).abs() < 0.066, "{variance}");
    }

    #[test]
    fn chooses_the_degree_that_the_noise_allows() {
        let fine = choose_elongation_degree(&measurements(1e-6, 3)).unwrap();
        assert_eq!(
            fine.surface.degree, 4,
            "cubic in tension times linear in length"
        );
        let errors: Vec<f64> = fine.scores.iter().map(|s| s.error_m.unwrap()).collect();
        assert!(errors[0] > errors[1] && errors[3] < 2e-6, "{errors:?}");
        let coarse = choose_elongation_degree(&measurements(2e-3, 3)).unwrap();
        assert!(coarse.surface.degree < 4);
        assert_eq!(
            coarse,
            choose_elongation_degree(&measurements(2e-3, 3)).unwrap()
        );
    }

    #[test]
    fn too_little_data_is_refused_in_words() {
        let all = measurements(0.0, 1);
        let few = fit_elongation_surface(&all[..10], 4)
            .unwrap_err()
            .to_string();
        assert_eq!(
            few,
            "degree 4 has 15 coefficients: 10 measurements are too few"
        );
        let three_lengths = fit_elongation_surface(&all[..27], 5)
            .unwrap_err()
            .to_string();
        assert!(three_lengths.ends_with("it needs 6 different lengths, there are 3"));
        let diagonal: Vec<ElongationTriple> = (0..60)
            .map(|i| ElongationTriple {
                length_m: f64::from(i),
                tension_n: 2.0 * f64::from(i),
                elongation_m: 0.0,
            })
            .collect();
        let error = fit_elongation_surface(&diagonal, 2)
            .unwrap_err()
            .to_string();
        assert!(error.contains("not varied independently"));
        assert!(choose_elongation_degree(&all[..9]).is_err());
        let choice = choose_elongation_degree(&all[..36]).unwrap();
        assert!(
            choice.scores[4].error_m.is_none(),
            "four lengths allow degree 3 at most"
        );
    }
}
