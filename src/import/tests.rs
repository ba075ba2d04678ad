//! A simulated robot's readings, written as foreign files and imported with the recipe that is proposed for them.

use std::fmt::Write as _;
use std::path::PathBuf;

use tautline_channels::{Channel, Format, MemoryBudget, Series, Source};
use tautline_core::estimation::{Control, Options, Problem, solve};
use tautline_core::measurement::{Dataset, Measurements};
use tautline_core::robot::{Robot, presets};
use tautline_core::simulation::{Recording, SimulationOptions, record, simulate};

use crate::{
    Assignment, Change, Cutting, Imported, Recipe, import, import_corrected, propose,
    propose_around, read_sources,
};

fn dataset() -> Dataset {
    let robot = presets::find("mini").expect("a preset").robot;
    simulate(&robot, &SimulationOptions::new(20, 11))
        .expect("simulated")
        .dataset
}

/// One reading of each pose, by name; `scale` divides the numbers that it names.
type Columns = Vec<(String, Vec<f64>)>;

/// The columns of a table in which every row is a pose.
fn columns(data: &Measurements) -> Columns {
    let poses = data.len();
    let per_cable = |name: &str, grid: &tautline_core::measurement::Grid| -> Columns {
        let of = |cable: usize| (0..poses).map(|pose| grid.get(pose, cable)).collect();
        (0..8)
            .map(|cable| (name.replace('#', &(cable + 1).to_string()), of(cable)))
            .collect()
    };
    let wanted = |k: usize| -> Vec<f64> {
        let part = |pose: usize| {
            data.commanded[pose].map_or(f64::NAN, |p| {
                [p.position.x, p.position.y, p.position.z]
                    .into_iter()
                    .chain(p.orientation_wxyz())
                    .nth(k)
                    .unwrap_or(f64::NAN)
            })
        };
        (0..poses).map(part).collect()
    };
    let mut columns = vec![(
        "pose".to_owned(),
        data.labels.iter().map(|label| *label as f64).collect(),
    )];
    columns.extend(per_cable("Winch#.Pos", &data.revolutions));
    columns.extend(per_cable("Winch#.Force", &data.force_n));
    columns.push(("Laser".into(), data.laser_m.clone()));
    columns.extend(
        ["x", "y", "z", "qw", "qx", "qy", "qz"]
            .iter()
            .enumerate()
            .map(|(k, name)| (format!("cmd.{name}"), wanted(k))),
    );
    columns
}

fn cell(value: f64) -> String {
    if value.is_nan() {
        String::new()
    } else {
        value.to_string()
    }
}

/// CSV with units in the header.
fn csv(columns: &Columns, separator: &str, comma: bool) -> String {
    let unit = |name: &str| match name {
        name if name.ends_with("Pos") => " [rev]",
        name if name.ends_with("Force") => " [N]",
        "Laser" | "cmd.x" | "cmd.y" | "cmd.z" => " [m]",
        _ => "",
    };
    let header: Vec<String> = columns
        .iter()
        .map(|(name, _)| format!("{name}{}", unit(name)))
        .collect();
    let mut text = format!("{}\n", header.join(separator));
    for row in 0..columns[0].1.len() {
        let cells: Vec<String> = columns
            .iter()
            .map(|(_, values)| cell(values[row]))
            .collect();
        let line = cells.join(separator);
        let _ = writeln!(
            text,
            "{}",
            if comma { line.replace('.', ",") } else { line }
        );
    }
    text
}

fn scope(columns: &Columns) -> String {
    let channels: Vec<&(String, Vec<f64>)> = columns
        .iter()
        .filter(|(_, values)| values.iter().all(|value| !value.is_nan()))
        .collect();
    let line = |key: &str, value: &dyn Fn(&str) -> String| {
        let cells: Vec<String> = channels
            .iter()
            .map(|(name, _)| format!("{key}\t{}", value(name)))
            .collect();
        cells.join("\t")
    };
    let mut text = "Name\tChart\nFile\tx\n\n".to_owned();
    let _ = writeln!(text, "{}", line("Name", &|name| name.to_owned()));
    let _ = writeln!(text, "{}\n", line("SampleTime[ms]", &|_| "1000".into()));
    for row in 0..columns[0].1.len() {
        let cells: Vec<String> = channels
            .iter()
            .map(|(_, values)| format!("{row}\t{}", values[row]))
            .collect();
        let _ = writeln!(text, "{}", cells.join("\t"));
    }
    text + "EOF\n"
}

fn npy(columns: &Columns) -> Vec<u8> {
    let fields: Vec<String> = columns
        .iter()
        .map(|(name, _)| format!("('{name}', '<f8')"))
        .collect();
    let header = format!(
        "{{'descr': [{}], 'fortran_order': False, 'shape': ({},), }}\n",
        fields.join(", "),
        columns[0].1.len()
    );
    let mut bytes = [
        b"\x93NUMPY\x01\x00",
        &(header.len() as u16).to_le_bytes()[..],
        header.as_bytes(),
    ]
    .concat();
    for row in 0..columns[0].1.len() {
        columns
            .iter()
            .for_each(|(_, values)| bytes.extend_from_slice(&values[row].to_le_bytes()));
    }
    bytes
}

