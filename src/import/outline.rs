//! The course of a channel, reduced to the resolution of a plot.

use tautline_channels::Values;

/// Rows and values of a channel for plotting: the minimum and the maximum in each of `columns` parts of the rows, so that no
/// peak is lost. Missing values yield one row with NaN.
#[must_use]
pub fn outline(values: &Values, columns: usize) -> Vec<(usize, f64)> {
    let columns = columns.clamp(1, values.len().max(1));
    let mut points: Vec<(usize, f64)> = Vec::with_capacity(2 * columns);
    for column in 0..columns {
        let from = column * values.len() / columns;
        let to = (column + 1) * values.len() / columns;
        let rows = (from..to).zip(values.range(from..to));
        let mut rows = rows.filter(|(_, value)| !value.is_nan());
        let Some(first) = rows.next() else {
            if to > from && points.last().is_some_and(|(_, value)| !value.is_nan()) {
                points.push((from, f64::NAN));
            }
            continue;
        };
        let (mut least, mut largest) = (first, first);
        for point in rows {
            if point.1 < least.1 {
                least = point;
            }
            if point.1 > largest.1 {
                largest = point;
            }
        }
        let (earlier, later) = match least.0 < largest.0 {
            true => (least, largest),
            false => (largest, least),
        };
        points.push(earlier);
        if earlier.0 != later.0 {
            points.push(later);
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use tautline_channels::Values;

    use super::outline;

    #[test]
    fn short_channels_are_shown_as_they_are() {
        assert_eq!(
            outline(&vec![1.0, 3.0, 2.0].into(), 100),
            [(0, 1.0), (1, 3.0), (2, 2.0)]
        );
        assert!(outline(&Values::default(), 10).is_empty());
    }

    #[test]
    fn no_peak_and_no_gap_is_lost() {
        let mut values = vec![0.0; 10_000];
        values[7123] = 5.0;
        values[7124] = -5.0;
        values[2000..3000].fill(f64::NAN);
        let points = outline(&values.into(), 50);
        assert!(points.len() <= 100);
        assert!(points.contains(&(7123, 5.0)) && points.contains(&(7124, -5.0)));
        let gaps = points.iter().filter(|(_, value)| value.is_nan());
        assert_eq!(gaps.count(), 1);
        assert!(points.is_sorted_by_key(|(row, _)| *row));
    }
}
