//! The Arrow schema of a table, as readers of Arrow look for it in a Parquet file: base64 of an
//! encapsulated message, whose fields carry unit and description as metadata.
//!
//! Sources: Apache Arrow format 1.5, Schema.fbs and Message.fbs; FlatBuffers binary format. Written
//! by hand: the crates of Arrow would multiply what is built for these few tables.

use super::{Column, Values};

/// Numbers of Message.fbs and Schema.fbs.
const VERSION_5: i16 = 4;
const HEADER_SCHEMA: u8 = 1;
const INT: u8 = 2;
const FLOATING_POINT: u8 = 3;
const UTF_8: u8 = 5;
const BOOL: u8 = 6;
const DOUBLE: i16 = 2;

/// The schema as the value of `ARROW:schema`.
pub(super) fn schema(columns: &[Column]) -> String {
    let mut out = Buffer(vec![0; 4]);
    let header = [Slot::Short(VERSION_5), Slot::Byte(HEADER_SCHEMA), Slot::Offset, Slot::Long(0)];
    let message = out.table(&header);
    out.point(0, message.at);
    let schema = out.table(&[Slot::Short(0), Slot::Offset]);
    out.point(message.slots[2], schema.at);
    let fields = out.vector(columns.len());
    out.point(schema.slots[1], fields.at);
    for (column, place) in columns.iter().zip(fields.slots) {
        let at = field(&mut out, column);
        out.point(place, at);
    }
    out.align(8, 0);
    let Buffer(body) = out;
    let mut message = vec![0xFF; 4];
    message.extend((body.len() as u32).to_le_bytes());
    message.extend(body);
    base64(&message)
}

fn field(out: &mut Buffer, column: &Column) -> usize {
    let (kind, nullable, slots): (u8, u8, &[Slot]) = match column.values {
        Values::Integers(_) => (INT, 0, &[Slot::Int(64), Slot::Byte(1)]),
        Values::Numbers(_) => (FLOATING_POINT, 1, &[Slot::Short(DOUBLE)]),
        Values::Flags(_) => (BOOL, 1, &[]),
        Values::Texts(_) => (UTF_8, 0, &[]),
    };
    let own = [
        Slot::Offset,
        Slot::Byte(nullable),
        Slot::Byte(kind),
        Slot::Offset,
        Slot::None,
        Slot::Offset,
        Slot::Offset,
    ];
    let field = out.table(&own);
    let name = out.text(&column.name);
    out.point(field.slots[0], name);
    let kind = out.table(slots);
    out.point(field.slots[3], kind.at);
    let children = out.vector(0);
    out.point(field.slots[5], children.at);
    let said = [("unit", &column.unit), ("description", &column.description)];
    let pairs = out.vector(said.len());
    out.point(field.slots[6], pairs.at);
    for ((key, value), place) in said.into_iter().zip(pairs.slots) {
        let pair = out.table(&[Slot::Offset, Slot::Offset]);
        out.point(place, pair.at);
        for (text, place) in [key, value].into_iter().zip(pair.slots) {
            let at = out.text(text);
            out.point(place, at);
        }
    }
    field.at
}

/// A field of a table, or its absence.
#[derive(Clone, Copy)]
enum Slot {
    None,
    Byte(u8),
    Short(i16),
    Int(i32),
    Long(i64),
    Offset,
}

/// A table or a vector, and the places of its fields.
struct Placed {
    at: usize,
    slots: Vec<usize>,
}

/// A FlatBuffer that is written from its root on: offsets point forwards.
struct Buffer(Vec<u8>);

impl Buffer {
    /// Zeros up to where the length is `rest` beyond a multiple.
    fn align(&mut self, to: usize, rest: usize) {
        while self.0.len() % to != rest {
            self.0.push(0);
        }
    }

    /// Lets the offset at `place` point to `to`.
    fn point(&mut self, place: usize, to: usize) {
        let offset = (to - place) as u32;
        self.0[place..place + 4].copy_from_slice(&offset.to_le_bytes());
    }

    /// Every field has eight bytes, at a multiple of eight.
    fn table(&mut self, fields: &[Slot]) -> Placed {
        let present = fields.iter().filter(|it| !matches!(it, Slot::None)).count();
        self.align(2, 0);
        // The table lies four bytes before a multiple of eight.
        let vtable = 4 + 2 * fields.len();
        while (self.0.len() + vtable) % 8 != 4 {
            self.0.extend([0, 0]);
        }
        let begin = self.0.len();
        self.0.extend((vtable as u16).to_le_bytes());
        self.0.extend((4 + 8 * present as u16).to_le_bytes());
        let mut next = 4u16;
        for field in fields {
            let offset = if matches!(field, Slot::None) { 0 } else { next };
            self.0.extend(offset.to_le_bytes());
            next += if offset == 0 { 0 } else { 8 };
        }
        let at = self.0.len();
        self.0.extend(((at - begin) as i32).to_le_bytes());
        let mut slots = Vec::new();
        for field in fields {
            slots.push(self.0.len());
            let value: [u8; 8] = match *field {
                Slot::None => continue,
                Slot::Byte(value) => u64::from(value).to_le_bytes(),
                Slot::Short(value) => u64::from(value as u16).to_le_bytes(),
                Slot::Int(value) => u64::from(value as u32).to_le_bytes(),
                Slot::Long(value) => value.to_le_bytes(),
                Slot::Offset => [0; 8],
            };
            self.0.extend(value);
        }
        Placed { at, slots }
    }

    /// A vector of offsets.
    fn vector(&mut self, count: usize) -> Placed {
        self.align(4, 0);
        let at = self.0.len();
        self.0.extend((count as u32).to_le_bytes());
        let slots = (0..count).map(|k| at + 4 + 4 * k).collect();
        self.0.extend(std::iter::repeat_n(0, 4 * count));
        Placed { at, slots }
    }

    fn text(&mut self, text: &str) -> usize {
        self.align(4, 0);
        let at = self.0.len();
        self.0.extend((text.len() as u32).to_le_bytes());
        self.0.extend(text.as_bytes());
        self.0.push(0);
        at
    }
}

/// RFC 4648, with padding.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let at = |k: usize| u32::from(three.get(k).copied().unwrap_or(0));
        let word = at(0) << 16 | at(1) << 8 | at(2);
        for k in 0..4 {
            let letter = LETTERS[(word >> (18 - 6 * k) & 63) as usize];
            text.push(if k <= three.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_those_of_the_standard() {
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn a_table_holds_what_its_offsets_say() {
        let mut out = Buffer(vec![0; 4]);
        let table = out.table(&[Slot::Int(7), Slot::None, Slot::Offset]);
        assert_eq!(table.at % 8, 4);
        let text = out.text("unit");
        out.point(table.slots[2], text);
        let word = |at: usize| u32::from_le_bytes(out.0[at..at + 4].try_into().expect("four"));
        let vtable = table.at - word(table.at) as usize;
        let short = |at: usize| u16::from_le_bytes(out.0[at..at + 2].try_into().expect("two"));
        let offsets: Vec<u16> = (0..3).map(|k| short(vtable + 4 + 2 * k)).collect();
        assert_eq!((short(vtable), offsets), (10, vec![4, 0, 12]));
        assert_eq!(word(table.at + 4), 7);
        let place = table.at + 12;
        assert_eq!(place + word(place) as usize, text);
        assert_eq!(&out.0[text + 4..text + 9], b"unit\0");
    }
}