/// A MATLAB struct `log` of column vectors.
fn mat(columns: &Columns) -> Vec<u8> {
    let element = |kind: u32, data: &[u8]| {
        let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
        bytes.extend_from_slice(data);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    };
    let head = |class: u32, rows: u32, name: &str| {
        let flags = [class.to_le_bytes(), [0; 4]].concat();
        let size = [rows.to_le_bytes(), 1_u32.to_le_bytes()].concat();
        [
            element(6, &flags),
            element(5, &size),
            element(1, name.as_bytes()),
        ]
        .concat()
    };
    let mut names = Vec::new();
    let mut arrays = Vec::new();
    for (name, values) in columns {
        names.extend_from_slice(name.replace('.', "_").as_bytes());
        names.resize(names.len().next_multiple_of(32), 0);
        let data: Vec<u8> = values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        arrays.extend(element(
            14,
            &[head(6, values.len() as u32, ""), element(9, &data)].concat(),
        ));
    }
    let fields = [vec![5, 0, 4, 0, 32, 0, 0, 0], element(1, &names)].concat();
    let log = element(14, &[head(2, 1, "log"), fields, arrays].concat());
    let mut bytes = b"MATLAB 5.0 MAT-file".to_vec();
    bytes.resize(124, b' ');
    [bytes, b"\x00\x01IM".to_vec(), log].concat()
}

/// A zip archive of stored entries.
fn archive(entries: &[(String, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut archive = rawzip::ZipArchiveWriter::new(&mut bytes);
    for (name, data) in entries {
        let entry = archive
            .new_file(name)
            .compression_method(rawzip::CompressionMethod::STORE);
        let (mut entry, config) = entry.start().expect("an entry");
        let mut writer = config.wrap(&mut entry);
        std::io::Write::write_all(&mut writer, data).expect("written");
        let (_, descriptor) = writer.finish().expect("finished");
        entry.finish(descriptor).expect("finished");
    }
    archive.finish().expect("finished");
    bytes
}

/// One array for each column.
fn npz(columns: &Columns) -> Vec<u8> {
    let entry = |(name, values): &(String, Vec<f64>)| {
        let header = format!(
            "{{'descr': '<f8', 'fortran_order': False, 'shape': ({},), }}\n",
            values.len()
        );
        let mut bytes = [
            b"\x93NUMPY\x01\x00",
            &(header.len() as u16).to_le_bytes()[..],
            header.as_bytes(),
        ]
        .concat();
        values
            .iter()
            .for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
        (format!("{name}.npy"), bytes)
    };
    archive(&columns.iter().map(entry).collect::<Vec<_>>())
}

fn xlsx(columns: &Columns) -> Vec<u8> {
    let mut sheet = "<worksheet><sheetData><row>".to_owned();
    for (name, _) in columns {
        let _ = write!(sheet, "<c t=\"str\"><v>{name}</v></c>");
    }
    sheet.push_str("</row>");
    for row in 0..columns[0].1.len() {
        sheet.push_str("<row>");
        for (k, (_, values)) in columns
            .iter()
            .enumerate()
            .filter(|(_, (_, values))| !values[row].is_nan())
        {
            let letter = char::from(b'A' + u8::try_from(k).expect("few columns"));
            let _ = write!(
                sheet,
                "<c r=\"{letter}{}\"><v>{}</v></c>",
                row + 2,
                values[row]
            );
        }
        sheet.push_str("</row>");
    }
    sheet.push_str("</sheetData></worksheet>");
    let workbook =
        r#"<workbook><sheets><sheet name="Log" sheetId="1" id="r1"/></sheets></workbook>"#;
    let relations =
        r#"<Relationships><Relationship Id="r1" Target="worksheets/sheet1.xml"/></Relationships>"#;
    let parts = [
        ("xl/workbook.xml", workbook),
        ("xl/_rels/workbook.xml.rels", relations),
        ("xl/worksheets/sheet1.xml", &sheet),
    ];
    archive(&parts.map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec())))
}

/// A bag of ROS 1 that was not closed, with a message for each row.
#[cfg(feature = "more-formats")]
fn bag(columns: &Columns) -> Vec<u8> {
    let counted = |bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes(), bytes].concat();
    let field = |name: &str, value: &[u8]| counted(&[name.as_bytes(), b"=", value].concat());
    let record =
        |fields: &[Vec<u8>], data: &[u8]| [counted(&fields.concat()), counted(data)].concat();
    let of_log = |op: u8| vec![field("op", &[op]), field("conn", &[0; 4])];
    let mut definition = String::new();
    for (name, _) in columns {
        let _ = writeln!(definition, "float64 {}", name.replace('.', "_"));
    }
    let kind = [
        field("type", b"log/Row"),
        field("message_definition", definition.as_bytes()),
    ];
    let head = [field("op", &[3]), field("index_pos", &[0; 8])];
    let topic = [of_log(7), vec![field("topic", b"/log")]].concat();
    let mut bytes = b"#ROSBAG V2.0\n".to_vec();
    bytes.extend(record(&head, b""));
    bytes.extend(record(&topic, &kind.concat()));
    for row in 0..columns[0].1.len() {
        let time = [(row as u32).to_le_bytes(), [0; 4]].concat();
        let values = columns
            .iter()
            .flat_map(|(_, values)| values[row].to_le_bytes());
        let fields = [of_log(2), vec![field("time", &time)]].concat();
        bytes.extend(record(&fields, &values.collect::<Vec<u8>>()));
    }
    bytes
}

