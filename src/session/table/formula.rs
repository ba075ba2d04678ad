//! Texts in cells, so that a spreadsheet takes none of them for a formula.
//!
//! A spreadsheet evaluates a cell that begins with `=`, `+`, `-` or `@`, so that the name of a cable could run a command on the
//! machine of whoever opens the table. Such a text gets an apostrophe in front, as one would type it; texts that begin so
//! already get one more, so that every text reads back as it was. Numbers stay numbers.

use std::borrow::Cow;

/// The text as it stands in a cell.
#[must_use]
pub fn escape_formula(text: &str) -> Cow<'_, str> {
    if is_formula(text.trim_start_matches('\'')) {
        format!("'{text}").into()
    } else {
        text.into()
    }
}

/// The text of a cell.
pub(crate) fn unescape_formula(cell: &str) -> &str {
    match cell.strip_prefix('\'') {
        Some(text) if is_formula(text.trim_start_matches('\'')) => text,
        _ => cell,
    }
}

/// Whether a spreadsheet evaluates it. A tab and a carriage return are skipped by some before they look.
fn is_formula(text: &str) -> bool {
    text.starts_with(['=', '+', '-', '@', '\t', '\r']) && !is_number(text)
}

/// Whether it is one number, with a point or a comma.
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
