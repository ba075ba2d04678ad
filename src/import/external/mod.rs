//! Poses measured by an external instrument in its own frame, also of a body with three or more markers.
//!
//! Markers determine the pose of the body that carries them. The pose of the instrument's frame in the robot's frame, and of
//! the body on the platform, are estimated from the commanded poses, otherwise from the cable lengths. This is as accurate as
//! these are, and sufficient as a start: the effects `tracker_frame`, `tracker_target` and `tracker_tilt` estimate the
//! remainder jointly with all other parameters.

mod placement;
mod platform_poses;
mod rigid_body;

use std::collections::BTreeMap;

use tautline_core::geometry::{Pose, Vec3};
use tautline_core::measurement::Measurements;
use tautline_core::robot::Robot;

use crate::cutting::{Averaged, CutPose};
use crate::recipe::{Instrument, Quantity, QuantityKind as Kind, Recipe};
use placement::{Alignment, Pair, align};
use platform_poses::platform_poses;
pub(crate) use rigid_body::FEWEST as FEWEST_MARKERS;
use rigid_body::{MarkerPositions, RigidBody};

/// Maximum number of poses used to align a frame or a body.
const MOST_POSES: usize = 2000;
/// Measured poses are in another frame if an alignment brings them closer by this factor.
const CLOSER: f64 = 4.0;
/// Distance relative to the size of the robot that an alignment to its frame may leave; more is another mistake.
const ALIGNED: f64 = 0.01;
/// Distance relative to the size of the robot below which measured poses are in its frame: the difference is then an error
/// to be estimated, such as that of the home pose.
const CLOSE: f64 = 0.05;

/// Transforms the measured poses into the robot's frame, computing them from markers where these were recorded. Returns the
/// recipe with the alignment that was found.
///
/// # Errors
/// In one sentence, if the markers or the poses do not determine the alignment.
pub(crate) fn place(
    poses: &mut [CutPose],
    recipe: &Recipe,
    robot: &Robot,
    notices: &mut Vec<String>,
) -> Result<Recipe, String> {
    let mut recipe = recipe.clone();
    let has_markers = poses
        .iter()
        .any(|pose| numbers_of_markers(pose).next().is_some());
    let instrument = recipe.instrument.take();
    if instrument.is_none() && !has_markers {
        return Ok(recipe);
    }
    let mut instrument = *instrument.unwrap_or_default();
    if has_markers {
        poses_of_markers(poses, &mut instrument, notices)?;
    }
    let pairs = pairs(poses, robot);
    let alignment = align(
        &thinned(&pairs),
        (
            instrument.frame.map(Pose::from),
            instrument.body.map(Pose::from),
        ),
    )
    .map_err(|message| format!("the frame of the external instrument: {message}"))?;
    notices.push(words(&alignment, &instrument));
    poses.iter_mut().for_each(|pose| bring(pose, &alignment));
    instrument.frame = Some(alignment.frame.into());
    instrument.body = Some(alignment.body.into());
    recipe.instrument = Some(Box::new(instrument));
    Ok(recipe)
}

/// A sentence if measured positions are in another frame, or those of another point of the platform, for a robot of a given
/// size.
pub(crate) fn other_frame(positions: &[(Vec3, Pose)], robot_m: f64) -> Option<String> {
    let pair = |(measured_m, platform): &(Vec3, Pose)| Pair {
        measured_m: *measured_m,
        turned: None,
        platform: *platform,
    };
    let pairs: Vec<Pair> = positions.iter().map(pair).collect();
    let apart = pairs
        .iter()
        .map(|p| (p.measured_m - p.platform.position).norm_squared());
    let rms_m = (apart.sum::<f64>() / pairs.len().max(1) as f64).sqrt();
    let alignment = align(&thinned(&pairs), (None, None)).ok()?;
    let is_other = rms_m > CLOSE * robot_m
        && alignment.rms_m * CLOSER < rms_m
        && alignment.rms_m < ALIGNED * robot_m;
    is_other.then(|| {
        format!(
            "the measured poses are in another frame, or are those of another point: they are off by {} mm, and by {} mm when aligned to the \
             robot's frame and the platform's origin",
            millimetres(rms_m),
            millimetres(alignment.rms_m)
        )
    })
}

