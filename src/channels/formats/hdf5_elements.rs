//! Content of the elements of an HDF5 array: a number, a text, or a record of these.

use hdf5_pure::{Datatype, DatatypeByteOrder, FloatingPointLayout};

/// A number or text in the elements of an array.
pub(super) struct Field {
    /// Its path in a record; empty in an array of plain numbers.
    pub name: String,
    pub offset: usize,
    pub size: usize,
    /// Number of consecutive values.
    pub count: usize,
    pub cell: Cell,
    big_endian: bool,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Cell {
    Signed,
    Unsigned,
    Float,
    Text,
    /// A variable-length text, stored outside the element.
    FarText,
}

/// The path of a part; the path of the whole if the part has no name.
pub(super) fn joined(path: &str, name: &str) -> String {
    match name {
        "" => path.to_owned(),
        name => format!("{path}.{name}"),
    }
}

/// Lists the numbers and texts in an element of this type, and unsupported parts.
pub(super) fn fields_of(
    datatype: &Datatype,
    name: &str,
    offset: u64,
    fields: &mut Vec<Field>,
    strange: &mut Vec<(String, &'static str)>,
) {
    let (cell, size, order) = match datatype {
        Datatype::Compound { members, .. } => {
            for member in members {
                let name = match name {
                    "" => member.name.clone(),
                    name => joined(name, &member.name),
                };
                let offset = offset.saturating_add(member.byte_offset);
                fields_of(&member.datatype, &name, offset, fields, strange);
            }
            return;
        }
        Datatype::Array {
            base_type,
            dimensions,
        } => {
            let before = fields.len();
            fields_of(base_type, name, offset, fields, strange);
            let count = dimensions
                .iter()
                .try_fold(1_usize, |count, size| count.checked_mul(*size as usize));
            match (&mut fields[before..], count) {
                ([], _) => {}
                ([field], Some(count)) if field.count == 1 && field.cell != Cell::FarText => {
                    field.count = count;
                }
                _ => {
                    fields.truncate(before);
                    strange.push((name.to_owned(), "arrays of records"));
                }
            }
            return;
        }
        Datatype::Enumeration { base_type, .. } => {
            return fields_of(base_type, name, offset, fields, strange);
        }
        Datatype::FixedPoint {
            size,
            byte_order,
            layout,
        } if is_whole(*size, layout.bit_offset, layout.bit_precision) => {
            let cell = if layout.signed {
                Cell::Signed
            } else {
                Cell::Unsigned
            };
            (cell, *size, *byte_order)
        }
        // PyTables uses this type for booleans.
        Datatype::BitField {
            size,
            byte_order,
            bit_offset,
            bit_precision,
        } if is_whole(*size, *bit_offset, *bit_precision) => (Cell::Unsigned, *size, *byte_order),
        Datatype::FloatingPoint {
            size,
            byte_order,
            layout,
        } if is_float(*size, layout) => (Cell::Float, *size, *byte_order),
        Datatype::String { size, .. } => (Cell::Text, *size, DatatypeByteOrder::LittleEndian),
        Datatype::VariableLength {
            is_string: true, ..
        } if name.is_empty() => (Cell::FarText, 0, DatatypeByteOrder::LittleEndian),
        other => {
            let why = match other {
                Datatype::FixedPoint { .. } | Datatype::FloatingPoint { .. } => {
                    "numbers of an unusual width"
                }
                Datatype::VariableLength {
                    is_string: true, ..
                } => "variable-length texts in a record",
                Datatype::VariableLength { .. } => "variable-length lists",
                Datatype::Reference { .. } => "references to other arrays",
                _ => "neither numbers nor text",
            };
            return strange.push((name.to_owned(), why));
        }
    };
    fields.push(Field {
        name: name.to_owned(),
        offset: usize::try_from(offset).unwrap_or(usize::MAX / 2),
        size: size as usize,
        count: 1,
        cell,
        big_endian: order == DatatypeByteOrder::BigEndian,
    });
}

/// Whether an integer of 1 to 8 bytes uses all of its bits.
fn is_whole(size: u32, bit_offset: u16, bit_precision: u16) -> bool {
    matches!(size, 1..=8) && bit_offset == 0 && u32::from(bit_precision) == 8 * size
}

/// Whether a floating-point number has the IEEE 754 layout of 2, 4 or 8 bytes.
fn is_float(size: u32, layout: &FloatingPointLayout) -> bool {
    let half = FloatingPointLayout {
        bit_offset: 0,
        bit_precision: 16,
        exponent_location: 10,
        exponent_size: 5,
        mantissa_location: 0,
        mantissa_size: 10,
        exponent_bias: 15,
    };
    match size {
        2 => *layout == half,
        4 => *layout == FloatingPointLayout::IEEE754_BINARY32,
        8 => *layout == FloatingPointLayout::IEEE754_BINARY64,
        _ => false,
    }
}

impl Field {
    /// A number; NaN if it is not finite.
    pub fn number(&self, bytes: &[u8]) -> f64 {
        let mut little = [0_u8; 8];
        let Some(slot) = little
            .get_mut(..bytes.len())
            .filter(|slot| !slot.is_empty())
        else {
            return f64::NAN;
        };
        slot.copy_from_slice(bytes);
        if self.big_endian {
            slot.reverse();
        }
        let bits = u64::from_le_bytes(little);
        let unused = 64 - 8 * bytes.len() as u32;
        let value = match (self.cell, bytes.len()) {
            (Cell::Float, 8) => f64::from_bits(bits),
            (Cell::Float, 4) => f64::from(f32::from_bits(bits as u32)),
            (Cell::Float, _) => half(bits as u16),
            (Cell::Signed, _) => ((bits << unused).cast_signed() >> unused) as f64,
            _ => bits as f64,
        };
        if value.is_finite() { value } else { f64::NAN }
    }
}

/// A half-precision number.
fn half(bits: u16) -> f64 {
    let mantissa = f64::from(bits & 0x3ff);
    let size = match bits >> 10 & 0x1f {
        0 => mantissa * 2_f64.powi(-24),
        0x1f => f64::NAN,
        exponent => (1024.0 + mantissa) * 2_f64.powi(i32::from(exponent) - 25),
    };
    if bits >> 15 == 0 { size } else { -size }
}

/// A text of fixed length, which zeros or blanks fill up.
pub(super) fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|byte| *byte == 0);
    let text = String::from_utf8_lossy(&bytes[..end.unwrap_or(bytes.len())]);
    text.trim_end().to_owned()
}
