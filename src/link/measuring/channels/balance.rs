//! Checks that the measured tensions balance the weight of the platform, however the controller
//! distributes them.

use nalgebra::{DMatrix, DVector};
use tautline_core::geometry::Vec3;
use tautline_core::kinematics::{applied_wrench, structure_matrix};
use tautline_core::measurement::Measurements;
use tautline_core::robot::Robot;

use super::{FaultKind, Finding, rounded};

/// Root mean square of the imbalance that is investigated, in standard deviations of a tension and
/// as a fraction of the mean tension; smaller values are friction and geometry errors.
const NOISE: f64 = 5.0;
const FRICTION: f64 = 0.05;
/// Largest fraction of the squares that an explanation may leave, and the smallest ratio to the next best one.
const LEFT: f64 = 0.1;
const CLEARER: f64 = 3.0;
/// Smallest relevant deviation of a sensor's factor from 1.
const FACTOR: f64 = 0.3;

/// Terms of the balance at a pose: `A^T f + w`, torques divided by the size of the platform (N).
#[derive(Debug)]
pub(super) struct Balance {
    /// One row per cable.
    structure: DMatrix<f64>,
    tensions_n: Vec<f64>,
    missing_n: DVector<f64>,
}

/// Possible faults of the force sensors.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cause {
    Exchanged([usize; 2]),
    /// Cable, and reading of its sensor per true tension.
    Factor(usize, f64),
}

impl Balance {
    /// The balance at a measured pose; `None` unless all tensions were read.
    pub fn of(robot: &Robot, at: &Measurements) -> Option<Self> {
        let readings = robot.cables.iter().zip(at.force_n.row(0));
        let tensions = readings.map(|(c, reading)| Some(c.force_sensor?.tension_n(*reading)));
        let tensions_n = tensions.collect::<Option<Vec<f64>>>()?;
        let finite = tensions_n.iter().all(|tension| tension.is_finite());
        if tensions_n.len() != robot.cable_count() || !finite {
            return None;
        }
        let commanded = at.commanded.first().copied().flatten()?;
        let mut structure = structure_matrix(robot, &commanded).ok()?;
        let mut wrench = applied_wrench(robot, &commanded).ok()?;
        let arms = robot.cables.iter().map(|c| Vec3::from(c.platform_anchor_m));
        let arm_m = arms.map(|arm| arm.norm()).fold(0.0, f64::max);
        for (k, coordinate) in robot.platform.freedom().coordinates().iter().enumerate() {
            if coordinate.index() >= 3 && arm_m > 0.0 {
                structure.column_mut(k).scale_mut(1.0 / arm_m);
                wrench[k] /= arm_m;
            }
        }
        let missing_n = structure.tr_mul(&DVector::from_column_slice(&tensions_n)) + wrench;
        Some(Self {
            structure,
            tensions_n,
            missing_n,
        })
    }

    /// Adds the effect of a change of one tension.
    fn plus(&self, missing_n: &mut DVector<f64>, cable: usize, more_n: f64) {
        missing_n.axpy(more_n, &self.structure.row(cable).transpose(), 1.0);
    }

    fn squares_if(&self, cause: Cause) -> f64 {
        let mut missing_n = self.missing_n.clone();
        let tension = |cable: usize| self.tensions_n[cable];
        match cause {
            Cause::Exchanged([a, b]) => {
                self.plus(&mut missing_n, a, tension(b) - tension(a));
                self.plus(&mut missing_n, b, tension(a) - tension(b));
            }
            Cause::Factor(cable, factor) => {
                self.plus(&mut missing_n, cable, tension(cable) * (1.0 / factor - 1.0));
            }
        }
        missing_n.norm_squared()
    }
}

/// The factor of one sensor that leaves the smallest imbalance.
fn factor_of(cable: usize, poses: &[&Balance]) -> f64 {
    let (mut with, mut own) = (0.0, 0.0);
    for pose in poses {
        let pull = pose.structure.row(cable).transpose() * pose.tensions_n[cable];
        with += pull.dot(&pose.missing_n);
        own += pull.norm_squared();
    }
    1.0 / (1.0 - with / own)
}

/// The single fault of the force sensors that explains the imbalance, if there is one.
pub(super) fn explained(robot: &Robot, poses: &[&Balance]) -> Option<Finding> {
    let cables = robot.cable_count();
    let squares: f64 = poses.iter().map(|p| p.missing_n.norm_squared()).sum();
    let values: usize = poses.iter().map(|p| p.missing_n.len()).sum();
    let sensors = robot.cables.iter().filter_map(|c| c.force_sensor);
    let sd_n = sensors.map(|s| s.tension_sd_n).fold(0.0, f64::max);
    let tensions = poses.iter().flat_map(|p| &p.tensions_n);
    let mean_n = tensions.map(|t| t.abs()).sum::<f64>() / (poses.len() * cables) as f64;
    let missing_n = (squares / values as f64).sqrt();
    if missing_n < (NOISE * sd_n).max(FRICTION * mean_n) {
        return None;
    }
    let factors = (0..cables).map(|cable| Cause::Factor(cable, factor_of(cable, poses)));
    let pairs = (0..cables).flat_map(|a| (a + 1..cables).map(move |b| Cause::Exchanged([a, b])));
    let causes = factors.chain(pairs);
    let mut left: Vec<(f64, Cause)> = causes
        .map(|cause| (poses.iter().map(|p| p.squares_if(cause)).sum(), cause))
        .filter(|(left, _): &(f64, Cause)| left.is_finite())
        .collect();
    left.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(best, cause), (next, _), ..] = *left else {
        return None;
    };
    let clear = best < LEFT * squares && CLEARER * best < next;
    clear.then(|| words(robot, cause)).flatten()
}

fn words(robot: &Robot, cause: Cause) -> Option<Finding> {
    let name = |cable: usize| robot.cables.get(cable).map_or("", |c| c.name.as_str());
    match cause {
        Cause::Exchanged([a, b]) => Some(Finding {
            what: FaultKind::ForcesExchanged(b),
            cable: Some(a),
            text: format!(
                "{} and {}: the platform is in balance only with their force readings swapped. Are their plugs swapped?",
                name(a),
                name(b)
            ),
        }),
        Cause::Factor(_, factor) if (factor - 1.0).abs() < FACTOR => None,
        Cause::Factor(cable, factor) => Some(Finding {
            what: FaultKind::ForceFactor,
            cable: Some(cable),
            text: format!(
                "{}: its force sensor shows about {} times the tension that holds the platform in balance. Are its zero, sign and unit right?",
                name(cable),
                rounded(factor)
            ),
        }),
    }
}
