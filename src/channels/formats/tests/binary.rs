use std::io::Write;

use flate2::Compression;
use flate2::write::{DeflateEncoder, ZlibEncoder};

use super::*;

/// An element of a MATLAB file.
fn element(kind: u32, data: &[u8], big: bool) -> Vec<u8> {
    let word = |word: u32| {
        if big {
            word.to_be_bytes()
        } else {
            word.to_le_bytes()
        }
    };
    let mut bytes = [word(kind), word(data.len() as u32)].concat();
    bytes.extend_from_slice(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// The beginning of an array: flags, dimensions and name.
fn array_head(class: u32, size: [u32; 2], name: &str, big: bool) -> Vec<u8> {
    let word = |word: u32| {
        if big {
            word.to_be_bytes()
        } else {
            word.to_le_bytes()
        }
    };
    [
        element(6, &[word(class), word(0)].concat(), big),
        element(5, &size.map(word).concat(), big),
        element(1, name.as_bytes(), big),
    ]
    .concat()
}

pub(super) fn doubles(name: &str, size: [u32; 2], values: &[f64], big: bool) -> Vec<u8> {
    let bytes = |value: &f64| {
        if big {
            value.to_be_bytes()
        } else {
            value.to_le_bytes()
        }
    };
    let data: Vec<u8> = values.iter().flat_map(bytes).collect();
    element(
        14,
        &[array_head(6, size, name, big), element(9, &data, big)].concat(),
        big,
    )
}

pub(super) fn matlab(elements: &[Vec<u8>], big: bool) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file, Platform: GLNXA64".to_vec();
    bytes.resize(124, b' ');
    bytes.extend_from_slice(if big { b"\x01\x00MI" } else { b"\x00\x01IM" });
    elements
        .iter()
        .for_each(|element| bytes.extend_from_slice(element));
    bytes
}

pub(super) fn compressed(element: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(element).expect("written");
    let data = encoder.finish().expect("compressed");
    [
        15_u32.to_le_bytes().to_vec(),
        (data.len() as u32).to_le_bytes().to_vec(),
        data,
    ]
    .concat()
}

fn log() -> Content {
    vec![
        channel("t", None, &[0.0, 1.0, 2.0]),
        channel("pos(:,1)", None, &[1.5, 2.5, 3.5]),
        channel("pos(:,2)", None, &[-1.0, -2.0, -3.0]),
    ]
}

#[test]
fn matlab_files_in_both_orders_and_compressed() {
    for big in [false, true] {
        let t = doubles("t", [1, 3], &[0.0, 1.0, 2.0], big);
        let pos = doubles("pos", [3, 2], &[1.5, 2.5, 3.5, -1.0, -2.0, -3.0], big);
        let source = read("a.mat", matlab(&[t, pos], big));
        assert_eq!(
            (source.format, content(&source.series[0])),
            (Format::Matlab, log())
        );
    }
    let t = doubles("t", [3, 1], &[0.0, 1.0, 2.0], false);
    let pos = doubles("pos", [3, 2], &[1.5, 2.5, 3.5, -1.0, -2.0, -3.0], false);
    let source = read("b.mat", matlab(&[compressed(&t), compressed(&pos)], false));
    assert_eq!(content(&source.series[0]), log());
    // Whole numbers are stored as narrow as they fit: here 0, 1, 2 in one small element.
    let small = [
        array_head(6, [3, 1], "t", false),
        vec![2, 0, 3, 0, 0, 1, 2, 0],
    ]
    .concat();
    let source = read(
        "c.mat",
        matlab(&[element(14, &small, false), compressed(&pos)], false),
    );
    assert_eq!(content(&source.series[0]), log());
}

#[test]
fn matlab_structs_and_cells() {
    let unnamed = |values: &[f64]| doubles("", [values.len() as u32, 1], values, false);
    let mut names = b"t\0\0\0\0\0\0\0force".to_vec();
    names.resize(16, 0);
    let fields = [
        array_head(2, [1, 1], "log", false),
        vec![5, 0, 4, 0, 8, 0, 0, 0],
        element(1, &names, false),
        unnamed(&[0.0, 1.0]),
        unnamed(&[5.0, f64::NAN]),
    ]
    .concat();
    let cells = [
        array_head(1, [1, 2], "runs", false),
        unnamed(&[1.0, 2.0]),
        unnamed(&[3.0, 4.0]),
    ]
    .concat();
    let text = [
        array_head(4, [1, 2], "note", false),
        element(4, &[65, 0, 66, 0], false),
    ]
    .concat();
    let scalar = doubles("gain", [1, 1], &[2.0], false);
    let source = read(
        "a.mat",
        matlab(
            &[
                element(14, &fields, false),
                element(14, &cells, false),
                element(14, &text, false),
                scalar,
            ],
            false,
        ),
    );
    assert_eq!(
        content(&source.series[0]),
        [
            channel("log.t", None, &[0.0, 1.0]),
            channel("log.force", None, &[5.0, f64::NAN])
        ]
    );
    assert_eq!(
        content(&source.series[1]),
        [
            channel("runs{1}", None, &[1.0, 2.0]),
            channel("runs{2}", None, &[3.0, 4.0])
        ]
    );
    assert_eq!(
        source.notices,
        ["a.mat: variable \"gain\" of 1 x 1 left out: not readings"]
    );
}

/// Struct array, cell array, nested structs, and a matrix with one row per cable, written by SciPy 1.17.
#[test]
fn matlab_struct_arrays_are_tables() {
    let source = read("log.mat", seed("scipy.mat"));
    let names = |series: &Series| -> Vec<String> {
        let channels = series.channels.iter();
        channels.map(|channel| channel.name.clone()).collect()
    };
    let poses = &source.series[0];
    assert_eq!(poses.rows, 12);
    assert_eq!(
        names(poses),
        [
            "poses.rev(:,1)",
            "poses.rev(:,2)",
            "poses.rev(:,3)",
            "poses.rev(:,4)",
            "poses.laser",
            "poses.cmd.x(:,1)",
            "poses.cmd.x(:,2)",
            "poses.cmd.x(:,3)",
            "poses.cmd.q(:,1)",
            "poses.cmd.q(:,2)",
            "poses.cmd.q(:,3)",
            "poses.cmd.q(:,4)",
        ]
    );
    let value = |name: &str, row: usize| poses.channel(name).expect(name).values.at(row);
    assert_eq!(value("poses.rev(:,2)", 4), -2.0);
    assert_eq!(value("poses.laser", 2), 1.52);
    assert!(value("poses.laser", 3).is_nan(), "an empty array");
    assert_eq!(value("poses.cmd.x(:,3)", 10), 3.0);
    let labels = poses.text("poses.name").expect("names");
    assert_eq!((labels.at(0), labels.at(11)), ("P0", "P11"));
    let nested = source.series.iter().find_map(|series| {
        let name = "log.plant.winch.angle_rad(:,4)";
        series.channel(name)
    });
    let nested = nested.expect("a matrix in a struct in a struct");
    assert_eq!(
        (nested.unit.as_deref(), nested.values.at(3)),
        (Some("rad"), 12.0)
    );
    assert_eq!(source.notices, [""; 0]);
}

/// An object as MATLAB writes it (scipy/scipy, pull request 23481): flags, name, type system, class, and the reference to its
/// properties, which are in an array without a name.
#[test]
fn matlab_objects_are_named_with_advice() {
    let object = |name: &str, class: &str| {
        let flags = [17_u32.to_le_bytes(), 0_u32.to_le_bytes()].concat();
        let head = [
            element(6, &flags, false),
            element(1, name.as_bytes(), false),
            element(1, b"MCOS", false),
            element(1, class.as_bytes(), false),
        ];
        let refers = doubles("", [6, 1], &[3.7e9, 2.0, 1.0, 1.0, 1.0, 1.0], false);
        element(14, &[head.concat(), refers].concat(), false)
    };
    let properties = doubles("", [4, 1], &[1.0, 2.0, 3.0, 4.0], false);
    let t = doubles("t", [3, 1], &[0.0, 1.0, 2.0], false);
    let whole = matlab(
        &[
            object("ts", "timeseries"),
            object("log", "timetable"),
            t,
            object("own", "Robot"),
            properties,
        ],
        false,
    );
    let source = read("a.mat", whole);
    assert_eq!(
        content(&source.series[0]),
        [channel("t", None, &[0.0, 1.0, 2.0])]
    );
    assert_eq!(
        source.notices,
        [
            "a.mat: variable \"ts\", an object of class \"timeseries\" (save its Time and Data as arrays), left out",
            "a.mat: variable \"log\", an object of class \"timetable\" (save its variables and seconds(RowTimes) as arrays, or use writetimetable), left out",
            "a.mat: variable \"own\", an object of class \"Robot\" (save its properties as arrays), left out",
        ]
    );
    let alone = refusal("b.mat", matlab(&[object("ts", "timeseries")], false));
    assert!(
        alone.contains("variable \"ts\", an object of class \"timeseries\""),
        "{alone}"
    );
}

#[test]
fn matlab_files_that_are_broken() {
    let whole = matlab(
        &[
            doubles("t", [3, 1], &[0.0, 1.0, 2.0], false),
            doubles("u", [3, 1], &[0.0; 3], false),
        ],
        false,
    );
    let source = read("a.mat", &whole[..whole.len() - 9]);
    assert_eq!(
        content(&source.series[0]),
        [channel("t", None, &[0.0, 1.0, 2.0])]
    );
    assert_eq!(source.notices.len(), 1);
    assert!(
        source.notices[0].ends_with("the file ends in the middle of a variable: left out"),
        "{}",
        source.notices[0]
    );
    let mut order = whole.clone();
    order[126] = b'X';
    assert!(refusal("b.mat", order).contains("byte 126: found no byte order"));
    let wrong = element(
        14,
        &[
            array_head(6, [4, 1], "t", false),
            element(9, &[0; 24], false),
        ]
        .concat(),
        false,
    );
    assert!(refusal("c.mat", matlab(&[wrong], false)).contains("found a damaged array"));
    assert!(refusal("d.mat", matlab(&[], false)).contains("found no numeric array"));
    let mut damaged = compressed(&doubles("t", [3, 1], &[0.0, 1.0, 2.0], false));
    damaged[20] ^= 0xff;
    assert!(refusal("e.mat", matlab(&[damaged], false)).contains("damaged"));
}

pub(super) fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
    [
        b"\x93NUMPY\x01\x00",
        &(header.len() as u16).to_le_bytes()[..],
        header.as_bytes(),
        data,
    ]
    .concat()
}

