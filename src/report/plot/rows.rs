//! One row a category, one mark or bar a series, on a common axis.
//!
//! What lies off the axis is an arrow at its end with the number; what has no value is said in
//! words. So a chart can keep the scale that shows the ordinary rows and hides no other.

use std::fmt::Write;

use super::axis::{Axis, Scale, span};
use super::ink::Ink;
use super::write::{WIDTH, plot, put, px, text, width};

/// A chart of rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// Name of the chart on its page, unique there.
    pub id: String,
    /// What it is, for those who do not see it.
    pub title: String,
    /// What it shows, for those who do not see it.
    pub description: String,
    /// The axis of the values; bars need 0 on it.
    pub axis: Axis,
    /// A place on the axis that is worth a line, and why.
    pub reference: Option<(f64, String)>,
    /// What each row has a value of.
    pub series: Vec<Series>,
    /// Name of each row and its values, one a series.
    pub rows: Vec<(String, Vec<Value>)>,
}

/// A series.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name.
    pub label: String,
    /// Colour.
    pub ink: Ink,
    /// Shape.
    pub mark: Mark,
    /// Line of the row on which it is drawn, from 0: series may share one.
    pub lane: usize,
}

/// How a value is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// A bar from 0.
    Bar,
    /// The outline of a bar.
    HollowBar,
    Disc,
    Circle,
    Diamond,
    /// The outline of a diamond.
    HollowDiamond,
}

/// A value of a series in a row.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Number(f64),
    /// No number, and why.
    Missing(String),
}

const RIGHT: f64 = 24.0;
const HEADING: f64 = 28.0;
const FOOT: f64 = 36.0;
const TEXT: f64 = 12.0;
const LEGEND_MARK: f64 = 14.0;
const TICK: f64 = 90.0;
/// Height of a bar, of a line of a row, and of the room between rows.
const BAR: f64 = 11.0;
const LANE: f64 = 12.0;
const BETWEEN: f64 = 10.0;
/// Half the size of a mark.
const RADIUS: f64 = 4.2;

impl Mark {
    fn is_bar(self) -> bool {
        matches!(self, Self::Bar | Self::HollowBar)
    }

    fn class(self) -> &'static str {
        match self {
            Self::Bar | Self::Disc | Self::Diamond => "mark",
            Self::HollowBar | Self::Circle | Self::HollowDiamond => "hollow",
        }
    }
}

