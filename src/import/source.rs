//! Content of a foreign file before any conversion.

use std::collections::HashMap;
use std::ops::Range;

use crate::memory::{Lease, MemoryBudget, OverBudget, of_rows};
use crate::values::Values;

/// Recognised file formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Delimited text: CSV and similar.
    Table,
    /// Points with their names, without a header row.
    PointList,
    /// CSV export of TwinCAT 3 Scope.
    TwinCatScope,
    /// CSV export of OptiTrack Motive.
    Motive,
    /// Text export of Vicon Nexus.
    Nexus,
    /// Motion capture in C3D.
    C3d,
    /// HDF5 of programs other than MATLAB.
    Hdf5,
    /// MATLAB 5 to 7.3.
    Matlab,
    /// NumPy `.npy` or `.npz`.
    NumPy,
    /// Apache Parquet.
    Parquet,
    /// Recording of ROS 2 in MCAP.
    Mcap,
    /// Bag of ROS 1.
    RosBag,
    /// TDMS of LabVIEW and DIAdem.
    Tdms,
    /// ASAM MDF 4.
    Mdf,
    /// Text file of LabVIEW (`.lvm`).
    LabView,
    /// Excel workbook.
    Excel,
    /// Spreadsheet of LibreOffice and others.
    OpenDocument,
}

impl Format {
    /// Name for use in sentences.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Table => "table",
            Self::PointList => "point list",
            Self::TwinCatScope => "TwinCAT Scope CSV",
            Self::Motive => "OptiTrack Motive CSV",
            Self::Nexus => "Vicon Nexus text",
            Self::C3d => "C3D file",
            Self::Hdf5 => "HDF5 file",
            Self::Matlab => "MATLAB file",
            Self::NumPy => "NumPy file",
            Self::Parquet => "Parquet file",
            Self::Mcap => "MCAP recording",
            Self::RosBag => "ROS 1 bag",
            Self::Tdms => "TDMS file",
            Self::Mdf => "MDF 4 file",
            Self::LabView => "LabVIEW text",
            Self::Excel => "Excel workbook",
            Self::OpenDocument => "OpenDocument spreadsheet",
        }
    }
}

/// A foreign file.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Path of the file as given.
    pub file: String,
    /// Kind.
    pub format: Format,
    /// Series, each with the channels that were sampled together.
    pub series: Vec<Series>,
    /// Notices: what was not understood or left out.
    pub notices: Vec<String>,
}

impl Source {
    /// Memory that it takes until its poses are cut (bytes).
    pub(crate) fn memory(&self) -> u64 {
        let of_text = |text: &TextChannel| {
            let texts = text.distinct.iter().map(String::capacity).sum::<usize>();
            texts + size_of_val(&text.codes[..]) + size_of_val(&text.distinct[..])
        };
        let of_series = |series: &Series| {
            let numbers = series
                .channels
                .iter()
                .map(|channel| channel.values.memory());
            let texts = series.texts.iter().map(of_text);
            of_rows(series.rows) + numbers.chain(texts).sum::<usize>() as u64
        };
        self.series.iter().map(of_series).sum()
    }
}

/// Channels that were sampled together.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Series {
    /// Name, unique among all sources that are imported together.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Time of each row (s), if the format defines it.
    pub time_s: Option<Values>,
    /// Columns of numbers.
    pub channels: Vec<Channel>,
    /// Columns of text.
    pub texts: Vec<TextChannel>,
}

/// A recorded quantity.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Channel {
    /// Name in the file.
    pub name: String,
    /// Unit as stated in the file.
    pub unit: Option<String>,
    /// Values; NaN for missing ones.
    pub values: Values,
}

/// A column of text: names of points, states.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TextChannel {
    /// Name in the file.
    pub name: String,
    /// The distinct texts.
    pub distinct: Vec<String>,
    /// Index into `distinct` for each row.
    pub codes: Vec<u32>,
}

