//! Signals to learn from: checked once, borrowed from where they lie. What was recorded in several
//! segments is one set of data: models begin at rest in each.

use std::ops::Range;

use thiserror::Error;

/// Why signals cannot be learned from.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DataError {
    /// No input signal was given.
    #[error("no input signal was given: a model needs at least one")]
    NoInput,
    /// Signals of different length.
    #[error("signal {signal} has {samples} samples where the first output has {expected}")]
    Length {
        /// The shorter or longer signal.
        signal: String,
        samples: usize,
        /// Samples of the output.
        expected: usize,
    },
    /// A value is NaN or infinite.
    #[error("signal {signal} is not a finite number at sample {sample}: cut or repair the gap")]
    NotFinite {
        signal: String,
        /// First such sample, from 0.
        sample: usize,
    },
    /// A signal that never changes.
    #[error("signal {signal} is constant at {value}: nothing can be learned from it")]
    Constant {
        signal: String,
        /// Its only value.
        value: f64,
    },
    /// Fewer samples than the model needs.
    #[error("{purpose} needs at least {needed} samples, there are {samples}")]
    TooFew {
        /// What they are needed for.
        purpose: &'static str,
        /// Fewest samples.
        needed: usize,
        /// Samples given.
        samples: usize,
    },
}

/// One signal with its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column<'a> {
    /// Name for messages.
    pub name: &'a str,
    /// One value a sample.
    pub values: &'a [f64],
}

/// Inputs and outputs over the same samples, all finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Data<'a> {
    inputs: Vec<Column<'a>>,
    /// Never empty; a detector and an ARX model see the first.
    outputs: Vec<Column<'a>>,
    /// Samples to learn from, in order: those between them only lie there.
    segments: Vec<Range<usize>>,
}

impl<'a> Data<'a> {
    /// One output; checks lengths and that every value is finite.
    pub fn new(inputs: Vec<Column<'a>>, output: Column<'a>) -> Result<Self, DataError> {
        if inputs.is_empty() {
            return Err(DataError::NoInput);
        }
        let expected = output.values.len();
        for column in inputs.iter().chain([&output]) {
            check(column, expected)?;
        }
        let segments = std::iter::once(0..expected).collect();
        Ok(Self { inputs, outputs: vec![output], segments })
    }

    /// The same, recorded in these segments.
    ///
    /// # Panics
    /// If they are not in order or reach beyond the data (an error of the calling code).
    pub fn in_segments(mut self, segments: Vec<Range<usize>>) -> Self {
        let in_order = segments.windows(2).all(|pair| pair[0].end <= pair[1].start);
        let within = segments.last().is_none_or(|last| last.end <= self.len());
        assert!(in_order && within, "segments of these data");
        self.segments = segments;
        self
    }

    /// Samples to learn from, segment by segment.
    pub fn segments(&self) -> &[Range<usize>] {
        &self.segments
    }

    /// Each segment of more than `run_up` samples as data of its own.
    pub fn parts(&self, run_up: usize) -> Vec<Data<'a>> {
        let long = self.segments.iter().filter(|segment| segment.len() > run_up);
        long.map(|segment| self.span(segment.clone())).collect()
    }

    /// The same without the first samples of every segment, in which models settle.
    pub fn settled(&self, run_up: usize) -> Data<'a> {
        let later = |segment: &Range<usize>| segment.start + run_up..segment.end;
        match &self.segments[..] {
            [single] => self.span(later(single)),
            several => {
                let long = several.iter().filter(|segment| segment.len() > run_up);
                let segments = long.map(later).collect();
                Data { segments, ..self.clone() }
            }
        }
    }

    /// Those of these values, one a sample, that lie `run_up` samples or more behind the beginning
    /// of a segment.
    pub fn judged(&self, values: &[f64], run_up: usize) -> Vec<f64> {
        let later = self.segments.iter().flat_map(|segment| segment.clone().skip(run_up));
        later.map(|k| values[k]).collect()
    }

    /// One more output over the same samples.
    pub fn and_output(mut self, output: Column<'a>) -> Result<Self, DataError> {
        check(&output, self.len())?;
        self.outputs.push(output);
        Ok(self)
    }

    /// The inputs, in the order in which a model takes them.
    pub fn inputs(&self) -> &[Column<'a>] {
        &self.inputs
    }

    /// The first output, or the only one.
    pub fn output(&self) -> Column<'a> {
        self.outputs[0]
    }

    /// All outputs; at least one.
    pub fn outputs(&self) -> &[Column<'a>] {
        &self.outputs
    }

    /// Samples.
    pub fn len(&self) -> usize {
        self.output().values.len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The same inputs with another output of the same length.
    pub fn with_output<'b>(&self, name: &'b str, values: &'b [f64]) -> Result<Data<'b>, DataError>
    where
        'a: 'b,
    {
        let data = Data::new(self.inputs.clone(), Column { name, values })?;
        Ok(data.in_segments(self.segments.clone()))
    }

    /// These samples only.
    ///
    /// # Panics
    /// If the range reaches beyond the data (an error of the calling code).
    pub fn span(&self, range: Range<usize>) -> Data<'a> {
        let cut = |column: &Column<'a>| Column {
            name: column.name,
            values: &column.values[range.clone()],
        };
        let within = |segment: &Range<usize>| {
            let (from, to) = (segment.start.max(range.start), segment.end.min(range.end));
            (from < to).then(|| from - range.start..to - range.start)
        };
        Data {
            inputs: self.inputs.iter().map(cut).collect(),
            outputs: self.outputs.iter().map(cut).collect(),
            segments: self.segments.iter().filter_map(within).collect(),
        }
    }

    /// Refuses signals that never change.
    pub fn require_variation(&self) -> Result<(), DataError> {
        for column in self.inputs.iter().chain(&self.outputs) {
            if let Some(&value) = column.values.first()
                && column.values.iter().all(|other| *other == value)
            {
                return Err(DataError::Constant { signal: column.name.into(), value });
            }
        }
        Ok(())
    }

    /// Refuses data whose longest segment has fewer samples than `needed`.
    pub fn require_samples(&self, needed: usize, purpose: &'static str) -> Result<(), DataError> {
        let samples = self.segments.iter().map(Range::len).max().unwrap_or(0);
        if samples < needed {
            return Err(DataError::TooFew { purpose, needed, samples });
        }
        Ok(())
    }
}

