//! Start values of the poses.

use super::globals::Globals;
use super::options::{Options, Termination};
use super::problem::{Geometry, Poses, Problem};
use super::solution::Solution;
use crate::effect::{BoundEffect, Search};
use crate::geometry::Pose;
use crate::kinematics::{ForwardKinematics, inverse_kinematics};
use crate::robot::{Cable, Robot};

/// Largest root mean square length residual of a start pose, relative to the size of the frame:
/// well above the errors of drawings, and of the order at which false local minima begin.
const RELATIVE_RESIDUAL_LIMIT: f64 = 0.02;

/// Starting point of a solve.
#[derive(Debug, Clone, Copy)]
pub(super) enum Start<'a> {
    /// A solution of the same problem with other free effects.
    Known(&'a Solution),
    /// Nominal values, with the commanded or tracked poses.
    Given,
    /// Nominal values, with the poses from forward kinematics.
    Lengths,
}

impl<'a> Start<'a> {
    /// The known solution of a problem if it is close enough, else the given poses.
    pub(super) fn of(problem: &'a Problem<'_>, options: &Options) -> Self {
        let is_same = problem.geometry == Geometry::Estimated && problem.poses == Poses::Estimated;
        let is_close = |known: &&Solution| {
            known.converged()
                && known.chi2 < options.largest_start_misfit * known.degrees_of_freedom
        };
        let known = problem.known.as_deref().filter(|_| is_same);
        known.filter(is_close).map_or(Self::Given, Self::Known)
    }

    /// Values of the common parameters; effects keep the values they were bound with.
    pub(super) fn globals(self, problem: &Problem<'_>) -> Globals {
        let nominal = Globals::nominal(problem);
        match self {
            Self::Known(known) => Globals {
                effects: nominal.effects,
                deviations: known_deviations(nominal.deviations, &known.globals.deviations),
                ..known.globals.clone()
            },
            Self::Given | Self::Lengths => nominal,
        }
    }

    /// Pose of every row: that of the known solution, else the commanded one, else that of the external instrument, else
    /// that from forward kinematics with the nominal geometry, else home.
    pub(super) fn poses(
        self,
        problem: &Problem<'_>,
        globals: &Globals,
        rows: &[usize],
    ) -> Vec<Pose> {
        if let Self::Known(known) = self {
            let home = problem.home_row();
            let fitted = known.poses.iter().filter(|(row, _)| Some(*row) != home);
            return fitted.map(|(_, pose)| *pose).collect();
        }
        start_poses(problem, globals, rows, matches!(self, Self::Given))
    }
}

/// The deviations of a problem with the values that a solution has for the same parts. It may have others: a part whose whole
/// deviation is a free effect has no deviation besides.
fn known_deviations(mut deviations: Vec<BoundEffect>, known: &[BoundEffect]) -> Vec<BoundEffect> {
    for own in &mut deviations {
        if let Some(same) = known.iter().find(|other| is_same_part(own, other)) {
            own.values.clone_from(&same.values);
        }
    }
    deviations
}

/// Whether two deviations are of the same part and, for waves, of the same phase: a part has waves of two phases.
fn is_same_part(one: &BoundEffect, other: &BoundEffect) -> bool {
    let has_same_phase = match one.effect.search() {
        Search::Wave { phase, .. } => one.values.get(phase) == other.values.get(phase),
        _ => true,
    };
    one.has_target_of(other) && has_same_phase
}

/// Whether a solve that started from given poses ended in a local minimum.
pub(super) fn is_local_minimum(
    problem: &Problem<'_>,
    solution: &Solution,
    options: &Options,
) -> bool {
    let data = &problem.dataset.measurements;
    let has_given = !(data.commanded.is_empty() && data.tracked_position_m.is_empty());
    let movable = problem.poses == Poses::Estimated && problem.geometry == Geometry::Estimated;
    let misfit = solution.chi2 / solution.degrees_of_freedom.max(1.0);
    let is_bad =
        solution.termination == Termination::Stalled || misfit > options.local_minimum_misfit;
    has_given && movable && is_bad && solution.termination != Termination::Cancelled
}

/// Commanded or tracked poses if `use_given`, else poses from forward kinematics.
fn start_poses(
    problem: &Problem<'_>,
    globals: &Globals,
    rows: &[usize],
    use_given: bool,
) -> Vec<Pose> {
    let data = &problem.dataset.measurements;
    let mut search = None;
    let mut start = |row: &usize| {
        let commanded = data.commanded.get(*row).copied().flatten();
        let turned = commanded.map_or(globals.home.orientation, |pose| pose.orientation);
        let tracked = data.tracked_position_at(*row).map(|position| Pose {
            position,
            orientation: data.tracked_orientation_at(*row).unwrap_or(turned),
        });
        if problem.poses == Poses::HeldAtTracker {
            return tracked.unwrap_or(globals.home);
        }
        let given = commanded.or(tracked).filter(|_| use_given);
        given.unwrap_or_else(|| {
            let search = search.get_or_insert_with(|| PoseSearch::new(problem, globals));
            search
                .as_ref()
                .map_or(globals.home, |s| s.pose(problem, *row))
        })
    };
    rows.iter().map(&mut start).collect()
}

