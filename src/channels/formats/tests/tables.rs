use super::*;

/// Common content of all variants of one table.
fn expected() -> Content {
    vec![
        channel("t", Some("s"), &[0.0, 0.5, 1.0]),
        channel("Länge 1", Some("mm"), &[1200.5, -3.25, f64::NAN]),
        channel("F1", Some("N"), &[10.0, 2e3, 7.5]),
    ]
}

fn utf_16(text: &str) -> Vec<u8> {
    format!("\u{feff}{text}")
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect()
}

fn latin_1(text: &str) -> Vec<u8> {
    text.chars()
        .map(|letter| u8::try_from(u32::from(letter)).expect("Latin-1"))
        .collect()
}

#[test]
fn every_dialect_is_read_to_the_same_channels() {
    let english = "t [s],Länge 1 [mm],F1 [N]\n0,1200.5,10\n0.5,-3.25,2e3\n1,,7.5\n";
    let german = "t [s];Länge 1 [mm];F1 [N]\r\n0;1200,5;10\r\n0,5;-3,25;2e3\r\n1;;7,5\r\n";
    let tabs = "t (s)\tLänge 1 / mm\tF1 in N\n0,0\t1200,5\t10,0\n0,5\t-3,25\t2000\n1,0\tNaN\t7,5\n";
    let unit_row = "t,Länge 1,F1\n[s],[mm],[N]\n0,1200.5,10\n0.5,-3.25,2000\n1,-,7.5\n";
    let quoted = "\"t [s]\";\"Länge 1 [mm]\";\"F1 [N]\"\n\"0\";\"1200,5\";\"10\"\n\"0,5\";\"-3,25\";\"2000\"\n\"1\";\"\";\"7,5\"\n";
    let preamble = format!("Prüfstand 7; 2024\n\nBediener: X\n{german}");
    let commented = "# t[s] Länge1[mm] F1[N]\n0 1200.5 10\n0.5 -3.25 2000\n# a note\n1 nan 7.5\n"
        .replace("Länge1", "\"Länge 1\"");
    let bars = english.replace(',', "|");
    let ends = english.replace('\n', ",\n");
    for (name, bytes) in [
        ("english.csv", english.as_bytes().to_vec()),
        ("german.csv", german.as_bytes().to_vec()),
        ("marked.csv", format!("\u{feff}{german}").into_bytes()),
        ("latin.csv", latin_1(german)),
        ("utf16.txt", utf_16(tabs)),
        ("tabs.txt", tabs.as_bytes().to_vec()),
        ("units.csv", unit_row.as_bytes().to_vec()),
        ("quoted.csv", quoted.as_bytes().to_vec()),
        ("preamble.csv", preamble.into_bytes()),
        ("bars.txt", bars.into_bytes()),
    ] {
        let source = read(name, &bytes);
        assert_eq!(source.format, Format::Table, "{name}");
        assert_eq!(
            content(&source.series[0]),
            expected(),
            "{name}: {:?}",
            source.notices
        );
    }
    // A separator at the end of each row makes a column without a name.
    let source = read("ends.csv", ends);
    assert_eq!(content(&source.series[0])[..3], expected());
    // Blanks divide cells and cannot stand in a name.
    let source = read("blanks.txt", commented.replace("\"Länge 1\"", "Länge_1"));
    let mut blank = expected();
    blank[1].0 = "Länge_1".into();
    assert_eq!(content(&source.series[0]), blank, "{:?}", source.notices);
}

