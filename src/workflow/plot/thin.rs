//! Thinning of points without a visible difference: the smallest and largest in each column of pixels are kept, so that no
//! outlier is lost.

use emath::Rangef;

use super::figure::Series;
use super::scale::Scale;

/// The drawn points of a series.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Thinned {
    /// Their indices, ascending.
    pub points: Vec<usize>,
    /// Pixel columns with more points than are drawn: x, and the range of y between smallest and largest.
    pub columns: Vec<(f32, Rangef)>,
}

/// Number of points up to which all are drawn: at few places along x, as for lengths measured several times, thinning
/// would hide the points in between.
const FEW: usize = 500;

/// The points of a series to draw in a view; `pixels_per_point` is the resolution of the screen.
#[must_use]
pub fn thin(series: &Series, scale: &Scale, pixels_per_point: f32) -> Thinned {
    let points = series.points();
    let first = points.partition_point(|point| point.x < scale.view[0][0]);
    let end = points.partition_point(|point| point.x <= scale.view[0][1]);
    if end.saturating_sub(first) <= FEW {
        return Thinned {
            points: (first..end).collect(),
            columns: Vec::new(),
        };
    }
    let column = |index: usize| (scale.x(points[index].x) * pixels_per_point).floor();
    let mut thinned = Thinned::default();
    let mut start = first;
    while start < end {
        let here = column(start);
        let (mut stop, mut least, mut greatest) = (start, start, start);
        while stop < end && column(stop) == here {
            if points[stop].y < points[least].y {
                least = stop;
            }
            if points[stop].y > points[greatest].y {
                greatest = stop;
            }
            stop += 1;
        }
        if stop - start <= 2 {
            thinned.points.extend(start..stop);
        } else {
            thinned.points.push(least.min(greatest));
            if least != greatest {
                thinned.points.push(least.max(greatest));
            }
            let range = Rangef::new(scale.y(points[greatest].y), scale.y(points[least].y));
            thinned
                .columns
                .push(((here + 0.5) / pixels_per_point, range));
        }
        start = stop;
    }
    thinned
}

#[cfg(test)]
mod tests {
    use emath::{Pos2, Rect};

    use super::*;
    use crate::plot::figure::Point;

    fn scale(view: [[f64; 2]; 2]) -> Scale {
        let rect = Rect::from_min_max(Pos2::ZERO, Pos2::new(100.0, 100.0));
        Scale { view, rect }
    }

    fn series(points: impl Iterator<Item = (f64, f64)>) -> Series {
        Series::of_cable(
            0,
            "cable-1",
            points.map(|(x, y)| Point::new(x, y)).collect(),
        )
    }

    #[test]
    fn few_points_all_stay() {
        let few = series((0..40).map(|k| (f64::from(k), f64::from(k % 7))));
        let thinned = thin(&few, &scale([[0.0, 40.0], [0.0, 7.0]]), 1.0);
        assert_eq!(thinned.points, (0..40).collect::<Vec<_>>());
        assert!(thinned.columns.is_empty());
    }

    #[test]
    fn at_most_two_stay_in_a_column_and_the_outlier_does() {
        let mut points: Vec<(f64, f64)> = (0..100_000)
            .map(|k| (f64::from(k), (f64::from(k) * 0.7).sin()))
            .collect();
        points[43_210].1 = 50.0;
        points[7].1 = -50.0;
        let many = series(points.into_iter());
        let thinned = thin(&many, &scale([[0.0, 1e5], [-50.0, 50.0]]), 1.0);
        assert!(thinned.points.len() <= 202, "{}", thinned.points.len());
        assert!(thinned.points.contains(&43_210) && thinned.points.contains(&7));
        assert!(thinned.points.is_sorted());
        assert_eq!(thinned.columns.len(), 100);
    }

    #[test]
    fn zoomed_in_the_points_come_back() {
        let many = series((0..100_000).map(|k| (f64::from(k), 0.0)));
        let thinned = thin(&many, &scale([[500.0, 550.0], [-1.0, 1.0]]), 1.0);
        assert_eq!(thinned.points, (500..=550).collect::<Vec<_>>());
        let finer = thin(&many, &scale([[0.0, 200.0], [-1.0, 1.0]]), 2.0);
        assert_eq!(
            finer.points.len(),
            201,
            "more pixels tell more points apart"
        );
    }
}
