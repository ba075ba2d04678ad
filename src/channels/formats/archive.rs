//! Zip archives, of which `.npz`, `.xlsx` and `.ods` are made.

use std::collections::HashMap;
use std::io::ErrorKind;

use flate2::read::DeflateDecoder;
use rawzip::{CompressionMethod, ZipArchive, ZipArchiveEntryWayfinder, ZipSliceArchive};

use crate::memory::MemoryBudget;

/// A zip archive in memory.
pub(super) struct Archive<'a> {
    archive: ZipSliceArchive<&'a [u8]>,
    names: Vec<String>,
    /// Compression and place of the first entry of each name.
    places: HashMap<String, (CompressionMethod, ZipArchiveEntryWayfinder)>,
}

impl<'a> Archive<'a> {
    /// Reads the directory of the archive; the error is a description of the damage.
    pub fn open(bytes: &'a [u8]) -> Result<Self, String> {
        let damaged = |error: rawzip::Error| format!("is a damaged archive ({error})");
        let archive = ZipArchive::from_slice(bytes).map_err(damaged)?;
        let (mut names, mut places) = (Vec::new(), HashMap::new());
        let mut entries = archive.entries();
        while let Some(entry) = entries.next_entry().map_err(damaged)? {
            let name = String::from_utf8_lossy(entry.file_path().as_ref()).into_owned();
            names.push(name.clone());
            let place = (entry.compression_method(), entry.wayfinder());
            places.entry(name).or_insert(place);
        }
        Ok(Self {
            archive,
            names,
            places,
        })
    }

    /// Names of its entries in their order.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Content of an entry, whose memory is taken from `budget`; `None` if there is no such entry.
    pub fn read(&self, name: &str, budget: &MemoryBudget) -> Result<Option<Vec<u8>>, String> {
        let damaged = |error: &dyn std::fmt::Display| {
            format!("entry {name} of the archive is damaged ({error})")
        };
        let Some((method, place)) = self.places.get(name) else {
            return Ok(None);
        };
        let local = self.archive.get_entry(*place);
        let local = local.map_err(|error| damaged(&error))?;
        let read = match *method {
            CompressionMethod::STORE => budget.read_to_end(local.verifying_reader(local.data())),
            CompressionMethod::DEFLATE => {
                let plain = DeflateDecoder::new(local.data());
                budget.read_to_end(local.verifying_reader(plain))
            }
            _ => {
                return Err(format!(
                    "entry {name} of the archive is compressed by a method other than deflate"
                ));
            }
        };
        match read {
            Ok(content) => Ok(Some(content)),
            Err(error) if error.kind() == ErrorKind::OutOfMemory => {
                Err(format!("entry {name} of the archive {error}"))
            }
            Err(error) => Err(damaged(&error)),
        }
    }
}
