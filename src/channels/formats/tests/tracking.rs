use super::*;

const MOTIVE: &str = "Format Version,1.23,Take Name,Take 1,Capture Frame Rate,120.000000,Capture Start Time,2024-05-07 10.00.00.000 AM,Rotation Type,Quaternion,Length Units,Meters,Coordinate Space,Global\n\
\n\
,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n\
,Name,Platform,Platform,Platform,Platform,Platform,Platform,Platform,Platform\n\
,ID,A1,A1,A1,A1,A1,A1,A1,A1\n\
,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error\n\
Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,\n\
0,0.000000,0,0,0,1,0.5,1.25,-0.75,0.0001\n\
1,0.008333,0,0,0,1,,,,\n\
2,0.016667,0,0,0,1,0.75,1.5,-1,0.0001\n";

fn platform(source: &Source, unit: &str, scale: f64) {
    assert_eq!(source.format, Format::Motive);
    let series = &source.series[0];
    assert_eq!(
        times(series).as_deref(),
        Some(&[0.0, 0.008_333, 0.016_667][..])
    );
    let content = content(series);
    assert_eq!(content[3], channel("Platform.Rotation.W", None, &[1.0; 3]));
    assert_eq!(
        content[4],
        channel(
            "Platform.Position.X",
            Some(unit),
            &[0.5 * scale, f64::NAN, 0.75 * scale]
        )
    );
    assert_eq!(
        content[6],
        channel(
            "Platform.Position.Z",
            Some(unit),
            &[-0.75 * scale, f64::NAN, -scale]
        )
    );
}

#[test]
fn motive_exports_are_read_in_their_versions() {
    let source = read("a.csv", MOTIVE);
    platform(&source, "m", 1.0);
    assert_eq!(source.notices, [""; 0]);
    // In millimetres, without the error of markers, of a German computer.
    let millimetres = MOTIVE
        .replace("Meters", "Millimeters")
        .replace("1.23", "1.24")
        .replace("AM", "vorm.")
        .replace(",Mean Marker Error", "")
        .replace("X,Y,Z,\n", "X,Y,Z\n")
        .replace(",0.0001\n", "\n")
        .replace("0.5,1.25,-0.75", "500,1250,-750")
        .replace("0.75,1.5,-1", "750,1500,-1000")
        .replace(",,,,\n", ",,,\n");
    platform(&read("b.csv", millimetres), "mm", 1000.0);
    let windows = format!("\u{feff}{}", MOTIVE.replace('\n', "\r\n"));
    platform(&read("c.csv", windows), "m", 1.0);
}

#[test]
fn motive_exports_that_are_broken() {
    let source = read("a.csv", format!("{}3,0.025,0,0,0,1,0.8", MOTIVE));
    assert_eq!(source.series[0].rows, 3);
    assert_eq!(
        source.notices,
        ["a.csv, line 11: the last row ends after 7 of 10 cells: left out"]
    );
    let source = read("b.csv", MOTIVE.replace("\n2,0.016667", "\n5,0.041667"));
    assert_eq!(source.notices, ["b.csv: 3 frames are missing in between"]);
    let euler = MOTIVE.replace("Quaternion", "XYZ");
    assert!(read("c.csv", euler).notices[0].contains("expected quaternions"));
    for (text, part) in [
        (
            MOTIVE.replace("Meters", "Furlongs"),
            "a.csv, line 1: found \"Furlongs\" as \"Length Units\"",
        ),
        (
            MOTIVE.replace("0.5,1.25", "0.5,x"),
            "a.csv, line 8, column \"Platform.Position.Y\": found \"x\", expected a number",
        ),
        (
            MOTIVE.replace("Frame,Time", "Bild,Zeit"),
            "found no row that begins with \"Frame\"",
        ),
        (
            MOTIVE[..MOTIVE.find("\n0,0.0").expect("data") + 1].to_owned(),
            "a header without frames",
        ),
    ] {
        let sentence = refusal("a.csv", text);
        assert!(sentence.contains(part), "{sentence}");
    }
}

const NEXUS: &str = "Trajectories\n100\n,,robot:A,,,robot:B,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n1,0,1.5,2,3,4,5,6\n2,0,,,,4.5,5,6\n3,0,2.5,2,3,5,5,6\n";

fn markers(source: &Source) {
    assert_eq!(source.format, Format::Nexus);
    let series = &source.series[0];
    assert_eq!(times(series).as_deref(), Some(&[0.0, 0.01, 0.02][..]));
    assert_eq!(
        content(series)[0],
        channel("robot:A.X", Some("mm"), &[1.5, f64::NAN, 2.5])
    );
    assert_eq!(
        content(series)[3],
        channel("robot:B.X", Some("mm"), &[4.0, 4.5, 5.0])
    );
}

#[test]
fn nexus_exports_are_read_in_their_variants() {
    let source = read("a.csv", NEXUS);
    markers(&source);
    assert_eq!(
        (source.series[0].name.as_str(), source.series.len()),
        ("a Trajectories", 1)
    );
    markers(&read("b.txt", NEXUS.replace(',', "\t")));
    markers(&read("c.csv", NEXUS.replace('\n', "\r\n")));
    let devices = "Devices\n200\n,,Force,,\nFrame,Sub Frame,Fx,Fy,Fz\n,,N,N,N\n1,0,1,2,3\n1,1,4,5,6\n2,0,7,8,9\n\n";
    let source = read("d.csv", format!("{devices}{NEXUS}"));
    assert_eq!(
        times(&source.series[0]).as_deref(),
        Some(&[0.0, 0.005, 0.01][..])
    );
    assert_eq!(
        content(&source.series[0])[2],
        channel("Force.Fz", Some("N"), &[3.0, 6.0, 9.0])
    );
    assert_eq!(
        content(&source.series[1])[0],
        channel("robot:A.X", Some("mm"), &[1.5, f64::NAN, 2.5])
    );
}

#[test]
fn nexus_exports_that_are_broken() {
    let source = read("a.csv", NEXUS.replace("\n3,0", "\n7,0"));
    assert_eq!(source.notices, ["a.csv: 4 frames are missing in between"]);
    for (text, part) in [
        (
            NEXUS.replace("\n100\n", "\nfast\n"),
            "a.csv, line 2: found \"fast\", expected the sampling rate in Hz",
        ),
        (
            NEXUS.replace("4.5", "x"),
            "a.csv, line 7, column \"robot:B.X\": found \"x\", expected a number",
        ),
        (
            format!("{NEXUS}\nhello\n"),
            "a.csv, line 10: found \"hello\", expected the title of a section",
        ),
        (
            "Trajectories\n100\n".to_owned(),
            "a.csv: ends in the section Trajectories",
        ),
    ] {
        let sentence = refusal("a.csv", text);
        assert!(sentence.contains(part), "{sentence}");
    }
}
