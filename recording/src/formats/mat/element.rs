//! The elements that a MAT file of version 5 is made of: a tag, then data in one of many types.

use std::io::{self, Read};

use crate::error::Error;

/// Why a variable ends early.
pub(super) enum Broken {
    Io(io::Error),
    What(&'static str),
    TooLarge(Error),
}

impl From<Error> for Broken {
    fn from(error: Error) -> Broken {
        Broken::TooLarge(error)
    }
}

impl From<io::Error> for Broken {
    fn from(error: io::Error) -> Broken {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => Broken::What("the file ends"),
            io::ErrorKind::InvalidInput | io::ErrorKind::InvalidData => {
                Broken::What("packed data are damaged")
            }
            _ => Broken::Io(error),
        }
    }
}

pub(super) fn text_of(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(&bytes[..end]).trim().to_owned()
}

pub(super) fn number(kind: u32, bytes: &[u8]) -> f64 {
    let mut word = [0; 8];
    word[..bytes.len()].copy_from_slice(bytes);
    let unsigned = u64::from_le_bytes(word);
    match kind {
        1 => f64::from(unsigned as i8),
        3 => f64::from(unsigned as i16),
        5 => f64::from(unsigned as i32),
        7 => f64::from(f32::from_bits(unsigned as u32)),
        9 => f64::from_bits(unsigned),
        12 => unsigned as i64 as f64,
        _ => unsigned as f64,
    }
}

/// An element whose data fit in memory whatever its tag says.
pub(super) fn small_element(reader: &mut dyn Read, most: u32) -> Result<Vec<u8>, Broken> {
    let (_, bytes, inside) = tag(reader)?;
    if let Some(inside) = inside {
        return Ok(inside[..bytes as usize].to_vec());
    }
    if bytes > most {
        return Err(Broken::What("a name or a dimension is too long"));
    }
    let mut data = vec![0; bytes.next_multiple_of(8) as usize];
    reader.read_exact(&mut data)?;
    data.truncate(bytes as usize);
    Ok(data)
}

/// Type and byte count; the data themselves where they stand inside the tag.
pub(super) fn tag(reader: &mut dyn Read) -> Result<(u32, u32, Option<[u8; 4]>), Broken> {
    let mut tag = [0; 8];
    reader.read_exact(&mut tag)?;
    let first = word(&tag, 0);
    match (first & 0xffff, first >> 16) {
        (kind, 0) => Ok((kind, word(&tag, 4), None)),
        (kind, bytes @ 1..=4) => Ok((kind, bytes, Some([tag[4], tag[5], tag[6], tag[7]]))),
        _ => Err(Broken::What("a tag is damaged")),
    }
}

/// The number in four bytes from there.
pub(super) fn word(bytes: &[u8], at: usize) -> u32 {
    bytes[at..].iter().take(4).rev().fold(0, |word, byte| word << 8 | u32::from(*byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_stored_type() {
        assert_eq!(number(1, &[0xff]), -1.0);
        assert_eq!(number(2, &[0xff]), 255.0);
        assert_eq!(number(3, &[0xfe, 0xff]), -2.0);
        assert_eq!(number(5, &(-3i32).to_le_bytes()), -3.0);
        assert_eq!(number(7, &0.5f32.to_le_bytes()), 0.5);
        assert_eq!(number(9, &0.1f64.to_le_bytes()), 0.1);
        assert_eq!(number(12, &(-4i64).to_le_bytes()), -4.0);
    }
}
