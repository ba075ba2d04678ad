//! Space on the disk that is kept for what has to be recorded after something that cannot be undone.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::SessionFileError;

/// Name of the file in the folder beside the session.
const NAME: &str = "space";
/// By how much a session grows at most by one record (bytes).
const RECORD: u64 = 1 << 20;
/// Zeros that are written at once.
static BLOCK: [u8; 1 << 16] = [0; 1 << 16];

/// Space that is kept; it is free again when this is dropped.
#[derive(Debug)]
pub struct KeptSpace(PathBuf);

impl KeptSpace {
    /// As much as the session file and one record take, because a file is written anew before the old one is replaced.
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

/// Writes a file of a size; a hole in it would take no space.
fn fill(path: &Path, size: u64) -> io::Result<()> {
    let mut file = File::create(path)?;
    let mut left = size;
    while left > 0 {
        let part = usize::try_from(left).unwrap_or(usize::MAX).min(BLOCK.len());
        file.write_all(&BLOCK[..part])?;
        left -= part as u64;
    }
    file.sync_all()
}

impl Drop for KeptSpace {
    fn drop(&mut self) {
        // If it cannot be removed, the next program that opens the session does it.
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
        let kept = KeptSpace::beside(&session, folder.path()).expect("space");
        let size = fs::metadata(folder.path().join(NAME))
            .expect("a file")
            .len();
        assert_eq!(size, 2 + RECORD);
        drop(kept);
        assert!(!folder.path().join(NAME).exists());
        let gone = KeptSpace::beside(&session, &folder.path().join("nowhere"));
        let told = gone.expect_err("no folder").to_string();
        assert!(told.contains("no space for the record"), "{told}");
    }
}
