//! Escaping of texts in cells, so that a spreadsheet does not evaluate them as formulas.
//!
//! A spreadsheet evaluates a cell that starts with `=`, `+`, `-` or `@`, so the name of a cable could run a command on the
//! machine of whoever opens the table. Such a text is prefixed with an apostrophe, as one would type it; texts that already
//! start with one get another, so that every text reads back unchanged. Numbers stay numbers.

use std::borrow::Cow;

/// The text in the form written to a cell.
#[must_use]
pub fn escape_formula(text: &str) -> Cow<'_, str> {
    if is_formula(text.trim_start_matches('\'')) {
        format!("'{text}").into()
    } else {
        text.into()
    }
}

/// The text that a cell represents.
pub(crate) fn unescape_formula(cell: &str) -> &str {
    match cell.strip_prefix('\'') {
        Some(text) if is_formula(text.trim_start_matches('\'')) => text,
        _ => cell,
    }
}

/// Whether a spreadsheet evaluates the text as a formula. Some skip a leading tab or carriage return first.
fn is_formula(text: &str) -> bool {
    text.starts_with(['=', '+', '-', '@', '\t', '\r']) && !is_number(text)
}

/// Whether the text is a single number, with a point or a comma.
fn is_number(text: &str) -> bool {
    let plain = |byte: u8| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b',' | b'e' | b'E');
    text.bytes().all(plain) && text.replacen(',', ".", 1).parse::<f64>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_escaped_and_numbers_are_not() {
        for formula in [
            "=1+1",
            "=cmd|' /C calc'!A0",
            "+1+2",
            "-2+3",
            "@SUM(A1)",
            "\t=1",
            "\r=1",
            "-",
            "+-1",
            "-1.2.3",
        ] {
            assert_eq!(escape_formula(formula), format!("'{formula}"));
        }
        for plain in [
            "-1.5", "+2", "-1,5", "-1e-7", "cable-1", "a=b", "'quoted'", "", "1 - 2",
        ] {
            assert_eq!(escape_formula(plain), plain);
        }
    }

    #[test]
    fn every_text_reads_back_as_it_was() {
        for text in [
            "=1", "'=1", "''=1", "'-1.5", "-1.5", "'", "''", "'a", "@x", "'@x", "", "-", "'-",
        ] {
            assert_eq!(unescape_formula(&escape_formula(text)), text, "{text:?}");
        }
    }
}
