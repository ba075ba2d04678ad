//! Finds measurements that would tell two causes apart: poses at which the fitted models still differ after the second
//! has adapted all its parameters to them, and checks in the workshop.

use nalgebra::{DMatrix, DVector};

use super::budget::{
    MAX_REPEATS, MAX_SEPARATING_POSES, MIN_SEPARATING_POSES, PROPOSED_POSES, SEPARATING_SEED,
};
use super::calibration::DECISIVE_CHI2;
use super::fit::Fit;
use super::fitted_problem::{independent_dataset, problem_at_fitted_poses};
use super::report::{Cause, Separation};
use crate::effect::Search;
use crate::estimation::{
    Control, EstimationError, Geometry, Linearisation, Options, Problem, Solution, solve,
};
use crate::geometry::Pose;
use crate::measurement::{Dataset, Measurements};
use crate::robot::Robot;
use crate::simulation::{SimulationOptions, TensionRange, TrueGeometry, Workspace, simulate};

/// The robot of a fit, with its readings on the correct channels.
fn robot_of(fit: &Fit<'_>) -> Robot {
    let mut globals = fit.solution.globals.clone();
    globals
        .effects
        .retain(|bound| bound.effect.search() != Search::Exchange);
    globals.model(&fit.problem.dataset.robot)
}

/// Measurements that tell apart the last causes of two fits; `None` where the robot cannot be simulated and no check is
/// known.
pub(super) fn separation(one: &Fit<'_>, other: &Fit<'_>) -> Option<Separation> {
    let checks = checks(one, other);
    let candidates = candidates((one, other), None);
    if candidates.is_none() && checks.is_empty() {
        return None;
    }
    let mut candidates = candidates.unwrap_or_default();
    let information = &other.solution.information;
    let alone = |candidate: &CandidatePose| expected_difference(&[candidate], 1.0, information);
    candidates.sort_by(|a, b| alone(b).total_cmp(&alone(a)));
    candidates.truncate(PROPOSED_POSES);
    let chosen: Vec<&CandidatePose> = candidates.iter().collect();
    let Some(needed) = measurements_needed(&chosen, information) else {
        return Some(Separation {
            poses: Vec::new(),
            expected_delta_chi2: 0.0,
            advice: without_poses(&checks),
        });
    };
    Some(Separation {
        advice: advice(needed, &checks),
        expected_delta_chi2: expected_difference(&chosen, 1.0, information),
        poses: chosen.iter().map(|candidate| candidate.pose).collect(),
    })
}

/// Expected excess chi-square of one set of causes over another at each of some poses, if the other set is true and the pose is
/// measured once in addition to the data; the mean of both directions. One row for each pair of sets, in the order (0, 1),
/// (0, 2), .., (1, 2), ..; `None` where a set cannot be simulated at these poses.
///
/// # Errors
/// If the data cannot be used with the robot.
pub fn expected_separation(
    dataset: &Dataset,
    sets: &[&[Cause]],
    poses: &[Pose],
) -> Result<Vec<Option<Vec<f64>>>, EstimationError> {
    let (dataset, _) = independent_dataset(dataset)?;
    let problem = problem_at_fitted_poses(&dataset)?;
    let fits: Result<Vec<Fit<'_>>, _> = sets.iter().map(|set| Fit::new(&problem, set)).collect();
    let fits = fits?;
    let towards = |one: usize, other: usize| {
        let candidates = candidates((&fits[one], &fits[other]), Some(poses))?;
        let information = &fits[other].solution.information;
        let each = candidates.iter();
        let each = each.map(|candidate| expected_difference(&[candidate], 1.0, information));
        Some(each.collect::<Vec<f64>>())
    };
    let mut pairs = Vec::new();
    for one in 0..sets.len() {
        for other in one + 1..sets.len() {
            let both = towards(one, other).zip(towards(other, one));
            let mean = |(there, back): (Vec<f64>, Vec<f64>)| {
                let both = there.iter().zip(&back);
                both.map(|(there, back)| 0.5 * (there + back)).collect()
            };
            pairs.push(both.map(mean));
        }
    }
    Ok(pairs)
}

/// A pose, with the prediction of the second model if the first one is true.
struct CandidatePose {
    pose: Pose,
    /// Prediction minus reading, without noise.
    residual: DVector<f64>,
    /// Derivative of the prediction with respect to the parameters of the second model.
    design: DMatrix<f64>,
}

/// The given poses, else poses drawn from the workspace of the data.
fn candidates(
    (one, other): (&Fit<'_>, &Fit<'_>),
    given: Option<&[Pose]>,
) -> Option<Vec<CandidatePose>> {
    let (measurements, poses) = predicted_readings(one, given)?;
    let dataset = Dataset {
        robot: robot_of(other),
        measurements,
    };
    let mut held = Problem::new(&dataset).ok()?;
    held.geometry = Geometry::Held;
    let quiet = &mut |_: &_| Control::Continue;
    let fitted = solve(&held, &Options::default(), quiet).ok()?;
    let described = Dataset {
        robot: other.problem.dataset.robot.clone(),
        measurements: dataset.measurements.clone(),
    };
    let mut problem = other.problem.clone();
    problem.dataset = &described;
    let problem = problem.at_poses_of(&fitted);
    if problem.parameters().len() != other.solution.parameters.len() {
        return None;
    }
    let mut solution = Solution {
        poses: fitted.poses,
        tensions_n: fitted.tensions_n,
        ..other.solution.clone()
    };
    solution.globals.home_tension_error_n = fitted.globals.home_tension_error_n;
    let linear = Linearisation::new(&problem, &solution);
    let candidate = |block: &crate::estimation::PoseBlock| {
        let (first, count) = (block.rows.start, block.rows.len());
        CandidatePose {
            pose: poses[block.row],
            residual: linear.residual.rows(first, count).into_owned(),
            design: linear.design.rows(first, count).into_owned(),
        }
    };
    let wanted = given.map_or(linear.poses.len(), <[Pose]>::len);
    // Poses that only fill the time until the last event come first.
    let before = linear.poses.len().checked_sub(wanted)?;
    Some(linear.poses[before..].iter().map(candidate).collect())
}

