//! Interpretation of channel names.

mod names;
pub(crate) mod words;

pub use names::pattern_of;
pub(crate) use names::{Family, families, words as words_of};

/// Whether a column name denotes pose labels.
pub(crate) fn is_label(name: &str) -> bool {
    words_of(name)
        .iter()
        .any(|word| words::LABEL.contains(&word.as_str()))
}
