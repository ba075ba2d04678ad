//! Pose of the platform on the home reference platform, from six distances.

use nalgebra::{Matrix6, SVD, Vector6};

use crate::geometry::{Pose, Twist, Vec3};
use crate::robot::HomePlatform;

/// The arrangement is singular if the smallest singular value of the sensors' sensitivity is below
/// this fraction of the largest: an error of a micrometre would then be a metre in the pose.
const SINGULAR: f64 = 1e-6;

/// Beams closer to their plane than this sine do not measure a distance to it.
const GRAZING: f64 = 1e-6;

/// Reasons why no pose can be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HomePlatformError {
    /// Not six sensors, or not six readings.
    #[error("expected six sensors with one reading each, found {given}")]
    NotSix {
        /// Number found.
        given: usize,
    },
    /// The description or reading of a sensor is invalid.
    #[error("sensor {sensor}: {message}")]
    Sensor {
        /// Number of the sensor, from 1.
        sensor: usize,
        /// Problem, in one sentence.
        message: String,
    },
    /// The distances do not determine the pose.
    #[error(
        "the six sensors do not determine the pose of the platform: no reading changes when it {motion}"
    )]
    Singular {
        /// The motion that changes no distance.
        motion: String,
    },
}

/// Pose of the platform on the home platform, from six distances.
///
/// Sensor i at `o_i` looks along the unit vector `q_i` (reference frame) at the plane `n . x = h`
/// fixed in the platform frame. With the platform at `(r, R)` in the reference frame and `N = R n`
/// the distance is `d_i = (h + N.(r - o_i)) / (N.q_i)`; six distances give six equations for the pose.
/// Exact planes, origins, directions and `base_from_reference` are assumed, and independent errors of the
/// distances. Source: Jin et al. 2018, section 3.3.
#[derive(Debug, Clone, PartialEq)]
pub struct HomeFix {
    /// Pose of the platform in the reference frame.
    pub platform_in_reference: Pose,
    /// Pose of the platform in the base frame.
    pub platform_in_base: Pose,
    /// Covariance of the pose in the base frame, as a [`Twist`] (m, rad).
    pub covariance_in_base: Matrix6<f64>,
    /// Standard deviations of the position in the base frame (m).
    pub position_sd_m: [f64; 3],
    /// Standard deviations of the rotation vector in the base frame (rad).
    pub orientation_sd_rad: [f64; 3],
    /// Largest difference between predicted and given distance (m).
    pub largest_misfit_m: f64,
    /// Newton steps taken.
    pub iterations: usize,
    /// Whether the six equations hold to 1e-10 m.
    pub converged: bool,
}

/// Solves for the pose by damped Newton steps from `start_in_reference`.
///
/// `distance_sd_m` are the standard deviations of the six distances.
///
/// # Errors
/// If there are not six sensors and distances, a plane does not exist, a beam is parallel to its plane, or the
/// arrangement leaves a motion undetermined.
pub fn locate_platform(
    home: &HomePlatform,
    distances_m: &[f64],
    distance_sd_m: &[f64],
    start_in_reference: &Pose,
) -> Result<HomeFix, HomePlatformError> {
    check(home, distances_m, distance_sd_m)?;
    let target = Vector6::from_column_slice(distances_m);
    let mut pose = *start_in_reference;
    let (mut predicted, mut sensitivity) = predict(home, &pose)?;
    let mut iterations = 0;
    let mut moved = f64::INFINITY;
    while iterations < 50 && moved > 1e-14 {
        let inverse = invert(&sensitivity)?;
        let Some(step) = damped_step(home, &pose, &target, inverse * (target - predicted)) else {
            break;
        };
        moved = step.amax();
        pose = pose.perturbed(&step);
        (predicted, sensitivity) = predict(home, &pose)?;
        iterations += 1;
    }
    let inverse = invert(&sensitivity)?;
    let variances = Vector6::from_iterator(distance_sd_m.iter().map(|sd| sd * sd));
    let covariance = inverse * Matrix6::from_diagonal(&variances) * inverse.transpose();
    let largest_misfit_m = (target - predicted).amax();
    let (covariance_in_base, sd) = in_base(home, &covariance);
    let base_from_reference = home.base_from_reference.pose();
    Ok(HomeFix {
        platform_in_reference: pose,
        platform_in_base: Pose {
            position: base_from_reference.transform(&pose.position),
            orientation: base_from_reference.orientation * pose.orientation,
        },
        covariance_in_base,
        position_sd_m: [sd[0], sd[1], sd[2]],
        orientation_sd_rad: [sd[3], sd[4], sd[5]],
        largest_misfit_m,
        iterations,
        // Far below the resolution of any sensor, far above the rounding of distances of metres.
        converged: largest_misfit_m < 1e-10,
    })
}

