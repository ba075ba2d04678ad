//! Correlation of the noise of readings in time, estimated from the residuals of a smooth motion.
//!
//! The noise is modelled as autoregressive of first order: its correlation over `h` samples is `rho^h`. The residual of a
//! local polynomial is a filter `c` of the noise, `r_t = sum_k c_k e_(t+k)`, so the correlation of
//! neighbouring residuals is `c'R_1 c / c'R_0 c` with `R_h = rho^|i - j - h|`, which is solved for `rho`. The motion
//! cancels, whatever it is, and so does the model. Noise that varies more slowly than the window cannot be separated from
//! motion. Source: G. E. P. Box and G. M. Jenkins, Time Series Analysis (1970), for the moments of filtered series.

/// Largest correlation of neighbouring samples that is considered.
const LARGEST: f64 = 0.995;
/// Number of bisections.
const BISECTIONS: usize = 40;

/// Sums of products of neighbouring residuals.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Moments {
    /// Sum of squares.
    own: f64,
    /// Sum of products with the next residual.
    next: f64,
}

impl Moments {
    /// Adds a residual and the next one, unless one is missing.
    pub fn add(&mut self, remainder: f64, next: f64) {
        if remainder.is_finite() && next.is_finite() {
            self.own += 0.5 * (remainder * remainder + next * next);
            self.next += remainder * next;
        }
    }

    /// Correlation of the noise of neighbouring samples, for a given filter; `None` without residuals.
    pub fn correlation(&self, filter: &[f64]) -> Option<f64> {
        if self.own <= 0.0 {
            return None;
        }
        let found = self.next / self.own;
        let (mut low, mut high) = (0.0, LARGEST);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if neighbours(filter, middle) < found {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(0.5 * (low + high))
    }
}

/// Correlation of neighbouring residuals of noise with the correlation `rho`.
fn neighbours(filter: &[f64], rho: f64) -> f64 {
    let powers: Vec<f64> = (0..=filter.len()).map(|h| rho.powi(h as i32)).collect();
    let moment = |lag: usize| -> f64 {
        let mut sum = 0.0;
        for (i, a) in filter.iter().enumerate() {
            for (j, b) in filter.iter().enumerate() {
                sum += a * b * powers[i.abs_diff(j + lag)];
            }
        }
        sum
    };
    moment(1) / moment(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::samples::generator;
    use crate::measurement::local_polynomial::Weights;
    use rand::RngExt;
    use rand_distr::StandardNormal;

    /// The standard deviation of the estimate from 20,000 samples is about 0.02 at most: false alarms are out of reach
    /// with a fixed seed.
    #[test]
    fn the_correlation_of_simulated_noise_comes_back() {
        let times: Vec<f64> = (-25..=25).map(|k| 0.01 * f64::from(k)).collect();
        let filter = Weights::new(&times).unwrap().residual();
        let mut rng = generator(3);
        for rho in [0.0, 0.3, 0.8, 0.9] {
            let mut state = 0.0;
            let noise: Vec<f64> = (0..20_000)
                .map(|_| {
                    let step: f64 = rng.sample(StandardNormal);
                    state = rho * state + step * f64::sqrt(1.0 - rho * rho);
                    state
                })
                .collect();
            let remainder =
                |at: usize| -> f64 { filter.iter().zip(&noise[at..]).map(|(c, e)| c * e).sum() };
            let mut moments = Moments::default();
            (0..19_900).for_each(|at| moments.add(remainder(at), remainder(at + 1)));
            let found = moments.correlation(&filter).unwrap();
            assert!((found - rho).abs() < 0.06, "{rho}: {found}");
        }
        assert_eq!(Moments::default().correlation(&filter), None);
    }
}
