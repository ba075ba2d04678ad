//! Contour lines of a heat map (marching squares between the centres of its cells).

use super::figure::HeatMap;

/// The contour of a level, as pieces that end with a non-finite point.
#[must_use]
pub fn contours(heat: &HeatMap, level: f64) -> Vec<[f64; 2]> {
    let middles = |edges: &[f64]| -> Vec<f64> {
        edges
            .windows(2)
            .map(|pair| 0.5 * (pair[0] + pair[1]))
            .collect()
    };
    let (x, y) = (middles(&heat.x), middles(&heat.y));
    if heat.values.len() < x.len() * y.len() {
        return Vec::new();
    }
    let mut line = Vec::new();
    for row in 1..y.len() {
        for column in 1..x.len() {
            let corner = |right: usize, up: usize| {
                let (c, r) = (column - 1 + right, row - 1 + up);
                ([x[c], y[r]], heat.values[r * x.len() + c])
            };
            let around = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            let mut crossings =
                (0..4).filter_map(|k| crossing(around[k], around[(k + 1) % 4], level));
            // Four crossings are a saddle point with two pieces.
            while let (Some(a), Some(b)) = (crossings.next(), crossings.next()) {
                line.extend([a, b, [f64::NAN; 2]]);
            }
        }
    }
    line
}

fn crossing(a: ([f64; 2], f64), b: ([f64; 2], f64), level: f64) -> Option<[f64; 2]> {
    if (a.1 < level) == (b.1 < level) {
        return None;
    }
    let share = (level - a.1) / (b.1 - a.1);
    let along = |k: usize| a.0[k] + share * (b.0[k] - a.0[k]);
    Some([along(0), along(1)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::figure::{Axis, ColourScale};

    #[test]
    fn the_contour_of_a_cone_is_a_circle() {
        let edges: Vec<f64> = (-20..=20).map(|k| f64::from(k) * 0.1).collect();
        let middle: Vec<f64> = edges.windows(2).map(|e| 0.5 * (e[0] + e[1])).collect();
        let mut values = Vec::new();
        for y in &middle {
            values.extend(middle.iter().map(|x| x.hypot(*y)));
        }
        let heat = HeatMap {
            x: edges.clone(),
            y: edges,
            values,
            shades: ColourScale::Rising(0.0, 2.0),
            axis: Axis::default(),
            names: Default::default(),
            cables: Vec::new(),
        };
        let line = contours(&heat, 1.25);
        assert!(line.len() > 100);
        for [x, y] in line.iter().filter(|place| place[0].is_finite()) {
            assert!((x.hypot(*y) - 1.25).abs() < 2e-3);
        }
        assert!(contours(&heat, 9.0).is_empty());
    }
}
