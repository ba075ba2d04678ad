//! Least-squares fits of curves and surfaces to measured points.

mod central_difference;
mod curve_fit;
mod fit_statistics;
mod linear_fit;
mod trust_region;

pub use curve_fit::{
    CurveFit, CurveFitOptions, CurveProblem, Differentiate, Predict, Termination, fit_curve,
};
pub use fit_statistics::FitStatistics;
pub use linear_fit::{fit_line, fit_linear};
