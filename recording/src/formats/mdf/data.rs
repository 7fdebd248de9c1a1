//! The records of a data group: in one block or many, packed or not, of one channel group or,
//! each marked by a number before it, of several.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::blocks::{Blocks, HEAD};
use super::channel::ChannelGroup;
use crate::budget::{Budget, MOST_NUMBERS, NUMBER_BYTES};
use crate::error::Error;

/// Bytes of a packed block before its data: original mark, kind, parameter, two lengths.
const PACKED_HEAD: u64 = 24;
/// Bytes before the links to data in a list of blocks.
const NEXT_LIST: usize = 1;

/// Reads the records that start there into the groups' channels.
pub(super) fn read(
    blocks: &mut Blocks,
    data: u64,
    record_id: u8,
    groups: &mut [ChannelGroup],
    budget: &mut Budget,
) -> Result<(), Error> {
    let mut records = Records { record_id: record_id.into(), groups, rest: Vec::new() };
    let (mut next, mut lists) = (data, Vec::new());
    loop {
        if next == 0 {
            match lists.pop() {
                Some(address) => next = address,
                None => break,
            }
            continue;
        }
        let (mark, length, links) = blocks.head(next)?;
        match &mark {
            b"##DT" => {
                let count = length - HEAD - 8 * links;
                Budget::new("").take_bytes(count).map_err(|_| budget.too_large())?;
                let bytes = blocks.bytes(next + HEAD + 8 * links, count)?;
                records.take(blocks, &bytes, budget)?;
                next = 0;
            }
            b"##DZ" => {
                let bytes = unpacked(blocks, next, length, budget)?;
                records.take(blocks, &bytes, budget)?;
                next = 0;
            }
            b"##HL" => next = blocks.block(next, b"##HL")?.link(0),
            b"##DL" => {
                let list = blocks.block(next, b"##DL")?;
                let count = usize::try_from(list.u32(4)).unwrap_or(0);
                let data = list.links().iter().skip(NEXT_LIST).take(count);
                // The last one in comes out first.
                lists.push(list.link(0));
                lists.extend(data.rev());
                next = 0;
            }
            _ => return Err(blocks.damaged("a block that holds no records")),
        }
    }
    if records.rest.is_empty() { Ok(()) } else { Err(blocks.damaged("a record that ends early")) }
}

/// The data of a packed block.
fn unpacked(blocks: &mut Blocks, at: u64, length: u64, budget: &Budget) -> Result<Vec<u8>, Error> {
    if length < HEAD + PACKED_HEAD {
        return Err(blocks.damaged("a packed block is too short"));
    }
    let head = blocks.bytes(at + HEAD, PACKED_HEAD)?;
    let word = |from: usize, to: usize| {
        head[from..to].iter().rev().fold(0u64, |all, byte| all << 8 | u64::from(*byte))
    };
    let (kind, columns, original, packed) = (head[2], word(4, 8), word(8, 16), word(16, 24));
    if original > (MOST_NUMBERS * NUMBER_BYTES) as u64 {
        return Err(budget.too_large());
    }
    let packed = blocks.bytes(at + HEAD + PACKED_HEAD, packed.min(length - HEAD - PACKED_HEAD))?;
    let mut bytes = Vec::new();
    let read = ZlibDecoder::new(&packed[..]).take(original).read_to_end(&mut bytes);
    if read.is_err() || bytes.len() as u64 != original {
        return Err(blocks.damaged("packed data are damaged"));
    }
    match kind {
        0 => Ok(bytes),
        1 => Ok(transposed(&bytes, columns as usize)),
        _ => Err(blocks.damaged("packed in an unknown way")),
    }
}

/// Bytes that were stored column by column, `columns` bytes a row; a last, shorter row follows.
fn transposed(bytes: &[u8], columns: usize) -> Vec<u8> {
    let rows = bytes.len().checked_div(columns).unwrap_or(0);
    let whole = rows * columns;
    let mut transposed = Vec::with_capacity(bytes.len());
    for row in 0..rows {
        transposed.extend((0..columns).map(|column| bytes[column * rows + row]));
    }
    transposed.extend_from_slice(&bytes[whole..]);
    transposed
}

/// Splits bytes into records, which may span blocks.
struct Records<'a> {
    record_id: usize,
    groups: &'a mut [ChannelGroup],
    /// The begin of a record whose end is still to come.
    rest: Vec<u8>,
}

impl Records<'_> {
    fn take(&mut self, blocks: &Blocks, bytes: &[u8], budget: &mut Budget) -> Result<(), Error> {
        let mut joined = std::mem::take(&mut self.rest);
        let bytes = if joined.is_empty() {
            bytes
        } else {
            joined.extend_from_slice(bytes);
            &joined[..]
        };
        let mut from = 0;
        while let Some((group, start, end)) = self.next(blocks, bytes, from)? {
            let group = &mut self.groups[group];
            // More records than the group announces are not its own.
            if !group.channels.is_empty() && group.samples > 0 {
                budget.take(group.channels.len())?;
                group.samples -= 1;
                for channel in &mut group.channels {
                    channel.take(&bytes[start..end], group.bytes.0);
                }
            }
            from = end;
        }
        self.rest = bytes[from..].to_vec();
        Ok(())
    }

    /// The group of the record there, and where its bytes start and end; `None` where it is cut.
    fn next(
        &self,
        blocks: &Blocks,
        bytes: &[u8],
        from: usize,
    ) -> Result<Option<(usize, usize, usize)>, Error> {
        let little = |bytes: &[u8]| bytes.iter().rev().fold(0, |all, it| all << 8 | u64::from(*it));
        let mut start = from + self.record_id;
        let Some(id) = bytes.get(from..start).filter(|_| from < bytes.len()) else {
            return Ok(None);
        };
        let id = little(id);
        let mut groups = self.groups.iter();
        let position = match self.record_id {
            0 => Some(0),
            _ => groups.position(|it| it.record_id == id),
        };
        let Some((position, group)) = position.and_then(|k| Some((k, self.groups.get(k)?))) else {
            return Err(blocks.damaged("a record of no group"));
        };
        let length = if group.variable {
            start += 4;
            match bytes.get(start - 4..start) {
                Some(length) => little(length) as usize,
                None => return Ok(None),
            }
        } else {
            group.bytes.0 + group.bytes.1
        };
        let end = start.saturating_add(length);
        if end == from {
            return Err(blocks.damaged("records without a byte"));
        }
        Ok((end <= bytes.len()).then_some((position, start, end)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_back_from_columns() {
        assert_eq!(transposed(b"adbecfxy", 3), b"abcdefxy");
        assert_eq!(transposed(b"ab", 3), b"ab");
        assert_eq!(transposed(b"ab", 0), b"ab");
    }
}
