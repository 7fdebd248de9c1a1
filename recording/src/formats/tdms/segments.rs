//! The structure of a TDMS file: segments, the objects in them, their raw data.
//!
//! A segment is a lead-in of 28 bytes, metadata (objects with properties and the layout of their
//! raw data) and raw data: chunks that each hold so many values of every channel, channel after
//! channel or, interleaved, row after row. What a segment does not say again holds as in the one
//! before. Source: National Instruments, "TDMS File Format Internal Structure".

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufReader, Seek, SeekFrom};

use super::object::{Object, names};
use super::values::Type;
use crate::budget::Budget;
use crate::error::Error;

pub(super) const MARK: &[u8] = b"TDSm";
const LEAD_IN: u64 = 28;
/// The end of a segment that was not closed: the file's.
const OPEN_END: u64 = u64::MAX;
const HAS_METADATA: u32 = 1 << 1;
const NEW_OBJECTS: u32 = 1 << 2;
const HAS_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;
const DAQMX: u32 = 1 << 7;
/// Objects and properties of a file.
const MOST_OBJECTS: usize = 100_000;
/// What a property costs, in numbers.
const PROPERTY: usize = 16;

/// Reads a file segment by segment.
pub(super) struct Segments {
    pub(super) reader: BufReader<File>,
    pub(super) file: String,
    length: u64,
    objects: Vec<Object>,
    by_path: HashMap<String, usize>,
    /// Channels with raw data in the segment, in order.
    active: Vec<usize>,
    pub(super) big: bool,
}

impl Segments {
    pub(super) fn new(opened: File, file: &str) -> Result<Segments, Error> {
        let failed = |source| Error::Read { file: file.to_owned(), source };
        let length = opened.metadata().map_err(failed)?.len();
        Ok(Segments {
            reader: BufReader::new(opened),
            file: file.to_owned(),
            length,
            objects: Vec::new(),
            by_path: HashMap::new(),
            active: Vec::new(),
            big: false,
        })
    }

    /// All objects with their values.
    pub(super) fn read(mut self, budget: &mut Budget) -> Result<Vec<Object>, Error> {
        let mut at = 0;
        while at + LEAD_IN <= self.length {
            at = self.segment(at, budget)?;
        }
        Ok(self.objects)
    }

    /// Reads the segment that starts there; where the next one starts.
    fn segment(&mut self, at: u64, budget: &mut Budget) -> Result<u64, Error> {
        self.reader.seek(SeekFrom::Start(at)).map_err(|it| self.broken(it))?;
        if self.bytes::<4>()? != *MARK {
            return Err(self.damaged("no segment"));
        }
        let flags = u32::from_le_bytes(self.bytes()?);
        self.big = flags & BIG_ENDIAN != 0;
        let _version = self.u32()?;
        let (next, raw) = (self.u64()?, self.u64()?);
        if flags & DAQMX != 0 {
            return Err(Error::Variety {
                file: self.file.clone(),
                what: "a TDMS file of raw DAQmx data".to_owned(),
                instead: "log it as scaled data in LabVIEW",
            });
        }
        let start = at + LEAD_IN;
        let end = match next {
            OPEN_END => self.length,
            next => start.saturating_add(next).min(self.length),
        };
        if flags & NEW_OBJECTS != 0 {
            self.active.clear();
        }
        if flags & HAS_METADATA != 0 {
            self.metadata(budget)?;
        }
        let data = start.saturating_add(raw);
        if flags & HAS_DATA != 0 && data < end {
            self.reader.seek(SeekFrom::Start(data)).map_err(|it| self.broken(it))?;
            self.raw_data(end - data, flags & INTERLEAVED != 0, budget)?;
        }
        if end <= at { Err(self.damaged("a segment without end")) } else { Ok(end) }
    }

