//! Times of day and dates as cells, in seconds.

/// Seconds since 1970 of a date with a time, or since midnight of a time without a date. Month names are not read, because
/// they are in the language of the recorder's computer; neither are dates with slashes, whose order differs by country.
pub(crate) fn parse_timestamp(cell: &str) -> Option<f64> {
    let cell = cell.strip_suffix('Z').unwrap_or(cell);
    match cell.split_once(['T', ' ']) {
        Some((date, time)) => Some(days(date)? * 86_400.0 + seconds(time.trim())?),
        None => seconds(cell),
    }
}

/// Days since 1970 of `2024-05-31` or `31.05.2024`.
fn days(date: &str) -> Option<f64> {
    let part = |text: &str| -> Option<i64> {
        let is_number = (1..=4).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
        is_number.then(|| text.parse().ok()).flatten()
    };
    let parts: Vec<&str> = date.split(['-', '.']).collect();
    let [first, month, last] = parts[..] else {
        return None;
    };
    let (year, month, day) = match date.contains('-') {
        true => (part(first)?, part(month)?, part(last)?),
        false => (part(last)?, part(month)?, part(first)?),
    };
    if !(1900..=2200).contains(&year) || !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        return None;
    }
    // Days from civil: the year begins in March, so that the leap day is its last.
    let shifted = if month <= 2 { year - 1 } else { year };
    let (era, of_era) = (shifted.div_euclid(400), shifted.rem_euclid(400));
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    let days = era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468;
    Some(days as f64)
}

/// Seconds of `10:11:12.345`, `10:11:12,345`, `10:11:12:345` or `10:11`.
fn seconds(time: &str) -> Option<f64> {
    let parts: Vec<&str> = time.split(':').collect();
    let whole = |text: &str, below: f64| {
        let is_number =
            !text.is_empty() && text.len() <= 2 && text.bytes().all(|b| b.is_ascii_digit());
        let value: f64 = is_number.then(|| text.parse().ok()).flatten()?;
        (value < below).then_some(value)
    };
    let (hour, minute, second) = match parts[..] {
        [hour, minute] => (hour, minute, "0".to_owned()),
        [hour, minute, second] => (hour, minute, second.replace(',', ".")),
        [hour, minute, second, fraction] => (hour, minute, format!("{second}.{fraction}")),
        _ => return None,
    };
    let is_plain = second.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    let second: f64 = is_plain.then(|| second.parse().ok()).flatten()?;
    (second < 61.0).then_some(whole(hour, 24.0)? * 3600.0 + whole(minute, 60.0)? * 60.0 + second)
}
