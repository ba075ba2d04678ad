//! Statistical comparison of two identified geometries of the same robot (deformation analysis).
//!
//! **Estimates.** Both runs were solved with the same drawing as prior. What they share must not count as agreement,
//! so the priors `P` of the robot itself (entry points, target plane, effects) are removed: with the
//! information `I` and the estimate `m` of a run, and the centre `m_0` of its priors,
//!
//! `J = I - k P`, `g = m + J^-1 k P (m - m_0)`, `cov g = J^-1`.
//!
//! `k = 0.99` keeps a hundredth, so that the variance of undetermined parameters is large, not infinite. The home pose was
//! approached anew in each run: its prior stays. The runs are independent: `d = g_B - g_A` has the covariance `S = J_A^-1 + J_B^-1`.
//!
//! **Datum.** Each run counts from its own home pose, so a common motion of all pulleys and the target plane by a small
//! shift `t` and rotation `w` about the middle `c` of the pulleys is no change of the robot. With
//! `G [t; w] = t + w x (a_i - c)` for pulley `i`, the motion is that of generalised least squares,
//!
//! `[t; w] = (G^T S^-1 G)^-1 G^T S^-1 d`,
//!
//! in those directions only in which nothing known exactly in both runs (coordinates of pulleys, the home pose) would
//! move. A pulley that has moved must not pull the others with it: the most conspicuous one is given a displacement
//! of its own, as columns beside `G`, and again, until none is conspicuous (Pelzer 1971; Caspary 1987). If most pulleys
//! have moved, the motion is that of the majority in this sense.
//!
//! **Tests.** A displacement `v` with covariance `V` has `chi2 = v^T V^-1 v` with as many degrees of freedom as
//! coordinates. Probabilities are corrected for the number of tests (Holm 1979), so that two runs of one
//! robot differ anywhere with at most the probability of the level.

mod datum;
mod differences;
mod estimate;
mod least_squares;
#[cfg(test)]
mod tests;

use nalgebra::{DMatrix, DVector, Matrix3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::estimation::{Problem, Solution};
use crate::geometry::{Coordinate, Vec3};

use datum::{Datum, FramePart};
use differences::{effects, home};
use estimate::Estimate;

/// A solved problem, with the description and data that it was solved from.
#[derive(Debug, Clone, Copy)]
pub struct Identified<'a> {
    /// What was solved.
    pub problem: &'a Problem<'a>,
    /// Its solution.
    pub solution: &'a Solution,
}

/// Why two geometries cannot be compared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ComparisonError {
    /// Not the same robot.
    #[error("found other cables in the second run ({second}) than in the first ({first})")]
    OtherCables {
        /// Cables of the first run.
        first: String,
        /// Cables of the second run.
        second: String,
    },
    /// The data of a run do not determine all parameters.
    #[error(
        "the data of the {run} run leave parts of the geometry open, so that there is nothing to compare"
    )]
    Undetermined {
        /// `first` or `second`.
        run: &'static str,
    },
    /// Neither run estimates a coordinate of a pulley.
    #[error("neither run estimates a coordinate of a pulley")]
    NothingEstimated,
}

/// Outcome of a test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Test {
    /// Chi-square.
    pub chi2: f64,
    /// Degrees of freedom.
    #[serde(rename = "dof")]
    pub degrees_of_freedom: usize,
    /// Probability of a chi-square at least as large by noise alone.
    pub p_value: f64,
    /// The same, corrected for the number of tests.
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

/// Difference of a point, second run less first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Displacement {
    /// Along the axes of the base frame (m).
    pub vector_m: Vec3,
    /// Its covariance along the axes (m^2); zero along coordinates known in both runs.
    pub covariance: Matrix3<f64>,
}

