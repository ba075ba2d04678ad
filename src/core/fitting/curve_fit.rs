//! Nonlinear least squares for curves of a few parameters.

use nalgebra::{DMatrix, DVector};

use super::central_difference;
use super::fit_statistics::FitStatistics;
use super::trust_region::{Linearization, Step};

/// Computes the predictions at the given parameters.
pub type Predict<'a> = &'a dyn Fn(&[f64], &mut [f64]);

/// Computes the derivatives of the predictions, one row per observation, one column per parameter.
pub type Differentiate<'a> = &'a dyn Fn(&[f64], &mut DMatrix<f64>);

/// Minimise `sum ((y_i - f_i(p)) / sd_i)^2` over the parameters `p`.
pub struct CurveProblem<'a> {
    /// The observations `y_i`.
    pub observations: &'a [f64],
    /// Their standard deviations; absent: all 1.
    pub sd: Option<&'a [f64]>,
    /// The prediction `f(p)`. It may write NaN or infinities where it is undefined: such points
    /// are rejected.
    pub predict: Predict<'a>,
    /// The derivative of the prediction; `None`: central differences.
    pub jacobian: Option<Differentiate<'a>>,
}

/// Stopping rules of a curve fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveFitOptions {
    /// Largest number of Jacobians.
    pub max_iterations: usize,
    /// Converged when the relative offset is below this; see [`CurveFit::relative_offset`].
    pub offset_tolerance: f64,
}

impl Default for CurveFitOptions {
    fn default() -> Self {
        Self {
            max_iterations: 2000,
            offset_tolerance: 1e-6,
        }
    }
}

/// Reason why the iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Termination {
    /// A further step would not reduce the sum of squares noticeably.
    Stationary,
    /// No step, however short, lowers the sum of squares.
    NoProgress,
    /// The iteration limit was reached.
    IterationLimit,
    /// The prediction is not finite at the starting values.
    InvalidStart,
}

/// The result of a curve fit. Non-convergence is part of it, not an error.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveFit {
    /// Parameters and their uncertainties.
    pub statistics: FitStatistics,
    /// Whether the relative offset is below the tolerance.
    pub converged: bool,
    /// Reason why the iteration ended.
    pub termination: Termination,
    /// Length of the last Gauss-Newton step in standard deviations of the parameters, per root of
    /// their number: `sqrt(|c|^2 / n) / s`, with `c` the part of the residuals that the step would
    /// remove (Bates, Watts, Technometrics 23 (1981) 179). It measures the distance from the minimum
    /// statistically, whatever the scales of the parameters.
    pub relative_offset: f64,
    /// Number of Jacobians.
    pub iterations: usize,
    /// Number of predictions, those for numerical derivatives not counted.
    pub evaluations: usize,
}

/// Fits the parameters from starting values.
///
/// A trust-region Levenberg-Marquardt method (More, Lecture Notes in Mathematics 630 (1978) 105):
/// the trust region is an ellipsoid scaled by the norms of the Jacobian's columns, the
/// factorisation is orthogonal. Undamped Gauss-Newton steps refine the result. Validated on all
/// NIST StRD nonlinear problems.
///
/// # Panics
/// If the numbers of observations and standard deviations differ, or there are no parameters.
#[must_use]
pub fn fit_curve(problem: &CurveProblem, start: &[f64], options: &CurveFitOptions) -> CurveFit {
    assert!(!start.is_empty(), "at least one parameter");
    let mut fitter = Fitter::new(problem, start);
    let termination = if fitter.point.square_sum.is_finite() {
        let termination = fitter.descend(options);
        fitter.refine();
        termination
    } else {
        Termination::InvalidStart
    };
    fitter.summary(termination, options)
}

/// First radius of the trust region, relative to the scaled parameters. MINPACK's 100 steps over the
/// minimum of NIST's BoxBOD and MGH10 from their first starts; 0.3 to 10 solve all 54 starts.
const INITIAL_RADIUS: f64 = 1.0;

/// Parameters with their residuals.
struct Point {
    parameters: DVector<f64>,
    /// Weighted residuals `(y_i - f_i) / sd_i`.
    residuals: DVector<f64>,
    square_sum: f64,
}

