//! Texts in PEM.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Number of characters of a line.
const LINE: usize = 64;
/// Label of a certificate.
pub(crate) const CERTIFICATE: &str = "CERTIFICATE";
/// Label of a private key (PKCS #8).
pub(crate) const PRIVATE_KEY: &str = "PRIVATE KEY";

fn marks(label: &str) -> [String; 2] {
    ["BEGIN", "END"].map(|word| format!("-----{word} {label}-----"))
}

/// The first part of a text with a label, with its marks.
pub(crate) fn section<'t>(text: &'t str, label: &str) -> Option<&'t str> {
    let [begin, end] = marks(label);
    let at = text.find(&begin)?;
    let length = text[at..].find(&end)? + end.len();
    text.get(at..at + length)
}

/// The content of a section.
pub(crate) fn decoded(section: &str) -> Option<Vec<u8>> {
    let lines = section.lines().map(str::trim);
    let lines = lines.filter(|line| !line.starts_with("-----"));
    STANDARD.decode(lines.collect::<String>()).ok()
}

/// A section with a content.
pub(crate) fn encoded(label: &str, bytes: &[u8]) -> String {
    let [begin, end] = marks(label);
    let text = STANDARD.encode(bytes);
    let mut lines = vec![begin.as_str()];
    let mut rest = text.as_str();
    while !rest.is_empty() {
        let (line, left) = rest.split_at(LINE.min(rest.len()));
        lines.push(line);
        rest = left;
    }
    lines.push(&end);
    lines.join("\n") + "\n"
}
