//! Output of results: to a file, written atomically, or to standard output.

use std::borrow::Cow;
use std::io::{ErrorKind, IsTerminal, Write, stdout};
use std::marker::PhantomData;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Result, anyhow};
use serde::Serialize;
use tautline_core::robot::Robot;
use tautline_session::{ReservedFile, VersionedFile, write_bytes, write_robot};
use tautline_workflow::wording::{is_obeyed, printable};

use crate::replace::{OutputFile, permit};

/// First error of writing to standard output.
static FAILURE: OnceLock<std::io::Error> = OnceLock::new();
/// Whether notices, progress and confirmations are left out.
static QUIET: AtomicBool = AtomicBool::new(false);
/// Whether standard output is reserved for a document, which other text would spoil.
static HAS_DOCUMENT: AtomicBool = AtomicBool::new(false);

/// Leaves out notices, progress and confirmations from now on.
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Whether notices, progress and confirmations are left out.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Keeps standard output free for a document.
pub fn expect_document() {
    HAS_DOCUMENT.store(true, Ordering::Relaxed);
}

/// Whether a file name is `-`, which stands for standard input or output.
pub fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
}

/// Prints a line on standard output, unless that is for a document. An error, such as a full disk, is reported by [`check`].
pub fn line(text: &str) {
    if !HAS_DOCUMENT.load(Ordering::Relaxed) {
        print(&printable(text));
    }
}

fn print(text: &str) {
    note_failure(writeln!(stdout(), "{text}"));
}

/// Notes an error of writing to standard output for [`check`]. A reader that stops reading (`tautline ... | head`) is not an
/// error.
pub fn note_failure(written: std::io::Result<()>) {
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
    {
        // Only the first error has a cause.
        let _ = FAILURE.set(error);
    }
}

/// Checks that everything has arrived on standard output.
pub fn check() -> Result<()> {
    note_failure(stdout().flush());
    match FAILURE.get() {
        None => Ok(()),
        Some(error) => Err(anyhow!("standard output: cannot be written ({error})")),
    }
}

/// Prints a line on standard error, even if the command is quiet: an error, a question.
pub fn message(text: impl AsRef<str>) {
    let _ = writeln!(std::io::stderr(), "{}", printable(text.as_ref()));
}

/// Prints a line on standard error, unless the command is to be quiet.
pub fn notice(text: impl AsRef<str>) {
    if !is_quiet() {
        message(text);
    }
}

/// `println!` through [`line()`].
macro_rules! say {
    ($($text:tt)*) => {
        $crate::output::line(&format!($($text)*))
    };
}
pub(crate) use say;

/// [`say!`] for what has been written, unless the command is to be quiet.
macro_rules! confirm {
    ($($text:tt)*) => {
        if !$crate::output::is_quiet() {
            $crate::output::line(&format!($($text)*));
        }
    };
}
pub(crate) use confirm;

/// `eprintln!` through [`notice()`].
macro_rules! note {
    ($($text:tt)*) => {
        $crate::output::notice(format!($($text)*))
    };
}
pub(crate) use note;

/// `--json`, for a document of one or two formats.
#[derive(Debug, clap::Args)]
pub struct JsonOutput<D: VersionedFile, E: VersionedFile = D> {
    /// Write the results as JSON, over those of an earlier run; - is standard output
    #[arg(
        id = "json",
        long,
        value_name = "FILE",
        value_parser = OutputFile::parser(vec![D::FORMAT, E::FORMAT])
    )]
    file: Option<OutputFile>,
    #[arg(skip)]
    documents: PhantomData<(D, E)>,
}

impl<D: VersionedFile, E: VersionedFile> JsonOutput<D, E> {
    /// Whether standard output gets human-readable text rather than JSON.
    pub fn is_text(&self) -> bool {
        !self.file.as_deref().is_some_and(is_standard)
    }

    /// Writes a document as JSON if requested, and prints the human-readable form.
    pub fn deliver<F: VersionedFile>(&self, document: &F, print: impl FnOnce()) -> Result<()> {
        self.open(0)?.deliver(document, print)
    }

    /// Opens the requested file, with space for the document and a result of at most [`RESULT`] bytes, before an action that
    /// cannot be repeated.
    pub fn reserve(&self, document: &D) -> Result<ReservedOutput> {
        let text = pretty(&tautline_session::versioned(document))?;
        self.open(text.len() as u64 + RESULT)
    }

    fn open(&self, bytes: u64) -> Result<ReservedOutput> {
        let path = self.file.as_deref().filter(|_| self.is_text());
        let file = match path {
            Some(path) => {
                permit(path, &[D::FORMAT, E::FORMAT])?;
                Some(ReservedFile::create(path, bytes)?)
            }
            None => None,
        };
        Ok(ReservedOutput {
            file,
            is_text: self.is_text(),
        })
    }
}

/// Largest growth of a document by its result (bytes).
const RESULT: u64 = 1 << 20;

/// Output whose space on the disk is reserved.
#[derive(Debug)]
pub struct ReservedOutput {
    /// `None` if no file was requested.
    file: Option<ReservedFile>,
    is_text: bool,
}

impl ReservedOutput {
    /// As [`JsonOutput::deliver`].
    pub fn deliver<D: VersionedFile>(self, document: &D, print: impl FnOnce()) -> Result<()> {
        let document = tautline_session::versioned(document);
        if let Some(file) = self.file {
            file.write_text(&pretty(&document)?)?;
        }
        match self.is_text {
            true => print(),
            false => write_json(Path::new("-"), &document)?,
        }
        check()
    }
}

fn pretty<T: Serialize>(value: &T) -> Result<String> {
    let mut text = serde_json::to_string_pretty(value)?;
    text.push('\n');
    Ok(text)
}

/// Writes `value` as JSON to `target`; `-` is standard output.
pub fn write_json<T: Serialize>(target: &Path, value: &T) -> Result<()> {
    let text = pretty(value)?;
    if is_standard(target) {
        print(&json_printable(text.trim_end()));
        return check();
    }
    write_file(target, text.as_bytes())
}

/// Writes a model file; `-` is standard output.
pub fn write_model(target: &Path, robot: &Robot) -> Result<()> {
    match is_standard(target) {
        true => write_json(target, &tautline_session::versioned(robot)),
        false => {
            permit(target, &[])?;
            Ok(write_robot(target, robot)?)
        }
    }
}

/// Writes a file of any kind; `-` is standard output, where a terminal gets no control characters.
pub fn write_file(target: &Path, bytes: &[u8]) -> Result<()> {
    if !is_standard(target) {
        permit(target, &[])?;
        return Ok(write_bytes(target, bytes)?);
    }
    note_failure(match stdout().is_terminal() {
        true => stdout().write_all(printable(&String::from_utf8_lossy(bytes)).as_bytes()),
        false => stdout().write_all(bytes),
    });
    check()
}

/// Equivalent JSON with escapes for the characters that a terminal would interpret; all of them are in strings.
fn json_printable(text: &str) -> Cow<'_, str> {
    if !text.contains(is_obeyed) {
        return text.into();
    }
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match is_obeyed(letter) {
            true => safe.push_str(&format!("\\u{:04x}", u32::from(letter))),
            false => safe.push(letter),
        }
    }
    safe.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_on_a_terminal_means_the_same() {
        let name = "PLC\u{1b}[2J\u{7f}\u{9b}1m";
        let text = serde_json::to_string(name).expect("text");
        let shown = json_printable(&text);
        assert!(!shown.contains(is_obeyed), "{shown}");
        let read: String = serde_json::from_str(&shown).expect("JSON");
        assert_eq!(read, name);
    }
}
