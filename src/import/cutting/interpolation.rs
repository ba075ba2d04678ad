//! Values of a series between its samples, at the times of another one.

use tautline_channels::Values;

/// Steps longer than this multiple of the usual step are gaps, across which nothing is interpolated.
const GAP: f64 = 3.0;

/// Value at a time (s) by the cubic through the four samples around it, fewer at the ends; `None` if a neighbouring sample
/// is missing or too far.
pub(super) fn value_at(time_s: &[f64], values: &Values, usual_s: f64, at_s: f64) -> Option<f64> {
    let after = time_s.partition_point(|time| *time < at_s);
    if time_s.get(after) == Some(&at_s) {
        return values.get(after).filter(|value| !value.is_nan());
    }
    if after == 0 || after == time_s.len() || time_s[after] - time_s[after - 1] > GAP * usual_s {
        return None;
    }
    let beside = [
        after.checked_sub(2),
        Some(after - 1),
        Some(after),
        Some(after + 1),
    ];
    let near = |row: &usize| {
        let is_near = |time: f64| (time - at_s).abs() <= (GAP + 1.0) * usual_s;
        time_s.get(*row).is_some_and(|time| is_near(*time)) && values.at(*row).is_finite()
    };
    let nodes: Vec<usize> = beside.into_iter().flatten().filter(near).collect();
    if !(nodes.contains(&after) && nodes.contains(&(after - 1))) {
        return None;
    }
    let weight = |node: usize| -> f64 {
        let others = nodes.iter().filter(|other| **other != node);
        others
            .map(|other| (at_s - time_s[*other]) / (time_s[node] - time_s[*other]))
            .product()
    };
    Some(
        nodes
            .iter()
            .map(|node| weight(*node) * values.at(*node))
            .sum(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_comes_back_and_gaps_stay_empty() {
        let cubic = |t: f64| 1.0 + t * (2.0 - t * (3.0 - t));
        let mut times: Vec<f64> = (0..50).map(|k| 0.01 * f64::from(k)).collect();
        let mut values: Vec<f64> = times.iter().map(|t| cubic(*t)).collect();
        let read =
            |times: &[f64], values: &[f64], at| value_at(times, &values.to_vec().into(), 0.01, at);
        assert!((read(&times, &values, 0.1234).unwrap() - cubic(0.1234)).abs() < 1e-12);
        assert_eq!(read(&times, &values, 0.2), Some(values[20]));
        assert_eq!(
            (read(&times, &values, -0.01), read(&times, &values, 0.6)),
            (None, None)
        );
        values[30] = f64::NAN;
        assert_eq!(read(&times, &values, 0.295), None);
        assert!(read(&times, &values, 0.285).is_some());
        times.drain(10..20);
        values.drain(10..20);
        assert_eq!(read(&times, &values, 0.15), None);
    }
}
