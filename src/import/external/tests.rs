use nalgebra::UnitQuaternion;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tautline_channels::{Channel, Format, MemoryBudget, Series, Source};
use tautline_core::kinematics::inverse_kinematics;
use tautline_core::robot::{PerAxis, Robot, Tracker, presets};

use super::*;
use crate::{Change, Cutting, Imported, Recipe, import, import_corrected, propose};

/// Markers on the platform (m, its frame).
const ON_PLATFORM: [[f64; 3]; 4] = [
    [0.05, 0.01, 0.04],
    [-0.04, 0.03, 0.05],
    [0.01, -0.05, 0.03],
    [0.02, 0.02, 0.09],
];
/// Markers that stand on the floor (m, the robot's frame).
const ON_FLOOR: [[f64; 3]; 3] = [[1.0, 0.0, -0.6], [0.0, 1.0, -0.6], [1.0, 1.0, -0.6]];

/// The robot's frame seen from the instrument: turned far, and elsewhere.
fn instrument_of_robot() -> Pose {
    Pose {
        position: Vec3::new(1.2, -0.7, 2.1),
        orientation: UnitQuaternion::from_euler_angles(1.7, 0.4, -2.2),
    }
}

fn robot() -> Robot {
    let mut robot = presets::find("mini").expect("a preset").robot;
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(1e-3),
        orientation_sd_rad: Some(1e-3),
    });
    robot
}

/// The home pose and others about it, none of them on one line.
fn poses(count: usize) -> Vec<Pose> {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut vector = |size: f64| Vec3::from_fn(|_, _| rng.random_range(-size..size));
    let others = (1..count).map(|_| Pose {
        position: vector(0.15),
        orientation: UnitQuaternion::from_scaled_axis(vector(0.15)),
    });
    std::iter::once(Pose::identity())
        .chain(others.collect::<Vec<_>>())
        .collect()
}

fn channel(name: &str, values: impl Iterator<Item = f64>) -> Channel {
    Channel {
        name: name.into(),
        unit: None,
        values: values.collect(),
    }
}

fn source(format: Format, name: &str, channels: Vec<Channel>) -> Source {
    let rows = channels[0].values.len();
    Source {
        file: format!("{name}.csv"),
        format,
        series: vec![Series {
            name: name.into(),
            rows,
            channels,
            ..Series::default()
        }],
        notices: Vec::new(),
    }
}

/// A table of revolutions at these poses, with the commanded poses or without.
fn table(robot: &Robot, poses: &[Pose], is_commanded: bool) -> Source {
    let lengths = |pose: &Pose| -> Vec<f64> {
        let states = inverse_kinematics(robot, pose).expect("within the frame");
        states.iter().map(|state| state.length_m).collect()
    };
    let all: Vec<Vec<f64>> = poses.iter().map(lengths).collect();
    let home = robot.home.expect("a home pose").pose();
    let home = lengths(&home);
    let mut channels: Vec<Channel> = (0..robot.cable_count())
        .map(|k| {
            let per = robot.cables[k].winch.cable_per_revolution_m();
            let paid = all.iter().map(|lengths| (lengths[k] - home[k]) / per);
            channel(&format!("rev_{}", k + 1), paid)
        })
        .collect();
    if is_commanded {
        let numbers = |pose: &Pose| {
            let all = pose.position.iter().copied().chain(pose.orientation_wxyz());
            all.collect::<Vec<f64>>()
        };
        for (k, name) in ["x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"]
            .iter()
            .enumerate()
        {
            channels.push(channel(name, poses.iter().map(|pose| numbers(pose)[k])));
        }
    }
    channels.push(channel("pose", (0..poses.len()).map(|k| k as f64)));
    source(Format::Table, "log", channels)
}

