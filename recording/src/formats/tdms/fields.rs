//! Single fields of a TDMS file's metadata: numbers in either order, texts, properties.

use std::io::{self, Read};

use super::FORMAT;
use super::object::Property;
use super::segments::Segments;
use super::values::Type;
use crate::error::Error;

/// Texts are no longer.
const LONGEST_TEXT: u32 = 1 << 20;

impl Segments {
    pub(super) fn property(&mut self) -> Result<Property, Error> {
        Ok(match self.kind()? {
            Type::Text => Property::Text(self.text()?),
            stored => {
                let mut value = [0; 16];
                let value = &mut value[..stored.size()];
                self.fill(value)?;
                match stored.no_number() {
                    None if stored != Type::TimeStamp => {
                        Property::Number(stored.value(value, self.big))
                    }
                    _ => Property::Other,
                }
            }
        })
    }

    pub(super) fn kind(&mut self) -> Result<Type, Error> {
        let code = self.u32()?;
        Type::of(code).ok_or_else(|| self.damaged("an unknown type of values"))
    }

    pub(super) fn text(&mut self) -> Result<String, Error> {
        let length = self.u32()?;
        if length > LONGEST_TEXT {
            return Err(self.damaged("a name is too long"));
        }
        let mut text = vec![0; length as usize];
        self.fill(&mut text)?;
        Ok(String::from_utf8_lossy(&text).into_owned())
    }

    pub(super) fn u32(&mut self) -> Result<u32, Error> {
        let bytes = self.bytes()?;
        Ok(if self.big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    pub(super) fn u64(&mut self) -> Result<u64, Error> {
        let bytes = self.bytes()?;
        Ok(if self.big { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) })
    }

    pub(super) fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Error> {
        let mut bytes = [0; N];
        self.fill(&mut bytes)?;
        Ok(bytes)
    }

    pub(super) fn fill(&mut self, bytes: &mut [u8]) -> Result<(), Error> {
        self.reader.read_exact(bytes).map_err(|it| self.broken(it))
    }

    pub(super) fn broken(&self, source: io::Error) -> Error {
        match source.kind() {
            io::ErrorKind::UnexpectedEof | io::ErrorKind::InvalidInput => {
                self.damaged("the file ends")
            }
            _ => Error::Read { file: self.file.clone(), source },
        }
    }

    pub(super) fn damaged(&self, what: &str) -> Error {
        let (file, what) = (self.file.clone(), what.to_owned());
        Error::Damaged { file, format: FORMAT.name, what }
    }
}
