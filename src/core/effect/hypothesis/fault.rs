//! Mistakes in a hypothesis, with their place.

/// A mistake at an offset in a text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    pub at: usize,
    pub message: String,
}

impl Fault {
    pub fn new(at: usize, message: impl Into<String>) -> Self {
        Self {
            at,
            message: message.into(),
        }
    }

    /// The error of a file with this text.
    pub fn in_text(&self, text: &str) -> HypothesisError {
        let (line, column) = line_and_column(text, self.at);
        HypothesisError {
            line,
            column,
            message: self.message.clone(),
        }
    }
}

/// A mistake in a hypothesis file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {message}")]
pub struct HypothesisError {
    /// Line, counted from 1.
    pub line: u64,
    /// Column in characters, counted from 1.
    pub column: u64,
    /// What was found and what was expected, in one sentence.
    pub message: String,
}

/// Line and column, counted from 1, of an offset in bytes.
#[must_use]
pub fn line_and_column(text: &str, at: usize) -> (u64, u64) {
    let before = text.get(..at).unwrap_or(text);
    let line = 1 + before.matches('\n').count() as u64;
    let begin = before.rfind('\n').map_or(0, |end| end + 1);
    let column = 1 + before[begin..].chars().count() as u64;
    (line, column)
}

/// `, such as "NAME"` with the most similar of some names, if one is similar.
pub(super) fn nearest<'n>(name: &str, of: impl Iterator<Item = &'n str>) -> String {
    let scored = of.map(|known| (strsim::jaro_winkler(name, known), known));
    let best = scored.max_by(|a, b| a.0.total_cmp(&b.0));
    match best.filter(|(similarity, _)| *similarity > 0.8) {
        Some((_, known)) => format!(", such as \"{known}\""),
        None => String::new(),
    }
}
