//! A figure as SVG.
//!
//! ```text
//!  heading [unit]                    -- line   == band      <- HEADING
//!  ┌───────────────────────────────────────────┐
//!  │ panel                                     │            <- its height
//!  └───────────────────────────────────────────┘
//!  strip label  | || |||||||||                              <- STRIP
//!  0        1000       2000                 x label [unit]  <- FOOT
//! ```
//!
//! A panel is a nested `<svg>`, which clips what leaves it.

use std::fmt::Write;

use super::axis::{Scale, span};
use super::decimate::{Point, envelope, extremes};
use super::figure::{Figure, Layer, Panel};
use super::frame::{LEFT, RIGHT, STRIP, TEXT, heading, marks};
use super::ink::Ink;
use super::path::{area, polyline};
use super::write::{WIDTH, plot, put, px, text, width};

const HEADING: f64 = 24.0;
const FOOT: f64 = 36.0;
const GAP: f64 = 4.0;
/// Room for what spans and markers say, above the data of the first panel.
const LABELS: f64 = 20.0;
/// Width of a column of which only the extremes are kept: a pixel at the usual size.
const COLUMN: f64 = 1.0;
/// Pixels that a tick on an axis takes.
const TICK_X: f64 = 90.0;
const TICK_Y: f64 = 34.0;

impl Figure {
    /// The figure as an SVG element over the width of a page.
    pub fn svg(&self) -> String {
        self.svg_of(WIDTH)
    }

    /// The figure as an SVG element of that many pixels in width, which scale with its place.
    pub fn svg_of(&self, width: f64) -> String {
        let inner = width - LEFT - RIGHT;
        let range = self.x.range.unwrap_or_else(|| self.places());
        let x = Scale::new(range, (0.0, inner));
        let ticks = x.ticks((inner / TICK_X) as usize);
        let mut out = String::new();
        let mut top = 0.0;
        for (place, panel) in self.panels.iter().enumerate() {
            top += HEADING;
            heading(&mut out, panel, top, width);
            self.panel(&mut out, panel, top, (&x, range), &ticks, place == 0);
            top += panel.height;
            if let Some(strip) = &panel.strip {
                marks(&mut out, strip, top, &x);
                top += STRIP;
            }
            top += GAP;
        }
        for (value, label) in &ticks {
            text(&mut out, LEFT + x.at(*value), top + TEXT, "middle", "quiet", label);
        }
        text(&mut out, width - RIGHT, top + 2.4 * TEXT, "end", "quiet", &self.x.heading());
        plot(&self.id, &self.title, &self.description, (width, top + FOOT), &out)
    }

    /// The ends of x where none are given: those of the data, without a margin.
    fn places(&self) -> (f64, f64) {
        let layers = self.panels.iter().flat_map(|panel| &panel.layers);
        layers
            .flat_map(Layer::places)
            .filter(|x| x.is_finite())
            .fold(None, |ends: Option<(f64, f64)>, x| {
                Some(ends.map_or((x, x), |(low, high)| (low.min(x), high.max(x))))
            })
            .unwrap_or((0.0, 1.0))
    }

