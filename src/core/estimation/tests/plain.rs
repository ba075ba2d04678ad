//! Problems R1 and R2 once more, written plainly: all parameters, poses and tensions stacked, numerical
//! Jacobian, dense Gauss-Newton. Shares no equations with the estimator.

use nalgebra::{DMatrix, DVector};

use crate::geometry::{Pose, Twist, Vec3};
use crate::measurement::Dataset;
use crate::robot::Cable;

/// Values of all unknowns.
#[derive(Clone)]
pub struct State {
    pub entry: Vec<Vec3>,
    pub plane: f64,
    /// Row by row; the home row first.
    pub poses: Vec<Pose>,
    /// Row by row.
    pub tensions: Vec<Vec<f64>>,
}

/// One scalar unknown.
#[derive(Clone, Copy)]
enum Unknown {
    Entry(usize, usize),
    Plane,
    Pose(usize, usize),
    Tension(usize, usize),
}

/// The stacked problem.
pub struct Plain<'a> {
    data: &'a Dataset,
    /// Whether tensions are unknown and equilibrium holds (R2).
    latent: bool,
    unknowns: Vec<Unknown>,
}

/// Solution of the plain problem.
pub struct FoundEffect {
    pub state: State,
    pub chi2: f64,
    /// Covariance of the free entry point coordinates, cable by cable.
    pub covariance: DMatrix<f64>,
}

/// Length and direction from the anchor to the pulley by equations 3 and 4, with arc cosines.
fn cable_path(cable: &Cable, entry: Vec3, pose: &Pose) -> (f64, Vec3) {
    let radius = cable.pulley.radius_m;
    let axis = Vec3::from(cable.pulley.swivel_axis);
    let anchor = pose.transform(&cable.platform_anchor_m.into());
    let d = anchor - entry;
    let along = d.dot(&axis);
    let across = d - axis * along;
    let facing = across.normalize();
    let to_centre = ((across.norm() - radius).powi(2) + along * along).sqrt();
    let free = (to_centre * to_centre - radius * radius).sqrt();
    let wrap = (free / to_centre).acos() + (along / to_centre).acos();
    let centre = entry + facing * radius;
    let exit = centre - facing * (radius * wrap.cos()) + axis * (radius * wrap.sin());
    (free + radius * wrap, (exit - anchor) / free)
}

impl<'a> Plain<'a> {
    pub fn new(data: &'a Dataset, latent: bool) -> Self {
        let robot = &data.robot;
        let mut unknowns = Vec::new();
        for (index, cable) in robot.cables.iter().enumerate() {
            let sd = cable.pulley.entry_point_sd_m.each().map(Option::unwrap);
            let free = (0..3).filter(|axis| sd[*axis] > 0.0);
            unknowns.extend(free.map(|axis| Unknown::Entry(index, axis)));
        }
        unknowns.push(Unknown::Plane);
        for row in 0..data.measurements.len() {
            let free = robot.platform.freedom();
            let pose = |c: &crate::geometry::Coordinate| Unknown::Pose(row, c.index());
            unknowns.extend(free.coordinates().iter().map(pose));
            if latent {
                unknowns.extend((0..robot.cable_count()).map(|c| Unknown::Tension(row, c)));
            }
        }
        Self {
            data,
            latent,
            unknowns,
        }
    }

    fn start(&self) -> State {
        let robot = &self.data.robot;
        let data = &self.data.measurements;
        let cables = || robot.cables.iter().enumerate();
        let reading = |row: usize, (index, cable): (usize, &Cable)| {
            let sensor = cable.force_sensor.unwrap();
            (data.force_n.get(row, index) - sensor.bias_n) / sensor.tension_gain
        };
        let rows = 0..data.len();
        State {
            entry: cables()
                .map(|(_, c)| c.pulley.entry_point_m.into())
                .collect(),
            plane: robot.laser.unwrap().target_plane.offset_m,
            poses: data.commanded.iter().map(|pose| pose.unwrap()).collect(),
            tensions: rows
                .map(|row| cables().map(|c| reading(row, c)).collect())
                .collect(),
        }
    }

    fn moved(&self, state: &State, step: &[f64]) -> State {
        let mut moved = state.clone();
        let mut twists = vec![Twist::zeros(); state.poses.len()];
        for (unknown, delta) in self.unknowns.iter().zip(step) {
            match *unknown {
                Unknown::Entry(cable, axis) => moved.entry[cable][axis] += delta,
                Unknown::Plane => moved.plane += delta,
                Unknown::Pose(row, k) => twists[row][k] = *delta,
                Unknown::Tension(row, cable) => moved.tensions[row][cable] += delta,
            }
        }
        for (pose, twist) in moved.poses.iter_mut().zip(&twists) {
            *pose = pose.perturbed(twist);
        }
        moved
    }

