//! Content of a file.

use std::collections::HashMap;
use std::ops::Range;

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

/// A file that was read.
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

/// Channels that were sampled together.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Series {
    /// Name, from that of the file or of a group in it.
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
    /// Memory of its values and of what is computed from them: a row takes as much as six values more.
    pub(crate) fn bytes(&self) -> u64 {
        let values = 6 + self.channels.len() + self.texts.len();
        self.rows.saturating_mul(size_of::<f64>() * values) as u64
    }

    /// Adds a column; the error states why texts are not kept.
    pub(crate) fn add(
        &mut self,
        name: String,
        unit: Option<String>,
        column: Filling,
    ) -> Result<(), String> {
        match column {
            Filling::Numbers(values) => {
                let values = values.into();
                self.channels.push(Channel { name, unit, values });
            }
            Filling::Texts(texts) => self.texts.push(texts.finish(&name)?),
        }
        Ok(())
    }

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

/// The variable of a struct or cell array that a path of MATLAB or HDF5 leads into, such as `run` of `run.force(:,2)`; empty for
/// an array of its own.
#[must_use]
pub fn owner_of(path: &str) -> &str {
    path.find(['.', '{', '(']).map_or("", |end| &path[..end])
}

/// Maximum number of distinct texts in a column: names of points and states have few.
const MAX_DISTINCT: usize = 100_000;

/// A column that is being filled.
pub(crate) enum Filling {
    Numbers(Vec<f64>),
    Texts(FillingTexts),
}

/// A column of text that is being filled.
#[derive(Default)]
pub(crate) struct FillingTexts {
    codes: Vec<u32>,
    distinct: Vec<String>,
    known: HashMap<String, u32>,
}

impl FillingTexts {
    /// Adds the text of a row.
    pub fn push(&mut self, cell: &str) {
        if let Some(code) = self.known.get(cell).copied() {
            self.codes.push(code);
        } else if self.distinct.len() <= MAX_DISTINCT {
            let code = self.distinct.len() as u32;
            self.distinct.push(cell.into());
            self.known.insert(cell.into(), code);
            self.codes.push(code);
        }
    }

    /// The column; the error states why it is not kept.
    pub fn finish(self, name: &str) -> Result<TextChannel, String> {
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
