//! Number formats of the computers for which C3D was designed.

/// Processor whose number format a file uses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Processor {
    Intel,
    Dec,
    Mips,
}

impl Processor {
    /// The processor of this code in the parameters.
    pub fn of(code: u8) -> Option<Self> {
        match code {
            84 => Some(Self::Intel),
            85 => Some(Self::Dec),
            86 => Some(Self::Mips),
            _ => None,
        }
    }

    pub fn integer(self, bytes: [u8; 2]) -> u16 {
        match self {
            Self::Intel | Self::Dec => u16::from_le_bytes(bytes),
            Self::Mips => u16::from_be_bytes(bytes),
        }
    }

    pub fn float(self, bytes: [u8; 4]) -> f64 {
        match self {
            Self::Intel => f64::from(f32::from_le_bytes(bytes)),
            Self::Mips => f64::from(f32::from_be_bytes(bytes)),
            Self::Dec => dec_float(bytes),
        }
    }
}

/// F_floating of DEC: the 16-bit halves are swapped, and the exponent has another bias.
fn dec_float([a, b, c, d]: [u8; 4]) -> f64 {
    let bits = u32::from_le_bytes([c, d, a, b]);
    let exponent = (bits >> 23) & 0xff;
    if exponent == 0 {
        return 0.0;
    }
    let size = f64::from((bits & 0x007f_ffff) | 0x0080_0000) * 2_f64.powi(exponent as i32 - 152);
    if bits >> 31 == 1 { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_numbers_of_three_processors() {
        for (number, dec) in [
            (1.0_f32, [0x80, 0x40, 0, 0]),
            (-1.0, [0x80, 0xc0, 0, 0]),
            (std::f32::consts::PI, [0x49, 0x41, 0xdb, 0x0f]),
            (0.1, [0xcc, 0x3e, 0xcd, 0xcc]),
            (0.0, [0; 4]),
        ] {
            let expected = f64::from(number);
            assert_eq!(Processor::Dec.float(dec), expected);
            assert_eq!(Processor::Intel.float(number.to_le_bytes()), expected);
            assert_eq!(Processor::Mips.float(number.to_be_bytes()), expected);
        }
        assert_eq!(Processor::Dec.integer([2, 1]), 258);
        assert_eq!(Processor::Mips.integer([1, 2]), 258);
        assert_eq!(Processor::of(87), None);
    }
}
