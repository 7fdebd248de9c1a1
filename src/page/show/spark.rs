//! A column at a glance: a plot as large as a word.

use std::fmt::Write;

use drivescope_recording::ColumnPreview;
use maud::{Markup, html};

use crate::report::page::minus;
use crate::report::words::given;

/// Width and height of the plot, in units of its own.
const WIDTH: f64 = 120.0;
const HEIGHT: f64 = 28.0;
/// Free above and below the line.
const MARGIN: f64 = 2.0;

/// The plot of a column, its least and greatest value in words.
pub(super) fn spark(column: &ColumnPreview) -> Markup {
    let values = range((column.least, column.greatest), column.unit.as_deref().unwrap_or_default());
    html! {
        svg.spark viewBox={ "0 0 " (WIDTH) " " (HEIGHT) } width=(WIDTH) height=(HEIGHT) role="img"
            aria-label={ (column.text) ": " (values) } {
            title { (values) }
            path d=(path(column)) {}
        }
    }
}

/// `3.2 … 314 rad/s`.
pub(super) fn range((least, greatest): (f64, f64), unit: &str) -> String {
    let unit = if unit == "1" { "" } else { unit };
    if least.is_nan() {
        return "no values".to_owned();
    }
    let text = |value: f64| minus(&given(value));
    format!("{} \u{2026} {} {unit}", text(least), text(greatest)).trim_end().to_owned()
}

/// The line through the least and the greatest of each stretch, broken where nothing is.
fn path(column: &ColumnPreview) -> String {
    let range = column.greatest - column.least;
    let across = WIDTH / (column.thinned.len() - 1).max(1) as f64;
    let y = |value: f64| match range > 0.0 {
        true => HEIGHT - MARGIN - (HEIGHT - 2.0 * MARGIN) * (value - column.least) / range,
        false => 0.5 * HEIGHT,
    };
    let mut path = String::new();
    let mut is_start = true;
    for (k, (least, greatest)) in column.thinned.iter().enumerate() {
        if least.is_nan() {
            is_start = true;
            continue;
        }
        let (x, mark) = (k as f64 * across, if is_start { 'M' } else { 'L' });
        let (low, high) = (y(*least), y(*greatest));
        // Writing to a string cannot fail.
        let _ = write!(path, "{mark}{x:.1} {low:.1}L{x:.1} {high:.1}");
        is_start = false;
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_short() {
        assert_eq!(range((3.2, 314.159), "rad/s"), "3.2 \u{2026} 314 rad/s");
        assert_eq!(range((-1.0, 4.0), "1"), "\u{2212}1 \u{2026} 4");
        assert_eq!(range((f64::NAN, f64::NAN), "V"), "no values");
    }

    #[test]
    fn holes_break_the_line() {
        let column = ColumnPreview {
            key: "a".to_owned(),
            text: "a [V]".to_owned(),
            name: "a".to_owned(),
            unit: Some("V".to_owned()),
            guess: None,
            as_time: None,
            least: 0.0,
            greatest: 10.0,
            thinned: vec![(0.0, 10.0), (f64::NAN, f64::NAN), (5.0, 5.0)],
        };
        assert_eq!(path(&column), "M0.0 26.0L0.0 2.0M120.0 14.0L120.0 14.0");
        let html = spark(&column).into_string();
        assert!(html.contains("aria-label=\"a [V]: 0 \u{2026} 10 V\""), "{html}");
        let still = ColumnPreview { greatest: 0.0, thinned: vec![(0.0, 0.0)], ..column };
        assert_eq!(path(&still), "M0.0 14.0L0.0 14.0");
    }
}