struct Fitter<'a> {
    problem: &'a CurveProblem<'a>,
    point: Point,
    /// Diagonal of the scaling `D`: the longest each Jacobian column has been.
    scale: DVector<f64>,
    iterations: usize,
    evaluations: usize,
}

impl<'a> Fitter<'a> {
    fn new(problem: &'a CurveProblem<'a>, start: &[f64]) -> Self {
        if let Some(sd) = problem.sd {
            assert_eq!(sd.len(), problem.observations.len(), "one sd each");
        }
        let parameters = DVector::from_column_slice(start);
        Self {
            problem,
            scale: DVector::zeros(start.len()),
            point: evaluate(problem, parameters),
            iterations: 0,
            evaluations: 1,
        }
    }

    fn linearize(&mut self) -> Option<Linearization> {
        self.iterations += 1;
        let mut jacobian =
            DMatrix::zeros(self.problem.observations.len(), self.point.parameters.len());
        let parameters = self.point.parameters.as_slice();
        match self.problem.jacobian {
            Some(differentiate) => differentiate(parameters, &mut jacobian),
            None => central_difference::jacobian(self.problem.predict, parameters, &mut jacobian),
        }
        if let Some(sd) = self.problem.sd {
            for (mut row, sd) in jacobian.row_iter_mut().zip(sd) {
                row /= *sd;
            }
        }
        for (scale, column) in self.scale.iter_mut().zip(jacobian.column_iter()) {
            *scale = scale.max(column.norm());
        }
        let positive = self.scale.map(|s| if s > 0.0 { s } else { 1.0 });
        Linearization::new(&jacobian, &self.point.residuals, &positive)
    }

    fn trial(&mut self, step: &Step) -> Point {
        self.evaluations += 1;
        evaluate(self.problem, &self.point.parameters + &step.change)
    }

    /// Trust-region iteration until the sum of squares hardly falls.
    fn descend(&mut self, options: &CurveFitOptions) -> Termination {
        let mut radius = None;
        while self.iterations < options.max_iterations {
            let Some(linear) = self.linearize() else {
                return Termination::NoProgress;
            };
            let reach = self.scaled_norm();
            let mut current = radius.unwrap_or(if reach > 0.0 {
                INITIAL_RADIUS * reach
            } else {
                1.0
            });
            loop {
                let step = linear.step(current);
                if step.predicted_reduction <= 1e-10 * self.point.square_sum {
                    return Termination::Stationary;
                }
                // Negated, so that a step that is not a number ends the search too.
                let moves = step.scaled_length > f64::EPSILON * reach;
                if !moves {
                    return Termination::NoProgress;
                }
                let trial = self.trial(&step);
                let reduction = self.point.square_sum - trial.square_sum;
                let ratio = reduction / step.predicted_reduction;
                current = next_radius(current, step.scaled_length, ratio);
                if ratio > 1e-4 {
                    self.point = trial;
                    break;
                }
            }
            radius = Some(current);
        }
        Termination::IterationLimit
    }

    fn scaled_norm(&self) -> f64 {
        self.scale.component_mul(&self.point.parameters).norm()
    }

    /// Refines the minimum by Gauss-Newton steps. Close to it the sum of squares is constant within rounding, while the
    /// relative offset still falls.
    fn refine(&mut self) {
        const MAX_STEPS: usize = 200;
        let Some(mut linear) = self.linearize() else {
            return;
        };
        for _ in 0..MAX_STEPS {
            let offset = linear.removable_square();
            let trial = self.trial(&linear.step(f64::INFINITY));
            let no_worse = trial.square_sum <= self.point.square_sum * (1.0 + 1e-9);
            let is_done = offset <= 1e-24 * self.point.square_sum;
            if is_done || linear.rank() < self.scale.len() || !no_worse {
                return;
            }
            let before = std::mem::replace(&mut self.point, trial);
            match self.linearize() {
                Some(next) if next.removable_square() < offset => linear = next,
                _ => {
                    self.point = before;
                    return;
                }
            }
        }
    }

