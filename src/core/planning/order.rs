//! Order of measurement: short moves, but no coordinate that correlates with time.
//!
//! Drifts with time (temperature, laser, creep of the cables) look like geometry if the platform moves steadily
//! from one end to the other meanwhile. So the path to be shortened (nearest neighbour, then reversal of segments: 2-opt)
//! is penalised by four times its length for each unit by which the largest correlation of a coordinate with the position in
//! the order exceeds 0.15: `cost = length (1 + 4 max(0, |rho| - 0.15))`. A move whose straight way cannot be held counts
//! with its way over the start, over which the platform goes then.

use std::collections::HashSet;

use crate::geometry::{Coordinate, Pose, Vec3};
use crate::robot::Robot;

/// Correlation up to which there is no penalty.
const FREE_CORRELATION: f64 = 0.15;
/// Penalty of one unit of correlation, relative to the length.
const CORRELATION_PENALTY: f64 = 4.0;
/// Smallest relative reduction of the cost worth another change.
const MIN_GAIN: f64 = 1e-9;

/// Order in which poses are visited.
#[derive(Debug, Clone, PartialEq)]
pub struct Order {
    /// Indices of the poses in the order of visits.
    pub sequence: Vec<usize>,
    /// Length of the path from the start through all poses, rotations counted at the anchors (m).
    pub travel_m: f64,
    /// Length of the path in the order in which the poses were given (m).
    pub unordered_travel_m: f64,
    /// Correlation of each coordinate with the position in the order.
    pub time_correlation: Vec<(Coordinate, f64)>,
}

impl Order {
    /// Orders `poses`, beginning near `start`; `is_held` tells whether the platform can move straight between two of them.
    #[must_use]
    pub fn of(
        robot: &Robot,
        start: Pose,
        poses: &[Pose],
        is_held: &dyn Fn(&Pose, &Pose) -> bool,
    ) -> Self {
        let mut tour = Tour::new(robot, start, poses);
        let mut sequence = tour.nearest_neighbours();
        let mut checked = HashSet::new();
        loop {
            tour.improve(&mut sequence);
            let moves: Vec<(usize, usize)> = sequence.windows(2).map(|m| (m[0], m[1])).collect();
            let new = moves.into_iter().filter(|m| checked.insert(*m));
            let open: Vec<_> = new
                .filter(|(a, b)| !is_held(&poses[*a], &poses[*b]))
                .collect();
            if open.is_empty() {
                return Self::along(robot, &tour, sequence);
            }
            open.into_iter()
                .for_each(|(a, b)| tour.lead_over_start(a, b));
        }
    }

    /// Keeps `poses` in the given order.
    pub(super) fn given(
        robot: &Robot,
        start: Pose,
        poses: &[Pose],
        is_held: &dyn Fn(&Pose, &Pose) -> bool,
    ) -> Self {
        let mut tour = Tour::new(robot, start, poses);
        for (k, ends) in poses.windows(2).enumerate() {
            if !is_held(&ends[0], &ends[1]) {
                tour.lead_over_start(k, k + 1);
            }
        }
        Self::along(robot, &tour, (0..poses.len()).collect())
    }

    fn along(robot: &Robot, tour: &Tour, sequence: Vec<usize>) -> Self {
        let given: Vec<usize> = (0..sequence.len()).collect();
        let freedom = robot.platform.freedom();
        let coordinates = freedom.coordinates().iter().copied();
        Self {
            travel_m: tour.length(&sequence),
            unordered_travel_m: tour.length(&given),
            time_correlation: coordinates.zip(tour.correlations(&sequence)).collect(),
            sequence,
        }
    }

    /// Largest absolute correlation of a coordinate with the position in the order.
    #[must_use]
    pub fn worst_correlation(&self) -> f64 {
        let all = self.time_correlation.iter();
        all.map(|(_, rho)| rho.abs()).fold(0.0, f64::max)
    }
}

struct Tour {
    /// Distance of every pose from every other; the start is the last (m).
    distance: Vec<Vec<f64>>,
    /// Standardised coordinates, one list per coordinate.
    coordinates: Vec<Vec<f64>>,
}

impl Tour {
    fn new(robot: &Robot, start: Pose, poses: &[Pose]) -> Self {
        let arms = robot.cables.iter();
        let arm = arms
            .map(|cable| Vec3::from(cable.platform_anchor_m).norm())
            .fold(0.0, f64::max);
        let places: Vec<Pose> = poses.iter().copied().chain([start]).collect();
        let between = |a: &Pose, b: &Pose| {
            let twist = a.difference(b);
            let shift = twist.fixed_rows::<3>(0).norm();
            shift.hypot(arm * twist.fixed_rows::<3>(3).norm())
        };
        let freedom = robot.platform.freedom();
        let coordinate = |k: usize| {
            standardised(
                poses
                    .iter()
                    .map(|pose| pose.difference(&start)[k])
                    .collect(),
            )
        };
        Self {
            distance: places
                .iter()
                .map(|a| places.iter().map(|b| between(a, b)).collect())
                .collect(),
            coordinates: (freedom.coordinates().iter())
                .map(|c| coordinate(c.index()))
                .collect(),
        }
    }