fn check(home: &HomePlatform, distances: &[f64], sds: &[f64]) -> Result<(), HomePlatformError> {
    for given in [home.sensors.len(), distances.len(), sds.len()] {
        if given != 6 {
            return Err(HomePlatformError::NotSix { given });
        }
    }
    for (index, sensor) in home.sensors.iter().enumerate() {
        let at_sensor = |message: String| HomePlatformError::Sensor {
            sensor: index + 1,
            message,
        };
        let Some(plane) = home.planes.get(sensor.plane) else {
            let message = format!("plane {} does not exist", sensor.plane);
            return Err(at_sensor(message));
        };
        for (name, vector) in [
            ("direction", sensor.direction),
            ("plane's normal", plane.normal),
        ] {
            let length = Vec3::from(vector).norm();
            if (length - 1.0).abs() > 1e-6 || length.is_nan() {
                let message = format!("its {name} has length {length}, not 1");
                return Err(at_sensor(message));
            }
        }
        let mut numbers = sensor
            .origin_m
            .iter()
            .chain([&plane.offset_m, &distances[index]]);
        if !numbers.all(|v| v.is_finite()) {
            let message = "its distance, origin or plane offset is not a finite number";
            return Err(at_sensor(message.to_owned()));
        }
    }
    Ok(())
}

/// Distances at a pose and their derivatives with respect to a [`Twist`] in the reference frame:
/// `N / (N.q)` for the position and `(N x (r - p)) / (N.q)` for the rotation, with `p` the point hit.
fn predict(
    home: &HomePlatform,
    pose: &Pose,
) -> Result<(Vector6<f64>, Matrix6<f64>), HomePlatformError> {
    let mut distances = Vector6::zeros();
    let mut sensitivity = Matrix6::zeros();
    for (index, sensor) in home.sensors.iter().enumerate() {
        let plane = &home.planes[sensor.plane];
        let (origin, direction) = (Vec3::from(sensor.origin_m), Vec3::from(sensor.direction));
        let normal = pose.orientation * Vec3::from(plane.normal);
        let cosine = normal.dot(&direction);
        if cosine.abs() < GRAZING {
            return Err(HomePlatformError::Sensor {
                sensor: index + 1,
                message: "its beam is parallel to its plane and never meets it".to_owned(),
            });
        }
        distances[index] = (plane.offset_m + normal.dot(&(pose.position - origin))) / cosine;
        let arm = pose.position - (origin + direction * distances[index]);
        let row = Twist::from_iterator(normal.iter().chain(&normal.cross(&arm)).copied());
        sensitivity.set_row(index, &(row / cosine).transpose());
    }
    Ok((distances, sensitivity))
}

/// The inverse of the sensitivity; if it is singular, an error that names the undetermined motion.
fn invert(sensitivity: &Matrix6<f64>) -> Result<Matrix6<f64>, HomePlatformError> {
    // Rotations are scaled by the displacement they cause at the planes, which makes them comparable with translations.
    let square: f64 = sensitivity.fixed_columns::<3>(3).norm_squared();
    let arm = (square / sensitivity.fixed_columns::<3>(0).norm_squared()).sqrt();
    let arm = if arm > 0.0 { arm } else { 1.0 };
    let scale = Vector6::new(1.0, 1.0, 1.0, arm, arm, arm);
    let mut scaled = *sensitivity;
    for (mut column, scale) in scaled.column_iter_mut().zip(&scale) {
        column /= *scale;
    }
    let svd = SVD::new(scaled, true, true);
    let (smallest, smallest_value) = svd.singular_values.argmin();
    let is_singular = smallest_value < SINGULAR * svd.singular_values.max();
    let open = svd.v_t.map(|v_t| v_t.row(smallest).transpose());
    match svd.pseudo_inverse(0.0) {
        Ok(inverse) if !is_singular => {
            Ok(Matrix6::from_diagonal(&scale.map(|s| 1.0 / s)) * inverse)
        }
        _ => Err(HomePlatformError::Singular {
            motion: open.map_or("moves".to_owned(), |open| in_words(&open)),
        }),
    }
}