/// Markers as a capture sees them (mm); the second of the platform is lost at pose 7.
fn capture(poses: &[Pose]) -> Source {
    let seen = instrument_of_robot();
    let mut channels = Vec::new();
    let mut add = |name: &str, course: Vec<Vec3>, lost: Option<usize>| {
        for (axis, letter) in ["X", "Y", "Z"].iter().enumerate() {
            let at = |(row, p): (usize, &Vec3)| match lost == Some(row) {
                true => f64::NAN,
                false => 1e3 * seen.transform(p)[axis],
            };
            let values = course.iter().enumerate().map(at);
            let mut one = channel(&format!("robot:{name}.{letter}"), values);
            one.unit = Some("mm".into());
            channels.push(one);
        }
    };
    for (k, place) in ON_FLOOR.iter().enumerate() {
        add(
            &format!("F{k}"),
            vec![Vec3::from(*place); poses.len()],
            None,
        );
    }
    for (k, place) in ON_PLATFORM.iter().enumerate() {
        let course = poses.iter().map(|pose| pose.transform(&Vec3::from(*place)));
        add(&format!("P{k}"), course.collect(), (k == 1).then_some(7));
    }
    source(Format::Nexus, "capture", channels)
}

/// The poses imported from files with a recipe.
fn followed(sources: &[Source], recipe: &Recipe, robot: &Robot) -> Imported {
    import(sources, recipe, "recipe", robot, &MemoryBudget::default()).expect("imported")
}

/// Largest distance and largest angle of measured poses from the true ones (m, rad).
fn errors(measured: &Measurements, poses: &[Pose]) -> [f64; 2] {
    let mut largest = [0.0_f64; 2];
    for (row, pose) in poses.iter().enumerate() {
        let position = measured.tracked_position_at(row).expect("a position");
        let turned = measured
            .tracked_orientation_at(row)
            .expect("an orientation");
        largest[0] = largest[0].max((position - pose.position).norm());
        largest[1] = largest[1].max(turned.angle_to(&pose.orientation));
    }
    largest
}

#[test]
fn markers_in_a_frame_of_their_own_become_poses_of_the_platform() {
    let (robot, poses) = (robot(), poses(25));
    // Poses of the platform are as commanded, or by the lengths of the cables to the tolerance of the kinematics.
    for (is_commanded, allowed) in [(true, 1e-9), (false, 1e-7)] {
        let sources = [table(&robot, &poses, is_commanded), capture(&poses)];
        let (recipe, notices) = propose(&sources, &robot);
        assert!(
            notices
                .iter()
                .any(|n| n.contains("robot:P0, robot:P1, robot:P2, robot:P3 move")),
            "{notices:?}"
        );
        let imported = followed(&sources, &recipe, &robot);
        let [distance, angle] = errors(&imported.measurements, &poses);
        assert!(distance < allowed && angle < allowed, "{distance} {angle}");
        assert!(
            !imported.poses_csv.contains("marker"),
            "markers are no readings"
        );
        let notices = imported.document.notices.join("\n");
        assert!(
            notices.contains("4 markers form a rigid body to within 0.0 mm"),
            "{notices}"
        );
        // The alignment that was found also applies to the next recording, even one with too few poses to find it.
        let found = imported.document.recipe.clone();
        let few = [table(&robot, &poses[..3], true), capture(&poses[..3])];
        let next = followed(&few, &found, &robot);
        let [distance, angle] = errors(&next.measurements, &poses[..3]);
        assert!(distance < allowed && angle < allowed, "{distance} {angle}");
    }
}

#[test]
fn poses_in_another_frame_are_recognised_and_brought_over() {
    let (robot, poses) = (robot(), poses(20));
    let seen = instrument_of_robot();
    let mut log = table(&robot, &poses, true);
    for (k, name) in ["meas_x_m", "meas_y_m", "meas_z_m"].iter().enumerate() {
        let values = poses.iter().map(|pose| seen.transform(&pose.position)[k]);
        log.series[0].channels.push(channel(name, values));
    }
    let sources = [log];
    let (mut recipe, assumed) = propose(&sources, &robot);
    assert!(recipe.instrument.is_some());
    let is_told = |sentence: &&String| {
        sentence.contains("the frame of the instrument is found from the poses")
    };
    assert_eq!(assumed.iter().filter(is_told).count(), 1, "{assumed:?}");
    let aligned = followed(&sources, &recipe, &robot);
    assert!(aligned.document.suggestions.is_empty());
    recipe.instrument = None;
    let as_it_is = followed(&sources, &recipe, &robot);
    let suggestions = &as_it_is.document.suggestions;
    assert_eq!(suggestions.len(), 1, "{suggestions:?}");
    assert_eq!(suggestions[0].change, Change::AlignInstrument);
    let corrected = import_corrected(
        &sources,
        &recipe,
        "recipe",
        &robot,
        (false, &MemoryBudget::default()),
    )
    .expect("imported");
    for (row, pose) in poses.iter().enumerate() {
        let position = corrected
            .measurements
            .tracked_position_at(row)
            .expect("a position");
        assert!((position - pose.position).norm() < 1e-9);
    }
}

