use super::*;

#[test]
fn topics_are_series_with_times_of_their_own() {
    let source = read("a.mcap", seed("zstd.mcap"));
    assert_eq!(source.format, Format::Mcap);
    let joints = series(&source, "/joint_states");
    let row = |first: f64, step: f64| (0..6).map(|k| first + step * f64::from(k)).collect();
    let rows: Vec<Vec<f64>> = vec![
        row(0.0, 0.5),
        row(1.0, 0.5),
        row(2.0, 0.5),
        row(3.0, 0.5),
        row(110.0, 1.0),
        row(120.0, 1.0),
        row(130.0, 1.0),
        row(140.0, 1.0),
    ];
    // In the fourth message the joints are in another order; velocities are empty.
    let expected = [
        channel("position[winch_1]", None, &rows[0]),
        channel("position[winch_2]", None, &rows[1]),
        channel("position[winch_3]", None, &rows[2]),
        channel("position[winch_4]", None, &rows[3]),
        channel("effort[winch_1]", None, &rows[4]),
        channel("effort[winch_2]", None, &rows[5]),
        channel("effort[winch_3]", None, &rows[6]),
        channel("effort[winch_4]", None, &rows[7]),
    ];
    assert_eq!(content(joints), expected);
    assert_times(joints, &[0.0, 0.01, 0.02, 0.03, 0.04, 0.05]);
    assert_eq!(joints.texts[0].name, "header.frame_id");
    assert_eq!(joints.texts[0].at(5), "base");

    let poses = series(&source, "/vicon/platform");
    assert_times(poses, &[0.0, 0.02, 0.04]);
    assert_eq!(
        content(poses),
        [
            channel("pose.position.x", None, &[0.0, 0.2, 0.4]),
            channel("pose.position.y", None, &[-1.0; 3]),
            channel("pose.position.z", None, &[2.5; 3]),
            channel("pose.orientation.x", None, &[0.0; 3]),
            channel("pose.orientation.y", None, &[0.0; 3]),
            channel("pose.orientation.z", None, &[0.6; 3]),
            channel("pose.orientation.w", None, &[0.8; 3]),
        ]
    );

    // Without a stamp the time is that of the recorder.
    let range = series(&source, "/range");
    let late: Vec<f64> = (0..6).map(|k| 0.01 * f64::from(k) + DELAY_S).collect();
    assert_times(range, &late);
    let last = range.channel("range").expect("ranges");
    assert_eq!(
        known(last.values.iter()),
        known([2.0, 2.125, 2.25, 2.375, 2.5, 2.625].into_iter())
    );
    assert_eq!(series(&source, "/scan").channels.len(), 1);
    assert_eq!(
        source.notices,
        [
            "a.mcap: topic \"/camera\": images, left out",
            "a.mcap: topic \"/scan\": \"ranges\", a list of more than 64, left out",
        ]
    );
}

#[test]
fn transforms_have_a_series_for_each_frame() {
    let source = read("a.mcap", seed("lz4.mcap"));
    let platform = series(&source, "/tf platform");
    assert_times(platform, &[0.0, 0.01, 0.02, 0.03, 0.04]);
    assert_eq!(
        content(platform)[..2],
        [
            channel(
                "transform.translation.x",
                None,
                &[0.0, 0.25, 0.5, 0.75, 1.0]
            ),
            channel("transform.translation.y", None, &[0.5; 5]),
        ]
    );
    assert_eq!(names(platform)[6], "transform.rotation.w");
    assert_eq!(series(&source, "/tf camera").rows, 2);
    assert_eq!(
        names(series(&source, "/ee/wrench")),
        [
            "wrench.force.x",
            "wrench.force.y",
            "wrench.force.z",
            "wrench.torque.x",
            "wrench.torque.y",
            "wrench.torque.z",
        ]
    );
}

#[test]
fn lists_have_the_columns_of_the_first_message() {
    let source = read("a.mcap", seed("lz4.mcap"));
    assert_eq!(
        content(series(&source, "/cable_forces")),
        [
            channel("cable_forces[0]", None, &[0.0, 1.0, 2.0, 3.0, 4.0]),
            channel("cable_forces[1]", None, &[10.0, 11.0, 12.0, 13.0, 14.0]),
            channel("cable_forces[2]", None, &[20.0, 21.0, 22.0, f64::NAN, 24.0]),
            channel("cable_forces[3]", None, &[30.0, 31.0, 32.0, f64::NAN, 34.0]),
        ]
    );
    assert_eq!(
        source.notices,
        ["a.mcap: topic \"/cable_forces\": fields that its first message does not have, left out"]
    );
}

#[test]
fn a_recording_without_its_end_is_read_as_far_as_it_goes() {
    let source = read("a.mcap", seed("cut_off.mcap"));
    let joints = series(&source, "/joint_states");
    assert_eq!(joints.rows, 11);
    assert_eq!(joints.channels[1].values.at(10), -5.0);
    assert_eq!(
        source.notices,
        [
            "a.mcap: has no end: the recorder was stopped, or the file was cut off; it is read as far as possible"
        ]
    );
    // In the middle of a compressed chunk, too.
    for name in ["zstd.mcap", "lz4.mcap"] {
        let whole = seed(name);
        let source = read("b.mcap", &whole[..whole.len() / 5]);
        assert!(source.series[0].rows > 0, "{name}");
        let told = source.notices.concat();
        assert!(told.contains("has no end"), "{name}: {told}");
    }
}

#[test]
fn messages_in_json_and_what_is_left_out() {
    let source = read("a.mcap", seed("json.mcap"));
    let winch = series(&source, "/winch");
    assert_times(winch, &[0.0, 0.25, 0.5, 0.75]);
    let mut found = content(winch);
    found.retain(|(name, ..)| name != "timestamp");
    assert_eq!(
        found,
        [
            channel("armed", None, &[0.0, 0.0, 1.0, 1.0]),
            channel("rev[0]", None, &[0.0, 0.5, 1.0, 1.5]),
            channel("rev[1]", None, &[1.5; 4]),
            channel("temp.c", None, &[20.5; 4]),
        ]
    );
    assert_eq!(winch.text("state").expect("a state").at(3), "moving");
    assert_eq!(
        source.notices,
        ["a.mcap: topic \"/proto\": messages in the encoding \"protobuf\", left out"]
    );
}

#[test]
fn recordings_without_readings_are_refused() {
    let bytes = seed("json.mcap");
    // The encoding of the messages, behind its length.
    let place = |part: &[u8]| bytes.windows(part.len()).position(|other| other == part);
    let at = place(b"\x04\0\0\0json").expect("an encoding") + 4;
    let mut other = bytes.clone();
    other[at..at + 4].copy_from_slice(b"cbor");
    let sentence = refusal("a.mcap", other);
    assert!(
        sentence.contains("found no topic with readings (topic "),
        "{sentence}"
    );
    let sentence = refusal("b.mcap", &bytes[..60]);
    assert!(sentence.contains("has no end"), "{sentence}");
    let mut bytes = bytes;
    bytes.truncate(8);
    bytes.extend([1, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff]);
    let sentence = refusal("c.mcap", bytes);
    assert!(sentence.contains("is damaged"), "{sentence}");
}
