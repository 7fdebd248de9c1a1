//! What a figure of signals holds: panels one below the other over a common x axis.

use super::axis::Axis;
use super::decimate::Point;
use super::ink::{Dash, Ink};

/// Panels over one x axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name of the figure on its page, unique there.
    pub id: String,
    /// What it is, for those who do not see it.
    pub title: String,
    /// What it shows, for those who do not see it.
    pub description: String,
    /// The x axis.
    pub x: Axis,
    /// Stretches of x that are shaded in all panels.
    pub spans: Vec<Span>,
    /// Places on x that are marked in all panels.
    pub markers: Vec<Marker>,
    /// The panels from top to bottom.
    pub panels: Vec<Panel>,
}

/// A shaded stretch of x.
#[derive(Debug, Clone, PartialEq)]
pub struct Span {
    /// Its begin.
    pub from: f64,
    /// Its end.
    pub to: f64,
    /// What it says at its upper edge.
    pub label: String,
}

/// A marked place on x.
#[derive(Debug, Clone, PartialEq)]
pub struct Marker {
    /// The place.
    pub x: f64,
    /// What it says.
    pub label: String,
    /// Colour of line and text.
    pub ink: Ink,
}

/// One plot of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Height of the plotting area, pixels.
    pub height: f64,
    /// The y axis.
    pub y: Axis,
    /// What is drawn, the lowest first.
    pub layers: Vec<Layer>,
    /// Marks in a strip below.
    pub strip: Option<Strip>,
}

/// Something drawn in a panel. A label puts it into the legend; an empty one does not.
#[derive(Debug, Clone, PartialEq)]
pub enum Layer {
    /// A line through points; a value that is not finite is a gap.
    Line {
        label: String,
        /// The points in the order of x.
        points: Vec<Point>,
        /// Colour.
        ink: Ink,
        /// Dashes.
        dash: Dash,
    },
    /// The area between two curves.
    Band {
        label: String,
        /// `(x, lower, upper)` in the order of x; a value that is not finite is a gap.
        points: Vec<(f64, f64, f64)>,
        /// Colour.
        ink: Ink,
    },
    /// Points without order, with their name at their middle and not in the legend.
    Cloud {
        /// What they are.
        name: String,
        points: Vec<Point>,
        /// Colour.
        ink: Ink,
        /// Whether the name stands below them, not above.
        below: bool,
    },
    /// A horizontal line.
    Level {
        label: String,
        /// Its height.
        y: f64,
        /// Colour.
        ink: Ink,
        /// Dashes.
        dash: Dash,
    },
}

/// Samples that are marked in a strip below a panel: neighbours become one mark.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// What the marks say, at the left.
    pub label: String,
    /// Where the marked samples begin, in order.
    pub starts: Vec<f64>,
    /// Length of a sample on x.
    pub step: f64,
    /// Colour.
    pub ink: Ink,
}

impl Layer {
    pub(super) fn label(&self) -> &str {
        match self {
            Self::Line { label, .. } | Self::Band { label, .. } | Self::Level { label, .. } => {
                label
            }
            Self::Cloud { .. } => "",
        }
    }

    /// The values that an axis must hold, of what lies between two places on x.
    pub(super) fn values(&self, x: (f64, f64)) -> Vec<f64> {
        let seen = |at: f64| x.0 <= at && at <= x.1;
        match self {
            Self::Line { points, .. } | Self::Cloud { points, .. } => {
                points.iter().filter(|p| seen(p.0)).map(|p| p.1).collect()
            }
            Self::Band { points, .. } => {
                points.iter().filter(|p| seen(p.0)).flat_map(|p| [p.1, p.2]).collect()
            }
            Self::Level { y, .. } => vec![*y],
        }
    }

    /// The places that an x axis must hold.
    pub(super) fn places(&self) -> Vec<f64> {
        match self {
            Self::Line { points, .. } | Self::Cloud { points, .. } => {
                points.iter().map(|p| p.0).collect()
            }
            Self::Band { points, .. } => points.iter().map(|p| p.0).collect(),
            Self::Level { .. } => Vec::new(),
        }
    }
}

impl Strip {
    /// The marked stretches: samples that touch are one.
    pub(super) fn runs(&self) -> Vec<(f64, f64)> {
        let mut runs: Vec<(f64, f64)> = Vec::new();
        for start in &self.starts {
            match runs.last_mut() {
                // Half a step of slack: times are computed.
                Some(run) if start - run.1 < 0.5 * self.step => run.1 = start + self.step,
                _ => runs.push((*start, start + self.step)),
            }
        }
        runs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_that_touch_are_one_mark() {
        let strip = Strip {
            label: String::new(),
            starts: vec![3.0, 4.0, 5.0, 9.0],
            step: 1.0,
            ink: Ink::Text,
        };
        assert_eq!(strip.runs(), [(3.0, 6.0), (9.0, 10.0)]);
    }
}
