//! Rank defects: parameters that the data leave undetermined, described in words.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::parameter::ParameterId;
use super::problem::Problem;
use super::solution::Solution;
use crate::geometry::{Coordinate, Vec3};
use crate::tolerances::OPEN_EIGENVALUE;

/// Largest component of a motion outside the undetermined subspace at which the motion counts as undetermined.
const OUTSIDE: f64 = 1e-3;

/// A direction in parameter space that readings and priors do not determine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RankDefect {
    /// Sentence for the operator: the undetermined quantity, and the data or description to provide.
    pub sentence: String,
}

/// Finds the directions that readings and priors leave undetermined. Empty if there are none.
#[must_use]
pub fn rank_defects(problem: &Problem<'_>, solution: &Solution) -> Vec<RankDefect> {
    let mut found = Vec::new();
    if solution.undetermined_coordinates > 0 {
        found.push(RankDefect {
            sentence: format!(
                "the readings leave {} pose coordinates undetermined: measure more cables or state a pose there",
                solution.undetermined_coordinates
            ),
        });
    }
    if solution.covariance.is_some() || solution.parameters.is_empty() {
        return found;
    }
    let scale = solution.information.diagonal().map(f64::sqrt);
    let untouched: Vec<usize> = (0..scale.len()).filter(|k| scale[*k] == 0.0).collect();
    for k in &untouched {
        found.push(RankDefect {
            sentence: format!(
                "no reading depends on {}: state its value",
                solution.parameters[*k].name
            ),
        });
    }
    if scale.iter().any(|s| !s.is_finite()) {
        return found;
    }
    let all = open_directions(&solution.information, &scale);
    // The directions that no rigid motion has explained so far.
    let mut open = all.clone();
    for (name, motion) in motions(problem, solution) {
        let scaled = motion.component_mul(&scale);
        let size = scaled.norm_squared();
        let outside = size - all.tr_mul(&scaled).norm_squared();
        let inside = open.tr_mul(&scaled);
        let is_new = inside.norm_squared() > OUTSIDE * size;
        if size > 0.0 && outside < OUTSIDE * size && is_new {
            found.push(RankDefect {
                sentence: format!("the data do not determine {name}: state one coordinate"),
            });
            open = without(&open, &inside);
        }
    }
    for column in open.column_iter() {
        if !untouched.iter().any(|k| column[*k].abs() > 0.5) {
            found.push(mixed(solution, &column.into_owned()));
        }
    }
    found
}

/// Orthonormal basis of the undetermined directions of the scaled parameters, as columns.
fn open_directions(information: &DMatrix<f64>, scale: &DVector<f64>) -> DMatrix<f64> {
    let n = scale.len();
    let scaled = DMatrix::from_fn(n, n, |i, k| {
        let product = scale[i] * scale[k];
        if product > 0.0 {
            information[(i, k)] / product
        } else {
            0.0
        }
    });
    let eigen = SymmetricEigen::new(scaled);
    let largest = eigen.eigenvalues.max();
    let columns: Vec<_> = (0..n)
        .filter(|k| eigen.eigenvalues[*k] < OPEN_EIGENVALUE * largest)
        .map(|k| eigen.eigenvectors.column(k).into_owned())
        .collect();
    if columns.is_empty() {
        return DMatrix::zeros(n, 0);
    }
    DMatrix::from_columns(&columns)
}

/// Basis of the columns of `open` without the direction `open * inside`.
fn without(open: &DMatrix<f64>, inside: &DVector<f64>) -> DMatrix<f64> {
    let n = inside.len();
    let projector = DMatrix::identity(n, n) - inside * inside.transpose() / inside.norm_squared();
    let eigen = SymmetricEigen::new(projector);
    let columns: Vec<_> = (0..n)
        .filter(|k| eigen.eigenvalues[*k] > 0.5)
        .map(|k| open * eigen.eigenvectors.column(k))
        .collect();
    if columns.is_empty() {
        return DMatrix::zeros(open.nrows(), 0);
    }
    DMatrix::from_columns(&columns)
}

/// Rigid motions of the whole robot, and a common scale.
fn motions(problem: &Problem<'_>, solution: &Solution) -> Vec<(String, DVector<f64>)> {
    let mut motions = Vec::new();
    for (k, axis) in ["x", "y", "z"].iter().enumerate() {
        let unit = Vec3::ith(k, 1.0);
        let shift = generator(problem, solution, &|_| unit, &Vec3::zeros());
        motions.push((format!("a shift along {axis}"), shift));
        let turn = generator(problem, solution, &|p| unit.cross(&p), &unit);
        motions.push((format!("a rotation about {axis}"), turn));
    }
    let mut scale = generator(problem, solution, &|p| p, &Vec3::zeros());
    for (k, parameter) in solution.parameters.iter().enumerate() {
        if let ParameterId::Effect { effect, .. } = parameter.id {
            let id = problem.free_effects[effect].effect.id();
            scale[k] = f64::from(u8::from(
                id.starts_with("winch_scale") || id == "laser_scale",
            ));
        }
    }
    motions.push(("a common scale of all lengths".to_owned(), scale));
    motions
}

/// Change of the parameters when every point moves by `displace` and the platform rotates by `turn`.
fn generator(
    problem: &Problem<'_>,
    solution: &Solution,
    displace: &dyn Fn(Vec3) -> Vec3,
    turn: &Vec3,
) -> DVector<f64> {
    let globals = &solution.globals;
    let normal = problem
        .dataset
        .robot
        .laser
        .map_or(Vec3::zeros(), |l| l.target_plane.normal.into());
    let home = displace(globals.home.position);
    let component = |id: &ParameterId| match *id {
        ParameterId::EntryPoint { cable, axis } => {
            displace(globals.entry_points[cable].into())[axis]
        }
        ParameterId::PlaneOffset => normal.dot(&displace(normal * globals.plane_offset_m)),
        ParameterId::Home(Coordinate::Rx) => turn.x,
        ParameterId::Home(Coordinate::Ry) => turn.y,
        ParameterId::Home(Coordinate::Rz) => turn.z,
        ParameterId::Home(coordinate) => home[coordinate.index()],
        ParameterId::HomeTension { .. }
        | ParameterId::Effect { .. }
        | ParameterId::Deviation { .. } => 0.0,
    };
    DVector::from_iterator(
        solution.parameters.len(),
        solution.parameters.iter().map(|p| component(&p.id)),
    )
}

/// A direction that is not a rigid motion: name the parameters with the largest components.
fn mixed(solution: &Solution, direction: &DVector<f64>) -> RankDefect {
    let mut order: Vec<usize> = (0..direction.len()).collect();
    order.sort_by(|a, b| direction[*b].abs().total_cmp(&direction[*a].abs()));
    let largest = direction[order[0]].abs();
    let names: Vec<&str> = order
        .iter()
        .take(3)
        .filter(|k| direction[**k].abs() > 0.3 * largest)
        .map(|k| solution.parameters[*k].name.as_str())
        .collect();
    RankDefect {
        sentence: format!(
            "the data cannot separate {}: state one of them",
            names.join(", ")
        ),
    }
}
