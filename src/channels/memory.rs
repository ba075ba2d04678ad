//! Limit of memory for the content of foreign files, which is not bounded by their size: a megabyte can decode to gigabytes.

use std::io::{Error, ErrorKind, Read, Result as IoResult};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Memory that an import may use for decoded content; clones share it. Content that a file stores byte by byte is not counted.
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

    /// A budget of `limit` bytes.
    #[must_use]
    pub fn new(limit: u64) -> Self {
        Self {
            used: Arc::default(),
            limit,
        }
    }

    /// A budget of the remaining bytes, for content that is dropped again.
    pub fn temporary(&self) -> Self {
        Self {
            used: Arc::new(self.used.load(Ordering::Relaxed).into()),
            limit: self.limit,
        }
    }

    /// Counts bytes before they are allocated.
    pub fn take(&self, bytes: u64) -> Result<(), OverBudget> {
        let fits = |used: u64| used.checked_add(bytes).filter(|used| *used <= self.limit);
        let taken = (self.used).fetch_update(Ordering::Relaxed, Ordering::Relaxed, fits);
        taken
            .map(|_| ())
            .map_err(|_| OverBudget { limit: self.limit })
    }

    /// Counts values of channels before they are allocated.
    pub(crate) fn take_values(&self, count: usize) -> Result<(), OverBudget> {
        self.take((size_of::<f64>() as u64).saturating_mul(count as u64))
    }

    /// Reads all bytes of decoded content. Twice as many count, since a vector that grows has room for them.
    pub(crate) fn read_to_end(&self, reader: impl Read) -> IoResult<Vec<u8>> {
        let left = self.limit - self.used.load(Ordering::Relaxed);
        let mut bytes = Vec::new();
        reader.take(left / 2 + 1).read_to_end(&mut bytes)?;
        self.take(2 * bytes.len() as u64)?;
        Ok(bytes)
    }
}

impl Default for MemoryBudget {
    fn default() -> Self {
        Self::new(Self::DEFAULT_LIMIT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_share_what_was_taken_and_temporary_budgets_do_not() {
        let budget = MemoryBudget::new(3 << 20);
        let over = OverBudget { limit: 3 << 20 };
        budget.take(1 << 20).expect("a third");
        let temporary = budget.temporary();
        assert_eq!(temporary.take((2 << 20) + 1), Err(over));
        temporary.take(2 << 20).expect("the rest");
        assert_eq!(temporary.clone().take(1), Err(over));
        assert_eq!(budget.take(u64::MAX), Err(over));
        assert_eq!(budget.take_values(usize::MAX), Err(over));
        budget.clone().take(2 << 20).expect("the rest");
        assert_eq!(budget.take(1), Err(over));
        assert!(over.to_string().starts_with("needs more than 3.0 MiB"));
    }

    #[test]
    fn endless_content_is_read_to_the_limit_only() {
        let budget = MemoryBudget::new(1 << 20);
        let read = budget.read_to_end(std::io::repeat(7));
        assert_eq!(read.expect_err("no end").kind(), ErrorKind::OutOfMemory);
        let whole = budget.read_to_end(std::io::repeat(7).take(300_000));
        assert_eq!(whole.expect("it fits"), vec![7; 300_000]);
        let more = budget.read_to_end(std::io::repeat(7).take(300_000));
        assert_eq!(more.expect_err("too much").kind(), ErrorKind::OutOfMemory);
    }
}
