//! Displacements of pulleys and target plane, and the rigid motion common to all of them (the datum).

use nalgebra::{DMatrix, DVector, Matrix3};

use super::estimate::{Estimate, Estimates};
use super::least_squares::Difference;
use super::rigid_motion::RigidMotion;
use super::{CommonMotion, Displacement, ScalarDifference, Test};
use crate::estimation::ParameterId;
use crate::geometry::Vec3;

/// A part fixed to the frame that may have been displaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FramePart {
    /// The pulley of a cable.
    Pulley(usize),
    /// The laser's target plane.
    TargetPlane,
}

/// Differences of all coordinates between two runs, and their change under a common rigid motion.
pub(super) struct Datum {
    coordinates: Vec<ParameterId>,
    cables: usize,
    difference: Difference,
    covariance: DMatrix<f64>,
    /// Columns: basis of the directions of `[t; w]` that the known coordinates leave free.
    open: DMatrix<f64>,
    /// Change of each coordinate along the free directions.
    by_motion: DMatrix<f64>,
}

impl Datum {
    /// `None` if no coordinate of a pulley is estimated.
    pub fn of(estimates: &Estimates<'_>) -> Option<Self> {
        let runs = &estimates.runs;
        let [first, second] = runs;
        let cables = first.robot().cable_count();
        let all = (0..cables)
            .flat_map(|cable| [0, 1, 2].map(|axis| ParameterId::EntryPoint { cable, axis }));
        let is_open = |id: &ParameterId| runs.iter().any(|run| run.index_of(id).is_some());
        let (mut coordinates, known): (Vec<_>, Vec<_>) = all.partition(is_open);
        if coordinates.is_empty() {
            return None;
        }
        coordinates.extend(Some(ParameterId::PlaneOffset).filter(is_open));
        let value = |run: &Estimate<'_>, id: &ParameterId| run.value_or(id, stated(run, id));
        let change = |id: &ParameterId| value(second, id) - value(first, id);
        let count = coordinates.len();
        let covariance = DMatrix::from_fn(count, count, |i, k| {
            estimates.covariance_of(&coordinates[i], &coordinates[k])
        });
        let differences = DVector::from_iterator(count, coordinates.iter().map(change));
        let motion = RigidMotion::new(first.robot());
        let open = motion.open_directions(&runs.each_ref().map(|run| run.run), &known);
        Some(Self {
            difference: Difference::new(differences, covariance.clone())?,
            covariance,
            by_motion: motion.of_coordinates(&coordinates) * &open,
            open,
            coordinates,
            cables,
        })
    }

    /// Number of directions in which the datum can move.
    pub fn freedom(&self) -> usize {
        self.open.ncols()
    }

    /// Indices of the coordinates of a part.
    fn places(&self, part: FramePart) -> Vec<usize> {
        let belongs = |id: &ParameterId| match (part, id) {
            (FramePart::Pulley(own), ParameterId::EntryPoint { cable, .. }) => own == *cable,
            (FramePart::TargetPlane, ParameterId::PlaneOffset) => true,
            _ => false,
        };
        (0..self.coordinates.len())
            .filter(|k| belongs(&self.coordinates[*k]))
            .collect()
    }

    /// Design matrix: columns of the common motion, then of the individual displacements in `own`.
    fn design(&self, own: &[FramePart]) -> DMatrix<f64> {
        let places: Vec<usize> = own.iter().flat_map(|q| self.places(*q)).collect();
        let motion = self.by_motion.ncols();
        let mut design = DMatrix::zeros(self.coordinates.len(), motion + places.len());
        design.columns_mut(0, motion).copy_from(&self.by_motion);
        for (column, place) in places.into_iter().enumerate() {
            design[(place, motion + column)] = 1.0;
        }
        design
    }

