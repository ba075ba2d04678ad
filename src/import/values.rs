//! Values of a channel: in memory or, for long recordings, in a temporary file read block by block.
//!
//! A log of a gigabyte has as much as a gigabyte of numbers. Those of all channels of a source that do not fit into
//! [`HELD`] go to one file without a name, which the system deletes with the program; each channel keeps one block of it.

use std::fs::File;
use std::io::{Read, Result, Seek, SeekFrom, Write};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use tautline_session::temporary_file;

use crate::source::Channel;

/// Maximum number of values that the channels of one source hold in memory (32 MB).
const HELD: usize = 4 << 20;
/// Values of a block (64 kB).
const BLOCK: usize = 8 << 10;

/// The values of a channel; NaN for missing ones. Clones share the file.
#[derive(Clone, Default)]
pub struct Values {
    stored: Option<Stored>,
    /// Values not in the file: all of them, or less than a block.
    held: Vec<f64>,
}

/// Number and values of a block.
type Block = (usize, Arc<[f64]>);

/// Complete blocks in a file.
#[derive(Clone)]
struct Stored {
    file: Arc<BlockFile>,
    /// Offset of each block (bytes).
    places: Arc<Vec<u64>>,
    /// The block read last.
    last: Arc<Mutex<Option<Block>>>,
}

struct BlockFile {
    file: Mutex<File>,
    /// Whether a block could not be read.
    failed: AtomicBool,
}

impl BlockFile {
    fn create() -> Result<Self> {
        Ok(Self {
            file: Mutex::new(temporary_file()?),
            failed: AtomicBool::new(false),
        })
    }

    fn append(&self, values: &[f64]) -> Result<u64> {
        let bytes: Vec<u8> = values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let place = file.seek(SeekFrom::End(0))?;
        file.write_all(&bytes)?;
        Ok(place)
    }

    fn read(&self, place: u64) -> Result<Vec<f64>> {
        let mut bytes = vec![0; 8 * BLOCK];
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start(place))?;
        file.read_exact(&mut bytes)?;
        let (values, _) = bytes.as_chunks::<8>();
        Ok(values
            .iter()
            .map(|bytes| f64::from_le_bytes(*bytes))
            .collect())
    }
}

impl Stored {
    /// A block; NaN if the file cannot be read, which [`Values::is_intact`] reports.
    fn block(&self, number: usize) -> Arc<[f64]> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((known, values)) = &*last
            && *known == number
        {
            return Arc::clone(values);
        }
        let values = self.file.read(self.places[number]).unwrap_or_else(|_| {
            self.file.failed.store(true, Ordering::Relaxed);
            vec![f64::NAN; BLOCK]
        });
        let values: Arc<[f64]> = values.into();
        *last = Some((number, Arc::clone(&values)));
        values
    }

    fn len(&self) -> usize {
        self.places.len() * BLOCK
    }
}

impl Values {
    /// Number of values.
    #[must_use]
    pub fn len(&self) -> usize {
        self.stored.as_ref().map_or(0, Stored::len) + self.held.len()
    }

    /// Memory that they take (bytes), with the block of the file that is held.
    pub(crate) fn memory(&self) -> usize {
        let stored = |stored: &Stored| size_of_val(&stored.places[..]) + 8 * BLOCK;
        size_of_val(&self.held[..]) + self.stored.as_ref().map_or(0, stored)
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value of a row, if there is such a row.
    #[must_use]
    pub fn get(&self, row: usize) -> Option<f64> {
        match &self.stored {
            Some(stored) if row < stored.len() => Some(stored.block(row / BLOCK)[row % BLOCK]),
            Some(stored) => self.held.get(row - stored.len()).copied(),
            None => self.held.get(row).copied(),
        }
    }

    /// The value of a row; NaN where there is no such row.
    #[must_use]
    pub fn at(&self, row: usize) -> f64 {
        self.get(row).unwrap_or(f64::NAN)
    }

    /// All values.
    pub fn iter(&self) -> impl Iterator<Item = f64> + '_ {
        self.range(0..self.len())
    }

    /// The values of a range of rows, clipped to the existing ones.
    pub fn range(&self, rows: Range<usize>) -> impl Iterator<Item = f64> + '_ {
        let stored = self.stored.as_ref().map_or(0, Stored::len);
        let in_file = rows.start.min(stored)..rows.end.min(stored);
        let held = rows.start.max(stored) - stored..rows.end.clamp(stored, self.len()) - stored;
        let blocks = in_file.start / BLOCK..in_file.end.div_ceil(BLOCK);
        let of_block = move |number: usize| {
            let from = in_file.start.max(number * BLOCK) - number * BLOCK;
            let to = in_file.end.min((number + 1) * BLOCK) - number * BLOCK;
            let block = self.stored.as_ref().map(|stored| stored.block(number));
            (from..to).map(move |k| block.as_ref().map_or(f64::NAN, |block| block[k]))
        };
        let held = self.held.get(held).unwrap_or_default().iter().copied();
        blocks.flat_map(of_block).chain(held)
    }

    /// Whether all requested values could be read.
    #[must_use]
    pub fn is_intact(&self) -> bool {
        let failed = |stored: &Stored| stored.file.failed.load(Ordering::Relaxed);
        !self.stored.as_ref().is_some_and(failed)
    }
}

