//! The fits of phases 1 and 2 in their machine form, file by file.

use tautline_core::instrument::HomeMeasurement;
use tautline_core::robot::Robot;
use tautline_session::{ElongationPoint, HomeReading, PhaseData};

use super::document::{
    DegreeResult, ElongationResult, ForceResult, HomeResult, HomeSensorResult, Precalibration,
    WinchResult,
};
use tautline_workflow::precalibration;

/// Why an item cannot be fitted.
pub struct Unfit {
    /// File of the dataset.
    pub file: &'static str,
    /// Cable or other item and what is the matter, one sentence.
    pub message: String,
}

impl Unfit {
    fn new(file: &'static str, message: String) -> Self {
        Self { file, message }
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
    let fit = precalibration::fit_winch(robot, &phases.winch, cable)
        .map_err(|message| Unfit::new("winch.csv", message))?;
    Ok(WinchResult {
        cable: robot.cables[cable].name.clone(),
        pairs: fit.residuals_m.len(),
        cable_per_revolution_m: fit.cable_per_revolution_m,
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
    let fit = precalibration::fit_force_sensor(robot, &phases.force, cable)
        .map_err(|message| Unfit::new("force.csv", message))?;
    Ok(ForceResult {
        cable: robot.cables[cable].name.clone(),
        pairs: fit.residuals_n.len(),
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
    precalibration::fit_home(robot, rows)
        .map(|home| home_result(&home))
        .map_err(|message| Unfit::new("home.csv", message))
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
    let fit = precalibration::fit_elongation(points)
        .map_err(|message| Unfit::new("elongation.csv", message))?;
    let degrees = fit.choice.scores.iter().map(|score| DegreeResult {
        degree: score.degree,
        error_m: score.error_m,
    });
    Ok(ElongationResult {
        points: points.len(),
        largest_residual_m: fit.largest_residual_m,
        degrees: degrees.collect(),
        surface: fit.choice.surface,
    })
}
