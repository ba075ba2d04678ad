//! All cables of a robot as a structure of arrays, so that one SIMD vector holds the same quantity of several cables.

use pulp::Simd;

use crate::geometry::PosePacket;
use crate::real::{Lanes, Packet};
use crate::robot::Robot;

use super::inverse::check_pulley;
use super::{KinematicsError, PulleyGeometry};

/// Largest number of cables of a robot.
pub const MAX_CABLES: usize = 64;
/// Columns are padded to a multiple of this, the width of the widest vectors.
const WIDEST: usize = 8;

/// Pulleys and platform anchors of all cables, in columns padded with copies of the first cable.
#[derive(Debug, Clone)]
pub(crate) struct CableArrays {
    count: usize,
    entry: [Vec<f64>; 3],
    axis: [Vec<f64>; 3],
    radius: Vec<f64>,
    anchor: [Vec<f64>; 3],
}

impl CableArrays {
    /// The cables of `robot`.
    pub(crate) fn new(robot: &Robot) -> Result<Self, KinematicsError> {
        let count = robot.cable_count();
        if !(1..=MAX_CABLES).contains(&count) {
            return Err(KinematicsError::CableCount { count });
        }
        robot.cables.iter().try_for_each(check_pulley)?;
        let padded = count.next_multiple_of(WIDEST);
        let column = |get: &dyn Fn(&crate::robot::Cable) -> f64| -> Vec<f64> {
            let at = |i: usize| get(&robot.cables[if i < count { i } else { 0 }]);
            (0..padded).map(at).collect()
        };
        Ok(Self {
            count,
            entry: std::array::from_fn(|k| column(&|c| c.pulley.entry_point_m[k])),
            axis: std::array::from_fn(|k| column(&|c| c.pulley.swivel_axis[k])),
            radius: column(&|c| c.pulley.radius_m),
            anchor: std::array::from_fn(|k| column(&|c| c.platform_anchor_m[k])),
        })
    }

    /// Replaces the entry points (m).
    pub(crate) fn set_entry_points(&mut self, entries: &[[f64; 3]]) {
        for (i, entry) in entries.iter().enumerate() {
            for k in 0..3 {
                self.entry[k][i] = entry[k];
            }
        }
    }

    /// Number of cables, padding left out.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Number of vectors that hold all cables.
    #[inline(always)]
    pub(crate) fn vectors<S: Simd>(&self) -> usize {
        self.count.div_ceil(S::F64_LANES)
    }

    /// Mean of the entry points (m).
    pub(crate) fn entry_centroid(&self) -> [f64; 3] {
        let mean = |column: &Vec<f64>| column[..self.count].iter().sum::<f64>() / self.count as f64;
        std::array::from_fn(|k| mean(&self.entry[k]))
    }

    /// Smallest and largest coordinate of the entry points along axis `k` (m).
    pub(crate) fn entry_range(&self, k: usize) -> (f64, f64) {
        let column = self.entry[k][..self.count].iter();
        column.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(*v), high.max(*v))
        })
    }

    /// The pulleys of the cables in vector `index`.
    #[inline(always)]
    pub(crate) fn pulleys<S: Simd>(&self, simd: S, index: usize) -> PulleyGeometry<Lanes<S>> {
        PulleyGeometry {
            entry: load_vector(simd, &self.entry, index),
            axis: load_vector(simd, &self.axis, index),
            radius: Lanes::load(simd, &self.radius, index),
        }
    }

    /// `R b` of the cables in vector `index` (m).
    #[inline(always)]
    pub(crate) fn arms<S: Simd>(
        &self,
        simd: S,
        index: usize,
        pose: &PosePacket<Lanes<S>>,
    ) -> [Lanes<S>; 3] {
        pose.rotate(load_vector(simd, &self.anchor, index))
    }
}

#[inline(always)]
fn load_vector<S: Simd>(simd: S, columns: &[Vec<f64>; 3], index: usize) -> [Lanes<S>; 3] {
    [
        Lanes::load(simd, &columns[0], index),
        Lanes::load(simd, &columns[1], index),
        Lanes::load(simd, &columns[2], index),
    ]
}
