//! Accuracy figures of ISO 9283 from commanded and attained poses.
//!
//! For one commanded position `p_c` and positions `p_k` attained in `n` cycles with barycentre `pbar`:
//! accuracy `AP = |pbar - p_c|`; with `l_k = |p_k - pbar|`, its mean `lbar` and standard deviation
//! `S_l = sqrt(sum (l_k - lbar)^2 / (n - 1))`, repeatability `RP = lbar + 3 S_l` (m). For each angle: accuracy
//! `AP_a = abar - a_c`, repeatability `RP_a = 3 S_a` (rad). Along a path, the same at each of `m` points, with
//! `AT = max_i |pbar_i - p_ci|` and `RT = max_i (lbar_i + 3 S_li)`; angles likewise.
//!
//! Angles are the components of the rotation vector from the commanded to the attained
//! orientation, in base coordinates: for the small deviations of a robot these are the deviations
//! of the standard's angles about the base axes, without their singular orientations.
//! Source: ISO 9283:1998, sections 7.2, 8.2 and 8.3.

use crate::geometry::{Pose, Vec3};

/// A commanded pose and the poses attained, one per cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Commanded pose.
    pub commanded: Pose,
    /// Attained poses, in the order of the cycles.
    pub attained: Vec<Pose>,
}

/// Errors of [`pose_accuracy`] and [`path_accuracy`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AccuracyError {
    /// There is no target.
    #[error("no commanded pose")]
    NoTarget,
    /// A target was never attained.
    #[error("target {target} has no attained pose")]
    NoCycle {
        /// Index of the target, from 0.
        target: usize,
    },
    /// A coordinate is not a finite number.
    #[error("target {target} has a coordinate that is not a finite number")]
    NotFinite {
        /// Index of the target, from 0.
        target: usize,
    },
    /// The points of a path do not all have the same number of cycles.
    #[error("point {point} of the path has {found} cycles, the first has {expected}")]
    UnequalCycles {
        /// Index of the point, from 0.
        point: usize,
        /// Its number of cycles.
        found: usize,
        /// Number of cycles of the first point.
        expected: usize,
    },
}

/// Accuracy and repeatability at one commanded pose.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseFigures {
    /// Number of cycles `n`.
    pub cycles: usize,
    /// Barycentre of the attained positions (m).
    pub barycentre_m: Vec3,
    /// Position accuracy `AP` (m).
    pub accuracy_m: f64,
    /// Deviation of the barycentre from the commanded position, base frame (m).
    pub deviation_m: Vec3,
    /// Position repeatability `RP` (m); `None` with fewer than two cycles.
    pub repeatability_m: Option<f64>,
    /// Orientation accuracy about the base axes x, y, z, signed (rad).
    pub angle_accuracy_rad: [f64; 3],
    /// Orientation repeatability about the base axes (rad); `None` with fewer than two cycles.
    pub angle_repeatability_rad: Option<[f64; 3]>,
}

/// Accuracy and repeatability at several commanded poses.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseSummary {
    /// Figures of each target.
    pub targets: Vec<PoseFigures>,
    /// Largest position accuracy figure (m).
    pub largest_accuracy_m: f64,
    /// Mean of the position accuracy figures (m).
    pub mean_accuracy_m: f64,
    /// Largest position repeatability (m); `None` if any target has fewer than two cycles.
    pub largest_repeatability_m: Option<f64>,
    /// Mean position repeatability (m); `None` if any target has fewer than two cycles.
    pub mean_repeatability_m: Option<f64>,
    /// Largest orientation accuracy figures, without sign (rad).
    pub largest_angle_accuracy_rad: [f64; 3],
    /// Largest orientation repeatability (rad); `None` if any target has fewer than two cycles.
    pub largest_angle_repeatability_rad: Option<[f64; 3]>,
}

/// Accuracy and repeatability along a path traversed several times.
#[derive(Debug, Clone, PartialEq)]
pub struct PathFigures {
    /// Number of cycles `n`.
    pub cycles: usize,
    /// Figures at each point of the path.
    pub points: Vec<PoseFigures>,
    /// Path accuracy `AT` (m).
    pub accuracy_m: f64,
    /// Path repeatability `RT` (m); `None` with fewer than two cycles.
    pub repeatability_m: Option<f64>,
    /// Orientation path accuracy about the base axes, without sign (rad).
    pub angle_accuracy_rad: [f64; 3],
    /// Orientation path repeatability (rad); `None` with fewer than two cycles.
    pub angle_repeatability_rad: Option<[f64; 3]>,
}