pub(super) fn archive(entries: &[(&str, Vec<u8>)], compress: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut archive = rawzip::ZipArchiveWriter::new(&mut bytes);
    for (name, data) in entries {
        let method = if compress {
            rawzip::CompressionMethod::DEFLATE
        } else {
            rawzip::CompressionMethod::STORE
        };
        let (mut entry, config) = archive
            .new_file(name)
            .compression_method(method)
            .start()
            .expect("an entry");
        let descriptor = if compress {
            let mut writer = config.wrap(DeflateEncoder::new(&mut entry, Compression::default()));
            writer.write_all(data).expect("written");
            let (encoder, descriptor) = writer.finish().expect("finished");
            encoder.finish().expect("finished");
            descriptor
        } else {
            let mut writer = config.wrap(&mut entry);
            writer.write_all(data).expect("written");
            writer.finish().expect("finished").1
        };
        entry.finish(descriptor).expect("finished");
    }
    archive.finish().expect("finished");
    bytes
}

#[test]
fn numpy_arrays_of_all_types() {
    let expected = vec![
        channel("column 1", None, &[1.0, 3.0, 5.0]),
        channel("column 2", None, &[2.0, 4.0, 6.0]),
    ];
    let little: Vec<u8> = (1..=6).flat_map(|k| f64::from(k).to_le_bytes()).collect();
    let big: Vec<u8> = [1.0_f32, 3.0, 5.0, 2.0, 4.0, 6.0]
        .iter()
        .flat_map(|value| value.to_be_bytes())
        .collect();
    let whole: Vec<u8> = (1_i16..=6).flat_map(i16::to_le_bytes).collect();
    for (name, bytes) in [
        ("a.npy", npy("'<f8'", false, "(3, 2)", &little)),
        ("b.npy", npy("'>f4'", true, "(3, 2)", &big)),
        ("c.npy", npy("'<i2'", false, "(3, 2)", &whole)),
    ] {
        let source = read(name, bytes);
        assert_eq!(
            (source.format, content(&source.series[0])),
            (Format::NumPy, expected.clone()),
            "{name}"
        );
    }
    let minus: Vec<u8> = [-2_i32, -1]
        .iter()
        .flat_map(|value| value.to_be_bytes())
        .collect();
    assert_eq!(
        content(&read("d.npy", npy("'>i4'", false, "(2,)", &minus)).series[0]),
        [channel("values", None, &[-2.0, -1.0])]
    );
    let records: Vec<u8> = (0..2_u8)
        .flat_map(|k| [&f64::from(k).to_le_bytes()[..], &[k + 7, k + 8], b"P\0"].concat())
        .collect();
    let source = read(
        "e.npy",
        npy(
            "[('t_s', '<f8'), ('n', '|u1', (2,)), ('name', '|S2')]",
            false,
            "(2,)",
            &records,
        ),
    );
    assert_eq!(
        content(&source.series[0]),
        [
            channel("t_s", Some("s"), &[0.0, 1.0]),
            channel("n[0]", None, &[7.0, 8.0]),
            channel("n[1]", None, &[8.0, 9.0])
        ]
    );
    assert_eq!(source.series[0].texts[0].at(1), "P");
}

