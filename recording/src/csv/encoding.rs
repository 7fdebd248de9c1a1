//! Text of any encoding that loggers write, as bytes of UTF-8 or of Windows-1252.

use std::borrow::Cow;
use std::io::{self, Cursor, ErrorKind, Read};

use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};
use encoding_rs_io::{DecodeReaderBytes, DecodeReaderBytesBuilder};

/// Bytes whose zeros tell UTF-16 without a mark: two letters of the header.
const LOOKED_AT: usize = 4;

/// A reader of UTF-8 (or another encoding that contains ASCII), whatever the file is in.
pub(super) type Decoded<R> = DecodeReaderBytes<io::Chain<Cursor<Vec<u8>>, R>, Vec<u8>>;

/// Takes a byte order mark off, and turns UTF-16 into UTF-8; anything else passes as it is.
pub(super) fn decoded<R: Read>(mut reader: R) -> io::Result<Decoded<R>> {
    let mut first = [0; LOOKED_AT];
    let mut known = 0;
    while known < LOOKED_AT {
        match reader.read(&mut first[known..]) {
            Ok(0) => break,
            Ok(more) => known += more,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    let first = first[..known].to_vec();
    let encoding = unmarked_utf_16(&first);
    Ok(DecodeReaderBytesBuilder::new()
        .encoding(encoding)
        .utf8_passthru(true)
        .strip_bom(true)
        .build(Cursor::new(first).chain(reader)))
}

/// UTF-16 without a mark, recognised by the zeros beside ASCII letters.
fn unmarked_utf_16(first: &[u8]) -> Option<&'static Encoding> {
    match *first {
        [a, 0, b, 0] if a != 0 && b != 0 => Some(UTF_16LE),
        [0, a, 0, b] if a != 0 && b != 0 => Some(UTF_16BE),
        _ => None,
    }
}

/// The text of bytes: UTF-8, or Windows-1252 (which holds Latin-1) where they are no UTF-8.
pub(super) fn text(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => WINDOWS_1252.decode_without_bom_handling(bytes).0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_encoding_comes_out_as_the_same_text() {
        let plain = "time [s];Winkel [°]\n0;1,5\n";
        let units = || plain.encode_utf16();
        let little = || units().flat_map(u16::to_le_bytes);
        let big = || units().flat_map(u16::to_be_bytes);
        let latin_1: Vec<u8> = plain.chars().map(|c| u8::try_from(c as u32).unwrap()).collect();
        for bytes in [
            plain.as_bytes().to_vec(),
            [b"\xef\xbb\xbf", plain.as_bytes()].concat(),
            little().collect(),
            big().collect(),
            [0xff, 0xfe].into_iter().chain(little()).collect(),
            [0xfe, 0xff].into_iter().chain(big()).collect(),
            latin_1,
        ] {
            let mut read = Vec::new();
            decoded(&bytes[..]).unwrap().read_to_end(&mut read).unwrap();
            assert_eq!(text(&read), plain, "{bytes:?}");
        }
        let mut short = Vec::new();
        decoded(&b"a"[..]).unwrap().read_to_end(&mut short).unwrap();
        assert_eq!(short, b"a");
    }
}
