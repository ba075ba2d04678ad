//! Proposals for files that other programs wrote.

use std::path::Path;

use tautline_channels::{Format, Source};
use tautline_core::robot::presets;

use crate::{arrange_per_cable, propose, read_source};

/// A file that another program wrote.
fn seed(name: &str) -> Source {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/suites/fuzz/seeds/foreign_file");
    read_source(&folder.join(name)).expect(name)
}

#[test]
fn arrays_of_matlab_are_arranged_per_cable() {
    let mut source = seed("scipy.mat");
    arrange_per_cable(std::slice::from_mut(&mut source), 4);
    let with_time = source
        .series
        .iter()
        .find(|series| series.channel("t").is_some());
    let expected = [
        "F(:,1)",
        "F(:,2)",
        "t",
        "theta(1,:)",
        "theta(2,:)",
        "theta(3,:)",
        "theta(4,:)",
    ];
    let with_time = with_time.expect("a time");
    assert_eq!(
        with_time
            .channels
            .iter()
            .map(|one| one.name.as_str())
            .collect::<Vec<_>>(),
        expected
    );
    let theta = with_time.channel("theta(3,:)").expect("a row");
    assert_eq!((theta.values.len(), theta.values.at(11)), (12, 33.0));
}

#[test]
fn markers_are_proposed_as_those_of_a_text_export() {
    let mut source = seed("unsigned.c3d");
    // Faster than in the file, so that their common motion is detected.
    for channel in source.series[0].channels.iter_mut().step_by(3) {
        let values = channel.values.iter().enumerate();
        channel.values = values.map(|(row, x)| x + 50.0 * row as f64).collect();
    }
    let robot = presets::find("mini").expect("a preset").robot;
    let export = Source {
        format: Format::Nexus,
        ..source.clone()
    };
    let proposed = propose(&[source], &robot);
    assert_eq!(proposed, propose(&[export], &robot));
    let quantities: Vec<&str> = proposed
        .0
        .channels
        .iter()
        .map(|one| one.quantity.as_str())
        .collect();
    assert!(quantities.contains(&"marker_3_z_m"), "{quantities:?}");
}

#[cfg(feature = "more-formats")]
#[test]
fn quantities_are_proposed_as_those_of_ros_2() {
    let robot = presets::find("planar").expect("a preset").robot;
    for (bag, mcap) in [("bz2.bag", "zstd.mcap"), ("lz4.bag", "lz4.mcap")] {
        let found = propose(&[seed(bag)], &robot);
        assert_eq!(found, propose(&[seed(mcap)], &robot));
    }
}

#[cfg(feature = "more-formats")]
#[test]
fn quantities_are_proposed_by_names_and_topics() {
    let robot = presets::find("planar").expect("a preset").robot;
    let proposed = |name: &str| {
        let (recipe, notices) = propose(&[seed(name)], &robot);
        let channels = recipe.channels.into_iter();
        let said: Vec<String> = channels
            .map(|one| {
                let unit = one.unit.unwrap_or_default();
                format!("{} is {} {unit}", one.quantity, one.channel)
            })
            .collect();
        (said, notices)
    };
    let (said, notices) = proposed("zstd.mcap");
    assert_eq!(
        said,
        [
            "rev_{i} is position[winch_{i}] rad",
            "force_{i}_n is effort[winch_{i}] ",
            "meas_x_m is pose.position.x ",
            "meas_y_m is pose.position.y ",
            "meas_z_m is pose.position.z ",
            "meas_qx is pose.orientation.x ",
            "meas_qy is pose.orientation.y ",
            "meas_qz is pose.orientation.z ",
            "meas_qw is pose.orientation.w ",
            "laser_m is range ",
        ]
    );
    assert!(notices[0].contains("conventions of ROS"), "{notices:?}");
    let (said, _) = proposed("lz4.mcap");
    assert_eq!(
        said,
        [
            "meas_x_m is transform.translation.x ",
            "meas_y_m is transform.translation.y ",
            "meas_z_m is transform.translation.z ",
            "meas_qx is transform.rotation.x ",
            "meas_qy is transform.rotation.y ",
            "meas_qz is transform.rotation.z ",
            "meas_qw is transform.rotation.w ",
            "force_{i}_n is cable_forces[{i}] ",
        ]
    );
}