    fn lead_over_start(&mut self, a: usize, b: usize) {
        let start = self.start();
        let detour = self.distance[a][start] + self.distance[start][b];
        self.distance[a][b] = detour;
        self.distance[b][a] = detour;
    }

    fn start(&self) -> usize {
        self.distance.len() - 1
    }

    fn nearest_neighbours(&self) -> Vec<usize> {
        let mut left: Vec<usize> = (0..self.start()).collect();
        let mut sequence = Vec::with_capacity(left.len());
        let mut at = self.start();
        while let Some(k) = (0..left.len())
            .min_by(|a, b| self.distance[at][left[*a]].total_cmp(&self.distance[at][left[*b]]))
        {
            at = left.swap_remove(k);
            sequence.push(at);
        }
        sequence
    }

    /// Reverses segments of the sequence as long as that lowers the cost.
    fn improve(&self, sequence: &mut [usize]) {
        let mut cost = self.cost(sequence);
        loop {
            let before = cost;
            for from in 0..sequence.len() {
                for to in from + 1..sequence.len() {
                    sequence[from..=to].reverse();
                    let changed = self.cost(sequence);
                    if changed < cost * (1.0 - MIN_GAIN) {
                        cost = changed;
                    } else {
                        sequence[from..=to].reverse();
                    }
                }
            }
            if cost >= before * (1.0 - MIN_GAIN) {
                return;
            }
        }
    }

    fn cost(&self, sequence: &[usize]) -> f64 {
        let correlations = self.correlations(sequence);
        let worst = correlations.iter().fold(0.0_f64, |w, rho| w.max(rho.abs()));
        let excess = (worst - FREE_CORRELATION).max(0.0);
        self.length(sequence) * (1.0 + CORRELATION_PENALTY * excess)
    }

    fn length(&self, sequence: &[usize]) -> f64 {
        let mut at = self.start();
        let mut length = 0.0;
        for next in sequence {
            length += self.distance[at][*next];
            at = *next;
        }
        length
    }

    fn correlations(&self, sequence: &[usize]) -> Vec<f64> {
        let count = sequence.len() as f64;
        let middle = (count - 1.0) / 2.0;
        // Standard deviation of the positions 0, 1, .., count - 1.
        let spread = ((count * count - 1.0) / 12.0).sqrt().max(f64::MIN_POSITIVE);
        let rho = |values: &Vec<f64>| {
            let terms = sequence.iter().enumerate();
            let sum: f64 = terms.map(|(t, k)| (t as f64 - middle) * values[*k]).sum();
            sum / (count * spread)
        };
        self.coordinates.iter().map(rho).collect()
    }
}

/// Values centred and divided by their standard deviation; zeros where they are constant.
fn standardised(values: Vec<f64>) -> Vec<f64> {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count;
    let scale = if variance > 0.0 {
        variance.sqrt().recip()
    } else {
        0.0
    };
    values.into_iter().map(|v| (v - mean) * scale).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::presets;

    #[test]
    fn moves_that_cannot_be_held_are_avoided_or_lead_over_the_start() {
        let robot = presets::find("mini").unwrap().robot;
        let at = |x: f64, y: f64| Pose::from_parts([x, y, 0.0], [1.0, 0.0, 0.0, 0.0]);
        let poses = [at(0.3, 0.01), at(0.31, 0.01), at(0.3, -0.2), at(0.31, -0.2)];
        let order = |is_held: &dyn Fn(&Pose, &Pose) -> bool| {
            Order::of(&robot, Pose::identity(), &poses, is_held)
        };
        let free = order(&|_, _| true).sequence;
        let moves = |sequence: &[usize]| -> Vec<[usize; 2]> {
            let pairs = sequence.windows(2);
            pairs.map(|m| [m[0].min(m[1]), m[0].max(m[1])]).collect()
        };
        let first = moves(&free)[0];
        let ends = first.map(|k| poses[k]);
        let other = order(&|a, b| !(ends.contains(a) && ends.contains(b)));
        assert!(!moves(&other.sequence).contains(&first), "{other:?}");
        // If no straight path is feasible, the platform returns to the start between all poses, which counts as path length.
        let none = order(&|_, _| false);
        let spokes: f64 = poses.iter().map(|pose| pose.position.norm()).sum();
        let last = poses[none.sequence[3]].position.norm();
        assert!((none.travel_m - (2.0 * spokes - last)).abs() < 1e-12);
    }
}
