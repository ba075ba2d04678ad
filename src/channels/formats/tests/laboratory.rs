//! Files of measuring computers: TDMS that `nptdms` has written, MDF 4 that `asammdf` has written, and text of LabVIEW.

use super::*;

#[test]
fn tdms_of_nptdms_has_values_of_all_segments_with_times_and_units() {
    let source = read("log.tdms", seed("nptdms.tdms"));
    assert_eq!(source.format, Format::Tdms);
    let [data, room] = &source.series[..] else {
        panic!("{:?}", source.series);
    };
    assert_eq!(data.name, "log Daten");
    assert_eq!(times(data), Some(vec![1.0, 1.25, 1.5, 1.75, 2.0]));
    assert_eq!(
        content(data),
        [
            channel("Winch1.Pos", Some("rev"), &[0.0, 1.5, 3.0, 4.5, 6.0]),
            channel("Winch2's Pos", Some("deg"), &[0.0, 10.0, 20.0, 30.0, 40.0]),
            // Stored as 0, 2, 4, 6, 8 with the scaling 3 x + 0.5.
            channel("Kraft", Some("N"), &[0.5, 6.5, 12.5, 18.5, 24.5]),
        ]
    );
    assert_eq!(room.name, "log Temperatur");
    assert_eq!(content(room), [channel("Raum", None, &[20.5, 20.5])]);
    assert_eq!(times(room), None);
    assert_eq!(
        source.notices,
        ["log.tdms: channel \"Notiz\" has texts, left out"]
    );
}

/// The recorder did not close the second segment.
#[test]
fn tdms_that_is_cut_off_is_read_as_far_as_it_goes() {
    let whole = seed("nptdms.tdms");
    let second = whole
        .windows(4)
        .rposition(|bytes| bytes == b"TDSm")
        .expect("two segments");
    let source = read("log.tdms", &whole[..second + 40]);
    assert_eq!(source.series[0].rows, 3);
    assert!(
        source
            .notices
            .iter()
            .any(|notice| notice.contains("cut off")),
        "{:?}",
        source.notices
    );
    assert!(refusal("a.tdms", &whole[..20]).contains("expected readings"));
    let mut daqmx = whole.clone();
    daqmx[4] |= 1 << 7;
    assert!(refusal("b.tdms", daqmx).contains("raw data of DAQmx devices"));
}

/// The same channels, stored plainly and compressed in columns.
#[test]
fn mdf_of_asammdf_has_physical_values() {
    for name in ["asammdf.mf4", "packed.mf4"] {
        let source = read("log.mf4", seed(name));
        assert_eq!(source.format, Format::Mdf, "{name}");
        let [control, room] = &source.series[..] else {
            panic!("{name}: {:?}", source.series);
        };
        assert_eq!(control.name, "log Steuerung", "{name}");
        assert_eq!(times(control), Some(vec![0.0, 0.5, 1.0, 1.5, 2.0, 2.5]));
        assert_eq!(
            content(control),
            [
                channel(
                    "Winde1.Pos",
                    Some("rev"),
                    &[0.0, 1.25, 2.5, 3.75, 5.0, 6.25]
                ),
                // Stored as -3 to 2 with the conversion 2 x + 10.
                channel("Kraft", Some("N"), &[4.0, 6.0, 8.0, 10.0, 12.0, 14.0]),
                channel("Status", None, &[0.0, 1.0, 2.0, 3.0, 200.0, 255.0]),
                channel("Motorola", Some("mm"), &[1.5, 2.5, 3.5, 4.5, 5.5, 6.5]),
            ],
            "{name}"
        );
        assert_eq!(content(room), [channel("Raum", Some("°C"), &[20.0, 21.0])]);
        assert_eq!(times(room), Some(vec![0.0, 2.0]));
    }
    let mut old = seed("asammdf.mf4");
    old[8..12].copy_from_slice(b"3.30");
    assert!(refusal("a.mf4", old).contains("is MDF of version \"3.30\", expected 4.0 or later"));
    assert!(refusal("b.mf4", &seed("asammdf.mf4")[..200]).contains("is damaged, expected MDF 4"));
}

const HEADER: &str = "LabVIEW Measurement\t\r\nWriter_Version\t2\r\nReader_Version\t2\r\nSeparator\tTab\r\n\
    Decimal_Separator\t,\r\nMulti_Headings\tYes\r\nX_Columns\tCOLUMNS\r\nTime_Pref\tRelative\r\nOperator\tlab\r\n\
    ***End_of_Header***\t\r\n\t\r\n";

