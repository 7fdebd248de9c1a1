//! One dataset of HDF5: its numbers, whatever type they are stored in.

use hdf5_reader::{ByteOrder, Dataset, Datatype};

use super::{Broken, Walk, beneath};
use crate::formats::tree::{KeyPath, Matrix, OBJECT};

/// Attributes that name a unit.
const UNITS: [&str; 5] = ["unit", "units", "Unit", "Units", "unit_string"];
/// References that one dataset may hold.
const MOST_REFERENCES: usize = 1000;
/// Bytes of a reference to an object.
const REFERENCE: usize = 8;

impl Walk<'_> {
    /// Adds a dataset under its path.
    pub(super) fn dataset(&mut self, dataset: &Dataset, path: KeyPath) -> Result<(), Broken> {
        self.object()?;
        let text = |name: &str| dataset.attribute(name).ok().and_then(|it| it.read_string().ok());
        let class = text("MATLAB_class").unwrap_or_default();
        if dataset.attribute("MATLAB_object_decode").is_ok() {
            self.tree.others.push((path, OBJECT));
            return Ok(());
        }
        let Some((rows, columns)) = sides(dataset.shape()) else {
            self.tree.others.push((path, "array of more than two dimensions"));
            return Ok(());
        };
        // MATLAB keeps the dimensions of an empty array where its values would stand.
        if rows * columns == 0 || dataset.attribute("MATLAB_empty").is_ok() {
            return Ok(());
        }
        match dataset.dtype() {
            Datatype::Reference { .. } => return self.referred(dataset, &path, rows * columns),
            Datatype::Compound { .. } => return self.compound(dataset, &path, rows * columns),
            Datatype::String { .. } | Datatype::VarLen { .. } => {
                let words = if rows * columns == 1 { dataset.read_string().ok() } else { None };
                match words {
                    Some(words) => self.tree.texts.push((path, words)),
                    None => self.tree.others.push((path, "list of texts")),
                }
                return Ok(());
            }
            _ => {}
        }
        let Some(number) = Number::of(dataset.dtype()) else {
            self.tree.others.push((path, "array of no real numbers"));
            return Ok(());
        };
        self.budget.take_table(rows, columns)?;
        let bytes = dataset.read_raw_bytes()?;
        let values: Vec<f64> = bytes.chunks_exact(number.size).map(|it| number.value(it)).collect();
        if class == "char" {
            let letters = values.iter().map(|code| char::from_u32(*code as u32).unwrap_or('?'));
            self.tree.texts.push((path, letters.collect()));
            return Ok(());
        }
        let unit = UNITS.iter().find_map(|name| text(name));
        self.tree.matrices.push(Matrix { path, unit, rows, columns, values });
        Ok(())
    }

    /// A column of each field of numbers.
    fn compound(&mut self, dataset: &Dataset, path: &KeyPath, rows: usize) -> Result<(), Broken> {
        let Datatype::Compound { size, fields } = dataset.dtype() else { return Ok(()) };
        let size = *size as usize;
        self.budget.take_bytes((rows as u64).saturating_mul(size as u64))?;
        self.budget.take_table(rows, fields.len())?;
        let bytes = dataset.read_raw_bytes()?;
        for field in fields {
            let (path, from) = (beneath(path, &field.name), field.byte_offset as usize);
            let number = Number::of(&field.datatype).filter(|it| from + it.size <= size);
            let Some(number) = number else {
                self.tree.others.push((path, "field of no numbers"));
                continue;
            };
            let records = bytes.chunks_exact(size.max(1));
            let values = records.map(|it| number.value(&it[from..from + number.size])).collect();
            self.tree.matrices.push(Matrix { path, unit: None, rows, columns: 1, values });
        }
        Ok(())
    }

    /// What references lead to: the elements of a cell array, or a field of every struct of an
    /// array, which is then named as that struct's field: `signals(2).values`.
    fn referred(&mut self, dataset: &Dataset, path: &KeyPath, count: usize) -> Result<(), Broken> {
        let Some(holder) = self.references.clone() else { return Ok(()) };
        if count > MOST_REFERENCES || path.len() > super::DEEPEST {
            self.tree.others.push((path.clone(), "large array of references"));
            return Ok(());
        }
        let class = dataset.attribute("MATLAB_class").and_then(|it| it.read_string());
        let cell = class.is_ok_and(|it| it == "cell");
        let bytes = dataset.read_raw_bytes()?;
        for (k, address) in bytes.chunks_exact(REFERENCE).enumerate() {
            let address = address.iter().rev().fold(0, |all, byte| all << 8 | u64::from(*byte));
            let Ok(Some(name)) = holder.child_name_by_address(address) else { continue };
            let mut path = path.clone();
            // A field's struct is the part before it.
            let fields = !cell && path.len() > 1;
            let at = path.len() - if fields { 2 } else { 1 };
            path[at] += &if fields { format!("({})", k + 1) } else { format!("{{{}}}", k + 1) };
            match (holder.dataset(&name), holder.group(&name)) {
                (Ok(dataset), _) => self.dataset(&dataset, path)?,
                (_, Ok(group)) => {
                    self.object()?;
                    self.group(&group, &path)?;
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// Rows and columns as MATLAB counts them; dimensions of one element do not count. `None` for
/// more than two.
fn sides(shape: &[u64]) -> Option<(usize, usize)> {
    let mut sides = shape.iter().filter(|side| **side != 1).map(|side| usize::try_from(*side).ok());
    match (sides.next(), sides.next(), sides.next()) {
        (None, ..) => Some((1, 1)),
        (Some(rows), None, _) => Some((rows?, 1)),
        // The last dimension runs fastest, as rows do in MATLAB.
        (Some(columns), Some(rows), None) => {
            let (rows, columns) = (rows?, columns?);
            rows.checked_mul(columns).map(|_| (rows, columns))
        }
        _ => None,
    }
}

/// How a number is stored.
#[derive(Clone, Copy)]
struct Number {
    size: usize,
    kind: Kind,
    big: bool,
}

#[derive(Clone, Copy)]
enum Kind {
    Float,
    Signed,
    Unsigned,
}

impl Number {
    fn of(stored: &Datatype) -> Option<Number> {
        let (size, kind, order) = match stored {
            Datatype::FloatingPoint { size, byte_order } => (*size, Kind::Float, byte_order),
            Datatype::FixedPoint { size, signed, byte_order } => {
                (*size, if *signed { Kind::Signed } else { Kind::Unsigned }, byte_order)
            }
            Datatype::Bitfield { size, byte_order } => (*size, Kind::Unsigned, byte_order),
            Datatype::Enum { base, .. } => return Number::of(base),
            _ => return None,
        };
        let known = match kind {
            Kind::Float => [4, 8].contains(&size),
            Kind::Signed | Kind::Unsigned => (1..=8).contains(&size),
        };
        let big = matches!(order, ByteOrder::BigEndian);
        known.then_some(Number { size: usize::from(size), kind, big })
    }

    fn value(self, bytes: &[u8]) -> f64 {
        let digit = |word: u64, byte: &u8| word << 8 | u64::from(*byte);
        let word = match self.big {
            true => bytes.iter().fold(0, digit),
            false => bytes.iter().rev().fold(0, digit),
        };
        match (self.kind, self.size) {
            (Kind::Float, 4) => f64::from(f32::from_bits(word as u32)),
            (Kind::Float, _) => f64::from_bits(word),
            (Kind::Unsigned, _) => word as f64,
            (Kind::Signed, size) => {
                let free = 64 - 8 * size as u32;
                ((word << free) as i64 >> free) as f64
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_size_and_order() {
        let number = |size, kind, big| Number { size, kind, big };
        assert_eq!(number(2, Kind::Signed, false).value(&[0xfe, 0xff]), -2.0);
        assert_eq!(number(2, Kind::Signed, true).value(&[0xff, 0xfe]), -2.0);
        assert_eq!(number(3, Kind::Unsigned, true).value(&[1, 0, 0]), 65536.0);
        assert_eq!(number(8, Kind::Signed, false).value(&(-7i64).to_le_bytes()), -7.0);
        assert_eq!(number(4, Kind::Float, true).value(&0.5f32.to_be_bytes()), 0.5);
        assert_eq!(number(8, Kind::Float, false).value(&(-0.1f64).to_le_bytes()), -0.1);
    }

    #[test]
    fn shapes_are_sides() {
        assert_eq!(sides(&[]), Some((1, 1)));
        assert_eq!(sides(&[1, 40]), Some((40, 1)));
        assert_eq!(sides(&[2, 40]), Some((40, 2)));
        assert_eq!(sides(&[2, 3, 4]), None);
        assert_eq!(sides(&[u64::MAX, 2]), None);
    }
}