/// A capture of one marker in C3D, floating-point numbers in metres.
fn c3d(rate_hz: f32, marker: &str, frames: &[[f32; 3]]) -> Vec<u8> {
    let entry = |name: &str, number: u8, content: &[u8]| {
        let offset = (content.len() as u16 + 2).to_le_bytes();
        [
            &[name.len() as u8, number],
            name.as_bytes(),
            &offset,
            content,
        ]
        .concat()
    };
    let text = |text: &str| [&[0xff, 1, text.len() as u8], text.as_bytes(), &[0]].concat();
    let count = (frames.len() as u16).to_le_bytes();
    let mut bytes = [&[2, 0x50, 1, 0, 0, 0, 1, 0][..], &count, &[0; 2]].concat();
    bytes.extend((-1.0_f32).to_le_bytes());
    bytes.extend([3, 0, 0, 0]);
    bytes.extend(rate_hz.to_le_bytes());
    bytes.resize(512, 0);
    bytes.extend([1, 0x50, 1, 84]);
    bytes.extend(entry("POINT", 0xff, b"\0"));
    bytes.extend(entry("LABELS", 1, &text(marker)));
    bytes.extend(entry("UNITS", 1, &text("m")));
    bytes.resize(1024, 0);
    for [x, y, z] in frames {
        bytes.extend(
            [*x, *y, *z, 0.0]
                .iter()
                .flat_map(|number| number.to_le_bytes()),
        );
    }
    bytes
}

fn imported(dataset: &Dataset, files: &[(&str, Vec<u8>)]) -> Imported {
    let folder = tempfile::tempdir().expect("a folder");
    let paths: Vec<PathBuf> = files
        .iter()
        .map(|(name, bytes)| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).expect("written");
            path
        })
        .collect();
    let sources = read_sources(&paths, &MemoryBudget::default(), &|_| true)
        .expect("read")
        .value;
    let (recipe, notices) = propose(&sources, &dataset.robot);
    match import(
        &sources,
        &recipe,
        "the proposed recipe",
        &dataset.robot,
        &MemoryBudget::default(),
    ) {
        Ok(imported) => imported,
        Err(error) => panic!("{error}\n{recipe:#?}\n{notices:#?}"),
    }
}

/// The poses imported from files with a recipe.
fn followed(sources: &[Source], recipe: &Recipe, robot: &Robot) -> Imported {
    import(
        sources,
        recipe,
        "the recipe",
        robot,
        &MemoryBudget::default(),
    )
    .expect("imported")
}

fn read(text: String) -> Vec<Source> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.csv");
    std::fs::write(&path, text).expect("written");
    read_sources(&[path], &MemoryBudget::default(), &|_| true)
        .expect("read")
        .value
}

/// The same entry points, to a nanometre.
fn assert_same_identification(dataset: &Dataset, imported: &Imported, what: &str) {
    let identified = |measurements: &Measurements| {
        let dataset = Dataset {
            robot: dataset.robot.clone(),
            measurements: measurements.clone(),
        };
        let problem = Problem::new(&dataset).expect("a problem");
        let solution = solve(&problem, &Options::default(), &mut |_| Control::Continue);
        let solution = solution.expect("solved");
        assert!(solution.converged(), "{what}: {:?}", solution.termination);
        solution.globals.entry_points
    };
    let (expected, found) = (
        identified(&dataset.measurements),
        identified(&imported.measurements),
    );
    for (expected, found) in expected.iter().zip(&found) {
        for axis in 0..3 {
            let difference = (expected[axis] - found[axis]).abs();
            assert!(difference < 1e-9, "{what}: {difference} m");
        }
    }
}

#[test]
fn every_format_gives_the_same_identification() {
    let dataset = dataset();
    let columns = columns(&dataset.measurements);
    for (name, bytes) in [
        ("log.csv", csv(&columns, ",", false).into_bytes()),
        ("german.csv", csv(&columns, ";", true).into_bytes()),
        ("tabs.txt", csv(&columns, "\t", false).into_bytes()),
        ("scope.csv", scope(&columns).into_bytes()),
        ("log.npy", npy(&columns)),
        ("log.npz", npz(&columns)),
        ("log.mat", mat(&columns)),
        ("log.xlsx", xlsx(&columns)),
        #[cfg(feature = "more-formats")]
        ("log.bag", bag(&columns)),
    ] {
        let imported = imported(&dataset, &[(name, bytes)]);
        assert_eq!(
            imported.measurements.labels, dataset.measurements.labels,
            "{name}"
        );
        assert_eq!(
            imported.measurements.revolutions, dataset.measurements.revolutions,
            "{name}"
        );
        assert_eq!(
            imported.measurements.force_n, dataset.measurements.force_n,
            "{name}"
        );
        assert_eq!(
            imported.measurements.laser_m, dataset.measurements.laser_m,
            "{name}"
        );
        assert_same_identification(&dataset, &imported, name);
    }
}

