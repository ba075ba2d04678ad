//! Static equilibrium of the platform and a tension distribution that satisfies it.
//!
//! Row `i` of the structure matrix `A` holds the free components of `[u_i; (R b_i) x u_i]`, with
//! `u_i` the unit vector from the anchor `B_i` to the exit point: the wrench on the platform, about
//! its origin, per newton of tension. With the applied wrench `w = [m g; (R c) x m g]` (`c` centre of
//! mass in the platform frame) the platform rests where `A^T T + w = 0`.
//!
//! Tensions in N, forces in N, torques in N m about the platform origin, all in base coordinates.
//! Assumptions: massless straight cables, a rigid platform, no friction. Source: Pott,
//! *Cable-Driven Parallel Robots*, 2018, chapter 3.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use crate::geometry::{Pose, Twist, Vec3};
use crate::robot::{Robot, TensionLimits};

use super::KinematicsError;
use super::inverse::LocatedCable;

/// Structure matrix `A` at a pose, one row per cable and one column per free coordinate.
///
/// # Errors
/// Names the first cable that has no path at this pose.
pub fn structure_matrix(robot: &Robot, pose: &Pose) -> Result<DMatrix<f64>, KinematicsError> {
    let freedom = robot.platform.freedom();
    let mut matrix = DMatrix::zeros(robot.cable_count(), freedom.count());
    for (i, cable) in robot.cables.iter().enumerate() {
        let located = LocatedCable::new(cable, pose)?;
        let u = located.toward_exit();
        let torque = located.arm.cross(&u);
        let wrench = Twist::new(u.x, u.y, u.z, torque.x, torque.y, torque.z);
        for (j, coordinate) in freedom.coordinates().iter().enumerate() {
            matrix[(i, j)] = wrench[coordinate.index()];
        }
    }
    Ok(matrix)
}

/// Wrench of gravity on the platform in its free coordinates (N, N m).
///
/// # Errors
/// If the mass is not given.
pub fn applied_wrench(robot: &Robot, pose: &Pose) -> Result<DVector<f64>, KinematicsError> {
    let mass = robot.platform.mass_kg;
    let weight = robot.gravity() * mass.ok_or(KinematicsError::MassNotGiven)?;
    let lever = pose.orientation * Vec3::from(robot.platform.center_of_mass_m);
    let torque = lever.cross(&weight);
    let wrench = [weight.x, weight.y, weight.z, torque.x, torque.y, torque.z];
    let freedom = robot.platform.freedom();
    let free = freedom.coordinates().iter();
    Ok(DVector::from_iterator(
        freedom.count(),
        free.map(|c| wrench[c.index()]),
    ))
}

/// Residual of the static equilibrium at given tensions, `A^T T + w` in the free coordinates (N, N m).
///
/// # Errors
/// If a cable has no path at this pose (naming it), or the mass is not given.
///
/// # Panics
/// If the number of tensions differs from the number of cables.
pub fn equilibrium_residual(
    robot: &Robot,
    pose: &Pose,
    tensions_n: &[f64],
) -> Result<DVector<f64>, KinematicsError> {
    assert_eq!(
        tensions_n.len(),
        robot.cable_count(),
        "one tension per cable"
    );
    let structure = structure_matrix(robot, pose)?;
    let wrench = applied_wrench(robot, pose)?;
    Ok(structure.tr_mul(&DVector::from_column_slice(tensions_n)) + wrench)
}

/// Feasibility of static equilibrium with tensions within the limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feasibility {
    /// The tensions balance the platform to rounding.
    Feasible,
    /// No tensions within the limits balance the platform.
    Infeasible,
}

/// Tensions nearest to a reference that balance the platform, or come as close to balance as possible.
#[derive(Debug, Clone, PartialEq)]
pub struct TensionDistribution {
    /// Feasibility of the equilibrium.
    pub feasibility: Feasibility,
    /// Tension of each cable (N), within its limits.
    pub tensions_n: Vec<f64>,
    /// Residual wrench `A^T T + w` (N, N m).
    pub residual: Vec<f64>,
    /// Number of Newton steps.
    pub iterations: usize,
}