#[test]
fn numpy_archives() {
    let column = |values: &[f64]| -> Vec<u8> {
        values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect()
    };
    let entries = [
        ("t.npy", npy("'<f8'", false, "(2,)", &column(&[0.0, 1.0]))),
        (
            "rev.npy",
            npy("'<f8'", false, "(2, 2)", &column(&[1.0, 2.0, 3.0, 4.0])),
        ),
        ("gain.npy", npy("'<f8'", false, "()", &column(&[1.0]))),
    ];
    for compress in [false, true] {
        let source = read("a.npz", archive(&entries, compress));
        assert_eq!(
            content(&source.series[0]),
            [
                channel("t", None, &[0.0, 1.0]),
                channel("rev[0]", None, &[1.0, 3.0]),
                channel("rev[1]", None, &[2.0, 4.0])
            ]
        );
        assert_eq!(
            source.notices,
            ["a.npz: array \"gain\": an array of shape [] left out: not a table"]
        );
    }
}

#[test]
fn numpy_files_that_are_broken() {
    let data = vec![0; 16];
    for (bytes, part) in [
        (
            npy("'<f8'", false, "(3,)", &data),
            "a.npy: found 16 bytes of data, expected 24",
        ),
        (
            npy("'<c16'", false, "(2,)", &data),
            "found values of type \"<c16\", expected real numbers or text",
        ),
        (
            npy("'|O'", false, "(2,)", &data),
            "expected real numbers or text",
        ),
        (npy("'<f8'", false, "(x,)", &data), "found an invalid shape"),
        (
            b"\x93NUMPY\x09\x00".to_vec(),
            "found format version 9, expected 1 to 3",
        ),
        (b"\x93NUMPY\x01\x00\xff\xff{".to_vec(), "ends in its header"),
        (
            npy("'<f8'", false, "(1,)", &data),
            "found no array of two rows or more",
        ),
        (
            npy("'<f8'", false, "(99999999999, 99999999999)", &data),
            "expected fewer",
        ),
    ] {
        let sentence = refusal("a.npy", bytes);
        assert!(sentence.contains(part), "{sentence}");
    }
    let mut bytes = archive(&[("t.npy", npy("'<f8'", false, "(2,)", &data))], true);
    let damaged = bytes.len() / 4;
    bytes[damaged] ^= 0xff;
    assert!(refusal("a.npz", bytes).contains("damaged"));
}

