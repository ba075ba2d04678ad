//! Values of a channel.

use std::ops::Range;
use std::sync::Arc;

use crate::source::Channel;

/// The values of a channel; NaN for missing ones. Clones share them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Values(Arc<[f64]>);

impl Values {
    /// Number of values.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether the list has no values.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The value of a row, if there is such a row.
    #[must_use]
    pub fn get(&self, row: usize) -> Option<f64> {
        self.0.get(row).copied()
    }

    /// The value of a row; NaN where there is no such row.
    #[must_use]
    pub fn at(&self, row: usize) -> f64 {
        self.get(row).unwrap_or(f64::NAN)
    }

    /// All values.
    pub fn iter(&self) -> impl Iterator<Item = f64> + '_ {
        self.0.iter().copied()
    }

    /// The values of a range of rows, clipped to the existing ones.
    pub fn range(&self, rows: Range<usize>) -> impl Iterator<Item = f64> + '_ {
        let end = rows.end.min(self.len());
        self.0[rows.start.min(end)..end].iter().copied()
    }
}

impl From<Vec<f64>> for Values {
    fn from(values: Vec<f64>) -> Self {
        Self(values.into())
    }
}

impl FromIterator<f64> for Values {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        Self(values.into_iter().collect())
    }
}

/// Gives channels their values.
pub(crate) fn fill(channels: &mut [Channel], columns: Vec<Vec<f64>>) {
    for (channel, column) in channels.iter_mut().zip(columns) {
        channel.values = column.into();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_that_were_pushed() {
        let rows = 30_007;
        let columns = vec![
            (0..rows).map(|row| row as f64).collect(),
            vec![f64::NAN; rows],
        ];
        let mut channels = [Channel::default(), Channel::default()];
        fill(&mut channels, columns);
        let [numbers, gaps] = channels.map(|channel| channel.values);
        assert!(numbers.iter().eq((0..rows).map(|row| row as f64)));
        assert!(gaps.iter().all(f64::is_nan) && gaps.len() == rows);
        assert!(numbers.range(5..7).eq([5.0, 6.0]));
        assert_eq!(numbers.range(rows - 2..rows + 5).count(), 2);
        assert_eq!(numbers.range(rows + 1..rows + 5).count(), 0);
        assert!(numbers.get(rows).is_none() && numbers.at(rows).is_nan());
    }
}
