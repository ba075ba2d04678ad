//! Values of a channel, in memory; while they are read they take their memory of a budget.

use std::io::Result;
use std::ops::Range;
use std::sync::Arc;

use crate::memory::{Lease, MemoryBudget};
use crate::source::Channel;

/// Number of values for which memory is taken at a time.
const STEP: usize = 8 << 10;
/// Bytes of a value while a channel is filled: a vector has room for up to twice as many.
const FILLING: u64 = 2 * size_of::<f64>() as u64;

/// The values of a channel; NaN for missing ones. Clones share them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Values(Arc<[f64]>);

impl Values {
    /// Number of values.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Memory that they take (bytes).
    pub(crate) fn memory(&self) -> usize {
        size_of_val(&*self.0)
    }

    /// Whether there are none.
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

/// Takes the memory of the channels of one source while they are filled.
pub(crate) struct Storage {
    memory: Lease,
    /// Values for which memory was taken and that are not there yet.
    room: usize,
}

/// A channel that is being filled.
#[derive(Default)]
pub(crate) struct Filling(Vec<f64>);

impl Storage {
    /// Takes memory of a budget.
    pub fn within(budget: &MemoryBudget) -> Self {
        Self {
            memory: budget.nothing(),
            room: 0,
        }
    }

    /// Adds a value to a channel.
    ///
    /// # Errors
    /// If it needs more memory than there is.
    pub fn push(&mut self, channel: &mut Filling, value: f64) -> Result<()> {
        if self.room == 0 {
            self.memory.take(FILLING * STEP as u64)?;
            self.room = STEP;
        }
        self.room -= 1;
        channel.0.push(value);
        Ok(())
    }
}

impl Filling {
    /// Number of its values.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The values of a completed channel.
    pub fn finish(self) -> Values {
        self.0.into()
    }
}

/// Numeric channels that are filled row by row.
pub(crate) struct Table {
    storage: Storage,
    columns: Vec<Filling>,
}

impl Table {
    pub fn new(columns: usize, budget: &MemoryBudget) -> Self {
        Self {
            storage: Storage::within(budget),
            columns: (0..columns).map(|_| Filling::default()).collect(),
        }
    }

    /// Adds a row.
    ///
    /// # Errors
    /// If it needs more memory than there is.
    pub fn push(&mut self, row: &[f64]) -> Result<()> {
        for (column, value) in self.columns.iter_mut().zip(row) {
            self.storage.push(column, *value)?;
        }
        Ok(())
    }

    /// Gives the channels their values.
    pub fn finish(self, channels: &mut [Channel]) {
        for (channel, column) in channels.iter_mut().zip(self.columns) {
            channel.values = column.finish();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_that_were_pushed() {
        let mut table = Table::new(2, &MemoryBudget::default());
        let rows = 3 * STEP + 7;
        for row in 0..rows {
            table.push(&[row as f64, f64::NAN]).expect("memory");
        }
        let mut channels = [Channel::default(), Channel::default()];
        table.finish(&mut channels);
        let [numbers, gaps] = channels.map(|channel| channel.values);
        assert!(numbers.iter().eq((0..rows).map(|row| row as f64)));
        assert!(gaps.iter().all(f64::is_nan) && gaps.len() == rows);
        assert!(numbers.range(5..7).eq([5.0, 6.0]));
        assert_eq!(numbers.range(rows - 2..rows + 5).count(), 2);
        assert_eq!(numbers.range(rows + 1..rows + 5).count(), 0);
        assert!(numbers.get(rows).is_none() && numbers.at(rows).is_nan());
    }

    #[test]
    fn memory_is_asked_for_and_given_back() {
        let budget = MemoryBudget::new(FILLING * 2 * STEP as u64);
        let mut table = Table::new(1, &budget);
        let fitting = (0..4 * STEP).take_while(|_| table.push(&[1.0]).is_ok());
        assert_eq!(fitting.count(), 2 * STEP);
        drop(table);
        assert!(budget.take(FILLING * 2 * STEP as u64).is_ok());
    }
}