/// Computes the figures of each target and summarises them over all targets.
///
/// ```
/// use tautline_core::accuracy::iso9283::{Target, pose_accuracy};
/// use tautline_core::geometry::Pose;
///
/// let at = |x_m: f64| Pose::from_parts([x_m, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]);
/// let target = Target {
///     commanded: at(0.0),
///     attained: vec![at(1e-3), at(3e-3)],
/// };
/// let figures = pose_accuracy(&[target])?;
/// assert!((figures.mean_accuracy_m - 2e-3).abs() < 1e-12);
/// # Ok::<(), tautline_core::accuracy::iso9283::AccuracyError>(())
/// ```
///
/// # Errors
/// If there is no target, or one without attained poses or with numbers that are not finite.
pub fn pose_accuracy(targets: &[Target]) -> Result<PoseSummary, AccuracyError> {
    if targets.is_empty() {
        return Err(AccuracyError::NoTarget);
    }
    let figures = targets.iter().enumerate().map(|(i, t)| figures(i, t));
    let targets = figures.collect::<Result<Vec<_>, _>>()?;
    let accuracies = targets.iter().map(|f| f.accuracy_m);
    let repeatabilities: Option<Vec<f64>> = targets.iter().map(|f| f.repeatability_m).collect();
    Ok(PoseSummary {
        largest_accuracy_m: largest(accuracies.clone()),
        mean_accuracy_m: mean(&accuracies.collect::<Vec<_>>()),
        largest_repeatability_m: repeatabilities.as_ref().map(|v| largest(v.iter().copied())),
        mean_repeatability_m: repeatabilities.as_deref().map(mean),
        largest_angle_accuracy_rad: largest_angle_accuracy(&targets),
        largest_angle_repeatability_rad: largest_angle_repeatability(&targets),
        targets,
    })
}

/// Computes the figures of a path sampled at the same points in every cycle.
///
/// The standard takes the points where the path crosses planes normal to the commanded path; samples at equal
/// times serve as well. Choosing the points is left to the caller.
/// # Errors
/// As [`pose_accuracy`], and if the points have different numbers of cycles.
pub fn path_accuracy(points: &[Target]) -> Result<PathFigures, AccuracyError> {
    let expected = points.first().map_or(0, |point| point.attained.len());
    for (point, target) in points.iter().enumerate() {
        let found = target.attained.len();
        if found != expected {
            return Err(AccuracyError::UnequalCycles {
                point,
                found,
                expected,
            });
        }
    }
    let summary = pose_accuracy(points)?;
    Ok(PathFigures {
        cycles: expected,
        accuracy_m: summary.largest_accuracy_m,
        repeatability_m: summary.largest_repeatability_m,
        angle_accuracy_rad: summary.largest_angle_accuracy_rad,
        angle_repeatability_rad: summary.largest_angle_repeatability_rad,
        points: summary.targets,
    })
}

fn figures(index: usize, target: &Target) -> Result<PoseFigures, AccuracyError> {
    check(index, target)?;
    let n = target.attained.len();
    let sum: Vec3 = target.attained.iter().map(|pose| pose.position).sum();
    let barycentre = sum / n as f64;
    let spread: Vec<f64> = target
        .attained
        .iter()
        .map(|pose| (pose.position - barycentre).norm())
        .collect();
    let angles: [Vec<f64>; 3] = std::array::from_fn(|axis| {
        let attained = target.attained.iter();
        let turned = attained.map(|pose| pose.difference(&target.commanded)[3 + axis]);
        turned.collect()
    });
    let deviation = barycentre - target.commanded.position;
    let repeatable = n >= 2;
    Ok(PoseFigures {
        cycles: n,
        barycentre_m: barycentre,
        accuracy_m: deviation.norm(),
        deviation_m: deviation,
        repeatability_m: repeatable.then(|| mean(&spread) + 3.0 * standard_deviation(&spread)),
        angle_accuracy_rad: angles.each_ref().map(|angle| mean(angle)),
        angle_repeatability_rad: repeatable.then(|| {
            angles
                .each_ref()
                .map(|angle| 3.0 * standard_deviation(angle))
        }),
    })
}

