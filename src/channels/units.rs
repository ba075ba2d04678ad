//! Units and their usual spellings.

use std::f64::consts::{PI, TAU};

/// Standard acceleration of free fall (m/s^2), by which masses stand for forces (ISO 80000-4).
const STANDARD_GRAVITY_M_S2: f64 = 9.806_65;

/// Dimension of a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Lengths; in metres.
    Length,
    /// Angles; in radians.
    Angle,
    /// Forces; in newtons.
    Force,
    /// Temperatures; in degrees Celsius.
    Temperature,
    /// Times; in seconds.
    Time,
    /// Numbers without a unit.
    Number,
}

/// A unit: `value in the base unit = factor value + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Dimension.
    pub dimension: Dimension,
    /// Base units per unit.
    pub factor: f64,
    /// Its zero point in the base unit.
    pub offset: f64,
}

/// Spellings, in lower case where case does not matter, and what they mean.
const UNITS: &[(&[&str], Dimension, f64)] = &[
    (
        &["m", "meter", "meters", "metre", "metres"],
        Dimension::Length,
        1.0,
    ),
    (&["dm"], Dimension::Length, 0.1),
    (
        &[
            "cm",
            "centimeter",
            "centimeters",
            "centimetre",
            "centimetres",
        ],
        Dimension::Length,
        0.01,
    ),
    (
        &[
            "mm",
            "millimeter",
            "millimeters",
            "millimetre",
            "millimetres",
        ],
        Dimension::Length,
        1e-3,
    ),
    (
        &[
            "µm",
            "μm",
            "um",
            "micrometer",
            "micrometers",
            "micron",
            "microns",
        ],
        Dimension::Length,
        1e-6,
    ),
    (&["in", "inch", "inches"], Dimension::Length, 0.0254),
    (&["ft", "foot", "feet"], Dimension::Length, 0.3048),
    (&["rad", "radian", "radians"], Dimension::Angle, 1.0),
    (&["mrad"], Dimension::Angle, 1e-3),
    (
        &["deg", "degs", "degree", "degrees", "°", "grad"],
        Dimension::Angle,
        PI / 180.0,
    ),
    (
        &[
            "rev",
            "revs",
            "revolution",
            "revolutions",
            "turn",
            "turns",
            "umdr",
            "u",
        ],
        Dimension::Angle,
        TAU,
    ),
    (&["n", "newton", "newtons"], Dimension::Force, 1.0),
    (&["kn"], Dimension::Force, 1e3),
    (&["mn"], Dimension::Force, 1e-3),
    (
        &["kg", "kgf", "kp"],
        Dimension::Force,
        STANDARD_GRAVITY_M_S2,
    ),
    (&["g"], Dimension::Force, STANDARD_GRAVITY_M_S2 * 1e-3),
    (
        &["lbf", "lb", "lbs"],
        Dimension::Force,
        STANDARD_GRAVITY_M_S2 * 0.453_592_37,
    ),
    (
        &["s", "sec", "secs", "second", "seconds"],
        Dimension::Time,
        1.0,
    ),
    (
        &["ms", "msec", "millisecond", "milliseconds"],
        Dimension::Time,
        1e-3,
    ),
    (
        &["µs", "μs", "us", "usec", "microsecond", "microseconds"],
        Dimension::Time,
        1e-6,
    ),
    (&["100ns"], Dimension::Time, 1e-7),
    (
        &["ns", "nsec", "nanosecond", "nanoseconds"],
        Dimension::Time,
        1e-9,
    ),
    (&["min", "minute", "minutes"], Dimension::Time, 60.0),
    (&["h", "hour", "hours"], Dimension::Time, 3600.0),
    (&["d", "day", "days"], Dimension::Time, 86_400.0),
    (&["°c", "degc", "c", "celsius"], Dimension::Temperature, 1.0),
    (
        &[
            "inc",
            "incs",
            "increments",
            "count",
            "counts",
            "cnt",
            "tick",
            "ticks",
            "1",
            "-",
        ],
        Dimension::Number,
        1.0,
    ),
];

/// Parses the name of a unit, or a part of one: `rev/4096` is the count of an encoder with 4096 of them per revolution.
#[must_use]
pub fn parse_unit(text: &str) -> Option<Unit> {
    let text = text.trim();
    if let Some((whole, parts)) = text.split_once('/') {
        let parts = parts.trim().parse().ok();
        let parts = parts.filter(|parts: &f64| *parts > 0.0 && parts.is_finite())?;
        let whole = parse_unit(whole).filter(|unit| unit.dimension != Dimension::Temperature)?;
        return Some(Unit {
            factor: whole.factor / parts,
            ..whole
        });
    }
    // The only spelling whose case matters: it could mean meganewton or millinewton, so it is rejected.
    if text == "MN" {
        return None;
    }
    match text {
        "K" | "kelvin" => {
            return Some(Unit {
                dimension: Dimension::Temperature,
                factor: 1.0,
                offset: -273.15,
            });
        }
        "°F" | "degF" => {
            let factor = 5.0 / 9.0;
            return Some(Unit {
                dimension: Dimension::Temperature,
                factor,
                offset: -32.0 * factor,
            });
        }
        _ => {}
    }
    let lower = text.to_lowercase();
    let found = UNITS
        .iter()
        .find(|(names, ..)| names.contains(&lower.as_str()));
    found.map(|(_, dimension, factor)| Unit {
        dimension: *dimension,
        factor: *factor,
        offset: 0.0,
    })
}

