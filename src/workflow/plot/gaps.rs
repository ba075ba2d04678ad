//! Curves interrupted where there are no data.

/// Smallest gap, as a fraction of the range of the data.
const LEAST: f64 = 0.15;
/// Smallest gap, as a multiple of the usual distance of neighbours.
const TIMES: f64 = 4.0;

/// Pieces of a curve with ascending x that lie where there are data: the curve is cut where neighbours in `data` (values of x,
/// in any order) are far apart.
#[must_use]
pub fn without_gaps(curve: &[[f64; 2]], data: &[f64]) -> Vec<Vec<[f64; 2]>> {
    let mut data: Vec<f64> = data.iter().copied().filter(|x| x.is_finite()).collect();
    data.sort_by(f64::total_cmp);
    let mut distances: Vec<f64> = data.windows(2).map(|pair| pair[1] - pair[0]).collect();
    distances.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (data.first(), data.last()) else {
        return Vec::new();
    };
    let usual = distances.get(distances.len() / 2).copied().unwrap_or(0.0);
    let least = (LEAST * (last - first)).max(TIMES * usual);
    let gaps: Vec<[f64; 2]> = data
        .windows(2)
        .filter(|pair| pair[1] - pair[0] > least)
        .map(|pair| [pair[0], pair[1]])
        .collect();
    // The number of gaps to the left identifies the piece; points inside a gap belong to none.
    let piece = |x: f64| {
        let is_inside = gaps.iter().any(|[from, to]| *from < x && x < *to);
        (!is_inside).then(|| gaps.iter().filter(|[_, to]| *to <= x).count())
    };
    let mut pieces: Vec<(usize, Vec<[f64; 2]>)> = Vec::new();
    for point in curve {
        let Some(number) = piece(point[0]) else {
            continue;
        };
        match pieces.last_mut() {
            Some((last, points)) if *last == number => points.push(*point),
            _ => pieces.push((number, vec![*point])),
        }
    }
    let pieces = pieces.into_iter().map(|(_, points)| points);
    pieces.filter(|points| points.len() > 1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_cut_where_there_are_no_data() {
        let curve: Vec<[f64; 2]> = (0..=100).map(|k| [f64::from(k), 1.0]).collect();
        let even: Vec<f64> = (0..=20).map(|k| 5.0 * f64::from(k)).collect();
        assert_eq!(without_gaps(&curve, &even), vec![curve.clone()]);
        let mut holed = even;
        holed.retain(|x| !(30.0..=70.0).contains(x));
        holed.reverse();
        let pieces = without_gaps(&curve, &holed);
        let ends: Vec<_> = pieces
            .iter()
            .map(|piece| [piece[0][0], piece[piece.len() - 1][0]])
            .collect();
        assert_eq!(ends, [[0.0, 25.0], [75.0, 100.0]]);
        assert!(without_gaps(&curve, &[]).is_empty());
    }

    #[test]
    fn data_at_random_places_have_no_gaps() {
        // Places of the golden ratio: as irregular as they are dense.
        let data: Vec<f64> = (0..30)
            .map(|k| (f64::from(k) * 0.618_034).fract())
            .collect();
        let curve: Vec<[f64; 2]> = (0..=100).map(|k| [0.01 * f64::from(k), 0.0]).collect();
        assert_eq!(without_gaps(&curve, &data).len(), 1);
    }
}
