//! Channel groups and their channels: where a value lies in a record, and what it means.

use super::blocks::{Block, Blocks};
use super::conversion::Conversion;
use crate::error::Error;

/// Channels that are structures of channels.
const DEEPEST: usize = 8;
const ALL_INVALID: u32 = 1;
const CAN_BE_INVALID: u32 = 1 << 1;
const VARIABLE_LENGTH: u16 = 1;
const REMOTE_MASTER: u16 = 1 << 3;

/// Channels that are sampled together.
#[derive(Debug)]
pub(super) struct ChannelGroup {
    pub(super) name: String,
    pub(super) record_id: u64,
    pub(super) samples: u64,
    /// Bytes of a record, and of its flags of what is invalid.
    pub(super) bytes: (usize, usize),
    /// Whether records have their own lengths and hold no channels.
    pub(super) variable: bool,
    pub(super) channels: Vec<Channel>,
    pub(super) left_out: Vec<String>,
}

/// A channel of numbers.
#[derive(Debug)]
pub(super) struct Channel {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) is_time: bool,
    pub(super) values: Vec<f64>,
    conversion: Conversion,
    kind: Kind,
    big: bool,
    /// First byte in the record, first bit in it, bits.
    place: (usize, u32, u32),
    /// The flag that says a value is invalid.
    flag: Option<usize>,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Unsigned,
    Signed,
    Float,
    /// Not stored: the number of the record.
    Counted,
}

/// The chain of channel groups that starts there.
pub(super) fn groups(blocks: &mut Blocks, first: u64) -> Result<Vec<ChannelGroup>, Error> {
    let (mut groups, mut next) = (Vec::new(), first);
    while next != 0 {
        let block = blocks.block(next, b"##CG")?;
        let flags = block.u16(16);
        let mut name = blocks.text(block.link(2))?;
        if name.is_empty() {
            name = blocks.text(block.link(5))?;
        }
        if name.is_empty() {
            name = format!("group {}", groups.len() + 1);
        }
        let mut group = ChannelGroup {
            name,
            record_id: block.u64(0),
            samples: block.u64(8),
            bytes: (block.u32(24) as usize, block.u32(28) as usize),
            variable: flags & VARIABLE_LENGTH != 0,
            channels: Vec::new(),
            left_out: Vec::new(),
        };
        if flags & REMOTE_MASTER != 0 {
            group.left_out.push(format!("channel group `{}` is stored by columns", group.name));
        } else if !group.variable {
            group.channels(blocks, block.link(1), 0)?;
        }
        groups.push(group);
        next = block.link(0);
    }
    Ok(groups)
}

impl ChannelGroup {
    /// The chain of channels that starts there.
    fn channels(&mut self, blocks: &mut Blocks, first: u64, depth: usize) -> Result<(), Error> {
        let mut next = first;
        while next != 0 {
            let block = blocks.block(next, b"##CN")?;
            next = block.link(0);
            let name = blocks.text(block.link(2))?;
            let inner = block.link(1);
            if inner != 0 {
                if depth < DEEPEST && &blocks.head(inner)?.0 == b"##CN" {
                    self.channels(blocks, inner, depth + 1)?;
                } else {
                    self.leave_out(&name, "an array");
                }
                continue;
            }
            match Channel::of(blocks, &block, name.clone())? {
                Ok(channel) if channel.fits(self.bytes) => self.channels.push(channel),
                Ok(_) => return Err(blocks.damaged("a channel lies outside its record")),
                Err(why) => self.leave_out(&name, why),
            }
        }
        Ok(())
    }

    fn leave_out(&mut self, name: &str, why: &str) {
        self.left_out.push(format!("channel `{name}` of `{}` is {why}", self.name));
    }
}