/// Splits the heading of a column into name and unit: `Pos [mm]`, `Pos (mm)`, `Pos / mm`, `Pos in mm`. For `pos_mm` the name
/// keeps its suffix.
#[must_use]
pub fn split_heading(heading: &str) -> (String, Option<String>) {
    let heading = heading.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(inner) = heading.strip_suffix(close)
            && let Some((name, unit)) = inner.rsplit_once(open)
            && !is_index(unit)
            && (open == '[' || parse_unit(unit).is_some())
            && !name.trim().is_empty()
        {
            return (name.trim().into(), Some(unit.trim().into()));
        }
    }
    for between in [" / ", " in ", "/"] {
        if let Some((name, unit)) = heading.rsplit_once(between)
            && parse_unit(unit).is_some()
            && !name.trim().is_empty()
        {
            return (name.trim().into(), Some(unit.trim().into()));
        }
    }
    // An index may follow: `angle_rad[2]`, `angle_rad_2`, `angle_rad(:,2)`.
    let is_of_index = |letter: char| {
        letter.is_ascii_digit() || matches!(letter, '[' | ']' | '(' | ')' | ':' | ',' | '{' | '}')
    };
    let indexed = heading.trim_end_matches(is_of_index);
    let base = match indexed.len() < heading.len() {
        true => indexed.trim_end_matches('_'),
        false => heading,
    };
    let unit = base.rsplit_once(['_', '.']).map(|(_, unit)| unit);
    // `A_m2` are square metres.
    let is_power = |unit: &&str| {
        unit.len() == 1
            && heading.len() > base.len()
            && heading[base.len()..].starts_with(|letter: char| letter.is_ascii_digit())
    };
    let unit = unit.filter(|unit| !is_power(unit));
    // A single letter after an underscore is more often part of the name than a unit, except for SI units.
    let is_unit = |unit: &&str| {
        matches!(*unit, "m" | "s" | "n" | "N") || (unit.len() > 1 && parse_unit(unit).is_some())
    };
    // Columns are often named in lower case, symbols of units are not.
    let symbol = |unit: &str| match unit {
        "n" => "N".to_owned(),
        "kn" => "kN".to_owned(),
        _ => unit.to_owned(),
    };
    (heading.into(), unit.filter(is_unit).map(symbol))
}

/// Whether the text in brackets is the index of a vector rather than a unit.
fn is_index(text: &str) -> bool {
    !text.is_empty()
        && text
            .bytes()
            .all(|byte| byte.is_ascii_digit() || byte == b',')
}

/// Whether all filled cells of a row are units.
pub(crate) fn are_units<'a>(cells: impl Iterator<Item = &'a str>) -> bool {
    let mut count = 0;
    for cell in cells.filter(|cell| !cell.is_empty()) {
        if parse_unit(bare(cell)).is_none() {
            return false;
        }
        count += 1;
    }
    count > 0
}

/// A unit without brackets around it.
pub(crate) fn bare(cell: &str) -> &str {
    cell.trim_matches(|letter| matches!(letter, '[' | ']' | '(' | ')' | ' '))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_known_by_their_spellings() {
        for (text, dimension, factor) in [
            ("mm", Dimension::Length, 1e-3),
            (" Millimeters ", Dimension::Length, 1e-3),
            ("°", Dimension::Angle, PI / 180.0),
            ("kN", Dimension::Force, 1e3),
            ("kg", Dimension::Force, 9.80665),
            ("ms", Dimension::Time, 1e-3),
            ("Inc", Dimension::Number, 1.0),
        ] {
            let unit = parse_unit(text).expect(text);
            assert_eq!((unit.dimension, unit.factor), (dimension, factor), "{text}");
        }
        let fahrenheit = parse_unit("°F").expect("a unit");
        assert!((212.0 * fahrenheit.factor + fahrenheit.offset - 100.0).abs() < 1e-12);
        let count = parse_unit("rev/4096").expect("a unit");
        assert_eq!(
            (count.dimension, count.factor),
            (Dimension::Angle, TAU / 4096.0)
        );
        for text in ["furlong", "mm/s", "rev/0", "1/min", "°C/10"] {
            assert_eq!(parse_unit(text), None, "{text}");
        }
        assert_eq!(parse_unit("MN"), None);
    }

    #[test]
    fn headings_are_split() {
        for (heading, name, unit) in [
            ("Pos [mm]", "Pos", Some("mm")),
            ("Force (N)", "Force", Some("N")),
            ("Seillänge / m", "Seillänge", Some("m")),
            ("angle in deg", "angle", Some("deg")),
            ("length_1_m", "length_1_m", Some("m")),
            ("motor_angle_rad[2]", "motor_angle_rad[2]", Some("rad")),
            ("motor_angle_rad_2", "motor_angle_rad_2", Some("rad")),
            ("motor_angle_deg2", "motor_angle_deg2", Some("deg")),
            ("pos_mm(:,3)", "pos_mm(:,3)", Some("mm")),
            ("A_m2", "A_m2", None),
            ("rev_3", "rev_3", None),
            ("x[3]", "x[3]", None),
            ("q (unit quaternion)", "q (unit quaternion)", None),
            ("Winch1.Pos", "Winch1.Pos", None),
            ("a_u", "a_u", None),
            ("Pos [furlong]", "Pos", Some("furlong")),
        ] {
            assert_eq!(
                split_heading(heading),
                (name.into(), unit.map(Into::into)),
                "{heading}"
            );
        }
    }
}
