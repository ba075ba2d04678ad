//! Recordings of ROS that the Python packages of MCAP and `rosbags` have written.

mod bag;
mod mcap;

use super::*;

/// 31 May 2024, 10:00 UTC.
const BEGIN_S: f64 = 1_717_149_600.0;
/// The recorder writes a message a millisecond after its stamp.
const DELAY_S: f64 = 1e-3;

fn series<'a>(source: &'a Source, name: &str) -> &'a Series {
    let mut all = source.series.iter();
    all.find(|series| series.name == name).expect(name)
}

/// Asserts the times (s) of the rows of a series after the begin, to a microsecond.
fn assert_times(series: &Series, expected: &[f64]) {
    let found = times(series).expect("times");
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - BEGIN_S - expected).abs() < 1e-6, "{found}");
    }
}

fn names(series: &Series) -> Vec<&str> {
    let channels = series.channels.iter();
    channels.map(|channel| channel.name.as_str()).collect()
}
