//! Files as recorders write them, made by hand: every variant gives the same channels, or is refused in one sentence.

mod any_types;
mod binary;
mod c3d;
#[cfg(feature = "more-formats")]
mod hdf5;
mod laboratory;
#[cfg(feature = "more-formats")]
mod memory;
#[cfg(feature = "more-formats")]
mod ros;
mod scope;
mod spreadsheets;
mod tables;
mod tracking;

use std::path::PathBuf;

use super::*;
use crate::source::Series;

/// A folder with one file in it.
struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        Self {
            folder: tempfile::tempdir().expect("a folder"),
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn read(&self, name: &str, bytes: &[u8]) -> Result<Source, String> {
        self.read_within(&MemoryBudget::default(), name, bytes)
    }

    fn read_within(
        &self,
        budget: &MemoryBudget,
        name: &str,
        bytes: &[u8],
    ) -> Result<Source, String> {
        let path = self.path(name);
        std::fs::write(&path, bytes).expect("written");
        let folder = format!("{}/", self.folder.path().display());
        match read_watched(&path, &Watch::new(0, &|_| true, budget)) {
            Ok(mut source) => {
                source.file = source.file.replace(&folder, "");
                source
                    .notices
                    .iter_mut()
                    .for_each(|notice| *notice = notice.replace(&folder, ""));
                Ok(source)
            }
            Err(error) => Err(error.to_string().replace(&folder, "")),
        }
    }
}

/// A file that another program wrote.
fn seed(name: &str) -> Vec<u8> {
    let folder =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/suites/fuzz/seeds/foreign_file");
    std::fs::read(folder.join(name)).expect("a seed")
}

/// Reads a file that is well formed.
fn read(name: &str, bytes: impl AsRef<[u8]>) -> Source {
    Bench::new().read(name, bytes.as_ref()).expect(name)
}

/// The sentence by which a file is refused.
fn refusal(name: &str, bytes: impl AsRef<[u8]>) -> String {
    let sentence = Bench::new().read(name, bytes.as_ref()).expect_err(name);
    assert!(
        sentence.starts_with(name) && !sentence.contains('\n'),
        "{sentence}"
    );
    sentence
}

/// Name, unit and values of the channels of a series; NaN as `None`.
type Content = Vec<(String, Option<String>, Vec<Option<f64>>)>;

fn known(values: impl Iterator<Item = f64>) -> Vec<Option<f64>> {
    values
        .map(|value| Some(value).filter(|value| !value.is_nan()))
        .collect()
}

/// Times of the rows (s).
fn times(series: &Series) -> Option<Vec<f64>> {
    series.time_s.as_ref().map(|times| times.iter().collect())
}

fn content(series: &Series) -> Content {
    series
        .channels
        .iter()
        .map(|channel| {
            (
                channel.name.clone(),
                channel.unit.clone(),
                known(channel.values.iter()),
            )
        })
        .collect()
}

fn channel(
    name: &str,
    unit: Option<&str>,
    values: &[f64],
) -> (String, Option<String>, Vec<Option<f64>>) {
    (
        name.into(),
        unit.map(Into::into),
        known(values.iter().copied()),
    )
}

#[test]
fn what_is_not_read_says_what_to_do() {
    for (name, bytes, part) in [
        (
            "a.svdx",
            &b"<TcScope"[..],
            "TC3ScopeExportTool.exe \"svd=<file>\" target=<csv> silent",
        ),
        ("a.csv", b"", "is empty, expected readings"),
        (
            "a.mat",
            b"MATLAB 7.3 MAT-file, Platform",
            if HAS_MORE_FORMATS {
                "expected HDF5"
            } else {
                "--features more-formats`, or version 7: save(name, vars{:}, '-v7')"
            },
        ),
        (
            "a.h5",
            b"\x89HDF\r\n\x1a\n",
            if HAS_MORE_FORMATS {
                "expected HDF5"
            } else {
                "expected the program of a release or `cargo build --release --features more-formats`, or a table as CSV"
            },
        ),
        ("a.parquet", b"PAR1\x15\x04", "is damaged, expected Parquet"),
        ("b.parquet", b"PARE\x15\x04", "is an encrypted Parquet file"),
        (
            "a.mcap",
            b"\x89MCAP0\r\n",
            if HAS_MORE_FORMATS {
                "has no end: the recorder was stopped, or the file was cut off, expected a readable MCAP recording"
            } else {
                "ros2 topic echo --csv"
            },
        ),
        (
            "a.bag",
            b"#ROSBAG V2.0\n",
            if HAS_MORE_FORMATS {
                "has no end: the recorder was stopped, or the file was cut off, expected a readable ROS 1 bag"
            } else {
                "rostopic echo -b <bag> -p <topic>"
            },
        ),
        (
            "b.bag",
            b"#ROSRECORD V1.1\n",
            "expected version 2.0 (rosbag filter <old> <new> True)",
        ),
        ("a.db3", b"SQLite format 3\0", "database"),
        (
            "a.xls",
            b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
            "expected .xlsx",
        ),
        (
            "a.c3d",
            b"\x02\x50\0\0",
            "ends before its data, expected C3D",
        ),
        (
            "a.png",
            b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
            "binary file of unknown format",
        ),
        ("a.xml", b"<html></html>", "XML file of unknown format"),
        ("a.json", b"{\"a\": 1}", "JSON file"),
        (
            "a.txt",
            b"no number in here\nnor here\n",
            "found no row of numbers",
        ),
        ("a.xlsx", b"PK\x03\x04 and no archive", "damaged archive"),
    ] {
        let sentence = refusal(name, bytes);
        assert!(sentence.contains(part), "{sentence} lacks {part}");
    }
}