/// Transforms the measured positions of a table into the robot's frame by the commanded poses; returns whether these
/// determine it. A coordinate that is not measured stays missing.
pub(crate) fn align_measured(data: &mut Measurements) -> bool {
    let rows = data.commanded.iter().zip(&data.tracked_position_m);
    let pairs: Vec<Option<Pair>> = rows
        .enumerate()
        .map(|(row, (commanded, read))| {
            let platform = (*commanded)?;
            let place = platform.position;
            let or_commanded = |k: usize| {
                if read[k].is_finite() {
                    read[k]
                } else {
                    place[k]
                }
            };
            let is_read = read.iter().filter(|v| v.is_finite()).count() > 1;
            is_read.then(|| Pair {
                measured_m: Vec3::new(or_commanded(0), or_commanded(1), or_commanded(2)),
                turned: data.tracked_orientation_at(row),
                platform,
            })
        })
        .collect();
    let known: Vec<Pair> = pairs.iter().flatten().copied().collect();
    let Ok(alignment) = align(&thinned(&known), (None, None)) else {
        return false;
    };
    for (row, pair) in pairs.into_iter().enumerate() {
        let Some(pair) = pair else { continue };
        let frame = &alignment.frame;
        let turned = pair
            .turned
            .map(|q| frame.orientation * q * alignment.body.orientation.inverse());
        let platform = turned.unwrap_or(pair.platform.orientation);
        let position = frame.transform(&pair.measured_m) - platform * alignment.body.position;
        for (read, found) in data.tracked_position_m[row].iter_mut().zip(&position) {
            if read.is_finite() {
                *read = *found;
            }
        }
        if let Some(orientation) = turned {
            let pose = Pose {
                position,
                orientation,
            };
            data.tracked_orientation_wxyz[row] = pose.orientation_wxyz();
        }
    }
    true
}

fn millimetres(length_m: f64) -> String {
    format!("{:.1}", 1e3 * length_m)
}

fn words(alignment: &Alignment, given: &Instrument) -> String {
    let millimetres = |place: Vec3| {
        let [x, y, z] = [place.x, place.y, place.z].map(|c| format!("{:.1}", 1e3 * c + 0.0));
        format!("({x}, {y}, {z}) mm")
    };
    let degrees = |pose: &Pose| format!("{:.1} degrees", pose.orientation.angle().to_degrees());
    let how = match (given.frame.is_some(), given.body.is_some()) {
        (true, true) => "given",
        (true, false) | (false, true) => {
            "partly given, the rest found from the poses of the platform"
        }
        (false, false) => "found from the poses of the platform",
    };
    format!(
        "frame of the external instrument, {how}: its origin is at {} in the robot's frame, it is rotated by {}; the body that it \
         follows is at {} on the platform. Measured poses then differ by {} mm from those of the platform (identify with the \
         effects tracker_frame and tracker_target, and tracker_tilt where orientations are measured, to estimate the rest)",
        millimetres(alignment.frame.position),
        degrees(&alignment.frame),
        millimetres(alignment.body.position),
        self::millimetres(alignment.rms_m)
    )
}

/// Indices of the markers with a coordinate at a pose.
fn numbers_of_markers(pose: &CutPose) -> impl Iterator<Item = usize> {
    let markers = pose
        .readings
        .keys()
        .filter(|quantity| quantity.kind == Kind::Marker);
    markers.map(|quantity| quantity.index / 3)
}

/// Replaces the markers of all poses by the pose of the body that carries them.
fn poses_of_markers(
    poses: &mut [CutPose],
    instrument: &mut Instrument,
    notices: &mut Vec<String>,
) -> Result<(), String> {
    let count = poses
        .iter()
        .flat_map(numbers_of_markers)
        .max()
        .map_or(0, |last| last + 1);
    let seen: Vec<MarkerPositions> = poses.iter().map(|pose| seen(pose, count)).collect();
    let body = match &instrument.markers_m {
        Some(known) => RigidBody {
            points_m: known.iter().map(|point| point.map(Vec3::from)).collect(),
        },
        None => RigidBody::of(&thinned(&seen)).map_err(|message| format!("markers: {message}"))?,
    };
    let mut lost = 0;
    for (pose, seen) in poses.iter_mut().zip(&seen) {
        let used: Vec<Averaged> = take_markers(pose);
        match body.pose(seen) {
            Some(found) => set_measured(pose, &found, typical(&used)),
            None => lost += 1,
        }
    }
    let known = body.points_m.iter().flatten().count();
    notices.push(format!(
        "{known} markers form a rigid body to within {} mm",
        millimetres(body.rms_m(&thinned(&seen)))
    ));
    if lost > 0 {
        notices.push(format!(
            "{lost} poses show fewer than {FEWEST_MARKERS} markers: they have no measured pose"
        ));
    }
    let points = body.points_m.iter().map(|point| point.map(Into::into));
    instrument.markers_m = Some(points.collect());
    Ok(())
}

fn seen(pose: &CutPose, count: usize) -> MarkerPositions {
    let coordinate = |index: usize| {
        let kind = Kind::Marker;
        pose.readings
            .get(&Quantity { kind, index })
            .map(|reading| reading.mean)
    };
    let place = |marker: usize| {
        let [x, y, z] = [0, 1, 2].map(|axis| coordinate(3 * marker + axis));
        Some(Vec3::new(x?, y?, z?))
    };
    (0..count).map(place).collect()
}

/// Removes the marker readings from a pose and returns them.
fn take_markers(pose: &mut CutPose) -> Vec<Averaged> {
    let readings = std::mem::take(&mut pose.readings);
    let (markers, others): (BTreeMap<_, _>, _) = readings
        .into_iter()
        .partition(|(quantity, _)| quantity.kind == Kind::Marker);
    pose.readings = others;
    markers.into_values().collect()
}