    fn residuals(&self, state: &State) -> Vec<f64> {
        let robot = &self.data.robot;
        let data = &self.data.measurements;
        let start = self.start();
        let mut r = Vec::new();
        let unstrained = |row: usize, index: usize| {
            let cable = &robot.cables[index];
            let (length, _) = cable_path(cable, state.entry[index], &state.poses[row]);
            let strain = state.tensions[row][index] / cable.cable.axial_stiffness_n.unwrap();
            (cable.winch.length_to_pulley_m + length) / (1.0 + strain)
        };
        let laser = robot.laser.unwrap();
        let normal = Vec3::from(laser.target_plane.normal);
        for row in 0..data.len() {
            let pose = &state.poses[row];
            let mut wrench = Twist::zeros();
            let mut load = |at: Vec3, force: Vec3| {
                let torque = (at - pose.position).cross(&force);
                wrench += Twist::new(force.x, force.y, force.z, torque.x, torque.y, torque.z);
            };
            for (index, cable) in robot.cables.iter().enumerate() {
                if row > 0 {
                    let winch = &cable.winch;
                    let turn = std::f64::consts::PI * winch.drum_diameter_m;
                    let paid = turn.hypot(winch.drum_pitch_m) / winch.gear_ratio
                        * data.revolutions.get(row, index);
                    let off = unstrained(row, index) - unstrained(0, index) - paid;
                    r.push(off / winch.length_sd_m);
                }
                let tension = state.tensions[row][index];
                if self.latent {
                    let sd = cable.force_sensor.unwrap().tension_sd_n;
                    r.push((tension - start.tensions[row][index]) / sd);
                }
                let (_, direction) = cable_path(cable, state.entry[index], pose);
                let anchor = pose.transform(&cable.platform_anchor_m.into());
                load(anchor, direction * tension);
            }
            let centre = pose.transform(&robot.platform.center_of_mass_m.into());
            load(centre, robot.gravity() * robot.platform.mass_kg.unwrap());
            let sd = robot.wrench_sd().unwrap();
            let free = robot.platform.freedom();
            for k in free.coordinates().iter().map(|c| c.index()) {
                let sd = if k < 3 { sd.force_n } else { sd.torque_nm };
                r.extend(self.latent.then(|| wrench[k] / sd));
            }
            let origin = pose.transform(&laser.origin_m.into());
            let beam = pose.orientation * Vec3::from(laser.direction);
            let distance = (state.plane - normal.dot(&origin)) / normal.dot(&beam);
            r.push((distance - data.laser_m[row]) / laser.sd_m);
        }
        for (index, cable) in robot.cables.iter().enumerate() {
            let sd = cable.pulley.entry_point_sd_m.each().map(Option::unwrap);
            for axis in (0..3).filter(|axis| sd[*axis] > 0.0) {
                r.push((state.entry[index] - start.entry[index])[axis] / sd[axis]);
            }
        }
        r.push((state.plane - start.plane) / laser.target_plane.offset_sd_m.unwrap());
        let home = robot.home.unwrap();
        let off = state.poses[0].difference(&home.pose());
        let free: Vec<usize> = (robot.platform.freedom().coordinates().iter())
            .map(|c| c.index())
            .collect();
        let covariance = DMatrix::from_fn(free.len(), free.len(), |i, k| {
            let sd = [home.position_sd_m, home.orientation_sd_rad];
            match home.covariance {
                Some(measured) => measured[free[i]][free[k]],
                None if i == k => sd[free[i] / 3].powi(2),
                None => 0.0,
            }
        });
        // The symmetric square root of the inverse; any square root gives the same sum of squares.
        let eigen = covariance.symmetric_eigen();
        for (value, direction) in eigen
            .eigenvalues
            .iter()
            .zip(eigen.eigenvectors.column_iter())
        {
            let along: f64 = free.iter().zip(&direction).map(|(k, d)| off[*k] * d).sum();
            r.push(along / value.sqrt());
        }
        r
    }

    fn jacobian(&self, state: &State) -> DMatrix<f64> {
        let mut columns = Vec::new();
        for (k, unknown) in self.unknowns.iter().enumerate() {
            let step = match unknown {
                Unknown::Tension(..) => 1e-3,
                _ => 1e-6,
            };
            let mut change = vec![0.0; self.unknowns.len()];
            change[k] = step;
            let plus = DVector::from(self.residuals(&self.moved(state, &change)));
            change[k] = -step;
            let minus = DVector::from(self.residuals(&self.moved(state, &change)));
            columns.push((plus - minus) / (2.0 * step));
        }
        DMatrix::from_columns(&columns)
    }

    /// Undamped Gauss-Newton until a step promises less than 1e-12 of the sum of squares.
    pub fn solve(&self) -> FoundEffect {
        let mut state = self.start();
        for _ in 0..50 {
            let residuals = DVector::from(self.residuals(&state));
            let jacobian = self.jacobian(&state);
            let (q, r) = jacobian.qr().unpack();
            let fitted = q.tr_mul(&residuals);
            let inverse = r.try_inverse().unwrap();
            let chi2 = residuals.norm_squared();
            if fitted.norm_squared() < 1e-12 * chi2 {
                let entry = self.unknowns.iter();
                let entry = entry
                    .take_while(|u| matches!(u, Unknown::Entry(..)))
                    .count();
                let covariance = &inverse * inverse.transpose();
                return FoundEffect {
                    state,
                    chi2,
                    covariance: covariance.view((0, 0), (entry, entry)).into_owned(),
                };
            }
            let step = -(&inverse * fitted);
            state = self.moved(&state, step.as_slice());
        }
        panic!("the plain solver did not converge");
    }
}