#[test]
fn columns_of_the_contract_are_what_they_are_called() {
    let dataset = dataset();
    let mut columns = columns(&dataset.measurements);
    for (name, _) in &mut columns {
        *name = match name.strip_prefix("cmd.") {
            Some(axis @ ("x" | "y" | "z")) => format!("{axis}_m"),
            Some(component) => component.into(),
            None => name.replace("Laser", "laser_m"),
        };
    }
    let text = csv(&columns, ",", false)
        .replace(" [rev]", "")
        .replace(" [N]", "");
    let imported = imported(&dataset, &[("a.csv", text.into_bytes())]);
    assert!(imported.measurements.tracked_position_m.is_empty());
    assert_eq!(
        imported.measurements.commanded,
        dataset.measurements.commanded
    );
}

#[test]
fn other_units_give_the_same_identification() {
    let dataset = dataset();
    let mut columns = columns(&dataset.measurements);
    for (name, values) in &mut columns {
        let factor = match name.as_str() {
            name if name.ends_with("Pos") => 360.0,
            name if name.ends_with("Force") => 1e-3,
            "Laser" | "cmd.x" | "cmd.y" | "cmd.z" => 1e3,
            _ => 1.0,
        };
        values.iter_mut().for_each(|value| *value *= factor);
    }
    let text = csv(&columns, ";", true)
        .replace("[rev]", "[°]")
        .replace("[N]", "[kN]")
        .replace("[m]", "[mm]");
    assert_same_identification(
        &dataset,
        &imported(&dataset, &[("a.csv", text.into_bytes())]),
        "units",
    );
    // Without units in the header they follow from the range; forces have none that differs by much.
    let force = columns
        .iter_mut()
        .filter(|(name, _)| name.ends_with("Force"));
    force.for_each(|(_, values)| values.iter_mut().for_each(|value| *value *= 1e3));
    let text = csv(&columns, ";", true)
        .replace(" [rev]", "")
        .replace(" [N]", "")
        .replace(" [m]", "");
    assert_same_identification(
        &dataset,
        &imported(&dataset, &[("a.csv", text.into_bytes())]),
        "no units",
    );
}

/// A recording at 100 Hz: each pose held for a second, with a second of motion between poses.
fn recording(columns: &Columns) -> Columns {
    let poses = columns[0].1.len();
    let mut time = Vec::new();
    let mut rows: Vec<(usize, f64)> = Vec::new();
    for pose in 0..poses {
        rows.extend((0..100).map(|_| (pose, 0.0)));
        if pose + 1 < poses {
            rows.extend((0..100).map(|k| (pose, f64::from(k) / 100.0)));
        }
    }
    time.extend((0..rows.len()).map(|row| row as f64 * 0.01));
    let mut recorded = vec![("Time [s]".to_owned(), time)];
    for (name, values) in columns.iter().filter(|(name, _)| name != "pose") {
        let between = |(pose, part): &(usize, f64)| match values.get(pose + 1) {
            Some(next) if *part > 0.0 => values[*pose] + (next - values[*pose]) * part,
            _ => values[*pose],
        };
        recorded.push((name.clone(), rows.iter().map(between).collect()));
    }
    recorded
}

#[test]
fn rests_of_a_recording_give_the_same_identification() {
    let dataset = dataset();
    let recorded = recording(&columns(&dataset.measurements));
    let imported = imported(
        &dataset,
        &[("log.csv", csv(&recorded, ",", false).into_bytes())],
    );
    assert!(matches!(imported.document.recipe.cutting, Cutting::Rest(_)));
    assert_eq!(imported.measurements.labels, dataset.measurements.labels);
    let first = &imported.document.poses[3];
    let reading = first.readings["rev_1"];
    assert!(
        reading.number > 60 && reading.sd == Some(0.0),
        "{reading:?}"
    );
    assert_same_identification(&dataset, &imported, "rests");
    let said = imported
        .document
        .notices
        .iter()
        .any(|notice| notice.starts_with("21 standstills with"));
    assert!(said, "{:?}", imported.document.notices);
}