impl TensionDistribution {
    /// Whether the tensions balance the platform.
    #[must_use]
    pub fn balances(&self) -> bool {
        self.feasibility == Feasibility::Feasible
    }
}

/// Largest number of proximal steps; infeasible poses near the border need the most.
const PROXIMAL_STEPS: usize = 60;
/// Largest number of Newton steps within one proximal step.
const NEWTON_STEPS: usize = 60;
/// Curvature added to the dual, relative to columns of `A` of norm 1.
const PROXIMAL_WEIGHT: f64 = 1e-6;
/// Residual wrench that counts as zero, relative to the sum of the wrenches.
const EQUILIBRIUM_TOLERANCE: f64 = 1e-10;

type Vector6 = SVector<f64, 6>;
type Matrix6 = SMatrix<f64, 6, 6>;

/// Minimises `|T - T_ref|^2` subject to `A^T T + w = 0` and `lower <= T <= upper`.
///
/// Solved in the dual: `T(lambda) = clip(T_ref + A lambda)`, and `F(lambda) = A^T T(lambda) + w = 0` is
/// the stationarity of a convex piecewise quadratic function, found by semismooth Newton steps
/// with line search (Qi and Sun 1993). A proximal term `mu/2 |lambda - lambda_k|^2` keeps every step
/// defined where cables are slack, at their limits or too few (Rockafellar 1976); its centres
/// converge to the solution, or diverge along a direction `p` with `max_T p.(A^T T + w) < 0`,
/// which proves infeasibility (Farkas).
///
/// `structure` is `A` (cables x free coordinates, at most 6), the limits may be infinite.
///
/// ```
/// use tautline_core::geometry::Pose;
/// use tautline_core::kinematics::{Feasibility, applied_wrench, distribute_tension, structure_matrix};
/// use tautline_core::robot::presets;
///
/// let robot = presets::find("mini").unwrap().robot;
/// let structure = structure_matrix(&robot, &Pose::identity())?;
/// let wrench = applied_wrench(&robot, &Pose::identity())?;
/// let found = distribute_tension(&structure, &wrench, &[40.0; 8], &[10.0; 8], &[150.0; 8]);
/// assert_eq!(found.feasibility, Feasibility::Feasible);
/// # Ok::<(), tautline_core::kinematics::KinematicsError>(())
/// ```
///
/// # Panics
/// If the numbers of rows, columns, references and limits are inconsistent.
#[must_use]
pub fn distribute_tension(
    structure: &DMatrix<f64>,
    wrench: &DVector<f64>,
    reference_n: &[f64],
    lower_n: &[f64],
    upper_n: &[f64],
) -> TensionDistribution {
    let dual = Dual::new(structure, wrench, reference_n, lower_n, upper_n);
    let mut centre = Vector6::zeros();
    let mut iterations = 0;
    let mut feasibility = Feasibility::Infeasible;
    for _ in 0..PROXIMAL_STEPS {
        let (next, steps) = dual.proximal_step(&centre);
        iterations += steps;
        let residual_wrench = dual.residual_wrench(&next);
        let run = next - centre;
        centre = next;
        if residual_wrench.norm() <= EQUILIBRIUM_TOLERANCE * dual.scale(&next) {
            feasibility = Feasibility::Feasible;
            break;
        }
        if dual.proves_infeasible(&run) {
            break;
        }
    }
    let tensions_n = dual.tensions(&centre);
    let residual = structure.tr_mul(&DVector::from_column_slice(&tensions_n)) + wrench;
    TensionDistribution {
        feasibility,
        tensions_n,
        residual: residual.iter().copied().collect(),
        iterations,
    }
}