    fn summary(mut self, termination: Termination, options: &CurveFitOptions) -> CurveFit {
        let count = self.scale.len();
        let undetermined = || DMatrix::from_diagonal_element(count, count, f64::INFINITY);
        let linear = self.linearize();
        let (cofactor, rank, removable) = match &linear {
            Some(linear) => (linear.cofactor(), linear.rank(), linear.removable_square()),
            None => (undetermined(), 0, f64::INFINITY),
        };
        let sd = |i: usize| self.problem.sd.map_or(1.0, |sd| sd[i]);
        let residuals = self.point.residuals.iter().enumerate();
        let statistics = FitStatistics::new(
            self.point.parameters.as_slice().to_vec(),
            residuals.map(|(i, e)| e * sd(i)).collect(),
            self.point.square_sum,
            cofactor,
            rank,
        );
        let relative_offset = (removable / count as f64).sqrt() / statistics.residual_sd;
        // Where the curve fits exactly, residuals are rounding, and their ratio means nothing.
        let observed = self.problem.observations.iter().enumerate();
        let size: f64 = observed.map(|(i, y)| (y / sd(i)).powi(2)).sum();
        let is_rounding = removable <= (8.0 * f64::EPSILON).powi(2) * size;
        CurveFit {
            converged: is_rounding || relative_offset <= options.offset_tolerance,
            statistics,
            termination,
            relative_offset,
            iterations: self.iterations,
            evaluations: self.evaluations,
        }
    }
}

fn evaluate(problem: &CurveProblem, parameters: DVector<f64>) -> Point {
    let mut prediction = vec![0.0; problem.observations.len()];
    (problem.predict)(parameters.as_slice(), &mut prediction);
    let mut residuals = DVector::from_column_slice(problem.observations);
    for (i, prediction) in prediction.iter().enumerate() {
        residuals[i] = (residuals[i] - prediction) / problem.sd.map_or(1.0, |sd| sd[i]);
    }
    let square_sum = residuals.norm_squared();
    Point {
        parameters,
        residuals,
        // A point outside the domain is worse than any inside.
        square_sum: if square_sum.is_finite() {
            square_sum
        } else {
            f64::INFINITY
        },
    }
}

