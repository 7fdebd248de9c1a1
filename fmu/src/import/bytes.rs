//! Numbers in and out of bytes, little-endian: for saved states.

/// Bytes being written.
#[derive(Default)]
pub(super) struct Writer(pub(super) Vec<u8>);

impl Writer {
    pub(super) fn flag(&mut self, flag: bool) {
        self.0.push(u8::from(flag));
    }

    pub(super) fn number(&mut self, number: f64) {
        self.0.extend(number.to_le_bytes());
    }

    pub(super) fn option(&mut self, number: Option<f64>) {
        self.flag(number.is_some());
        self.number(number.unwrap_or(0.0));
    }

    pub(super) fn numbers(&mut self, numbers: &[f64]) {
        self.0.extend((numbers.len() as u64).to_le_bytes());
        numbers.iter().for_each(|number| self.number(*number));
    }
}

/// Bytes being read; `None` where they end too early or make no sense.
pub(super) struct Reader<'a>(pub(super) &'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*head)
    }

    pub(super) fn flag(&mut self) -> Option<bool> {
        match self.take()? {
            [0] => Some(false),
            [1] => Some(true),
            _ => None,
        }
    }

    pub(super) fn number(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    pub(super) fn option(&mut self) -> Option<Option<f64>> {
        let (there, number) = (self.flag()?, self.number()?);
        Some(there.then_some(number))
    }

    pub(super) fn numbers(&mut self) -> Option<Vec<f64>> {
        let count = u64::from_le_bytes(self.take()?);
        // What is left bounds the length, whatever the bytes claim.
        if count > (self.0.len() / size_of::<f64>()) as u64 {
            return None;
        }
        (0..count).map(|_| self.number()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let mut writer = Writer::default();
        writer.flag(true);
        writer.option(None);
        writer.numbers(&[1.5, -0.0]);
        let mut reader = Reader(&writer.0);
        assert_eq!((reader.flag(), reader.option()), (Some(true), Some(None)));
        assert_eq!(reader.numbers(), Some(vec![1.5, -0.0]));
        assert_eq!(reader.flag(), None);
        assert_eq!(Reader(&[255; 12]).numbers(), None);
        assert_eq!(Reader(&[7]).flag(), None);
    }
}