/// Tensions within limits that balance the platform at a pose, as close to their reference as possible (N, one per
/// cable); the reference itself where none do.
pub(crate) fn balanced_tension(robot: &Robot, pose: &Pose, limits: &TensionLimits) -> Vec<f64> {
    let all = |value: f64| vec![value; robot.cable_count()];
    let found = structure_matrix(robot, pose).and_then(|structure| {
        let wrench = applied_wrench(robot, pose)?;
        let [reference, lower, upper] =
            [limits.reference_n, limits.lower_n, limits.upper_n].map(all);
        Ok(distribute_tension(
            &structure, &wrench, &reference, &lower, &upper,
        ))
    });
    match found {
        Ok(found) if found.balances() => found.tensions_n,
        _ => all(limits.reference_n),
    }
}

/// Largest number of steps to a pose at rest.
const RESTING_STEPS: usize = 50;
/// Longest step to it, as the norm of a twist (m, rad).
const RESTING_STEP: f64 = 0.2;
/// Singular value that counts as zero, relative to the largest.
const RANK_TOLERANCE: f64 = 1e-9;
/// Difference for the derivative of the wrench by the pose (m, rad).
const DIFFERENCE: f64 = 1e-6;

/// The pose near `pose`, with the tensions (N), at which a platform with fewer cables than free coordinates hangs at rest: gravity
/// turns it until the cables balance it, which they do only at such poses. The steps are Gauss-Newton ones of least norm for the
/// wrench that is left by the tensions that balance it best. `None` if no stable equilibrium is near: it is stable if no motion
/// that keeps the lengths lowers the energy.
///
/// # Errors
/// If a cable has no path on the way (naming it), or the mass is not given.
pub(crate) fn resting_pose(
    robot: &Robot,
    pose: &Pose,
) -> Result<Option<(Pose, Vec<f64>)>, KinematicsError> {
    let freedom = robot.platform.freedom();
    let coordinates = freedom.count();
    let moved = |pose: &Pose, step: &[f64]| pose.perturbed(&freedom.expand(step));
    let mut pose = *pose;
    for _ in 0..RESTING_STEPS {
        let structure = structure_matrix(robot, &pose)?;
        let weight = applied_wrench(robot, &pose)?;
        let Ok(inverse) = structure.transpose().pseudo_inverse(RANK_TOLERANCE) else {
            return Ok(None);
        };
        let tensions: Vec<f64> = (-(&inverse * &weight)).iter().copied().collect();
        let at = |step: &[f64]| equilibrium_residual(robot, &moved(&pose, step), &tensions);
        let mut step = vec![0.0; coordinates];
        let wrench = at(&step)?;
        let mut by_pose = DMatrix::zeros(coordinates, coordinates);
        for axis in 0..coordinates {
            step[axis] = DIFFERENCE;
            let beyond = at(&step)?;
            step[axis] = -DIFFERENCE;
            let slope = (beyond - at(&step)?) / (2.0 * DIFFERENCE);
            by_pose.set_column(axis, &slope);
            step[axis] = 0.0;
        }
        if wrench.norm() <= 0.01 * EQUILIBRIUM_TOLERANCE * weight.norm() {
            return Ok(is_stable(&structure, &by_pose).then_some((pose, tensions)));
        }
        let unbalanced = &by_pose - structure.transpose() * (inverse * &by_pose);
        // A turn about a point in which all cables meet changes nothing.
        let least = RANK_TOLERANCE * by_pose.norm();
        let Ok(step) = unbalanced.svd(true, true).solve(&-wrench, least) else {
            return Ok(None);
        };
        let step = &step * (RESTING_STEP / step.norm()).min(1.0);
        pose = moved(&pose, step.as_slice());
    }
    Ok(None)
}

/// Whether no motion that keeps the lengths lowers the energy, whose second derivative is `-dF/dx` of the wrench `F`.
fn is_stable(structure: &DMatrix<f64>, wrench_by_pose: &DMatrix<f64>) -> bool {
    let constraints = structure.tr_mul(structure).symmetric_eigen();
    let largest = constraints.eigenvalues.amax();
    let is_free = |k: &usize| constraints.eigenvalues[*k] < RANK_TOLERANCE * largest;
    let free: Vec<usize> = (0..structure.ncols()).filter(is_free).collect();
    let motions = constraints.eigenvectors.select_columns(&free);
    let stiffness = motions.tr_mul(&(wrench_by_pose * -&motions));
    let stiffness = (&stiffness + stiffness.transpose()) * 0.5;
    let least = -RANK_TOLERANCE.sqrt() * wrench_by_pose.norm();
    stiffness
        .symmetric_eigenvalues()
        .iter()
        .all(|own| *own >= least)
}

