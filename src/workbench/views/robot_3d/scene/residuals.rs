//! Residuals of lengths by cable and by pose.

use tautline_core::estimation::{Observation, ObservationKind};

use super::Residual;
use tautline_workflow::identification::Identification;

/// Normalised residuals of the lengths of a fit.
#[derive(Debug, Default)]
pub struct Residuals {
    /// Row, cable and value, in ascending order.
    lengths: Vec<(usize, usize, f64)>,
}

impl Residuals {
    pub fn of(fit: &Identification) -> Self {
        let length = |reading: &Observation| match reading.kind {
            ObservationKind::Length(cable) => {
                let value = reading.normalised().unwrap_or(reading.standardised);
                Some((reading.row, cable, value))
            }
            _ => None,
        };
        let lengths = fit.analysis.observations.iter().filter_map(length);
        let mut lengths: Vec<_> = lengths.collect();
        lengths.sort_by_key(|(row, cable, _)| (*row, *cable));
        Self { lengths }
    }

    fn of_row(&self, row: usize) -> &[(usize, usize, f64)] {
        let first = self.lengths.partition_point(|(r, _, _)| *r < row);
        let count = self.lengths[first..].partition_point(|(r, _, _)| *r == row);
        &self.lengths[first..first + count]
    }

    /// Residual of a cable at the pose in `row`; over all poses without a row.
    pub fn of_cable(&self, cable: usize, row: Option<usize>) -> Option<Residual> {
        if let Some(row) = row {
            let found = self.of_row(row).iter().find(|(_, c, _)| *c == cable);
            return found.map(|(_, _, value)| Residual::One(*value));
        }
        let (count, sum) = self
            .lengths
            .iter()
            .filter(|(_, c, _)| *c == cable)
            .fold((0_usize, 0.0), |(n, sum), (_, _, v)| (n + 1, sum + v * v));
        (count > 0).then(|| Residual::Rms((sum / count as f64).sqrt(), count))
    }

    /// Residual of `cable` at the pose in `row`, or the largest of all cables there.
    pub fn of_pose(&self, row: usize, cable: Option<usize>) -> Option<f64> {
        self.of_row(row)
            .iter()
            .filter(|(_, c, _)| cable.is_none_or(|cable| cable == *c))
            .map(|(_, _, value)| *value)
            .max_by(|a, b| a.abs().total_cmp(&b.abs()))
    }
}
