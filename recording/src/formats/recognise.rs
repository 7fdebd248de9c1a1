//! Which format a file is in: by its first bytes, then as text, then by its extension.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use super::{FORMATS, Format, csv, formats_listed};
use crate::error::Error;

/// Bytes looked at: HDF5 may begin at byte 2048.
const HEAD: u64 = 4096;

/// First bytes of files that are no recordings, whatever their names say.
const OTHERS: [(&[u8], &str); 8] = [
    (b"\x89PNG", "a picture (PNG)"),
    (b"\xff\xd8\xff", "a picture (JPEG)"),
    (b"GIF8", "a picture (GIF)"),
    (b"%PDF", "a document (PDF)"),
    (b"\x1f\x8b", "packed by gzip"),
    (b"\x7fELF", "a program"),
    (b"{", "structured text (JSON)"),
    (b"<", "structured text (HTML or XML)"),
];

/// The file's format; afterwards the file stands at its start.
///
/// First bytes count more than the extension, since files get renamed and many loggers write
/// plain text as `.xls` or `.dat`. What cannot be looked at beforehand (a pipe) goes by its
/// extension, or is text.
pub(crate) fn recognise(
    opened: &mut File,
    path: &Path,
    file: &str,
) -> Result<&'static Format, Error> {
    let failed = |source| Error::Read { file: file.to_owned(), source };
    if !opened.metadata().map_err(failed)?.is_file() {
        return Ok(by_extension(path).unwrap_or(&csv::FORMAT));
    }
    let mut head = Vec::new();
    opened.take(HEAD).read_to_end(&mut head).map_err(failed)?;
    opened.seek(SeekFrom::Start(0)).map_err(failed)?;
    if let Some((_, what)) = OTHERS.iter().find(|(starts, _)| head.starts_with(starts)) {
        return Err(Error::Other { file: file.to_owned(), what, known: formats_listed() });
    }
    by_content(&head)
        .or_else(|| by_extension(path))
        .ok_or_else(|| Error::Format { file: file.to_owned(), known: formats_listed() })
}

/// The format with that extension.
pub(crate) fn by_extension(path: &Path) -> Option<&'static Format> {
    let extension = path.extension()?.to_string_lossy().to_lowercase();
    FORMATS.iter().copied().find(|it| it.extensions.contains(&extension.as_str()))
}

fn by_content(head: &[u8]) -> Option<&'static Format> {
    let known = FORMATS.iter().copied().find(|it| (it.starts)(head));
    known.or_else(|| is_text(head).then_some(&csv::FORMAT))
}

/// Whether that is the start of a text in any encoding: no control characters but those of a
/// text; in UTF-16, every second byte of plain characters is zero.
fn is_text(head: &[u8]) -> bool {
    let text = |byte: &u8| *byte >= b' ' || matches!(byte, b'\t' | b'\n' | b'\r' | 0x0c);
    let every_second = |from: usize| head.iter().skip(from).step_by(2).all(|byte| *byte == 0);
    let marked = head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff");
    marked || head.iter().all(text) || (head.len() > 1 && (every_second(0) || every_second(1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(head: &[u8]) -> Option<&'static str> {
        by_content(head).map(|it| it.name)
    }

    #[test]
    fn first_bytes_tell() {
        let mut matlab = [0; 600];
        matlab[..10].copy_from_slice(b"MATLAB 7.3");
        matlab[512..520].copy_from_slice(b"\x89HDF\r\n\x1a\n");
        let heads: [(&[u8], _); 8] = [
            (b"PAR1\x15\x04", "Parquet"),
            (b"PK\x03\x04\x14\0", "Excel"),
            (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "Excel"),
            (b"MATLAB 5.0 MAT-file, made", "MAT"),
            (b"\x89HDF\r\n\x1a\n\0", "HDF5"),
            (&matlab, "HDF5"),
            (b"TDSm\x0e\0\0\0", "TDMS"),
            (b"MDF     4.10    ", "MDF"),
        ];
        for (head, name) in heads {
            assert_eq!(named(head), Some(name));
        }
    }

    #[test]
    fn text_is_csv_in_every_encoding() {
        let utf16: Vec<u8> = "time,u\n0,1\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = "time,u\n0,1\n".encode_utf16().flat_map(u16::to_be_bytes).collect();
        for text in
            [&b"time\tu\r\n0\t1"[..], b"", b"Zeit [\xb5s];u\n", "µ,Ω".as_bytes(), &utf16, &big]
        {
            assert_eq!(named(text), Some("CSV"), "{text:?}");
        }
        assert_eq!(named(b"\x00\x01\x02\x03binary"), None);
        assert_eq!(by_extension(Path::new("a/B.MAT")).map(|it| it.name), Some("MAT"));
        assert!(by_extension(Path::new("a/mat")).is_none());
    }
}
