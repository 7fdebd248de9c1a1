//! The lines before the first sample: comments, the header, and what they tell of the dialect.

use std::io::Read;

use super::lines::{Fields, LineReader};
use super::rows::number;
use crate::error::Error;
use crate::place::Place;
use crate::unit::Unit;

/// What the header tells.
pub(super) struct Preamble {
    pub(super) header: Vec<String>,
    pub(super) delimiter: u8,
    /// Whether every row ends in a delimiter, as LabVIEW writes them.
    pub(super) trailing: bool,
}

impl Preamble {
    /// Reads up to the header.
    ///
    /// That is the first line that is no comment, unless it holds numbers below a comment that
    /// names as many columns (as `numpy.savetxt` writes it).
    pub(super) fn read<R: Read>(lines: &mut LineReader<R>) -> Result<Preamble, Error> {
        let mut comment: Option<(Place, Vec<u8>)> = None;
        loop {
            let file = lines.file().to_owned();
            let Some((_, line)) = lines.next()? else { return Err(Error::Empty { file }) };
            let line = line.to_vec();
            if let Some(text) = line.trim_ascii_start().strip_prefix(b"#") {
                comment = Some((lines.place(), text.to_vec()));
                continue;
            }
            let delimiter = delimiter(&line);
            let first = fields(&line, delimiter, &lines.place())?;
            if !first.iter().all(|field| number(field.as_bytes()).is_some()) {
                let mut preamble = Preamble::named(first, delimiter);
                preamble.take_units(lines)?;
                return Ok(preamble);
            }
            if let Some((place, text)) = comment {
                let names = fields(&text, delimiter, &place)?;
                if names.len() == first.len() {
                    lines.give_again();
                    return Ok(Preamble::named(names, delimiter));
                }
            }
            return Err(Error::NoHeader { place: lines.place() });
        }
    }

    fn named(mut header: Vec<String>, delimiter: u8) -> Preamble {
        let trailing = header.len() > 1 && header.last().is_some_and(String::is_empty);
        if trailing {
            header.pop();
        }
        for (k, name) in header.iter_mut().enumerate().filter(|(_, name)| name.is_empty()) {
            *name = format!("column {}", k + 1);
        }
        Preamble { header, delimiter, trailing }
    }

    /// A second line that holds nothing but units belongs to the header, as many loggers write it.
    fn take_units<R: Read>(&mut self, lines: &mut LineReader<R>) -> Result<(), Error> {
        let mut fields = Fields::new(self.delimiter);
        let Some((_, line)) = lines.next()? else { return Ok(()) };
        fields.split(line);
        let units: Vec<&str> = (0..self.header.len())
            .map_while(|k| std::str::from_utf8(fields.get(k)).ok())
            .map(|text| text.trim_matches(['[', ']', '(', ')']))
            .collect();
        let known = units.iter().all(|unit| Unit::parse(unit).is_some());
        let numbers = units.iter().any(|unit| number(unit.as_bytes()).is_some_and(f64::is_finite));
        if units.len() < self.header.len() || !known || numbers || units.concat().is_empty() {
            lines.give_again();
            return Ok(());
        }
        for (name, unit) in self.header.iter_mut().zip(units).filter(|(_, it)| !it.is_empty()) {
            *name = format!("{name} [{unit}]");
        }
        Ok(())
    }
}

/// Semicolon, tab or comma, in this order: a decimal comma may stand beside the first two.
fn delimiter(line: &[u8]) -> u8 {
    let mut quoted = false;
    let mut outside = line.to_vec();
    outside.retain(|byte| {
        quoted ^= *byte == b'"';
        !quoted
    });
    *b";\t".iter().find(|byte| outside.contains(byte)).unwrap_or(&b',')
}

fn fields(line: &[u8], delimiter: u8, place: &Place) -> Result<Vec<String>, Error> {
    let mut fields = Fields::new(delimiter);
    fields.split(line);
    (0..fields.len())
        .map(|k| {
            let field = fields.get(k);
            let bad = |byte| Error::NotUtf8 { place: place.clone(), position: k + 1, byte };
            match std::str::from_utf8(field) {
                Ok(text) if !text.contains('\0') => Ok(text.to_owned()),
                Ok(_) => Err(bad(0)),
                Err(error) => Err(bad(field[error.valid_up_to()])),
            }
        })
        .collect()
}
