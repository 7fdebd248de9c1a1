//! One variable of a MAT file of version 5: its values, or the variables in it.

use std::io::{self, Read};

use super::element::{Broken, number, small_element, tag, text_of, word};
use crate::budget::Budget;
use crate::formats::tree::{KeyPath, Matrix, OBJECT, Tree};

/// The type of an element that is a variable.
pub(super) const MATRIX: u32 = 14;
/// The class of objects.
const OPAQUE: u8 = 17;
/// A name is at most 63 characters in MATLAB; others write longer ones.
const LONGEST_NAME: u32 = 4096;
/// Field names of a struct, bytes.
const LONGEST_FIELDS: u32 = 1 << 20;
/// A label is no longer; other texts are passed over.
const LONGEST_TEXT: u32 = 1024;
/// Structs in structs.
const DEEPEST: usize = 16;
/// What an element of a struct or a cell array costs beside its values, in numbers.
const ELEMENT: usize = 32;
/// Bytes that are turned into numbers at a time; a multiple of every number's size.
const CHUNK: usize = 1 << 16;

/// What a struct or a cell array holds.
struct Held {
    /// Where it stands.
    path: KeyPath,
    /// How many elements, or structs.
    count: usize,
    depth: usize,
}

/// Puts variables where their names say.
pub(super) struct Parser<'a> {
    pub(super) tree: &'a mut Tree,
    pub(super) budget: &'a mut Budget,
}

impl Parser<'_> {
    /// Flags, dimensions, name, and the values or the elements in it; a variable inside another
    /// one has its path from there.
    pub(super) fn variable(
        &mut self,
        reader: &mut dyn Read,
        path: KeyPath,
        depth: usize,
    ) -> Result<(), Broken> {
        let flags = small_element(reader, 8)?;
        let dimensions = small_element(reader, 4 * 32)?;
        let name = small_element(reader, LONGEST_NAME)?;
        let [class, bits, ..] = flags[..] else { return Err(Broken::What("no flags")) };
        // An object has no dimensions: its name stands there, and here the name of its system.
        let name = text_of(if class == OPAQUE { &dimensions } else { &name });
        if path.is_empty() && name.is_empty() {
            // MATLAB's own workspace, in which its objects lie.
            return Ok(());
        }
        let path = if path.is_empty() { vec![name] } else { path };
        let lengths: Vec<usize> =
            dimensions.chunks_exact(4).map(|it| word(it, 0) as usize).collect();
        let elements = lengths.iter().try_fold(1usize, |all, it| all.checked_mul(*it));
        let elements = elements.ok_or(Broken::What("impossible dimensions"))?;
        let other = match class {
            1 if depth < DEEPEST => {
                return self.cells(reader, &Held { path, count: elements, depth });
            }
            2 if depth < DEEPEST => {
                return self.fields(reader, &Held { path, count: elements, depth });
            }
            4 => return self.text(reader, path),
            1 => "cell array",
            2 => "struct",
            3 => OBJECT,
            5 => "sparse matrix",
            6..=15 if bits & 0x08 != 0 => "complex matrix",
            6..=15 if lengths.len() != 2 => "matrix of more than two dimensions",
            6..=15 => {
                let (rows, columns) = (lengths[0], lengths[1]);
                let values = self.numbers(reader)?;
                if elements != values.len() {
                    return Err(Broken::What("dimensions and number of values differ"));
                }
                self.tree.matrices.push(Matrix { path, unit: None, rows, columns, values });
                return Ok(());
            }
            16 => "function",
            _ => OBJECT,
        };
        self.tree.others.push((path, other));
        Ok(())
    }

    /// A struct, or every struct of an array: the fields' names, then their elements.
    fn fields(&mut self, reader: &mut dyn Read, held: &Held) -> Result<(), Broken> {
        let Held { path, count, depth } = held;
        let length = small_element(reader, 4)?;
        let length = word(&length, 0) as usize;
        let names = small_element(reader, LONGEST_FIELDS)?;
        if length == 0 {
            return Ok(());
        }
        let names: Vec<String> = names.chunks_exact(length).map(text_of).collect();
        for k in 0..if names.is_empty() { 0 } else { *count } {
            let holder =
                if *count == 1 { path.clone() } else { numbered(path, &format!("({})", k + 1)) };
            for name in &names {
                let path = holder.iter().chain([name]).cloned().collect();
                self.nested(reader, path, *depth)?;
            }
        }
        Ok(())
    }

    fn cells(&mut self, reader: &mut dyn Read, held: &Held) -> Result<(), Broken> {
        for k in 0..held.count {
            let path = numbered(&held.path, &format!("{{{}}}", k + 1));
            self.nested(reader, path, held.depth)?;
        }
        Ok(())
    }

    /// An element of a struct or a cell array.
    fn nested(&mut self, reader: &mut dyn Read, path: KeyPath, depth: usize) -> Result<(), Broken> {
        self.budget.take(ELEMENT)?;
        let (kind, bytes, _) = tag(reader)?;
        if kind != MATRIX {
            return Err(Broken::What("a struct holds no variable"));
        }
        if bytes == 0 {
            return Ok(());
        }
        let mut element = reader.take(u64::from(bytes));
        self.variable(&mut element, path, depth + 1)?;
        io::copy(&mut element, &mut io::sink())?;
        Ok(())
    }

    fn text(&mut self, reader: &mut dyn Read, path: KeyPath) -> Result<(), Broken> {
        let (kind, bytes, inside) = tag(reader)?;
        let data = match inside {
            Some(inside) => inside[..bytes as usize].to_vec(),
            None if bytes <= LONGEST_TEXT => {
                let mut data = vec![0; bytes as usize];
                reader.read_exact(&mut data)?;
                data
            }
            None => Vec::new(),
        };
        let text = match kind {
            // Stored as numbers of two bytes, or as UTF-16.
            4 | 17 => {
                let units = data.chunks_exact(2).map(|it| u16::from_le_bytes([it[0], it[1]]));
                char::decode_utf16(units).map(|it| it.unwrap_or('?')).collect()
            }
            _ => text_of(&data),
        };
        self.tree.texts.push((path, text));
        Ok(())
    }

    /// The values' element, whatever type they are stored in: MATLAB stores doubles that are small
    /// integers in a byte each.
    fn numbers(&mut self, reader: &mut dyn Read) -> Result<Vec<f64>, Broken> {
        let (kind, bytes, inside) = tag(reader)?;
        let size = match kind {
            1 | 2 => 1,
            3 | 4 => 2,
            5..=7 => 4,
            9 | 12 | 13 => 8,
            _ => return Err(Broken::What("values of an unknown type")),
        };
        self.budget.take(bytes as usize / size)?;
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
}

/// The path of one of many elements, as MATLAB writes it.
fn numbered(path: &KeyPath, which: &str) -> KeyPath {
    let mut path = path.clone();
    if let Some(last) = path.last_mut() {
        last.push_str(which);
    }
    path
}
