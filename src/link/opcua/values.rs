//! Values of nodes: types, conversion to numbers, and values to write.

use opcua_types::{Array, Variant, VariantScalarTypeId as Scalar};

use crate::symbols::{Content, Expected, ValueKind};

/// The type of a node's value.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shape {
    scalar: Option<Scalar>,
    count: usize,
    is_array: bool,
}

impl Shape {
    /// The shape of a value.
    pub fn of(value: &Variant) -> Self {
        match value {
            Variant::Array(array) => Self {
                scalar: Some(array.value_type),
                count: array.values.len(),
                is_array: true,
            },
            value => Self {
                scalar: value.scalar_type_id(),
                count: 1,
                is_array: false,
            },
        }
    }

    /// Kind of value, independent of the protocol, and number of elements.
    pub fn kind(&self) -> (ValueKind, usize) {
        use Scalar as S;
        let kind = match self.scalar {
            Some(S::Boolean) => ValueKind::Flag,
            Some(S::UInt32) => ValueKind::Counter,
            Some(S::SByte | S::Byte | S::Int16 | S::UInt16 | S::Int32 | S::Int64 | S::UInt64) => {
                ValueKind::Integer
            }
            Some(S::Float | S::Double | S::DateTime) => ValueKind::Real,
            Some(S::String) => ValueKind::Text,
            _ => ValueKind::Other,
        };
        (kind, self.count)
    }

    /// Name of the type in the standard.
    pub fn name(&self) -> String {
        let name = self
            .scalar
            .map_or("no value".to_owned(), |s| format!("{s:?}"));
        match self.is_array {
            true => format!("{name}[{}]", self.count),
            false => name,
        }
    }

    /// Content of a value; `None` if its type differs from this shape.
    pub fn content(&self, value: &Variant) -> Option<Content> {
        if Self::of(value) != *self {
            return None;
        }
        Some(match value {
            Variant::String(text) => {
                Content::Text(text.as_ref().chars().filter(|c| !c.is_control()).collect())
            }
            Variant::Array(array) => Content::Numbers(array.values.iter().map(number).collect()),
            value => Content::Numbers(vec![number(value)]),
        })
    }

    /// A value to write, with some elements changed; `None` if its type cannot hold one of them.
    pub fn with(&self, held: &Variant, changes: &[(usize, f64)]) -> Option<Variant> {
        if Self::of(held) != *self {
            return None;
        }
        let scalar = self.scalar?;
        if let Variant::Array(array) = held {
            let mut array: Array = (**array).clone();
            for (element, value) in changes {
                *array.values.get_mut(*element)? = made(scalar, *value)?;
            }
            return Some(Variant::Array(Box::new(array)));
        }
        let (_, value) = changes.last()?;
        made(scalar, *value)
    }
}

/// The types that match an expectation, in words.
pub(super) fn types_of(expected: Expected) -> &'static str {
    match expected {
        Expected::Flag => "Boolean",
        Expected::Integer => "an integer",
        Expected::Code => "an integer or Boolean",
        Expected::Counter => "UInt32",
        Expected::Number => "a number (Boolean, an integer, Float or Double)",
        Expected::Text => "String",
    }
}

/// A scalar value as a number, NaN if it is not numeric. Times are seconds since 1601.
fn number(value: &Variant) -> f64 {
    match value {
        Variant::Boolean(on) => f64::from(u8::from(*on)),
        Variant::SByte(n) => f64::from(*n),
        Variant::Byte(n) => f64::from(*n),
        Variant::Int16(n) => f64::from(*n),
        Variant::UInt16(n) => f64::from(*n),
        Variant::Int32(n) => f64::from(*n),
        Variant::UInt32(n) => f64::from(*n),
        Variant::Int64(n) => *n as f64,
        Variant::UInt64(n) => *n as f64,
        Variant::Float(n) => f64::from(*n),
        Variant::Double(n) => *n,
        Variant::DateTime(time) => time.checked_ticks() as f64 * 1e-7,
        _ => f64::NAN,
    }
}

/// A value of a type, rounded for integer types. `None` if the type cannot represent the number.
fn made(scalar: Scalar, value: f64) -> Option<Variant> {
    fn whole<T: TryFrom<i128>>(value: f64) -> Option<T> {
        let is_possible = value.is_finite() && value.abs() < 1e20;
        is_possible.then(|| T::try_from(value.round() as i128).ok())?
    }
    match scalar {
        Scalar::Boolean if value == 0.0 || value == 1.0 => Some(Variant::Boolean(value == 1.0)),
        Scalar::SByte => whole(value).map(Variant::SByte),
        Scalar::Byte => whole(value).map(Variant::Byte),
        Scalar::Int16 => whole(value).map(Variant::Int16),
        Scalar::UInt16 => whole(value).map(Variant::UInt16),
        Scalar::Int32 => whole(value).map(Variant::Int32),
        Scalar::UInt32 => whole(value).map(Variant::UInt32),
        Scalar::Int64 => whole(value).map(Variant::Int64),
        Scalar::UInt64 => whole(value).map(Variant::UInt64),
        Scalar::Float => Some(value as f32)
            .filter(|n| n.is_finite())
            .map(Variant::Float),
        Scalar::Double => Some(Variant::Double(value)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(values: &[f64]) -> Variant {
        let values: Vec<Variant> = values.iter().map(|v| Variant::Double(*v)).collect();
        let array = Array::new(Scalar::Double, values).expect("an array");
        Variant::Array(Box::new(array))
    }

    #[test]
    fn elements_are_replaced_and_read_back() {
        let held = array(&[1.0, 2.0, 3.0]);
        let shape = Shape::of(&held);
        assert_eq!(shape.name(), "Double[3]");
        assert_eq!(shape.kind(), (ValueKind::Real, 3));
        let written = shape.with(&held, &[(2, 5.0), (0, -1.0)]).expect("a value");
        let expected = Content::Numbers(vec![-1.0, 2.0, 5.0]);
        assert_eq!(shape.content(&written), Some(expected));
        assert_eq!(shape.with(&held, &[(3, 0.0)]), None);
        // Another program has another array at this node.
        assert_eq!(shape.content(&array(&[1.0])), None);
        assert_eq!(shape.with(&array(&[1.0]), &[(0, 0.0)]), None);
    }

    #[test]
    fn numbers_are_made_only_where_the_type_has_them() {
        for (scalar, value) in [
            (Scalar::Boolean, 1.0),
            (Scalar::SByte, -128.0),
            (Scalar::Int16, 32767.0),
            (Scalar::UInt32, 4_294_967_295.0),
            (Scalar::UInt64, 9_007_199_254_740_992.0),
            (Scalar::Float, 0.5),
            (Scalar::Double, 0.1),
        ] {
            assert_eq!(made(scalar, value).as_ref().map(number), Some(value));
        }
        for (scalar, value) in [
            (Scalar::Boolean, 2.0),
            (Scalar::Byte, 256.0),
            (Scalar::UInt32, -1.0),
            (Scalar::Int64, f64::NAN),
            (Scalar::Int64, 1e19),
            (Scalar::Float, 1e40),
            (Scalar::String, 0.0),
        ] {
            assert_eq!(made(scalar, value), None, "{scalar:?} {value}");
        }
    }
}