/// Noise-free readings of a fit at further poses, for the instruments that its data have, and the poses.
fn predicted_readings(fit: &Fit<'_>, given: Option<&[Pose]>) -> Option<(Measurements, Vec<Pose>)> {
    let events = fit.solution.globals.effects.iter();
    let labels = events.filter_map(|bound| Some(bound.values[bound.effect.pose_parameter()?]));
    // The poses must go on until after the last event.
    let last = labels.fold(0.0, f64::max) as usize;
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        noise: false,
        workspace: Workspace::around(fit.solution.poses.iter().map(|(_, pose)| pose)),
        tension: tension_of(fit),
        ..SimulationOptions::new(
            (last + PROPOSED_POSES).clamp(MIN_SEPARATING_POSES, MAX_SEPARATING_POSES),
            SEPARATING_SEED,
        )
    };
    let options = match given {
        Some(poses) => {
            let before = std::iter::repeat_n(*poses.first()?, last);
            options.commanding(before.chain(poses.iter().copied()).collect())
        }
        None => options,
    };
    let run = simulate(&robot_of(fit), &options).ok()?;
    let mut further = run.dataset.measurements;
    let poses = std::mem::take(&mut further.truth.poses);
    further.leave_out_unread(&fit.problem.dataset.measurements);
    Some((further, poses))
}

/// Range of tensions of the data.
fn tension_of(fit: &Fit<'_>) -> Option<TensionRange> {
    let dataset = fit.problem.dataset;
    let mut tensions = Vec::new();
    for row in 0..dataset.measurements.len() {
        for (index, cable) in dataset.robot.cables.iter().enumerate() {
            let read = dataset.measurements.force_n.get(row, index);
            tensions.extend(cable.force_sensor.map(|sensor| sensor.tension_n(read)));
        }
    }
    tensions.retain(|tension| *tension > 0.0);
    let mean = tensions.iter().sum::<f64>() / tensions.len() as f64;
    let largest = tensions.iter().copied().fold(0.0, f64::max);
    (!tensions.is_empty()).then(|| TensionRange {
        lower_n: tensions.iter().copied().fold(mean, f64::min) / 2.0,
        reference_n: mean,
        upper_n: 2.0 * largest,
    })
}

/// Expected excess chi-square of the second model over the first if each of these poses is measured `times` times in
/// addition to the present data. The second model adapts its parameters, with the present information as prior.
fn expected_difference(chosen: &[&CandidatePose], times: f64, information: &DMatrix<f64>) -> f64 {
    let mut squares = 0.0;
    let mut pull = DVector::zeros(information.nrows());
    let mut total = information.clone();
    for candidate in chosen {
        squares += candidate.residual.norm_squared();
        pull += candidate.design.tr_mul(&candidate.residual);
        total += candidate.design.tr_mul(&candidate.design) * times;
    }
    // If the data leave a parameter undetermined, no difference can be promised.
    let solved = total.cholesky().map(|factor| factor.solve(&pull));
    let explained = solved.map_or(f64::INFINITY, |solved| times * pull.dot(&solved));
    (times * (squares - explained)).max(0.0)
}

/// Number of measurements for a decision: the first poses once each, or all of them several times.
fn measurements_needed(chosen: &[&CandidatePose], information: &DMatrix<f64>) -> Option<usize> {
    let decides = |poses: usize, times: usize| {
        expected_difference(&chosen[..poses], times as f64, information) >= DECISIVE_CHI2
    };
    let few = (1..=chosen.len()).find(|poses| decides(*poses, 1));
    let often = || (2..=MAX_REPEATS).find(|times| decides(chosen.len(), *times));
    few.or_else(|| Some(chosen.len() * often()?))
}

/// The checks of both causes, without repetition.
fn checks(one: &Fit<'_>, other: &Fit<'_>) -> Vec<&'static str> {
    let causes = [one, other].map(|fit| fit.causes.last());
    let mut checks: Vec<&str> = causes
        .into_iter()
        .flatten()
        .filter_map(|cause| cause.effect().check())
        .collect();
    checks.dedup();
    checks
}

fn advice(needed: usize, checks: &[&str]) -> String {
    let often = match needed {
        1 => "once, at the first of the poses listed".to_owned(),
        _ => format!("about {needed} times in all, at the poses listed"),
    };
    let poses = format!("Measure the platform {often}: there these causes differ most.");
    match checks {
        [] => poses,
        _ => format!("{poses} Or check, without measuring: {}", checks.join(" ")),
    }
}

fn without_poses(checks: &[&str]) -> String {
    let none = "No poses of this workspace tell these causes apart";
    match checks {
        [] => format!("{none}; a reading of another kind would."),
        _ => format!("{none}, but a check does: {}", checks.join(" ")),
    }
}