impl From<Vec<f64>> for Values {
    fn from(held: Vec<f64>) -> Self {
        Self { stored: None, held }
    }
}

impl FromIterator<f64> for Values {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        Vec::from_iter(values).into()
    }
}

impl PartialEq for Values {
    fn eq(&self, other: &Self) -> bool {
        self.len() == other.len() && self.iter().eq(other.iter())
    }
}

impl std::fmt::Debug for Values {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.iter().take(BLOCK)).finish()
    }
}

/// Fills the channels of one source.
#[derive(Default)]
pub(crate) struct Storage {
    file: Option<Arc<BlockFile>>,
    /// Values in memory.
    held: usize,
}

/// A channel that is being filled.
#[derive(Default)]
pub(crate) struct Filling {
    values: Vec<f64>,
    places: Vec<u64>,
}

impl Storage {
    /// Adds a value to a channel.
    ///
    /// # Errors
    /// If the temporary file cannot be written.
    pub fn push(&mut self, channel: &mut Filling, value: f64) -> Result<()> {
        channel.values.push(value);
        self.held += 1;
        if self.held > HELD && channel.values.len() >= BLOCK {
            self.store(channel)?;
        }
        Ok(())
    }

    /// Moves the complete blocks of a channel to the file.
    fn store(&mut self, channel: &mut Filling) -> Result<()> {
        let file = match &mut self.file {
            Some(file) => file,
            None => self.file.insert(Arc::new(BlockFile::create()?)),
        };
        let whole = channel.values.len() / BLOCK * BLOCK;
        for block in channel.values[..whole].chunks_exact(BLOCK) {
            channel.places.push(file.append(block)?);
        }
        channel.values = channel.values.split_off(whole);
        self.held -= whole;
        Ok(())
    }

    /// The values of a completed channel.
    pub fn finish(&self, channel: Filling) -> Values {
        let file = self.file.as_ref().filter(|_| !channel.places.is_empty());
        Values {
            stored: file.map(|file| Stored {
                file: Arc::clone(file),
                places: Arc::new(channel.places),
                last: Arc::default(),
            }),
            held: channel.values,
        }
    }
}

/// Numeric channels that are filled row by row.
pub(crate) struct Table {
    storage: Storage,
    columns: Vec<Filling>,
}

impl Table {
    pub fn new(columns: usize) -> Self {
        Self {
            storage: Storage::default(),
            columns: (0..columns).map(|_| Filling::default()).collect(),
        }
    }

    /// Adds a row.
    ///
    /// # Errors
    /// If the temporary file cannot be written.
    pub fn push(&mut self, row: &[f64]) -> Result<()> {
        for (column, value) in self.columns.iter_mut().zip(row) {
            self.storage.push(column, *value)?;
        }
        Ok(())
    }

    /// Gives the channels their values.
    pub fn finish(self, channels: &mut [Channel]) {
        for (channel, column) in channels.iter_mut().zip(self.columns) {
            channel.values = self.storage.finish(column);
        }
    }
}

impl Filling {
    /// Number of its values.
    pub fn len(&self) -> usize {
        self.places.len() * BLOCK + self.values.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two channels of which one has gaps, long enough that both are in the file but for their ends.
    #[test]
    fn values_in_a_file_are_those_that_were_pushed() {
        let mut storage = Storage::default();
        let mut channels = [Filling::default(), Filling::default()];
        let rows = HELD / 2 + 3 * BLOCK + 7;
        let value = |row: usize, k: usize| match (row % 1000, k) {
            (0, 1) => f64::NAN,
            _ => (row as f64).sqrt() + k as f64,
        };
        for row in 0..rows {
            for (k, channel) in channels.iter_mut().enumerate() {
                storage.push(channel, value(row, k)).unwrap();
            }
        }
        assert!(storage.held < HELD && channels.iter().all(|one| one.len() == rows));
        let channels = channels.map(|channel| storage.finish(channel));
        let same = |a: f64, b: f64| a == b || a.is_nan() && b.is_nan();
        for (k, values) in channels.iter().enumerate() {
            assert_eq!(values.len(), rows);
            assert!(
                values
                    .iter()
                    .enumerate()
                    .all(|(row, found)| same(found, value(row, k)))
            );
            for rows in [
                BLOCK - 2..BLOCK + 3,
                5..6,
                rows - 9..rows,
                rows - 2 * BLOCK..rows + 5,
                3..3,
            ] {
                let found: Vec<f64> = values.range(rows.clone()).collect();
                let expected: Vec<f64> = rows
                    .filter(|row| *row < values.len())
                    .map(|row| value(row, k))
                    .collect();
                assert_eq!(found.len(), expected.len());
                assert!(found.iter().zip(&expected).all(|(a, b)| same(*a, *b)));
            }
            assert!(same(values.at(BLOCK), value(BLOCK, k)) && values.get(rows).is_none());
            assert!(values.is_intact());
        }
        assert!(channels.iter().any(|values| values.stored.is_some()));
        assert_eq!(channels[0], channels[0].clone());
        assert_ne!(channels[0], channels[1]);
    }
}
