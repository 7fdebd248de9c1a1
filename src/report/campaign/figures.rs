//! Detection against size, a curve with its interval for each kind of fault.

use drivescope_scenarios::campaign::summary::{KindRow, MethodSummary, SizeRow};

use crate::report::plot::{Axis, Dash, Figure, Ink, Layer, Panel};

const HEIGHT: f64 = 200.0;
const INKS: [Ink; 5] = [Ink::Blue, Ink::Orange, Ink::Green, Ink::Purple, Ink::Vermilion];
const DASHES: [Dash; 3] = [Dash::Solid, Dash::Dashed, Dash::Dotted];

/// The figure as SVG; nothing where no kind has two sizes.
pub(super) fn detection(method: &MethodSummary) -> Option<String> {
    let kinds: Vec<&KindRow> = method.kinds.iter().filter(|kind| kind.sizes.len() > 1).collect();
    if kinds.is_empty() {
        return None;
    }
    let mut layers = Vec::new();
    for (k, kind) in kinds.iter().enumerate() {
        let band = |row: &SizeRow| {
            (middle(row), 100.0 * row.detected.interval[0], 100.0 * row.detected.interval[1])
        };
        layers.push(Layer::Band {
            label: String::new(),
            points: kind.sizes.iter().map(band).collect(),
            ink: INKS[k % INKS.len()],
        });
    }
    for (k, kind) in kinds.iter().enumerate() {
        layers.push(Layer::Line {
            label: kind.kind.clone(),
            points: kind
                .sizes
                .iter()
                .map(|row| (middle(row), 100.0 * row.detected.share))
                .collect(),
            ink: INKS[k % INKS.len()],
            dash: DASHES[k / INKS.len() % DASHES.len()],
        });
    }
    let figure = Figure {
        id: format!("detection-{}-plot", method.method),
        title: format!("Detection against size, {}", method.method),
        description:
            "A curve a kind of fault: the share of scenarios in which it was declared, over \
                      the magnitude of its size, with its 95 % interval. The table has the numbers."
                .to_owned(),
        x: Axis::new("magnitude of the fault", ""),
        spans: Vec::new(),
        markers: Vec::new(),
        panels: vec![Panel {
            height: HEIGHT,
            y: Axis::new("detected", "%").from_to(0.0, 100.0),
            layers,
            strip: None,
        }],
    };
    Some(figure.svg())
}

fn middle(row: &SizeRow) -> f64 {
    0.5 * (row.from + row.to)
}
