//! Fingerprints that are the same in every version of the program.

use std::fs::File;
use std::io::{BufRead, BufReader, Result as IoResult};
use std::path::Path;

use serde_json::Value;
use sha2::{Digest, Sha256};

/// FNV-1a hash of 64 bits (Fowler, Noll and Vo), which detects accidental changes, not forgeries.
#[derive(Debug, Clone, Copy)]
pub struct Fingerprint(u64);

impl Default for Fingerprint {
    fn default() -> Self {
        Self::new()
    }
}

impl Fingerprint {
    /// The fingerprint of empty input.
    #[must_use]
    pub fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// The fingerprint of bytes.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        Self::new().and(bytes)
    }

    /// The fingerprint of the content of a file.
    pub(crate) fn of_file(path: &Path) -> IoResult<Self> {
        let mut reader = BufReader::with_capacity(1 << 16, File::open(path)?);
        let mut hash = Self::new();
        loop {
            let bytes = reader.fill_buf()?;
            if bytes.is_empty() {
                return Ok(hash);
            }
            hash = hash.and(bytes);
            let read = bytes.len();
            reader.consume(read);
        }
    }

    /// Adds bytes.
    #[must_use]
    pub fn and(self, bytes: &[u8]) -> Self {
        let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
        Self(bytes.iter().fold(self.0, step))
    }

    /// Adds a JSON value; see [`feed`].
    #[must_use]
    pub(crate) fn and_value(self, value: &Value) -> Self {
        let mut hash = self;
        feed(value, &mut |bytes| hash = hash.and(bytes));
        hash
    }

    /// As 16 hexadecimal digits.
    #[must_use]
    pub fn to_hex(self) -> String {
        format!("{:016x}", self.0)
    }
}

/// Gives a JSON value to a hash, byte by byte. The order of keys and the notation of numbers do not
/// matter, and a key with the value null counts as absent.
fn feed(value: &Value, hash: &mut impl FnMut(&[u8])) {
    let length = |count: usize| (count as u64).to_le_bytes();
    match value {
        Value::Null => hash(b"n"),
        Value::Bool(value) => hash(if *value { b"t" } else { b"f" }),
        Value::Number(number) => {
            // Adding 0 turns -0 into 0.
            let number = number.as_f64().unwrap_or(f64::NAN) + 0.0;
            hash(b"d");
            hash(&number.to_bits().to_le_bytes());
        }
        Value::String(text) => {
            hash(b"s");
            hash(&length(text.len()));
            hash(text.as_bytes());
        }
        Value::Array(values) => {
            hash(b"a");
            hash(&length(values.len()));
            values.iter().for_each(|value| feed(value, hash));
        }
        Value::Object(map) => {
            let mut entries: Vec<_> = map.iter().filter(|(_, v)| !v.is_null()).collect();
            entries.sort_by_key(|(key, _)| *key);
            hash(b"o");
            hash(&length(entries.len()));
            for (key, value) in entries {
                hash(&length(key.len()));
                hash(key.as_bytes());
                feed(value, hash);
            }
        }
    }
}

/// SHA-256 of a JSON value, fed as to a [`Fingerprint`]: 64 hexadecimal digits. It detects forgeries.
pub(crate) fn sha256(value: &Value) -> String {
    let mut hash = Sha256::new();
    feed(value, &mut |bytes| hash.update(bytes));
    hex::encode(hash.finalize())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn published_values() {
        for (text, hex) in [
            ("", "cbf29ce484222325"),
            ("a", "af63dc4c8601ec8c"),
            ("foobar", "85944171f73967e8"),
        ] {
            assert_eq!(Fingerprint::of(text.as_bytes()).to_hex(), hex, "{text}");
        }
    }

    #[test]
    fn hashes_of_values_are_those_of_their_bytes() {
        // As printed by `printf 's\\x03\\0\\0\\0\\0\\0\\0\\0abc' | sha256sum`.
        assert_eq!(
            sha256(&json!("abc")),
            "738cc6a4aeca85404f503c399ed1bf53f0e7e5b104bb428cc3b24df250a46e64"
        );
    }

    #[test]
    fn only_what_a_value_means_counts() {
        let hex = |text: &str| {
            let value = serde_json::from_str(text).expect("JSON");
            Fingerprint::new().and_value(&value).to_hex()
        };
        let value = hex(r#"{"a": 1, "b": [0.1, "x"]}"#);
        assert_eq!(value, hex(r#"{"b": [1e-1, "x"], "a": 1.0, "c": null}"#));
        for other in [
            r#"{"a": 1, "b": [0.1], "c": "x"}"#,
            r#"{"a": 1, "b": [0.10000000000000002, "x"]}"#,
            r#"{"a": true, "b": [0.1, "x"]}"#,
            r#"{"a": 1, "b": ["x", 0.1]}"#,
        ] {
            assert_ne!(value, hex(other), "{other}");
        }
        let nested = Fingerprint::new().and_value(&json!([[1], 2])).to_hex();
        assert_ne!(nested, hex("[[1, 2]]"));
    }
}