/// A motion in words, such as "moves along y".
fn in_words(motion: &Twist) -> String {
    let moved = Vec3::new(motion[0], motion[1], motion[2]);
    let turned = Vec3::new(motion[3], motion[4], motion[5]);
    let axis = |v: &Vec3| {
        let v = v.normalize();
        match v.iamax() {
            main if v[main].abs() > 0.99 => ["x", "y", "z"][main].to_owned(),
            _ => format!("({:.2}, {:.2}, {:.2})", v.x, v.y, v.z),
        }
    };
    let frame = "of the reference frame";
    if turned.norm() < 0.05 {
        format!("moves along {} {frame}", axis(&moved))
    } else if moved.norm() < 0.05 {
        format!("rotates about {} {frame}", axis(&turned))
    } else {
        format!(
            "rotates about {} and moves along {} {frame}",
            axis(&turned),
            axis(&moved)
        )
    }
}

/// The Newton step, halved until it reduces the misfit of the distances; `None` if no part of it does.
fn damped_step(
    home: &HomePlatform,
    pose: &Pose,
    target: &Vector6<f64>,
    newton: Twist,
) -> Option<Twist> {
    let misfit = |pose: &Pose| match predict(home, pose) {
        Ok((predicted, _)) => (target - predicted).norm(),
        Err(_) => f64::INFINITY,
    };
    let before = misfit(pose);
    // The linearisation does not hold beyond a radian.
    let turn = newton.fixed_rows::<3>(3).norm();
    let mut step = newton / turn.max(1.0);
    for _ in 0..40 {
        if misfit(&pose.perturbed(&step)) < before {
            return Some(step);
        }
        step *= 0.5;
    }
    None
}

/// Covariance in base coordinates, and the standard deviations.
fn in_base(home: &HomePlatform, covariance: &Matrix6<f64>) -> (Matrix6<f64>, Vector6<f64>) {
    let rotation = home
        .base_from_reference
        .pose()
        .orientation
        .to_rotation_matrix();
    let mut turn = Matrix6::zeros();
    turn.fixed_view_mut::<3, 3>(0, 0)
        .copy_from(rotation.matrix());
    turn.fixed_view_mut::<3, 3>(3, 3)
        .copy_from(rotation.matrix());
    let covariance = turn * covariance * turn.transpose();
    (covariance, covariance.diagonal().map(f64::sqrt))
}

