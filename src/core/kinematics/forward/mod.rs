//! Forward kinematics: the pose from the cable lengths.
//!
//! Minimises `sum_i (l_i(r, R) - l_i,measured)^2` over the free coordinates of the platform, with
//! `l_i` the geometric length over the pulley from entry point to anchor (m). Gauss-Newton steps on
//! the normal equations, damped after Levenberg and Marquardt only where a plain step fails;
//! further starts from a fixed sequence where the residual stays large. Deterministic.
//!
//! With as many cables as free coordinates several poses can have the same lengths; the one that
//! the start leads to is returned. With more cables a second pose is exceptional, but local minima
//! with a residual are not: see [`ForwardKinematics::with_residual_limit`].
//! Sources: Jin et al. 2018, equation 5; Pott 2018, chapter 4.4; Nocedal and Wright 2006, chapter 10.

mod levenberg_marquardt;
mod normal;
mod starts;

use pulp::{Arch, Simd, WithSimd};

use crate::geometry::{Freedom, Pose, PosePacket};
use crate::robot::Robot;

use super::KinematicsError;
use super::cable_arrays::{CableArrays, MAX_CABLES};
use levenberg_marquardt::{LengthProblem, Minimum, minimise};

/// Conditioning below which a pose counts as singular; see [`ForwardSolution::conditioning`].
const SINGULAR: f64 = 1e-6;
/// Default of the residual limit, relative to the size of the frame.
const RELATIVE_RESIDUAL_LIMIT: f64 = 1e-6;
/// A residual below this, relative to the size of the frame, is rounding: no start can do better.
const RELATIVE_ROUNDING: f64 = 1e-11;
/// Default number of starts.
const STARTS: usize = 40;

/// Forward kinematics of one robot, prepared for many solves.
///
/// ```
/// use tautline_core::geometry::Pose;
/// use tautline_core::kinematics::{ForwardKinematics, inverse_kinematics};
/// use tautline_core::robot::presets;
///
/// let robot = presets::find("mini").unwrap().robot;
/// let pose = Pose::from_parts([0.05, -0.02, 0.1], [1.0, 0.0, 0.0, 0.0]);
/// let cables = inverse_kinematics(&robot, &pose)?;
/// let lengths_m: Vec<f64> = cables.iter().map(|cable| cable.length_m).collect();
///
/// let found = ForwardKinematics::new(&robot)?.solve(&lengths_m, &Pose::identity());
/// assert!(found.converged);
/// assert!(found.pose.difference(&pose).norm() < 1e-9);
/// # Ok::<(), tautline_core::kinematics::KinematicsError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ForwardKinematics {
    cables: CableArrays,
    free: [bool; 6],
    freedom: Freedom,
    centre: Pose,
    frame_size_m: f64,
    residual_limit_m: f64,
    starts: usize,
    arch: Arch,
}

/// The pose found, and how far it can be trusted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForwardSolution {
    /// The pose with the smallest residual that was found.
    pub pose: Pose,
    /// Whether the iteration converged to a regular pose within the residual limit at which every cable has a
    /// path.
    pub converged: bool,
    /// Root mean square of the length residuals (m).
    pub residual_rms_m: f64,
    /// Number of steps tried, over all starts.
    pub iterations: usize,
    /// Number of starts used; 1 if the given one sufficed.
    pub starts_used: usize,
    /// Independence of the free coordinates in the length Jacobian: the sine of the smallest angle
    /// between a column and the span of the columns before it. 1: orthogonal; 0:
    /// singular, some motion changes no length.
    pub conditioning: f64,
}

impl ForwardKinematics {
    /// Prepares the forward kinematics of `robot`.
    ///
    /// # Errors
    /// If the geometry of a pulley is invalid (naming it), or the number of cables is outside 1 to 64.
    pub fn new(robot: &Robot) -> Result<Self, KinematicsError> {
        let cables = CableArrays::new(robot)?;
        let freedom = robot.platform.freedom();
        let mut free = [false; 6];
        for coordinate in freedom.coordinates() {
            free[coordinate.index()] = true;
        }
        let frame_size_m = starts::frame_size(&cables);
        let home = robot.home.map(|home| home.pose());
        Ok(Self {
            centre: home.unwrap_or_else(|| starts::centre(&cables, robot, frame_size_m)),
            cables,
            free,
            freedom,
            frame_size_m,
            residual_limit_m: RELATIVE_RESIDUAL_LIMIT * frame_size_m,
            starts: STARTS,
            arch: Arch::new(),
        })
    }

