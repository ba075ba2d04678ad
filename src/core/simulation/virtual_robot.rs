//! A virtual robot whose true geometry differs from its description, and its simulated measurements.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::holding_tensions::{AfterHome, Schedule, Visit, resting_state};
use super::inversion::invert;
use super::readings::{add_noise, blank, normal, true_directions};
use super::workspace::{TensionRange, Workspace};
use crate::effect::{BoundEffect, EffectError, EffectSetting, PartDeviation, part_deviations};
use crate::estimation::EstimationError;
use crate::geometry::{Pose, Twist};
use crate::kinematics::{KinematicsError, inverse_kinematics};
use crate::measurement::{Dataset, Grid};
use crate::robot::Robot;

/// Source of the true geometry.
#[derive(Debug, Clone, PartialEq)]
pub enum TrueGeometry {
    /// Drawn from the priors that the robot states.
    Drawn,
    /// Given entry points (m); home pose and target plane are drawn.
    EntryPoints(Vec<[f64; 3]>),
    /// As described.
    Nominal,
}

/// Options of a simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulationOptions {
    /// Number of poses, without the home pose.
    pub poses: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// True geometry.
    pub geometry: TrueGeometry,
    /// Effects that the description does not contain.
    pub effects: Vec<EffectSetting>,
    /// Whether readings have noise.
    pub noise: bool,
    /// Workspace of the platform; by default around its home pose.
    pub workspace: Option<Workspace>,
    /// Tension limits of the cables; by default as suits the weight.
    pub tension: Option<TensionRange>,
    /// Poses to command, in this order, instead of `poses` drawn from the workspace.
    pub at: Option<Vec<Pose>>,
}

impl SimulationOptions {
    /// Poses with noise and a true geometry drawn from the priors.
    #[must_use]
    pub fn new(poses: usize, seed: u64) -> Self {
        Self {
            poses,
            seed,
            geometry: TrueGeometry::Drawn,
            effects: Vec::new(),
            noise: true,
            workspace: None,
            tension: None,
            at: None,
        }
    }

    /// The same options with given commanded poses.
    #[must_use]
    pub fn commanding(self, poses: Vec<Pose>) -> Self {
        Self {
            poses: poses.len(),
            at: Some(poses),
            ..self
        }
    }
}

/// A simulated calibration run.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// The description and the measurements, as available to an operator.
    pub dataset: Dataset,
    /// True entry points, home pose, target plane and effects.
    pub truth: Robot,
}

