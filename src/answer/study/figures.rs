//! The paper's Figs. 3 and 4 from runs of our own: a healthy residual with constant thresholds and
//! with bands, and the decision without its window under the first fault.

use std::ops::Range;

use drivescope_scenarios::results::{DetectorKind, Pictures, StudyResults};

use super::words::{level as designed, outside, sampling};
use crate::answer::block::{Block, HTML, Picture, Plot};
use crate::report::page::minus;
use crate::report::plot::{Axis, Dash, Figure, Ink, Layer, Panel, Span};
use crate::report::words::{count, fault, given, number};

/// Samples that Fig. 3 shows.
const HEALTHY: Range<usize> = 2000..3000;
/// The fault of Fig. 4, and samples shown before and after its begin.
const LABEL: &str = "f_1^1";
const BESIDE: (usize, usize) = (200, 400);
const HEIGHT: f64 = 150.0;
const DECISION: f64 = 50.0;

/// The section.
pub(super) fn blocks(study: &StudyResults, pictures: &[Pictures]) -> Vec<Block> {
    let healthy = pictures.iter().find(|picture| picture.fault.is_none());
    let first = |picture: &&Pictures| picture.fault.as_ref().is_some_and(|f| f.label == LABEL);
    let faulty = pictures.iter().find(first);
    let drawn = [
        healthy.map(|picture| healthy_figure(study, picture)),
        faulty.map(|picture| faulty_figure(study, picture)),
    ];
    let mut blocks: Vec<Block> = drawn.into_iter().flatten().map(Block::Figure).collect();
    if blocks.is_empty() {
        blocks.push(Block::Note("No traces were kept".to_owned()));
    }
    vec![Block::In(HTML, blocks)]
}

fn shown(picture: &Pictures, wanted: Range<usize>) -> Range<usize> {
    let end = wanted.end.min(picture.residual.len());
    wanted.start.min(end)..end
}

fn line(label: &str, signal: &[f64], shown: &Range<usize>) -> Layer {
    Layer::Line {
        label: label.into(),
        points: shown.clone().filter_map(|k| Some((k as f64, *signal.get(k)?))).collect(),
        ink: Ink::Text,
        dash: Dash::Solid,
    }
}

fn band(picture: &Pictures, shown: &Range<usize>) -> Layer {
    let at = |k: usize| Some((k as f64, *picture.lower.get(k)?, *picture.upper.get(k)?));
    Layer::Band {
        label: "bands (6), (7)".into(),
        points: shown.clone().filter_map(at).collect(),
        ink: Ink::Blue,
    }
}

fn axis(study: &StudyResults, shown: &Range<usize>) -> Axis {
    Axis::new("sample", sampling(study)).from_to(shown.start as f64, shown.end as f64)
}

fn healthy_figure(study: &StudyResults, picture: &Pictures) -> Picture {
    let shown = shown(picture, HEALTHY);
    let unit = &study.drive.tacho_unit;
    let level = |label: &str, y| Layer::Level {
        label: label.into(),
        y,
        ink: Ink::Orange,
        dash: Dash::Dashed,
    };
    let (low, high) = study.model.constant;
    let panel = |name: &str, layers| Panel {
        height: HEIGHT,
        y: Axis::new(name, unit),
        layers,
        strip: None,
    };
    let residual = || line("residual", &picture.residual, &shown);
    let drawn = Figure {
        id: "figure-3-plot".into(),
        title: "Residual of a healthy run with constant thresholds and with bands".into(),
        description: "Two panels over the same samples: the residual between constant thresholds, \
                      and inside the adaptive bands."
            .into(),
        x: axis(study, &shown),
        spans: Vec::new(),
        markers: Vec::new(),
        panels: vec![
            panel("(a) r", vec![residual(), level("constant thresholds", low), level("", high)]),
            panel("(b) r", vec![band(picture, &shown), residual()]),
        ],
    };
    let paper = study.paper.r_fd;
    let [constant, mem] = [DetectorKind::Constant, DetectorKind::Mem].map(|it| study.r_fd.of(it));
    let caption = format!(
        "Fig. 3: a healthy residual (a) with constant thresholds, r_fd = {} over {} (paper: {}), (b) \
         with the bands of model error modelling, r_fd = {} (paper: {}), both designed for {} %.",
        number(constant),
        count(study.healthy.runs, "run"),
        given(paper.constant),
        number(mem),
        given(paper.mem),
        designed(study.beta)
    );
    Picture { plot: Plot::Figure(drawn), caption }
}

fn faulty_figure(study: &StudyResults, picture: &Pictures) -> Picture {
    let from = study.fault_span.from;
    let shown = shown(picture, from.saturating_sub(BESIDE.0)..from + BESIDE.1);
    let decision: Vec<f64> =
        (0..shown.end).map(|k| f64::from(u8::from(outside(picture, k)))).collect();
    let name = picture.fault.as_ref().map_or_else(String::new, fault);
    let drawn = Figure {
        id: "figure-4-plot".into(),
        title: format!("Bands and decision logic under the fault {}", minus(&name)),
        description: "Two panels over the same samples: the residual with its bands, and the \
                      decision, one while a sample lies outside them."
            .into(),
        x: axis(study, &shown),
        spans: vec![Span {
            from: from as f64,
            to: study.fault_span.to as f64,
            label: "fault acts".into(),
        }],
        markers: Vec::new(),
        panels: vec![
            Panel {
                height: HEIGHT,
                y: Axis::new("(a) r", &study.drive.tacho_unit),
                layers: vec![band(picture, &shown), line("residual", &picture.residual, &shown)],
                strip: None,
            },
            Panel {
                height: DECISION,
                y: Axis::new("(b) decision", "").from_to(-0.1, 1.1),
                layers: vec![line("", &decision, &shown)],
                strip: None,
            },
        ],
    };
    let paper = study.paper.detection.iter().find(|row| row.label == LABEL);
    let declared = match picture.declared {
        Some(sample) => format!("declared at sample {sample}"),
        None => "not declared".to_owned(),
    };
    let paper = paper.map_or_else(String::new, |row| format!(" (paper: {})", row.t_dt));
    let caption = format!(
        "Fig. 4: the fault {name}, (a) bands by model error modelling, (b) decision logic without the \
         time window. With the window it was {declared}{paper}."
    );
    Picture { plot: Plot::Figure(drawn), caption }
}