    /// Displacement of a pulley or the plane with its covariance, relative to the parts that have not moved; `None`
    /// where those do not determine it.
    pub fn displacement(
        &self,
        part: FramePart,
        moved: &[FramePart],
    ) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let mut own: Vec<FramePart> = moved.iter().copied().filter(|q| *q != part).collect();
        own.push(part);
        let size = self.places(part).len();
        if size == 0 {
            return None;
        }
        let solved = self.difference.solve(&self.design(&own))?;
        let first = solved.estimate.len() - size;
        Some((
            solved.estimate.rows(first, size).into_owned(),
            solved
                .covariance
                .view((first, first), (size, size))
                .into_owned(),
        ))
    }

    /// The pulleys (and the plane) that have moved, most significant first; `others` further tests share the level.
    pub fn moved(&self, level: f64, others: usize) -> Vec<FramePart> {
        let pulleys = (0..self.cables).map(FramePart::Pulley);
        let parts: Vec<FramePart> = pulleys
            .chain([FramePart::TargetPlane])
            .filter(|part| !self.places(*part).is_empty())
            .collect();
        let mut moved = Vec::new();
        loop {
            let open = parts.iter().filter(|part| !moved.contains(*part));
            let judged = open.filter_map(|part| {
                let (value, covariance) = self.displacement(*part, &moved)?;
                Some((*part, Test::of(&value, &covariance)?.p_value))
            });
            let Some((worst, p_value)) = judged.min_by(|a, b| a.1.total_cmp(&b.1)) else {
                return moved;
            };
            let tests = parts.len() + others - moved.len();
            if p_value * tests as f64 >= level {
                return moved;
            }
            moved.push(worst);
        }
    }

    /// Difference of a pulley's entry point as estimated, each run in its own datum.
    pub fn raw(&self, cable: usize) -> Displacement {
        let places = self.places(FramePart::Pulley(cable));
        let value = self.difference.value.select_rows(&places);
        let covariance = self.covariance.select_rows(&places).select_columns(&places);
        self.spatial(cable, &(value, covariance))
    }

    /// Extends a displacement of a pulley's estimated coordinates to all three axes.
    pub fn spatial(
        &self,
        cable: usize,
        (value, covariance): &(DVector<f64>, DMatrix<f64>),
    ) -> Displacement {
        let mut spatial = Displacement {
            vector_m: Vec3::zeros(),
            covariance: Matrix3::zeros(),
        };
        let places = self.places(FramePart::Pulley(cable));
        let axes: Vec<usize> = (places.iter())
            .filter_map(|place| match self.coordinates[*place] {
                ParameterId::EntryPoint { axis, .. } => Some(axis),
                _ => None,
            })
            .collect();
        for (i, axis) in axes.iter().enumerate() {
            spatial.vector_m[*axis] = value[i];
            for (k, other) in axes.iter().enumerate() {
                spatial.covariance[(*axis, *other)] = covariance[(i, k)];
            }
        }
        spatial
    }

    /// Common motion of the parts that have not moved.
    pub fn motion(&self, moved: &[FramePart]) -> Option<CommonMotion> {
        let freedom = self.freedom();
        if freedom == 0 {
            return None;
        }
        let solved = self.difference.solve(&self.design(moved))?;
        let open = solved.estimate.rows(0, freedom).into_owned();
        let covariance = solved
            .covariance
            .view((0, 0), (freedom, freedom))
            .into_owned();
        let motion = &self.open * &open;
        Some(CommonMotion {
            shift_m: motion.fixed_rows::<3>(0).into_owned(),
            rotation_rad: motion.fixed_rows::<3>(3).into_owned(),
            test: Test::of(&open, &covariance),
            covariance: &self.open * covariance * self.open.transpose(),
            freedom,
        })
    }

    /// Difference of the offset of the target plane.
    pub fn plane(&self, runs: &[Estimate<'_>; 2], moved: &[FramePart]) -> Option<ScalarDifference> {
        let (value, covariance) = self.displacement(FramePart::TargetPlane, moved)?;
        let offset = |run: &Estimate<'_>| {
            let laser = run.robot().laser?;
            Some(run.value_or(&ParameterId::PlaneOffset, laser.target_plane.offset_m))
        };
        Some(ScalarDifference {
            first: offset(&runs[0]),
            second: offset(&runs[1]),
            difference: value[0],
            sd: covariance[(0, 0)].sqrt(),
            test: Test::of(&value, &covariance),
        })
    }

    /// Tests whether all coordinates together differ by more than a common motion.
    pub fn global(&self) -> Option<Test> {
        let chi2 = self.difference.solve(&self.design(&[]))?.chi2;
        let degrees_of_freedom = self.coordinates.len().checked_sub(self.freedom())?;
        let p_value = crate::statistics::chi_square_survival(chi2, degrees_of_freedom as f64)?;
        Some(Test {
            chi2,
            degrees_of_freedom,
            p_value,
            p_corrected: p_value,
        })
    }
}

/// Value stated in the robot description.
fn stated(run: &Estimate<'_>, id: &ParameterId) -> f64 {
    match *id {
        ParameterId::EntryPoint { cable, axis } => {
            run.robot().cables[cable].pulley.entry_point_m[axis]
        }
        _ => run.robot().laser.map_or(0.0, |l| l.target_plane.offset_m),
    }
}
