//! Parsing of numbers as written by recorders.

/// Decimal separator of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Decimal {
    /// None: a whole number.
    None,
    /// A point.
    Point,
    /// A comma.
    Comma,
}

/// Texts that recorders write for a missing reading.
const GAPS: [&str; 16] = [
    "",
    "-",
    "--",
    "---",
    "nan",
    "-nan",
    "na",
    "n/a",
    "#n/a",
    "null",
    "none",
    "nil",
    "?",
    "-nan(ind)",
    "1.#qnan",
    "-1.#ind",
];

/// Whether a cell denotes a missing reading.
pub(crate) fn is_gap(cell: &str) -> bool {
    cell.is_empty() || (cell.len() <= 9 && GAPS.contains(&cell.to_ascii_lowercase().as_str()))
}

/// A finite number and its decimal sign; `None` for anything else, numbers with thousands separators included.
pub(crate) fn parse_number(cell: &str) -> Option<(f64, Decimal)> {
    let mut decimal = Decimal::None;
    let mut digits = false;
    for byte in cell.bytes() {
        match byte {
            b'0'..=b'9' => digits = true,
            b'+' | b'-' | b'e' | b'E' => {}
            b'.' if decimal == Decimal::None => decimal = Decimal::Point,
            b',' if decimal == Decimal::None => decimal = Decimal::Comma,
            _ => return None,
        }
    }
    if !digits {
        return None;
    }
    let value: f64 = match decimal {
        Decimal::Comma => {
            let mut buffer = [0_u8; 64];
            let text = buffer.get_mut(..cell.len())?;
            text.copy_from_slice(cell.as_bytes());
            for byte in text.iter_mut().filter(|byte| **byte == b',') {
                *byte = b'.';
            }
            std::str::from_utf8(text).ok()?.parse().ok()?
        }
        Decimal::None | Decimal::Point => cell.parse().ok()?,
    };
    value.is_finite().then_some((value, decimal))
}