    fn panel(
        &self,
        out: &mut String,
        panel: &Panel,
        top: f64,
        (x, range): (&Scale, (f64, f64)),
        x_ticks: &[(f64, String)],
        first: bool,
    ) {
        let (height, inner) = (panel.height, x.end());
        let ends = panel
            .y
            .range
            .unwrap_or_else(|| span(panel.layers.iter().flat_map(|layer| layer.values(range))));
        let labelled = first && !(self.spans.is_empty() && self.markers.is_empty());
        let y = Scale::new(ends, (height, if labelled { LABELS } else { 0.0 }));
        let y_ticks = y_ticks(&y, height);
        put!(out, r#"<svg x="{LEFT}" y="{top}" width="{inner}" height="{height}">"#);
        for shaded in &self.spans {
            let (from, to) = (x.at(shaded.from).max(0.0), x.at(shaded.to).min(x.end()));
            if from < to {
                put!(
                    out,
                    r#"<rect class="span" x="{}" width="{}" height="{height}"/>"#,
                    px(from),
                    px(to - from)
                );
            }
        }
        let mut grid = String::new();
        for (value, _) in &y_ticks {
            put!(grid, "M0 {}h{inner}", px(y.at(*value)));
        }
        for (value, _) in x_ticks {
            put!(grid, "M{} {height}v-4", px(x.at(*value)));
        }
        put!(out, r#"<path class="grid" d="{grid}"/>"#);
        for layer in &panel.layers {
            draw(out, layer, x, &y);
        }
        for marker in self.markers.iter().filter(|marker| x.shows(marker.x)) {
            let class = marker.ink.class();
            put!(out, r#"<path class="pointer {class}" d="M{} 0v{height}"/>"#, px(x.at(marker.x)));
        }
        if first {
            self.labels(out, x);
        }
        put!(out, "</svg>");
        let bottom = top + height;
        put!(out, r#"<path class="frame" d="M{LEFT} {top}V{bottom}h{inner}"/>"#);
        for (value, label) in &y_ticks {
            text(out, LEFT - 6.0, top + y.at(*value) + 4.0, "end", "quiet", label);
        }
    }

    /// What spans and markers say, at the upper edge of the first panel.
    fn labels(&self, out: &mut String, x: &Scale) {
        for shaded in self.spans.iter().filter(|span| x.at(span.to) > 0.0) {
            let right = x.at(shaded.to).min(x.end()) - 6.0;
            text(out, right, TEXT + 2.0, "end", "quiet", &shaded.label);
        }
        for marker in self.markers.iter().filter(|marker| x.shows(marker.x)) {
            let at = x.at(marker.x);
            let fits = at + 6.0 + width(&marker.label) < x.end();
            let (at, anchor) = if fits { (at + 6.0, "start") } else { (at - 6.0, "end") };
            let class = format!("inked {}", marker.ink.class());
            text(out, at, TEXT + 2.0, anchor, &class, &marker.label);
        }
    }
}

/// Ticks of a y axis: as many as its height has room for, but two at least, without which nobody
/// could read off a value.
fn y_ticks(y: &Scale, height: f64) -> Vec<(f64, String)> {
    let wanted = ((height / TICK_Y) as usize).max(2);
    // A step is at most five halves of what was wanted, so twice as many give two.
    let enough = (wanted..2 * wanted + 2).map(|wanted| y.ticks(wanted)).find(|t| t.len() >= 2);
    enough.unwrap_or_else(|| y.ticks(wanted))
}

fn draw(out: &mut String, layer: &Layer, x: &Scale, y: &Scale) {
    match layer {
        Layer::Line { points, ink, dash, .. } => {
            let seen = points.iter().filter(|p| x.shows(p.0)).map(|p| (x.at(p.0), y.at(p.1)));
            let path = polyline(extremes(seen, COLUMN));
            let (ink, dash) = (ink.class(), dash.class());
            put!(out, r#"<path class="line {ink} {dash}" d="{path}"/>"#);
        }
        Layer::Band { points, ink, .. } => {
            let seen = points.iter().filter(|p| x.shows(p.0));
            // Pixels count downwards: the upper curve has the lesser values.
            let pixels = seen.map(|p| (x.at(p.0), y.at(p.2), y.at(p.1)));
            let (upper, lower) = envelope(pixels, COLUMN);
            let path = area(&lower, &upper);
            put!(out, r#"<path class="area edge {}" d="{path}"/>"#, ink.class());
        }
        Layer::Cloud { name, points, ink, below } => cloud(out, (name, *below), points, *ink, x, y),
        Layer::Level { y: at, ink, dash, .. } if at.is_finite() => {
            let (ink, dash) = (ink.class(), dash.class());
            let (at, end) = (px(y.at(*at)), x.end());
            put!(out, r#"<path class="level {ink} {dash}" d="M0 {at}h{end}"/>"#);
        }
        Layer::Level { .. } => {}
    }
}

/// Points as round dots, and their name over or under their middle.
fn cloud(
    out: &mut String,
    (name, below): (&str, bool),
    points: &[Point],
    ink: Ink,
    x: &Scale,
    y: &Scale,
) {
    let seen = points.iter().filter(|p| x.shows(p.0) && p.1.is_finite());
    let pixels: Vec<(f64, f64)> = seen.map(|p| (x.at(p.0), y.at(p.1))).collect();
    if pixels.is_empty() {
        return;
    }
    let mut path = String::new();
    for (at, height) in &pixels {
        put!(path, "M{} {}h0", px(*at), px(*height));
    }
    put!(out, r#"<path class="dots {}" d="{path}"/>"#, ink.class());
    let middle = pixels.iter().map(|p| p.0).sum::<f64>() / pixels.len() as f64;
    let ends = pixels.iter().map(|p| p.1);
    let base = if below {
        ends.fold(f64::NEG_INFINITY, f64::max) + TEXT + 3.0
    } else {
        ends.fold(f64::INFINITY, f64::min) - 5.0
    };
    text(out, middle, base, "middle", &format!("inked {}", ink.class()), name);
}

#[cfg(test)]
mod tests {
    use super::super::axis::Axis;
    use super::super::figure::{Marker, Span, Strip};
    use super::super::ink::Dash;
    use super::*;

    fn figure(samples: usize) -> Figure {
        let wave = |k: usize| (k as f64, (k as f64 / 50.0).sin() + 1e-3 * ((k * 31) % 97) as f64);
        let points: Vec<_> = (0..samples).map(wave).collect();
        let band = points.iter().map(|(x, y)| (*x, y - 1.0, y + 1.0)).collect();
        Figure {
            id: "wave".into(),
            title: "A wave <of> \"mine\"".into(),
            description: "Sine & noise".into(),
            x: Axis::new("time", "s"),
            spans: vec![Span { from: 10.0, to: 20.0, label: "here & there".into() }],
            markers: vec![Marker { x: 15.0, label: "<now>".into(), ink: Ink::Vermilion }],
            panels: vec![Panel {
                height: 200.0,
                y: Axis::new("y", "<m>"),
                layers: vec![
                    Layer::Band { label: "band".into(), points: band, ink: Ink::Blue },
                    Layer::Cloud {
                        name: "a & b".into(),
                        points: vec![(1.0, 0.0), (2.0, f64::NAN), (3.0, 1.0)],
                        ink: Ink::Purple,
                        below: true,
                    },
                    Layer::Line {
                        label: "y & z".into(),
                        points,
                        ink: Ink::Text,
                        dash: Dash::Solid,
                    },
                    Layer::Level {
                        label: String::new(),
                        y: 0.5,
                        ink: Ink::Green,
                        dash: Dash::Dashed,
                    },
                ],
                strip: Some(Strip {
                    label: "out".into(),
                    starts: (0..samples).step_by(3).map(|k| k as f64).collect(),
                    step: 1.0,
                    ink: Ink::Vermilion,
                }),
            }],
        }
    }

    #[test]
    fn a_figure_is_well_formed_whatever_its_names() {
        let svg = figure(500).svg();
        let document = roxmltree::Document::parse(&svg).expect("well-formed");
        let elements = document.descendants().filter(|it| it.is_element()).count();
        assert!(elements > 20);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn the_size_depends_on_the_width_not_on_the_samples() {
        let (some, many) = (figure(20_000).svg().len(), figure(400_000).svg().len());
        assert!(many < some + some / 10, "{some} and {many} bytes");
        assert!(many < 60_000, "{many} bytes");
    }

    #[test]
    fn a_figure_without_data_is_still_a_figure() {
        let mut empty = figure(0);
        empty.markers.clear();
        let svg = empty.svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    #[test]
    fn a_value_can_be_read_off_every_axis() {
        for (low, high) in [(1983.0, 2016.0), (-0.4, 0.9), (4.9, 5.6), (0.0, 3.1e-7)] {
            assert!(y_ticks(&Scale::new((low, high), (54.0, 0.0)), 54.0).len() >= 2, "{low}");
        }
    }
}