const WORKBOOK: &str = r#"<workbook xmlns:r="x"><sheets><sheet name="Notes" sheetId="1" r:id="rId1"/><sheet name="Log &amp; more" sheetId="2" r:id="rId2"/></sheets></workbook>"#;
const RELATIONS: &str = r#"<Relationships><Relationship Id="rId1" Target="worksheets/sheet1.xml"/><Relationship Id="rId2" Target="/xl/worksheets/sheet2.xml"/></Relationships>"#;
const SHARED: &str = r#"<sst><si><t>t [s]</t></si><si><r><t>Force </t></r><r><t>1 [N]</t></r></si><si><t>only a &lt;note&gt;</t></si></sst>"#;
const STYLES: &str = r#"<styleSheet><numFmts><numFmt numFmtId="164" formatCode="yyyy\-mm\-dd hh:mm:ss"/></numFmts><cellStyleXfs><xf numFmtId="14"/></cellStyleXfs><cellXfs><xf numFmtId="0"/><xf numFmtId="164"/></cellXfs></styleSheet>"#;
const NOTES: &str = r#"<worksheet><sheetData><row r="1"><c r="A1" t="s"><v>2</v></c></row></sheetData></worksheet>"#;

pub(super) fn workbook(sheet: &str) -> Vec<u8> {
    let parts = [
        ("xl/workbook.xml", WORKBOOK),
        ("xl/_rels/workbook.xml.rels", RELATIONS),
        ("xl/sharedStrings.xml", SHARED),
        ("xl/styles.xml", STYLES),
        ("xl/worksheets/sheet1.xml", NOTES),
        ("xl/worksheets/sheet2.xml", sheet),
    ];
    let parts: Vec<(&str, Vec<u8>)> = parts
        .iter()
        .map(|(name, text)| (*name, text.as_bytes().to_vec()))
        .collect();
    archive(&parts, true)
}

