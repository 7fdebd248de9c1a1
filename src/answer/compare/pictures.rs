//! The pictures of a comparison.

use drivescope_discovery::compare::{Correlation, Curve, RecordingComparison};
use drivescope_recording::Clock;

use crate::report::plot::{Axis, Dash, Figure, Ink, Layer, Panel, Span};
use crate::report::words::{capital, error, number};

/// Height of a panel of signals, of residuals, of a curve, of correlations.
const SIGNAL: f64 = 130.0;
const RESIDUAL: f64 = 80.0;
const CURVE: f64 = 130.0;
const CORRELATION: f64 = 90.0;

fn line(label: &str, points: Vec<(f64, f64)>, ink: Ink) -> Layer {
    Layer::Line { label: label.to_owned(), points, ink, dash: Dash::Solid }
}

/// Measured and modelled outputs over time, and what is left.
pub(super) fn recording(it: &RecordingComparison, clock: &Clock, place: usize) -> Figure {
    let mut panels = Vec::new();
    for output in &it.outputs {
        let pairs = |of: &dyn Fn(usize) -> f64| {
            let mut points = Vec::with_capacity(output.model.len());
            for segment in clock.segments(output.model.len()) {
                // Nothing is drawn through the gap before a segment.
                if segment.start > 0 {
                    points.push((clock.time(segment.start), f64::NAN));
                }
                points.extend(segment.map(|k| (clock.time(k), of(k))));
            }
            points
        };
        panels.push(Panel {
            height: SIGNAL,
            y: Axis::new(output.name, &output.unit),
            layers: vec![
                line("measured", pairs(&|k| output.model[k] + output.residual[k]), Ink::Text),
                line("model", pairs(&|k| output.model[k]), Ink::Blue),
            ],
            strip: None,
        });
        panels.push(Panel {
            height: RESIDUAL,
            y: Axis::new(format!("residual of {}", output.name), "noise sd"),
            layers: vec![line("", pairs(&|k| output.residual[k] / output.noise), Ink::Vermilion)],
            strip: None,
        });
    }
    Figure {
        id: format!("recording-{place}-plot"),
        title: format!("Model and measurement, {}", it.name),
        description: format!("Outputs and residuals over time; error {}", error(it.error)),
        x: Axis::new("time", "s"),
        spans: it
            .spans
            .iter()
            .map(|span| Span { from: span.from, to: span.to, label: String::new() })
            .collect(),
        markers: Vec::new(),
        panels,
    }
}

/// What is missing over a variable, under a name that is unique on its page.
pub(crate) fn curve(it: &Curve, id: &str) -> Figure {
    let points = it.x.iter().zip(&it.value).map(|(x, y)| (*x, *y)).collect();
    let ends = it.lower.iter().zip(&it.upper);
    let band = it.x.iter().zip(ends).map(|(x, (low, high))| (*x, *low, *high)).collect();
    let label = match it.variable {
        "i" => "current i",
        "theta" => "angle, within a period",
        "temperature" => "smoothed square of the current",
        "time" => "time since the beginning",
        other => other,
    };
    let quantity = match (it.variable, it.balance) {
        ("time", _) => "friction",
        ("temperature", _) => "resistance",
        (_, balance) => balance,
    };
    Figure {
        id: format!("{id}-plot"),
        title: it.words.to_owned(),
        description: caption(it),
        x: Axis::new(label, &it.x_unit),
        spans: Vec::new(),
        markers: Vec::new(),
        panels: vec![Panel {
            height: CURVE,
            y: Axis::new(format!("missing {quantity}"), &it.unit),
            layers: vec![
                Layer::Band { label: "95 %".to_owned(), points: band, ink: Ink::Blue },
                Layer::Level { label: String::new(), y: 0.0, ink: Ink::Text, dash: Dash::Dashed },
                line("", points, Ink::Blue),
            ],
            strip: None,
        }],
    }
}

/// Points at which the band of a curve leaves zero out.
pub(super) fn outside(it: &Curve) -> usize {
    let ends = it.lower.iter().zip(&it.upper);
    ends.filter(|(low, high)| **low > 0.0 || **high < 0.0).count()
}

/// What a curve says.
pub(crate) fn caption(it: &Curve) -> String {
    let count = outside(it);
    let largest = it.value.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let words = capital(it.words);
    match count {
        0 => format!("{words}: the band contains zero at every point."),
        _ => format!(
            "{words}: up to {} {}; the band leaves zero out at {count} of {} points.",
            number(largest),
            it.unit,
            it.x.len()
        ),
    }
}

/// The residual's correlation with itself and with the input, of every output.
pub(super) fn correlations(it: &RecordingComparison, place: usize) -> Figure {
    let panel = |name: String, of: &Correlation| {
        let points = of.lags.iter().zip(&of.values).map(|(x, y)| (*x, *y)).collect();
        let band = of.lags.iter().zip(&of.bands).map(|(x, band)| (*x, -band, *band)).collect();
        Panel {
            height: CORRELATION,
            y: Axis::new(name, ""),
            layers: vec![
                Layer::Band { label: "95 %".to_owned(), points: band, ink: Ink::Blue },
                line("", points, Ink::Vermilion),
            ],
            strip: None,
        }
    };
    let panels = it.outputs.iter().flat_map(|output| {
        [
            panel(format!("residual of {} with itself", output.name), &output.autocorrelation),
            panel(format!("residual of {} with the input", output.name), &output.input_correlation),
        ]
    });
    Figure {
        id: format!("correlation-{place}-plot"),
        title: format!("Correlations of the residual, {}", it.name),
        description: "Correlations over lags, with their bands".to_owned(),
        x: Axis::new("lag (negative: the residual comes first)", "s"),
        spans: Vec::new(),
        markers: Vec::new(),
        panels: panels.collect(),
    }
}
