//! Columns in a NumPy archive (`.npz`): one array of one dimension for each, not compressed, with the check sums of zip.

use std::io::{Read, Write};

use rawzip::{CompressionMethod, ZipArchive, ZipArchiveWriter};

/// An array of one dimension.
#[derive(Debug, Clone, PartialEq)]
pub enum Column {
    /// 64 bits without sign.
    U64(Vec<u64>),
    /// 32 bits without sign.
    U32(Vec<u32>),
    /// 8 bits without sign.
    U8(Vec<u8>),
    /// Single precision.
    F32(Vec<f32>),
}

impl Column {
    fn kind(&self) -> &'static str {
        match self {
            Self::U64(_) => "<u8",
            Self::U32(_) => "<u4",
            Self::U8(_) => "|u1",
            Self::F32(_) => "<f4",
        }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::U64(values) => values.len(),
            Self::U32(values) => values.len(),
            Self::U8(values) => values.len(),
            Self::F32(values) => values.len(),
        }
    }

    /// Version 1.0 of the format, `numpy.lib.format`: magic, length of the header, header padded to 64 bytes, data.
    fn bytes(&self) -> Vec<u8> {
        let mut header = format!(
            "{{'descr': '{}', 'fortran_order': False, 'shape': ({},), }}",
            self.kind(),
            self.len()
        );
        while !(HEAD + header.len() + 1).is_multiple_of(64) {
            header.push(' ');
        }
        header.push('\n');
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        match self {
            Self::U64(values) => values
                .iter()
                .for_each(|value| bytes.extend(value.to_le_bytes())),
            Self::U32(values) => values
                .iter()
                .for_each(|value| bytes.extend(value.to_le_bytes())),
            Self::U8(values) => bytes.extend(values),
            Self::F32(values) => values
                .iter()
                .for_each(|value| bytes.extend(value.to_le_bytes())),
        }
        bytes
    }

    /// The array of a file that this module wrote; an error is what is wrong.
    fn parse(bytes: &[u8]) -> Result<Self, String> {
        let broken = || "an array is not as this program writes it".to_owned();
        let length = bytes
            .get(8..HEAD)
            .filter(|_| bytes.starts_with(b"\x93NUMPY\x01\x00"))
            .ok_or_else(broken)?;
        let begin = HEAD + usize::from(u16::from_le_bytes([length[0], length[1]]));
        let header = bytes
            .get(HEAD..begin)
            .and_then(|text| std::str::from_utf8(text).ok())
            .ok_or_else(broken)?;
        let data = &bytes[begin..];
        let column = match header.split('\'').nth(3) {
            Some("<u8") => Self::U64(
                data.as_chunks()
                    .0
                    .iter()
                    .map(|part| u64::from_le_bytes(*part))
                    .collect(),
            ),
            Some("<u4") => Self::U32(
                data.as_chunks()
                    .0
                    .iter()
                    .map(|part| u32::from_le_bytes(*part))
                    .collect(),
            ),
            Some("|u1") => Self::U8(data.to_vec()),
            Some("<f4") => Self::F32(
                data.as_chunks()
                    .0
                    .iter()
                    .map(|part| f32::from_le_bytes(*part))
                    .collect(),
            ),
            _ => return Err(broken()),
        };
        if column.bytes().len() != bytes.len() || !header.contains(&format!("({},)", column.len()))
        {
            return Err(broken());
        }
        Ok(column)
    }
}

/// Bytes before the header.
const HEAD: usize = 10;

/// Writes a text and columns.
///
/// # Errors
/// What the archive refused.
pub fn write(text: (&str, &str), columns: &[(&str, Column)]) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut archive = ZipArchiveWriter::new(&mut bytes);
    let mut put = |name: &str, content: &[u8]| -> Result<(), String> {
        let file = archive
            .new_file(name)
            .compression_method(CompressionMethod::STORE);
        let (mut entry, config) = file.start().map_err(|error| error.to_string())?;
        let mut writer = config.wrap(&mut entry);
        writer
            .write_all(content)
            .map_err(|error| error.to_string())?;
        let (_, descriptor) = writer.finish().map_err(|error| error.to_string())?;
        entry
            .finish(descriptor)
            .map_err(|error| error.to_string())?;
        Ok(())
    };
    put(text.0, text.1.as_bytes())?;
    for (name, column) in columns {
        put(&format!("{name}.npy"), &column.bytes())?;
    }
    archive.finish().map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Reads a text and columns, in the order of the file.
///
/// # Errors
/// What is damaged.
pub fn read(bytes: &[u8], text: &str) -> Result<(String, Vec<(String, Column)>), String> {
    let damaged = |error: &dyn std::fmt::Display| format!("the file is damaged ({error})");
    let archive = ZipArchive::from_slice(bytes).map_err(|error| damaged(&error))?;
    let (mut found, mut columns) = (None, Vec::new());
    let mut entries = archive.entries();
    while let Some(entry) = entries.next_entry().map_err(|error| damaged(&error))? {
        let name = String::from_utf8_lossy(entry.file_path().as_ref()).into_owned();
        let local = archive
            .get_entry(entry.wayfinder())
            .map_err(|error| damaged(&error))?;
        let mut content = Vec::new();
        let mut reader = local.verifying_reader(local.data());
        reader
            .read_to_end(&mut content)
            .map_err(|error| damaged(&error))?;
        if name == text {
            found = String::from_utf8(content).ok();
        } else if let Some(name) = name.strip_suffix(".npy") {
            columns.push((name.to_owned(), Column::parse(&content)?));
        }
    }
    let text = found
        .ok_or_else(|| format!("the file has no entry {text}, expected a chunk of a study"))?;
    Ok((text, columns))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Vec<u8> {
        let columns = [
            ("a", Column::U64(vec![1, u64::MAX])),
            ("b", Column::F32(vec![0.5, f32::NAN])),
            ("c", Column::U8(vec![7])),
            ("d", Column::U32(Vec::new())),
        ];
        write(("about.json", "{}"), &columns).expect("written")
    }

    #[test]
    fn columns_come_back() {
        let (text, columns) = read(&sample(), "about.json").expect("read");
        assert_eq!((text.as_str(), columns.len()), ("{}", 4));
        assert_eq!(columns[0].1, Column::U64(vec![1, u64::MAX]));
        assert!(matches!(&columns[1].1, Column::F32(values) if values[1].is_nan()));
        assert_eq!(columns[3], ("d".to_owned(), Column::U32(Vec::new())));
    }

    #[test]
    fn every_bit_that_falls_over_in_the_data_is_noticed() {
        let bytes = sample();
        let (_, good) = read(&bytes, "about.json").expect("read");
        for place in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 0x10;
            // What is not noticed is nothing that matters, such as a date; names of columns are compared by who reads them.
            let Ok((text, columns)) = read(&damaged, "about.json") else {
                continue;
            };
            let values = |columns: &[(String, Column)]| {
                let values: Vec<&Column> = columns.iter().map(|(_, column)| column).collect();
                format!("{values:?}")
            };
            let has_names = |columns: &[(String, Column)]| {
                let names = columns.iter().zip(&good).all(|(a, b)| a.0 == b.0);
                names && columns.len() == good.len()
            };
            assert_eq!(text, "{}", "byte {place}");
            if has_names(&columns) {
                assert_eq!(values(&columns), values(&good), "byte {place}");
            }
        }
        for end in 0..bytes.len() {
            assert!(read(&bytes[..end], "about.json").is_err(), "cut at {end}");
        }
    }
}
