//! The drawing of a run: residual, bands and thresholds over the signals they come from.

use std::ops::Range;

use drivescope_scenarios::results::{Pictures, StudyResults};

use super::words::{name, outside, sampling};
use crate::report::page::minus;
use crate::report::plot::{Axis, Dash, Figure, Ink, Layer, Marker, Panel, Point, Span, Strip};

const RESIDUAL_HEIGHT: f64 = 220.0;
const SIGNAL_HEIGHT: f64 = 54.0;

/// The figure of the samples `shown`, as `id` on its page, with what to see in it.
pub(super) fn drawing(
    study: &StudyResults,
    picture: &Pictures,
    shown: &Range<usize>,
    (id, caption): (&str, &str),
) -> Figure {
    let unit = &study.drive.tacho_unit;
    let points = |signal: &[f64]| -> Vec<Point> {
        shown.clone().filter_map(|k| Some((k as f64, *signal.get(k)?))).collect()
    };
    let band = shown
        .clone()
        .filter_map(|k| Some((k as f64, *picture.lower.get(k)?, *picture.upper.get(k)?)));
    let level = |label: &str, y| Layer::Level {
        label: label.into(),
        y,
        ink: Ink::Orange,
        dash: Dash::Dashed,
    };
    let line = |label: &str, signal: &[f64], ink| Layer::Line {
        label: label.into(),
        points: points(signal),
        ink,
        dash: Dash::Solid,
    };
    let signal = |name: &str, unit: &str, values: &[f64]| Panel {
        height: SIGNAL_HEIGHT,
        y: Axis::new(name, unit),
        layers: vec![line("", values, Ink::Text)],
        strip: None,
    };
    let span = study.fault_span;
    let acts = picture.fault.as_ref().map(|_| Span {
        from: span.from as f64,
        to: span.to as f64,
        label: "fault acts".into(),
    });
    let declared = picture.declared.map(|sample| Marker {
        x: sample as f64,
        label: format!("declared {sample}"),
        ink: Ink::Vermilion,
    });
    Figure {
        id: format!("{id}-plot"),
        title: format!("Residual and bands, {}", minus(&name(picture))),
        description: caption.to_owned(),
        x: Axis::new("sample", sampling(study)).from_to(shown.start as f64, shown.end as f64),
        spans: acts.into_iter().collect(),
        markers: declared.into_iter().collect(),
        panels: vec![
            Panel {
                height: RESIDUAL_HEIGHT,
                y: Axis::new("residual r", unit),
                layers: vec![
                    Layer::Band {
                        label: "adaptive band".into(),
                        points: band.collect(),
                        ink: Ink::Blue,
                    },
                    line("residual", &picture.residual, Ink::Text),
                    level("constant thresholds", study.model.constant.0),
                    level("", study.model.constant.1),
                ],
                strip: Some(Strip {
                    label: "outside".into(),
                    starts: shown
                        .clone()
                        .filter(|k| outside(picture, *k))
                        .map(|k| k as f64)
                        .collect(),
                    step: 1.0,
                    ink: Ink::Vermilion,
                }),
            },
            signal("tachometer T", unit, &picture.t),
            signal("control signal C_m", "V", &picture.c_m),
        ],
    }
}
