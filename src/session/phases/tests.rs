use super::*;

fn robot() -> Robot {
    let cable = |name: &str, x: f64| {
        serde_json::json!({"name": name, "platform_anchor_m": [0, 0, 0],
            "pulley": {"entry_point_m": [x, 0, 1], "swivel_axis": [0, 0, 1], "radius_m": 0},
            "winch": {"drum_diameter_m": 0.1, "length_sd_m": 1e-3}})
    };
    let robot = serde_json::json!({"format": "tautline-robot", "version": 1, "name": "two",
        "platform": {"free": ["x", "y"]}, "cables": [cable("2", -1.0), cable("right", 1.0)]});
    let bytes = robot.to_string();
    crate::parse_robot(bytes.as_bytes(), "robot.json")
        .expect("a robot")
        .value
}

#[test]
fn cables_are_named_or_numbered_and_names_win() {
    let text = "cable,reading_n,load_n\nright,1,0\n1,2,0\n2,3,0\n";
    let pairs = read_force(text.as_bytes(), "force.csv", &robot()).expect("pairs");
    let cables: Vec<usize> = pairs.value.iter().map(|pair| pair.cable).collect();
    assert_eq!(cables, [1, 0, 0]);
    for wrong in ["left", "0", "3", "-1", ""] {
        let text = format!("cable,reading_n,load_n\n{wrong},1,0\n");
        assert!(
            read_force(text.as_bytes(), "force.csv", &robot()).is_err(),
            "{wrong}"
        );
    }
}

#[test]
fn every_table_reads_back() {
    let mut robot = robot();
    robot.cables[1].name = "#right".into();
    let winch = vec![
        WinchPair {
            cable: 0,
            revolutions: 0.1,
            length_m: 1.0 / 3.0,
            tension_n: None,
        },
        WinchPair {
            cable: 1,
            revolutions: -2.0,
            length_m: 0.2,
            tension_n: Some(30.5),
        },
    ];
    let mut bytes = Vec::new();
    write_winch(&mut bytes, &winch, &robot).expect("written");
    assert_eq!(
        read_winch(&bytes[..], "w", &robot).expect("read").value,
        winch
    );

    let force = vec![ForcePair {
        cable: 1,
        reading_n: 20.1,
        load_n: 9.80665,
    }];
    bytes.clear();
    write_force(&mut bytes, &force, &robot).expect("written");
    assert_eq!(
        read_force(&bytes[..], "f", &robot).expect("read").value,
        force
    );

    let home = vec![
        HomeReading {
            sensor: 5,
            reading: 1.25
        };
        3
    ];
    bytes.clear();
    write_home(&mut bytes, &home).expect("written");
    assert_eq!(read_home(&bytes[..], "h").expect("read").value, home);

    let elongation = vec![ElongationPoint {
        length_m: 2.0,
        tension_n: 0.0,
        elongation_m: 1e-9,
    }];
    bytes.clear();
    write_elongation(&mut bytes, &elongation).expect("written");
    assert_eq!(
        read_elongation(&bytes[..], "e").expect("read").value,
        elongation
    );
}

#[test]
fn checks_read_back_with_and_without_orientation() {
    let pose = |x: f64, orientation_wxyz| CheckPose {
        position_m: [x, 0.0, -0.1],
        orientation_wxyz,
    };
    let row = |kind, cycle, sample| CheckRow {
        kind,
        target: "P,1".into(),
        cycle,
        sample,
        time_s: (cycle == 1).then_some(0.3),
        commanded: pose(0.1, Some([1.0, 0.0, 0.0, 0.0])),
        attained: pose(0.1 + 0.2, None),
    };
    let rows = vec![
        row(CheckKind::Pose, 1, 0),
        row(CheckKind::Pose, 2, 0),
        row(CheckKind::Path, 1, 1),
        row(CheckKind::Path, 1, 2),
    ];
    let mut bytes = Vec::new();
    write_check(&mut bytes, &rows).expect("written");
    assert_eq!(
        read_check(&bytes[..], "check.csv").expect("read").value,
        rows
    );
    let bare = "kind,target,cycle,cmd_x_m,cmd_y_m,cmd_z_m,x_m,y_m,z_m\npose,1,1,0,0,0,0,0,0\n";
    let read = read_check(bare.as_bytes(), "check.csv").expect("read");
    assert_eq!(read.value[0].attained.orientation_wxyz, None);
}

#[test]
fn distances_read_back_and_wrong_ones_are_refused() {
    let text = "pose_a,pose_b,distance_m,sd_m,point_z_m\n0,2,0.25,0.001,\n2,5,1.5,0.0005,-0.1\n";
    let read = |text: &str| read_distances(text.as_bytes(), "distances.csv", &[0, 2, 5]);
    let distances = read(text).expect("distances").value;
    assert_eq!(distances[1].point_m, [0.0, 0.0, -0.1]);
    let mut written = Vec::new();
    write_distances(&mut written, &distances).expect("written");
    let written = String::from_utf8(written).expect("text");
    assert_eq!(read(&written).expect("distances").value, distances);
    for (from, to) in [
        ("0,2", "2,2"),
        ("0,2", "0,3"),
        ("0.25", "-1"),
        ("0.001", "0"),
    ] {
        let error = read(&text.replacen(from, to, 1)).expect_err("an error");
        assert!(
            error.to_string().starts_with("distances.csv, line 2"),
            "{error}"
        );
    }
}