fn check(column: &Column, expected: usize) -> Result<(), DataError> {
    let signal = || column.name.to_owned();
    let samples = column.values.len();
    if samples != expected {
        return Err(DataError::Length { signal: signal(), samples, expected });
    }
    match column.values.iter().position(|value| !value.is_finite()) {
        Some(sample) => Err(DataError::NotFinite { signal: signal(), sample }),
        None => Ok(()),
    }
}

/// What a test's run recorded.
#[cfg(test)]
pub(crate) fn data(run: &crate::testing::Run) -> Data<'_> {
    let input = Column { name: "C_m", values: &run.control };
    Data::new(vec![input], Column { name: "T", values: &run.speed }).unwrap()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column<'a>(name: &'a str, values: &'a [f64]) -> Column<'a> {
        Column { name, values }
    }

    #[test]
    fn what_cannot_be_learned_from_is_refused_by_name_and_sample() {
        let fine = [1.0, 2.0, 3.0];
        let gap = [1.0, f64::NAN, 3.0];
        assert_eq!(Data::new(vec![], column("T", &fine)), Err(DataError::NoInput));
        assert_eq!(
            Data::new(vec![column("C_m", &fine)], column("T", &gap)),
            Err(DataError::NotFinite { signal: "T".into(), sample: 1 })
        );
        assert_eq!(
            Data::new(vec![column("C_m", &fine[..2])], column("T", &fine)),
            Err(DataError::Length { signal: "C_m".into(), samples: 2, expected: 3 })
        );
        let still = Data::new(vec![column("C_m", &[4.0; 3])], column("T", &fine)).unwrap();
        assert_eq!(
            still.require_variation(),
            Err(DataError::Constant { signal: "C_m".into(), value: 4.0 })
        );
        assert_eq!(
            still.require_samples(10, "a test"),
            Err(DataError::TooFew { purpose: "a test", needed: 10, samples: 3 })
        );
    }

    #[test]
    fn segments_are_cut_settled_and_judged_each_by_itself() {
        let values: Vec<f64> = (0..20).map(f64::from).collect();
        let data = Data::new(vec![column("u", &values)], column("y", &values)).unwrap();
        let two = data.clone().in_segments(vec![0..8, 9..12, 14..20]);
        assert_eq!(two.judged(&values, 4), [4.0, 5.0, 6.0, 7.0, 18.0, 19.0]);
        assert_eq!(two.settled(4).segments(), [4..8, 18..20]);
        assert_eq!(data.settled(4), data.span(4..20), "one segment is cut");
        let parts = two.parts(4);
        assert_eq!(parts.iter().map(Data::len).collect::<Vec<_>>(), [8, 6]);
        assert_eq!(parts[1].output().values[0], 14.0);
        assert_eq!(two.span(5..16).segments(), [0..3, 4..7, 9..11]);
        assert_eq!(two.with_output("r", &values).unwrap().segments(), two.segments());
        assert!(two.require_samples(8, "a test").is_ok() && two.require_samples(9, "it").is_err());
    }

    #[test]
    fn a_span_holds_its_samples_of_every_signal() {
        let (u, y) = ([0.0, 1.0, 2.0, 3.0], [5.0, 6.0, 7.0, 8.0]);
        let data = Data::new(vec![column("u", &u)], column("y", &y)).unwrap();
        let span = data.span(1..3);
        assert_eq!(span.inputs()[0].values, [1.0, 2.0]);
        assert_eq!(span.output().values, [6.0, 7.0]);
    }
}
