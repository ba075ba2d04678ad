//! File format recognition, and one reader for each format.

mod archive;
mod c3d;
mod delimited;
mod excel;
mod fault;
#[cfg(feature = "more-formats")]
mod hdf5;
#[cfg(feature = "more-formats")]
mod hdf5_elements;
mod labview;
mod matlab;
mod mdf;
mod motive;
mod nexus;
mod numpy;
mod open_document;
mod parquet;
#[cfg(feature = "more-formats")]
mod ros;
mod scope;
mod spreadsheet;
mod tdms;
mod workbook;
mod workbook_xml;

use std::fs::File;
use std::io::{Read, Seek};
use std::path::Path;

use tautline_files::{Location, ReadError, open_input};

use crate::input::{Input, Watch};
use crate::memory::{MemoryBudget, OverBudget};
use crate::source::{Format, Series, Source};
use crate::text::decoded;

/// Number of leading bytes from which the format is recognised.
const HEAD: u64 = 64 << 10;
/// Largest file (bytes) in a format that has to be read as a whole.
const MAX_WHOLE: u64 = 2 << 30;

/// Whether the program was built with the feature `more-formats`.
pub const HAS_MORE_FORMATS: bool = cfg!(feature = "more-formats");

/// Advice for a format that this build leaves out.
const LEFT_OUT: &str = "which this build leaves out, expected the program of a release or \
                        `cargo build --release --features more-formats`";

/// Beginning of a MATLAB file that is an HDF5 file.
const MATLAB_73: &[u8] = b"MATLAB 7.3";