/// Standard deviation and number of readings of a coordinate of the centroid of the markers.
fn typical(markers: &[Averaged]) -> Averaged {
    let variance = markers
        .iter()
        .map(|reading| reading.sd * reading.sd)
        .sum::<f64>();
    let count = markers.len().max(1) as f64;
    Averaged {
        mean: f64::NAN,
        sd: (variance / count / (count / 3.0).max(1.0)).sqrt(),
        number: markers
            .iter()
            .map(|reading| reading.number)
            .min()
            .unwrap_or(1),
    }
}

fn set_measured(pose: &mut CutPose, found: &Pose, like: Averaged) {
    let numbers = found
        .position
        .iter()
        .copied()
        .chain(found.orientation_wxyz());
    for (index, mean) in numbers.enumerate() {
        let kind = Kind::Tracked;
        // The scatter of the markers does not translate simply to a quaternion.
        let sd = if index < 3 { like.sd } else { f64::NAN };
        let reading = Averaged { mean, sd, ..like };
        pose.readings.insert(Quantity { kind, index }, reading);
    }
}

fn vector(pose: &CutPose, kind: Kind) -> Option<Vec3> {
    let [x, y, z] = [0, 1, 2].map(|index| pose.readings.get(&Quantity { kind, index }));
    Some(Vec3::new(x?.mean, y?.mean, z?.mean))
}

fn orientation(pose: &CutPose, kind: Kind) -> Option<nalgebra::UnitQuaternion<f64>> {
    let component = |index| pose.readings.get(&Quantity { kind, index }).map(|r| r.mean);
    let [w, x, y, z] = [3, 4, 5, 6].map(component);
    let q = [w?, x?, y?, z?];
    let is_there = q.iter().map(|v| v * v).sum::<f64>() > 0.25;
    is_there.then(|| Pose::from_parts([0.0; 3], q).orientation)
}

/// The measured poses with a known pose of the platform.
fn pairs(poses: &[CutPose], robot: &Robot) -> Vec<Pair> {
    let pair = |(pose, platform): (&CutPose, Option<Pose>)| {
        Some(Pair {
            measured_m: vector(pose, Kind::Tracked)?,
            turned: orientation(pose, Kind::Tracked),
            platform: platform?,
        })
    };
    let platform = platform_poses(poses, robot);
    poses.iter().zip(platform).filter_map(pair).collect()
}

/// Transforms the measured pose of the body to the pose of the platform in the robot's frame.
fn bring(pose: &mut CutPose, alignment: &Alignment) {
    let Some(measured) = vector(pose, Kind::Tracked) else {
        return;
    };
    let frame = &alignment.frame;
    let turned = orientation(pose, Kind::Tracked)
        .map(|q| frame.orientation * q * alignment.body.orientation.inverse());
    let platform = turned.or_else(|| orientation(pose, Kind::Commanded));
    let lever = platform.unwrap_or_default() * alignment.body.position;
    let position = frame.transform(&measured) - lever;
    let rotation = frame.orientation.to_rotation_matrix().into_inner();
    for kind in [Kind::Tracked, Kind::TrackedSd] {
        turn_deviations(pose, kind, &rotation);
    }
    let mut set = |index: usize, mean: f64| {
        let kind = Kind::Tracked;
        if let Some(reading) = pose.readings.get_mut(&Quantity { kind, index }) {
            reading.mean = mean;
        }
    };
    (0..3).for_each(|k| set(k, position[k]));
    if let Some(orientation) = turned {
        let q = Pose {
            position,
            orientation,
        };
        let q = q.orientation_wxyz();
        (0..4).for_each(|k| set(3 + k, q[k]));
    }
}

/// Transforms standard deviations along the axes of the instrument's frame to those of the robot's frame: scatter of the
/// readings, or columns that state them.
fn turn_deviations(pose: &mut CutPose, kind: Kind, rotation: &nalgebra::Matrix3<f64>) {
    let is_stated = kind == Kind::TrackedSd;
    let sd = |k: usize| {
        let reading = pose.readings.get(&Quantity { kind, index: k });
        reading.map_or(f64::NAN, |r| if is_stated { r.mean } else { r.sd })
    };
    let own = [0, 1, 2].map(sd);
    for axis in 0..3 {
        let squares = (0..3).map(|k| (rotation[(axis, k)] * own[k]).powi(2));
        let turned = squares.sum::<f64>().sqrt();
        if let Some(reading) = pose.readings.get_mut(&Quantity { kind, index: axis }) {
            let place = if is_stated {
                &mut reading.mean
            } else {
                &mut reading.sd
            };
            *place = turned;
        }
    }
}

/// At most [`MOST_POSES`] elements, evenly spaced.
fn thinned<T: Clone>(all: &[T]) -> Vec<T> {
    let every = all.len().div_ceil(MOST_POSES).max(1);
    all.iter().step_by(every).cloned().collect()
}

#[cfg(test)]
mod tests;