/// The dual problem, with columns of `A` scaled to norm 1 and padded to six coordinates.
struct Dual<'a> {
    rows: Vec<Vector6>,
    wrench: Vector6,
    reference: &'a [f64],
    lower: &'a [f64],
    upper: &'a [f64],
}

impl<'a> Dual<'a> {
    fn new(
        structure: &DMatrix<f64>,
        wrench: &DVector<f64>,
        reference: &'a [f64],
        lower: &'a [f64],
        upper: &'a [f64],
    ) -> Self {
        let (cables, coordinates) = structure.shape();
        assert!(coordinates <= 6 && wrench.len() == coordinates);
        assert!(reference.len() == cables && lower.len() == cables && upper.len() == cables);
        let mut scale = Vector6::repeat(1.0);
        for (j, column) in structure.column_iter().enumerate() {
            let norm = column.norm();
            // A coordinate that no cable acts on keeps its unit.
            scale[j] = if norm > 1e-12 { 1.0 / norm } else { 1.0 };
        }
        let padded = |get: &dyn Fn(usize) -> f64| {
            Vector6::from_fn(|j, _| {
                if j < coordinates {
                    get(j) * scale[j]
                } else {
                    0.0
                }
            })
        };
        Self {
            rows: (0..cables)
                .map(|i| padded(&|j| structure[(i, j)]))
                .collect(),
            wrench: padded(&|j| wrench[j]),
            reference,
            lower,
            upper,
        }
    }

    /// `T(lambda)` of one cable, and whether it is strictly between its limits.
    fn tension(&self, i: usize, lambda: &Vector6) -> (f64, bool) {
        let wanted = self.reference[i] + self.rows[i].dot(lambda);
        let tension = wanted.min(self.upper[i]).max(self.lower[i]);
        (tension, tension == wanted)
    }

    fn tensions(&self, lambda: &Vector6) -> Vec<f64> {
        let cables = 0..self.rows.len();
        cables.map(|i| self.tension(i, lambda).0).collect()
    }

    /// `F(lambda) = A^T T(lambda) + w`, scaled.
    fn residual_wrench(&self, lambda: &Vector6) -> Vector6 {
        let rows = self.rows.iter().enumerate();
        rows.fold(self.wrench, |sum, (i, row)| {
            sum + row * self.tension(i, lambda).0
        })
    }

    /// Sum of the magnitudes of all wrenches.
    fn scale(&self, lambda: &Vector6) -> f64 {
        let rows = self.rows.iter().enumerate();
        rows.fold(self.wrench.norm(), |sum, (i, row)| {
            sum + row.norm() * self.tension(i, lambda).0.abs()
        })
    }

    /// Negative of the dual function plus the proximal term.
    fn merit(&self, lambda: &Vector6, centre: &Vector6) -> f64 {
        let proximal = 0.5 * PROXIMAL_WEIGHT * (lambda - centre).norm_squared();
        let rows = self.rows.iter().enumerate();
        rows.fold(proximal + lambda.dot(&self.wrench), |sum, (i, row)| {
            let tension = self.tension(i, lambda).0;
            let off = tension - self.reference[i];
            sum + tension * row.dot(lambda) - 0.5 * off * off
        })
    }

    fn curvature(&self, lambda: &Vector6) -> Matrix6 {
        let mut sum = Matrix6::identity() * PROXIMAL_WEIGHT;
        for (i, row) in self.rows.iter().enumerate() {
            if self.tension(i, lambda).1 {
                sum += row * row.transpose();
            }
        }
        sum
    }

