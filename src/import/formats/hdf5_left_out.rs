//! Errors for HDF5 files in builds without the HDF5 reader.

use tautline_session::{Place, ReadError};

use crate::input::Input;
use crate::source::{Format, Source};

pub(super) fn read(_: &mut Input<'_>, format: Format, file: &str) -> Result<Source, ReadError> {
    let message = match format {
        Format::Matlab => {
            "is a MATLAB file of version 7.3 (HDF5), expected version 7: save(name, vars{:}, '-v7')"
        }
        _ => "is an HDF5 file, which this build cannot read, expected a table, for example as CSV",
    };
    Err(ReadError::new(file, Place::File, message))
}
