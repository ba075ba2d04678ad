//! Text of files and controllers, which can contain any character, for terminals and reports.

use std::borrow::Cow;

/// Text with its control characters made visible: an escape sequence could rewrite a terminal, and a mark of direction the
/// line that follows it. Line ends and tabs stay.
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.contains(is_obeyed) {
        return text.into();
    }
    let mut shown = String::with_capacity(text.len());
    for letter in text.chars() {
        match is_obeyed(letter) {
            true => shown.extend(letter.escape_unicode()),
            false => shown.push(letter),
        }
    }
    shown.into()
}

/// Whether a terminal may interpret a character instead of showing it, including marks that change the direction of
/// writing.
#[must_use]
pub fn is_obeyed(letter: char) -> bool {
    let turns = matches!(letter, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || letter.is_control() && !matches!(letter, '\n' | '\t')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown_and_not_obeyed() {
        let name = "PLC\u{1b}]0;owned\u{7}\u{1b}[2J\r\u{9b}1m\u{202e}";
        let shown = printable(name);
        assert_eq!(
            shown,
            r"PLC\u{1b}]0;owned\u{7}\u{1b}[2J\u{d}\u{9b}1m\u{202e}"
        );
        assert_eq!(printable("a\tb\nµ ± 1"), "a\tb\nµ ± 1");
    }
}
