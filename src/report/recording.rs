//! A recording on a page: its signals over time, with the spans that something was found in.

use drivescope_recording::{Recording, in_words, rounded};
use maud::html;

use super::page::{figure, page};
use super::plot::{Axis, Dash, Figure, Ink, Layer, Panel, Span};
use super::words::capital;

/// Height of a panel, pixels.
const PANEL: f64 = 90.0;

/// One self-contained page of a recording; spans are from, to, s, and what they say.
pub fn recording_html(recording: &Recording, spans: &[(f64, f64, String)]) -> String {
    let clock = recording.clock();
    let (samples, period_s) = (recording.len(), recording.period_s);
    let panel = |signal: &drivescope_recording::Signal| {
        let mut points = Vec::with_capacity(signal.values.len());
        for segment in clock.segments(samples) {
            // Nothing is drawn through the gap before a segment.
            if segment.start > 0 {
                points.push((clock.time(segment.start), f64::NAN));
            }
            points.extend(segment.map(|k| (clock.time(k), signal.values[k])));
        }
        let (label, ink, dash) = (String::new(), Ink::Blue, Dash::Solid);
        Panel {
            height: PANEL,
            y: Axis::new(&signal.name, &signal.unit),
            layers: vec![Layer::Line { label, points, ink, dash }],
            strip: None,
        }
    };
    let spans =
        spans.iter().map(|(from, to, label)| Span { from: *from, to: *to, label: label.clone() });
    let names: Vec<&str> = recording.signals.iter().map(|it| in_words(&it.name)).collect();
    let picture = Figure {
        id: "recording-plot".to_owned(),
        title: format!("Recording {}", recording.name),
        description: format!("Over time: {}", names.join(", ")),
        x: Axis::new("time", "s"),
        spans: spans.collect(),
        markers: Vec::new(),
        panels: recording.signals.iter().map(panel).collect(),
    };
    let about = html! {
        (samples) " samples every " (rounded(period_s)) " s."
    };
    let caption = html! { (capital(&names.join(", "))) "." };
    let name = &recording.name;
    let body = figure("recording", picture.svg(), &picture.title, &caption);
    page(name, &about, &body, &html! { "drivescope" })
}

#[cfg(test)]
mod tests {
    use drivescope_recording::{Break, Signal};

    use super::*;

    #[test]
    fn signals_and_spans_are_drawn() {
        let values = (0..100).map(f64::from).collect();
        let signal = Signal { name: "omega".into(), unit: "rad/s".into(), values };
        let breaks = vec![Break { at: 40, start_s: 3.0 }];
        let recording = Recording { breaks, ..Recording::new("<a>.csv", 0.0, 0.01, vec![signal]) };
        let html = recording_html(&recording, &[(3.1, 3.3, "tacho".to_owned())]);
        assert!(html.contains("&lt;a&gt;.csv") && html.contains("Speed"), "{html}");
        assert!(html.contains("tacho") && html.contains("<svg"));
    }
}