impl Displacement {
    /// Length (m).
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.vector_m.norm()
    }

    /// Standard deviation of the length (m), to first order: along the displacement.
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
    /// As the runs have it, each in its own datum.
    pub raw: Displacement,
    /// Relative to the pulleys that did not move; `None` where too few others are left to determine it.
    pub relative: Option<Displacement>,
    /// Test of the relative displacement against noise; `None` where it is not determined.
    pub test: Option<Test>,
    /// Whether it has moved, at the level of the comparison.
    pub moved: bool,
}

/// Common motion of all pulleys and the target plane.
#[derive(Debug, Clone, PartialEq)]
pub struct CommonMotion {
    /// Shift of the middle of the pulleys (m).
    pub shift_m: Vec3,
    /// Rotation vector about it (rad).
    pub rotation_rad: Vec3,
    /// Covariance of `[shift; rotation]` (6 x 6; m^2, m rad, rad^2); zero in directions that cannot move.
    pub covariance: DMatrix<f64>,
    /// Number of directions of motion that change no coordinate known exactly.
    pub freedom: usize,
    /// Test against the uncertainty of both home poses.
    pub test: Option<Test>,
}

/// Difference of a single quantity, second run less first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScalarDifference {
    /// In the first run (SI units); `None` where it is not part of it.
    pub first: Option<f64>,
    /// In the second run; `None` where it is not part of it.
    pub second: Option<f64>,
    /// Difference; of a quantity that only one run has, from its value without effect.
    pub difference: f64,
    /// Its standard deviation.
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

/// Difference of the home pose, each in its own datum.
#[derive(Debug, Clone, PartialEq)]
pub struct HomeDifference {
    /// Coordinates that are estimated (m, rad), with difference and standard deviation.
    pub coordinates: Vec<(Coordinate, f64, f64)>,
    /// Test against noise.
    pub test: Option<Test>,
}

/// How well a run is explained by its model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitQuality {
    /// Chi-square.
    pub chi2: f64,
    /// Degrees of freedom.
    #[serde(rename = "dof")]
    pub degrees_of_freedom: f64,
    /// Probability of a chi-square at least as large if model and noise are right: where it is small, differences
    /// may come from unmodelled effects.
    pub p_value: Option<f64>,
}

/// Differences between two runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Probability with which two runs of one robot are called different anywhere.
    pub level: f64,
    /// Every pulley, in the robot's order.
    pub pulleys: Vec<PulleyDifference>,
    /// Common motion of all; `None` where exactly known coordinates allow none.
    pub motion: Option<CommonMotion>,
    /// Offset of the target plane, the common motion taken out; `None` where neither run estimates it.
    pub plane: Option<ScalarDifference>,
    /// Home pose; `None` where neither run estimates it.
    pub home: Option<HomeDifference>,
    /// Effects that a run estimates.
    pub effects: Vec<EffectDifference>,
    /// Whether pulleys and target plane together differ by more than a common motion; a test of its own.
    pub global: Option<Test>,
    /// How well both runs are explained.
    pub fits: [FitQuality; 2],
}

impl Comparison {
    /// Whether a pulley, the target plane or an effect differs.
    /// A common motion and the home pose are no change of the robot.
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

/// Compares two runs of the same robot at the given probability of a false difference, 0.05 for example.
///
/// # Errors
/// If the robots have other cables, or a run leaves its geometry open.
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
    let undetermined = |run| ComparisonError::Undetermined { run };
    let runs = [
        Estimate::of(first).ok_or(undetermined("first"))?,
        Estimate::of(second).ok_or(undetermined("second"))?,
    ];
    let datum = Datum::of(&runs).ok_or(ComparisonError::NothingEstimated)?;
    let effects = effects(&runs);
    let home = home(&runs);
    // Besides pulleys and plane: effects, the home pose, the common motion.
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
        plane: datum.plane(&runs, &moved),
        home,
        effects,
        global: datum.global(),
        fits: [fit(first), fit(second)],
    };
    correct(&mut comparison);
    Ok(comparison)
}

/// Corrects all probabilities for their number and marks the pulleys that have moved.
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

/// Probabilities corrected for their number (Holm 1979): in rising order, each times the number of those that are
/// not smaller, never below the one before.
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
