use super::*;

/// The texts of a column.
fn texts(series: &Series, name: &str) -> Vec<String> {
    let column = series.text(name).expect(name);
    (0..series.rows)
        .map(|row| column.at(row).to_owned())
        .collect()
}

/// A file that h5py has written.
fn hdf5(name: &str) -> Source {
    let source = read(name, seed(name));
    assert_eq!(source.format, Format::Hdf5);
    source
}

#[test]
fn hdf5_arrays_in_groups_with_units() {
    let source = hdf5("h5py.h5");
    assert_eq!(source.series.len(), 1);
    let rev = Some("rev");
    assert_eq!(
        content(&source.series[0]),
        [
            channel("t", Some("s"), &[0.0, 0.5, 1.0, 1.5, 2.0, 2.5]),
            channel("run.armed", None, &[1.0, 0.0, 1.0, 0.0, 1.0, 0.0]),
            channel("run.count", None, &[-2.0, -1.0, 0.0, 1.0, 2.0, 3.0]),
            channel(
                "run.force",
                Some("N"),
                &[100.0, 101.0, f64::NAN, 103.0, 104.0, f64::NAN]
            ),
            channel("run.pos[0]", rev, &[0.0, 0.5, 1.0, 1.5, 2.0, 2.5]),
            channel("run.pos[1]", rev, &[0.25, 0.75, 1.25, 1.75, 2.25, 2.75]),
        ]
    );
    assert_eq!(
        source.notices,
        [
            "h5py.h5, array \"gain\": a single value, left out",
            "h5py.h5, array \"image\": more than two dimensions, left out",
        ]
    );
}

#[test]
fn hdf5_in_an_unknown_layout_is_not_called_damaged() {
    let mut bytes = seed("h5py.h5");
    // The message with the layout of an array: type 8, a size, no flags, version 3, contiguous or chunked.
    let layout = |at: &[u8]| at[..2] == [8, 0] && at[4..8] == [0; 4] && at[8] == 3 && at[9] < 3;
    let place = bytes.windows(10).position(layout).expect("a layout");
    bytes[place + 8] = 5;
    let told = refusal("h5py.h5", bytes);
    assert!(
        told.contains("layout version 5, which is unknown here"),
        "{told}"
    );
    assert!(!told.contains("damaged"), "{told}");
}

#[test]
fn hdf5_of_newer_structure() {
    let source = hdf5("newer.h5");
    let content = content(&source.series[0]);
    assert_eq!(
        content[..5],
        [
            channel("checked", None, &[0.0, 1.0, 2.0]),
            channel("grown[0]", None, &[1.0, 2.0, 3.0]),
            channel("grown[1]", None, &[-1.0, -2.0, -3.0]),
            channel("a.b.x0", None, &[0.0, 0.5, 1.0]),
            channel("a.b.x1", None, &[1.0, 1.5, 2.0]),
        ]
    );
    assert_eq!(content.len(), 12);
}

#[test]
fn hdf5_records_and_texts() {
    let source = hdf5("records.h5");
    assert_eq!(
        content(&source.series[0]),
        [
            channel("flat", None, &[0.0, 1.0, 2.0]),
            channel("log.t_s", Some("s"), &[0.0, 0.1, 0.2]),
            channel("log.q[0]", None, &[1.0, 3.0, 5.0]),
            channel("log.q[1]", None, &[2.0, 4.0, f64::NAN]),
            channel("log.in.a", None, &[7.0, 8.0, 9.0]),
            channel("log.in.b", None, &[-1.0, -2.0, -3.0]),
            channel("log.z.r", None, &[0.0, 2.0, 3.0]),
            channel("log.z.i", None, &[1.0, 0.0, -1.0]),
        ]
    );
    assert_eq!(texts(&source.series[0], "log.name"), ["P1", "P2", "P1"]);
    assert_eq!(
        texts(&source.series[0], "state"),
        ["still", "moving", "\u{dc}"]
    );
    assert_eq!(
        content(&source.series[1]),
        [
            channel("points[0]", Some("mm"), &[0.0, 2.0]),
            channel("points[1]", Some("deg"), &[1.0, 3.0]),
        ]
    );
    assert_eq!(
        source.notices,
        [
            "records.h5, array \"log.o\": neither numbers nor text, left out",
            "records.h5, array \"words\": 4 texts without numbers beside them, left out",
        ]
    );
}

#[test]
fn hdf5_of_pandas_has_the_names_of_its_columns() {
    let source = hdf5("pandas.h5");
    assert_eq!(
        content(&source.series[0]),
        [
            channel("df.axis1", None, &[0.0, 1.0, 2.0, 3.0]),
            channel("t", None, &[0.0, 0.5, 1.0, 1.5]),
            channel("f", None, &[1.0, 2.0, f64::NAN, 4.0]),
            channel("n", None, &[1.0, 2.0, 3.0, 4.0]),
        ]
    );
}

#[test]
fn matlab_73_is_transposed_and_has_structs() {
    let source = read("log73.mat", seed("log73.mat"));
    assert_eq!((source.format, source.series.len()), (Format::Matlab, 2));
    assert_eq!(
        content(&source.series[0]),
        [
            channel("on", None, &[1.0, 0.0, 1.0, 1.0]),
            channel("pos(:,1)", None, &[0.0, 2.0, 4.0, 6.0]),
            channel("pos(:,2)", None, &[1.0, 3.0, 5.0, 7.0]),
            channel("t", None, &[0.0, 0.5, 1.0, 1.5]),
        ]
    );
    assert_eq!(
        content(&source.series[1]),
        [channel("log.force", None, &[5.0, f64::NAN, 7.0])]
    );
    let left_out = [
        ("note", "text"),
        ("nothing", "empty"),
        ("runs", "cells (save with -v7)"),
    ];
    let left_out =
        left_out.map(|(name, why)| format!("log73.mat, variable \"{name}\": {why}, left out"));
    assert_eq!(source.notices, left_out);
}

#[test]
fn hdf5_that_is_not_read() {
    let blosc = refusal("blosc.h5", seed("blosc.h5"));
    assert!(
        blosc
            .ends_with("array \"t\" uses the filter \"blosc\" (32001), expected gzip, LZF or none"),
        "{blosc}"
    );
    let whole = seed("h5py.h5");
    assert!(refusal("cut.h5", &whole[..whole.len() / 2]).contains("expected HDF5"));
}

#[test]
fn reading_of_hdf5_can_be_ended() {
    let bench = Bench::new();
    let path = bench.path("h5py.h5");
    std::fs::write(&path, seed("h5py.h5")).expect("written");
    let budget = MemoryBudget::default();
    let watch = Watch::new(1, &|_| false, &budget);
    assert!(read_watched(&path, &watch).is_err() && watch.is_stopped());
}
