//! Recordings as the synthesis sees them: standardised variables, one array each.

use super::{NeuronOrders, Source};
use crate::data::Data;
use crate::scale::Scale;

/// Standardised outputs reach to this share of (-1, 1), so that noise bounds fit in as well.
const OUTPUT_RANGE: f64 = 0.8;

/// One recording: the input variables of the first layer and the output to be imitated.
#[derive(Debug, Clone)]
pub(super) struct Series {
    /// One array a variable.
    pub(super) variables: Vec<Vec<f64>>,
    /// Measured output within (-1, 1).
    pub(super) y: Vec<f64>,
    /// First sample that is judged.
    pub(super) from: usize,
}

impl Series {
    /// Delayed input signals of one recording; standardised zeros stand before its start.
    pub(super) fn new(
        data: &Data,
        sources: &[Source],
        input_scales: &[Scale],
        output_scale: Scale,
        from: usize,
    ) -> Self {
        let delayed = |source: &Source| match *source {
            Source::Input { input, delay } => {
                let scale = input_scales[input];
                let values = data.inputs()[input].values;
                let past = values.iter().map(|u| scale.standardise(*u));
                std::iter::repeat_n(0.0, delay).chain(past).take(values.len()).collect()
            }
            Source::Neuron(_) => Vec::new(),
        };
        Self {
            variables: sources.iter().map(delayed).collect(),
            y: data.output().values.iter().map(|y| output_scale.standardise(*y)).collect(),
            from,
        }
    }

    /// Judged samples.
    pub(super) fn judged(&self) -> usize {
        self.y.len() - self.from
    }
}

/// Scales of inputs (mean, standard deviation) and output (mean, into the range of tanh) over
/// several recordings.
pub(super) fn scales(recordings: &[Data]) -> (Vec<Scale>, Scale) {
    let inputs = recordings.first().map_or(0, |data| data.inputs().len());
    let over_all = |values: &mut dyn Iterator<Item = f64>| Scale::of(&values.collect::<Vec<_>>());
    let input_scales = (0..inputs)
        .map(|j| {
            let mut values = recordings.iter().flat_map(|d| d.inputs()[j].values.iter().copied());
            over_all(&mut values)
        })
        .collect();
    let outputs = || recordings.iter().flat_map(|d| d.output().values.iter().copied());
    let mean = over_all(&mut outputs()).mean;
    let reach = outputs().map(|y| (y - mean).abs()).fold(0.0, f64::max);
    (input_scales, Scale { mean, deviation: reach / OUTPUT_RANGE })
}

/// The delayed input signals that form the first layer's input vector: for every input `count`
/// delays from `first` on, so far apart that the taps of two neurons' inputs never coincide.
pub(super) fn first_layer(
    inputs: usize,
    first: usize,
    count: usize,
    orders: NeuronOrders,
) -> Vec<Source> {
    let delays = move |input| {
        (0..count).map(move |i| Source::Input { input, delay: first + i * (orders.n_b + 1) })
    };
    (0..inputs).flat_map(delays).collect()
}
