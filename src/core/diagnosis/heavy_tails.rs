//! Heavy tails of the noise as a rival of single wrong readings.
//!
//! A wrong reading looks like a rare large error of noise with heavier tails than normal. Two descriptions of all
//! readings of one kind are compared: normal noise with some wrong readings, each with its prior probability and size,
//! and noise with a Student's t distribution (Lange, Little and Taylor 1989). The other readings tell which is right,
//! if there are enough of them: with heavy tails, some of their errors are large, too.

use std::f64::consts::{PI, TAU};

use super::budget::{MIN_REDUNDANCY_OF_TAILS, UNDETERMINED};
use super::inference::Inference;
use super::priors::{HEAVY_TAILS, TAIL_FREEDOMS, TAIL_SCALES};
use super::report::Quantity;
use super::residual_space::ResidualSpace;
use crate::effect::Search;
use crate::statistics::{log_sum, logit};

/// A single wrong reading, of one number or of a vector.
#[derive(Debug, Clone)]
struct WrongReading {
    quantity: Quantity,
    /// Its errors in standard deviations, without components that the readings do not determine.
    errors: Vec<f64>,
    /// Log prior probability of a wrong reading times the prior density of its errors, per standard deviation.
    log_prior: f64,
}

impl WrongReading {
    fn size(&self) -> f64 {
        self.errors
            .iter()
            .map(|error| error * error)
            .sum::<f64>()
            .sqrt()
    }
}

/// For each cause of an inference the odds that heavy tails explain it; 0 for causes other than single wrong readings.
pub(super) fn odds_of_heavy_tails(inference: &Inference<'_>) -> Vec<f64> {
    let causes = &inference.fit.causes;
    if !causes.iter().any(|cause| cause.effect().is_wrong_reading()) {
        return vec![0.0; causes.len()];
    }
    let sds = inference.sds().into_iter().enumerate();
    let wrong: Vec<Option<WrongReading>> = sds
        .map(|(cause, sds)| wrong_reading(inference, cause, &sds))
        .collect();
    let space = ResidualSpace::new(&inference.fit.linearisation());
    let odds = |reading: &Option<WrongReading>| {
        let Some(reading) = reading else {
            return 0.0;
        };
        // Larger errors may be wrong readings all the same.
        let alike = wrong.iter().flatten();
        let alike = alike.filter(|w| w.quantity == reading.quantity && w.size() <= reading.size());
        let alike: Vec<&WrongReading> = alike.collect();
        let others = other_residuals(&space, reading.quantity, &alike);
        log_odds(&alike, &others).exp()
    };
    wrong.iter().map(odds).collect()
}

fn wrong_reading(
    inference: &Inference<'_>,
    cause: usize,
    sds: &[Option<f64>],
) -> Option<WrongReading> {
    let bound = &inference.fit.causes[cause].instances[0];
    let (Search::AtPose(place) | Search::AtDistance(place)) = bound.effect.search() else {
        return None;
    };
    let robot = &inference.fit.problem.dataset.robot;
    let of_errors = (0..bound.values.len()).filter(|k| *k != place);
    let determined = of_errors
        .zip(sds)
        .enumerate()
        .filter_map(|(column, (k, sd))| {
            let prior_sd = bound.effect.parameters()[k].prior_sd_in(robot);
            let sd = sd.filter(|sd| *sd < UNDETERMINED * prior_sd)?;
            Some(((column, bound.values[k]), sd))
        });
    let (values, sds): (Vec<(usize, f64)>, Vec<f64>) = determined.unzip();
    if values.is_empty() {
        return None;
    }
    let per_sd: f64 = sds.iter().map(|sd| sd.ln()).sum();
    let errors = values.iter().zip(&sds).map(|((_, value), sd)| value / sd);
    Some(WrongReading {
        quantity: inference.most_affected_class(cause)?.quantity,
        errors: errors.collect(),
        log_prior: inference.log_prior_density(cause, &values) + per_sd,
    })
}