/// Recognised kind of a file.
enum FileKind {
    Readable(Format),
    /// A recognised but unsupported format: what was found and what to do.
    Refused(&'static str),
}

/// Reads a file in any supported format.
///
/// # Errors
/// If its format is unknown or its content is invalid; names the place.
pub fn read_source(path: &Path) -> Result<Source, ReadError> {
    let budget = MemoryBudget::default();
    read_watched(path, &Watch::new(0, &|_| true, &budget))
}

/// Reads a file in any supported format, reporting progress to `watch`, whose budget its content takes.
///
/// # Errors
/// As [`read_source`], if it was stopped, and if it needs more memory than there is.
pub fn read_watched(path: &Path, watch: &Watch<'_>) -> Result<Source, ReadError> {
    let source = read(path, watch)?;
    let mut series = source.series.iter();
    if series.all(|one| one.channels.is_empty() || one.rows == 0) {
        let message = "found a table without numbers, expected readings";
        return Err(ReadError::new(&source.file, Location::File, message));
    }
    let bytes = source.series.iter().map(Series::bytes);
    let taken = watch.budget().take(bytes.fold(0, u64::saturating_add));
    taken.map_err(|over| over_budget(&source.file, over))?;
    Ok(source)
}

/// The error that a file needs more memory than there is.
fn over_budget(file: &str, over: OverBudget) -> ReadError {
    ReadError::new(file, Location::File, over.to_string())
}

fn read(path: &Path, watch: &Watch<'_>) -> Result<Source, ReadError> {
    let file = path.display().to_string();
    let refuse = |message: &str| Err(ReadError::new(&file, Location::File, message));
    let (head, input) = open(path, &file)?;
    // Only the series of a file are kept.
    let budget = watch.budget().temporary();
    let mut input = Input::new(input, watch, &budget);
    let format = match recognise(&head, path) {
        FileKind::Readable(format) => format,
        FileKind::Refused(message) => return refuse(message),
    };
    match format {
        Format::Table | Format::PointList => delimited::read(&head, input, &file),
        Format::TwinCatScope => scope::read(&head, input, &file),
        Format::Motive => motive::read(&head, input, &file),
        Format::Nexus => nexus::read(&head, input, &file),
        Format::C3d => c3d::read(input, &file, &stem(&file)),
        #[cfg(feature = "more-formats")]
        Format::Hdf5 => hdf5::read(&mut input, format, &file),
        #[cfg(feature = "more-formats")]
        Format::Matlab if head.starts_with(MATLAB_73) => hdf5::read(&mut input, format, &file),
        #[cfg(not(feature = "more-formats"))]
        Format::Hdf5 => refuse(&format!("is an HDF5 file, {LEFT_OUT}, or a table as CSV")),
        #[cfg(not(feature = "more-formats"))]
        Format::Matlab if head.starts_with(MATLAB_73) => refuse(&format!(
            "is a MATLAB file of version 7.3, {LEFT_OUT}, or version 7: save(name, vars{{:}}, '-v7')"
        )),
        Format::Matlab => matlab::read(&mut input, &file),
        Format::NumPy => numpy::read(input, &head, &file),
        Format::Parquet => parquet::read(&mut input, &file),
        #[cfg(feature = "more-formats")]
        Format::Mcap => ros::mcap::read(&mut input, &file),
        #[cfg(feature = "more-formats")]
        Format::RosBag => ros::bag::read(&mut input, &file),
        #[cfg(not(feature = "more-formats"))]
        Format::Mcap => refuse(&format!(
            "is an MCAP recording of ROS 2, {LEFT_OUT}, or its topics as CSV (ros2 topic echo --csv)"
        )),
        #[cfg(not(feature = "more-formats"))]
        Format::RosBag => refuse(&format!(
            "is a bag of ROS 1, {LEFT_OUT}, or its topics as CSV (rostopic echo -b <bag> -p <topic>)"
        )),
        Format::Tdms => tdms::read(input, &file),
        Format::Mdf => mdf::read(input, &file),
        Format::LabView => labview::read(&head, input, &file),
        Format::Excel | Format::OpenDocument => spreadsheet::read(input, &file),
    }
}

/// The beginning of a text file; `None` for a format that is not text.
///
/// # Errors
/// If the file cannot be read.
pub fn text_head(path: &Path) -> Result<Option<String>, ReadError> {
    let (head, _) = open(path, &path.display().to_string())?;
    Ok(text_of(&head))
}

/// Opens a file and returns its first bytes and the rewound file.
fn open(path: &Path, file: &str) -> Result<(Vec<u8>, File), ReadError> {
    let mut input = open_input(path, file)?;
    let failed = |error| ReadError::io(file, Location::File, &error);
    let mut head = Vec::new();
    (&mut input)
        .take(HEAD)
        .read_to_end(&mut head)
        .map_err(failed)?;
    input.rewind().map_err(failed)?;
    Ok((head, input))
}

/// The content of a file.
fn whole(input: &mut Input<'_>, file: &str) -> Result<Vec<u8>, ReadError> {
    let io = |error| ReadError::io(file, Location::File, &error);
    let length = input.file().and_then(|file| file.metadata());
    let length = length.map_err(io)?.len();
    if length > MAX_WHOLE {
        let message = format!(
            "found more than {} GB, expected a smaller file",
            MAX_WHOLE >> 30
        );
        return Err(ReadError::new(file, Location::File, message));
    }
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
    input.take(length).read_to_end(&mut bytes).map_err(io)?;
    Ok(bytes)
}

fn recognise(head: &[u8], path: &Path) -> FileKind {
    use FileKind::{Readable, Refused};
    if path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("svdx"))
    {
        return Refused(
            "is a recording of TwinCAT Scope in its proprietary format, expected its export: \
             TC3ScopeExportTool.exe \"svd=<file>\" target=<csv> silent",
        );
    }
    if let Some(kind) = recognise_signature(head) {
        return kind;
    }
    let Some(text) = text_of(head) else {
        return Refused("is a binary file of unknown format, expected readings");
    };
    let text = text.trim_start();
    let first = text.lines().next().unwrap_or_default();
    let cell = first
        .split(['\t', ',', ';', ':', ' '])
        .next()
        .unwrap_or_default()
        .trim_matches('"');
    match cell {
        "" => Refused("is empty, expected readings"),
        _ if text.starts_with('<') => {
            Refused("is an XML file of unknown format, expected readings")
        }
        _ if text.starts_with('{') => Refused("is a JSON file, expected readings"),
        "rosbag2_bagfile_information" => Refused(
            "describes a recording of ROS 2, expected the recording beside it (.mcap; of a .db3: mcap convert <db3> <mcap>)",
        ),
        "Format" if first.starts_with("Format Version") => Readable(Format::Motive),
        "Name" if text.contains("SampleTime") || text.contains("SymbolName") => {
            Readable(Format::TwinCatScope)
        }
        _ if labview::is_title(first) => Readable(Format::LabView),
        _ if nexus::is_title(first) => Readable(Format::Nexus),
        _ => Readable(Format::Table),
    }
}