impl Series {
    /// The channel of this name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// The column of text of this name.
    #[must_use]
    pub fn text(&self, name: &str) -> Option<&TextChannel> {
        self.texts.iter().find(|text| text.name == name)
    }
}

impl TextChannel {
    /// The text of a row.
    #[must_use]
    pub fn at(&self, row: usize) -> &str {
        let code = self.codes.get(row).copied().unwrap_or_default();
        self.distinct.get(code as usize).map_or("", String::as_str)
    }
}

/// Maximum number of distinct texts in a column: names of points and states have few.
const MAX_DISTINCT: usize = 100_000;

/// A column of text that is being filled.
#[derive(Default)]
pub(crate) struct FillingTexts {
    codes: Vec<u32>,
    distinct: Vec<String>,
    known: HashMap<String, u32>,
    /// `None` for files whose texts are not larger than they are themselves.
    lease: Option<Lease>,
    over: Option<OverBudget>,
}

impl FillingTexts {
    /// A column whose memory is taken of a budget.
    pub fn within(budget: &MemoryBudget) -> Self {
        let lease = budget.lease(0);
        Self {
            over: lease.as_ref().err().copied(),
            lease: lease.ok(),
            ..Self::default()
        }
    }

    /// Takes memory for a row, and for its text if that is new; without memory the column is given up.
    fn takes(&mut self, text: Option<&str>) -> bool {
        const DISTINCT: usize = 2 * size_of::<String>() + 16;
        let Some(lease) = &mut self.lease else {
            return self.over.is_none();
        };
        let new = text.map_or(0, |text| 2 * text.len() + DISTINCT);
        let taken = lease.take((size_of::<u32>() + new) as u64);
        if let Err(over) = taken {
            *self = Self {
                over: Some(over),
                ..Self::default()
            };
        }
        taken.is_ok()
    }

    /// Adds the text of a row.
    pub fn push(&mut self, cell: &str) {
        if let Some(code) = self.known.get(cell).copied() {
            if self.takes(None) {
                self.codes.push(code);
            }
        } else if self.distinct.len() <= MAX_DISTINCT && self.takes(Some(cell)) {
            let code = self.distinct.len() as u32;
            self.distinct.push(cell.into());
            self.known.insert(cell.into(), code);
            self.codes.push(code);
        }
    }

    /// The column; the error states why it is not kept.
    pub fn finish(self, name: &str) -> Result<TextChannel, String> {
        if let Some(over) = self.over {
            return Err(format!("{over}, not kept"));
        }
        if self.distinct.len() > MAX_DISTINCT {
            return Err(format!(
                "text with more than {MAX_DISTINCT} distinct values, not kept"
            ));
        }
        if self.distinct.iter().all(String::is_empty) {
            return Err("empty, left out".to_owned());
        }
        Ok(TextChannel {
            name: name.to_owned(),
            distinct: self.distinct,
            codes: self.codes,
        })
    }
}

/// Statistics of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// Number of values.
    pub values: usize,
    /// Number of rows without a value.
    pub gaps: usize,
    /// Smallest and largest value; NaN without any.
    pub range: [f64; 2],
}

impl Channel {
    /// Statistics of its values.
    #[must_use]
    pub fn summary(&self) -> Summary {
        let mut summary = Summary {
            values: 0,
            gaps: 0,
            range: [f64::NAN; 2],
        };
        for value in self.values.iter() {
            if value.is_nan() {
                summary.gaps += 1;
                continue;
            }
            summary.values += 1;
            summary.range = [summary.range[0].min(value), summary.range[1].max(value)];
        }
        summary
    }

    /// Runs of missing values between valid ones.
    #[must_use]
    pub fn lost(&self) -> Vec<Range<usize>> {
        let mut runs = Vec::new();
        let mut last = None;
        for (row, value) in self.values.iter().enumerate() {
            if value.is_nan() {
                continue;
            }
            if let Some(last) = last
                && row > last + 1
            {
                runs.push(last + 1..row);
            }
            last = Some(row);
        }
        runs
    }
}
