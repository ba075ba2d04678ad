//! Distances between two poses, measured with a tape or on a board with marks.

/// Distance between the places of one point of the platform at two poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistanceReading {
    /// Its row in the list of distances, from 1.
    pub number: usize,
    /// Rows of the two poses in the measurements.
    pub rows: [usize; 2],
    /// The point (m, platform frame).
    pub point_m: [f64; 3],
    /// Distance (m).
    pub distance_m: f64,
    /// Its standard deviation (m).
    pub sd_m: f64,
}

impl DistanceReading {
    /// The same distance with its rows numbered by `number`; `None` if a row has no number, or both have the same one.
    pub(super) fn renumbered(&self, number: impl Fn(usize) -> Option<usize>) -> Option<Self> {
        let [Some(a), Some(b)] = self.rows.map(number) else {
            return None;
        };
        (a != b).then_some(Self {
            rows: [a, b],
            ..*self
        })
    }
}