fn check(target: usize, poses: &Target) -> Result<(), AccuracyError> {
    if poses.attained.is_empty() {
        return Err(AccuracyError::NoCycle { target });
    }
    let finite = |pose: &Pose| {
        let numbers = pose.position.iter().chain(&pose.orientation.coords);
        numbers.into_iter().all(|v| v.is_finite())
    };
    if finite(&poses.commanded) && poses.attained.iter().all(finite) {
        return Ok(());
    }
    Err(AccuracyError::NotFinite { target })
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Sample standard deviation with `n - 1` in the denominator, as in the standard; needs at least two values.
fn standard_deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    let sum: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    (sum / (values.len() - 1) as f64).sqrt()
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

fn largest_angle_accuracy(targets: &[PoseFigures]) -> [f64; 3] {
    let of_axis = |axis: usize| {
        targets
            .iter()
            .map(move |f| f.angle_accuracy_rad[axis].abs())
    };
    std::array::from_fn(|axis| largest(of_axis(axis)))
}

fn largest_angle_repeatability(targets: &[PoseFigures]) -> Option<[f64; 3]> {
    let all = targets.iter().map(|f| f.angle_repeatability_rad);
    let all: Vec<[f64; 3]> = all.collect::<Option<_>>()?;
    let of_axis = |axis: usize| all.iter().map(move |angles| angles[axis]);
    Some(std::array::from_fn(|axis| largest(of_axis(axis))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Twist;

    fn at(x: f64, y: f64, z: f64) -> Pose {
        Pose::from_parts([x, y, z], [1.0, 0.0, 0.0, 0.0])
    }

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-14, "{a} {b}");
    }

    #[test]
    fn figures_by_hand() {
        // Attained at x = 1, 3, 5, 7 mm: barycentre 4 mm, l = 3, 1, 1, 3 mm, lbar = 2 mm,
        // S_l = sqrt(4/3) mm. Commanded (1, 4, 0) mm: AP = |(3, -4, 0)| mm = 5 mm.
        let target = Target {
            commanded: at(1e-3, 4e-3, 0.0),
            attained: [1e-3, 3e-3, 5e-3, 7e-3].map(|x| at(x, 0.0, 0.0)).to_vec(),
        };
        let summary = pose_accuracy(&[target]).unwrap();
        let figures = &summary.targets[0];
        near(figures.accuracy_m, 5e-3);
        let repeatability = 2e-3 + 3.0 * (4.0_f64 / 3.0).sqrt() * 1e-3;
        near(figures.repeatability_m.unwrap(), repeatability);
        near(summary.mean_repeatability_m.unwrap(), repeatability);
        assert!((figures.deviation_m - Vec3::new(3e-3, -4e-3, 0.0)).norm() < 1e-15);
        assert_eq!(figures.angle_repeatability_rad, Some([0.0; 3]));
    }

    #[test]
    fn angles_by_hand() {
        // Turned about z by 1, 2, 3 and 6 mrad from a turned command: mean 3 mrad,
        // S = sqrt((4 + 1 + 0 + 9)/3) mrad.
        let commanded = Pose::from_parts([0.1, 0.2, 0.3], [0.8, 0.2, -0.4, 0.4]);
        let turned = [1e-3, 2e-3, 3e-3, 6e-3].map(|angle| {
            let twist = Twist::new(0.0, 0.0, 0.0, 0.0, 0.0, angle);
            commanded.perturbed(&twist)
        });
        let target = Target {
            commanded,
            attained: turned.to_vec(),
        };
        let summary = pose_accuracy(&[target]).unwrap();
        near(summary.largest_angle_accuracy_rad[2], 3e-3);
        near(summary.largest_angle_accuracy_rad[0], 0.0);
        let repeatability = summary.largest_angle_repeatability_rad.unwrap();
        near(repeatability[2], 3.0 * (14.0_f64 / 3.0).sqrt() * 1e-3);
        near(summary.largest_repeatability_m.unwrap(), 0.0);
    }

    #[test]
    fn path_takes_the_worst_point() {
        // Point 0: barycentre 1 mm off, both cycles 1 mm from it. Point 1: 2 mm off, no spread.
        let points = [
            Target {
                commanded: at(0.0, 0.0, 0.0),
                attained: vec![at(0.0, 0.0, 0.0), at(2e-3, 0.0, 0.0)],
            },
            Target {
                commanded: at(0.1, 0.0, 0.0),
                attained: vec![at(0.1, 2e-3, 0.0); 2],
            },
        ];
        let path = path_accuracy(&points).unwrap();
        near(path.accuracy_m, 2e-3);
        near(path.repeatability_m.unwrap(), 1e-3);
        assert_eq!(path.cycles, 2);
        let summary = pose_accuracy(&points).unwrap();
        near(summary.mean_accuracy_m, 1.5e-3);
        near(summary.mean_repeatability_m.unwrap(), 0.5e-3);
    }

    #[test]
    fn one_cycle_has_no_repeatability() {
        let target = Target {
            commanded: at(0.0, 0.0, 0.0),
            attained: vec![at(0.0, 0.0, 3e-3)],
        };
        let path = path_accuracy(std::slice::from_ref(&target)).unwrap();
        assert_eq!(path.repeatability_m, None);
        assert_eq!(path.angle_repeatability_rad, None);
        near(path.accuracy_m, 3e-3);
        let summary = pose_accuracy(&[target]).unwrap();
        assert_eq!(summary.mean_repeatability_m, None);
    }

    #[test]
    fn what_is_missing_is_said() {
        let target = |attained: Vec<Pose>| Target {
            commanded: at(0.0, 0.0, 0.0),
            attained,
        };
        let one = target(vec![at(0.0, 0.0, 0.0)]);
        assert_eq!(pose_accuracy(&[]), Err(AccuracyError::NoTarget));
        assert_eq!(path_accuracy(&[]), Err(AccuracyError::NoTarget));
        let none = pose_accuracy(&[one.clone(), target(Vec::new())]);
        assert_eq!(none, Err(AccuracyError::NoCycle { target: 1 }));
        let broken = pose_accuracy(&[target(vec![at(f64::NAN, 0.0, 0.0)])]);
        assert_eq!(broken, Err(AccuracyError::NotFinite { target: 0 }));
        let unequal = path_accuracy(&[one, target(vec![at(0.0, 0.0, 0.0); 2])]);
        assert_eq!(
            unequal.unwrap_err().to_string(),
            "point 1 of the path has 2 cycles, the first has 1"
        );
    }
}
