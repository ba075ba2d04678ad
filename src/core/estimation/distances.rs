//! Measured distances, which couple two poses each.
//!
//! The poses are eliminated one by one from their own readings, see [`super::evaluator`]: with `u = L^T dx + y + Y dg` these
//! have the loss `u^T u` of the poses' steps `dx` and the common step `dg`. A distance with the whitened residual `r` and the
//! derivative `D` by the poses is then the row `r' + A' dg + B u` with `B = D L^-T`, `r' = r - B y` and `A' = -B Y`. Its
//! minimum over `u` is `u = -B^T K^-1 (r' + A' dg)` with `K = 1 + B B^T`, which leaves the rows
//! `F^-1 (r' + A' dg)`, `K = F F^T`, for the common parameters. A distance does not move a pose along a coordinate that no other
//! reading determines.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector3};

use super::evaluator::{Elimination, Parts};
use super::globals::Globals;
use super::home::HomeRow;
use super::parameter::{Parameter, ParameterId};
use super::problem::Problem;
use super::system::ColumnMap;
use crate::effect::{DistancePorts, Dual};
use crate::geometry::Pose;
use crate::measurement::DistanceReading;
use crate::real::Packet;

/// The distances of a problem at a state, with the poses eliminated.
#[derive(Debug, Clone)]
pub(super) struct Distances {
    /// Whitened residuals `r`, prediction minus reading.
    residuals: DVector<f64>,
    /// `F^-1 r'`.
    pub remaining: DVector<f64>,
    /// `F^-1 A'`: distances x parameters.
    pub design: DMatrix<f64>,
    /// `B`: for each distance the poses, by their order among the estimated ones, with its six numbers for each.
    by_pose: Vec<Vec<(usize, [f64; 6])>>,
    /// Factor of `K`.
    factor: Cholesky<f64, Dyn>,
    /// Loss of the distances at the present poses.
    pub loss: f64,
}

/// The state that the distances are evaluated at.
pub(super) struct DistanceState<'s> {
    pub problem: &'s Problem<'s>,
    pub globals: &'s Globals,
    pub parameters: &'s [Parameter],
    pub map: &'s ColumnMap,
    pub home: &'s HomeRow,
    pub huber: Option<f64>,
}

impl DistanceState<'_> {
    /// The ports of the distance in this row, with the derivative by one parameter of one of the effects, if any.
    fn ports(&self, row: usize, by: Option<(usize, usize)>) -> DistancePorts {
        let mut ports = DistancePorts::NOMINAL;
        for (effect, bound) in self.globals.effects.iter().enumerate() {
            let dual = |(k, value): (usize, &f64)| match by == Some((effect, k)) {
                true => Dual::variable(*value),
                false => Dual::constant(*value),
            };
            let values: Vec<Dual> = bound.values.iter().enumerate().map(dual).collect();
            (bound.effect.change_distance)(&values, row, &mut ports);
        }
        ports
    }

    /// Derivatives of the ports of a distance by the parameters, by their index, where they are not zero.
    fn slopes(&self, row: usize) -> Vec<(usize, DistancePorts)> {
        let held = self.problem.held_effects.len();
        let slope = |(column, parameter): (usize, &Parameter)| {
            let ParameterId::Effect { effect, parameter } = parameter.id else {
                return None;
            };
            let ports = self.ports(row, Some((held + effect, parameter)));
            let acts = ports.gain.slope != 0.0 || ports.shift.slope != 0.0;
            acts.then_some((column, ports))
        };
        let parameters = self.parameters.iter().enumerate();
        parameters.filter_map(slope).collect()
    }
}

