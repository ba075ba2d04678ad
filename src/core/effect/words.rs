//! Sizes and directions in words. Sizes have no sign: the surrounding words state the direction.

use super::Dual;
use super::direction::tilted;

/// Checks that several effects share: a change over time shows at a pose that is measured again.
pub(super) const GO_BACK: &str =
    "Go back to the first pose half-way and at the end, and compare the readings.";
pub(super) const GO_FROM_EITHER_SIDE: &str =
    "Go to one pose from either side and compare the readings.";
pub(super) const GO_THERE_AGAIN: &str = "Go to that pose again and compare the readings.";
pub(super) const CHECK_CLOCKS: &str = "Move the platform to and fro quickly and plot the readings against time: late readings follow the others.";
pub(super) const REPEAT_WARMER: &str =
    "Repeat the run when it is warmer, and compare the readings at the same poses.";

/// A size with three significant digits, or all digits before the decimal point.
pub(super) fn size(value: f64) -> String {
    let value = value.abs();
    if value == 0.0 {
        return "0".to_owned();
    }
    let before_point = value.log10().floor() as i32 + 1;
    let decimals = usize::try_from(3 - before_point).unwrap_or(0);
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A length (m).
pub(crate) fn millimetres(length_m: f64) -> String {
    format!("{} mm", size(1e3 * length_m))
}

/// A time (s).
pub(super) fn milliseconds(time_s: f64) -> String {
    format!("{} ms", size(1e3 * time_s))
}

/// A force (N).
pub(crate) fn newtons(force_n: f64) -> String {
    format!("{} N", size(force_n))
}

/// A ratio.
pub(super) fn percent(ratio: f64) -> String {
    format!("{} %", size(1e2 * ratio))
}

/// An angle (rad).
pub(crate) fn degrees(angle_rad: f64) -> String {
    let size = size(angle_rad.to_degrees());
    let unit = if size == "1" { "degree" } else { "degrees" };
    format!("{size} {unit}")
}

/// `a, b and c`.
pub(super) fn list(items: &[String]) -> String {
    match items {
        [before @ .., last] if !before.is_empty() => format!("{} and {last}", before.join(", ")),
        _ => items.concat(),
    }
}

/// The text with a capital at its start.
pub(super) fn sentence(text: &str) -> String {
    let mut rest = text.chars();
    let first = rest.next().into_iter().flat_map(char::to_uppercase);
    first.chain(rest).collect()
}

/// Components below this fraction of the largest are left out.
const WORTH_NAMING: f64 = 0.1;

/// The significant components of a vector, as size and signed axis: `(3.1, "+x")`.
pub(super) fn components(vector: &[f64]) -> Vec<(f64, String)> {
    let largest = vector.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let axes = vector.iter().zip(["x", "y", "z"]);
    let named = axes.filter(|(v, _)| **v != 0.0 && v.abs() >= WORTH_NAMING * largest);
    let signed = |v: f64| if v < 0.0 { '-' } else { '+' };
    named
        .map(|(v, axis)| (*v, format!("{}{axis}", signed(*v))))
        .collect()
}

/// A displacement (m): `3.1 mm towards +x and 2.8 mm towards -y`.
pub(super) fn displacement(vector_m: &[f64]) -> String {
    let parts = components(vector_m);
    if parts.is_empty() {
        return millimetres(0.0);
    }
    let words = |(length, axis): &(f64, String)| format!("{} towards {axis}", millimetres(*length));
    list(&parts.iter().map(words).collect::<Vec<_>>())
}

/// A rotation by small angles (rad): `0.3 degrees about +x and 0.1 degrees about -y`.
pub(super) fn turn(angles_rad: &[f64]) -> String {
    let parts = components(angles_rad);
    if parts.is_empty() {
        return degrees(0.0);
    }
    let words = |(angle, axis): &(f64, String)| format!("{} about {axis}", degrees(*angle));
    list(&parts.iter().map(words).collect::<Vec<_>>())
}

/// Tilt of a direction by the angles of [`tilted`], with where it points to: `2.1 degrees towards +x`. Without a
/// nominal direction, its size only.
pub(super) fn inclination(nominal: Option<[f64; 3]>, tilt_1: f64, tilt_2: f64) -> String {
    let Some(nominal) = nominal else {
        return degrees(tilt_1.hypot(tilt_2));
    };
    let [first, second] = [tilt_1, tilt_2].map(Dual::constant);
    let direction = tilted(nominal.map(Dual::constant), nominal, first, second);
    let direction = nalgebra::Vector3::from(direction.map(|dual| dual.value));
    let nominal = nalgebra::Vector3::from(nominal);
    // The component along the nominal direction changes only to second order in the tilt.
    let along = nominal.dot(&direction);
    let across = direction - nominal * along;
    let angle = degrees(across.norm().atan2(along));
    let axes = components(across.as_slice());
    if axes.is_empty() {
        return angle;
    }
    let axes: Vec<_> = axes.into_iter().map(|(_, axis)| axis).collect();
    format!("{angle} towards {}", list(&axes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (0.31, "0.31"),
            (-12.345, "12.3"),
            (0.000_123_45, "0.000123"),
            (1234.5, "1234"),
            (100.0, "100"),
            (0.999_9, "1"),
            (30.0, "30"),
        ] {
            assert_eq!(size(value), text);
        }
        assert_eq!(degrees(1_f64.to_radians()), "1 degree");
    }

    #[test]
    fn what_does_not_matter_is_left_out() {
        assert_eq!(
            displacement(&[0.003, 0.0001, -0.002]),
            "3 mm towards +x and 2 mm towards -z"
        );
        assert_eq!(displacement(&[0.0; 3]), "0 mm");
    }

    #[test]
    fn a_tilt_is_an_angle_and_a_direction() {
        let down = [0.0, 0.0, -1.0];
        let angle = 2_f64.to_radians();
        // About +x, the downward direction turns to +y.
        assert_eq!(inclination(Some(down), angle, 0.0), "2 degrees towards +y");
        assert_eq!(inclination(Some(down), -angle, 0.0), "2 degrees towards -y");
        assert_eq!(inclination(Some(down), 0.0, 0.0), "0 degrees");
        assert_eq!(inclination(None, angle, 0.0), "2 degrees");
    }

    #[test]
    fn lists_and_sentences() {
        let items = ["a", "b", "c"].map(str::to_owned);
        assert_eq!(list(&items), "a, b and c");
        assert_eq!(list(&items[..1]), "a");
        assert_eq!(sentence("the end."), "The end.");
    }
}
