//! Many samples at once: the loop over them is compiled as a whole for the widest instruction
//! set there is, so that each part of a sample is a straight loop over the lanes.
//!
//! The other loop, of [`Unit`](crate::unit::Unit), cannot be this one: its caller chooses the steps, and
//! a sample is taken where one falls due. What a sample is, both have from [`Sampled`].

use drivescope_numerics::dispatch::{Work, widest};

use super::{InputLanes, Sampled, SignalLanes};
use crate::effects::law::OutputLanes;
use crate::fault::FaultLanes;
use crate::integrate::Stepper;

/// What a run takes from outside and what becomes of its signals. Both methods are called once a
/// sample and should be `#[inline(always)]`.
pub trait Samples<const N: usize> {
    /// The inputs of sample `k`.
    fn inputs(&mut self, k: usize) -> &InputLanes<f64, N>;

    /// Takes the signals of sample `k` and what ideal sensors show at its end.
    fn keep(&mut self, k: usize, signals: &SignalLanes<f64, N>, shown: &OutputLanes<f64, N>);
}

/// Samples over which no fault changes: sample k lies at `start_s + k * period_s`.
#[derive(Debug, Clone, PartialEq)]
pub struct Span {
    /// Time of sample 0, s.
    pub start_s: f64,
    /// Sampling time, s.
    pub period_s: f64,
    /// The samples to make.
    pub samples: std::ops::Range<usize>,
}

impl<const N: usize, S: Stepper<N>> Sampled<N, S> {
    /// Makes the samples of the span, as [`Sampled::sample`] and [`Sampled::advance`] by turns.
    pub fn run(&mut self, span: &Span, faults: &FaultLanes<f64, N>, samples: &mut impl Samples<N>) {
        widest(Run { sampled: self, span, faults, samples });
    }
}

/// The samples of a span.
struct Run<'a, const N: usize, S, F> {
    sampled: &'a mut Sampled<N, S>,
    span: &'a Span,
    faults: &'a FaultLanes<f64, N>,
    samples: &'a mut F,
}

impl<const N: usize, S: Stepper<N>, F: Samples<N>> Work for Run<'_, N, S, F> {
    #[inline(always)]
    fn run(self) {
        let Self { sampled, span, faults, samples } = self;
        for k in span.samples.clone() {
            let time = span.start_s + k as f64 * span.period_s;
            let first = k == span.samples.start;
            sampled.sample_inlined(time, samples.inputs(k), faults, first);
            sampled.advance(time, span.period_s);
            samples.keep(k, &sampled.signals, &sampled.outputs(time + span.period_s));
        }
    }
}
