//! Lines with fewer points that look the same: a graphics card, or what stands in for one, draws every segment.

use egui::{Pos2, Vec2};

/// The points of a line without those from which it would not be told: each is at most so far (points) from the line that
/// is left. In one pass, by the sector in which a segment passes all points so far (Williams 1978).
#[must_use]
pub fn straightened(places: &[Pos2], tolerance: f32) -> Vec<Pos2> {
    let mut left = Vec::new();
    let Some((&first, rest)) = places.split_first() else {
        return left;
    };
    left.push(first);
    let mut sector = Sector::from(first);
    let mut last = first;
    for &place in rest {
        if !sector.takes(place, tolerance) {
            left.push(last);
            sector = Sector::from(last);
            sector.takes(place, tolerance);
        }
        last = place;
    }
    if rest.is_empty() {
        return left;
    }
    left.push(last);
    left
}

/// The directions from a point in which a segment passes near all points that it takes.
struct Sector {
    from: Pos2,
    /// Least and greatest direction about `middle` (rad), once there is one.
    range: Option<(Vec2, [f32; 2])>,
    /// Distance of the farthest point so far.
    reach: f32,
}

impl Sector {
    fn from(from: Pos2) -> Self {
        Self {
            from,
            range: None,
            reach: 0.0,
        }
    }

    /// Whether a segment that ends at `place` passes all points so far; then it is one of them.
    fn takes(&mut self, place: Pos2, tolerance: f32) -> bool {
        let way = place - self.from;
        let distance = way.length();
        // A line that turns back would lose its end.
        if !distance.is_finite() || distance + tolerance < self.reach {
            return false;
        }
        self.reach = self.reach.max(distance);
        if distance <= tolerance {
            return true;
        }
        let half = (tolerance / distance).asin();
        let Some((middle, [low, high])) = &mut self.range else {
            self.range = Some((way, [-half, half]));
            return true;
        };
        let angle = (middle.x * way.y - middle.y * way.x).atan2(middle.dot(way));
        if angle < *low || angle > *high {
            return false;
        }
        (*low, *high) = (low.max(angle - half), high.min(angle + half));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(place: Pos2, line: &[Pos2]) -> f32 {
        let to_segment = |pair: &[Pos2]| {
            let (begin, way) = (pair[0], pair[1] - pair[0]);
            let part = (place - begin).dot(way) / way.length_sq().max(f32::MIN_POSITIVE);
            place.distance(begin + part.clamp(0.0, 1.0) * way)
        };
        line.windows(2)
            .map(to_segment)
            .fold(f32::INFINITY, f32::min)
    }

    #[test]
    fn what_is_left_out_is_no_farther_than_the_tolerance() {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32 - 0.5
        };
        for noise in [0.1_f32, 0.5, 3.0, 40.0] {
            let wave = |k: usize| 20.0 * (k as f32 / 60.0).sin();
            let places: Vec<Pos2> = (0..600)
                .map(|k| Pos2::new(0.5 * k as f32, wave(k) + noise * random()))
                .collect();
            let left = straightened(&places, 0.3);
            assert!(left.first() == places.first() && left.last() == places.last());
            assert!(left.iter().all(|place| places.contains(place)));
            for place in &places {
                let away = distance(*place, &left);
                assert!(away < 0.301, "{away} at noise {noise}");
            }
            assert!(noise > 1.0 || left.len() < 300, "{} at {noise}", left.len());
        }
    }

    #[test]
    fn ends_of_strokes_and_short_lines_stay() {
        let up_and_down = [[0.0, 0.0], [0.0, 9.0], [0.1, 0.0], [0.1, 4.0]].map(Pos2::from);
        assert_eq!(straightened(&up_and_down, 0.3), up_and_down);
        assert!(straightened(&[], 0.3).is_empty());
        let one = [Pos2::new(1.0, 2.0)];
        assert_eq!(straightened(&one, 0.3), one);
        let straight: Vec<Pos2> = (0..50).map(|k| Pos2::new(k as f32, 2.0)).collect();
        assert_eq!(straightened(&straight, 0.3).len(), 2);
    }
}
