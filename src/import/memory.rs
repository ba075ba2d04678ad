//! Memory for the content of foreign files. It is not bounded by their size: a megabyte can decode to gigabytes.

use std::io::{Error, ErrorKind, Read, Result as IoResult};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes that are read at a time where the size of a content is not known before its end.
const STEP: usize = 1 << 16;
/// Bytes that a row takes besides its values until its poses are cut: its times, its range, and whether it is at rest.
const ROW: u64 = 48;
/// Bytes of a pose without its readings: its record here and in the document, and what its readings are compared with.
const POSE: u64 = 1024;
/// Bytes of a reading: with its deviation here and in the document, as a column of the checks, as text, and as a measurement.
const READING: u64 = 256;

/// Memory that an import may use; clones share it. Readers ask before they allocate.
#[derive(Debug, Clone)]
pub struct MemoryBudget {
    used: Arc<AtomicU64>,
    limit: u64,
}

/// The memory that was asked for is more than is left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OverBudget {
    /// Limit of the budget (bytes).
    pub limit: u64,
}

impl std::fmt::Display for OverBudget {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let limit = shown(self.limit);
        write!(
            f,
            "needs more than {limit} of memory when it is decoded, expected fewer values, or the command `import` with a larger --memory-limit"
        )
    }
}

impl std::error::Error for OverBudget {}

impl From<OverBudget> for Error {
    fn from(over: OverBudget) -> Self {
        Self::new(ErrorKind::OutOfMemory, over)
    }
}

fn shown(bytes: u64) -> String {
    const UNIT: f64 = 1024.0;
    match bytes as f64 / UNIT / UNIT {
        mebibytes if mebibytes < UNIT => format!("{mebibytes:.1} MiB"),
        mebibytes => format!("{:.1} GiB", mebibytes / UNIT),
    }
}

impl MemoryBudget {
    /// The default limit (bytes).
    pub const DEFAULT_LIMIT: u64 = 2 << 30;

    /// A budget of so many bytes.
    #[must_use]
    pub fn new(limit: u64) -> Self {
        Self {
            used: Arc::default(),
            limit,
        }
    }

    /// Takes bytes for as long as the budget exists.
    pub(crate) fn take(&self, bytes: u64) -> Result<(), OverBudget> {
        let fits = |used: u64| used.checked_add(bytes).filter(|used| *used <= self.limit);
        let taken = (self.used).fetch_update(Ordering::Relaxed, Ordering::Relaxed, fits);
        taken
            .map(|_| ())
            .map_err(|_| OverBudget { limit: self.limit })
    }

    /// A lease of nothing yet.
    pub(crate) fn nothing(&self) -> Lease {
        Lease {
            budget: self.clone(),
            bytes: 0,
        }
    }

    /// Takes bytes until the result is dropped.
    pub(crate) fn lease(&self, bytes: u64) -> Result<Lease, OverBudget> {
        let mut lease = self.nothing();
        lease.take(bytes)?;
        Ok(lease)
    }
}

impl Default for MemoryBudget {
    fn default() -> Self {
        Self::new(Self::DEFAULT_LIMIT)
    }
}

/// Memory that is given back when this is dropped.
#[derive(Debug)]
pub(crate) struct Lease {
    budget: MemoryBudget,
    bytes: u64,
}

impl Lease {
    /// Takes more bytes.
    pub fn take(&mut self, bytes: u64) -> Result<(), OverBudget> {
        self.budget.take(bytes)?;
        self.bytes += bytes;
        Ok(())
    }

    /// The budget that it is taken of.
    pub fn budget(&self) -> &MemoryBudget {
        &self.budget
    }

    /// A lease of the same budget, of nothing yet.
    pub fn another(&self) -> Self {
        self.budget.nothing()
    }

    /// Takes over what another lease of the same budget holds.
    pub fn absorb(&mut self, mut other: Self) {
        self.bytes += std::mem::take(&mut other.bytes);
    }

    /// Takes memory for `count` values of a type.
    pub fn take_values<T>(&mut self, count: usize) -> Result<(), OverBudget> {
        self.take((count as u64).saturating_mul(size_of::<T>() as u64))
    }

    /// Reads all bytes.
    pub fn read_to_end(&mut self, mut reader: impl Read) -> IoResult<Vec<u8>> {
        let mut bytes = Vec::new();
        loop {
            let held = bytes.capacity();
            if held - bytes.len() < STEP {
                // A vector grows to twice its size, and both are there while it is moved.
                self.take(held.max(STEP) as u64)?;
                bytes.reserve_exact(held.max(STEP));
            }
            let read = (&mut reader).take(STEP as u64).read_to_end(&mut bytes)?;
            if read < STEP {
                return Ok(bytes);
            }
        }
    }
}

impl Drop for Lease {
    fn drop(&mut self) {
        self.budget.used.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

/// Memory for poses with so many quantities until they are imported: their readings, the checks of them, and their table.
pub(crate) fn of_poses(poses: usize, quantities: usize) -> u64 {
    let of_pose = POSE.saturating_add(READING.saturating_mul(quantities as u64));
    of_pose.saturating_mul(poses as u64)
}

/// Memory for the rows of a series until its poses are cut.
pub(crate) fn of_rows(rows: usize) -> u64 {
    ROW.saturating_mul(rows as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_leased_comes_back_and_what_was_taken_does_not() {
        let budget = MemoryBudget::new(3 << 20);
        let over = OverBudget { limit: 3 << 20 };
        budget.take(1 << 20).expect("a third");
        let mut lease = budget.lease(1 << 20).expect("a third");
        assert_eq!(lease.take((1 << 20) + 1), Err(over));
        lease.take(1 << 20).expect("the rest");
        assert_eq!(budget.clone().take(1), Err(over));
        assert_eq!(budget.lease(u64::MAX).map(drop), Err(over));
        drop(lease);
        budget.take(2 << 20).expect("what was leased");
        assert!(over.to_string().starts_with("needs more than 3.0 MiB"));
    }

    #[test]
    fn endless_content_is_read_to_the_limit_only() {
        let budget = MemoryBudget::new(1 << 20);
        let mut lease = budget.lease(0).expect("nothing");
        let read = lease.read_to_end(std::io::repeat(7));
        assert_eq!(read.expect_err("no end").kind(), ErrorKind::OutOfMemory);
        drop(lease);
        let mut lease = budget.lease(0).expect("nothing");
        let whole = lease.read_to_end(std::io::repeat(7).take(300_000));
        assert_eq!(whole.expect("it fits"), vec![7; 300_000]);
        assert!(lease.bytes >= 300_000);
    }
}