#[test]
fn excel_workbooks() {
    let expected = vec![
        channel("t", Some("s"), &[0.0, 0.5, 1.0]),
        channel("Force 1", Some("N"), &[10.0, f64::NAN, 7.5]),
    ];
    let head = r#"<row r="1"><c r="A1" t="s"><v>0</v></c><c r="B1" t="s"><v>1</v></c></row>"#;
    let inline =
        r#"<row><c t="inlineStr"><is><t>t [s]</t></is></c><c t="str"><v>Force 1 [N]</v></c></row>"#;
    let rows = r#"<row r="2"><c r="A2"><v>0</v></c><c r="B2"><v>10</v></c></row><row r="3"><c r="A3"><v>0.5</v></c></row><row r="5"><c r="A5"><v>1</v></c><c r="B5"><f>A5*7.5</f><v>7.5</v></c></row>"#;
    let error = rows.replace(
        r#"<c r="A3"><v>0.5</v></c>"#,
        r##"<c r="A3"><v>0.5</v></c><c r="B3" t="e"><v>#DIV/0!</v></c>"##,
    );
    for (name, sheet) in [
        ("a.xlsx", format!("{head}{rows}")),
        ("b.xlsx", format!("{inline}{rows}")),
        ("c.xlsx", format!("{head}{error}")),
    ] {
        let source = read(
            name,
            workbook(&format!(
                "<worksheet><sheetData>{sheet}</sheetData></worksheet>"
            )),
        );
        assert_eq!(
            (source.format, content(&source.series[0])),
            (Format::Excel, expected.clone()),
            "{name}: {:?}",
            source.notices
        );
        assert!(
            source.series[0].name.ends_with("Log & more"),
            "{}",
            source.series[0].name
        );
        assert_eq!(
            source.notices,
            [format!(
                "{name}, sheet \"Notes\": found no row of numbers, expected a table with a reading in each column: sheet left out"
            )]
        );
    }
}

#[test]
fn dates_in_workbooks_are_times() {
    let sheet = r#"<worksheet><sheetData>
        <row r="1"><c r="A1" t="inlineStr"><is><t>when</t></is></c><c r="B1" t="inlineStr"><is><t>v</t></is></c></row>
        <row r="2"><c r="A2" s="1"><v>45352.5</v></c><c r="B2"><v>1</v></c></row>
        <row r="3"><c r="A3" s="1"><v>45352.50001157407</v></c><c r="B3"><v>2</v></c></row></sheetData></worksheet>"#;
    let source = read("a.xlsx", workbook(sheet));
    // 1 March 2024, noon.
    let content = content(&source.series[0]);
    assert_eq!(
        content[0],
        channel("when", Some("s"), &[1_709_294_400.0, 1_709_294_401.0])
    );
}

