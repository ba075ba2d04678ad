//! What `tautline import` did, for other programs.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_session::VersionedFile;

use crate::check::Suggestion;
use crate::recipe::Recipe;
use crate::source::{Series, Source};

/// An import, or what was found in the sources.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ImportDocument {
    /// The files and their channels.
    pub sources: Vec<SourceReport>,
    /// The recipe that was used, or is proposed.
    pub recipe: Recipe,
    /// Whether the recipe was proposed from names, units and ranges.
    pub proposed: bool,
    /// The poses; empty if channels were only listed.
    pub poses: Vec<PoseReport>,
    /// Mistakes that the readings seem to have.
    pub suggestions: Vec<Suggestion>,
    /// Suggestions that the recipe has taken up.
    pub applied: Vec<Suggestion>,
    /// What was not understood or left out, assumptions, gaps and jumps of clocks.
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
    /// The file as it was named.
    pub file: String,
    /// Its format.
    pub format: String,
    /// Its series.
    pub series: Vec<SeriesReport>,
}

/// Channels that were sampled together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SeriesReport {
    /// Its name, by which recipes know it.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Its channels; those of text have no range.
    pub channels: Vec<ChannelReport>,
}

/// A channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChannelReport {
    /// Its name, by which recipes know it.
    pub name: String,
    /// Its unit as the file states it.
    pub unit: Option<String>,
    /// Number of rows with a value.
    pub values: usize,
    /// Number of rows without one.
    pub gaps: usize,
    /// Runs of rows without a value between rows with one: lost frames.
    pub lost: usize,
    /// Smallest and largest value, in the unit of the file.
    pub range: Option<[f64; 2]>,
    /// Column of poses.csv that the recipe makes of it.
    pub used_as: Option<String>,
}

/// A pose and what was read there.
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
    /// Standard deviation of one value; null for a single one.
    pub sd: Option<f64>,
    /// Number of values.
    pub number: usize,
}

impl SourceReport {
    /// The report of a source; `used_as` says which column is made of a channel of a series.
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
