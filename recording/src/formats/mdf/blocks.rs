//! The blocks of an MDF file: a mark, links to other blocks, and data.
//!
//! Source: ASAM MDF 4.1, "Programmers Guide", chapter 4.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};

use super::FORMAT;
use crate::error::Error;

/// Bytes before a block's links: mark, nothing, length, number of links.
pub(super) const HEAD: u64 = 24;
/// Where the header block stands.
const HEADER: u64 = 64;
/// Blocks that describe are no longer; blocks of samples are read elsewhere.
const LONGEST: u64 = 1 << 22;
/// Blocks that are read before a chain is taken for a circle.
const MOST_BLOCKS: usize = 1_000_000;

/// A block that describes something.
#[derive(Debug)]
pub(super) struct Block {
    links: Vec<u64>,
    data: Vec<u8>,
}

impl Block {
    /// The address that a link leads to; 0 for none.
    pub(super) fn link(&self, k: usize) -> u64 {
        self.links.get(k).copied().unwrap_or(0)
    }

    pub(super) fn links(&self) -> &[u64] {
        &self.links
    }

    pub(super) fn byte(&self, at: usize) -> u8 {
        self.data.get(at).copied().unwrap_or(0)
    }

    pub(super) fn u16(&self, at: usize) -> u16 {
        self.word::<2>(at).map_or(0, u16::from_le_bytes)
    }

    pub(super) fn u32(&self, at: usize) -> u32 {
        self.word::<4>(at).map_or(0, u32::from_le_bytes)
    }

    pub(super) fn u64(&self, at: usize) -> u64 {
        self.word::<8>(at).map_or(0, u64::from_le_bytes)
    }

    pub(super) fn f64(&self, at: usize) -> Option<f64> {
        self.word(at).map(f64::from_le_bytes)
    }

    fn word<const N: usize>(&self, at: usize) -> Option<[u8; N]> {
        self.data.get(at..)?.first_chunk().copied()
    }
}

/// Reads blocks by their addresses.
pub(super) struct Blocks {
    reader: BufReader<File>,
    file: String,
    length: u64,
    count: usize,
}

impl Blocks {
    pub(super) fn new(opened: File, file: &str) -> Result<Blocks, Error> {
        let failed = |source| Error::Read { file: file.to_owned(), source };
        let length = opened.metadata().map_err(failed)?.len();
        let reader = BufReader::new(opened);
        Ok(Blocks { reader, file: file.to_owned(), length, count: 0 })
    }

    /// The first data group, after a look at the version.
    pub(super) fn first(&mut self) -> Result<u64, Error> {
        let identity = self.bytes(0, HEADER)?;
        let variety = |what: &str, instead| Error::Variety {
            file: self.file.clone(),
            what: what.to_owned(),
            instead,
        };
        if identity.starts_with(b"UnFin") {
            return Err(variety("an MDF file that was not closed", "close it in its recorder"));
        }
        if u16::from_le_bytes([identity[28], identity[29]]) < 400 {
            return Err(variety("an MDF file older than version 4", "export it as MDF 4"));
        }
        Ok(self.block(HEADER, b"##HD")?.link(0))
    }

    /// A block that must have that mark.
    pub(super) fn block(&mut self, at: u64, mark: &[u8; 4]) -> Result<Block, Error> {
        match self.any(at)? {
            (found, block) if found == *mark => Ok(block),
            _ => {
                let mark = String::from_utf8_lossy(mark);
                Err(self.damaged(&format!("no block {mark} at byte {at}")))
            }
        }
    }

    /// A block with its mark.
    pub(super) fn any(&mut self, at: u64) -> Result<([u8; 4], Block), Error> {
        let (mark, length, links) = self.head(at)?;
        if length > LONGEST {
            return Err(self.damaged(&format!("the block at byte {at} is too long")));
        }
        let bytes = self.bytes(at + HEAD, length - HEAD)?;
        let (links, data) = bytes.split_at((8 * links as usize).min(bytes.len()));
        let word = |bytes: &[u8]| bytes.iter().rev().fold(0, |all, it| all << 8 | u64::from(*it));
        Ok((mark, Block { links: links.chunks_exact(8).map(word).collect(), data: data.to_vec() }))
    }

    /// Mark, length and number of links of the block there.
    pub(super) fn head(&mut self, at: u64) -> Result<([u8; 4], u64, u64), Error> {
        self.count += 1;
        if self.count > MOST_BLOCKS {
            return Err(self.damaged("its blocks lead in a circle"));
        }
        let head = self.bytes(at, HEAD)?;
        let word = |from: usize| {
            head[from..from + 8].iter().rev().fold(0, |all, it| all << 8 | u64::from(*it))
        };
        let (length, links) = (word(8), word(16));
        let inside = length >= HEAD && links <= (length - HEAD) / 8;
        if !inside || at.checked_add(length).is_none_or(|end| end > self.length) {
            return Err(self.damaged(&format!("the block at byte {at} does not fit into it")));
        }
        Ok(([head[0], head[1], head[2], head[3]], length, links))
    }

    /// So many bytes from there; they must be in the file.
    pub(super) fn bytes(&mut self, at: u64, count: u64) -> Result<Vec<u8>, Error> {
        if at.checked_add(count).is_none_or(|end| end > self.length) {
            return Err(self.damaged("the file ends"));
        }
        let mut bytes = vec![0; count as usize];
        let read = self.reader.seek(SeekFrom::Start(at));
        match read.and_then(|_| self.reader.read_exact(&mut bytes)) {
            Ok(()) => Ok(bytes),
            Err(source) if source.kind() == io::ErrorKind::UnexpectedEof => {
                Err(self.damaged("the file ends"))
            }
            Err(source) => Err(Error::Read { file: self.file.clone(), source }),
        }
    }

    /// The text of a text block, or of the element `TX` in a block of XML.
    pub(super) fn text(&mut self, at: u64) -> Result<String, Error> {
        if at == 0 {
            return Ok(String::new());
        }
        let (_, block) = self.any(at)?;
        let text = String::from_utf8_lossy(&block.data);
        let text = text.trim_end_matches('\0').trim();
        let inside = text.split_once("<TX>").and_then(|(_, rest)| rest.split_once("</TX>"));
        Ok(inside.map_or(text, |(text, _)| text).trim().to_owned())
    }

    pub(super) fn damaged(&self, what: &str) -> Error {
        let (file, what) = (self.file.clone(), what.to_owned());
        Error::Damaged { file, format: FORMAT.name, what }
    }
}