/// The format of a file that begins with a signature.
fn recognise_signature(head: &[u8]) -> Option<FileKind> {
    use FileKind::{Readable, Refused};
    let kind = match head {
        [] => Refused("is empty, expected readings"),
        [b'P', b'K', 3, 4, ..] => Readable(zip_content(head)),
        [0x93, b'N', b'U', b'M', b'P', b'Y', ..] => Readable(Format::NumPy),
        _ if head.starts_with(b"MATLAB 5.0") || head.starts_with(MATLAB_73) => {
            Readable(Format::Matlab)
        }
        [0x89, b'H', b'D', b'F', ..] => Readable(Format::Hdf5),
        [b'P', b'A', b'R', b'1', ..] => Readable(Format::Parquet),
        [b'P', b'A', b'R', b'E', ..] => {
            Refused("is an encrypted Parquet file, expected one that is not")
        }
        [0x89, b'M', b'C', b'A', b'P', ..] => Readable(Format::Mcap),
        _ if head.starts_with(tdms::BEGIN) => Readable(Format::Tdms),
        _ if mdf::BEGIN.iter().any(|begin| head.starts_with(begin)) => Readable(Format::Mdf),
        _ if head.starts_with(b"#ROSBAG V2.0\n") => Readable(Format::RosBag),
        _ if head.starts_with(b"#ROSBAG") || head.starts_with(b"#ROSRECORD") => Refused(
            "is a bag of ROS 1 of another version, expected version 2.0 (rosbag filter <old> <new> True)",
        ),
        _ if head.starts_with(b"SQLite format 3") => Refused(
            "is a database, which cannot be imported, expected CSV; a recording of ROS 2: mcap convert <db3> <mcap>",
        ),
        [0xd0, 0xcf, 0x11, 0xe0, ..] => Refused(
            "is an old Excel file (.xls) or one with a password, expected .xlsx without a password: save it in that format",
        ),
        [2..=8, 0x50, ..] => Readable(Format::C3d),
        _ => return None,
    };
    Some(kind)
}

/// The beginning of a text file; `None` for a format that is not text.
fn text_of(head: &[u8]) -> Option<String> {
    let text = decoded(head);
    let is_text = recognise_signature(head).is_none() && !text.contains('\0');
    is_text.then_some(text)
}

/// A workbook of either format, or arrays: the names of the entries are in the clear, and the first one's is at the beginning.
fn zip_content(head: &[u8]) -> Format {
    let is_array = head.windows(4).any(|name| name == b".npy");
    if is_array {
        Format::NumPy
    } else {
        Format::Excel
    }
}

/// The name of a file without folder and extension, for its series.
fn stem(file: &str) -> String {
    Path::new(file)
        .file_stem()
        .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}

/// The notice about an unusual encoding.
fn encoding_notice(file: &str, encoding: crate::text::Encoding) -> Option<String> {
    encoding
        .name()
        .map(|name| format!("{file}: read as {name}"))
}

#[cfg(test)]
mod tests;
