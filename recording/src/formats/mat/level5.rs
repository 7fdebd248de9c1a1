//! The MAT-file format of version 5 ("Level 5"), as far as numbers go.
//!
//! 128 bytes of header, then elements: a tag (type, byte count) and data padded to 8 bytes; up to
//! four bytes of data may stand inside the tag. A variable is an element of type 14, or 15 where
//! it is packed by zlib; in it follow flags, dimensions, name and values, or, in a struct or a
//! cell array, further elements of type 14. Values are unpacked as they are read, so a file costs
//! its numbers and nothing more; variables that hold no numbers are passed over.
//! The elements are read here, what is in a variable in `variable`.
//! Source: MathWorks, "MAT-File Format", R2021b, chapter 1.

use std::io::{self, Read};

use flate2::read::ZlibDecoder;

use super::OCTAVE_TEXT;
use super::element::{Broken, word};
use super::variable::{MATRIX, Parser};
use crate::budget::Budget;
use crate::error::Error;
use crate::formats::tree::Tree;

const HEADER: usize = 128;
const COMPRESSED: u32 = 15;

/// Reads a file's variables.
pub(super) fn read(reader: impl Read, file: &str, budget: &mut Budget) -> Result<Tree, Error> {
    let mut level5 = Level5::new(reader, file)?;
    let mut tree = Tree::default();
    let mut parser = Parser { tree: &mut tree, budget };
    loop {
        match level5.element(&mut parser) {
            Ok(true) => {}
            Ok(false) => return Ok(tree),
            Err(broken) => return Err(level5.broken(broken)),
        }
    }
}

/// Reads variable after variable.
struct Level5<R: Read> {
    reader: Counted<R>,
    file: String,
}

impl<R: Read> Level5<R> {
    /// Reads the header.
    fn new(reader: R, file: &str) -> Result<Level5<R>, Error> {
        let mut level5 = Level5 { reader: Counted { reader, bytes: 0 }, file: file.to_owned() };
        let mut header = [0; HEADER];
        let read = fill(&mut level5.reader, &mut header).map_err(|error| level5.broken(error))?;
        let variety = |what: &str| Error::Variety {
            file: file.to_owned(),
            what: format!("a MAT file of {what}"),
            instead: "save it with `save -v7` in MATLAB or Octave",
        };
        if header.starts_with(OCTAVE_TEXT) {
            return Err(variety("Octave's text form"));
        }
        if read == 0 {
            return Err(Error::Empty { file: file.to_owned() });
        }
        match (read, &header[124..]) {
            (HEADER, [0, 1, b'I', b'M']) => Ok(level5),
            (HEADER, [1, 0, b'M', b'I']) => Err(variety("version 5, big-endian")),
            // Version 4 has no text: its first number is a small type code.
            _ if header[..4].contains(&0) => Err(variety("version 4")),
            _ => Err(level5.broken(Broken::What("no header of version 5"))),
        }
    }

    /// Reads an element; false at the end of the file.
    fn element(&mut self, parser: &mut Parser) -> Result<bool, Broken> {
        let mut tag = [0; 8];
        match fill(&mut self.reader, &mut tag)? {
            0 => return Ok(false),
            8 => {}
            _ => return Err(Broken::What("the file ends")),
        }
        let (kind, bytes) = (word(&tag, 0), u64::from(word(&tag, 4)));
        let mut element = self.reader.by_ref().take(bytes);
        match kind {
            MATRIX => parser.variable(&mut element, Vec::new(), 0)?,
            COMPRESSED => {
                let mut unpacked = ZlibDecoder::new(&mut element);
                let mut tag = [0; 8];
                unpacked.read_exact(&mut tag)?;
                if word(&tag, 0) != MATRIX {
                    return Err(Broken::What("packed data hold no variable"));
                }
                parser.variable(&mut unpacked, Vec::new(), 0)?;
            }
            _ => {}
        }
        io::copy(&mut element, &mut io::sink())?;
        if element.limit() > 0 {
            return Err(Broken::What("the file ends"));
        }
        if kind != COMPRESSED {
            let mut padding = self.reader.by_ref().take((8 - bytes % 8) % 8);
            io::copy(&mut padding, &mut io::sink())?;
        }
        Ok(true)
    }

    fn broken(&self, error: Broken) -> Error {
        let file = self.file.clone();
        match error {
            Broken::Io(source) => Error::Read { file, source },
            Broken::What(what) => {
                let what = format!("{what} near byte {}", self.reader.bytes);
                Error::Damaged { file, format: super::FORMAT.name, what }
            }
            Broken::TooLarge(error) => error,
        }
    }
}

/// Reads until the buffer is full or the file ends; the number of bytes read.
fn fill(reader: &mut dyn Read, buffer: &mut [u8]) -> Result<usize, Broken> {
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
