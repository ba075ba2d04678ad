//! Prompts at the terminal.

use std::io::{BufRead, IsTerminal, stdin};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use anyhow::Result;

use super::interrupt;
use crate::BadInput;
use crate::output::message;

/// Number of attempts to type a valid answer.
const TRIES: usize = 3;
/// Interval of looking for an interrupt while nothing is typed.
const POLL: Duration = Duration::from_millis(50);

/// Fails if no answers can be typed: standard input is neither a terminal nor a file or pipe.
pub fn require(what: &str) -> Result<()> {
    if stdin().is_terminal() || !is_null_device() {
        return Ok(());
    }
    Err(BadInput::new(format!(
        "{what}, and standard input is not a terminal: run the command in one"
    )))
}

/// Whether standard input is a device such as `/dev/null`; a terminal has been ruled out before.
#[cfg(unix)]
fn is_null_device() -> bool {
    use std::fs::File;
    use std::os::fd::AsFd;
    use std::os::unix::fs::FileTypeExt;
    let own = stdin().as_fd().try_clone_to_owned().map(File::from);
    let metadata = own.and_then(|input| input.metadata());
    metadata.map_or(true, |metadata| metadata.file_type().is_char_device())
}

/// On other systems, the first prompt fails.
#[cfg(not(unix))]
fn is_null_device() -> bool {
    false
}

/// Parses `N` finite numbers separated by spaces, semicolons or tabs.
pub fn numbers<const N: usize>(line: &str) -> Option<[f64; N]> {
    let parts = line.split(|c: char| c.is_whitespace() || c == ';');
    let numbers = parts.filter(|part| !part.is_empty());
    let numbers: Result<Vec<f64>, _> = numbers.map(str::parse).collect();
    let numbers: [f64; N] = numbers.ok()?.try_into().ok()?;
    numbers
        .iter()
        .all(|number| number.is_finite())
        .then_some(numbers)
}

/// The next line of standard input; `None` at its end, or if the command is interrupted before.
fn line() -> Option<String> {
    let (sender, typed) = channel();
    // A system call that waits for input cannot be ended; the thread ends with the program.
    thread::spawn(move || {
        let mut line = String::new();
        let length = stdin().lock().read_line(&mut line);
        sender.send(matches!(length, Ok(1..)).then_some(line))
    });
    loop {
        match typed.recv_timeout(POLL) {
            Ok(line) => return line,
            Err(RecvTimeoutError::Timeout) if !interrupt::requested() => {}
            Err(_) => return None,
        }
    }
}

/// Asks a question and reads lines from standard input until one is valid; `None` if there is none.
pub fn answer<T>(question: &str, expected: &str, read: impl Fn(&str) -> Option<T>) -> Option<T> {
    message(question);
    for _ in 0..TRIES {
        let line = line()?;
        if let Some(answer) = read(&line) {
            return Some(answer);
        }
        message(format!("found \"{}\", expected {expected}", line.trim()));
    }
    None
}
