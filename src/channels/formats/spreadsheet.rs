//! Spreadsheets: zip archives of XML, in the formats of Excel (`.xlsx`) and LibreOffice (`.ods`).
//!
//! The crate that reads more formats, `calamine`, is not used: it lays out every sheet as a full grid before anyone can ask
//! for the memory, so that an `.xls` of 6 kB or an `.ods` of 1 kB takes gigabytes, and it switches the whole program to another
//! compressor.

use tautline_files::{Location, ReadError};

use super::archive::Archive;
use super::workbook::Workbook;
use super::{excel, open_document, whole};
use crate::input::Input;
use crate::source::Source;

/// Reads a workbook of either format.
pub(super) fn read(mut input: Input<'_>, file: &str) -> Result<Source, ReadError> {
    let bytes = whole(&mut input, file)?;
    let archive = Archive::open(&bytes);
    let book = Workbook {
        file,
        archive: archive.map_err(|message| ReadError::new(file, Location::File, message))?,
        budget: input.budget(),
    };
    if book.has(excel::WORKBOOK) {
        return excel::read(&book);
    }
    if book.has(open_document::CONTENT) {
        return open_document::read(&book);
    }
    Err(book.fail(match book.has("xl/workbook.bin") {
        true => "is a binary Excel workbook (.xlsb), expected .xlsx: save it in that format",
        false => "is an archive without a workbook or arrays, expected .xlsx, .ods or .npz",
    }))
}