/// More's update of the trust region from the ratio of actual to predicted reduction.
fn next_radius(radius: f64, step_length: f64, ratio: f64) -> f64 {
    if !ratio.is_finite() {
        0.1 * radius.min(step_length)
    } else if ratio < 0.25 {
        0.25 * radius.min(step_length)
    } else if ratio > 0.75 {
        radius.max(2.0 * step_length)
    } else {
        radius
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// Decay `p0 exp(-p1 t)` at t = 0, 0.25, .. 4.75.
    const COUNT: usize = 20;
    const TRUTH: [f64; 2] = [3.0, 0.8];

    fn time(i: usize) -> f64 {
        0.25 * i as f64
    }

    fn decay(p: &[f64], values: &mut [f64]) {
        for (i, value) in values.iter_mut().enumerate() {
            *value = p[0] * (-p[1] * time(i)).exp();
        }
    }

    fn decay_jacobian(p: &[f64], jacobian: &mut DMatrix<f64>) {
        for i in 0..jacobian.nrows() {
            let factor = (-p[1] * time(i)).exp();
            jacobian[(i, 0)] = factor;
            jacobian[(i, 1)] = -p[0] * time(i) * factor;
        }
    }

    /// Noise whose standard deviation grows along the curve, and those standard deviations.
    fn observations(seed: u64) -> (Vec<f64>, Vec<f64>) {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let sd: Vec<f64> = (0..COUNT).map(|i| 0.01 * (1.0 + time(i))).collect();
        let mut values = vec![0.0; COUNT];
        decay(&TRUTH, &mut values);
        for (value, sd) in values.iter_mut().zip(&sd) {
            let noise: f64 = StandardNormal.sample(&mut random);
            *value += sd * noise;
        }
        (values, sd)
    }

    fn fit(observations: &[f64], sd: Option<&[f64]>, start: &[f64]) -> CurveFit {
        let problem = CurveProblem {
            observations,
            sd,
            predict: &decay,
            jacobian: Some(&decay_jacobian),
        };
        fit_curve(&problem, start, &CurveFitOptions::default())
    }

    #[test]
    fn numerical_and_analytic_jacobians_agree() {
        let (observations, sd) = observations(1);
        let analytic = fit(&observations, Some(&sd), &[1.0, 1.0]);
        let problem = CurveProblem {
            observations: &observations,
            sd: Some(&sd),
            predict: &decay,
            jacobian: None,
        };
        let numerical = fit_curve(&problem, &[1.0, 1.0], &CurveFitOptions::default());
        for k in 0..2 {
            let (a, n) = (&analytic.statistics, &numerical.statistics);
            assert!((a.parameters[k] - n.parameters[k]).abs() < 1e-11);
            let ratio = a.standard_deviations[k] / n.standard_deviations[k];
            assert!((ratio - 1.0).abs() < 1e-9);
        }
        assert!(analytic.converged && numerical.converged);
    }

    #[test]
    fn gradient_vanishes_at_the_minimum() {
        let (observations, sd) = observations(2);
        let result = fit(&observations, Some(&sd), &[10.0, 0.1]);
        let mut jacobian = DMatrix::zeros(COUNT, 2);
        decay_jacobian(&result.statistics.parameters, &mut jacobian);
        let residuals = result.statistics.residuals.iter().zip(&sd);
        let weighted: Vec<f64> = residuals.map(|(e, sd)| e / (sd * sd)).collect();
        let gradient = jacobian.tr_mul(&DVector::from_vec(weighted));
        assert!(gradient.amax() < 1e-9, "{gradient}");
    }

    #[test]
    fn standard_deviations_cover() {
        // 95 % of Student's t with 18 degrees of freedom; 5 sd of the binomial count of 2000 trials: false
        // failure 6e-7 per parameter (fixed seeds).
        let mut covered = [0_u32; 2];
        for seed in 0..2000 {
            let (observations, sd) = observations(seed);
            let result = fit(&observations, Some(&sd), &[1.0, 1.0]);
            assert!(result.converged);
            for k in 0..2 {
                let error = result.statistics.parameters[k] - TRUTH[k];
                let limit = 2.100_922 * result.statistics.standard_deviations[k];
                covered[k] += u32::from(error.abs() < limit);
            }
        }
        for count in covered {
            assert!((f64::from(count) - 1900.0).abs() < 5.0 * 9.75, "{count}");
        }
    }

    #[test]
    fn undetermined_parameters_are_reported() {
        // Only the product of the two parameters matters.
        let predict = |p: &[f64], values: &mut [f64]| values.fill(p[0] * p[1]);
        let problem = CurveProblem {
            observations: &[2.0, 2.1, 1.9],
            sd: None,
            predict: &predict,
            jacobian: None,
        };
        let result = fit_curve(&problem, &[1.0, 1.0], &CurveFitOptions::default());
        let statistics = &result.statistics;
        assert_eq!((statistics.rank, statistics.dof), (1, 2));
        assert_eq!(statistics.undetermined, [0, 1]);
        assert!((statistics.parameters[0] * statistics.parameters[1] - 2.0).abs() < 1e-9);
    }

    #[test]
    fn failure_is_said_in_the_summary() {
        let (observations, _) = observations(3);
        let invalid = fit(&observations, None, &[f64::NAN, 1.0]);
        assert_eq!(invalid.termination, Termination::InvalidStart);
        assert!(!invalid.converged && invalid.statistics.rank == 0);

        // Far from the minimum, two Jacobians are not enough.
        let problem = CurveProblem {
            observations: &observations,
            sd: None,
            predict: &decay,
            jacobian: None,
        };
        let options = CurveFitOptions {
            max_iterations: 2,
            ..CurveFitOptions::default()
        };
        let short = fit_curve(&problem, &[300.0, 9.0], &options);
        assert_eq!(short.termination, Termination::IterationLimit);
    }

    #[test]
    fn points_outside_the_domain_are_refused() {
        // The logarithm exists only for p > 0; a full first step from 5 would leave its domain.
        let predict = |p: &[f64], values: &mut [f64]| values.fill(p[0].ln());
        let problem = CurveProblem {
            observations: &[-2.0, -2.0],
            sd: None,
            predict: &predict,
            jacobian: None,
        };
        let result = fit_curve(&problem, &[5.0], &CurveFitOptions::default());
        assert!(result.converged);
        assert!((result.statistics.parameters[0] - (-2.0_f64).exp()).abs() < 1e-14);
    }
}