    /// Minimiser of the dual with the proximal term about `centre`, and the number of Newton steps.
    fn proximal_step(&self, centre: &Vector6) -> (Vector6, usize) {
        let mut lambda = *centre;
        for taken in 0..NEWTON_STEPS {
            let gradient = self.residual_wrench(&lambda) + (lambda - centre) * PROXIMAL_WEIGHT;
            if gradient.norm() <= 0.1 * EQUILIBRIUM_TOLERANCE * self.scale(&lambda) {
                return (lambda, taken);
            }
            let Some(factor) = self.curvature(&lambda).cholesky() else {
                return (lambda, taken);
            };
            let step = -factor.solve(&gradient);
            let Some(length) = self.line_search(&lambda, centre, &step, gradient.dot(&step)) else {
                return (lambda, taken);
            };
            lambda += step * length;
        }
        (lambda, NEWTON_STEPS)
    }

    /// Step length with sufficient decrease (Armijo); `None` where rounding hides any decrease.
    fn line_search(
        &self,
        lambda: &Vector6,
        centre: &Vector6,
        step: &Vector6,
        slope: f64,
    ) -> Option<f64> {
        let before = self.merit(lambda, centre);
        let rounding = 1e-15 * before.abs();
        let mut length = 1.0;
        for _ in 0..40 {
            let after = self.merit(&(lambda + step * length), centre);
            if after <= before + 1e-4 * length * slope + rounding {
                return Some(length);
            }
            length *= 0.5;
        }
        None
    }

    /// Whether every admissible tension leaves a wrench component against `direction`.
    fn proves_infeasible(&self, direction: &Vector6) -> bool {
        let norm = direction.norm();
        if norm == 0.0 {
            return false;
        }
        let p = direction / norm;
        let mut most = p.dot(&self.wrench);
        let mut scale = self.wrench.norm();
        for (i, row) in self.rows.iter().enumerate() {
            let along = row.dot(&p);
            // Infinite limits would give NaN for cables normal to the direction.
            if along != 0.0 {
                let tension = if along > 0.0 {
                    self.upper[i]
                } else {
                    self.lower[i]
                };
                most += along * tension;
                scale += (along * tension).abs();
            }
        }
        let against = if most < 0.0 { -most } else { 0.0 };
        against > EQUILIBRIUM_TOLERANCE * scale
    }
}

#[cfg(test)]
mod tests {
    use super::super::length_gradients;
    use super::super::samples::{self, PlatformKind};
    use super::*;
    use crate::geometry::Coordinate;
    use rand::RngExt;

    /// The optimum by enumeration: every cable is "at the lower limit", "at the upper limit" or "free".
    /// The optimum is the stationary point of one of these choices, hence the best admissible one.
    fn by_enumeration(
        structure: &DMatrix<f64>,
        wrench: &DVector<f64>,
        reference: &[f64],
        lower: f64,
        upper: f64,
    ) -> Option<(f64, Vec<f64>)> {
        let m = reference.len();
        let mut best: Option<(f64, Vec<f64>)> = None;
        for code in 0..3_usize.pow(m as u32) {
            let choice: Vec<usize> = (0..m).map(|i| code / 3_usize.pow(i as u32) % 3).collect();
            let mut tensions: Vec<f64> = (0..m)
                .map(|i| [lower, upper, reference[i]][choice[i]])
                .collect();
            let mut free = structure.clone();
            for i in (0..m).filter(|i| choice[*i] != 2) {
                free.row_mut(i).fill(0.0);
            }
            let rest = structure.tr_mul(&DVector::from_vec(tensions.clone())) + wrench;
            let normal = free.tr_mul(&free);
            let Ok(lambda) = normal.svd(true, true).solve(&-rest, 1e-10) else {
                continue;
            };
            let change = free * lambda;
            for i in 0..m {
                tensions[i] += change[i];
            }
            let left = structure.tr_mul(&DVector::from_vec(tensions.clone())) + wrench;
            let inside = tensions
                .iter()
                .all(|t| (lower - 1e-9..upper + 1e-9).contains(t));
            if left.norm() > 1e-8 || !inside {
                continue;
            }
            let pairs = tensions.iter().zip(reference);
            let distance: f64 = pairs.map(|(t, r)| (t - r).powi(2)).sum();
            if best.as_ref().is_none_or(|(d, _)| distance < *d) {
                best = Some((distance, tensions));
            }
        }
        best
    }

