//! Packs constants, readings and poses.

use super::POSE_NUMBERS;
use super::cable_rows::CableConstants;
use super::columns::{ColumnStore, Packed, StoredColumn, packed};
use super::layout::Layout;
use crate::estimation::problem::Problem;
use crate::geometry::Pose;
use crate::real::Packet;

/// Readings of the platform's instruments.
#[derive(Clone)]
pub(super) struct InstrumentInputs {
    pub laser: StoredColumn,
    pub swivel: Vec<StoredColumn>,
    pub tracker_position: Vec<StoredColumn>,
    pub tracker_inverse_sd: Vec<StoredColumn>,
    pub tracker_orientation: Vec<StoredColumn>,
    pub inclination: Vec<StoredColumn>,
}

/// Constants of each cable; at home, lengths are predictions and tensions are not
/// latent.
pub(super) fn constants_of(problem: &Problem<'_>, is_home: bool) -> Vec<CableConstants> {
    let has_forces = !problem.dataset.measurements.force_n.is_empty();
    let needs_sag = |bound: &crate::effect::BoundEffect| bound.effect.needs_sag;
    let held = || problem.held_effects.iter().chain(&problem.held_deviations);
    let effects = || held().chain(problem.estimated());
    let constants = |(index, cable): (usize, &crate::robot::Cable)| {
        let measured = problem.assumes_tensions() || has_forces && cable.force_sensor.is_some();
        let latent = problem.has_latent_tension() && !is_home;
        CableConstants {
            run: cable.winch.length_to_pulley_m,
            length_sd: if is_home {
                1.0
            } else {
                cable.winch.length_sd_m
            },
            tension_sd: (problem.tension_sd_n(index).filter(|_| latent)).unwrap_or(0.0),
            sags: measured && (cable.cable.weight_n_per_m != 0.0 || effects().any(needs_sag)),
            surface: cable.cable.elongation_surface.clone().filter(|_| measured),
            swivel_zero: cable.pulley.swivel_zero.unwrap_or_default(),
            swivel_sd: cable.pulley.swivel_sd_rad.unwrap_or(f64::INFINITY),
        }
    };
    (problem.dataset.robot.cables.iter().enumerate())
        .map(constants)
        .collect()
}

/// Poses as position and quaternion, packet by packet; the last pose is repeated to fill the last packet.
pub(super) fn pack_poses<T: Packet>(poses: &[Pose]) -> Packed {
    let count = poses.len().next_multiple_of(T::LANES);
    let mut values = packed(count * POSE_NUMBERS);
    for index in 0..count {
        let Some(pose) = poses.get(index).or(poses.last()) else {
            continue;
        };
        let (batch, lane) = (index / T::LANES, index % T::LANES);
        let numbers = pose.position.iter().copied().chain(pose.orientation_wxyz());
        for (k, value) in numbers.enumerate() {
            values[(batch * POSE_NUMBERS + k) * T::LANES + lane] = value;
        }
    }
    values
}

/// Readings of the instruments at `rows`.
pub(super) fn pack_instruments<T: Packet>(
    store: &mut ColumnStore<T>,
    problem: &Problem<'_>,
    layout: &Layout,
    rows: &[usize],
) -> InstrumentInputs {
    let data = &problem.dataset.measurements;
    let nan = f64::NAN;
    let mut triple = |present: bool, column: &[[f64; 3]]| -> Vec<StoredColumn> {
        let count = if present { 3 } else { 0 };
        let pack = |k: usize| store.varying(rows.iter().map(|row| column[*row][k]), nan);
        (0..count).map(pack).collect()
    };
    let tracker_position = triple(layout.tracker_position.is_some(), &data.tracked_position_m);
    let inclination = triple(layout.inclination.is_some(), &data.inclination_rad);
    let tracker_sd = problem
        .dataset
        .robot
        .tracker
        .map_or([nan; 3], |t| t.position_sd_m.each());
    let inverse_sd = |row: usize, k: usize| {
        let own = data.tracked_position_sd_m.get(row).map_or(nan, |sd| sd[k]);
        (if own.is_nan() { tracker_sd[k] } else { own }).recip()
    };
    let tracker_inverse_sd = tracker_position
        .iter()
        .enumerate()
        .map(|(k, _)| store.varying(rows.iter().map(|row| inverse_sd(*row, k)), 0.0))
        .collect();
    let quaternion = if layout.tracker_orientation.is_some() {
        4
    } else {
        0
    };
    let tracker_orientation = (0..quaternion)
        .map(|k| {
            store.varying(
                rows.iter()
                    .map(|row| data.tracked_orientation_wxyz[*row][k]),
                nan,
            )
        })
        .collect();
    let swivels = if layout.swivel.is_some() {
        layout.cables
    } else {
        0
    };
    let swivel = (0..swivels)
        .map(|cable| {
            // Without zero direction or standard deviation the reading cannot be used.
            let pulley = &problem.dataset.robot.cables[cable].pulley;
            let usable = pulley.swivel_zero.is_some() && pulley.swivel_sd_rad.is_some();
            let at = |row: &usize| {
                if usable {
                    data.swivel_rad.get(*row, cable)
                } else {
                    nan
                }
            };
            store.varying(rows.iter().map(at), nan)
        })
        .collect();
    InstrumentInputs {
        laser: store.varying(rows.iter().map(|row| data.laser_at(*row)), nan),
        swivel,
        tracker_position,
        tracker_inverse_sd,
        tracker_orientation,
        inclination,
    }
}
