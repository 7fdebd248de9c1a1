//! What a run remembers, as bytes: an FMU saves it, and another process goes on from there.
//!
//! One walk over the fields both saves and restores them, so that the two cannot disagree. Models,
//! limits and designs are not walked: a run is restored into one that was made of the same diagnoser.

use std::collections::VecDeque;

use thiserror::Error;

/// Bytes that are no memory of such a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("these bytes are not the memory of a run of this diagnoser")]
pub struct MemoryError;

/// A walk over what is remembered.
#[derive(Debug)]
pub struct Walk<'a>(Direction<'a>);

#[derive(Debug)]
enum Direction<'a> {
    Save(&'a mut Vec<u8>),
    Restore(&'a [u8]),
}

/// Something that is remembered.
pub trait Memory {
    /// Hands every field to the walk, always in the same order.
    ///
    /// # Errors
    /// Bytes that are no such memory; what is walked is then to be thrown away.
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError>;
}

impl Walk<'_> {
    /// Whether values are read and not written.
    pub fn restores(&self) -> bool {
        matches!(self.0, Direction::Restore(_))
    }

    fn word(&mut self, value: u64) -> Result<u64, MemoryError> {
        match &mut self.0 {
            Direction::Save(bytes) => {
                bytes.extend(value.to_le_bytes());
                Ok(value)
            }
            Direction::Restore(bytes) => {
                let (word, rest) = bytes.split_first_chunk::<8>().ok_or(MemoryError)?;
                *bytes = rest;
                Ok(u64::from_le_bytes(*word))
            }
        }
    }

    /// A number that stays below a bound: a place in a list, a choice.
    ///
    /// # Errors
    /// Another number.
    pub fn below(&mut self, value: &mut usize, bound: usize) -> Result<(), MemoryError> {
        value.walk(self)?;
        if *value < bound { Ok(()) } else { Err(MemoryError) }
    }

    /// As many values as there are.
    ///
    /// # Errors
    /// As [`Memory::walk`].
    pub fn each<'b, T: Memory + 'b>(
        &mut self,
        values: impl IntoIterator<Item = &'b mut T>,
    ) -> Result<(), MemoryError> {
        values.into_iter().try_for_each(|value| value.walk(self))
    }

    /// A list that grows and shrinks, of `most` values at most; new ones begin as `blank`.
    ///
    /// # Errors
    /// As [`Memory::walk`].
    pub fn list<T: Memory>(
        &mut self,
        values: &mut VecDeque<T>,
        most: usize,
        blank: impl FnMut() -> T,
    ) -> Result<(), MemoryError> {
        let mut count = values.len();
        count.walk(self)?;
        if self.restores() {
            if count > most {
                return Err(MemoryError);
            }
            values.clear();
            values.resize_with(count, blank);
        }
        self.each(values)
    }

    /// A value that may be missing; a new one begins as `blank`.
    ///
    /// # Errors
    /// As [`Memory::walk`].
    pub fn maybe<T: Memory>(
        &mut self,
        value: &mut Option<T>,
        blank: impl FnOnce() -> T,
    ) -> Result<(), MemoryError> {
        let mut there = value.is_some();
        there.walk(self)?;
        if self.restores() {
            *value = there.then(blank);
        }
        value.as_mut().map_or(Ok(()), |value| value.walk(self))
    }
}

/// The memory of a run.
pub fn remember(run: &mut impl Memory) -> Vec<u8> {
    let mut bytes = Vec::new();
    // Writing into a vector fails nowhere.
    let _ = run.walk(&mut Walk(Direction::Save(&mut bytes)));
    bytes
}

/// Goes on from that memory.
///
/// # Errors
/// Bytes of something else; the run is then to be thrown away.
pub fn recall(run: &mut impl Memory, bytes: &[u8]) -> Result<(), MemoryError> {
    let mut walk = Walk(Direction::Restore(bytes));
    run.walk(&mut walk)?;
    match walk.0 {
        Direction::Restore([]) => Ok(()),
        _ => Err(MemoryError),
    }
}

impl Memory for usize {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        *self = walk.word(*self as u64)? as usize;
        Ok(())
    }
}

impl Memory for f64 {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        *self = Self::from_bits(walk.word(self.to_bits())?);
        Ok(())
    }
}

impl Memory for f32 {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        *self = Self::from_bits(walk.word(self.to_bits().into())? as u32);
        Ok(())
    }
}

impl Memory for bool {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        *self = walk.word(u64::from(*self))? != 0;
        Ok(())
    }
}

impl Memory for String {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        let mut count = self.len();
        count.walk(walk)?;
        match &mut walk.0 {
            Direction::Save(bytes) => bytes.extend(self.as_bytes()),
            Direction::Restore(bytes) => {
                let (text, rest) = bytes.split_at_checked(count).ok_or(MemoryError)?;
                *self = std::str::from_utf8(text).map_err(|_| MemoryError)?.to_owned();
                *bytes = rest;
            }
        }
        Ok(())
    }
}

impl<T: Memory, const N: usize> Memory for [T; N] {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        walk.each(self)
    }
}

impl<A: Memory, B: Memory> Memory for (A, B) {
    fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
        self.0.walk(walk)?;
        self.1.walk(walk)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Clone, PartialEq, Default)]
    struct Run {
        name: String,
        last: VecDeque<f64>,
        size: Option<[f64; 2]>,
        standing: bool,
    }

    impl Memory for Run {
        fn walk(&mut self, walk: &mut Walk) -> Result<(), MemoryError> {
            self.name.walk(walk)?;
            walk.list(&mut self.last, 3, || 0.0)?;
            walk.maybe(&mut self.size, || [0.0; 2])?;
            self.standing.walk(walk)
        }
    }

    #[test]
    fn what_is_remembered_comes_back_and_damaged_bytes_are_refused() {
        let last = [f64::NAN, -0.0].into();
        let mut run =
            Run { name: "load".into(), last, size: Some([1.0, f64::INFINITY]), standing: true };
        let bytes = remember(&mut run);
        let mut other = Run { last: [5.0; 3].into(), ..Run::default() };
        recall(&mut other, &bytes).expect("they are its own");
        assert_eq!(remember(&mut other), bytes);
        assert_eq!((&*other.name, other.last.len(), other.standing), ("load", 2, true));
        for cut in 0..bytes.len() {
            assert_eq!(recall(&mut Run::default(), &bytes[..cut]), Err(MemoryError), "{cut}");
        }
        let longer: Vec<u8> = bytes.iter().copied().chain([0]).collect();
        assert_eq!(recall(&mut Run::default(), &longer), Err(MemoryError));
        let many = remember(&mut Run { last: [0.0; 4].into(), ..Run::default() });
        assert_eq!(recall(&mut Run::default(), &many), Err(MemoryError));
    }
}
