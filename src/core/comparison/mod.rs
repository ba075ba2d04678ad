//! Statistical comparison of two identified geometries of the same robot (deformation analysis).
//!
//! **Estimates.** Both runs were solved with the same drawing as prior. A shared prior must not count as agreement,
//! so the priors `P` of the robot itself (entry points, target plane, effects) are removed: with the
//! information `I` and the estimate `m` of a run, and the centre `m_0` of its priors,
//!
//! `J = I - k P`, `g = m + J^-1 k P (m - m_0)`, `cov g = J^-1`.
//!
//! `k = 0.99` keeps one percent of the prior, so that the variance of undetermined parameters is large but finite. The home
//! pose was approached anew in each run, so its prior stays. The deviations of the parts within their tolerances are the
//! same in both runs: they are unknowns of both together, with their prior once. Apart from them the runs are independent:
//! without tolerances `d = g_B - g_A` has the covariance `S = J_A^-1 + J_B^-1`.
//!
//! **Datum.** Each run is referred to its own home pose, so a common motion of all pulleys and the target plane by a small
//! translation `t` and rotation `w` about the centroid `c` of the pulleys is no change of the robot. With
//! `G [t; w] = t + w x (a_i - c)` for pulley `i`, the motion is estimated by generalised least squares,
//!
//! `[t; w] = (G^T S^-1 G)^-1 G^T S^-1 d`,
//!
//! in those directions only in which no coordinate known exactly in both runs (of a pulley, of the home pose) would
//! move. A displaced pulley must not pull the others with it: the most significant one is given a displacement
//! of its own, as additional columns beside `G`, and so on until none is significant (Pelzer 1971; Caspary 1987). If most
//! pulleys have moved, the datum is that of the largest group that moved together.
//!
//! **Tests.** A displacement `v` with covariance `V` has `chi2 = v^T V^-1 v` with as many degrees of freedom as
//! coordinates. P-values are corrected for the number of tests (Holm 1979), so that the probability of finding any
//! difference between two runs of an unchanged robot is at most the level.

mod datum;
mod differences;
mod estimate;
mod least_squares;
mod rigid_motion;
#[cfg(test)]
mod tests;

use nalgebra::{DMatrix, DVector, Matrix3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::estimation::{Problem, Solution};
use crate::geometry::{Coordinate, Vec3};

use datum::{Datum, FramePart};
use differences::{effects, home};
use estimate::Estimates;
pub(crate) use estimate::{DeviationKey, data_information, deviation_key};
pub(crate) use rigid_motion::RigidMotion;

/// An identification problem with its solution.
#[derive(Debug, Clone, Copy)]
pub struct Identified<'a> {
    /// The problem that was solved.
    pub problem: &'a Problem<'a>,
    /// Its solution.
    pub solution: &'a Solution,
}

/// Errors of [`compare`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ComparisonError {
    /// The cables of the two runs differ.
    #[error("the second run has the cables {second}, but the first has {first}")]
    OtherCables {
        /// Cables of the first run.
        first: String,
        /// Cables of the second run.
        second: String,
    },
    /// The data of a run do not determine all parameters.
    #[error(
        "the data of the {run} run do not determine the whole geometry, so the runs cannot be compared"
    )]
    Undetermined {
        /// `first` or `second`.
        run: &'static str,
    },
    /// Neither run estimates a coordinate of a pulley.
    #[error("neither run estimates a coordinate of a pulley")]
    NothingEstimated,
}

/// Result of a chi-square test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Test {
    /// Test statistic, chi-square.
    pub chi2: f64,
    /// Degrees of freedom.
    #[serde(rename = "dof")]
    pub degrees_of_freedom: usize,
    /// Probability that noise alone gives a chi-square at least as large.
    pub p_value: f64,
    /// p-value corrected for the number of tests.
    pub p_corrected: f64,
}

impl Test {
    fn of(value: &DVector<f64>, covariance: &DMatrix<f64>) -> Option<Self> {
        let solved = covariance.clone().cholesky()?.solve(value);
        let chi2 = value.dot(&solved);
        let p_value = crate::statistics::chi_square_survival(chi2, value.len() as f64)?;
        Some(Self {
            chi2,
            degrees_of_freedom: value.len(),
            p_value,
            p_corrected: p_value,
        })
    }
}