impl Distances {
    /// Evaluates the distances at poses that were eliminated last where they are now; `None` if there are none.
    pub fn evaluate<T: Packet>(state: &DistanceState<'_>, poses: &Parts<'_, T>) -> Option<Self> {
        if !state.problem.has_distances() {
            return None;
        }
        let readings = &state.problem.dataset.measurements.distances;
        let at: Vec<(usize, Pose)> = poses.poses().collect();
        let order = |row: usize| at.iter().position(|(own, _)| *own == row);
        let mut eliminations: Vec<Option<Elimination<f64>>> = vec![None; at.len()];
        let (count, n) = (readings.len(), state.parameters.len());
        let mut own = Self {
            residuals: DVector::zeros(count),
            remaining: DVector::zeros(count),
            design: DMatrix::zeros(count, n),
            by_pose: vec![Vec::new(); count],
            factor: DMatrix::identity(count, count).cholesky()?,
            loss: 0.0,
        };
        for (k, reading) in readings.iter().enumerate() {
            let places = reading.rows.map(order);
            let pose = |place: Option<usize>| place.map_or(state.globals.home, |p| at[p].1);
            let ports = state.ports(reading.number, None);
            let mut linear = LinearDistance::new(reading, places.map(pose), &ports);
            own.loss += linear.weigh_down(state.huber);
            let LinearDistance {
                mut residual,
                by_pose,
                by_gain,
                by_shift,
            } = linear;
            own.residuals[k] = residual;
            for (parameter, ports) in state.slopes(reading.number) {
                own.design[(k, parameter)] +=
                    by_gain * ports.gain.slope + by_shift * ports.shift.slope;
            }
            let mut columns = vec![0.0; poses.layout().columns];
            for (place, slopes) in places.into_iter().zip(by_pose) {
                let Some(place) = place else {
                    add_home_slopes(&mut own.design, k, state.parameters, &slopes);
                    continue;
                };
                let elimination =
                    eliminations[place].get_or_insert_with(|| poses.elimination(place));
                let half = elimination.half_solve(slopes);
                residual -= dot(&half, &elimination.residual);
                for (sum, column) in columns.iter_mut().zip(&elimination.columns) {
                    *sum -= dot(&half, column);
                }
                own.by_pose[k].push((place, half));
            }
            own.remaining[k] = residual;
            let mapped = state.map.map_row(state.home, &columns);
            for (parameter, slope) in mapped.into_iter().enumerate() {
                own.design[(k, parameter)] += slope;
            }
        }
        own.factor = own.coupling().cholesky()?;
        let lower = own.factor.l();
        lower.solve_lower_triangular_mut(&mut own.remaining);
        lower.solve_lower_triangular_mut(&mut own.design);
        Some(own)
    }

    /// `K = 1 + B B^T`.
    fn coupling(&self) -> DMatrix<f64> {
        let count = self.by_pose.len();
        DMatrix::from_fn(count, count, |i, k| {
            let pairs = self.by_pose[i].iter().flat_map(|(place, half)| {
                let others = self.by_pose[k].iter();
                let same = others.filter(move |(other, _)| other == place);
                same.map(move |(_, other)| dot(half, other))
            });
            f64::from(u8::from(i == k)) + pairs.sum::<f64>()
        })
    }

    /// Number of distances.
    pub fn count(&self) -> usize {
        self.residuals.len()
    }

    /// Reduction of the loss that steps of the poses alone predict, beside that of their own readings.
    pub fn predicted_reduction(&self) -> f64 {
        self.residuals.norm_squared() - self.remaining.norm_squared()
    }

    /// `-u` of the poses that distances connect, for a common step: what is added to `y` before the poses move.
    pub fn pulls(&self, step: &[f64]) -> Vec<(usize, [f64; 6])> {
        let mut weights = &self.remaining + &self.design * DVector::from_column_slice(step);
        let upper = self.factor.l().transpose();
        upper.solve_upper_triangular_mut(&mut weights);
        let ends = self.by_pose.iter().zip(&weights);
        ends.flat_map(|(ends, weight)| {
            let pull = move |(place, half): &(usize, [f64; 6])| (*place, half.map(|b| b * weight));
            ends.iter().map(pull)
        })
        .collect()
    }

    /// How the distances act on the pose with this order; `None` if none does.
    pub fn pull_of(&self, place: usize) -> Option<DistancePull> {
        let slopes = self.by_pose.iter().map(|ends| {
            let own = ends.iter().find(|(other, _)| *other == place);
            own.map_or([0.0; 6], |(_, half)| *half)
        });
        let slopes: Vec<[f64; 6]> = slopes.collect();
        if slopes.iter().flatten().all(|slope| *slope == 0.0) {
            return None;
        }
        // `F^-1 B` of the pose.
        let mut scaled = DMatrix::from_fn(slopes.len(), 6, |k, axis| slopes[k][axis]);
        self.factor.l().solve_lower_triangular_mut(&mut scaled);
        Some(DistancePull {
            estimate: -scaled.tr_mul(&self.remaining),
            spread: scaled.tr_mul(&scaled),
            by_parameter: -scaled.tr_mul(&self.design),
        })
    }

