//! The fields in a line.

/// Stands for runs of blanks between aligned columns.
pub(super) const BLANKS: u8 = b' ';
/// From the first: a decimal comma may stand beside each but the comma.
pub(super) const DELIMITERS: [u8; 5] = [b';', b'\t', b'|', b',', BLANKS];

/// Splits lines at a delimiter, outside quotes, into buffers that are used again.
pub(super) struct Fields {
    delimiter: u8,
    splitter: csv_core::Reader,
    text: Vec<u8>,
    ends: Vec<usize>,
    count: usize,
}

impl Fields {
    pub(super) fn new(delimiter: u8) -> Fields {
        let splitter = csv_core::ReaderBuilder::new()
            .delimiter(delimiter)
            .terminator(csv_core::Terminator::Any(b'\n'))
            .build();
        Fields { delimiter, splitter, text: Vec::new(), ends: Vec::new(), count: 0 }
    }

    /// Splits one line, given without its end.
    pub(super) fn split(&mut self, line: &[u8]) {
        if self.delimiter == BLANKS {
            self.split_at_blanks(line);
            return;
        }
        if self.text.len() <= line.len() {
            // A field may be empty, so there can be one more than there are bytes.
            self.text.resize(line.len() + 1, 0);
            self.ends.resize(line.len() + 2, 0);
        }
        self.splitter.reset();
        let (_, _, written, ended) =
            self.splitter.read_record(line, &mut self.text, &mut self.ends);
        // The end of input ends the last field.
        let (_, _, _, last) =
            self.splitter.read_record(&[], &mut self.text[written..], &mut self.ends[ended..]);
        self.count = ended + last;
    }

    /// Any run of blanks parts two fields, outside quotes.
    fn split_at_blanks(&mut self, line: &[u8]) {
        self.text.clear();
        self.ends.clear();
        let (mut quoted, mut inside) = (false, false);
        for byte in line {
            match byte {
                b'"' => (quoted, inside) = (!quoted, true),
                b' ' | b'\t' if !quoted => {
                    if std::mem::take(&mut inside) {
                        self.ends.push(self.text.len());
                    }
                }
                byte => {
                    self.text.push(*byte);
                    inside = true;
                }
            }
        }
        if inside {
            self.ends.push(self.text.len());
        }
        self.count = self.ends.len();
    }

    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// Field `k` without blanks around it; empty beyond the last.
    pub(super) fn get(&self, k: usize) -> &[u8] {
        if k >= self.count {
            return &[];
        }
        let start = if k == 0 { 0 } else { self.ends[k - 1] };
        self.text[start..self.ends[k]].trim_ascii()
    }

    /// All fields of the line that was split last.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u8]> {
        (0..self.count).map(|k| self.get(k))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_split_outside_quotes() {
        for (delimiter, line, expected) in [
            (b',', "a, b ,c", vec!["a", "b", "c"]),
            (b',', "\"1,5\",2", vec!["1,5", "2"]),
            (b',', ",,", vec!["", "", ""]),
            (b',', "a", vec!["a"]),
            (b',', "\"x\"\"y\",", vec!["x\"y", ""]),
            (b'|', "a|b", vec!["a", "b"]),
            (BLANKS, "  1.5   -2\t3 ", vec!["1.5", "-2", "3"]),
            (BLANKS, "\"a b\" c", vec!["a b", "c"]),
        ] {
            let mut fields = Fields::new(delimiter);
            fields.split(line.as_bytes());
            let read: Vec<_> = fields.iter().collect();
            assert_eq!(read, expected.iter().map(|it| it.as_bytes()).collect::<Vec<_>>(), "{line}");
        }
    }
}
