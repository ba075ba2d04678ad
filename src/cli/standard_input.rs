//! `-` as the name of an input file.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, stdin};
use std::path::Path;

use anyhow::Result;
use tautline_core::robot::Robot;
use tautline_files::ReadError;
use tautline_session::{
    CheckRow, Loaded, PlannedPose, Session, SymbolMapping, VersionedFile, parse_session,
    parse_symbols, parse_versioned, parse_versioned_toml, read_check, read_plan, read_symbols,
    read_table_file, read_versioned, read_versioned_toml,
};

use crate::BadInput;
use crate::output::is_standard;

/// Its name in messages.
const NAME: &str = "standard input";

/// Reads a JSON file with a version.
pub fn versioned<T: VersionedFile>(path: &Path) -> Result<Loaded<T>> {
    Ok(match is_standard(path) {
        true => parse_versioned(&bytes(T::MAX_BYTES)?, NAME)?,
        false => read_versioned(path)?,
    })
}

/// Reads a TOML file with a version.
pub fn versioned_toml<T: VersionedFile>(path: &Path) -> Result<Loaded<T>> {
    Ok(match is_standard(path) {
        true => parse_versioned_toml(&bytes(T::MAX_BYTES)?, NAME)?,
        false => read_versioned_toml(path)?,
    })
}

/// Reads a session from standard input.
pub fn session() -> Result<Loaded<Session>> {
    Ok(parse_session(&bytes(Session::MAX_BYTES)?, NAME)?)
}

/// Reads the symbols of a controller of this robot.
pub fn symbols(path: &Path, robot: &Robot) -> Result<Loaded<SymbolMapping>> {
    Ok(match is_standard(path) {
        true => parse_symbols(&bytes(SymbolMapping::MAX_BYTES)?, NAME, robot)?,
        false => read_symbols(path, robot)?,
    })
}

/// Reads a table of checked poses and paths.
pub fn check_rows(path: &Path) -> Result<Loaded<Vec<CheckRow>>, ReadError> {
    table(path, read_check)
}

/// Reads a table of poses to measure with this robot.
pub fn plan(path: &Path, robot: &Robot) -> Result<Loaded<Vec<PlannedPose>>, ReadError> {
    table(path, |reader, file| read_plan(reader, file, robot))
}

fn table<T>(
    path: &Path,
    read: impl FnOnce(Box<dyn BufRead>, &str) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    match is_standard(path) {
        true => read(Box::new(BufReader::new(stdin())), NAME),
        false => read_table_file(path, |file: BufReader<File>, name| {
            read(Box::new(file), name)
        }),
    }
}

/// Reads at most one byte more than `limit`, from which a parser sees that there are too many.
fn bytes(limit: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = stdin().lock().take(limit + 1).read_to_end(&mut bytes);
    read.map_err(|error| BadInput::new(format!("{NAME}: cannot be read ({error})")))?;
    Ok(bytes)
}
