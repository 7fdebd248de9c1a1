//! What is seen of each recording: how well its outputs fit, what is left of them, and when.

use drivescope_plant::units::for_motion;
use serde::Serialize;

use super::columns::Builder;
use super::residual::{self, Correlation};
use super::span::{self, Span, spans};
use super::whitening;
use crate::estimate::fit_percent;

/// An output of a recording against the model's.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutputComparison {
    pub name: &'static str,
    pub unit: String,
    /// Standard deviation of its noise.
    pub noise: f64,
    /// 100 (1 - |y - y_model| / |y - mean y|), %; none where y is constant.
    pub fit_percent: Option<f64>,
    /// Root of the mean squared difference, in the unit.
    pub rms: f64,
    /// The same in units of the noise.
    pub error: f64,
    /// Error of the prediction one step ahead, by what is left of all outputs before (a vector
    /// autoregression of the residual), in units of the noise.
    pub one_step_error: f64,
    /// 100 (1 - |one-step error| / |y - mean y|), %.
    pub one_step_percent: Option<f64>,
    /// The residual's correlation with itself.
    pub autocorrelation: Correlation,
    /// Its correlation with the input.
    pub input_correlation: Correlation,
    /// y - y_model, one value a sample, NaN where nothing was measured.
    #[serde(skip)]
    pub residual: Vec<f64>,
    /// The model's output, one value a sample.
    #[serde(skip)]
    pub model: Vec<f64>,
}

/// One recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordingComparison {
    /// Where it comes from.
    pub name: String,
    /// Root of the mean squared error, in units of the noise.
    pub error: f64,
    pub outputs: Vec<OutputComparison>,
    /// When it fails.
    pub spans: Vec<Span>,
}

/// What recordings are told from.
pub(super) struct Seen<'a> {
    pub(super) builder: &'a Builder<'a>,
    /// Errors one step ahead, by rows of the layout.
    pub(super) one_step: &'a [f64],
    /// Squared error of a perfect model, per value.
    pub(super) floor: f64,
    /// Whether a cause was found.
    pub(super) explained: bool,
}

impl Seen<'_> {
    pub(super) fn recording(&self, place: usize) -> RecordingComparison {
        let case = &self.builder.cases[place];
        let mut shown = case.trajectory();
        let mut squares = vec![(0.0, 0); case.measured.len()];
        let mut outputs = Vec::new();
        for (j, channel) in case.measured.outputs.iter().enumerate() {
            let model = std::mem::take(&mut shown[channel.output as usize]);
            let output = self.output(place, j, model);
            for (square, r) in squares.iter_mut().zip(&output.residual) {
                if r.is_finite() {
                    square.0 += (r / case.noise[j]).powi(2);
                    square.1 += 1;
                }
            }
            outputs.push(output);
        }
        let (sum, count) = squares.iter().fold((0.0, 0), |(s, n), it| (s + it.0, n + it.1));
        let unit = |rotary| for_motion(case.drive.motion, rotary);
        let spans = spans(&span::View {
            path: &self.builder.paths[place],
            scales: self.builder.scales,
            squares: &squares,
            clock: case.measured.clock.clone(),
            floor: self.floor,
            explained: self.explained,
            limit: self.builder.limit,
            units: [&unit("rad/s"), if self.builder.paths[place].force { "(u)" } else { "A" }],
        });
        RecordingComparison {
            name: case.measured.name.clone(),
            error: (sum / f64::from(count.max(1) as u32)).sqrt(),
            outputs,
            spans,
        }
    }

    fn output(&self, place: usize, j: usize, model: Vec<f64>) -> OutputComparison {
        let (case, layout) = (&self.builder.cases[place], self.builder.layout);
        let channel = &case.measured.outputs[j];
        let residual: Vec<f64> = channel.values.iter().zip(&model).map(|(y, m)| y - m).collect();
        let known = || residual.iter().copied().filter(|r| r.is_finite());
        let count = known().count().max(1) as f64;
        let rms = (known().map(|r| r * r).sum::<f64>() / count).sqrt();
        let shown = || channel.values.iter().zip(&residual).filter(|(_, r)| r.is_finite());
        let mean = shown().map(|(y, _)| y).sum::<f64>() / count;
        let swing = (shown().map(|(y, _)| (y - mean).powi(2)).sum::<f64>() / count).sqrt();
        let span = layout.starts[place]..layout.starts[place + 1];
        let row = |group: usize| group * layout.outputs + j;
        let steps: Vec<f64> =
            span.clone().skip(whitening::FIRST).map(|group| self.one_step[row(group)]).collect();
        let squares = steps.iter().map(|v| v * v).sum::<f64>();
        let one_step_error = (squares / steps.len().max(1) as f64).sqrt();
        // What is not measured is 0 here: it adds nothing to a correlation.
        let mut e = vec![0.0; span.len()];
        let mut u = vec![0.0; span.len()];
        for k in 0..case.measured.len() {
            let group = k / layout.stride;
            e[group] += if residual[k].is_finite() { residual[k] } else { 0.0 };
            u[group] += case.measured.u[k];
        }
        OutputComparison {
            name: channel.name,
            unit: channel.unit.clone(),
            noise: case.noise[j],
            fit_percent: fit_percent(rms, swing),
            rms,
            error: rms / case.noise[j],
            one_step_error,
            one_step_percent: fit_percent(one_step_error * case.noise[j], swing),
            autocorrelation: residual::autocorrelation(&e, layout.group_s),
            input_correlation: residual::input_correlation(&e, &u, layout.group_s),
            residual,
            model,
        }
    }
}
