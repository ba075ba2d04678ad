use super::*;

/// A record of a bag.
fn record(fields: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    let counted = |bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes(), bytes].concat();
    let field = |(name, value): &(&str, &[u8])| counted(&[name.as_bytes(), b"=", value].concat());
    let header: Vec<u8> = fields.iter().flat_map(field).collect();
    [counted(&header), counted(data)].concat()
}

/// A bag with these records, in one chunk of a compression.
fn bag(compression: &[u8], records: &[u8]) -> Vec<u8> {
    let size = (records.len() as u32).to_le_bytes();
    let chunk = record(
        &[("op", &[5]), ("compression", compression), ("size", &size)],
        records,
    );
    let head = |index_at: u64| {
        let fields: [(&str, &[u8]); 2] = [("op", &[3]), ("index_pos", &index_at.to_le_bytes())];
        [&b"#ROSBAG V2.0\n"[..], &record(&fields, b"")].concat()
    };
    let index_at = head(0).len() + chunk.len();
    [head(index_at as u64), chunk].concat()
}

fn connection(id: u8, topic: &[u8], kind: &[u8], definition: &[u8]) -> Vec<u8> {
    let fields: [(&str, &[u8]); 3] = [("op", &[7]), ("conn", &[id, 0, 0, 0]), ("topic", topic)];
    let data = record(&[("type", kind), ("message_definition", definition)], b"");
    // The data of a connection are fields, as those of a header.
    record(&fields, &data[4..data.len() - 4])
}

fn message(id: u8, second: u8, data: &[u8]) -> Vec<u8> {
    let time = [second, 0, 0, 0, 0, 0, 0, 0];
    let fields: [(&str, &[u8]); 3] = [("op", &[2]), ("conn", &[id, 0, 0, 0]), ("time", &time)];
    record(&fields, data)
}

/// Asserts that topics are the same in a bag and in a recording of ROS 2.
fn assert_alike(bag: &Source, mcap: &Source, topics: &[&str]) {
    for topic in topics {
        let (found, expected) = (series(bag, topic), series(mcap, topic));
        assert_eq!(content(found), content(expected), "{topic}");
        assert_eq!(times(found), times(expected), "{topic}");
        assert_eq!(found.texts, expected.texts, "{topic}");
    }
}

#[test]
fn topics_are_those_of_the_same_recording_of_ros_2() {
    let source = read("a.bag", seed("bz2.bag"));
    assert_eq!(source.format, Format::RosBag);
    let mcap = read("a.mcap", seed("zstd.mcap"));
    assert_alike(
        &source,
        &mcap,
        &["/joint_states", "/vicon/platform", "/range"],
    );
    assert_eq!(
        source.notices,
        [
            "a.bag: topic \"/camera\": images, left out",
            "a.bag: topic \"/rosout\": log messages, left out",
            "a.bag: topic \"/scan\": \"ranges\", a list of more than 64, left out",
        ]
    );
    let source = read("b.bag", seed("lz4.bag"));
    let mcap = read("b.mcap", seed("lz4.mcap"));
    let topics = ["/tf platform", "/tf camera", "/ee/wrench", "/cable_forces"];
    assert_alike(&source, &mcap, &topics);
    assert_eq!(
        content(series(&source, "/lag")),
        [channel("lag", Some("s"), &[0.5, -0.5, -1.5, -2.5, -3.5])]
    );
    assert_eq!(
        source.notices,
        [
            "b.bag: topic \"/trigger\": messages of the type \"std_msgs/Empty\", whose fields are unknown, left out",
            "b.bag: topic \"/cable_forces\": fields that its first message does not have, left out",
        ]
    );
}

#[test]
fn a_bag_that_was_not_closed_is_read_as_far_as_it_goes() {
    // Of two publishers, recorded without compression.
    let source = read("a.bag", seed("open.bag"));
    let joints = series(&source, "/joint_states");
    assert_eq!(joints.rows, 11);
    assert_eq!(names(joints)[3], "position[winch_4]");
    let last = &joints.channels[3].values;
    assert_eq!((last.at(0), last.at(10)), (3.0, -7.0));
    let told = "has no end: the recorder was stopped, or the file was cut off; it is read as far as possible";
    assert_eq!(source.notices, [format!("a.bag: {told}")]);
    for (name, part) in [("bz2.bag", "/range"), ("lz4.bag", "/ee/wrench")] {
        let whole = seed(name);
        // In the index, which is not needed.
        let source = read("b.bag", &whole[..whole.len() - 40]);
        assert_eq!(
            series(&source, part).rows,
            series(&read("c.bag", whole), part).rows
        );
        assert!(source.notices.concat().contains(told), "{name}");
    }
}