#[cfg(test)]
pub(super) mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::robot::{FrameTransform, HomeSensor, Plane};

    /// A 3-2-1 arrangement: three sensors look up at the bottom plane, two at a side, one at the
    /// other side.
    pub(crate) fn arrangement() -> HomePlatform {
        let sensor = |origin_m, direction, plane| HomeSensor {
            origin_m,
            direction,
            plane,
            sd_m: 2e-4,
            curve: None,
        };
        let (up, along_x, along_y) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        HomePlatform {
            base_from_reference: FrameTransform {
                position_m: [0.1, -0.2, -0.3],
                orientation_wxyz: [0.8, 0.1, -0.2, 0.55],
            },
            sensors: vec![
                sensor([0.05, 0.04, -0.2], up, 0),
                sensor([-0.05, 0.04, -0.2], up, 0),
                sensor([0.0, -0.06, -0.2], up, 0),
                sensor([-0.2, 0.05, 0.0], along_x, 1),
                sensor([-0.2, -0.05, 0.01], along_x, 1),
                sensor([0.01, -0.2, 0.0], along_y, 2),
            ],
            planes: vec![
                Plane {
                    normal: [0.0, 0.0, -1.0],
                    offset_m: 0.06,
                },
                Plane {
                    normal: [-1.0, 0.0, 0.0],
                    offset_m: 0.07,
                },
                Plane {
                    normal: [0.0, -1.0, 0.0],
                    offset_m: 0.08,
                },
            ],
        }
    }

    pub(crate) fn truth() -> Pose {
        Pose::from_parts([0.012, -0.008, 0.02], [1.0, 0.05, -0.08, 0.06])
    }

    /// Distances by intersecting each beam with three points of its plane, independently of
    /// [`predict`].
    pub(crate) fn distances(home: &HomePlatform, pose: &Pose) -> Vec<f64> {
        let distance = |sensor: &HomeSensor| {
            let plane = &home.planes[sensor.plane];
            let normal = Vec3::from(plane.normal);
            let side = Vec3::new(normal.y, normal.z, normal.x);
            let corner = |v: Vec3| pose.transform(&(normal * plane.offset_m + v));
            let (a, b, c) = (
                corner(Vec3::zeros()),
                corner(side),
                corner(normal.cross(&side)),
            );
            let columns = [b - a, c - a, -Vec3::from(sensor.direction)];
            let system = nalgebra::Matrix3::from_columns(&columns);
            let solution = system.lu().solve(&(Vec3::from(sensor.origin_m) - a));
            solution.unwrap().z
        };
        home.sensors.iter().map(distance).collect()
    }

    #[test]
    fn recovers_the_pose_from_exact_distances() {
        let home = arrangement();
        let measured = distances(&home, &truth());
        for start in [
            Pose::identity(),
            Pose::from_parts([0.1; 3], [1.0, 0.3, 0.2, -0.3]),
        ] {
            let fix = locate_platform(&home, &measured, &[2e-4; 6], &start).unwrap();
            let error = fix.platform_in_reference.difference(&truth());
            assert!(fix.converged && error.norm() < 1e-12, "{error}");
        }
    }

    #[test]
    fn pose_in_the_base_frame_maps_the_same_points() {
        let home = arrangement();
        let measured = distances(&home, &truth());
        let fix = locate_platform(&home, &measured, &[2e-4; 6], &Pose::identity()).unwrap();
        let point = Vec3::new(0.3, -0.1, 0.2);
        let by_way_of_reference = home
            .base_from_reference
            .pose()
            .transform(&truth().transform(&point));
        let direct = fix.platform_in_base.transform(&point);
        assert!((by_way_of_reference - direct).norm() < 1e-12);
    }

    #[test]
    fn covariance_covers_the_errors() {
        // The squared error over the covariance is chi-square with 6 degrees of freedom; its mean over 2000
        // trials has sd 0.077. 5 sd: a false failure has probability 6e-7 (the seed is fixed).
        let home = arrangement();
        let exact = distances(&home, &truth());
        let base = home.base_from_reference.pose();
        let true_in_base = Pose {
            position: base.transform(&truth().position),
            orientation: base.orientation * truth().orientation,
        };
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let mut sum = 0.0;
        for _ in 0..2000 {
            let noisy: Vec<f64> = exact
                .iter()
                .map(|d| {
                    let noise: f64 = StandardNormal.sample(&mut random);
                    d + 2e-4 * noise
                })
                .collect();
            let fix = locate_platform(&home, &noisy, &[2e-4; 6], &Pose::identity()).unwrap();
            let error = fix.platform_in_base.difference(&true_in_base);
            let inverse = fix.covariance_in_base.try_inverse().unwrap();
            sum += (error.transpose() * inverse * error)[0];
        }
        let mean = sum / 2000.0;
        assert!((mean - 6.0).abs() < 5.0 * 0.0775, "{mean}");
    }

    #[test]
    fn an_open_motion_is_named() {
        let mut home = arrangement();
        // The last sensor now sees the x side too: nobody sees y.
        home.sensors[5] = HomeSensor {
            origin_m: [-0.2, 0.0, 0.05],
            ..home.sensors[3]
        };
        let error = locate_platform(&home, &[0.13; 6], &[2e-4; 6], &Pose::identity());
        let message = error.unwrap_err().to_string();
        assert!(message.contains("moves along y"), "{message}");
    }

    #[test]
    fn impossible_sensors_are_refused_in_words() {
        let mut home = arrangement();
        home.sensors[2].plane = 5;
        let error = locate_platform(&home, &[0.1; 6], &[2e-4; 6], &Pose::identity());
        assert_eq!(
            error.unwrap_err().to_string(),
            "sensor 3: plane 5 does not exist"
        );
        let error = locate_platform(&arrangement(), &[0.1; 5], &[2e-4; 5], &Pose::identity());
        assert!(error.unwrap_err().to_string().contains("found 5"));
    }
}