/// Forward kinematics from the readings of a row; effects and sag are not modelled.
struct PoseSearch<'a> {
    robot: &'a Robot,
    forward: ForwardKinematics,
    start: Pose,
    /// Geometric lengths at the start pose (m).
    lengths_m: Vec<f64>,
    /// Unstrained lengths at home, run-in included (m); for absolute lengths the run-in lengths.
    from_m: Vec<f64>,
}

impl<'a> PoseSearch<'a> {
    fn new(problem: &Problem<'a>, globals: &Globals) -> Option<Self> {
        let robot = &problem.dataset.robot;
        let forward = ForwardKinematics::new(robot).ok()?;
        let start = match robot.home {
            Some(_) => globals.home,
            None => *forward.centre(),
        };
        let states = inverse_kinematics(robot, &start).ok()?;
        let lengths_m: Vec<f64> = states.iter().map(|state| state.length_m).collect();
        let from = |(index, cable): (usize, &Cable)| {
            let run = cable.winch.length_to_pulley_m;
            match problem.home_row() {
                Some(home) => (run + lengths_m[index]) / stretch(problem, home, index),
                None => run,
            }
        };
        Some(Self {
            from_m: robot.cables.iter().enumerate().map(from).collect(),
            forward: forward
                .with_residual_limit(RELATIVE_RESIDUAL_LIMIT * robot.frame_diagonal_m()),
            robot,
            start,
            lengths_m,
        })
    }

    fn pose(&self, problem: &Problem<'_>, row: usize) -> Pose {
        let data = &problem.dataset.measurements;
        let length = |(index, cable): (usize, &Cable)| {
            let paid = if data.revolutions.is_empty() {
                data.length_m.get(row, index)
            } else {
                cable.winch.cable_per_revolution_m() * data.revolutions.get(row, index)
            };
            let unstrained = self.from_m[index] + paid;
            unstrained * stretch(problem, row, index) - cable.winch.length_to_pulley_m
        };
        let lengths: Vec<f64> = self.robot.cables.iter().enumerate().map(length).collect();
        let found = self.forward.solve(&lengths, &self.start);
        if found.converged || found.residual_rms_m < self.residual_at_start(&lengths) {
            found.pose
        } else {
            self.start
        }
    }

    fn residual_at_start(&self, lengths: &[f64]) -> f64 {
        let off = self.lengths_m.iter().zip(lengths).map(|(a, b)| a - b);
        let known: Vec<f64> = off.filter(|d| !d.is_nan()).collect();
        let sum: f64 = known.iter().map(|d| d * d).sum();
        (sum / known.len().max(1) as f64).sqrt()
    }
}

/// `1 + T/EA` from the tension reading; 1 without one.
fn stretch(problem: &Problem<'_>, row: usize, index: usize) -> f64 {
    let cable = &problem.dataset.robot.cables[index];
    let reading = problem.dataset.measurements.force_n.get(row, index);
    let strain = match (cable.force_sensor, cable.cable.axial_stiffness_n) {
        (Some(sensor), Some(stiffness)) if !reading.is_nan() => {
            sensor.tension_n(reading) / stiffness
        }
        _ => 0.0,
    };
    1.0 + strain
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::find;

    fn deviation(id: &str, cable: usize, values: &[f64]) -> BoundEffect {
        BoundEffect {
            effect: find(id).unwrap(),
            cables: vec![cable],
            targeted: true,
            values: values.to_vec(),
        }
    }

    #[test]
    fn known_deviations_are_those_of_the_same_parts() {
        let anchor = deviation("platform_anchor", 1, &[0.0; 3]);
        let scale = deviation("winch_scale", 2, &[0.0]);
        let [sine, cosine] =
            [0.0, 1.5].map(|phase| deviation("drum_eccentricity", 0, &[0.0, phase]));
        let known = [
            deviation("winch_scale", 2, &[0.01]),
            deviation("drum_eccentricity", 0, &[0.002, 1.5]),
            deviation("winch_scale", 3, &[0.02]),
            deviation("force_bias", 1, &[4.0]),
        ];
        let found = known_deviations(vec![anchor, scale, sine, cosine], &known);
        let values: Vec<&[f64]> = found.iter().map(|own| &own.values[..]).collect();
        // As many deviations, but of other parts.
        assert_eq!(values, [&[0.0; 3][..], &[0.01], &[0.0, 0.0], &[0.002, 1.5]]);
    }
}