/// Two recorders: every sample of the winches is kept, and the laser, read half as often and in between, is interpolated.
#[test]
fn a_recording_in_motion_keeps_every_sample() {
    let recording = Recording {
        duration_s: 10.0,
        rate_hz: 50.0,
        correlation_s: 0.0,
    };
    let options = SimulationOptions {
        noise: false,
        ..SimulationOptions::new(0, 3)
    };
    let robot = dataset().robot;
    let dataset = record(&robot, &options, &recording)
        .expect("recorded")
        .dataset;
    let data = &dataset.measurements;
    let mut winches = columns(data);
    winches.retain(|(name, _)| name.starts_with("Winch"));
    winches.insert(0, ("Time [s]".to_owned(), data.time_s.clone()));
    let odd = |values: &[f64]| values.iter().skip(1).step_by(2).copied().collect();
    let laser = vec![
        ("Time [s]".to_owned(), odd(&data.time_s)),
        ("Laser".to_owned(), odd(&data.laser_m)),
    ];
    let files = [
        ("winches.csv", csv(&winches, ",", false).into_bytes()),
        ("laser.csv", csv(&laser, ",", false).into_bytes()),
    ];
    let imported = imported(&dataset, &files);
    assert_eq!(imported.document.recipe.cutting, Cutting::Motion);
    let found = &imported.measurements;
    assert_eq!((found.len(), &found.revolutions), (501, &data.revolutions));
    assert!(found.laser_m[0].is_nan());
    for row in 2..499 {
        assert!(
            (found.laser_m[row] - data.laser_m[row]).abs() < 1e-5,
            "{row}"
        );
    }
    assert!(found.independent_samples(&robot, 100).is_some());
}

#[test]
fn rows_of_one_label_are_one_pose() {
    let dataset = dataset();
    let once = columns(&dataset.measurements);
    let thrice: Columns = once
        .iter()
        .map(|(name, values)| {
            (
                name.clone(),
                values.iter().flat_map(|value| [*value; 3]).collect(),
            )
        })
        .collect();
    let imported = imported(
        &dataset,
        &[("log.csv", csv(&thrice, ",", false).into_bytes())],
    );
    assert_eq!(imported.document.recipe.cutting, Cutting::Labels);
    assert_eq!(imported.document.poses[0].rows, 3);
    assert_same_identification(&dataset, &imported, "labels");
}

#[test]
fn a_point_list_of_a_tracker_joins_by_the_names_of_its_points() {
    let mut dataset = dataset();
    dataset.robot.tracker = Some(tautline_core::robot::Tracker {
        position_sd_m: tautline_core::robot::PerAxis::Same(1e-3),
        orientation_sd_rad: None,
    });
    let table = csv(&columns(&dataset.measurements), ",", false);
    // In another order than the poses, and not for all of them.
    let mut list = String::new();
    for pose in (2..15).rev() {
        let _ = writeln!(list, "P{pose} {} {} {}", 1000 * pose, 2.5, -f64::from(pose));
    }
    let imported = imported(
        &dataset,
        &[
            ("log.csv", table.into_bytes()),
            ("points.txt", list.into_bytes()),
        ],
    );
    let tracked = &imported.measurements.tracked_position_m;
    assert_eq!(tracked[7], [7.0, 0.0025, -0.007]);
    assert!(tracked[1][0].is_nan() && tracked[16][0].is_nan());
}

#[test]
fn markers_of_a_capture_are_measured_positions() {
    let mut dataset = dataset();
    dataset.robot.tracker = Some(tautline_core::robot::Tracker {
        position_sd_m: tautline_core::robot::PerAxis::Same(1e-3),
        orientation_sd_rad: None,
    });
    let recorded = recording(&columns(&dataset.measurements));
    let commanded = ["cmd.x", "cmd.y", "cmd.z"].map(|name| {
        let column = recorded.iter().find(|(known, _)| known == name);
        &column.expect("a column").1
    });
    let frames: Vec<[f32; 3]> = (0..recorded[0].1.len())
        .map(|row| commanded.map(|values| values[row] as f32))
        .collect();
    let imported = imported(
        &dataset,
        &[
            ("log.csv", csv(&recorded, ",", false).into_bytes()),
            ("take.c3d", c3d(100.0, "robot:platform", &frames)),
        ],
    );
    assert_eq!(imported.measurements.labels, dataset.measurements.labels);
    let tracked = &imported.measurements.tracked_position_m;
    let mut compared = 0;
    for (found, expected) in tracked.iter().zip(&dataset.measurements.commanded) {
        let Some(expected) = expected else { continue };
        let expected = expected.position.iter();
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
            compared += 1;
        }
    }
    assert!(compared > 50, "{compared}");
}

