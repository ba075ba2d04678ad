//! Questions at the terminal.

use std::io::{BufRead, stdin};

/// How often a line that is no answer is asked for again.
const TRIES: usize = 3;

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