/// Without a column of times these follow from the header of the segment; the second segment has one of its own.
#[test]
fn labview_text_has_times_by_its_header() {
    let segment = "Channels\t2\t\r\nSamples\t3\t3\t\r\nDate\t2024/05/31\t2024/05/31\t\r\nY_Unit_Label\tN\tmm\t\r\n\
        X_Dimension\tTime\tTime\t\r\nX0\t1,0000E+0\t1,0000E+0\t\r\nDelta_X\t0,500000\t0,500000\t\r\n\
        ***End_of_Header***\t\t\t\r\nX_Value\tKraft 1\tUntitled\tComment\r\n\
        \t10,500000\t0,25\t\r\n\t11,500000\t0,50\tremark\r\n\t12,500000\t\t\r\n";
    let text = format!("{}{segment}\r\n{segment}", HEADER.replace("COLUMNS", "No"));
    let source = read("log.lvm", text);
    assert_eq!((source.format, source.series.len()), (Format::LabView, 2));
    for series in &source.series {
        assert_eq!(times(series), Some(vec![1.0, 1.5, 2.0]));
        assert_eq!(
            content(series),
            [
                channel("Kraft 1", Some("N"), &[10.5, 11.5, 12.5]),
                channel("Untitled", Some("mm"), &[0.25, 0.5, f64::NAN]),
            ]
        );
    }
    assert_eq!(source.series[1].name, "log 2");
}

#[test]
fn labview_text_has_one_column_of_times_or_one_for_each_channel() {
    let one = "Channels\t2\r\n***End_of_Header***\r\nX_Value\tA\tB\tComment\r\n0,0\t1\t2\r\n0,1\t3\t4\r\n";
    let source = read(
        "log.lvm",
        format!("{}{one}", HEADER.replace("COLUMNS", "One")),
    );
    assert_eq!(times(&source.series[0]), Some(vec![0.0, 0.1]));
    assert_eq!(source.series[0].channels.len(), 2);
    // Without a header of the segment the names follow at once.
    let multi = "X_Value\tA\tX_Value\tB\tX_Value\tA\tComment\r\n0,0\t1\t0,5\t2\t0,0\t5\r\n0,1\t3\t0,6\t4\t0,1\t6\r\n";
    let source = read(
        "log.lvm",
        format!("{}{multi}", HEADER.replace("COLUMNS", "Multi")),
    );
    let [first, second] = &source.series[..] else {
        panic!("{:?}", source.series);
    };
    assert_eq!(times(second), Some(vec![0.5, 0.6]));
    let names: Vec<&str> = first.channels.iter().map(|one| one.name.as_str()).collect();
    assert_eq!(names, ["A", "A (2)"]);
    let wrong = format!("{}{one}0,2\tx\t1\r\n", HEADER.replace("COLUMNS", "One"));
    assert_eq!(
        refusal("a.lvm", wrong),
        "a.lvm, line 17, column \"A\": found \"x\", expected a number"
    );
    assert!(refusal("b.lvm", HEADER).contains("expected readings after the header"));
}

/// Settings of the recorder before the table, as many devices write them.
#[test]
fn lines_of_keys_and_numbers_are_no_table() {
    let text = "Gerät;DAQ 3\nAbtastrate;1000;Hz\nKanäle;3\nDauer;12,5;s\n\nZeit [s];Kraft1 [N];Kraft2 [N];Weg [mm]\n\
        0,000;10,5;20,25;1\n0,001;11,5;21,25;2\n0,002;12,5;22,25;3\n";
    let source = read("log.csv", text);
    assert_eq!(source.series[0].rows, 3);
    assert_eq!(
        content(&source.series[0])[1],
        channel("Kraft1", Some("N"), &[10.5, 11.5, 12.5])
    );
    assert_eq!(source.notices.len(), 1, "{:?}", source.notices);
    assert!(source.notices[0].contains("and 3 more lines before the table: not used"));
}

#[test]
fn the_description_of_a_recording_of_ros_2_names_the_recording() {
    let text = "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  duration:\n    nanoseconds: 10\n";
    assert!(refusal("metadata.yaml", text).contains("expected the recording beside it"));
}
