//! Residuals of lengths by cable and by pose.

use std::collections::HashMap;

use tautline_core::estimation::ReadingKind;

use super::Residual;
use crate::app::fit::Fit;

/// Normalised residuals of the lengths of a fit.
#[derive(Debug, Default)]
pub struct Residuals {
    by_row: HashMap<usize, Vec<(usize, f64)>>,
}

impl Residuals {
    /// Those of `fit`.
    pub fn of(fit: &Fit) -> Self {
        let mut by_row: HashMap<usize, Vec<(usize, f64)>> = HashMap::new();
        for reading in &fit.analysis.readings {
            if let ReadingKind::Length(cable) = reading.kind {
                let value = reading.normalised().unwrap_or(reading.standardised);
                by_row.entry(reading.row).or_default().push((cable, value));
            }
        }
        Self { by_row }
    }

    /// That of a cable at the pose in `row`, or over all poses without.
    pub fn of_cable(&self, cable: usize, row: Option<usize>) -> Option<Residual> {
        if let Some(row) = row {
            let of_pose = self.by_row.get(&row)?;
            let found = of_pose.iter().find(|(c, _)| *c == cable);
            return found.map(|(_, value)| Residual::One(*value));
        }
        let values = self.by_row.values().flatten();
        let (count, sum) = values
            .filter(|(c, _)| *c == cable)
            .fold((0_usize, 0.0), |(n, sum), (_, v)| (n + 1, sum + v * v));
        (count > 0).then(|| Residual::Rms((sum / count as f64).sqrt(), count))
    }

    /// That of `cable` at the pose in `row`, or the largest of all cables there.
    pub fn of_pose(&self, row: usize, cable: Option<usize>) -> Option<f64> {
        let values = self.by_row.get(&row)?.iter();
        values
            .filter(|(c, _)| cable.is_none_or(|cable| cable == *c))
            .map(|(_, value)| *value)
            .max_by(|a, b| a.abs().total_cmp(&b.abs()))
    }
}
