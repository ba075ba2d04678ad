//! Atomic writing: files are written completely or not at all.

use std::fs;
use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use tempfile::NamedTempFile;

use crate::error::WriteError;

/// Prefix of temporary files.
const PREFIX: &str = ".tautline-";
/// Number of random letters and digits after the prefix.
const LETTERS: usize = 6;
/// Age from which a temporary file belongs to a killed program, as no write takes that long.
const STALE: Duration = Duration::from_secs(24 * 60 * 60);
/// Block of zeros for reserving space.
static BLOCK: [u8; 1 << 16] = [0; 1 << 16];

/// Writes a temporary file in the same folder and renames it: a reader sees either the old content or the new, also
/// after a power failure.
pub(crate) fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), WriteError> {
    replace(path, fill).map_err(|source| WriteError::io(path, source))
}

/// Writes a text file atomically.
///
/// # Errors
/// If the file cannot be written.
pub fn write_text(path: &Path, text: &str) -> Result<(), WriteError> {
    write_bytes(path, text.as_bytes())
}

/// Writes a file of any kind atomically.
///
/// # Errors
/// If the file cannot be written.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_atomically(path, |out| out.write_all(bytes))
}

/// Creates a file that only its owner can read, completely or not at all; the folder is created if
/// necessary.
///
/// # Errors
/// If there is such a file or it cannot be written.
pub(crate) fn create_private(path: &Path, content: &[u8]) -> Result<(), WriteError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let create = || {
        fs::create_dir_all(folder)?;
        // Temporary files are readable by their owner only.
        let mut file = tempfile::Builder::new()
            .prefix(PREFIX)
            .tempfile_in(folder)?;
        file.write_all(content)?;
        file.as_file().sync_all()?;
        file.persist_noclobber(path).map_err(|error| error.error)
    };
    create()
        .map(drop)
        .map_err(|error| WriteError::io(path, error))
}

