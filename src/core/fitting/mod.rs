//! Least-squares fits of curves and surfaces to measured points.

mod central_difference;
mod curve_fit;
mod double_double;
mod fit_statistics;
mod linear_fit;
mod pivoted_qr;
mod trust_region;

pub use curve_fit::{
    CurveFit, CurveFitOptions, CurveProblem, Differentiate, Predict, Termination, fit_curve,
};
pub use fit_statistics::FitStatistics;
pub use linear_fit::{fit_linear, fit_polynomial};
