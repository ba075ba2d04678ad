//! The mean of the samples at a pose.

use tautline_core::geometry::Pose;
use tautline_core::measurement::{Grid, Measurements};

use crate::controller::Sample;

/// The mean readings at a pose, as one row; quantities that were not read have no column.
pub(super) fn mean_readings(label: i64, commanded: Pose, samples: &[Sample]) -> Measurements {
    let mean = |get: &dyn Fn(&Sample) -> Option<f64>| mean_and_sd(samples, get).0;
    let column = |get: &dyn Fn(&Sample) -> Option<f64>| -> Vec<f64> {
        let read = Some(mean(get)).filter(|mean| mean.is_finite());
        read.into_iter().collect()
    };
    let row = |get: fn(&Sample) -> &[f64]| {
        let count = samples.iter().map(|s| get(s).len()).max();
        let cables = 0..count.unwrap_or(0);
        Grid::of_row(cables.map(|k| mean(&|s| get(s).get(k).copied())).collect())
    };
    let inclined = samples.iter().any(|s| s.inclination_rad.is_some());
    let angle = |k: usize| mean(&|s| s.inclination_rad.map(|angles| angles[k]));
    Measurements {
        labels: vec![label],
        time_s: column(&|s| Some(s.time_s)),
        temperature_c: column(&|s| s.temperature_c),
        commanded: vec![Some(commanded)],
        revolutions: row(|s| &s.revolutions),
        force_n: row(|s| &s.force_n),
        laser_m: column(&|s| s.laser_m),
        swivel_rad: row(|s| s.swivel_rad.as_deref().unwrap_or_default()),
        inclination_rad: inclined
            .then(|| std::array::from_fn(angle))
            .into_iter()
            .collect(),
        ..Measurements::default()
    }
}

/// Mean and standard deviation of the readings present; NaN without readings, the deviation also with a single one.
pub(super) fn mean_and_sd(samples: &[Sample], get: &dyn Fn(&Sample) -> Option<f64>) -> (f64, f64) {
    let values = samples.iter().filter_map(get);
    let values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    let n = values.len() as f64;
    // Relative to the first value, so that bit-identical readings have exactly their value as mean and no deviation.
    let first = values.first().copied().unwrap_or(f64::NAN);
    let mean = first + values.iter().map(|v| v - first).sum::<f64>() / n;
    let square: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    let sd = if n > 1.0 {
        (square / (n - 1.0)).sqrt()
    } else {
        f64::NAN
    };
    (mean, sd)
}