    /// Sets the largest rms residual (m) of a pose that counts as found.
    ///
    /// The default, a millionth of the frame's size, is for exact lengths. For measured lengths,
    /// choose a few times their error. A tighter limit recognises local minima more reliably:
    /// a small platform can have some that fit to one percent of the frame.
    #[must_use]
    pub fn with_residual_limit(mut self, limit_m: f64) -> Self {
        self.residual_limit_m = limit_m;
        self
    }

    /// Sets the largest number of starts; 1 allows only the given one.
    #[must_use]
    pub fn with_starts(mut self, starts: usize) -> Self {
        self.starts = starts.max(1);
        self
    }

    /// Number of cables.
    #[must_use]
    pub fn cable_count(&self) -> usize {
        self.cables.count()
    }

    /// The start of [`Self::solve_from_anywhere`]: the home pose or the centre of the frame.
    #[must_use]
    pub fn centre(&self) -> &Pose {
        &self.centre
    }

    /// Finds the pose with the given lengths (m) from entry points to platform anchors, starting from
    /// `start`, which also provides the coordinates that are not free.
    ///
    /// The first pose within the residual limit is returned; further starts are tried only if that
    /// from `start` is not. A length that is NaN or missing leaves its cable out. Never fails:
    /// see [`ForwardSolution::converged`].
    #[must_use]
    pub fn solve(&self, lengths_m: &[f64], start: &Pose) -> ForwardSolution {
        self.search(lengths_m, start, self.residual_limit_m)
    }

    /// As [`Self::solve`], from the [centre](Self::centre) of the workspace; returns the best of all
    /// starts unless one fits to rounding.
    #[must_use]
    pub fn solve_from_anywhere(&self, lengths_m: &[f64]) -> ForwardSolution {
        let rounding = RELATIVE_ROUNDING * self.frame_size_m;
        self.search(lengths_m, &self.centre, rounding)
    }

    fn search(&self, lengths_m: &[f64], start: &Pose, enough_m: f64) -> ForwardSolution {
        let mut lengths = [f64::NAN; MAX_CABLES];
        let count = lengths_m.len().min(self.cables.count());
        lengths[..count].copy_from_slice(&lengths_m[..count]);
        let known = lengths.iter().filter(|l| !l.is_nan()).count();
        self.arch.dispatch(Search {
            problem: self,
            lengths: &lengths,
            known,
            start,
            enough_m,
        })
    }
}

/// One solve, generic over the vectors of the processor.
struct Search<'a> {
    problem: &'a ForwardKinematics,
    lengths: &'a [f64; MAX_CABLES],
    known: usize,
    start: &'a Pose,
    /// No further start is tried once the rms residual (m) is below this.
    enough_m: f64,
}

impl WithSimd for Search<'_> {
    type Output = ForwardSolution;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> ForwardSolution {
        let mut best = self.minimise(simd, self.start);
        let (mut iterations, mut used) = (best.iterations, 1);
        // Fewer lengths than coordinates: no start can make the pose unique.
        let determined = self.known >= self.problem.freedom.count();
        while determined && used < self.problem.starts && !self.suffices(&best) {
            let next = starts::further(self.problem, self.start, &best.pose.into(), used);
            let found = self.minimise(simd, &next);
            iterations += found.iterations;
            used += 1;
            if self.rank(&found) < self.rank(&best) {
                best = found;
            }
        }
        let converged = self.accepts(&best);
        ForwardSolution {
            pose: best.pose.into(),
            converged,
            residual_rms_m: self.rms(&best),
            iterations,
            starts_used: used,
            conditioning: best.conditioning,
        }
    }
}

impl Search<'_> {
    #[inline(always)]
    fn minimise<S: Simd>(&self, simd: S, start: &Pose) -> Minimum {
        let problem = LengthProblem {
            cables: &self.problem.cables,
            measured: self.lengths,
            free: &self.problem.free,
        };
        minimise(simd, problem, PosePacket::from(start))
    }

    fn rms(&self, found: &Minimum) -> f64 {
        (found.cost / self.known.max(1) as f64).sqrt()
    }

    /// Order of preference: accepted minima first, then by residual.
    fn rank(&self, found: &Minimum) -> (bool, f64) {
        (!self.accepts(found), found.cost)
    }

    fn suffices(&self, found: &Minimum) -> bool {
        self.accepts(found) && self.rms(found) <= self.enough_m
    }

    fn accepts(&self, found: &Minimum) -> bool {
        found.converged
            && !found.blocked
            && found.conditioning > SINGULAR
            && self.known >= self.problem.freedom.count()
            && self.rms(found) <= self.problem.residual_limit_m
    }
}

#[cfg(test)]
mod tests;
