//! When enough is measured.

use tautline_core::estimation::{ParameterId, Solution};

/// The largest standard deviation of a coordinate of an entry point (m) that the readings so far lead to: a run may end
/// where it is small enough.
///
/// It is that of the readings' noise as described; whether the model explains the readings is another question. `None`
/// while the readings leave a coordinate open, and where no entry point is identified.
#[must_use]
pub fn largest_sd_m(solution: &Solution) -> Option<f64> {
    let parameters = solution.parameters.iter().enumerate();
    let points = parameters.filter(|(_, p)| matches!(p.id, ParameterId::EntryPoint { .. }));
    points
        .map(|(index, _)| solution.standard_deviation(index))
        .reduce(|a, b| Some(a?.max(b?)))
        .flatten()
        .filter(|sd_m| sd_m.is_finite())
}
