//! Fits of the tables of phases 1 and 2, computed once for each state of the tables.

use tautline_core::geometry::Pose;
use tautline_core::instrument::{
    ForceSensorCalibration, HomeAverage, HomeMeasurement, WinchCalibration,
};
use tautline_core::robot::{Home, Robot};
use tautline_session::{PhaseData, Session};

use super::apply::{set_cable_per_revolution, set_elongation_surface, set_force_sensor, set_home};
use super::fits::{
    ElongationFit, average_home, fit_elongation, fit_force_sensor, fit_home, fit_winch,
};

/// The fit of one cable's instrument, or one sentence why there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct PerCable<T> {
    /// Index of the cable.
    pub cable: usize,
    /// The fit.
    pub fit: Result<T, String>,
}

/// The robot with fitted values replacing its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// The robot, or one sentence why it cannot adopt the values.
    pub robot: Result<Robot, String>,
    /// Whether the robot of the session already has the values.
    pub is_used: bool,
    /// Fitted values that the robot cannot hold, one sentence each.
    pub left_out: Vec<String>,
}

/// Fits of phases 1 and 2; empty without measurements.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    robot: Robot,
    phases: PhaseData,
    /// Fits of the measured winches, in the order of the cables.
    pub winches: Vec<PerCable<WinchCalibration>>,
    /// The robot with the values of the winches.
    pub with_winches: Proposal,
    /// Fits of the measured force sensors, in the order of the cables.
    pub force_sensors: Vec<PerCable<ForceSensorCalibration>>,
    /// The robot with the values of the force sensors.
    pub with_force_sensors: Proposal,
    /// The home pose from the home platform.
    pub home: Option<Result<HomeMeasurement, String>>,
    /// The mean of all measurements of the home pose.
    pub home_average: Option<HomeAverage>,
    /// The robot with the mean home pose.
    pub with_home: Proposal,
    /// Fit of the elongation of the cables.
    pub elongation: Option<Result<ElongationFit, String>>,
    /// The robot with the fitted elongation.
    pub with_elongation: Proposal,
}

impl Calibration {
    /// Fits everything that was measured in a session.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        Self::new(&session.robot, &session.phases)
    }

    /// Fits everything in the tables of a robot.
    #[must_use]
    pub fn new(robot: &Robot, phases: &PhaseData) -> Self {
        let winches = per_cable(robot, |cable| {
            let measured = phases.winch.iter().any(|pair| pair.cable == cable);
            measured.then(|| fit_winch(robot, &phases.winch, cable))
        });
        let force_sensors = per_cable(robot, |cable| {
            let measured = phases.force.iter().any(|pair| pair.cable == cable);
            measured.then(|| fit_force_sensor(robot, &phases.force, cable))
        });
        let home = (!phases.home.is_empty()).then(|| fit_home(robot, &phases.home));
        let home_average = average_home(home.as_ref(), &phases.home_poses);
        let elongation =
            (!phases.elongation.is_empty()).then(|| fit_elongation(&phases.elongation));
        Self {
            with_winches: Proposal::new(robot, |robot, _| apply_winches(robot, &winches)),
            with_force_sensors: Proposal::new(robot, |robot, left_out| {
                apply_force_sensors(robot, &force_sensors, left_out);
                Ok(())
            }),
            with_home: with_home(robot, home_average.as_ref()),
            with_elongation: Proposal::new(robot, |robot, _| {
                apply_elongation(robot, elongation.as_ref());
                Ok(())
            }),
            winches,
            force_sensors,
            home,
            home_average,
            elongation,
            robot: robot.clone(),
            phases: PhaseData {
                check: Vec::new(),
                ..phases.clone()
            },
        }
    }

    /// The robot with all fitted values.
    #[must_use]
    pub fn with_all(&self) -> Proposal {
        Proposal::new(&self.robot, |robot, left_out| {
            apply_winches(robot, &self.winches)?;
            apply_force_sensors(robot, &self.force_sensors, left_out);
            apply_home(robot, self.home_average.as_ref());
            apply_elongation(robot, self.elongation.as_ref());
            Ok(())
        })
    }

    /// Whether the calibration was computed from the present robot and tables of a session.
    #[must_use]
    pub fn is_of(&self, session: &Session) -> bool {
        let (ours, theirs) = (&self.phases, &session.phases);
        ours.winch == theirs.winch
            && ours.force == theirs.force
            && ours.home == theirs.home
            && ours.home_poses == theirs.home_poses
            && ours.elongation == theirs.elongation
            && self.robot == session.robot
    }
}

