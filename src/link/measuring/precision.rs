//! Criterion for ending a run.

use tautline_core::estimation::{ParameterId, Solution};

/// The largest standard deviation of a coordinate of an entry point (m) that results from the readings so far: a run may end
/// once it is small enough.
///
/// It assumes the described noise of the readings, whether or not the model explains them. `None`
/// while the readings leave a coordinate undetermined, and if no entry point is identified.
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
