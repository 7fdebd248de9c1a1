//! What stands around a panel: its heading, its legend, its strip of marks.

use std::fmt::Write;

use super::axis::Scale;
use super::figure::{Layer, Panel, Strip};
use super::write::{put, px, text, width};

/// Left and right of the plotting areas.
pub(super) const LEFT: f64 = 58.0;
pub(super) const RIGHT: f64 = 20.0;
/// Height of a strip.
pub(super) const STRIP: f64 = 16.0;
/// Height of a text line.
pub(super) const TEXT: f64 = 12.0;
/// Least width of a mark in a strip that is still seen.
const LEAST_MARK: f64 = 0.8;

/// Name of the y axis at the left, the legend at the right of a plot of that width.
pub(super) fn heading(out: &mut String, panel: &Panel, top: f64, whole: f64) {
    const SAMPLE: f64 = 22.0;
    let base = top - 7.0;
    text(out, LEFT, base, "start", "heading", &panel.y.heading());
    let mut right = whole - RIGHT;
    for layer in panel.layers.iter().rev().filter(|layer| !layer.label().is_empty()) {
        let label = layer.label();
        let left = right - width(label);
        text(out, left, base, "start", "quiet", label);
        let from = left - SAMPLE - 6.0;
        let middle = base - 4.0;
        match layer {
            Layer::Cloud { .. } => {}
            Layer::Line { ink, dash, .. } | Layer::Level { ink, dash, .. } => {
                let (ink, dash) = (ink.class(), dash.class());
                put!(out, r#"<path class="level {ink} {dash}" d="M{from} {middle}h{SAMPLE}"/>"#);
            }
            Layer::Band { ink, .. } => {
                let (corner, class) = (middle - 5.0, ink.class());
                put!(
                    out,
                    r#"<rect class="area edge {class}" x="{from}" y="{corner}" width="{SAMPLE}" height="10"/>"#
                );
            }
        }
        right = from - 18.0;
    }
}

/// The marks of a strip, its name at the left.
pub(super) fn marks(out: &mut String, strip: &Strip, top: f64, x: &Scale) {
    let middle = top + STRIP / 2.0 + 2.0;
    let class = format!("inked {}", strip.ink.class());
    text(out, LEFT - 6.0, middle + 4.0, "end", &class, &strip.label);
    let mut path = String::new();
    let mut reached = f64::NEG_INFINITY;
    for (from, to) in strip.runs() {
        let (from, to) = (x.at(from).max(0.0), x.at(to).min(x.end()));
        // Marks narrower than a mark can be share one.
        if from >= to || to <= reached {
            continue;
        }
        let to = to.max(from + LEAST_MARK);
        put!(path, "M{} {middle}H{}", px(LEFT + from), px(LEFT + to));
        reached = to;
    }
    put!(
        out,
        r#"<path class="strip {}" stroke-width="{}" d="{path}"/>"#,
        strip.ink.class(),
        STRIP - 6.0
    );
}
