//! MATLAB files of version 5: each table is a struct of columns, numbers are column vectors, texts are cells of strings.
//!
//! Elements have a type and a number of bytes, and are padded to 8 bytes; an array is an element that consists of flags,
//! dimensions, name and data. Source: MATLAB MAT-File Format (The MathWorks, R2021b), chapter 1.

use super::{Cells, Table};

const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;

const CELL: u32 = 1;
const STRUCT: u32 = 2;
const CHAR: u32 = 4;
const DOUBLES: u32 = 6;

/// Length of a field name in bytes, including the terminating zero.
const FIELD: usize = 32;

/// The bytes of a file with these tables.
pub(super) fn file(tables: &[Table]) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file, written by Tautline".to_vec();
    bytes.resize(124, b' ');
    bytes.extend(0x0100_u16.to_le_bytes());
    bytes.extend(b"IM");
    for table in tables {
        bytes.extend(structure(table));
    }
    bytes
}

fn structure(table: &Table) -> Vec<u8> {
    let mut names: Vec<String> = Vec::new();
    for (name, _) in &table.columns {
        let mut field = field(name);
        for number in 2.. {
            if !names.contains(&field) {
                break;
            }
            field.truncate(FIELD - 6);
            field += &format!("_{number}");
        }
        names.push(field);
    }
    let mut fields = vec![0; FIELD * names.len()];
    for (field, name) in fields.chunks_exact_mut(FIELD).zip(&names) {
        field[..name.len()].copy_from_slice(name.as_bytes());
    }
    // The length of a name is always a small element, whose tag holds type and size in one word.
    let mut data = [4 << 16 | INT32, FIELD as u32]
        .map(u32::to_le_bytes)
        .concat();
    data.extend(element(INT8, &fields));
    for (_, cells) in &table.columns {
        data.extend(match cells {
            Cells::Numbers(numbers) => {
                let bytes: Vec<u8> = numbers.iter().flat_map(|one| one.to_le_bytes()).collect();
                array(DOUBLES, [numbers.len(), 1], "", &element(DOUBLE, &bytes))
            }
            Cells::Texts(texts) => {
                let cells: Vec<u8> = texts.iter().flat_map(|text| string(text)).collect();
                array(CELL, [texts.len(), 1], "", &cells)
            }
        });
    }
    array(STRUCT, [1, 1], table.name, &data)
}

fn string(text: &str) -> Vec<u8> {
    let units: Vec<u16> = text.encode_utf16().collect();
    let bytes: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let rows = usize::from(!units.is_empty());
    array(CHAR, [rows, units.len()], "", &element(UINT16, &bytes))
}

fn array(class: u32, dimensions: [usize; 2], name: &str, data: &[u8]) -> Vec<u8> {
    let words = |words: [u32; 2]| words.map(u32::to_le_bytes).concat();
    let mut content = element(UINT32, &words([class, 0]));
    content.extend(element(INT32, &words(dimensions.map(|size| size as u32))));
    content.extend(element(INT8, name.as_bytes()));
    content.extend(data);
    element(MATRIX, &content)
}

fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind, data.len() as u32].map(u32::to_le_bytes).concat();
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// A valid field name of MATLAB: letters, digits and underscores, starting with a letter, at most 31 characters.
fn field(name: &str) -> String {
    let allowed = |letter: char| match letter.is_ascii_alphanumeric() {
        true => letter,
        false => '_',
    };
    let mut field: String = name.chars().map(allowed).collect();
    if !field.starts_with(|letter: char| letter.is_ascii_alphabetic()) {
        field.insert(0, 'x');
    }
    field.truncate(FIELD - 1);
    field
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected bytes by hand from the description of the format.
    #[test]
    fn a_column_has_the_bytes_of_the_format() {
        let table = Table::new("t").numbers("a b", [2.5].into_iter());
        let bytes = file(&[table]);
        let words: Vec<u32> = bytes[128..]
            .chunks_exact(4)
            .map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
            .collect();
        let [low, high] = [2.5_f64.to_bits() as u32, (2.5_f64.to_bits() >> 32) as u32];
        assert_eq!(words[..10], [14, 160, 6, 8, 2, 0, 5, 8, 1, 1]);
        assert_eq!(
            words[10..18],
            [1, 1, u32::from(b't'), 0, 0x4_0005, 32, 1, 32]
        );
        assert_eq!(&bytes[128 + 72..128 + 76], b"a_b\0");
        assert_eq!(words[26..36], [14, 56, 6, 8, 6, 0, 5, 8, 1, 1]);
        assert_eq!(words[36..], [1, 0, 9, 8, low, high]);
    }

    #[test]
    fn names_are_fields_and_texts_are_strings() {
        assert_eq!(field("1st reading (mm)"), "x1st_reading__mm_");
        assert_eq!(field(&"long".repeat(20)).len(), 31);
        let bytes = string("é");
        assert_eq!(bytes[48..58], [4, 0, 0, 0, 2, 0, 0, 0, 0xe9, 0]);
    }
}
