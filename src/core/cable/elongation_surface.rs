//! Measured elongation of a cable over length and tension.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Polynomial surface `elongation(length, tension)` in metres (Jin et al. 2018, equation 2).
///
/// With `x = (length - length_center) / length_scale` and `y` likewise for the tension it is
/// `sum p_ab x^a y^b` over `a + b <= degree`, ordered by total degree and then by falling `a`:
/// `p00 p10 p01 p20 p11 p02 ..`. Centre and scale are the middle and half the width of the measured
/// range, so that `|x| <= 1` and `|y| <= 1` is where the surface is valid; it is never extrapolated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ElongationSurface {
    /// Total degree, 1 to 5.
    pub degree: usize,
    /// Middle of the measured lengths (m).
    pub length_center_m: f64,
    /// Half the width of the measured lengths (m).
    pub length_scale_m: f64,
    /// Middle of the measured tensions (N).
    pub tension_center_n: f64,
    /// Half the width of the measured tensions (N).
    pub tension_scale_n: f64,
    /// Coefficients `p_ab` (m), `(degree + 1)(degree + 2)/2` of them.
    pub coefficients: Vec<f64>,
    /// Standard deviation of the residuals of the fit (m).
    pub residual_sd_m: f64,
}