    /// Compares with the enumeration; returns whether the pose was feasible.
    fn check(robot: &Robot, pose: &Pose, lower: f64, upper: f64) -> bool {
        let structure = structure_matrix(robot, pose).unwrap();
        let wrench = applied_wrench(robot, pose).unwrap();
        let m = robot.cable_count();
        let reference: Vec<f64> = (0..m).map(|i| 20.0 + i as f64).collect();
        let (lo, hi) = (vec![lower; m], vec![upper; m]);
        let result = distribute_tension(&structure, &wrench, &reference, &lo, &hi);
        let best = by_enumeration(&structure, &wrench, &reference, lower, upper);
        let feasible = result.feasibility == Feasibility::Feasible;
        assert_eq!(feasible, best.is_some(), "{:?}", result.residual);
        assert!(
            result
                .tensions_n
                .iter()
                .all(|t| (lower..=upper).contains(t))
        );
        if let Some((_, tensions)) = best {
            for (a, b) in result.tensions_n.iter().zip(&tensions) {
                assert!((a - b).abs() < 1e-6, "{a} {b}");
            }
            let residual = equilibrium_residual(robot, pose, &result.tensions_n).unwrap();
            assert!(residual.norm() < 1e-7, "{}", residual.norm());
        }
        feasible
    }

    #[test]
    fn structure_matrix_is_minus_the_length_gradient() {
        let mut rng = samples::generator(21);
        for kind in [
            PlatformKind::Spatial,
            PlatformKind::Planar,
            PlatformKind::PointMass,
        ] {
            let robot = samples::of_kind(kind, 0.02);
            let twist = Twist::from_fn(|_, _| rng.random_range(-0.1..0.1));
            let pose = Pose::identity().perturbed(&twist);
            let structure = structure_matrix(&robot, &pose).unwrap();
            for (i, gradient) in length_gradients(&robot, &pose).unwrap().iter().enumerate() {
                for (j, slope) in gradient.pose_free(&robot).iter().enumerate() {
                    assert_eq!(structure[(i, j)], -slope);
                }
            }
        }
    }

    #[test]
    fn distribution_is_the_enumerated_optimum() {
        use Coordinate::{Rz, X, Y, Z};
        let mut rng = samples::generator(22);
        let (mut feasible, mut infeasible) = (0, 0);
        for round in 0..240 {
            let count = 1 + round % 7;
            let free: &[Coordinate] =
                [&[X, Y][..], &[X, Y, Z], &[X, Y, Rz], &Coordinate::ALL][rng.random_range(0..4)];
            let (robot, pose) = samples::anywhere(&mut rng, free, count);
            if check(&robot, &pose, 2.0, 80.0) {
                feasible += 1;
            } else {
                infeasible += 1;
            }
        }
        assert!(
            feasible >= 40 && infeasible >= 40,
            "{feasible} {infeasible}"
        );
    }

    #[test]
    fn eight_cable_robot_is_balanced_where_enumeration_says_so() {
        let mut rng = samples::generator(23);
        let mut feasible = 0;
        let robot = samples::spatial(0.018);
        for _ in 0..10 {
            let twist = Twist::from_fn(|k, _| rng.random_range(-0.2..0.2) * [1.0, 2.0][k / 3]);
            let pose = Pose::identity().perturbed(&twist);
            feasible += usize::from(check(&robot, &pose, 5.0, 60.0));
        }
        assert!((1..10).contains(&feasible), "{feasible}");
    }