/// Residuals of a kind of reading with their redundancies as weights, in units of their root mean square.
fn other_residuals(
    space: &ResidualSpace,
    quantity: Quantity,
    wrong: &[&WrongReading],
) -> Vec<(f64, f64)> {
    let redundancy = space.redundancy();
    let rows = (0..space.rows()).filter(|row| {
        space.readings[*row].is_some_and(|id| id.quantity == quantity)
            && redundancy[*row] > MIN_REDUNDANCY_OF_TAILS
    });
    let mut residuals: Vec<(f64, f64)> = rows
        .map(|row| {
            (
                space.residual[row] / redundancy[row].sqrt(),
                redundancy[row],
            )
        })
        .collect();
    // The residual of a wrong reading is zero, because the fit has its error as a parameter.
    residuals.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let wrong: usize = wrong.iter().map(|one| one.errors.len()).sum();
    residuals.drain(..wrong.min(residuals.len()));
    let (squares, weight) = residuals
        .iter()
        .fold((0.0, 0.0), |sum, (r, w)| (sum.0 + w * r * r, sum.1 + w));
    let rms = (squares / weight).sqrt();
    residuals.iter().map(|(r, w)| (r / rms, *w)).collect()
}

/// Log posterior odds of heavy tails over normal noise with some wrong readings, given the residuals of the other
/// readings with their weights, all in standard deviations.
fn log_odds(wrong: &[&WrongReading], others: &[(f64, f64)]) -> f64 {
    let normal = |z: f64| -0.5 * (z * z + TAU.ln());
    let with_wrong_readings = wrong.iter().map(|w| w.log_prior).sum::<f64>()
        + others.iter().map(|(z, w)| w * normal(*z)).sum::<f64>();
    let errors = wrong.iter().flat_map(|w| &w.errors);
    let mut with_tails = Vec::new();
    for freedom in TAIL_FREEDOMS {
        for scale in TAIL_SCALES {
            let density = |z: f64| log_student_t(z / scale, freedom) - scale.ln();
            with_tails.push(
                errors.clone().map(|error| density(*error)).sum::<f64>()
                    + others.iter().map(|(z, w)| w * density(*z)).sum::<f64>(),
            );
        }
    }
    let count = (with_tails.len() as f64).ln();
    log_sum(with_tails.into_iter()) - count - with_wrong_readings + logit(HEAVY_TAILS)
}

/// Log density of Student's t with 3, 4 or 6 degrees of freedom.
fn log_student_t(z: f64, freedom: f64) -> f64 {
    let half = 0.5 * (freedom + 1.0);
    let constant = statrs::function::gamma::ln_gamma(half)
        - statrs::function::gamma::ln_gamma(0.5 * freedom)
        - 0.5 * (freedom * PI).ln();
    constant - half * (z * z / freedom).ln_1p()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal, StudentT};

    fn wrong(size: f64) -> WrongReading {
        WrongReading {
            quantity: Quantity::Length,
            errors: vec![size],
            log_prior: -13.0,
        }
    }

    fn probability(wrong: &[WrongReading], others: &[f64]) -> f64 {
        let others: Vec<(f64, f64)> = others.iter().map(|z| (*z, 1.0)).collect();
        let wrong: Vec<&WrongReading> = wrong.iter().collect();
        1.0 / (1.0 + (-log_odds(&wrong, &others)).exp())
    }

    #[test]
    fn the_density_integrates_to_one() {
        for freedom in TAIL_FREEDOMS {
            let step = 0.01;
            let sum: f64 = (-100_000..=100_000)
                .map(|k| log_student_t(f64::from(k) * step, freedom).exp() * step)
                .sum();
            assert!((sum - 1.0).abs() < 1e-5, "{sum}");
        }
    }

    /// With random seeds, each of the three assertions fails with a probability below 1e-3.
    #[test]
    fn many_normal_readings_rule_out_heavy_tails() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let normal: Vec<f64> = (0..400).map(|_| StandardNormal.sample(&mut rng)).collect();
        assert!(probability(&[wrong(12.0)], &normal) < 0.01);
        // Few readings do not, unless the error is so large that no tails explain it.
        let few = &normal[..40];
        assert!((0.02..0.9).contains(&probability(&[wrong(9.0)], few)));
        assert!(probability(&[wrong(100.0)], few) < 0.02);
    }

    /// With random seeds, this fails with a probability below 1e-2.
    #[test]
    fn readings_with_heavy_tails_are_recognised() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let tails = StudentT::new(3.0).unwrap();
        let mut errors: Vec<f64> = (0..300).map(|_| tails.sample(&mut rng)).collect();
        errors.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let large = errors.split_off(297);
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        let others: Vec<f64> = errors.iter().map(|e| e / rms).collect();
        let large: Vec<WrongReading> = large.iter().map(|e| wrong((e / rms).abs())).collect();
        assert!(probability(&large, &others) > 0.95);
    }
}
