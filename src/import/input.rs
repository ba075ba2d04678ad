//! A file that is read, with how far reading is.

use std::cell::Cell;
use std::fs::File;
use std::io::{Error, Read, Result, Seek, SeekFrom};

/// Bytes after which the reader is asked whether to go on.
const STEP: u64 = 1 << 20;

/// Follows how far reading is, and may end it.
pub(crate) struct Watch<'a> {
    /// Bytes of all files.
    whole: u64,
    /// Bytes that were read.
    read: Cell<u64>,
    /// Bytes at which it is asked next.
    next: Cell<u64>,
    /// Whether reading was ended.
    stopped: Cell<bool>,
    /// Takes the part that is done, and says whether to go on.
    goes_on: &'a dyn Fn(f64) -> bool,
}

impl<'a> Watch<'a> {
    /// Asks `goes_on` from time to time while `whole` bytes are read, with the part that was.
    pub fn new(whole: u64, goes_on: &'a dyn Fn(f64) -> bool) -> Self {
        Self {
            whole,
            read: Cell::new(0),
            next: Cell::new(0),
            stopped: Cell::new(false),
            goes_on,
        }
    }

    /// Whether reading was ended.
    pub fn is_stopped(&self) -> bool {
        self.stopped.get()
    }

    /// Counts bytes; fails where reading is to end.
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

/// A file that is watched.
pub(crate) struct Input<'a> {
    file: File,
    watch: &'a Watch<'a>,
}

impl<'a> Input<'a> {
    pub fn new(file: File, watch: &'a Watch<'a>) -> Self {
        Self { file, watch }
    }

    /// The file, for a reader that goes to and fro in it and tells by [`Self::advance`] what it has read.
    pub fn file(&self) -> Result<File> {
        self.file.try_clone()
    }

    /// Counts bytes that were read otherwise.
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
