//! Motion capture in C3D: written by the Python packages `c3d` (`points`) and `ezc3d` (`many`), and by hand for the numbers of
//! other computers, checked with the former.

use super::*;

/// Writes bytes behind the first occurrence of `mark`.
fn behind(bytes: &mut [u8], mark: &[u8], new: &[u8]) {
    let mut all = bytes.windows(mark.len());
    let at = all.position(|other| other == mark).expect("a mark") + mark.len();
    bytes[at..at + new.len()].copy_from_slice(new);
}

/// Three markers at 100 Hz from frame 11 on, of which the second one is lost for two frames, and two analog channels.
fn assert_capture(source: &Source, name: &str) {
    assert_eq!(source.format, Format::C3d);
    let [points, analog] = &source.series[..] else {
        panic!("{} series", source.series.len());
    };
    assert_eq!(points.name, format!("{name} Trajectories"));
    let near = |found: Option<Vec<f64>>, first: f64, step: f64, count: usize| {
        let found = found.expect("times");
        assert_eq!(found.len(), count);
        for (k, found) in found.iter().enumerate() {
            assert!((found - first - step * k as f64).abs() < 1e-12, "{found}");
        }
    };
    near(times(points), 0.1, 0.01, 6);
    let gap = f64::NAN;
    assert_eq!(
        content(points),
        [
            channel("robot:A.X", Some("mm"), &[0.0, 0.5, 1.0, 1.5, 2.0, 2.5]),
            channel("robot:A.Y", Some("mm"), &[-20.0; 6]),
            channel(
                "robot:A.Z",
                Some("mm"),
                &[1500.0, 1498.0, 1496.0, 1494.0, 1492.0, 1490.0]
            ),
            channel(
                "robot:B.X",
                Some("mm"),
                &[100.0, gap, gap, 101.5, 102.0, 102.5]
            ),
            channel(
                "robot:B.Y",
                Some("mm"),
                &[-19.0, gap, gap, -19.0, -19.0, -19.0]
            ),
            channel(
                "robot:B.Z",
                Some("mm"),
                &[1500.0, gap, gap, 1494.0, 1492.0, 1490.0]
            ),
            channel(
                "robot:C.X",
                Some("mm"),
                &[200.0, 200.5, 201.0, 201.5, 202.0, 202.5]
            ),
            channel("robot:C.Y", Some("mm"), &[-18.0; 6]),
            channel(
                "robot:C.Z",
                Some("mm"),
                &[1500.0, 1498.0, 1496.0, 1494.0, 1492.0, 1490.0]
            ),
        ]
    );
    assert_eq!(analog.name, format!("{name} Devices"));
    near(times(analog), 0.1, 0.005, 12);
    let row = |begin: f64| -> Vec<f64> { (0..12).map(|k| begin + 0.25 * f64::from(k)).collect() };
    let units: Vec<Option<&str>> = analog
        .channels
        .iter()
        .map(|one| one.unit.as_deref())
        .collect();
    // The package `c3d` writes no units of analog channels.
    let expected = [
        channel("Force.Fz", units[0], &row(0.0)),
        channel("Laser", units[1], &row(-10.0)),
    ];
    assert_eq!(content(analog), expected);
}

#[test]
fn captures_are_read_in_their_variants() {
    for (name, notices) in [
        ("points", &[][..]),
        (
            "dec",
            &[
                "dec.c3d: 2 events left out",
                "dec.c3d: its axis \"+Y\" points up, expected +Z: check which axis is vertical",
            ],
        ),
        ("mips", &["mips.c3d: rotations of 1 segments left out"]),
        ("unsigned", &[]),
    ] {
        let file = format!("{name}.c3d");
        let source = read(&file, seed(&file));
        assert_capture(&source, name);
        assert_eq!(source.notices, notices, "{name}");
    }
    let source = read("a.c3d", seed("unsigned.c3d"));
    assert_eq!(source.series[1].channels[1].unit.as_deref(), Some("mm"));
}

#[test]
fn many_points_have_all_their_names() {
    let source = read("a.c3d", seed("many.c3d"));
    let [points] = &source.series[..] else {
        panic!("{} series", source.series.len());
    };
    assert_eq!(points.channels.len(), 3 * 260);
    let x = points.channel("M260.X").expect("the last point");
    assert_eq!(x.unit.as_deref(), Some("m"));
    assert_eq!(x.values.at(1), f64::from(0.259_f32));
    let lost = points.channel("M8.Y").expect("a point");
    assert_eq!(known(lost.values.iter()), [Some(1.0), None]);
    assert_eq!(times(points).as_deref(), Some(&[0.0, 0.02][..]));
    assert_eq!(source.notices, ["a.c3d: 2 events left out"]);
}

#[test]
fn captures_that_are_broken() {
    let whole = seed("unsigned.c3d");
    let frame = 2 * (4 * 3 + 2 * 2);
    let source = read("a.c3d", &whole[..1536 + 4 * frame + 5]);
    assert_eq!((source.series[0].rows, source.series[1].rows), (4, 8));
    assert_eq!(source.notices, ["a.c3d: ends after 4 of 6 frames"]);
    let longer = [&whole[..], &[0; 1024]].concat();
    let source = read("a.c3d", longer);
    assert_eq!(source.series[0].rows, 6);
    assert_eq!(
        source.notices,
        ["a.c3d: states 6 frames; data that could be 42 more are left out"]
    );
    // The length of a name in the parameters.
    let mut bytes = whole.clone();
    behind(&mut bytes, b"\x01RATE", &[0xff, 0x7f]);
    let source = read("b.c3d", &bytes);
    let told = source.notices.concat();
    assert!(told.contains("b.c3d: its parameters are damaged"), "{told}");
    assert!(told.contains("3 of 3 labels of POINT are empty"), "{told}");
    assert_eq!(source.series[0].channels[3].name, "point_2.X");
    let changed = |mark: &[u8], new: &[u8]| {
        let mut bytes = whole.clone();
        behind(&mut bytes, mark, new);
        bytes
    };
    for (bytes, part) in [
        (whole[..300].to_vec(), "a.c3d: ends before its data"),
        (whole[..1536].to_vec(), "a.c3d: found no frame"),
        (
            changed(b"\x01\x50\x02", &[87]),
            "a.c3d: found processor 87, expected 84, 85 or 86",
        ),
        (
            changed(b"\x01USED\x07\0\x02\0", &[4]),
            "found 3 in its header and 4 as POINT:USED, expected the same number",
        ),
        (
            changed(b"SCALE\x09\0\x04\0", &[0; 4]),
            "found 0 as POINT:SCALE, expected a finite factor",
        ),
    ] {
        let sentence = refusal("a.c3d", bytes);
        assert!(sentence.contains(part), "{sentence}");
    }
}