/// Errors of a simulation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// The kinematics has no solution at the home pose.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// An effect cannot be attached.
    #[error(transparent)]
    Effect(#[from] EstimationError),
    /// An effect acts only on readings in motion, but the poses are at rest.
    #[error("effect \"{0}\" acts only on a moving platform: simulate a recording in motion")]
    AtRest(&'static str),
    /// No equilibrium was found at the motor revolutions.
    #[error("the platform has no equilibrium at these motor revolutions")]
    NoEquilibrium,
    /// No tensions balance the platform.
    #[error("no tensions between {lower_n:.1} N and {upper_n:.1} N hold the platform at {place}")]
    Infeasible {
        /// Smallest tension (N).
        lower_n: f64,
        /// Largest tension (N).
        upper_n: f64,
        /// Description of the pose.
        place: &'static str,
    },
}

impl SimulationError {
    pub(crate) fn infeasible(range: &TensionRange, place: &'static str) -> Self {
        Self::Infeasible {
            lower_n: range.lower_n,
            upper_n: range.upper_n,
            place,
        }
    }
}

/// Number of poses drawn for each one wanted before giving up.
const TRIES_PER_POSE: usize = 200;

/// Simulates a calibration run.
///
/// # Errors
/// If the robot cannot be held in its workspace, an effect is unknown, or an effect refers to a pose that does not exist.
pub fn simulate(robot: &Robot, options: &SimulationOptions) -> Result<Simulated, SimulationError> {
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let mut truth = draw_truth(robot, options, &mut rng);
    let effects = bind(&truth)?;
    if let Some(bound) = effects.iter().find(|bound| bound.effect.is_in_motion()) {
        return Err(SimulationError::AtRest(bound.effect.id()));
    }
    let mut robot = robot.clone();
    let (poses, commanded, tensions) =
        visit_poses((&mut robot, &mut truth), &effects, options, &mut rng)?;
    let schedule = Schedule::of(&robot, poses.len() - 1);
    let mut exact = Dataset {
        robot: truth.clone(),
        measurements: blank(&robot, schedule, (&poses, &commanded), &tensions),
    };
    for effect in &effects {
        let checked = effect.check_poses(&exact.measurements);
        checked.map_err(EstimationError::Effect)?;
    }
    let directions = true_directions(&truth, &poses)?;
    invert(&mut exact, (&poses, &tensions), &directions)?;
    if options.noise {
        add_noise(&robot, &mut exact.measurements, &mut rng);
    }
    for effect in &effects {
        effect.exchange_channels(&mut exact.measurements);
    }
    Ok(Simulated {
        dataset: Dataset {
            robot,
            measurements: exact.measurements,
        },
        truth,
    })
}

pub(super) fn bind(truth: &Robot) -> Result<Vec<BoundEffect>, SimulationError> {
    let settings = truth.effects_and_deviations();
    let bound: Result<Vec<_>, EffectError> = settings
        .map(|setting| BoundEffect::from_setting(setting, truth))
        .collect();
    Ok(bound.map_err(EstimationError::Effect)?)
}

/// The true robot behind the description `robot`, equal to that of [`simulate`] with the same options.
#[must_use]
pub fn true_robot(robot: &Robot, options: &SimulationOptions) -> Robot {
    draw_truth(robot, options, &mut ChaCha8Rng::seed_from_u64(options.seed))
}

/// A dataset whose inputs are drawn from their distributions around their values: readings by their noise, the drawn places,
/// home and target plane by their stated uncertainties (JCGM 101:2008, 6.4). Deviations of the parts are not drawn.
#[must_use]
pub fn drawn_inputs(dataset: &Dataset, rng: &mut ChaCha8Rng) -> Dataset {
    let mut robot = draw_truth(&dataset.robot, &SimulationOptions::new(0, 0), rng);
    robot.deviations.clone_from(&dataset.robot.deviations);
    let mut measurements = dataset.measurements.clone();
    add_noise(&robot, &mut measurements, rng);
    Dataset {
        robot,
        measurements,
    }
}

pub(super) fn draw_truth(
    robot: &Robot,
    options: &SimulationOptions,
    rng: &mut ChaCha8Rng,
) -> Robot {
    let mut truth = robot.clone();
    truth.effects.extend(options.effects.iter().cloned());
    for (index, cable) in truth.cables.iter_mut().enumerate() {
        // An unknown coordinate has no distribution to draw from.
        let sd = cable.pulley.entry_point_sd_m.each();
        let offset = sd.map(|sd| normal(rng, sd.unwrap_or(0.0)));
        match &options.geometry {
            TrueGeometry::Drawn => {
                for k in 0..3 {
                    cable.pulley.entry_point_m[k] += offset[k];
                }
            }
            TrueGeometry::EntryPoints(points) => cable.pulley.entry_point_m = points[index],
            TrueGeometry::Nominal => {}
        }
    }
    if options.geometry == TrueGeometry::Nominal {
        return truth;
    }
    truth.deviations = draw_deviations(robot, options.seed);
    if let Some(laser) = &mut truth.laser {
        let plane = &mut laser.target_plane;
        plane.offset_m += normal(rng, plane.offset_sd_m.unwrap_or(0.0));
    }
    if let Some(home) = &mut truth.home {
        let sd = home.covariance().diagonal().map(f64::sqrt);
        let twist = robot.platform.freedom().twist(|k| normal(rng, sd[k]));
        *home = home.at(&home.pose().perturbed(&twist));
    }
    truth
}

/// Stream of the random numbers of deviations, apart from all others so that stating tolerances changes nothing else.
const DEVIATIONS: u64 = 1;

/// Deviations of the parts drawn from the tolerances that a robot states, each in the form of an effect. They are those of
/// [`simulate`] with the same seed.
#[must_use]
pub fn draw_deviations(robot: &Robot, seed: u64) -> Vec<EffectSetting> {
    let Some(tolerances) = &robot.tolerances else {
        return Vec::new();
    };
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(DEVIATIONS);
    let draw = |mut deviation: PartDeviation| {
        let bound = &mut deviation.bound;
        let parameters = bound.effect.parameters().iter().zip(&deviation.prior_sd);
        for (value, (parameter, sd)) in bound.values.iter_mut().zip(parameters) {
            let drawn = normal(&mut rng, *sd);
            let one_sided = match parameter.tolerance {
                Some(tolerance) => tolerance.is_one_sided,
                None => parameter.bounds[0] == parameter.neutral,
            };
            *value += if one_sided { drawn.abs() } else { drawn };
        }
        bound.setting(robot)
    };
    let all = part_deviations(robot, tolerances);
    all.into_iter().map(draw).collect()
}

type Visits = (Vec<Pose>, Vec<Pose>, Grid);

/// Home, then poses that the cables can hold; true poses differ from the commanded ones by
/// about the errors of the drawing.
fn visit_poses(
    (robot, truth): (&mut Robot, &mut Robot),
    effects: &[BoundEffect],
    options: &SimulationOptions,
    rng: &mut ChaCha8Rng,
) -> Result<Visits, SimulationError> {
    let workspace = options.workspace.unwrap_or_else(|| Workspace::of(robot));
    let range = options.tension.unwrap_or_else(|| TensionRange::of(robot));
    let mut poses = Vec::new();
    let mut commanded = Vec::new();
    let mut tensions = Grid::new(robot.cable_count());
    let hold = |truth: &Robot, poses: &[Pose], pose: &Pose| {
        // Computed for this row only: a schedule of all rows for each would take time quadratic in the poses.
        let epoch = |row| Schedule::epoch_of(truth, row);
        let visit = Visit {
            // All rows count time and temperature from the first one.
            first: poses.first().map(|first| (epoch(0), first)),
            epoch: epoch(poses.len()),
            pose,
            motion: [Twist::zeros(); 2],
        };
        resting_state(truth, effects, &visit, &range)
    };
    if let (Some(home), Some(mut nominal)) = (truth.home, robot.home) {
        let pose = home.pose();
        inverse_kinematics(truth, &pose)?;
        let (pose, held) = hold(truth, &poses, &pose)?
            .ok_or_else(|| SimulationError::infeasible(&range, "the home pose"))?;
        if pose != home.pose() {
            // Where a platform hangs is known by measuring it there.
            let moved = pose.difference(&home.pose());
            nominal = nominal.at(&nominal.pose().perturbed(&moved));
            robot.home = Some(nominal);
            truth.home = Some(home.at(&pose));
        }
        tensions.push_row(&held);
        poses.push(pose);
        commanded.push(nominal.pose());
    }
    let first = poses.len();
    let wanted = options.at.as_ref().map_or(options.poses, Vec::len);
    for _ in 0..TRIES_PER_POSE * wanted {
        let done = poses.len() - first;
        if done == wanted {
            break;
        }
        let target = match &options.at {
            Some(commanded) => commanded[done],
            None => {
                let as_described = AfterHome {
                    robot,
                    effects: &[],
                    range: &range,
                };
                as_described.resting_pose(workspace.draw(robot, rng))
            }
        };
        let pose = displaced(robot, &target, rng);
        // A pose that has no cable path in either geometry cannot be commanded.
        if inverse_kinematics(truth, &pose).is_err() || inverse_kinematics(robot, &target).is_err()
        {
            continue;
        }
        if let Some((pose, held)) = hold(truth, &poses, &pose)? {
            tensions.push_row(&held);
            poses.push(pose);
            commanded.push(target);
        }
    }
    if poses.len() < first + wanted {
        return Err(SimulationError::infeasible(
            &range,
            match options.at {
                Some(_) => "a commanded pose",
                None => "enough poses of its workspace",
            },
        ));
    }
    Ok((poses, commanded, tensions))
}

pub(super) fn displaced(robot: &Robot, target: &Pose, rng: &mut ChaCha8Rng) -> Pose {
    let cables = robot.cables.iter();
    let sds = cables.flat_map(|c| c.pulley.entry_point_sd_m.each());
    perturbed(robot, target, sds.flatten().fold(0.0, f64::max), rng)
}

/// A pose displaced in the free coordinates by a standard deviation (m), and turned by what that is at the anchors.
pub(super) fn perturbed(robot: &Robot, target: &Pose, sd: f64, rng: &mut ChaCha8Rng) -> Pose {
    let arms = robot
        .cables
        .iter()
        .map(|c| nalgebra::Vector3::from(c.platform_anchor_m).norm());
    let arm = arms.fold(1e-9, f64::max);
    let size = [sd, (sd / arm).min(0.02)];
    let twist = robot.platform.freedom().twist(|k| normal(rng, size[k / 3]));
    target.perturbed(&twist)
}
