//! Least-squares fits against the certified values of the NIST Statistical Reference Datasets.
//!
//! One table serves the validation suite and the documentation.

mod data;
mod models;

use anyhow::Result;
use nalgebra::{DMatrix, DVector};
use tautline_core::fitting::{CurveFitOptions, CurveProblem, FitStatistics, fit_curve, fit_linear};

use super::markdown::table;
pub use data::{Problem, read};

/// Agreement of one fit with NIST's certified values.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Name of the dataset.
    pub problem: String,
    /// Level of difficulty in NIST's words.
    pub level: String,
    /// Which of NIST's starting values, 1 or 2; 0 for a linear problem.
    pub start: usize,
    /// Correct digits of the worst parameter.
    pub parameter_digits: f64,
    /// Correct digits of the worst standard deviation of a parameter.
    pub sd_digits: f64,
    /// Correct digits of the residual standard deviation.
    pub residual_sd_digits: f64,
    /// Jacobians used; 0 for a linear problem.
    pub iterations: usize,
    /// Whether the fit says that it converged.
    pub converged: bool,
    /// Condition numbers of a linear problem: `k` of its scaled columns, and `(k + k^2 |r| / |A p|) |p| / |p_k|` of the worst
    /// parameter `p_k`, with the residuals `r`, the predictions `A p` and the parameters `p` of the scaled columns (Bjorck,
    /// Numerical Methods for Least Squares Problems, section 1.4); 1 for a nonlinear problem.
    pub conditions: [f64; 2],
}

/// Linear problems whose model is a polynomial, with its degree.
const POLYNOMIAL: [(&str, usize); 8] = [
    ("Norris", 1),
    ("Pontius", 2),
    ("Filip", 10),
    ("Wampler1", 5),
    ("Wampler2", 5),
    ("Wampler3", 5),
    ("Wampler4", 5),
    ("Wampler5", 5),
];

/// Linear problems with other columns: name and whether there is an intercept.
const MULTILINEAR: [(&str, bool); 3] = [("NoInt1", false), ("NoInt2", false), ("Longley", true)];

/// Solves every problem: 8 polynomial, 3 multilinear, 27 nonlinear from two starts each.
///
/// # Errors
/// If a data file cannot be read.
pub fn study() -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (name, degree) in POLYNOMIAL {
        let problem = read(name)?;
        let power = |row: usize, k: usize| problem.x[row][0].powi(k as i32);
        let powers = DMatrix::from_fn(problem.y.len(), degree + 1, power);
        rows.push(linear_row(&problem, &powers));
    }
    for (name, has_intercept) in MULTILINEAR {
        let problem = read(name)?;
        rows.push(linear_row(&problem, &design(&problem, has_intercept)));
    }
    for (name, curve) in models::NONLINEAR {
        let problem = read(name)?;
        for start in 0..problem.starts.len() {
            rows.push(nonlinear_row(&problem, curve, start));
        }
    }
    Ok(rows)
}

fn design(problem: &Problem, has_intercept: bool) -> DMatrix<f64> {
    let rows = problem.x.iter().flat_map(|x| {
        let intercept = has_intercept.then_some(1.0);
        intercept.into_iter().chain(x.iter().copied())
    });
    DMatrix::from_row_iterator(problem.y.len(), problem.parameters.len(), rows)
}

fn linear_row(problem: &Problem, design: &DMatrix<f64>) -> Row {
    let mut scaled = design.clone();
    let norms: Vec<f64> = scaled.column_iter().map(|c| c.norm()).collect();
    for (mut column, norm) in scaled.column_iter_mut().zip(&norms) {
        column /= *norm;
    }
    let singular_values = scaled.singular_values();
    let of_columns = singular_values.max() / singular_values.min();
    let fit = fit_linear(design, &problem.y, None);
    let residuals = DVector::from_column_slice(&fit.residuals);
    let predicted = DVector::from_column_slice(&problem.y) - &residuals;
    let parameters = fit.parameters.iter().zip(&norms).map(|(p, norm)| p * norm);
    let parameters = DVector::from_iterator(norms.len(), parameters);
    let of_worst =
        of_columns * (1.0 + of_columns * residuals.norm() / predicted.norm()) * parameters.norm()
            / parameters.abs().min();
    Row {
        conditions: [of_columns, of_worst],
        ..row(problem, &fit, 15.0)
    }
}

fn nonlinear_row(problem: &Problem, curve: models::Curve, start: usize) -> Row {
    // NIST states Nelson's model for the logarithm of the response.
    let log = |y: &f64| if problem.name == "Nelson" { y.ln() } else { *y };
    let observations: Vec<f64> = problem.y.iter().map(log).collect();
    let predict = |b: &[f64], y: &mut [f64]| {
        for (y, x) in y.iter_mut().zip(&problem.x) {
            *y = curve(x, b);
        }
    };
    let curve_problem = CurveProblem {
        observations: &observations,
        sd: None,
        predict: &predict,
        jacobian: None,
    };
    let fit = fit_curve(
        &curve_problem,
        &problem.starts[start],
        &CurveFitOptions::default(),
    );
    Row {
        start: start + 1,
        iterations: fit.iterations,
        converged: fit.converged,
        ..row(problem, &fit.statistics, 11.0)
    }
}

fn row(problem: &Problem, fit: &FitStatistics, certified_digits: f64) -> Row {
    let largest = problem.y.iter().fold(0.0, |a: f64, y| a.max(y.abs()));
    let worst = |values: &[f64], certified: &[f64]| {
        let digits = values.iter().zip(certified).map(|(value, certified)| {
            // Where the data are exact, standard deviations of zero are certified, and rounding is relative to the data.
            let scale = match certified {
                0.0 => largest,
                _ => certified.abs(),
            };
            correct_digits((value - certified) / scale, certified_digits)
        });
        digits.fold(certified_digits, f64::min)
    };
    Row {
        problem: problem.name.clone(),
        level: problem.level.clone(),
        start: 0,
        parameter_digits: worst(&fit.parameters, &problem.parameters),
        sd_digits: worst(&fit.standard_deviations, &problem.standard_deviations),
        residual_sd_digits: worst(&[fit.residual_sd], &[problem.residual_sd]),
        iterations: 0,
        converged: fit.is_full_rank(),
        conditions: [1.0; 2],
    }
}

/// `-log10` of a relative error, at least 0 and at most the number of digits that NIST certifies.
fn correct_digits(relative_error: f64, certified_digits: f64) -> f64 {
    let digits = -relative_error.abs().log10();
    // Not finite values have no correct digit.
    if digits.is_nan() {
        return 0.0;
    }
    digits.clamp(0.0, certified_digits)
}

/// The table in Markdown.
#[must_use]
pub fn markdown(rows: &[Row]) -> String {
    let rows = rows.iter().map(|row| {
        let start = match row.start {
            0 => "linear".to_owned(),
            start => start.to_string(),
        };
        format!(
            "{} | {} | {start} | {:.1} | {:.1} | {:.1} | {} | {}",
            row.problem,
            row.level,
            row.parameter_digits,
            row.sd_digits,
            row.residual_sd_digits,
            row.iterations,
            if row.converged { "yes" } else { "no" },
        )
    });
    table(
        "problem | level | start | digits of parameters | of their sd | of residual sd | iterations | converged",
        rows,
    )
}
