//! Common motion of all parts that are fixed to the frame: a small translation `t` and rotation `w` about the centroid of the
//! pulleys, by which the datum of one run differs from that of another.

use nalgebra::{DMatrix, SymmetricEigen};

use super::Identified;
use crate::estimation::ParameterId;
use crate::geometry::Vec3;
use crate::robot::Robot;

/// Eigenvalues below this fraction of the largest belong to motions that leave all known coordinates unchanged.
const NULL_EIGENVALUE: f64 = 1e-9;

/// Rigid motions of the frame of a robot.
pub(crate) struct RigidMotion<'a> {
    robot: &'a Robot,
    /// Centroid of the entry points as described (m).
    centroid: Vec3,
}

impl<'a> RigidMotion<'a> {
    pub fn new(robot: &'a Robot) -> Self {
        let entries = robot.cables.iter().map(|c| c.pulley.entry_point_m);
        let sum = entries.fold(Vec3::zeros(), |sum, entry| sum + Vec3::from(entry));
        Self {
            robot,
            centroid: sum / robot.cables.len() as f64,
        }
    }

    /// Derivatives of coordinates of the frame by `[t; w]`, one row each (n x 6).
    pub fn of_coordinates(&self, coordinates: &[ParameterId]) -> DMatrix<f64> {
        rows(coordinates.iter().map(|id| self.of_coordinate(id)))
    }

    /// Derivative of a coordinate by `[t; w]`: its direction, and the moment of that direction about the centroid.
    fn of_coordinate(&self, id: &ParameterId) -> [f64; 6] {
        match (id, self.robot.laser) {
            (ParameterId::EntryPoint { cable, axis }, _) => {
                let entry = self.robot.cables[*cable].pulley.entry_point_m;
                self.along(entry.into(), Vec3::ith(*axis, 1.0))
            }
            (ParameterId::PlaneOffset, Some(laser)) => {
                let normal = Vec3::from(laser.target_plane.normal);
                // The plane's offset is observed near the home position, so that is the point whose motion counts.
                let home = self.robot.home.map(|home| home.pose().position);
                let home = home.unwrap_or(self.centroid);
                let foot = home + normal * (laser.target_plane.offset_m - normal.dot(&home));
                self.along(foot, normal)
            }
            _ => [0.0; 6],
        }
    }

    /// `direction . (t + w x (point - centroid))` by `[t; w]`.
    fn along(&self, point: Vec3, direction: Vec3) -> [f64; 6] {
        let turn = (point - self.centroid).cross(&direction);
        let [x, y, z]: [f64; 3] = direction.into();
        [x, y, z, turn.x, turn.y, turn.z]
    }

    /// Orthonormal basis of the motions `[t; w]` that change none of the `known` coordinates (6 x k), nor a home pose that all
    /// runs know exactly.
    pub fn open_directions(&self, runs: &[Identified<'_>], known: &[ParameterId]) -> DMatrix<f64> {
        let mut still: Vec<[f64; 6]> = known.iter().map(|id| self.of_coordinate(id)).collect();
        let home =
            |run: &Identified<'_>| run.problem.home_row().and(run.problem.dataset.robot.home);
        let homes: Option<Vec<_>> = runs.iter().map(home).collect();
        if let Some([first, others @ ..]) = homes.as_deref() {
            let all = || std::iter::once(first).chain(others);
            if all().all(|home| home.position_sd_m == 0.0) {
                let at = first.pose().position;
                still.extend([0, 1, 2].map(|axis| self.along(at, Vec3::ith(axis, 1.0))));
            }
            if all().all(|home| home.orientation_sd_rad == 0.0) {
                let unit = |k: usize| std::array::from_fn(|i| f64::from(u8::from(i == k)));
                still.extend([3, 4, 5].map(unit));
            }
        }
        let still = rows(still.into_iter());
        let eigen = SymmetricEigen::new(still.tr_mul(&still));
        let largest = eigen.eigenvalues.max().max(f64::MIN_POSITIVE);
        let open: Vec<_> = (0..6)
            .filter(|k| eigen.eigenvalues[*k] <= NULL_EIGENVALUE * largest)
            .map(|k| eigen.eigenvectors.column(k).into_owned())
            .collect();
        if open.is_empty() {
            return DMatrix::zeros(6, 0);
        }
        DMatrix::from_columns(&open)
    }
}

fn rows(rows: impl ExactSizeIterator<Item = [f64; 6]>) -> DMatrix<f64> {
    DMatrix::from_row_iterator(rows.len(), 6, rows.flatten())
}
