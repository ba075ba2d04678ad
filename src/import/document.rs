//! The result of `tautline import` as JSON.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_channels::{Series, Source};
use tautline_session::VersionedFile;

use crate::check::Suggestion;
use crate::recipe::Recipe;

/// Result of an import, or of listing the sources.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ImportDocument {
    /// The files and their channels.
    pub sources: Vec<SourceReport>,
    /// The recipe that was used or is proposed.
    pub recipe: Recipe,
    /// Whether the recipe was proposed from names, units and ranges.
    pub proposed: bool,
    /// The poses; empty if the channels were only listed.
    pub poses: Vec<PoseReport>,
    /// Suspected mistakes in the readings.
    pub suggestions: Vec<Suggestion>,
    /// Suggestions applied to the recipe.
    pub applied: Vec<Suggestion>,
    /// Notices: what was not understood or left out, assumptions, gaps and clock jumps.
    pub notices: Vec<String>,
}

impl VersionedFile for ImportDocument {
    const FORMAT: &'static str = "tautline-import";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 1 << 30;
}

/// A file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SourceReport {
    /// Path of the file as given.
    pub file: String,
    /// Its format.
    pub format: String,
    /// Its series.
    pub series: Vec<SeriesReport>,
}

/// Channels that were sampled together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SeriesReport {
    /// Name, to which recipes refer.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Channels; text channels have no range.
    pub channels: Vec<ChannelReport>,
}

/// A channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChannelReport {
    /// Name, to which recipes refer.
    pub name: String,
    /// Unit as stated in the file.
    pub unit: Option<String>,
    /// Number of rows with a value.
    pub values: usize,
    /// Number of rows without a value.
    pub gaps: usize,
    /// Runs of rows without a value between rows with one: lost frames.
    pub lost: usize,
    /// Smallest and largest value, in the unit of the file.
    pub range: Option<[f64; 2]>,
    /// Column of `poses.csv` to which the recipe assigns it.
    pub used_as: Option<String>,
}

/// A pose with its mean readings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PoseReport {
    /// Its label.
    pub pose: i64,
    /// Begin (s).
    pub begin_s: Option<f64>,
    /// End (s).
    pub end_s: Option<f64>,
    /// First row, from 0.
    pub first_row: usize,
    /// Number of rows.
    pub rows: usize,
    /// Means by column of poses.csv.
    pub readings: BTreeMap<String, Reading>,
}

/// A mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reading {
    /// Mean.
    pub mean: f64,
    /// Standard deviation of a single value; null if there is only one.
    pub sd: Option<f64>,
    /// Number of values.
    pub number: usize,
}

impl SourceReport {
    /// The report of a source; `used_as` maps series and channel to a column of `poses.csv`.
    #[must_use]
    pub fn of(source: &Source, used_as: &dyn Fn(&str, &str) -> Option<String>) -> Self {
        Self {
            file: source.file.clone(),
            format: source.format.name().into(),
            series: source
                .series
                .iter()
                .map(|series| series_report(series, used_as))
                .collect(),
        }
    }
}

fn series_report(series: &Series, used_as: &dyn Fn(&str, &str) -> Option<String>) -> SeriesReport {
    let numbers = series.channels.iter().map(|channel| {
        let summary = channel.summary();
        ChannelReport {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            values: summary.values,
            gaps: summary.gaps,
            lost: channel.lost().len(),
            range: (summary.values > 0).then_some(summary.range),
            used_as: used_as(&series.name, &channel.name),
        }
    });
    let texts = series.texts.iter().map(|text| {
        let empty = (0..series.rows)
            .filter(|row| text.at(*row).is_empty())
            .count();
        ChannelReport {
            name: text.name.clone(),
            unit: None,
            values: series.rows - empty,
            gaps: empty,
            lost: 0,
            range: None,
            used_as: used_as(&series.name, &text.name),
        }
    });
    SeriesReport {
        name: series.name.clone(),
        rows: series.rows,
        channels: numbers.chain(texts).collect(),
    }
}