impl Rows {
    /// The chart as an SVG element.
    pub fn svg(&self) -> String {
        let left = self.rows.iter().map(|row| width(&row.0)).fold(60.0, f64::max) + 10.0;
        let inner = WIDTH - left - RIGHT;
        let x = Scale::new(self.axis.range.unwrap_or_else(|| self.span()), (left, left + inner));
        let lanes = self.series.iter().map(|series| series.lane + 1).max().unwrap_or(1);
        let row_height = LANE * lanes as f64 + BETWEEN;
        let bottom = HEADING + row_height * self.rows.len() as f64;
        let mut out = String::new();
        self.legend(&mut out, left);
        let mut grid = String::new();
        let ticks = x.ticks((inner / TICK) as usize);
        for (value, label) in &ticks {
            put!(grid, "M{} {HEADING}V{bottom}", px(x.at(*value)));
            text(&mut out, x.at(*value), bottom + TEXT + 2.0, "middle", "quiet", label);
        }
        for place in 1..self.rows.len() {
            put!(grid, "M{left} {}h{inner}", HEADING + row_height * place as f64);
        }
        put!(out, r#"<path class="grid" d="{grid}"/>"#);
        if let Some((value, label)) = self.reference.as_ref().filter(|line| x.shows(line.0)) {
            let at = px(x.at(*value));
            put!(out, r#"<path class="level k-text d-dashed" d="M{at} {HEADING}V{bottom}"/>"#);
            text(&mut out, at, bottom + 2.6 * TEXT, "middle", "", label);
        }
        for (place, (name, values)) in self.rows.iter().enumerate() {
            let top = HEADING + row_height * place as f64 + BETWEEN / 2.0;
            let middle = top + (row_height - BETWEEN) / 2.0;
            text(&mut out, left - 8.0, middle + 4.0, "end", "", name);
            for (series, value) in self.series.iter().zip(values) {
                let y = top + LANE * (series.lane as f64 + 0.5);
                draw(&mut out, series, value, y, &x, (left, left + inner));
            }
        }
        put!(out, r#"<path class="frame" d="M{left} {HEADING}V{bottom}h{inner}"/>"#);
        let base = bottom + 2.6 * TEXT;
        text(&mut out, left + inner, base, "end", "quiet", &self.axis.heading());
        plot(&self.id, &self.title, &self.description, (WIDTH, bottom + FOOT), &out)
    }

    /// The ends of the axis for the values, with 0 where there are bars.
    fn span(&self) -> (f64, f64) {
        let numbers = self.rows.iter().flat_map(|row| &row.1).filter_map(|value| match value {
            Value::Number(number) => Some(*number),
            Value::Missing(_) => None,
        });
        if !self.series.iter().any(|series| series.mark.is_bar()) {
            return span(numbers);
        }
        let (low, high) = span(numbers.chain([0.0]));
        // No margin beyond the line on which bars stand.
        (if low < 0.0 && high > 0.0 && low.abs() < 0.1 * high { 0.0 } else { low }, high)
    }

    fn legend(&self, out: &mut String, left: f64) {
        let mut at = left;
        for series in &self.series {
            // A bar fills the place of its mark.
            let x = at + if series.mark.is_bar() { LEGEND_MARK } else { LEGEND_MARK / 2.0 };
            shape(out, series, x, 10.0, at);
            text(out, at + LEGEND_MARK + 6.0, 14.0, "start", "quiet", &series.label);
            at += LEGEND_MARK + 26.0 + width(&series.label);
        }
    }
}

/// A mark around `x`, or a bar from `from` to about `x`.
fn shape(out: &mut String, series: &Series, x: f64, y: f64, from: f64) {
    let (class, ink) = (series.mark.class(), series.ink.class());
    match series.mark {
        Mark::Bar | Mark::HollowBar => {
            let (low, high) = (from.min(x), from.max(x));
            put!(
                out,
                r#"<rect class="{class} {ink}" x="{}" y="{}" width="{}" height="{}"/>"#,
                px(low),
                px(y - BAR / 2.0 + 1.0),
                px(high - low),
                BAR - 2.0
            );
        }
        Mark::Disc | Mark::Circle => {
            put!(
                out,
                r#"<circle class="{class} {ink}" cx="{}" cy="{}" r="{RADIUS}"/>"#,
                px(x),
                px(y)
            );
        }
        Mark::Diamond | Mark::HollowDiamond => {
            let r = RADIUS + 0.8;
            put!(
                out,
                r#"<path class="{class} {ink}" d="M{} {}l{r} {r} -{r} {r} -{r} -{r}z"/>"#,
                px(x),
                px(y - r)
            );
        }
    }
}

fn draw(
    out: &mut String,
    series: &Series,
    value: &Value,
    y: f64,
    x: &Scale,
    (left, right): (f64, f64),
) {
    let says = |out: &mut String, content: &str| {
        text(out, right - 4.0, y + 4.0, "end", "", content);
        // Whose it is; a bar has no shape apart from its length.
        if !series.mark.is_bar() {
            shape(out, series, right - 4.0 - width(content) - LEGEND_MARK, y, right);
        }
    };
    match value {
        Value::Number(number) if !number.is_finite() => says(out, "not a number"),
        Value::Number(number) if x.shows(*number) => {
            let zero = if x.shows(0.0) { x.at(0.0) } else { left };
            put!(out, "<g><title>{}: {number}</title>", super::write::escaped(&series.label));
            shape(out, series, x.at(*number), y, zero);
            put!(out, "</g>");
        }
        Value::Number(number) => {
            let ink = series.ink.class();
            let below = x.at(*number) < left;
            let (tip, back) = if below { (left + 3.0, 7.0) } else { (right - 3.0, -7.0) };
            put!(out, r#"<path class="mark {ink}" d="M{tip} {y}l{back} -4v8z"/>"#);
            let (at, anchor) = if below { (tip + 13.0, "start") } else { (tip - 13.0, "end") };
            let content = number.to_string().replace('-', "\u{2212}");
            text(out, at, y + 4.0, anchor, "quiet", &content);
        }
        Value::Missing(why) => says(out, why),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(axis: Axis, mark: Mark) -> Rows {
        Rows {
            id: "rows".into(),
            title: "Rows".into(),
            description: "Of three kinds".into(),
            axis,
            reference: Some((50.0, "half & half".into())),
            series: vec![Series { label: "ours & theirs".into(), ink: Ink::Blue, mark, lane: 0 }],
            rows: vec![
                ("<a>".into(), vec![Value::Number(10.0)]),
                ("b".into(), vec![Value::Number(-853.0)]),
                ("c".into(), vec![Value::Missing("not <declared>".into())]),
            ],
        }
    }

    #[test]
    fn what_lies_off_the_axis_or_is_missing_is_said() {
        let svg = rows(Axis::new("delay", "samples").from_to(0.0, 100.0), Mark::Disc).svg();
        assert!(svg.contains("\u{2212}853"));
        assert!(svg.contains("not &lt;declared&gt;"));
        // One disc in the legend, one in the chart, one before the words.
        assert_eq!(svg.matches("<circle").count(), 3);
        roxmltree::Document::parse(&svg).expect("well-formed");
    }

    #[test]
    fn bars_stand_on_zero() {
        let mut chart = rows(Axis::new("S", ""), Mark::Bar);
        chart.rows.truncate(1);
        assert_eq!(chart.span().0, 0.0);
        assert!(chart.span().1 > 10.0);
    }
}