#[test]
fn motion_capture_has_y_up() {
    let mut dataset = dataset();
    dataset.robot.tracker = Some(tautline_core::robot::Tracker {
        position_sd_m: tautline_core::robot::PerAxis::Same(1e-3),
        orientation_sd_rad: Some(1e-3),
    });
    let recorded = recording(&columns(&dataset.measurements));
    let mut text = "Format Version,1.23,Length Units,Meters,Rotation Type,Quaternion\n\n,Name,P,P,P,P,P,P,P\n,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position\nFrame,Time (Seconds),X,Y,Z,W,X,Y,Z\n".to_owned();
    for (frame, time) in recorded[0].1.iter().enumerate() {
        let _ = writeln!(text, "{frame},{time},0.6,0,0,0.8,0.1,0.2,-0.3");
    }
    let imported = imported(
        &dataset,
        &[
            ("log.csv", csv(&recorded, ",", false).into_bytes()),
            ("take.csv", text.into_bytes()),
        ],
    );
    assert_eq!(imported.measurements.tracked_position_m[4], [0.1, 0.3, 0.2]);
    let quaternion = imported.measurements.tracked_orientation_wxyz[4];
    assert!(
        (quaternion[0] - 0.8).abs() < 1e-15 && (quaternion[1] - 0.6).abs() < 1e-15,
        "{quaternion:?}"
    );
    assert_same_identification(
        &dataset,
        &Imported {
            measurements: Measurements {
                tracked_position_m: Vec::new(),
                tracked_orientation_wxyz: Vec::new(),
                ..imported.measurements.clone()
            },
            ..imported
        },
        "motion capture beside",
    );
}

