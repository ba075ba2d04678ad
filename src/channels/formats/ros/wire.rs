//! Messages as bytes. In CDR (XCDR1) of ROS 2 numbers are aligned to their size, counted after the four bytes that state the
//! byte order; in ROS 1 they follow each other, least significant byte first.

use super::definitions::Number;

/// Maximum number of parts without bytes in a message of ROS 1, more than any message has, so that a damaged type ends.
const MOST_EMPTY: usize = 1000;

/// A message that is read from its beginning; `None` where it ends too early.
pub(super) struct Wire<'a> {
    bytes: &'a [u8],
    at: usize,
    is_big: bool,
    is_aligned: bool,
    /// Remaining budget of parts without bytes.
    empty: usize,
}

impl<'a> Wire<'a> {
    /// Begins a message of ROS 2, if it is in CDR.
    pub fn cdr(message: &'a [u8]) -> Option<Self> {
        let (head, bytes) = message.split_first_chunk::<4>()?;
        let is_big = match head {
            [0, 0, ..] => true,
            [0, 1, ..] => false,
            _ => return None,
        };
        Some(Self {
            bytes,
            at: 0,
            is_big,
            is_aligned: true,
            empty: 0,
        })
    }

    /// Begins a message of ROS 1.
    pub fn ros_1(message: &'a [u8]) -> Self {
        Self {
            bytes: message,
            at: 0,
            is_big: false,
            is_aligned: false,
            empty: MOST_EMPTY,
        }
    }

    /// Aligns to the size of a number.
    fn align(&mut self, size: usize) {
        if self.is_aligned {
            self.at = self.at.next_multiple_of(size);
        }
    }

    /// The bytes of a number, least significant first.
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.align(N);
        let mut bytes = *self.bytes.get(self.at..)?.first_chunk::<N>()?;
        self.at += N;
        if self.is_big {
            bytes.reverse();
        }
        Some(bytes)
    }

    pub fn number(&mut self, number: Number) -> Option<f64> {
        Some(match number {
            Number::Bool => f64::from(u8::from(self.take::<1>()? != [0])),
            Number::I8 => f64::from(i8::from_le_bytes(self.take()?)),
            Number::U8 => f64::from(u8::from_le_bytes(self.take()?)),
            Number::I16 => f64::from(i16::from_le_bytes(self.take()?)),
            Number::U16 => f64::from(u16::from_le_bytes(self.take()?)),
            Number::I32 => f64::from(i32::from_le_bytes(self.take()?)),
            Number::U32 => f64::from(u32::from_le_bytes(self.take()?)),
            Number::I64 => i64::from_le_bytes(self.take()?) as f64,
            Number::U64 => u64::from_le_bytes(self.take()?) as f64,
            Number::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Number::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// Skips numbers.
    pub fn skip(&mut self, number: Number, count: usize) -> Option<()> {
        // Nothing is aligned for an empty list.
        if count == 0 {
            return Some(());
        }
        let size = match number {
            Number::Bool | Number::I8 | Number::U8 => 1,
            Number::I16 | Number::U16 => 2,
            Number::I32 | Number::U32 | Number::F32 => 4,
            Number::I64 | Number::U64 | Number::F64 => 8,
        };
        self.align(size);
        let end = self.at.checked_add(count.checked_mul(size)?)?;
        self.bytes.get(..end)?;
        self.at = end;
        Some(())
    }

    /// Skips a part whose type has no fields: one byte in CDR.
    pub fn skip_empty(&mut self) -> Option<()> {
        if self.is_aligned {
            return self.skip(Number::U8, 1);
        }
        self.empty = self.empty.checked_sub(1)?;
        Some(())
    }

    /// Length prefix.
    pub fn count(&mut self) -> Option<usize> {
        usize::try_from(u32::from_le_bytes(self.take()?)).ok()
    }

    /// A time (s) stored as seconds and nanoseconds; `None` if it is 0, i.e. not set.
    pub fn time_s(&mut self, [seconds, nanoseconds]: [Number; 2]) -> Option<f64> {
        let seconds = self.number(seconds)?;
        let nanoseconds = self.number(nanoseconds)?;
        Some(seconds + nanoseconds * 1e-9)
    }

    /// A text, which CDR stores with a zero at its end; empty where it is not UTF-8.
    pub fn text(&mut self) -> Option<&'a str> {
        let length = self.count()?;
        let end = self.at.checked_add(length)?;
        let bytes = self.bytes.get(self.at..end)?;
        self.at = end;
        let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        Some(std::str::from_utf8(bytes).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_in_both_byte_orders() {
        let little = [
            &[0, 1, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0][..],
            &1.5_f64.to_le_bytes(),
            &[1, 0],
            &(-2_i16).to_le_bytes(),
            &3_u32.to_le_bytes(),
            b"ab\0",
            &[0; 5],
            &(-5_i64).to_le_bytes(),
        ]
        .concat();
        let big = [
            &[0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0][..],
            &1.5_f64.to_be_bytes(),
            &[1, 0],
            &(-2_i16).to_be_bytes(),
            &3_u32.to_be_bytes(),
            b"ab\0",
            &[0; 5],
            &(-5_i64).to_be_bytes(),
        ]
        .concat();
        for message in [little, big] {
            let mut wire = Wire::cdr(&message).expect("a message");
            assert_eq!(wire.number(Number::U8), Some(7.0));
            assert_eq!(wire.number(Number::F64), Some(1.5));
            assert_eq!(wire.number(Number::Bool), Some(1.0));
            assert_eq!(wire.number(Number::I16), Some(-2.0));
            assert_eq!(wire.text(), Some("ab"));
            assert_eq!(wire.number(Number::I64), Some(-5.0));
            assert_eq!(wire.number(Number::U8), None);
        }
    }

    #[test]
    fn an_empty_list_is_not_aligned() {
        let mut wire = Wire::cdr(&[0, 1, 0, 0, 0, 0, 0, 0, 9, 0, 0, 0]).expect("a message");
        assert_eq!(wire.count(), Some(0));
        assert_eq!(wire.skip(Number::F64, 0), Some(()));
        assert_eq!(wire.number(Number::U32), Some(9.0));
        assert_eq!(wire.skip(Number::F64, usize::MAX), None);
    }

    #[test]
    fn other_encodings_are_refused() {
        // PL_CDR and XCDR2, and an invalid message.
        for message in [&[0, 3, 0, 0, 1][..], &[0, 7, 0, 0, 1], &[0, 1]] {
            assert!(Wire::cdr(message).is_none());
        }
    }

    #[test]
    fn numbers_of_ros_1_follow_each_other() {
        let message = [
            &[7][..],
            &1.5_f64.to_le_bytes(),
            &2_u32.to_le_bytes(),
            b"ab",
            &(-2_i32).to_le_bytes(),
            &500_000_000_i32.to_le_bytes(),
        ]
        .concat();
        let mut wire = Wire::ros_1(&message);
        assert_eq!(wire.number(Number::U8), Some(7.0));
        assert_eq!(wire.number(Number::F64), Some(1.5));
        assert_eq!(wire.text(), Some("ab"));
        assert_eq!(wire.time_s([Number::I32; 2]), Some(-1.5));
        assert_eq!(wire.number(Number::U8), None);
        assert!((0..MOST_EMPTY).all(|_| wire.skip_empty().is_some()));
        assert_eq!(wire.skip_empty(), None);
    }
}