impl Channel {
    /// The channel, or what it is instead of numbers.
    fn of(
        blocks: &mut Blocks,
        block: &Block,
        name: String,
    ) -> Result<Result<Channel, &'static str>, Error> {
        let (kind, stored) = (block.byte(0), block.byte(2));
        // Synchronised by time; others by angle, distance or number.
        let is_time = matches!(kind, 2 | 3) && block.byte(1) == 1;
        let bits = block.u32(8);
        let (number, big) = match (kind, stored) {
            (3 | 6, _) => (Kind::Counted, false),
            (1 | 4 | 5, _) => return Ok(Err("no series of numbers")),
            (_, 0 | 1) if (1..=64).contains(&bits) => (Kind::Unsigned, stored == 1),
            (_, 2 | 3) if (1..=64).contains(&bits) => (Kind::Signed, stored == 3),
            (_, 4 | 5) if matches!(bits, 32 | 64) => (Kind::Float, stored == 5),
            _ => return Ok(Err("no series of numbers")),
        };
        let Some((conversion, converted_unit)) = Conversion::read(blocks, block.link(4))? else {
            return Ok(Err("converted by a formula, which is not read"));
        };
        let own = blocks.text(block.link(6))?;
        let unit = match (own.is_empty(), is_time) {
            (true, true) if converted_unit.is_empty() => "s".to_owned(),
            (true, _) => converted_unit,
            _ => own,
        };
        let flags = block.u32(12);
        let flag = match flags {
            _ if flags & ALL_INVALID != 0 => return Ok(Err("invalid throughout")),
            _ if flags & CAN_BE_INVALID != 0 => Some(block.u32(16) as usize),
            _ => None,
        };
        let place = (block.u32(4) as usize, u32::from(block.byte(3)), bits);
        let values = Vec::new();
        Ok(Ok(Channel { name, unit, is_time, values, conversion, kind: number, big, place, flag }))
    }

    fn fits(&self, (bytes, flags): (usize, usize)) -> bool {
        let inside = self.flag.is_none_or(|bit| bit / 8 < flags);
        let (from, bit, bits) = self.place;
        let stored = !matches!(self.kind, Kind::Counted);
        let end = from.saturating_add((bit + bits).div_ceil(8) as usize);
        inside && bit < 8 && (!stored || end <= bytes)
    }

    /// Adds the value in a record; flags of what is invalid follow the record's `bytes`.
    pub(super) fn take(&mut self, record: &[u8], bytes: usize) {
        let invalid =
            |bit: usize| record.get(bytes + bit / 8).is_some_and(|it| it >> (bit % 8) & 1 == 1);
        let value = match self.flag {
            Some(bit) if invalid(bit) => f64::NAN,
            _ => self.conversion.physical(self.raw(record)),
        };
        self.values.push(value);
    }

    fn raw(&self, record: &[u8]) -> f64 {
        let (from, bit, bits) = self.place;
        if matches!(self.kind, Kind::Counted) {
            return self.values.len() as f64;
        }
        let bytes = &record[from..from + (bit + bits).div_ceil(8) as usize];
        let digit = |word: u128, byte: &u8| word << 8 | u128::from(*byte);
        let word = match self.big {
            true => bytes.iter().fold(0, digit),
            false => bytes.iter().rev().fold(0, digit),
        };
        let word = (word >> bit) as u64;
        let free = 64 - bits;
        match self.kind {
            Kind::Float if bits == 32 => f64::from(f32::from_bits(word as u32)),
            Kind::Float => f64::from_bits(word),
            Kind::Signed => ((word << free) as i64 >> free) as f64,
            Kind::Unsigned | Kind::Counted => (word << free >> free) as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raw(kind: Kind, big: bool, place: (usize, u32, u32), record: &[u8]) -> f64 {
        let (name, unit, values) = (String::new(), String::new(), Vec::new());
        let (is_time, conversion, flag) = (false, Conversion::Same, None);
        Channel { name, unit, is_time, values, conversion, kind, big, place, flag }.raw(record)
    }

    #[test]
    fn values_may_begin_at_any_bit() {
        assert_eq!(raw(Kind::Unsigned, false, (1, 4, 8), &[0, 0xf0, 0x0a]), f64::from(0xaf));
        assert_eq!(raw(Kind::Signed, false, (0, 0, 12), &[0xfe, 0x0f]), -2.0);
        assert_eq!(raw(Kind::Signed, true, (0, 0, 16), &[0xff, 0xfe]), -2.0);
        assert_eq!(raw(Kind::Float, true, (0, 0, 32), &1.5f32.to_be_bytes()), 1.5);
        assert_eq!(raw(Kind::Unsigned, false, (0, 3, 64), &[0xff; 9]), u64::MAX as f64);
    }
}