    /// `A'` and `K`.
    pub fn coupled(&self) -> (DMatrix<f64>, DMatrix<f64>) {
        let lower = self.factor.l();
        (&lower * &self.design, &lower * lower.transpose())
    }

    /// The distances as readings: index, whitened residual, share of its variance that is left with known parameters, which is
    /// the diagonal of `K^-1`, and derivative by the parameters, `K^-1 A'`.
    pub fn readings(&self) -> Vec<(usize, f64, f64, DVector<f64>)> {
        let inverse = self.factor.inverse();
        let mut gradients = self.design.clone();
        let upper = self.factor.l().transpose();
        upper.solve_upper_triangular_mut(&mut gradients);
        let reading = |k: usize| {
            let gradient = gradients.row(k).transpose();
            (k, self.residuals[k], inverse[(k, k)], gradient)
        };
        (0..self.count()).map(reading).collect()
    }
}

/// How distances act on one pose, in units of the information of the pose's own readings.
pub(super) struct DistancePull {
    /// `u`.
    pub estimate: DVector<f64>,
    /// Covariance of `u` with known parameters, 6 x 6.
    pub spread: DMatrix<f64>,
    /// Derivative of `u` by the parameters, 6 x parameters.
    pub by_parameter: DMatrix<f64>,
}

/// Whitened residual of a distance and its derivatives.
struct LinearDistance {
    residual: f64,
    /// By the two poses (translation, rotation vector; base frame).
    by_pose: [[f64; 6]; 2],
    by_gain: f64,
    by_shift: f64,
}

impl LinearDistance {
    fn new(reading: &DistanceReading, poses: [Pose; 2], ports: &DistancePorts) -> Self {
        let (gain, shift) = (ports.gain.value, ports.shift.value);
        let arms = poses.map(|pose| pose.orientation * Vector3::from(reading.point_m));
        let points = [0, 1].map(|k| poses[k].position + arms[k]);
        let between: Vector3<f64> = points[1] - points[0];
        let distance = between.norm();
        // Two poses at one place have no direction between them, which moves neither.
        let along = between * (gain / (distance.max(f64::MIN_POSITIVE) * reading.sd_m));
        let slopes = |sign: f64, arm: &Vector3<f64>| {
            let (along, turned) = (along * sign, arm.cross(&along) * sign);
            [along.x, along.y, along.z, turned.x, turned.y, turned.z]
        };
        Self {
            residual: (gain * distance + shift - reading.distance_m) / reading.sd_m,
            by_pose: [slopes(-1.0, &arms[0]), slopes(1.0, &arms[1])],
            by_gain: distance / reading.sd_m,
            by_shift: reading.sd_m.recip(),
        }
    }

    /// Weighs down a residual beyond the limit of a robust loss, and returns its loss.
    fn weigh_down(&mut self, huber: Option<f64>) -> f64 {
        let size = self.residual.abs();
        let Some(limit) = huber.filter(|limit| size > *limit) else {
            return size * size;
        };
        let weight = (limit / size).sqrt();
        self.residual *= weight;
        self.by_gain *= weight;
        self.by_shift *= weight;
        let slopes = self.by_pose.iter_mut().flatten();
        slopes.for_each(|slope| *slope *= weight);
        limit * (2.0 * size - limit)
    }
}

/// Adds the derivatives of a distance by the estimated home pose.
fn add_home_slopes(
    design: &mut DMatrix<f64>,
    row: usize,
    parameters: &[Parameter],
    slopes: &[f64; 6],
) {
    for (column, parameter) in parameters.iter().enumerate() {
        if let ParameterId::Home(coordinate) = parameter.id {
            design[(row, column)] += slopes[coordinate.index()];
        }
    }
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