#[test]
fn a_recipe_is_used_as_it_is_written() {
    let dataset = dataset();
    let text = csv(&columns(&dataset.measurements), ",", false);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.csv");
    std::fs::write(&path, text).expect("written");
    let sources = read_sources(&[path], &MemoryBudget::default(), &|_| true)
        .expect("read")
        .value;
    let json = r#"{"format": "tautline-import-recipe", "version": 1, "channels": [
        {"channel": "Winch{i}.Pos", "quantity": "rev_{i}"},
        {"channel": "Winch4.Pos", "quantity": "rev_3", "reversed": true, "factor": 2, "offset": 0.5},
        {"channel": "pose", "quantity": "pose"}], "left_empty": ["rev_5"],
        "steps": [{"quantity": "rev_1", "from_pose": 3, "add": 1}]}"#;
    let recipe = tautline_session::parse_versioned(json.as_bytes(), "recipe.json")
        .expect("a recipe")
        .value;
    let found = import(
        &sources,
        &recipe,
        "recipe.json",
        &dataset.robot,
        &MemoryBudget::default(),
    )
    .expect("imported")
    .measurements;
    let given = &dataset.measurements.revolutions;
    for pose in 0..dataset.measurements.len() {
        assert_eq!(found.revolutions.get(pose, 1), given.get(pose, 1));
        assert_eq!(
            found.revolutions.get(pose, 2),
            -2.0 * given.get(pose, 3) + 0.5
        );
        assert!(found.revolutions.get(pose, 4).is_nan());
        let step = if dataset.measurements.labels[pose] >= 3 {
            1.0
        } else {
            0.0
        };
        assert_eq!(found.revolutions.get(pose, 0), given.get(pose, 0) + step);
    }
    for (entry, part) in [
        (
            r#"{"channel": "Winch{i}.Weg", "quantity": "rev_{i}"}"#,
            "/channels/0/channel: found no channel \"Winch1.Weg\"",
        ),
        (
            r#"{"channel": "Laser", "quantity": "rev_9"}"#,
            "/channels/0/quantity: found \"rev_9\", but the robot has 8 cables",
        ),
        (
            r#"{"channel": "Laser", "quantity": "force_1_n"}"#,
            "/channels/0/unit: the file states \"m\" for \"Laser\", expected a unit of force",
        ),
    ] {
        let json = format!(
            r#"{{"format": "tautline-import-recipe", "version": 1, "channels": [{entry}]}}"#
        );
        let recipe = tautline_session::parse_versioned(json.as_bytes(), "recipe.json")
            .expect("a recipe")
            .value;
        let error = import(
            &sources,
            &recipe,
            "recipe.json",
            &dataset.robot,
            &MemoryBudget::default(),
        )
        .expect_err(part)
        .to_string();
        assert!(error.contains(part), "{error}");
    }
    for (entry, part) in [
        (
            r#"{"channel": "a", "quantity": "speed"}"#,
            "/channels/0/quantity: found \"speed\", expected a column of poses.csv",
        ),
        (
            r#"{"channel": "a", "quantity": "laser_m", "unit": "N"}"#,
            "/channels/0/unit: found \"N\", expected a unit of length",
        ),
        (
            r#"{"channel": "a{i}", "quantity": "laser_m"}"#,
            "expected {i} once in both or in neither",
        ),
        (
            r#"{"channel": "a", "quantity": "laser_m", "factor": 0}"#,
            "/channels/0/factor: found 0",
        ),
    ] {
        let json = format!(
            r#"{{"format": "tautline-import-recipe", "version": 1, "channels": [{entry}]}}"#
        );
        let read = tautline_session::parse_versioned::<Recipe>(json.as_bytes(), "recipe.json");
        let error = read.expect_err(part).to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn more_poses_than_there_is_memory_for_are_refused_before_they_are_made() {
    const ROWS: usize = 50_000;
    let robot = dataset().robot;
    let channel = |cable: usize| Channel {
        name: format!("Winch{cable}.Pos"),
        unit: Some("rev".to_owned()),
        values: (0..ROWS)
            .map(|row| (0.01 * row as f64 + cable as f64).sin())
            .collect::<Vec<f64>>()
            .into(),
    };
    let sources = [Source {
        file: "many.parquet".to_owned(),
        format: Format::Parquet,
        series: vec![Series {
            name: "many".to_owned(),
            rows: ROWS,
            channels: (1..=8).map(channel).collect(),
            ..Series::default()
        }],
        notices: Vec::new(),
    }];
    let (recipe, _) = propose(&sources, &robot);
    let budget = MemoryBudget::new(64 << 20);
    let told = import(&sources, &recipe, "recipe.json", &robot, &budget);
    let told = told.expect_err("too many").to_string();
    let expected = "many.parquet: a table of 50000 poses needs more than 64.0 MiB of memory";
    assert!(told.starts_with(expected), "{told}");
}

#[test]
fn right_forces_are_not_divided_by_g_for_a_guessed_mass() {
    let dataset = dataset();
    let sources = read(csv(&columns(&dataset.measurements), ",", false));
    let mut guessed = dataset.robot.clone();
    let mass_kg = guessed.platform.mass_kg.expect("a mass");
    guessed.platform.mass_kg = Some(10.0 * mass_kg);
    let (recipe, _) = propose(&sources, &guessed);
    let corrected = |is_weighed| {
        let how = (is_weighed, &MemoryBudget::default());
        import_corrected(&sources, &recipe, "the recipe", &guessed, how).expect("imported")
    };
    let told = corrected(false).document;
    assert_eq!(told.applied, []);
    assert_eq!(told.recipe, recipe);
    let [suggestion] = &told.suggestions[..] else {
        panic!("one suggestion, found {:?}", told.suggestions);
    };
    assert!(suggestion.by_mass);
    // The mass of the sentence is that which the forces carry.
    let sentence = &suggestion.sentence;
    let stated = sentence.split("its mass is ").nth(1).expect("a mass");
    let stated: f64 = stated
        .split(' ')
        .next()
        .unwrap_or_default()
        .parse()
        .expect("a number");
    assert!((stated / mass_kg - 1.0).abs() < 0.05, "{sentence}");
    assert!(matches!(
        &corrected(true).document.applied[..],
        [applied] if matches!(applied.change, Change::Multiply { .. })
    ));
}

#[test]
fn counts_of_encoders_ask_how_many_make_a_revolution() {
    let dataset = dataset();
    let mut columns = columns(&dataset.measurements);
    for (name, values) in &mut columns {
        if name.ends_with(".Pos") {
            *name = name.replace("Pos", "Enc");
            values
                .iter_mut()
                .for_each(|value| *value = (65536.0 * *value).round());
        }
    }
    let sources = read(csv(&columns, ",", false));
    let (recipe, notices) = propose(&sources, &dataset.robot);
    assert!(
        recipe
            .channels
            .iter()
            .all(|known| known.quantity != "rev_{i}")
    );
    let asks = notices
        .iter()
        .find(|notice| notice.contains("encoder counts"));
    let asks = asks.expect("a question");
    assert!(
        asks.contains("--set \"rev_{i}=Winch{i}.Enc [rev/4096]\""),
        "{asks}"
    );
    let set = Assignment::parse("rev_{i}=Winch{i}.Enc [rev/65536]", &sources).expect("an entry");
    let (recipe, _) = propose_around(&sources, &dataset.robot, vec![set.clone()]);
    assert_eq!(recipe.channels.last(), Some(&set));
    assert!(
        recipe
            .channels
            .iter()
            .any(|known| known.quantity == "force_{i}_n")
    );
    let imported = followed(&sources, &recipe, &dataset.robot);
    let given = &dataset.measurements.revolutions;
    for pose in 0..dataset.measurements.len() {
        let found = imported.measurements.revolutions.get(pose, 3);
        assert!((found - given.get(pose, 3)).abs() < 1.0 / 65536.0);
    }
}

#[test]
fn what_does_not_go_forwards_is_no_clock() {
    let dataset = dataset();
    let mut columns = columns(&dataset.measurements);
    let waves = (0..dataset.measurements.len()).map(|row| (1.3 * row as f64).sin());
    columns.push(("t".to_owned(), waves.collect()));
    let sources = read(csv(&columns, ",", false));
    let (recipe, _) = propose(&sources, &dataset.robot);
    assert!(
        recipe
            .channels
            .iter()
            .all(|known| known.quantity != "time_s")
    );
    // Nor is it repaired as one if a recipe says that it is.
    let mut channels = recipe.channels;
    channels.push(Assignment::new("t", "time_s"));
    let recipe = Recipe {
        channels,
        cutting: Cutting::Rows,
        ..Recipe::default()
    };
    let imported = followed(&sources, &recipe, &dataset.robot);
    let repairs = |change: &Change| matches!(change, Change::CloseJumps { .. });
    let document = imported.document;
    assert!(
        !document
            .suggestions
            .iter()
            .any(|found| repairs(&found.change))
    );
    let told = |notice: &String| notice.contains("they are those of no clock");
    assert!(document.notices.iter().any(told), "{:?}", document.notices);
}

/// Angles of R = Rz Ry Rx.
fn yaw_pitch_roll([w, x, y, z]: [f64; 4]) -> [f64; 3] {
    [
        (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z)),
        (2.0 * (w * y - z * x)).asin(),
        (2.0 * (w * x + y * z)).atan2(1.0 - 2.0 * (x * x + y * y)),
    ]
}