#[test]
fn workbooks_that_are_broken() {
    let sheet = |cells: &str| {
        workbook(&format!(
            "<worksheet><sheetData><row>{cells}</row></sheetData></worksheet>"
        ))
    };
    assert!(
        refusal("a.xlsx", sheet(r#"<c r="A1" t="s"><v>99</v></c>"#))
            .contains("part xl/worksheets/sheet2.xml is damaged")
    );
    assert!(refusal("b.xlsx", sheet(r#"<c r="ZZZZZZZZ1"><v>1</v></c>"#)).contains("is damaged"));
    assert!(refusal("c.xlsx", sheet("")).contains("found no row of numbers"));
    assert!(
        refusal("d.xlsx", archive(&[("a.txt", b"hello".to_vec())], false))
            .contains("is an archive without a workbook or arrays")
    );
    assert!(refusal("e.xlsx", &workbook("<worksheet/>")[..900]).contains("damaged archive"));
}

/// The content of a file that another program has written.
/// A file that pandas, polars or pyarrow has written.
fn parquet(name: &str) -> Source {
    read(name, seed(name))
}

#[test]
fn parquet_of_pandas_has_times_gaps_and_texts() {
    let source = parquet("pandas.parquet");
    let series = &source.series[0];
    assert_eq!((source.format, series.rows), (Format::Parquet, 6));
    let time = series.channel("time").expect("times");
    assert_eq!(time.unit.as_deref(), Some("s"));
    // 31 May 2024, 10:00 UTC, in steps of 10 ms.
    for (row, found) in time.values.iter().enumerate() {
        let expected = 1_717_149_600.0 + 0.01 * row as f64;
        assert!((found - expected).abs() < 1e-6, "{found}");
    }
    let rev = Some("rev");
    assert_eq!(
        content(series)[1..],
        [
            channel("Winch1.Pos", rev, &[0.0, 0.25, 0.5, 0.75, 1.0, 1.25]),
            channel("Winch2.Pos", rev, &[0.5, f64::NAN, 1.5, 2.0, 2.5, 3.0]),
            channel("count", None, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]),
            channel("armed", None, &[1.0, 0.0, 1.0, 0.0, 1.0, 0.0]),
        ]
    );
    let states: Vec<&str> = (0..6).map(|row| series.texts[0].at(row)).collect();
    assert_eq!(states, ["still", "still", "moving", "moving", "still", ""]);
    assert_eq!(
        source.notices,
        ["pandas.parquet, column \"pair.list.element\": variable-length lists, left out"]
    );
}

#[cfg(not(feature = "more-formats"))]
#[test]
fn parquet_in_other_compressors_says_what_to_do() {
    for (name, compressor) in [("polars.parquet", "Zstandard"), ("groups.parquet", "gzip")] {
        let sentence = refusal(name, seed(name));
        let expected = format!("is compressed with {compressor}, which this build leaves out");
        assert!(sentence.contains(&expected), "{sentence}");
    }
}

#[cfg(feature = "more-formats")]
#[test]
fn parquet_of_other_writers_in_other_compressors_and_groups() {
    let source = parquet("polars.parquet");
    assert_eq!(
        content(&source.series[0]),
        [
            channel("t_ms", Some("ms"), &[0.0, 10.0, 20.0, 30.0, 40.0, 50.0]),
            channel(
                "F1",
                Some("N"),
                &[100.0, 101.0, f64::NAN, 103.0, 104.0, 105.0]
            ),
            channel("n", None, &[1.0, 2.0, 3.0, 4.0, 5.0, 1_099_511_627_776.0]),
        ]
    );
    assert_eq!(source.series[0].texts[0].at(3), "b");
    let source = parquet("groups.parquet");
    assert_eq!(
        content(&source.series[0]),
        [
            channel("a", None, &[1.5, 2.5, 3.5, 4.5]),
            channel("s.x", None, &[1.0, 2.0, f64::NAN, 4.0]),
            channel("s.y", None, &[7.0, 8.0, 9.0, 10.0]),
        ]
    );
}
