//! Values of a TDMS file by their types.

/// Types of values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Type {
    Signed(u8),
    Unsigned(u8),
    Single,
    Double,
    Flag,
    Text,
    TimeStamp,
    /// So many bytes of something else.
    Other(u8),
}

impl Type {
    pub(super) fn of(code: u32) -> Option<Type> {
        Some(match code {
            0 => Type::Other(0),
            1 => Type::Signed(1),
            2 => Type::Signed(2),
            3 => Type::Signed(4),
            4 => Type::Signed(8),
            5 => Type::Unsigned(1),
            6 => Type::Unsigned(2),
            7 => Type::Unsigned(4),
            8 => Type::Unsigned(8),
            9 | 0x19 => Type::Single,
            10 | 0x1a => Type::Double,
            // Extended floats, with and without a unit; complex numbers.
            11 | 0x1b | 0x10_000d => Type::Other(16),
            0x08_000c => Type::Other(8),
            0x20 => Type::Text,
            0x21 => Type::Flag,
            0x44 => Type::TimeStamp,
            _ => return None,
        })
    }

    pub(super) fn size(self) -> usize {
        match self {
            Type::Signed(size) | Type::Unsigned(size) | Type::Other(size) => size.into(),
            Type::Single => 4,
            Type::Double => 8,
            Type::Flag => 1,
            Type::TimeStamp => 16,
            Type::Text => 0,
        }
    }

    /// What the values are, if they are no numbers.
    pub(super) fn no_number(self) -> Option<&'static str> {
        match self {
            Type::Text => Some("texts"),
            Type::Other(_) => Some("complex or extended numbers"),
            _ => None,
        }
    }

    /// The value in as many bytes as its size; a time in seconds since 1904.
    pub(super) fn value(self, bytes: &[u8], big: bool) -> f64 {
        let digit = |word: u128, byte: &u8| word << 8 | u128::from(*byte);
        let word = match big {
            true => bytes.iter().fold(0, digit),
            false => bytes.iter().rev().fold(0, digit),
        };
        match self {
            Type::Single => f64::from(f32::from_bits(word as u32)),
            Type::Double => f64::from_bits(word as u64),
            Type::Signed(size) => {
                let free = 64 - 8 * u32::from(size);
                ((word as u64) << free) as i64 as f64 / (1u64 << free) as f64
            }
            // Seconds above, their fractions in units of 2^-64 below.
            Type::TimeStamp => (word >> 64) as i64 as f64 + (word as u64) as f64 / 2f64.powi(64),
            Type::Unsigned(_) | Type::Flag | Type::Text | Type::Other(_) => word as u64 as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_in_both_orders() {
        assert_eq!(Type::Signed(2).value(&[0xfe, 0xff], false), -2.0);
        assert_eq!(Type::Signed(2).value(&[0xff, 0xfe], true), -2.0);
        assert_eq!(Type::Signed(8).value(&(-9i64).to_le_bytes(), false), -9.0);
        assert_eq!(Type::Unsigned(4).value(&7u32.to_be_bytes(), true), 7.0);
        assert_eq!(Type::Double.value(&0.1f64.to_le_bytes(), false), 0.1);
        let stamp = (3u128 << 64) + (1 << 63);
        assert_eq!(Type::TimeStamp.value(&stamp.to_le_bytes(), false), 3.5);
    }
}
