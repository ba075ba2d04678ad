//! The fits of phases 1 and 2, file by file.

use tautline_core::cable::{ElongationTriple, choose_elongation_degree};
use tautline_core::geometry::Pose;
use tautline_core::instrument::{
    ForcePair, HomeMeasurement, WinchPair, calibrate_force_sensor, calibrate_winch, measure_home,
};
use tautline_core::robot::{HomePlatform, Robot};
use tautline_session::{ElongationPoint, HomeReading, PhaseData};

use super::document::{
    DegreeResult, ElongationResult, ForceResult, HomeResult, HomeSensorResult, Precalibration,
    WinchResult,
};

/// Why an item cannot be fitted.
pub struct Unfit {
    /// File of the dataset.
    pub file: &'static str,
    /// Cable or other item and what is the matter, one sentence.
    pub message: String,
}

impl Unfit {
    fn new(file: &'static str, message: impl ToString) -> Self {
        let message = message.to_string();
        Self { file, message }
    }

    fn of_cable(file: &'static str, robot: &Robot, cable: usize, message: impl ToString) -> Self {
        let name = &robot.cables[cable].name;
        Self::new(file, format!("{name}: {}", message.to_string()))
    }
}

/// Fits everything that was measured.
///
/// # Errors
/// The first item that cannot be fitted.
pub fn fit(robot: &Robot, phases: &PhaseData) -> Result<Precalibration, Unfit> {
    let has_winch = |cable: &usize| phases.winch.iter().any(|pair| pair.cable == *cable);
    let has_force = |cable: &usize| phases.force.iter().any(|pair| pair.cable == *cable);
    let cables = 0..robot.cable_count();
    Ok(Precalibration {
        winches: cables
            .clone()
            .filter(has_winch)
            .map(|cable| fit_winch(robot, phases, cable))
            .collect::<Result<_, _>>()?,
        force_sensors: cables
            .filter(has_force)
            .map(|cable| fit_force(robot, phases, cable))
            .collect::<Result<_, _>>()?,
        home: match phases.home.is_empty() {
            true => None,
            false => Some(fit_home(robot, &phases.home)?),
        },
        elongation: match phases.elongation.is_empty() {
            true => None,
            false => Some(fit_elongation(&phases.elongation)?),
        },
    })
}

fn fit_winch(robot: &Robot, phases: &PhaseData, cable: usize) -> Result<WinchResult, Unfit> {
    let unfit = |message: String| Unfit::of_cable("winch.csv", robot, cable, message);
    let rows = phases.winch.iter().filter(|pair| pair.cable == cable);
    let pairs: Vec<WinchPair> = rows
        .map(|pair| WinchPair {
            revolutions: pair.revolutions,
            length_m: pair.length_m,
            tension_n: pair.tension_n,
        })
        .collect();
    let fit = calibrate_winch(&pairs).map_err(|error| unfit(error.to_string()))?;
    let found = fit.cable_per_revolution_m;
    if found <= 0.0 {
        return Err(unfit(format!(
            "found {found} m of cable per revolution, expected more than 0: positive revolutions pay cable out"
        )));
    }
    Ok(WinchResult {
        cable: robot.cables[cable].name.clone(),
        pairs: pairs.len(),
        cable_per_revolution_m: found,
        cable_per_revolution_sd_m: fit.cable_per_revolution_sd_m,
        nominal_cable_per_revolution_m: robot.cables[cable].winch.cable_per_revolution_m(),
        offset_m: fit.offset_m,
        offset_sd_m: fit.offset_sd_m,
        stretch_m_per_n: fit.stretch_m_per_n.map(|(value, _)| value),
        stretch_sd_m_per_n: fit.stretch_m_per_n.map(|(_, sd)| sd),
        residual_sd_m: fit.residual_sd_m,
        largest_residual_m: fit.largest_residual_m,
        passed: fit.passed,
    })
}

