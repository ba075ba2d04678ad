//! Input files with progress, cancellation and a limit of memory.

use std::cell::Cell;
use std::fs::File;
use std::io::{Error, Read, Result, Seek, SeekFrom};

use crate::memory::MemoryBudget;

/// Interval between progress callbacks (bytes).
const STEP: u64 = 1 << 20;

/// Progress of reading, its cancellation and its memory budget.
pub struct Watch<'a> {
    /// Total size of all files (bytes).
    whole: u64,
    /// Bytes read.
    read: Cell<u64>,
    /// Position of the next callback (bytes).
    next: Cell<u64>,
    /// Whether reading was cancelled.
    stopped: Cell<bool>,
    /// Receives the fraction done and returns whether to continue.
    goes_on: &'a dyn Fn(f64) -> bool,
    budget: &'a MemoryBudget,
}

impl<'a> Watch<'a> {
    /// Calls `goes_on` with the fraction done while `whole` bytes are read.
    pub fn new(whole: u64, goes_on: &'a dyn Fn(f64) -> bool, budget: &'a MemoryBudget) -> Self {
        Self {
            whole,
            read: Cell::new(0),
            next: Cell::new(0),
            stopped: Cell::new(false),
            goes_on,
            budget,
        }
    }

    /// The memory for what is read.
    pub fn budget(&self) -> &'a MemoryBudget {
        self.budget
    }

    /// Whether reading was cancelled.
    pub fn is_stopped(&self) -> bool {
        self.stopped.get()
    }

    /// Counts bytes read; fails once reading was cancelled.
    fn count(&self, bytes: u64) -> Result<()> {
        let read = self.read.get() + bytes;
        self.read.set(read);
        if read < self.next.get() {
            return Ok(());
        }
        self.next.set(read + STEP);
        let part = read as f64 / self.whole.max(1) as f64;
        if (self.goes_on)(part.min(1.0)) {
            return Ok(());
        }
        self.stopped.set(true);
        Err(Error::other("reading was stopped"))
    }
}

/// A file whose reading is tracked.
pub(crate) struct Input<'a> {
    file: File,
    watch: &'a Watch<'a>,
    budget: &'a MemoryBudget,
}

impl<'a> Input<'a> {
    pub fn new(file: File, watch: &'a Watch<'a>, budget: &'a MemoryBudget) -> Self {
        Self {
            file,
            watch,
            budget,
        }
    }

    /// The file, for a reader that seeks in it and reports what it reads by [`Self::advance`].
    pub fn file(&self) -> Result<File> {
        self.file.try_clone()
    }

    /// The memory for what the file decodes to.
    pub fn budget(&self) -> &'a MemoryBudget {
        self.budget
    }

    /// Counts bytes that were read by other means.
    pub fn advance(&mut self, bytes: u64) -> Result<()> {
        self.watch.count(bytes)
    }
}

impl Read for Input<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let read = self.file.read(buffer)?;
        self.watch.count(read as u64)?;
        Ok(read)
    }
}

impl Seek for Input<'_> {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        self.file.seek(to)
    }
}