/// Displacement of a point, second run less first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Displacement {
    /// Components along the axes of the base frame (m).
    pub vector_m: Vec3,
    /// Covariance of the components (m^2); zero for coordinates known exactly in both runs.
    pub covariance: Matrix3<f64>,
}

impl Displacement {
    /// Length of the displacement (m).
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.vector_m.norm()
    }

    /// Standard deviation of the length (m), to first order: that of the component along the displacement.
    #[must_use]
    pub fn length_sd_m(&self) -> f64 {
        match self.vector_m.try_normalize(0.0) {
            Some(along) => along.dot(&(self.covariance * along)).max(0.0).sqrt(),
            None => self.covariance.trace().max(0.0).sqrt(),
        }
    }
}

/// Difference of a pulley's entry point.
#[derive(Debug, Clone, PartialEq)]
pub struct PulleyDifference {
    /// Name of the cable.
    pub cable: String,
    /// As estimated, each run in its own datum.
    pub raw: Displacement,
    /// Relative to the pulleys that did not move; `None` where too few others are left to determine it.
    pub relative: Option<Displacement>,
    /// Test of the relative displacement against noise; `None` where it is not determined.
    pub test: Option<Test>,
    /// Whether the pulley has moved, at the significance level of the comparison.
    pub moved: bool,
}

/// Common motion of all pulleys and the target plane.
#[derive(Debug, Clone, PartialEq)]
pub struct CommonMotion {
    /// Translation of the centroid of the pulleys (m).
    pub shift_m: Vec3,
    /// Rotation vector about it (rad).
    pub rotation_rad: Vec3,
    /// Covariance of `[shift; rotation]` (6 x 6; m^2, m rad, rad^2); zero in directions held by known coordinates.
    pub covariance: DMatrix<f64>,
    /// Number of directions of motion that change no coordinate known exactly.
    pub freedom: usize,
    /// Test against zero, given the uncertainty of both home poses.
    pub test: Option<Test>,
}

/// Difference of a single quantity, second run less first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScalarDifference {
    /// Value in the first run (SI units); `None` if the run does not contain the quantity.
    pub first: Option<f64>,
    /// Value in the second run (SI units); `None` if the run does not contain the quantity.
    pub second: Option<f64>,
    /// Second less first; a run that does not contain the quantity counts with its neutral value.
    pub difference: f64,
    /// Standard deviation of the difference.
    pub sd: f64,
    /// Test against noise.
    pub test: Option<Test>,
}

/// Difference of a parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EffectDifference {
    /// Effect of the catalogue.
    pub effect: String,
    /// Names of its cables; empty for all.
    pub targets: Vec<String>,
    /// Name of the parameter.
    pub parameter: String,
    /// SI unit.
    pub unit: String,
    /// Values in both runs.
    pub size: ScalarDifference,
}

/// Difference of the home pose, each run in its own datum.
#[derive(Debug, Clone, PartialEq)]
pub struct HomeDifference {
    /// Estimated coordinates, each with difference and standard deviation (m or rad).
    pub coordinates: Vec<(Coordinate, f64, f64)>,
    /// Test against noise.
    pub test: Option<Test>,
}

/// Goodness of fit of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitQuality {
    /// Chi-square.
    pub chi2: f64,
    /// Degrees of freedom.
    #[serde(rename = "dof")]
    pub degrees_of_freedom: f64,
    /// Probability of a chi-square at least as large if model and noise are right; if it is small, differences
    /// may come from unmodelled effects.
    pub p_value: Option<f64>,
}

/// Result of comparing two runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Significance level: the probability of finding any difference between two runs of an unchanged robot.
    pub level: f64,
    /// Every pulley, in the robot's order.
    pub pulleys: Vec<PulleyDifference>,
    /// Common motion of all parts; `None` if the coordinates known exactly leave no direction free.
    pub motion: Option<CommonMotion>,
    /// Offset of the target plane, relative to the common motion; `None` where neither run estimates it.
    pub plane: Option<ScalarDifference>,
    /// Home pose; `None` where neither run estimates it.
    pub home: Option<HomeDifference>,
    /// Effects that a run estimates.
    pub effects: Vec<EffectDifference>,
    /// Tests whether pulleys and target plane together differ by more than a common motion.
    pub global: Option<Test>,
    /// Goodness of fit of both runs.
    pub fits: [FitQuality; 2],
}