    /// The equilibrium is lower than its neighbours with the same lengths of two cables.
    #[test]
    fn a_bar_on_two_cables_comes_to_rest_at_its_lowest_pose() {
        let free = [Coordinate::X, Coordinate::Z, Coordinate::Ry];
        let mut rng = samples::generator(24);
        let mut checked = 0;
        for _ in 0..40 {
            let (mut robot, start) = samples::anywhere(&mut rng, &free, 2);
            for (cable, side) in robot.cables.iter_mut().zip([-1.0, 1.0]) {
                cable.pulley.entry_point_m = [side * rng.random_range(1.0..2.0), 0.0, 2.0];
                cable.pulley.radius_m = 0.0;
                cable.platform_anchor_m = [side * 0.3, 0.0, 0.1];
            }
            robot.platform.center_of_mass_m = [rng.random_range(-0.1..0.1), 0.0, -0.1];
            let start = Pose {
                position: Vec3::new(rng.random_range(-0.5..0.5), 0.0, 0.0),
                ..start
            };
            let Some((rest, _)) = resting_pose(&robot, &start).unwrap() else {
                continue;
            };
            let lengths = |pose: &Pose| -> Vec<f64> {
                let states = super::super::inverse_kinematics(&robot, pose).unwrap();
                states.iter().map(|state| state.length_m).collect()
            };
            let height = |pose: &Pose| pose.transform(&robot.platform.center_of_mass_m.into()).z;
            let kept = lengths(&rest);
            // Poses with the same lengths, turned by a little: Newton steps on x and z.
            for turn in [-0.02, -0.01, 0.01, 0.02] {
                let mut near = rest.perturbed(&Twist::new(0.0, 0.0, 0.0, 0.0, turn, 0.0));
                for _ in 0..20 {
                    let slopes = structure_matrix(&robot, &near).unwrap();
                    let off: Vec<f64> = lengths(&near)
                        .iter()
                        .zip(&kept)
                        .map(|(a, b)| a - b)
                        .collect();
                    let step = slopes
                        .columns(0, 2)
                        .into_owned()
                        .lu()
                        .solve(&DVector::from_vec(off));
                    let step = step.unwrap();
                    near = near.perturbed(&Twist::new(step[0], 0.0, step[1], 0.0, 0.0, 0.0));
                }
                assert!(height(&near) > height(&rest), "{turn}");
            }
            checked += 1;
        }
        assert!(checked >= 20, "{checked}");
    }

    #[test]
    fn without_cables_only_no_wrench_is_feasible() {
        let none = DMatrix::zeros(0, 3);
        let wrench = DVector::from_column_slice(&[0.0, 0.0, -9.8]);
        let result = distribute_tension(&none, &wrench, &[], &[], &[]);
        assert_eq!(result.feasibility, Feasibility::Infeasible);
        let result = distribute_tension(&none, &DVector::zeros(3), &[], &[], &[]);
        assert_eq!(result.feasibility, Feasibility::Feasible);
    }

    #[test]
    fn without_limits_it_is_the_least_norm_correction() {
        let robot = samples::spatial(0.018);
        let pose = Pose::from_parts([0.05, -0.02, 0.1], [0.99, 0.02, 0.03, -0.05]);
        let structure = structure_matrix(&robot, &pose).unwrap();
        let wrench = applied_wrench(&robot, &pose).unwrap();
        let (reference, infinite) = (vec![30.0; 8], vec![f64::INFINITY; 8]);
        let minus: Vec<f64> = infinite.iter().map(|v| -v).collect();
        let result = distribute_tension(&structure, &wrench, &reference, &minus, &infinite);
        assert_eq!(result.feasibility, Feasibility::Feasible);
        let rest = structure.tr_mul(&DVector::from_column_slice(&reference)) + &wrench;
        let lambda = structure
            .tr_mul(&structure)
            .cholesky()
            .unwrap()
            .solve(&-rest);
        let change = &structure * lambda;
        for i in 0..8 {
            assert!((result.tensions_n[i] - reference[i] - change[i]).abs() < 1e-8);
        }
    }

    #[test]
    fn missing_mass_is_said() {
        let mut robot = samples::spatial(0.018);
        robot.platform.mass_kg = None;
        let error = applied_wrench(&robot, &Pose::identity()).unwrap_err();
        assert_eq!(error.to_string(), "the mass of the platform is not given");
    }
}