#[test]
fn what_is_left_out_is_told() {
    let source = read(
        "a.csv",
        "log of X\nt,v\n0,1\n1,2\n2\n3,4,5\n4,abc\n5,xyz\n6,7\n7",
    );
    assert_eq!(
        content(&source.series[0]),
        [
            channel("t", None, &[0.0, 1.0, 4.0, 5.0, 6.0]),
            channel("v", None, &[1.0, 2.0, f64::NAN, f64::NAN, 7.0])
        ]
    );
    assert_eq!(
        source.notices,
        [
            "a.csv, line 1: \"log of X\" before the table: not used",
            "a.csv, line 5: found 1 cells, expected 2: 3 such rows left out",
            "a.csv, column \"v\": line 7 holds \"abc\" and 1 more such cells, treated as missing",
        ]
    );
    let source = read("b.csv", "t,v\n0,1\n1,2\n2");
    assert_eq!(
        source.notices,
        ["b.csv, line 4: the last row ends after 1 of 2 cells: left out"]
    );
    let source = read("c.csv", latin_1("Größe,b\n1,2\n3,4\n"));
    assert_eq!(source.notices, ["c.csv: read as Windows-1252"]);
    assert_eq!(source.series[0].channels[0].name, "Größe");
}

#[test]
fn tables_without_a_header_go_by_numbers() {
    let source = read("a.txt", "1 2 3\n4 5 6\n7 8 9\n");
    assert_eq!(
        content(&source.series[0])[2],
        channel("column 3", None, &[3.0, 6.0, 9.0])
    );
    assert_eq!(
        source.notices,
        ["a.txt: no header row; columns are numbered"]
    );
    let source = read("one.txt", "1.5\n2.5\n");
    assert_eq!(
        content(&source.series[0]),
        [channel("column 1", None, &[1.5, 2.5])]
    );
}

#[test]
fn texts_and_times_are_columns_too() {
    let source = read(
        "a.csv",
        "when;state;p\n2024-01-02 10:00:00,5;run;1\n2024-01-02 10:00:01,0;stop;2\n2024-01-02 10:00:01,5;run;3\n",
    );
    let series = &source.series[0];
    assert_eq!(content(series)[0].1.as_deref(), Some("s"));
    assert_eq!(
        series.channels[0].values.at(2) - series.channels[0].values.at(0),
        1.0
    );
    let states: Vec<&str> = (0..3).map(|row| series.texts[0].at(row)).collect();
    assert_eq!(states, ["run", "stop", "run"]);
    let source = read("twice.csv", "a,a,\n1,2,3\n4,5,6\n");
    let names: Vec<&str> = source.series[0]
        .channels
        .iter()
        .map(|channel| channel.name.as_str())
        .collect();
    assert_eq!(names, ["a", "a (2)", "column 3"]);
}

#[test]
fn ambiguous_tables_are_refused() {
    assert_eq!(
        refusal("a.csv", "a;b\n1.5;2\n2.5;3\n3;1,5\n"),
        "a.csv, line 4: found a decimal comma and, in line 2, a decimal point, expected one of the two"
    );
    let broken = "a,b,c\n1,2,3\n4,5,6\n7,8,9\n1,2\n1,2\n1,2\n1,2\n1,2\n1,2\n1,2\n1,2\n";
    assert!(refusal("b.csv", broken).contains("cells, expected"));
}

#[test]
fn point_lists_have_names_and_coordinates() {
    let expected = vec![
        channel("x", None, &[1234.5, -2.0, 3.25]),
        channel("y", None, &[1.0, 2.0, 3.0]),
        channel("z", None, &[0.0, 0.5, 1.0]),
    ];
    for (name, text) in [
        ("a.txt", "P1 1234.5 1 0\nP2 -2 2 0.5\nP3 3.25 3 1\n"),
        ("b.csv", "P1;1234,5;1;0\nP2;-2;2;0,5\nP3;3,25;3;1\n"),
        ("c.txt", "P1,1234.5,1,0\r\nP2,-2,2,0.5\r\nP3,3.25,3,1"),
    ] {
        let source = read(name, text);
        assert_eq!(
            (source.format, content(&source.series[0])),
            (Format::PointList, expected.clone()),
            "{name}"
        );
        assert_eq!(source.series[0].texts[0].at(1), "P2");
    }
    let source = read("sd.txt", "A 1 2 3 0.1 0.2 0.3\nB 4 5 6 0.1 0.2 0.3\n");
    assert_eq!(
        content(&source.series[0])[5],
        channel("sz", None, &[0.3, 0.3])
    );
}
