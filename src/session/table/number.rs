//! Numbers in the notations of spreadsheets and scripts.

/// Parses a decimal number; an error states what was expected.
pub(super) fn parse(text: &str, decimal_comma: bool) -> Result<f64, &'static str> {
    // Any text that parses to a finite number is in plain notation; this is nearly every cell.
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => parse_unusual(text, decimal_comma),
    }
}

fn parse_unusual(text: &str, decimal_comma: bool) -> Result<f64, &'static str> {
    let number = |text: &str| text.parse::<f64>().map_err(|_| "a number");
    let plain = |byte: u8| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E');
    let value = if text.bytes().all(plain) {
        number(text)?
    } else if decimal_comma && text.bytes().all(|byte| plain(byte) || byte == b',') {
        // A point beside a comma would be a thousands separator in some country.
        if text.contains('.') {
            return Err("a number without thousands separators");
        }
        number(&text.replacen(',', ".", 1))?
    } else if text.contains(',') && text.replacen(',', ".", 1).parse::<f64>().is_ok() {
        return Err("a number with a decimal point (decimal commas need ; as the separator)");
    } else {
        return Err("a number");
    };
    if value.is_finite() {
        Ok(value)
    } else {
        Err("a number below 1.8e308")
    }
}
