//! The MAT-file format of version 5 ("Level 5"), as far as numbers go.
//!
//! 128 bytes of header, then elements: a tag (type, byte count) and data padded to 8 bytes; up to
//! four bytes of data may stand inside the tag. A variable is an element of type 14, or 15 where
//! it is packed by zlib; in it follow flags, dimensions, name and values. Values are unpacked as
//! they are read, so a file costs its numbers and nothing more; variables that hold no numbers
//! are passed over. Source: MathWorks, "MAT-File Format", R2021b, chapter 1.

use std::io::{self, Read};

use flate2::read::ZlibDecoder;

use crate::error::Error;

const HEADER: usize = 128;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// A name is at most 63 characters in MATLAB; others write longer ones.
const LONGEST_NAME: u32 = 4096;
/// Bytes that are turned into numbers at a time; a multiple of every number's size.
const CHUNK: usize = 1 << 16;

/// A variable of the file.
pub(super) struct Variable {
    pub(super) name: String,
    pub(super) content: Content,
}

/// What a variable holds.
pub(super) enum Content {
    /// A real matrix, column after column.
    Numbers { rows: usize, columns: usize, values: Vec<f64> },
    /// Something else, by its name.
    Other(&'static str),
}

/// Reads variable after variable.
pub(super) struct Level5<R: Read> {
    reader: Counted<R>,
    file: String,
}

/// Why a variable ends early.
enum Broken {
    Io(io::Error),
    What(&'static str),
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

impl<R: Read> Level5<R> {
    /// Reads the header.
    pub(super) fn new(reader: R, file: &str) -> Result<Level5<R>, Error> {
        let mut level5 = Level5 { reader: Counted { reader, bytes: 0 }, file: file.to_owned() };
        let mut header = [0; HEADER];
        let read = fill(&mut level5.reader, &mut header).map_err(|error| level5.broken(error))?;
        let version = |version| Error::MatVersion { file: file.to_owned(), version };
        if header.starts_with(b"\x89HDF") || header.starts_with(b"MATLAB 7.3") {
            return Err(version("version 7.3 (HDF5)"));
        }
        if read == 0 {
            return Err(Error::Empty { file: file.to_owned() });
        }
        match (read, &header[124..]) {
            (HEADER, [0, 1, b'I', b'M']) => Ok(level5),
            (HEADER, [1, 0, b'M', b'I']) => Err(version("version 5, big-endian")),
            // Version 4 has no text: its first number is a small type code.
            _ if header[..4].contains(&0) => Err(version("version 4")),
            _ => Err(level5.broken(Broken::What("no header of version 5"))),
        }
    }

    /// The next variable; `None` at the end of the file.
    pub(super) fn next(&mut self) -> Result<Option<Variable>, Error> {
        self.element().map_err(|error| self.broken(error))
    }

    fn element(&mut self) -> Result<Option<Variable>, Broken> {
        loop {
            let mut tag = [0; 8];
            match fill(&mut self.reader, &mut tag)? {
                0 => return Ok(None),
                8 => {}
                _ => return Err(Broken::What("the file ends")),
            }
            let (kind, bytes) = (word(&tag, 0), u64::from(word(&tag, 4)));
            let mut element = self.reader.by_ref().take(bytes);
            let variable = match kind {
                MATRIX => Some(variable(&mut element)?),
                COMPRESSED => {
                    let mut unpacked = ZlibDecoder::new(&mut element);
                    let mut tag = [0; 8];
                    unpacked.read_exact(&mut tag)?;
                    if word(&tag, 0) != MATRIX {
                        return Err(Broken::What("packed data hold no variable"));
                    }
                    Some(variable(&mut unpacked)?)
                }
                _ => None,
            };
            io::copy(&mut element, &mut io::sink())?;
            if element.limit() > 0 {
                return Err(Broken::What("the file ends"));
            }
            if kind != COMPRESSED {
                let mut padding = self.reader.by_ref().take((8 - bytes % 8) % 8);
                io::copy(&mut padding, &mut io::sink())?;
            }
            if variable.is_some() {
                return Ok(variable);
            }
        }
    }

    fn broken(&self, error: Broken) -> Error {
        let file = self.file.clone();
        match error {
            Broken::Io(source) => Error::Read { file, source },
            Broken::What(what) => Error::MatDamaged { file, what, at: self.reader.bytes },
        }
    }
}

/// Flags, dimensions, name and, if they are real numbers, the values.
fn variable(reader: &mut impl Read) -> Result<Variable, Broken> {
    let flags = small_element(reader, 8)?;
    let dimensions = small_element(reader, 4 * 32)?;
    let name = small_element(reader, LONGEST_NAME)?;
    let name = String::from_utf8_lossy(&name).trim_end_matches('\0').to_owned();
    let [class, bits, ..] = flags[..] else { return Err(Broken::What("no flags")) };
    let other = match class {
        1 => Some("cell array"),
        2 => Some("struct"),
        3 => Some("object"),
        4 => Some("text"),
        5 => Some("sparse matrix"),
        6..=15 if bits & 0x08 != 0 => Some("complex matrix"),
        6..=15 if dimensions.len() != 8 => Some("matrix of more than two dimensions"),
        6..=15 => None,
        _ => Some("function or object"),
    };
    if let Some(kind) = other {
        return Ok(Variable { name, content: Content::Other(kind) });
    }
    let (rows, columns) = (word(&dimensions, 0) as usize, word(&dimensions, 4) as usize);
    let values = numbers(reader)?;
    if rows.checked_mul(columns) != Some(values.len()) {
        return Err(Broken::What("dimensions and number of values differ"));
    }
    Ok(Variable { name, content: Content::Numbers { rows, columns, values } })
}

/// The values' element, whatever type they are stored in: MATLAB stores doubles that are small
/// integers in a byte each.
fn numbers(reader: &mut impl Read) -> Result<Vec<f64>, Broken> {
    let (kind, bytes, inside) = tag(reader)?;
    let size = match kind {
        1 | 2 => 1,
        3 | 4 => 2,
        5..=7 => 4,
        9 | 12 | 13 => 8,
        _ => return Err(Broken::What("values of an unknown type")),
    };
    if let Some(inside) = inside {
        let inside = &inside[..bytes as usize];
        return Ok(inside.chunks_exact(size).map(|value| number(kind, value)).collect());
    }
    let mut values = Vec::new();
    let mut chunk = vec![0; CHUNK];
    let mut rest = bytes as usize;
    while rest > 0 {
        let part = &mut chunk[..rest.min(CHUNK)];
        reader.read_exact(part)?;
        if rest == bytes as usize {
            // A damaged count costs no memory unless the first bytes are there.
            let _ = values.try_reserve_exact(rest / size);
        }
        rest -= part.len();
        values.extend(part.chunks_exact(size).map(|value| number(kind, value)));
    }
    Ok(values)
}

fn number(kind: u32, bytes: &[u8]) -> f64 {
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
fn small_element(reader: &mut impl Read, most: u32) -> Result<Vec<u8>, Broken> {
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
fn tag(reader: &mut impl Read) -> Result<(u32, u32, Option<[u8; 4]>), Broken> {
    let mut tag = [0; 8];
    reader.read_exact(&mut tag)?;
    let first = word(&tag, 0);
    match (first & 0xffff, first >> 16) {
        (kind, 0) => Ok((kind, word(&tag, 4), None)),
        (kind, bytes @ 1..=4) => Ok((kind, bytes, Some([tag[4], tag[5], tag[6], tag[7]]))),
        _ => Err(Broken::What("a tag is damaged")),
    }
}

fn word(bytes: &[u8], at: usize) -> u32 {
    bytes[at..].iter().take(4).rev().fold(0, |word, byte| word << 8 | u32::from(*byte))
}

/// Reads until the buffer is full or the file ends; the number of bytes read.
fn fill(reader: &mut impl Read, buffer: &mut [u8]) -> Result<usize, Broken> {
    let mut filled = 0;
    while filled < buffer.len() {
        match reader.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(read) => filled += read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error.into()),
        }
    }
    Ok(filled)
}

/// Counts bytes, for messages.
struct Counted<R> {
    reader: R,
    bytes: u64,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.reader.read(buffer)?;
        self.bytes += read as u64;
        Ok(read)
    }
}