#[test]
fn angles_of_commanded_poses_become_quaternions() {
    let dataset = dataset();
    let data = &dataset.measurements;
    let mut columns = columns(data);
    columns.retain(|(name, _)| !name.starts_with("cmd.q"));
    for (k, name) in ["Yaw", "Pitch", "Roll"].iter().enumerate() {
        let degrees = data.commanded.iter().map(|pose| {
            let pose = pose.expect("commanded");
            yaw_pitch_roll(pose.orientation_wxyz())[k].to_degrees()
        });
        columns.push((format!("cmd.{name}"), degrees.collect()));
    }
    let sources = read(csv(&columns, ",", false));
    let (mut recipe, notices) = propose(&sources, &dataset.robot);
    let told = notices
        .iter()
        .find(|notice| notice.contains("R = Rz Ry Rx"));
    assert!(
        told.is_some_and(|told| told.contains("in degrees")),
        "{notices:?}"
    );
    let off = |recipe: &Recipe| {
        let found = followed(&sources, recipe, &dataset.robot);
        let poses = found.measurements.commanded.iter().zip(&data.commanded);
        let off = poses.map(|(found, given)| {
            let (found, given) = (found.expect("a pose"), given.expect("a pose"));
            found.difference(&given).amax()
        });
        off.fold(0.0, f64::max)
    };
    assert!(off(&recipe) < 1e-9, "{}", off(&recipe));
    // The channels keep their axes in another order, which is not that of the file.
    recipe.order_angles("xyz".parse().expect("an order"));
    let column = |channel: &str| {
        let mut entries = recipe.channels.iter();
        entries
            .find(|known| known.channel == channel)
            .map(|known| known.quantity.clone())
    };
    assert_eq!(column("cmd.Roll").as_deref(), Some("angle_1_rad"));
    assert_eq!(column("cmd.Yaw").as_deref(), Some("angle_3_rad"));
    let wrong = off(&recipe);
    assert!((1e-3..0.2).contains(&wrong), "{wrong}");
}

#[test]
fn channels_without_a_name_are_known_by_what_they_do() {
    let dataset = dataset();
    let data = &dataset.measurements;
    for (unit, factor) in [
        (None, 1.0),
        (Some("deg"), -360.0),
        (Some("rad"), std::f64::consts::TAU),
    ] {
        let mut columns = columns(data);
        for (name, values) in &mut columns {
            if let Some(number) = name
                .strip_prefix("Winch")
                .and_then(|rest| rest.strip_suffix(".Pos"))
            {
                *name = format!("AI{number}");
                values.iter_mut().for_each(|value| *value *= factor);
            } else if let Some(number) = name
                .strip_prefix("Winch")
                .and_then(|rest| rest.strip_suffix(".Force"))
            {
                *name = format!("Kanal_{number}");
            }
        }
        let text = csv(&columns, ",", false)
            .replace(" [N]", "")
            .replace(" [rev]", "");
        let sources = read(text);
        let (recipe, notices) = propose(&sources, &dataset.robot);
        let entry = |column: &str| {
            let found = recipe
                .channels
                .iter()
                .find(|known| known.quantity == column);
            found.unwrap_or_else(|| panic!("no {column}: {notices:?}"))
        };
        let rev = entry("rev_{i}");
        assert_eq!((rev.channel.as_str(), rev.unit.as_deref()), ("AI{i}", unit));
        assert_eq!(rev.reversed, factor < 0.0);
        assert_eq!(entry("force_{i}_n").channel, "Kanal_{i}");
        for part in ["AI{i} follow the lengths", "Kanal_{i} carry the platform"] {
            assert!(
                notices.iter().any(|notice| notice.contains(part)),
                "{part}: {notices:?}"
            );
        }
    }
    // Channels that follow the cables in another order are none of them.
    let mut columns = columns(data);
    columns.retain(|(name, _)| !name.ends_with(".Force"));
    for (name, _) in &mut columns {
        if let Some(number) = name
            .strip_prefix("Winch")
            .and_then(|rest| rest.strip_suffix(".Pos"))
        {
            let number: usize = number.parse().expect("a number");
            *name = format!("AI{}", number % 8 + 1);
        }
    }
    let sources = read(csv(&columns, ",", false).replace(" [rev]", ""));
    let (recipe, _) = propose(&sources, &dataset.robot);
    assert!(
        recipe
            .channels
            .iter()
            .all(|known| !known.channel.starts_with("AI"))
    );
}
