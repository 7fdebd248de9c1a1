//! The figure of a watched recording: residual and band, the bank's innovations, declared faults.

use drivescope_diagnoser::bank::TWO_SIDED_95;
use drivescope_diagnoser::{DetectorKind, Diagnoser};
use drivescope_monitor::{Declaration, Method, Monitor};
use drivescope_recording::Recording;

use crate::answer::diagnose::DiagnoseAnswer;
use crate::report::plot::{Axis, Dash, Figure, Ink, Layer, Panel, Point, Span, Strip};

const RESIDUAL_HEIGHT: f64 = 150.0;
const SIGNAL_HEIGHT: f64 = 64.0;
/// Declared faults whose names are written into the figure.
const NAMED: usize = 6;

/// What is drawn, gathered row by row.
pub(super) struct Traces {
    method: Method,
    /// Name and unit of the watched signal.
    output: (String, String),
    time: Vec<f64>,
    measured: Vec<f64>,
    residual: Vec<f64>,
    band: Vec<[f64; 2]>,
    outside: Vec<bool>,
    /// Innovation of the bank's speed sensor, standard deviations.
    innovation: Vec<f64>,
    period_s: f64,
}

impl Traces {
    pub(super) fn new(diagnoser: &Diagnoser, recording: &Recording) -> Self {
        let output = &diagnoser.interface.output;
        let measured = recording.signal(&output.name);
        let best = Method::best(diagnoser, false);
        Self {
            // A bank has no band of its own about the residual of the models.
            method: match best {
                Method::Residual(_) => best,
                _ => Method::Residual(DetectorKind::Constant),
            },
            output: (output.name.clone(), output.unit.clone()),
            time: (0..recording.len()).map(|k| recording.time(k)).collect(),
            measured: measured.map_or_else(Vec::new, |it| it.values.clone()),
            residual: Vec::new(),
            band: Vec::new(),
            outside: Vec::new(),
            innovation: Vec::new(),
            period_s: recording.period_s,
        }
    }

    /// Takes a row.
    pub(super) fn take(&mut self, monitor: &Monitor, _: usize) {
        let shown = monitor.shown(self.method).unwrap_or_default();
        self.residual.push(shown.residual);
        self.band.push([shown.lower, shown.upper]);
        self.outside.push(shown.outside);
        let statistics = monitor.statistics();
        self.innovation.push(statistics.map_or(f64::NAN, |(it, _)| it.innovation[0]));
    }

    /// Points of a line from that sample on.
    fn points(&self, values: &[f64], first: usize) -> Vec<Point> {
        self.time.iter().copied().zip(values.iter().copied()).skip(first).collect()
    }

    /// The figure.
    pub(super) fn figure(&self, answer: &DiagnoseAnswer, id: &str) -> Figure {
        let (name, unit) = (&*self.output.0, &*self.output.1);
        let line = |label: &str, values: &[f64], first| Layer::Line {
            label: label.to_owned(),
            points: self.points(values, first),
            ink: Ink::Text,
            dash: Dash::Solid,
        };
        // While the models settle the residual says nothing, and would set the scale.
        let judged = answer.run_up.min(self.time.len());
        let ends = self.time.iter().zip(&self.band).skip(judged);
        let band = ends.map(|(time, [lower, upper])| (*time, *lower, *upper)).collect();
        let outside = self.time.iter().zip(&self.outside).filter(|(_, outside)| **outside);
        let mut panels = vec![Panel {
            height: RESIDUAL_HEIGHT,
            y: Axis::new("residual", unit),
            layers: vec![
                Layer::Band {
                    label: format!("band of {}", self.method.label()),
                    points: band,
                    ink: Ink::Blue,
                },
                line("residual of the model", &self.residual, judged),
            ],
            strip: Some(Strip {
                label: "outside".to_owned(),
                starts: outside.map(|(time, _)| *time).collect(),
                step: self.period_s,
                ink: Ink::Vermilion,
            }),
        }];
        if self.innovation.iter().any(|it| it.is_finite()) {
            let both = self.time.iter().map(|time| (*time, -TWO_SIDED_95, TWO_SIDED_95)).collect();
            panels.push(Panel {
                height: RESIDUAL_HEIGHT,
                y: Axis::new("bank, speed", "sd"),
                layers: vec![
                    Layer::Band {
                        label: "95 % of healthy ones".to_owned(),
                        points: both,
                        ink: Ink::Blue,
                    },
                    line("measured less predicted by the drive", &self.innovation, 0),
                ],
                strip: None,
            });
        }
        panels.push(Panel {
            height: SIGNAL_HEIGHT,
            y: Axis::new(name, unit),
            layers: vec![line("", &self.measured, 0)],
            strip: None,
        });
        let last = self.time.last().copied().unwrap_or(0.0);
        let span = |(k, it): (usize, &Declaration)| Span {
            from: it.from,
            to: it.to.unwrap_or(last).max(it.from + self.period_s),
            label: if k < NAMED { it.mechanism.clone() } else { String::new() },
        };
        Figure {
            id: format!("{id}-plot"),
            title: format!("Residual, band and declared faults of {}", answer.recording),
            description: format!(
                "{} faults declared; the table below holds them",
                answer.declarations.len()
            ),
            x: Axis::new("time", "s").from_to(self.time.first().copied().unwrap_or(0.0), last),
            spans: answer.declarations.iter().enumerate().map(span).collect(),
            markers: Vec::new(),
            panels,
        }
    }
}