#[test]
fn damaged_chunks_are_told() {
    // Inside the compressed data, and in its header.
    for (name, begin, at) in [
        ("bz2.bag", &b"BZh9"[..], 1000),
        ("lz4.bag", b"\x04\x22\x4d\x18", 4),
    ] {
        let mut bytes = seed(name);
        let place = bytes.windows(4).position(|other| other == begin);
        bytes[place.expect("a chunk") + at] ^= 0x80;
        let sentence = refusal("a.bag", &bytes);
        assert!(
            sentence.contains("1 of its chunks are damaged"),
            "{sentence}"
        );
    }
    let records = [
        connection(0, b"/force", b"p/Force", b"float64 data\n"),
        message(0, 9, &2.5_f64.to_le_bytes()),
        vec![0xff; 7],
    ]
    .concat();
    let source = read("a.bag", bag(b"none", &records));
    assert_eq!(source.series[0].rows, 1);
    assert_eq!(
        source.notices,
        [
            "a.bag: 1 of its chunks are damaged; their messages are read as far as possible and may be wrong"
        ]
    );
}

#[test]
fn bags_that_are_not_read() {
    let records = [
        connection(0, b"/force", b"p/Force", b"float64 data\n"),
        message(0, 9, &2.5_f64.to_le_bytes()),
        message(0, 10, &[1, 2]),
    ]
    .concat();
    let source = read("a.bag", bag(b"none", &records));
    assert_eq!(content(&source.series[0]), [channel("force", None, &[2.5])]);
    assert_eq!(times(&source.series[0]).as_deref(), Some(&[9.0][..]));
    assert_eq!(
        source.notices,
        ["a.bag: topic \"/force\": messages that do not fit their type, left out (1)"]
    );
    let mut encrypted = bag(b"none", &records);
    let fields: [(&str, &[u8]); 3] = [
        ("op", &[3]),
        ("index_pos", &[0; 8]),
        ("encryptor", b"rosbag/AesCbcEncryptor"),
    ];
    encrypted.splice(13.., record(&fields, b""));
    let unknown = [
        connection(0, b"/a", b"p/Wide", b"wstring a\n"),
        message(0, 9, b""),
    ]
    .concat();
    for (bytes, part) in [
        (
            bag(b"xz", &records),
            "a.bag: uses an unsupported compression (\"xz\")",
        ),
        (
            encrypted,
            "a.bag: is an encrypted bag, expected one that is not",
        ),
        (
            bag(b"none", &unknown),
            "found no topic with readings (topic \"/a\": its type contains wstring, left out)",
        ),
        (
            bag(b"none", b""),
            "a.bag: found no messages, expected readings",
        ),
        (
            [&b"#ROSBAG V2.0\n"[..], &[0xff; 40]].concat(),
            "a.bag: has no end",
        ),
        (
            [&b"#ROSBAG V2.0\n"[..], &record(&[("op", &[3])], b"")].concat(),
            "a.bag: is damaged, expected a readable ROS 1 bag",
        ),
    ] {
        let sentence = refusal("a.bag", bytes);
        assert!(sentence.contains(part), "{sentence}");
    }
}

/// Types without fields take no bytes: a list of them could be endless.
#[test]
fn types_without_end_are_left_out() {
    let definition = b"p/Nothing[4000000000] a\n===\nMSG: p/Nothing\nuint8 ON=1\n";
    let records = [
        connection(0, b"/a", b"p/Many", definition),
        connection(1, b"/b", b"p/Self", b"p/Self inner\n"),
        message(0, 9, b""),
        message(1, 9, b""),
    ]
    .concat();
    let sentence = refusal("a.bag", bag(b"none", &records));
    assert!(
        sentence.contains("messages that do not fit their type"),
        "{sentence}"
    );
}