impl Comparison {
    /// Whether a pulley, the target plane or an effect differs significantly. A common motion or another home pose is not a
    /// change of the robot.
    #[must_use]
    pub fn is_different(&self) -> bool {
        let differs = |test: &Option<Test>| test.is_some_and(|t| t.p_corrected < self.level);
        self.pulleys.iter().any(|pulley| pulley.moved)
            || self
                .plane
                .as_ref()
                .is_some_and(|plane| differs(&plane.test))
            || self.effects.iter().any(|effect| differs(&effect.size.test))
    }
}

/// Compares two runs of the same robot at a significance level, for example 0.05.
///
/// # Errors
/// If the robots have different cables, or the data of a run do not determine its geometry.
pub fn compare(
    first: &Identified<'_>,
    second: &Identified<'_>,
    level: f64,
) -> Result<Comparison, ComparisonError> {
    let names = |run: &Identified<'_>| -> Vec<String> {
        let cables = run.problem.dataset.robot.cables.iter();
        cables.map(|cable| cable.name.clone()).collect()
    };
    let cables = names(first);
    if cables != names(second) {
        return Err(ComparisonError::OtherCables {
            first: cables.join(", "),
            second: names(second).join(", "),
        });
    }
    let estimates = Estimates::of([first, second])?;
    let runs = &estimates.runs;
    let datum = Datum::of(&estimates).ok_or(ComparisonError::NothingEstimated)?;
    let effects = effects(&estimates);
    let home = home(&estimates);
    // The tests of effects, home pose and common motion share the level with those of pulleys and plane.
    let others = effects.len() + usize::from(home.is_some()) + usize::from(datum.freedom() > 0);
    let moved = datum.moved(level, others);
    let fit = |run: &Identified<'_>| FitQuality {
        chi2: run.solution.chi2,
        degrees_of_freedom: run.solution.degrees_of_freedom,
        p_value: run.solution.p_value(),
    };
    let mut comparison = Comparison {
        level,
        pulleys: cables
            .into_iter()
            .enumerate()
            .map(|(cable, name)| {
                let own = datum.displacement(FramePart::Pulley(cable), &moved);
                PulleyDifference {
                    cable: name,
                    raw: datum.raw(cable),
                    relative: own.as_ref().map(|own| datum.spatial(cable, own)),
                    test: own.as_ref().and_then(|(v, c)| Test::of(v, c)),
                    moved: false,
                }
            })
            .collect(),
        motion: datum.motion(&moved),
        plane: datum.plane(runs, &moved),
        home,
        effects,
        global: datum.global(),
        fits: [fit(first), fit(second)],
    };
    correct(&mut comparison);
    Ok(comparison)
}

/// Corrects all p-values for the number of tests and marks the pulleys that have moved.
fn correct(comparison: &mut Comparison) {
    let level = comparison.level;
    let pulleys = comparison.pulleys.iter_mut().map(|p| &mut p.test);
    let effects = comparison.effects.iter_mut().map(|e| &mut e.size.test);
    let plane = comparison.plane.iter_mut().map(|p| &mut p.test);
    let home = comparison.home.iter_mut().map(|h| &mut h.test);
    let motion = comparison.motion.iter_mut().map(|m| &mut m.test);
    let all = pulleys
        .chain(effects)
        .chain(plane)
        .chain(home)
        .chain(motion);
    let mut tests: Vec<&mut Test> = all.flatten().collect();
    let raw: Vec<f64> = tests.iter().map(|test| test.p_value).collect();
    for (test, corrected) in tests.iter_mut().zip(holm(&raw)) {
        test.p_corrected = corrected;
    }
    for pulley in &mut comparison.pulleys {
        pulley.moved = pulley.test.is_some_and(|test| test.p_corrected < level);
    }
}

/// Corrects p-values for their number (Holm 1979): in ascending order, each is multiplied by the number of those that
/// are not smaller, and raised to the one before if that is larger.
fn holm(p_values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|a, b| p_values[*a].total_cmp(&p_values[*b]));
    let mut corrected = vec![1.0; p_values.len()];
    let mut least = 0.0_f64;
    for (rank, index) in order.into_iter().enumerate() {
        let factor = (p_values.len() - rank) as f64;
        least = least.max((factor * p_values[index]).min(1.0));
        corrected[index] = least;
    }
    corrected
}
