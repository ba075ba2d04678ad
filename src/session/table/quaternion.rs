//! Quaternions in four cells.

/// Largest deviation of a quaternion's norm from one, as files round it.
const NORM_TOLERANCE: f64 = 1e-3;

/// The faulty component of a quaternion, w first and NaN for an empty cell, and a description of the fault: it must
/// be complete or absent, and have norm one.
pub(crate) fn quaternion_fault(wxyz: &[f64; 4]) -> Option<(usize, String)> {
    let empty = wxyz.iter().position(|value| value.is_nan());
    if let Some(k) = empty {
        let partial = wxyz.iter().any(|value| !value.is_nan());
        let message = "found an empty cell, expected the whole quaternion or no cell of it";
        return partial.then(|| (k, message.into()));
    }
    let norm = wxyz.iter().map(|value| value * value).sum::<f64>().sqrt();
    let wrong = (norm - 1.0).abs() > NORM_TOLERANCE;
    wrong.then(|| {
        (
            0,
            format!("found a quaternion of norm {norm}, expected norm 1"),
        )
    })
}
