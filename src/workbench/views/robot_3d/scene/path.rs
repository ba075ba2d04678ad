//! Paths of pulleys over several dates.

use tautline_core::geometry::Vec3;

use super::Scene;

/// Positions of the pulleys at several dates.
#[derive(Debug, Clone, PartialEq)]
pub struct PulleyPaths {
    /// Displacements of the pulley of each cable since the first date (m), in the order of the dates.
    pub by: Vec<Vec<Vec3>>,
    /// Index of the shown date.
    pub date: usize,
}

impl PulleyPaths {
    /// Longest displacement of any pulley (m), so that the picture keeps its scale from date to date.
    #[must_use]
    pub fn reach_m(&self) -> f64 {
        let all = self.by.iter().flatten();
        all.map(|by| by.norm()).fold(0.0, f64::max)
    }
}

impl Scene {
    /// Path of a pulley as drawn, with displacements magnified by a factor, in the order of the dates (m); empty if
    /// unknown.
    #[must_use]
    pub fn path_of(&self, cable: usize, magnification: f64) -> Vec<Vec3> {
        let by = self.paths.as_ref().and_then(|paths| paths.by.get(cable));
        let from = self.cables.get(cable).and_then(|cable| cable.moved);
        let (Some(by), Some(moved)) = (by, from) else {
            return Vec::new();
        };
        let place = |by: &Vec3| moved.from + by * magnification;
        by.iter().map(place).collect()
    }
}