fn replace(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> std::io::Result<()> {
    Output::open(&link_target(path))?.replace(&link_target(path), fill)
}

/// A text file that is opened, with space reserved on the disk, before its content is known, so that a computation or motion
/// that cannot be repeated starts only if its result can be written.
#[derive(Debug)]
pub struct ReservedFile {
    path: PathBuf,
    target: PathBuf,
    output: Output,
}

impl ReservedFile {
    /// Opens a file for a text of at most `bytes` bytes. An existing file keeps its content until the text is written.
    ///
    /// # Errors
    /// If the file cannot be written or there is not enough space.
    pub fn create(path: &Path, bytes: u64) -> Result<Self, WriteError> {
        let target = link_target(path);
        let create = || {
            let output = Output::open(&target)?;
            if let Output::File(file) = &output {
                reserve(file.as_file(), bytes)?;
            }
            Ok(output)
        };
        let output = create().map_err(|error| WriteError::io(path, error))?;
        Ok(Self {
            path: path.to_owned(),
            target,
            output,
        })
    }

    /// Writes the text atomically.
    ///
    /// # Errors
    /// If the file cannot be written, which for a device shows only now.
    pub fn write_text(self, text: &str) -> Result<(), WriteError> {
        let written = self
            .output
            .replace(&self.target, |out| out.write_all(text.as_bytes()));
        written.map_err(|error| WriteError::io(&self.path, error))
    }
}

/// Takes `bytes` bytes of the disk at the beginning of a file; a sparse file would take none.
///
/// # Errors
/// If there is not enough space.
pub fn reserve(mut file: &fs::File, bytes: u64) -> std::io::Result<()> {
    let mut left = bytes;
    while left > 0 {
        let part = usize::try_from(left).unwrap_or(usize::MAX).min(BLOCK.len());
        file.write_all(&BLOCK[..part])?;
        left -= part as u64;
    }
    file.sync_all()?;
    file.rewind()
}

/// Destination of the content of a file.
#[derive(Debug)]
enum Output {
    /// A device or a pipe is written to directly; renaming a file over it would replace it.
    Device(fs::File),
    /// A temporary file in the same folder.
    File(NamedTempFile<fs::File>),
}

impl Output {
    fn open(target: &Path) -> std::io::Result<Self> {
        if fs::metadata(target).is_ok_and(|found| !found.is_file() && !found.is_dir()) {
            let device = fs::File::options().write(true).open(target)?;
            return Ok(Self::Device(device));
        }
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX).rand_bytes(LETTERS);
        let mut options = fs::File::options();
        options.write(true).create_new(true);
        // A temporary file is private by default, but this one becomes an ordinary file.
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, mode(target));
        // Opened and written as a file of its own: errors of tempfile name the temporary file, which means nothing to the
        // operator.
        let file = builder.make_in(folder_of(target), |temporary| options.open(temporary))?;
        Ok(Self::File(file))
    }

    fn replace(
        self,
        target: &Path,
        fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> std::io::Result<()> {
        let file = match self {
            Self::Device(device) => {
                let mut out = BufWriter::new(device);
                fill(&mut out)?;
                return out.flush();
            }
            Self::File(file) => file,
        };
        let mut writer = BufWriter::new(file.as_file());
        fill(&mut writer)?;
        writer.flush()?;
        let length = writer.stream_position()?;
        drop(writer);
        // Reserved space is given back.
        file.as_file().set_len(length)?;
        file.as_file().sync_all()?;
        file.persist(target).map_err(|error| error.error)?;
        let folder = folder_of(target);
        sync_folder(folder)?;
        remove_stale(folder);
        Ok(())
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Largest number of links that are followed, the limit of operating systems.
const MAX_LINKS: usize = 40;

/// The target if `path` is a link, else `path` itself: writing through a link must not replace the link by a file.
#[must_use]
pub fn link_target(path: &Path) -> PathBuf {
    let mut target = path.to_owned();
    for _ in 0..MAX_LINKS {
        let Ok(next) = fs::read_link(&target) else {
            break;
        };
        // A relative target is relative to the folder of its link.
        target = target.parent().unwrap_or(Path::new("")).join(next);
    }
    target
}

/// Removes temporary files of programs that were killed while writing. Failures are ignored, because nothing depends
/// on it.
fn remove_stale(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        if name.to_str().is_some_and(is_temporary) && is_stale(&entry) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether a name has the form of the names of temporary files.
pub(crate) fn is_temporary(name: &str) -> bool {
    let letters = name.strip_prefix(PREFIX);
    letters.is_some_and(|l| l.len() == LETTERS && l.bytes().all(|b| b.is_ascii_alphanumeric()))
}

/// Whether an entry is a file, not a link, that is too old to be still written.
fn is_stale(entry: &fs::DirEntry) -> bool {
    let metadata = entry.metadata().ok().filter(fs::Metadata::is_file);
    let modified = metadata.and_then(|metadata| metadata.modified().ok());
    // A time in the future, after the clock was set back, is not stale.
    modified.is_some_and(|when| when.elapsed().is_ok_and(|age| age > STALE))
}

/// Waits until the directory entries of a folder are on disk, where the operating system supports it.
pub(crate) fn sync_folder(folder: &Path) -> std::io::Result<()> {
    #[cfg(unix)]
    fs::File::open(folder)?.sync_all()?;
    #[cfg(not(unix))]
    let _ = folder;
    Ok(())
}

/// Permissions of the file to be replaced, else those of any new file.
#[cfg(unix)]
fn mode(path: &Path) -> u32 {
    use std::os::unix::fs::PermissionsExt;
    fs::metadata(path).map_or(0o666, |metadata| metadata.permissions().mode())
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;

    #[cfg(unix)]
    #[test]
    fn a_file_written_through_links_stays_one_file() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path("real")).expect("a folder");
        write_text(&path("real/file"), "old").expect("written");
        symlink("real/file", path("one")).expect("a link");
        symlink(path("one"), path("two")).expect("a link");
        write_text(&path("two"), "new").expect("written");
        assert_eq!(fs::read_to_string(path("real/file")).expect("read"), "new");
        assert!(path("one").is_symlink() && path("two").is_symlink());
        assert_eq!(link_target(&path("two")), path("real/file"));
        symlink("round", path("round")).expect("a link");
        assert_eq!(link_target(&path("round")), path("round"));
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_written_to_and_stays_one() {
        use std::os::unix::fs::FileTypeExt;
        let folder = tempfile::tempdir().expect("a folder");
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.expect("mkfifo").success());
        let source = pipe.clone();
        let reader = std::thread::spawn(move || fs::read_to_string(source));
        write_text(&pipe, "text").expect("written");
        assert_eq!(reader.join().expect("a thread").expect("read"), "text");
        let kind = fs::symlink_metadata(&pipe).expect("there").file_type();
        assert!(kind.is_fifo());
    }

    #[test]
    fn a_reserved_file_appears_when_it_is_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("result.json");
        let taken = || -> u64 {
            let entries = fs::read_dir(folder.path()).expect("readable").flatten();
            entries.map(|e| e.metadata().expect("a file").len()).sum()
        };
        let reserved = ReservedFile::create(&path, 100_000).expect("space");
        assert_eq!((taken(), path.exists()), (100_000, false));
        reserved.write_text("text").expect("written");
        assert_eq!(fs::read_to_string(&path).expect("read"), "text");
        assert_eq!(taken(), 4);
        // A file that is not written leaves nothing behind, and keeps the old content.
        drop(ReservedFile::create(&path, 100_000).expect("space"));
        assert_eq!((taken(), fs::read(&path).expect("read").len()), (4, 4));
        let nowhere = folder.path().join("nowhere/result.json");
        assert!(ReservedFile::create(&nowhere, 1).is_err());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_is_an_error() {
        let full = ReservedFile::create(Path::new("/dev/full"), 9).expect("open");
        let told = full.write_text("text").expect_err("full").to_string();
        assert!(told.starts_with("/dev/full: cannot be written"), "{told}");
    }

    #[test]
    fn an_error_names_the_file_and_not_its_temporary_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("nowhere/table.csv");
        let error = write_text(&path, "text").expect_err("no such folder");
        let text = error.to_string();
        assert!(text.starts_with(&path.display().to_string()), "{text}");
        assert!(!text.contains(PREFIX), "{text}");
    }

    #[test]
    fn only_old_temporary_files_are_removed() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        let old = SystemTime::now() - STALE - Duration::from_secs(60);
        for (name, when) in [
            (".tautline-aB3dE9", old),
            (".tautline-aB3dE8", SystemTime::now()),
            (".tautline-notes.txt", old),
            (".tautline-aB3dE9x", old),
            ("notes", old),
        ] {
            let file = fs::File::create(path(name)).expect("a file");
            file.set_modified(when).expect("a time");
        }
        fs::create_dir(path(".tautline-folder")).expect("a folder");
        write_text(&path("written"), "text").expect("written");
        let entries = fs::read_dir(folder.path()).expect("readable").flatten();
        let mut names: Vec<String> = entries
            .map(|entry| entry.file_name().into_string().expect("a name"))
            .collect();
        names.sort();
        let expected = [
            ".tautline-aB3dE8",
            ".tautline-aB3dE9x",
            ".tautline-folder",
            ".tautline-notes.txt",
            "notes",
            "written",
        ];
        assert_eq!(names, expected);
    }
}
