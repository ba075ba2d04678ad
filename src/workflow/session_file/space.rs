//! Disk space reserved for the record of an operation that cannot be undone.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use tautline_session::reserve;

use super::SessionFileError;

/// Name of the file in the folder beside the session.
const NAME: &str = "space";
/// Largest growth of a session by one record (bytes).
const RECORD: u64 = 1 << 20;

/// Reserved space, which is released when this is dropped.
#[derive(Debug)]
pub struct ReservedSpace(PathBuf);

impl ReservedSpace {
    /// Reserves space for the session file and one record, as a file is written anew before the old one is replaced.
    pub(super) fn beside(session: &Path, folder: &Path) -> Result<Self, SessionFileError> {
        let kept = Self(folder.join(NAME));
        let filled = fs::metadata(session).and_then(|held| fill(&kept.0, held.len() + RECORD));
        filled
            .map(|()| kept)
            .map_err(|reason| SessionFileError::NoSpace {
                path: session.to_owned(),
                reason,
            })
    }
}

/// Writes a file of a given size.
fn fill(path: &Path, size: u64) -> io::Result<()> {
    remove_left(path)?;
    // A link in its place would lead elsewhere.
    reserve(&File::create_new(path)?, size)
}

/// Removes the file left by a killed program, if it is a plain file.
fn remove_left(path: &Path) -> io::Result<()> {
    let left = fs::symlink_metadata(path);
    match left.is_ok_and(|left| left.is_file()) {
        true => fs::remove_file(path),
        false => Ok(()),
    }
}

/// Releases the space reserved by a killed program beside a session.
pub(super) fn free_left(folder: &Path) -> io::Result<()> {
    remove_left(&folder.join(NAME))
}

impl Drop for ReservedSpace {
    fn drop(&mut self) {
        // If it cannot be removed, the next program that opens the session removes it.
        let _ = fs::remove_file(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn space_is_taken_and_given_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let session = folder.path().join("s.json");
        fs::write(&session, "{}").expect("written");
        let kept = ReservedSpace::beside(&session, folder.path()).expect("space");
        let size = fs::metadata(folder.path().join(NAME))
            .expect("a file")
            .len();
        assert_eq!(size, 2 + RECORD);
        drop(kept);
        assert!(!folder.path().join(NAME).exists());
        let gone = ReservedSpace::beside(&session, &folder.path().join("nowhere"));
        let told = gone.expect_err("no folder").to_string();
        assert!(told.contains("no space for the record"), "{told}");
    }
}
