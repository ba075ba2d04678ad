//! Fits of phases 1 and 2; an error is one sentence that names the cable, if there is one.

use tautline_core::cable::{DegreeChoice, ElongationTriple, choose_elongation_degree};
use tautline_core::geometry::Pose;
use tautline_core::instrument::{
    ForceSensorCalibration, HomeAverage, HomeMeasurement, WinchCalibration, calibrate_force_sensor,
    calibrate_winch, measure_home,
};
use tautline_core::robot::{HomePlatform, Robot};
use tautline_session::{ElongationPoint, ForcePair, HomePose, HomeReading, WinchPair};

fn of_cable(robot: &Robot, cable: usize, message: impl ToString) -> String {
    let name = robot.cables.get(cable).map_or("", |c| c.name.as_str());
    format!("{name}: {}", message.to_string())
}

/// Fits the winch of one cable to its pairs.
///
/// # Errors
/// If the pairs do not determine the parameters, or positive revolutions reel cable in.
pub fn fit_winch(
    robot: &Robot,
    pairs: &[WinchPair],
    cable: usize,
) -> Result<WinchCalibration, String> {
    let rows = pairs.iter().filter(|pair| pair.cable == cable);
    let pairs: Vec<_> = rows
        .map(|pair| tautline_core::instrument::WinchPair {
            revolutions: pair.revolutions,
            length_m: pair.length_m,
            tension_n: pair.tension_n,
        })
        .collect();
    let fit = calibrate_winch(&pairs).map_err(|error| of_cable(robot, cable, error))?;
    let found = fit.cable_per_revolution_m;
    if found <= 0.0 {
        let message = format!(
            "found {found} m of cable per revolution, expected more than 0: positive revolutions pay cable out"
        );
        return Err(of_cable(robot, cable, message));
    }
    Ok(fit)
}

/// Fits the force sensor of one cable to its pairs.
///
/// # Errors
/// If the pairs do not determine the parameters.
pub fn fit_force_sensor(
    robot: &Robot,
    pairs: &[ForcePair],
    cable: usize,
) -> Result<ForceSensorCalibration, String> {
    let rows = pairs.iter().filter(|pair| pair.cable == cable);
    let pairs: Vec<_> = rows
        .map(|pair| tautline_core::instrument::ForcePair {
            reading_n: pair.reading_n,
            load_n: pair.load_n,
        })
        .collect();
    calibrate_force_sensor(&pairs).map_err(|error| of_cable(robot, cable, error))
}

/// Computes the home pose from the readings of the home platform.
///
/// # Errors
/// If the robot has no home platform, or its sensors do not give a pose.
pub fn fit_home(robot: &Robot, rows: &[HomeReading]) -> Result<HomeMeasurement, String> {
    let Some(platform) = &robot.home_platform else {
        return Err(
            "robot.json has no home_platform, expected one to compute a pose from the readings"
                .into(),
        );
    };
    let mut readings = vec![Vec::new(); platform.sensors.len()];
    for row in rows {
        match readings.get_mut(row.sensor) {
            Some(readings) => readings.push(row.reading),
            None => return Err(format!("robot.json has no sensor {}", row.sensor + 1)),
        }
    }
    let start = home_start_in_reference(robot, platform);
    let home = measure_home(platform, &readings, &start).map_err(|error| error.to_string())?;
    if !home.fix.converged {
        let misfit_mm = home.fix.largest_misfit_m * 1e3;
        return Err(format!(
            "no pose of the platform gives these distances: the best misses one by {misfit_mm:.3} mm"
        ));
    }
    Ok(home)
}

/// The mean of all measurements of the home pose: that of the home platform, which counts as one with the covariance
/// of the mean of its readings, and each of the others. `None` without measurements.
#[must_use]
pub fn average_home(
    platform: Option<&Result<HomeMeasurement, String>>,
    poses: &[HomePose],
) -> Option<HomeAverage> {
    let fix = platform
        .and_then(|fit| fit.as_ref().ok())
        .map(|fit| &fit.fix);
    let of_platform = fix.map(|fix| tautline_core::instrument::HomeReading {
        pose: fix.platform_in_base,
        covariance: fix.covariance_in_base,
    });
    let others = poses.iter().map(|pose| {
        let measured = Pose::from_parts(pose.position_m, pose.orientation_wxyz);
        tautline_core::instrument::HomeReading::isotropic(
            measured,
            pose.position_sd_m,
            pose.orientation_sd_rad,
        )
    });
    let all: Vec<_> = of_platform.into_iter().chain(others).collect();
    HomeAverage::of(&all)
}

/// The home pose of robot.json in the reference frame; identity if there is none.
#[must_use]
pub fn home_start_in_reference(robot: &Robot, platform: &HomePlatform) -> Pose {
    let Some(home) = &robot.home else {
        return Pose::identity();
    };
    let (home, reference) = (home.pose(), platform.base_from_reference.pose());
    let back = reference.orientation.inverse();
    Pose {
        position: back * (home.position - reference.position),
        orientation: back * home.orientation,
    }
}

/// An elongation surface fitted to measurements.
#[derive(Debug, Clone, PartialEq)]
pub struct ElongationFit {
    /// The surface, and the scores of all degrees.
    pub choice: DegreeChoice,
    /// Measured minus fitted elongation of each point (m).
    pub residuals_m: Vec<f64>,
    /// Largest absolute residual (m).
    pub largest_residual_m: f64,
}

/// Fits a surface whose degree is chosen by cross-validation.
///
/// # Errors
/// If the points do not determine any surface.
pub fn fit_elongation(points: &[ElongationPoint]) -> Result<ElongationFit, String> {
    let rows = points.iter().map(|point| ElongationTriple {
        length_m: point.length_m,
        tension_n: point.tension_n,
        elongation_m: point.elongation_m,
    });
    let triples: Vec<ElongationTriple> = rows.collect();
    let choice = choose_elongation_degree(&triples).map_err(|error| error.to_string())?;
    let residual = |t: &ElongationTriple| {
        let fitted = choice.surface.evaluate_unchecked(t.length_m, t.tension_n);
        t.elongation_m - fitted.elongation_m
    };
    let residuals_m: Vec<f64> = triples.iter().map(residual).collect();
    Ok(ElongationFit {
        largest_residual_m: residuals_m.iter().fold(0.0, |most, e| e.abs().max(most)),
        residuals_m,
        choice,
    })
}