/// Without commanded poses the lengths of the cables tell where the platform was, also those of six cables, which are not redundant.
#[test]
fn the_frame_of_an_instrument_is_found_from_the_lengths() {
    let seen = instrument_of_robot();
    for cables in [8, 6] {
        let (mut robot, poses) = (robot(), poses(20));
        // Six cables that hold the platform in all directions.
        let kept = [0, 1, 3, 4, 6, 7, 2, 5];
        robot.cables = kept[..cables]
            .iter()
            .map(|k| robot.cables[*k].clone())
            .collect();
        for is_other in [true, false] {
            let mut log = table(&robot, &poses, false);
            for index in 0..7 {
                let value = |pose: &Pose| {
                    let position = match is_other {
                        true => seen.transform(&pose.position),
                        false => pose.position,
                    };
                    let orientation = match is_other {
                        true => seen.orientation * pose.orientation,
                        false => pose.orientation,
                    };
                    let pose = Pose {
                        position,
                        orientation,
                    };
                    let turned = pose.orientation_wxyz();
                    pose.position.iter().chain(&turned).copied().nth(index)
                };
                let values = poses.iter().map(|pose| value(pose).expect("seven numbers"));
                let kind = Kind::Tracked;
                let name = Quantity { kind, index }.column();
                log.series[0].channels.push(channel(&name, values));
            }
            let sources = [log];
            let (recipe, _) = propose(&sources, &robot);
            assert_eq!(recipe.instrument.is_some(), is_other, "{cables} cables");
            let imported = followed(&sources, &recipe, &robot);
            assert!(imported.document.suggestions.is_empty());
            for (row, pose) in poses.iter().enumerate() {
                let position = imported.measurements.tracked_position_at(row);
                let off = (position.expect("a position") - pose.position).norm();
                assert!(off < 1e-6, "{cables} cables, row {row}: {off}");
            }
        }
    }
}

#[test]
fn what_markers_do_not_say_is_told() {
    let (robot, poses) = (robot(), poses(10));
    let sources = [table(&robot, &poses, true), capture(&poses)];
    let (mut recipe, _) = propose(&sources, &robot);
    assert_eq!(recipe.cutting, Cutting::Rows);
    let message = |recipe: &Recipe, count: usize| {
        let sources = [
            table(&robot, &poses[..count], true),
            capture(&poses[..count]),
        ];
        import(&sources, recipe, "recipe", &robot, &MemoryBudget::default())
            .unwrap_err()
            .error
            .to_string()
    };
    let few = message(&recipe, 4);
    assert!(
        few.contains("found 4 poses with a known pose of the platform, expected 6 or more"),
        "{few}"
    );
    recipe.channels.retain(|entry| {
        !entry.quantity.starts_with("marker_3") && !entry.quantity.starts_with("marker_4")
    });
    let two = message(&recipe, 10);
    assert!(
        two.contains("markers: found at most 2 markers at once, expected 3 or more"),
        "{two}"
    );
}

#[test]
fn deviations_turn_with_the_frame() {
    let kind = Kind::TrackedSd;
    let reading = |mean: f64| Averaged {
        mean,
        sd: f64::NAN,
        number: 1,
    };
    let mut pose = CutPose {
        label: None,
        group: None,
        time_s: None,
        first_row: 0,
        rows: 1,
        readings: [1e-3, 2e-3, 3e-3]
            .into_iter()
            .enumerate()
            .map(|(index, sd)| (Quantity { kind, index }, reading(sd)))
            .collect(),
    };
    // x of the instrument is y of the robot.
    let quarter = UnitQuaternion::from_euler_angles(0.0, 0.0, std::f64::consts::FRAC_PI_2);
    turn_deviations(&mut pose, kind, &quarter.to_rotation_matrix().into_inner());
    let after = vector(&pose, kind).expect("deviations");
    assert!((after - Vec3::new(2e-3, 1e-3, 3e-3)).norm() < 1e-15);
}
