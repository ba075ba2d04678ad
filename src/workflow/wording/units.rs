//! Quantities in display units: millimetres, degrees, percent.

/// Factor from an SI unit to the display unit, and the display unit.
pub fn display_unit(unit: &str) -> (f64, &str) {
    match unit {
        "m" => (1e3, "mm"),
        "rad" => (1.0_f64.to_degrees(), "degrees"),
        "1" => (1e2, "%"),
        "m/h" => (1e3, "mm/h"),
        "m/N" => (1e6, "mm/kN"),
        "s" => (1e3, "ms"),
        "1/K" => (1e3, "mm per metre and kelvin"),
        // One hour is ln(1 + 3600 s / 600 s).
        "1/ln(1+t/600s)" => (1e3 * 7_f64.ln(), "mm per metre in the first hour"),
        "1/rev" => (1e2, "% per revolution"),
        other => (1.0, other),
    }
}

/// Unit of a parameter: coefficients of friction are ratios that are not shown as percentages.
pub fn unit_of<'a>(parameter: &str, unit: &'a str) -> &'a str {
    match parameter {
        "mu" => "",
        _ => unit,
    }
}

/// A number with `digits` significant digits, without trailing zeros; digits before the point are kept.
pub fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return format!("{value}");
    }
    let before_point = value.abs().log10().floor() as i32 + 1;
    let decimals = usize::try_from(digits - before_point).unwrap_or(0);
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// An SI quantity in its display unit: `2.3 mm`.
pub fn quantity(value: f64, unit: &str) -> String {
    let (factor, name) = display_unit(unit);
    let size = significant(value * factor, 3);
    match (name, size.as_str()) {
        ("degrees", "1" | "-1") => format!("{size} degree"),
        _ => format!("{size} {name}").trim_end().to_owned(),
    }
}

/// A range of quantities: `1.2 to 9 mm`.
pub fn range([from, to]: [f64; 2], unit: &str) -> String {
    let (factor, _) = display_unit(unit);
    let size = significant(from * factor, 3);
    let to = quantity(to, unit);
    if to.split(' ').next() == Some(&size) {
        return to;
    }
    format!("{size} to {to}")
}

/// Number of significant decimals of a value with this standard deviation (positive).
pub fn decimals(sd: f64) -> usize {
    let leading = sd.log10().floor();
    // Two digits if the first is a 1: 0.1 could be anything from 0.05 to 0.15.
    let digits = if sd / 10_f64.powf(leading) < 1.95 {
        1
    } else {
        0
    };
    usize::try_from(digits - leading as i32).unwrap_or(0)
}

/// Number of decimals that give an uncertainty (positive) two significant digits (JCGM 100, 7.2.6).
pub fn decimals_of_uncertainty(uncertainty: f64) -> usize {
    usize::try_from(1 - uncertainty.log10().floor() as i32).unwrap_or(0)
}

/// A quantity with its standard deviation, to which digits are rounded: `0.31 ± 0.04 %`.
pub fn with_sd(value: f64, sd: f64, unit: &str) -> String {
    let (factor, name) = display_unit(unit);
    let (value, sd) = (value * factor, sd * factor);
    if !(sd.is_finite() && sd > 0.0) {
        return format!("{} {name}", significant(value, 3))
            .trim_end()
            .to_owned();
    }
    let decimals = decimals(sd);
    let value = fixed(value, decimals);
    format!("{value} ± {sd:.decimals$} {name}")
        .trim_end()
        .to_owned()
}

/// An SI quantity in its display unit, with the decimals of a standard deviation, so that a difference can be seen.
pub fn quantity_to(value: f64, sd: f64, unit: &str) -> String {
    let (factor, name) = display_unit(unit);
    let sd = factor * sd;
    if !(sd.is_finite() && sd > 0.0) {
        return quantity(value, unit);
    }
    let value = fixed(factor * value, decimals(sd));
    format!("{value} {name}").trim_end().to_owned()
}

