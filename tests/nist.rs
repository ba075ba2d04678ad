//! Least-squares fits against the certified values of the NIST Statistical Reference Datasets.
//!
//! One table serves the validation suite and the documentation.

mod data;
mod models;

use std::fmt::Write;

use anyhow::Result;
use nalgebra::DMatrix;
use tautline_core::fitting::{
    CurveFitOptions, CurveProblem, FitStatistics, fit_curve, fit_linear, fit_polynomial,
};

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

/// Solves every problem: 8 polynomial, Filip once more with its powers rounded to `f64`, 3
/// multilinear, 27 nonlinear from two starts each.
///
/// # Errors
/// If a data file cannot be read.
pub fn table() -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (name, degree) in POLYNOMIAL {
        let problem = read(name)?;
        let x: Vec<f64> = problem.x.iter().map(|x| x[0]).collect();
        let fit = fit_polynomial(&x, &problem.y, None, degree);
        rows.push(linear_row(&problem, &fit));
    }
    rows.push(filip_with_rounded_powers()?);
    for (name, has_intercept) in MULTILINEAR {
        let problem = read(name)?;
        let fit = fit_linear(&design(&problem, has_intercept), &problem.y, None);
        rows.push(linear_row(&problem, &fit));
    }
    for (name, curve) in models::NONLINEAR {
        let problem = read(name)?;
        for start in 0..problem.starts.len() {
            rows.push(nonlinear_row(&problem, curve, start));
        }
    }
    Ok(rows)
}

fn filip_with_rounded_powers() -> Result<Row> {
    let problem = read("Filip")?;
    let power = |i: usize, k: usize| problem.x[i][0].powi(k as i32);
    let design = DMatrix::from_fn(problem.y.len(), problem.parameters.len(), power);
    let fit = fit_linear(&design, &problem.y, None);
    Ok(Row {
        problem: "Filip, rounded powers".to_owned(),
        ..linear_row(&problem, &fit)
    })
}

fn design(problem: &Problem, has_intercept: bool) -> DMatrix<f64> {
    let rows = problem.x.iter().flat_map(|x| {
        let intercept = has_intercept.then_some(1.0);
        intercept.into_iter().chain(x.iter().copied())
    });
    DMatrix::from_row_iterator(problem.y.len(), problem.parameters.len(), rows)
}

fn linear_row(problem: &Problem, fit: &FitStatistics) -> Row {
    row(problem, fit, 15.0)
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
    let worst = |values: &[f64], certified: &[f64]| {
        let digits = values.iter().zip(certified);
        digits
            .map(|(value, certified)| correct_digits(*value, *certified, certified_digits))
            .fold(certified_digits, f64::min)
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
    }
}

/// `-log10` of the relative error (of the absolute error where zero is certified), at least 0 and at
/// most the number of digits that NIST certifies.
fn correct_digits(value: f64, certified: f64, certified_digits: f64) -> f64 {
    let scale = if certified == 0.0 {
        1.0
    } else {
        certified.abs()
    };
    let digits = -((value - certified).abs() / scale).log10();
    // Not finite values have no correct digit.
    if digits.is_nan() {
        return 0.0;
    }
    digits.max(0.0).min(certified_digits)
}

/// The table in Markdown.
#[must_use]
pub fn markdown(rows: &[Row]) -> String {
    let mut text = String::from(
        "| problem | level | start | digits of parameters | of their sd | of residual sd | iterations | converged |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        let start = if row.start == 0 {
            "linear".to_owned()
        } else {
            row.start.to_string()
        };
        let converged = if row.converged { "yes" } else { "no" };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} | {start} | {:.1} | {:.1} | {:.1} | {} | {converged} |",
            row.problem,
            row.level,
            row.parameter_digits,
            row.sd_digits,
            row.residual_sd_digits,
            row.iterations,
        );
    }
    text
}
