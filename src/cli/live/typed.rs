//! Questions at the terminal.

use std::io::{BufRead, IsTerminal, stdin};

use anyhow::Result;

use crate::BadInput;

/// How often a line that is no answer is asked for again.
const TRIES: usize = 3;

/// Refuses to begin where nobody can type: neither a terminal nor a file or program gives standard input.
pub fn require(what: &str) -> Result<()> {
    if stdin().is_terminal() || !gives_nothing() {
        return Ok(());
    }
    Err(BadInput::new(format!(
        "{what}, and there is no terminal to type at: start the command at one"
    )))
}

/// Whether standard input is a device, such as that for nothing; a terminal was looked for before.
#[cfg(unix)]
fn gives_nothing() -> bool {
    use std::fs::File;
    use std::os::fd::AsFd;
    use std::os::unix::fs::FileTypeExt;
    let own = stdin().as_fd().try_clone_to_owned().map(File::from);
    let metadata = own.and_then(|input| input.metadata());
    metadata.map_or(true, |metadata| metadata.file_type().is_char_device())
}

/// Elsewhere the first question tells.
#[cfg(not(unix))]
fn gives_nothing() -> bool {
    false
}

/// Asks, and reads lines from standard input until one is an answer; `None` where none comes.
pub fn answer<T>(question: &str, expected: &str, read: impl Fn(&str) -> Option<T>) -> Option<T> {
    eprintln!("{question}");
    for _ in 0..TRIES {
        let mut line = String::new();
        let length = stdin().lock().read_line(&mut line);
        if !matches!(length, Ok(1..)) {
            return None;
        }
        if let Some(answer) = read(&line) {
            return Some(answer);
        }
        eprintln!("found \"{}\", expected {expected}", line.trim());
    }
    None
}