    fn metadata(&mut self, budget: &mut Budget) -> Result<(), Error> {
        for _ in 0..self.u32()? {
            let text = self.text()?;
            budget.take(PROPERTY)?;
            let index = match self.by_path.get(&text) {
                Some(index) => *index,
                None => {
                    let path = names(&text);
                    self.objects.push(Object { path, ..Object::default() });
                    self.by_path.insert(text, self.objects.len() - 1);
                    self.objects.len() - 1
                }
            };
            if self.objects.len() > MOST_OBJECTS {
                return Err(budget.too_large());
            }
            self.layout(index)?;
            for _ in 0..self.u32()? {
                budget.take(PROPERTY)?;
                let name = self.text()?;
                let value = self.property()?;
                self.objects[index].properties.insert(name, value);
            }
        }
        Ok(())
    }

    /// How an object's raw data lie: not at all, as before, or as said here.
    fn layout(&mut self, index: usize) -> Result<(), Error> {
        match self.u32()? {
            u32::MAX => {
                self.active.retain(|it| *it != index);
                return Ok(());
            }
            0 => {}
            _ => {
                let stored = self.kind()?;
                let _dimensions = self.u32()?;
                let count = self.u64()?;
                let bytes = if stored == Type::Text { Some(self.u64()?) } else { None };
                let object = &mut self.objects[index];
                if object.stored.is_some_and(|before| before != stored) {
                    return Err(self.damaged("a channel changes its type"));
                }
                (object.stored, object.chunk) = (Some(stored), (count, bytes));
            }
        }
        if !self.active.contains(&index) {
            self.active.push(index);
        }
        Ok(())
    }

    /// As many chunks as there are bytes for.
    fn raw_data(
        &mut self,
        bytes: u64,
        interleaved: bool,
        budget: &mut Budget,
    ) -> Result<(), Error> {
        let active = std::mem::take(&mut self.active);
        let chunk =
            active.iter().fold(0u64, |all, k| all.saturating_add(self.objects[*k].chunk_bytes()));
        let read = match chunk {
            0 => Ok(()),
            _ if interleaved => self.rows(&active, bytes, budget),
            _ => (0..bytes / chunk)
                .try_for_each(|_| active.iter().try_for_each(|k| self.channel(*k, budget))),
        };
        self.active = active;
        read
    }

    /// A chunk of one channel.
    fn channel(&mut self, index: usize, budget: &mut Budget) -> Result<(), Error> {
        let object = &self.objects[index];
        let Some(stored) = object.stored.filter(|it| it.no_number().is_none()) else {
            let bytes = i64::try_from(object.chunk_bytes()).unwrap_or(i64::MAX);
            return self.reader.seek_relative(bytes).map_err(|it| self.broken(it));
        };
        let count = usize::try_from(object.chunk.0).map_err(|_| budget.too_large())?;
        budget.take(count)?;
        let mut value = [0; 16];
        let value = &mut value[..stored.size()];
        for _ in 0..count {
            self.fill(value)?;
            let number = stored.value(value, self.big);
            self.objects[index].values.push(number);
        }
        Ok(())
    }

    /// One value of every channel after the other.
    fn rows(&mut self, active: &[usize], bytes: u64, budget: &mut Budget) -> Result<(), Error> {
        let stored: Vec<(usize, Type)> =
            active.iter().filter_map(|k| Some((*k, self.objects[*k].stored?))).collect();
        let width: usize = stored.iter().map(|(_, it)| it.size()).sum();
        if width == 0 || stored.iter().any(|(_, it)| *it == Type::Text) {
            return Err(self.damaged("interleaved texts"));
        }
        let rows = bytes / width as u64;
        let rows = usize::try_from(rows).map_err(|_| budget.too_large())?;
        budget.take_table(rows, stored.len())?;
        let mut row = vec![0; width];
        for _ in 0..rows {
            self.fill(&mut row)?;
            let mut from = 0;
            for (k, stored) in &stored {
                let value = &row[from..from + stored.size()];
                from += stored.size();
                if stored.no_number().is_none() {
                    self.objects[*k].values.push(stored.value(value, self.big));
                }
            }
        }
        Ok(())
    }
}
