//! Trail of the platform during an operation, with a limited number of points.

use std::sync::Arc;

use tautline_core::geometry::Vec3;

/// Largest number of points; at this number every other one is dropped.
const MOST: usize = 512;
/// Initial distance between points (m).
const APART_M: f64 = 2e-3;

/// Path of the platform.
#[derive(Debug, Clone)]
pub struct Trail {
    places: Arc<Vec<Vec3>>,
    apart_m: f64,
}

impl Default for Trail {
    fn default() -> Self {
        Self {
            places: Arc::default(),
            apart_m: APART_M,
        }
    }
}

impl Trail {
    /// Points (m), oldest first.
    #[must_use]
    pub fn places(&self) -> &Arc<Vec<Vec3>> {
        &self.places
    }

    /// Adds a position if it is far enough from the last point.
    pub fn follow(&mut self, place: Vec3) {
        let last = self.places.last();
        if last.is_some_and(|last| (place - last).norm() < self.apart_m) {
            return;
        }
        let places = Arc::make_mut(&mut self.places);
        places.push(place);
        if places.len() == MOST {
            let mut number = 0;
            places.retain(|_| {
                number += 1;
                number % 2 == 1
            });
            self.apart_m *= 2.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_way_keeps_its_shape_and_its_size() {
        let mut trail = Trail::default();
        let at = |k: i32| {
            let angle = f64::from(k) * 1e-3;
            Vec3::new(angle.cos(), angle.sin(), 0.0)
        };
        for k in 0..100_000 {
            trail.follow(at(k));
        }
        let places = trail.places();
        assert!(places.len() < MOST && places.len() > MOST / 8);
        assert_eq!(places[0], at(0));
        let apart = places.windows(2).map(|pair| (pair[1] - pair[0]).norm());
        assert!(apart.fold(0.0, f64::max) < 4.0 * trail.apart_m);
    }

    #[test]
    fn a_platform_at_rest_leaves_one_place() {
        let mut trail = Trail::default();
        for k in 0..100 {
            trail.follow(Vec3::new(1e-5 * f64::from(k), 0.0, 0.0));
        }
        assert_eq!(trail.places().len(), 1);
    }
}