/// The 95 % interval of a quantity with a standard deviation: `0.23 to 0.39 %`, with the digits of [`with_sd`].
pub fn interval(value: f64, sd: f64, unit: &str) -> String {
    let (factor, name) = display_unit(unit);
    if !(sd.is_finite() && sd > 0.0) {
        return quantity(value, unit);
    }
    let decimals = decimals(sd * factor);
    let [from, to] = [-1.96, 1.96].map(|times| fixed((value + times * sd) * factor, decimals));
    format!("{from} to {to} {name}").trim_end().to_owned()
}

/// A number with a fixed number of decimals; zero after rounding has no sign.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(size) if !size.contains(|digit| matches!(digit, '1'..='9')) => size.to_owned(),
        _ => text,
    }
}

/// A number with a fixed number of decimals and a sign, plus included.
pub fn signed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    let is_positive = value > 0.0 && text.contains(|digit| matches!(digit, '1'..='9'));
    if is_positive {
        format!("+{text}")
    } else {
        text
    }
}

/// Metres as millimetres with a fixed number of decimals.
pub fn mm(metres: f64, decimals: usize) -> String {
    fixed(metres * 1e3, decimals)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_in_display_units() {
        for (value, unit, text) in [
            (0.002_346, "m", "2.35 mm"),
            (-0.03, "m", "-30 mm"),
            (0.0031, "1", "0.31 %"),
            (1.0_f64.to_radians(), "rad", "1 degree"),
            (2.5_f64.to_radians(), "rad", "2.5 degrees"),
            (1.2e-5, "1/K", "0.012 mm per metre and kelvin"),
            (
                0.002,
                "1/ln(1+t/600s)",
                "3.89 mm per metre in the first hour",
            ),
            (0.05, "s", "50 ms"),
            (3e-6, "m/N", "3 mm/kN"),
            (0.005, "m/h", "5 mm/h"),
            (1234.5, "N", "1234 N"),
            (0.0, "m", "0 mm"),
            (0.021, unit_of("mu", "1"), "0.021"),
        ] {
            assert_eq!(quantity(value, unit), text);
        }
        assert_eq!(range([0.0012, 0.009], "m"), "1.2 to 9 mm");
        assert_eq!(range([0.0012, 0.0012], "m"), "1.2 mm");
    }

    #[test]
    fn signs_mean_something() {
        let all = [-1.25, -0.001, 0.0, 0.001, 2.0];
        let [plain, with_plus] = [fixed, signed].map(|text| all.map(|v| text(v, 1)).join(" "));
        assert_eq!(plain, "-1.2 0.0 0.0 0.0 2.0");
        assert_eq!(with_plus, "-1.2 0.0 0.0 0.0 +2.0");
    }

    #[test]
    fn digits_follow_the_standard_deviation() {
        for (value, sd, unit, text) in [
            (0.0031, 0.0004, "1", "0.31 ± 0.04 %"),
            (0.0031, 0.000_12, "1", "0.310 ± 0.012 %"),
            (0.0523, 0.0234, "m", "52 ± 23 mm"),
            (-12.3, 4.6, "N", "-12 ± 5 N"),
            (1234.5, 150.0, "N", "1234 ± 150 N"),
            (0.0031, f64::NAN, "1", "0.31 %"),
            (-0.0002, 0.0023, "m", "0 ± 2 mm"),
            (-0.000_004, 0.000_12, "m", "0.00 ± 0.12 mm"),
            (-0.000_006, 0.000_12, "m", "-0.01 ± 0.12 mm"),
            (-0.0, f64::NAN, "m", "0 mm"),
        ] {
            assert_eq!(with_sd(value, sd, unit), text);
        }
        assert_eq!(interval(0.0031, 0.0004, "1"), "0.23 to 0.39 %");
        assert_eq!(interval(0.001_998, 0.000_003, "1"), "0.1992 to 0.2004 %");
        assert_eq!(interval(-12.3, 4.6, "N"), "-21 to -3 N");
        assert_eq!(interval(0.0031, 0.0, "1"), "0.31 %");
    }
}