fn fit_force(robot: &Robot, phases: &PhaseData, cable: usize) -> Result<ForceResult, Unfit> {
    let rows = phases.force.iter().filter(|pair| pair.cable == cable);
    let pairs: Vec<ForcePair> = rows
        .map(|pair| ForcePair {
            reading_n: pair.reading_n,
            load_n: pair.load_n,
        })
        .collect();
    let fit = calibrate_force_sensor(&pairs)
        .map_err(|error| Unfit::of_cable("force.csv", robot, cable, error))?;
    Ok(ForceResult {
        cable: robot.cables[cable].name.clone(),
        pairs: pairs.len(),
        tension_gain: fit.gain,
        tension_gain_sd: fit.gain_sd,
        bias_n: fit.bias_n,
        bias_sd_n: fit.bias_sd_n,
        residual_sd_n: fit.residual_sd_n,
        largest_residual_n: fit.largest_residual_n,
        passed: fit.passed,
    })
}

fn fit_home(robot: &Robot, rows: &[HomeReading]) -> Result<HomeResult, Unfit> {
    let file = "home.csv";
    let Some(platform) = &robot.home_platform else {
        let message =
            "robot.json has no home_platform, expected one to make a pose of the readings";
        return Err(Unfit::new(file, message));
    };
    let mut readings = vec![Vec::new(); platform.sensors.len()];
    for row in rows {
        match readings.get_mut(row.sensor) {
            Some(readings) => readings.push(row.reading),
            None => {
                let message = format!("robot.json has no sensor {}", row.sensor + 1);
                return Err(Unfit::new(file, message));
            }
        }
    }
    let start = start_in_reference(robot, platform);
    let home = measure_home(platform, &readings, &start).map_err(|e| Unfit::new(file, e))?;
    if !home.fix.converged {
        let misfit_mm = home.fix.largest_misfit_m * 1e3;
        return Err(Unfit::new(
            file,
            format!(
                "no pose of the platform gives these distances: the best misses one by {misfit_mm:.3} mm"
            ),
        ));
    }
    Ok(home_result(&home))
}

/// The home pose of robot.json, or where both frames coincide.
fn start_in_reference(robot: &Robot, platform: &HomePlatform) -> Pose {
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

fn home_result(home: &HomeMeasurement) -> HomeResult {
    let fix = &home.fix;
    let repeatability = home.repeatability;
    HomeResult {
        position_m: fix.platform_in_base.position.into(),
        orientation_wxyz: fix.platform_in_base.orientation_wxyz(),
        position_sd_m: fix.position_sd_m,
        orientation_sd_rad: fix.orientation_sd_rad,
        position_repeatability_m: repeatability.map(|r| [r[0], r[1], r[2]]),
        orientation_repeatability_rad: repeatability.map(|r| [r[3], r[4], r[5]]),
        largest_residual_m: fix.largest_misfit_m,
        sensors: home
            .sensors
            .iter()
            .enumerate()
            .map(|(k, repeats)| HomeSensorResult {
                sensor: k + 1,
                readings: repeats.count,
                mean_m: repeats.mean_m,
                sd_m: Some(repeats.sd_m).filter(|sd| sd.is_finite()),
                in_range: repeats.in_range,
            })
            .collect(),
    }
}

fn fit_elongation(points: &[ElongationPoint]) -> Result<ElongationResult, Unfit> {
    let rows = points.iter().map(|point| ElongationTriple {
        length_m: point.length_m,
        tension_n: point.tension_n,
        elongation_m: point.elongation_m,
    });
    let triples: Vec<ElongationTriple> = rows.collect();
    let choice =
        choose_elongation_degree(&triples).map_err(|error| Unfit::new("elongation.csv", error))?;
    let residual = |t: &ElongationTriple| {
        let fitted = choice.surface.evaluate_unchecked(t.length_m, t.tension_n);
        (t.elongation_m - fitted.elongation_m).abs()
    };
    let largest_residual_m = triples.iter().map(residual).fold(0.0, f64::max);
    let degrees = choice.scores.iter().map(|score| DegreeResult {
        degree: score.degree,
        error_m: score.error_m,
    });
    Ok(ElongationResult {
        points: points.len(),
        largest_residual_m,
        degrees: degrees.collect(),
        surface: choice.surface,
    })
}