fn per_cable<T>(
    robot: &Robot,
    fit: impl Fn(usize) -> Option<Result<T, String>>,
) -> Vec<PerCable<T>> {
    let cables = 0..robot.cable_count();
    let fits = cables.filter_map(|cable| fit(cable).map(|fit| PerCable { cable, fit }));
    fits.collect()
}

impl Proposal {
    /// The robot after `change`, which adds values that the robot cannot hold to its second argument.
    fn new(
        robot: &Robot,
        change: impl FnOnce(&mut Robot, &mut Vec<String>) -> Result<(), String>,
    ) -> Self {
        let (mut changed, mut left_out) = (robot.clone(), Vec::new());
        let result = change(&mut changed, &mut left_out).and_then(|()| {
            let checked = changed.check();
            checked.map_err(|error| format!("The values are not valid for a robot: {error}"))
        });
        Self {
            is_used: result.is_ok() && changed == *robot,
            robot: result.map(|()| changed),
            left_out,
        }
    }
}

/// Sets the drums of the winches so that they pay out the measured lengths.
fn apply_winches(robot: &mut Robot, fits: &[PerCable<WinchCalibration>]) -> Result<(), String> {
    for PerCable { cable, fit } in fits {
        if let (Ok(fit), Some(cable)) = (fit, robot.cables.get_mut(*cable)) {
            set_cable_per_revolution(&mut cable.winch, fit.cable_per_revolution_m)
                .map_err(|message| format!("{}: {message}", cable.name))?;
        }
    }
    Ok(())
}

/// Sets gain and bias of the force sensors; sensors that the robot does not have are added to `left_out`.
fn apply_force_sensors(
    robot: &mut Robot,
    fits: &[PerCable<ForceSensorCalibration>],
    left_out: &mut Vec<String>,
) {
    for PerCable { cable, fit } in fits {
        if let (Ok(fit), Some(cable)) = (fit, robot.cables.get_mut(*cable)) {
            left_out.extend(set_force_sensor(cable, fit.gain, fit.bias_n).err());
        }
    }
}

fn apply_home(robot: &mut Robot, average: Option<&HomeAverage>) {
    if let Some(average) = average {
        set_home(robot, average);
    }
}

fn apply_elongation(robot: &mut Robot, fit: Option<&Result<ElongationFit, String>>) {
    if let Some(Ok(fit)) = fit {
        set_elongation_surface(robot, &fit.choice.surface);
    }
}

fn with_home(robot: &Robot, average: Option<&HomeAverage>) -> Proposal {
    let proposal = Proposal::new(robot, |robot, _| {
        apply_home(robot, average);
        Ok(())
    });
    // The fit starts from the home pose of the robot, so after adoption it still changes by rounding.
    let is_used = match (&proposal.robot, &robot.home) {
        (Ok(changed), Some(now)) => changed.home.is_some_and(|new| is_same_home(&new, now)),
        _ => proposal.is_used,
    };
    Proposal {
        is_used,
        ..proposal
    }
}

/// Whether two home poses are equal to rounding (m, rad).
fn is_same_home(a: &Home, b: &Home) -> bool {
    const ROUNDING: f64 = 1e-9;
    let (pose_a, pose_b): (Pose, Pose) = (a.pose(), b.pose());
    let sd = |home: &Home| home.covariance().diagonal().map(f64::sqrt);
    pose_a.difference(&pose_b).amax() < ROUNDING
        && (sd(a) - sd(b)).amax() < ROUNDING
        && a.covariance.is_some() == b.covariance.is_some()
}
