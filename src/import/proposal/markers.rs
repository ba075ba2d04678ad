//! Markers on the platform: those at constant distances from each other while they move.

use tautline_channels::Channel;

use crate::external::FEWEST_MARKERS;

/// Maximum number of rows that are examined.
const MOST_ROWS: usize = 300;
/// Minimum number of rows in which two markers were both seen.
const FEWEST_ROWS: usize = 3;
/// Distances of markers on one body change by less than this fraction of the distance, and of the range of their motion.
const RIGID: f64 = 0.01;
/// A body moves if its motion exceeds this fraction of its size.
const MOVES: f64 = 0.1;

/// A marker: its name, and its coordinates.
pub(super) type Marker<'a> = (String, [&'a Channel; 3]);

/// The markers of the body that moves most; none where fewer than three move together.
pub(super) fn on_platform(markers: &[Marker<'_>]) -> Vec<usize> {
    let rows = markers.first().map_or(0, |(_, [x, ..])| x.values.len());
    let every = rows.div_ceil(MOST_ROWS).max(1);
    let place = |(_, channels): &Marker<'_>, row: usize| channels.map(|c| c.values.at(row));
    let courses: Vec<Vec<[f64; 3]>> = markers
        .iter()
        .map(|marker| {
            (0..rows)
                .step_by(every)
                .map(|row| place(marker, row))
                .collect()
        })
        .collect();
    let is_rigid = |a: usize, b: usize| distances(&courses[a], &courses[b]).is_some();
    let mut best: (f64, Vec<usize>) = (0.0, Vec::new());
    for seed in 0..markers.len() {
        let mut body = vec![seed];
        for other in (0..markers.len()).filter(|other| *other != seed) {
            if body.iter().all(|known| is_rigid(*known, other)) {
                body.push(other);
            }
        }
        if body.len() < FEWEST_MARKERS {
            continue;
        }
        let apart = body[1..]
            .iter()
            .filter_map(|b| distances(&courses[seed], &courses[*b]));
        let size = apart.fold(0.0, f64::max);
        let motion = extent(&courses[seed]);
        if motion > MOVES * size && (motion, body.len()) > (best.0, best.1.len()) {
            body.sort_unstable();
            best = (motion, body);
        }
    }
    best.1
}

/// Mean distance of two markers if it is constant.
fn distances(a: &[[f64; 3]], b: &[[f64; 3]]) -> Option<f64> {
    let distance = |(a, b): (&[f64; 3], &[f64; 3])| {
        let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let all: Vec<f64> = a
        .iter()
        .zip(b)
        .map(distance)
        .filter(|d| d.is_finite())
        .collect();
    let count = all.len() as f64;
    let mean = all.iter().sum::<f64>() / count;
    let variance = all.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / count;
    let allowed = RIGID * mean.min(extent(a).max(extent(b)));
    (all.len() >= FEWEST_ROWS && variance.sqrt() < allowed).then_some(mean)
}

/// Largest range of the coordinates of a marker.
fn extent(course: &[[f64; 3]]) -> f64 {
    let along = |axis: usize| {
        let seen = course
            .iter()
            .map(|at| at[axis])
            .filter(|value| value.is_finite());
        let (low, high) = seen.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        high - low
    };
    (0..3).map(along).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channels(course: impl Fn(usize) -> [f64; 3]) -> [Channel; 3] {
        [0, 1, 2].map(|axis| Channel {
            values: (0..50).map(|row| course(row)[axis]).collect(),
            ..Channel::default()
        })
    }

    #[test]
    fn markers_that_move_together_are_told_from_those_of_the_frame_and_a_person() {
        let at = |row: usize, off: [f64; 3]| {
            let angle = 0.02 * row as f64;
            let (s, c) = angle.sin_cos();
            [
                c * off[0] - s * off[1] + 4.0 * row as f64,
                s * off[0] + c * off[1],
                off[2],
            ]
        };
        let frame = [
            [0.0, 0.0, 0.0],
            [900.0, 0.0, 0.0],
            [0.0, 900.0, 0.0],
            [0.0, 0.0, 900.0],
        ];
        let body = [
            [50.0, 0.0, 0.0],
            [0.0, 60.0, 0.0],
            [0.0, 0.0, 70.0],
            [-40.0, 10.0, 0.0],
        ];
        let mut all: Vec<[Channel; 3]> = frame.iter().map(|place| channels(|_| *place)).collect();
        all.extend(body.iter().map(|off| channels(|row| at(row, *off))));
        all.push(channels(|row| {
            [(row * row) as f64, 100.0 - row as f64, 0.0]
        }));
        let markers: Vec<Marker<'_>> = all
            .iter()
            .enumerate()
            .map(|(k, [x, y, z])| (format!("m{k}"), [x, y, z]))
            .collect();
        assert_eq!(on_platform(&markers), [4, 5, 6, 7]);
        assert_eq!(on_platform(&markers[..6]), [0_usize; 0]);
    }
}
