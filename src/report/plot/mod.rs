//! Small plots as inline SVG: what a report shows, readable without colour and without a script.
//!
//! ```text
//!  Figure ── x axis, spans and markers through all panels
//!    └ Panel ── y axis, layers (line, band, cloud, level), strip of marks below
//!  Rows ── one row a category: bars or marks on one axis
//! ```
//!
//! A figure draws data of any length: lines are reduced to the extremes of each pixel column
//! ([`decimate`]), so that the size of the SVG depends on its width alone. Colours and dashes come
//! from [`STYLE`], which the page includes once; colours are those of Okabe and Ito (Color
//! Universal Design, 2008), and each pairs with a dash or a shape. Every figure carries its title
//! and its description for readers who do not see it; data tables are the page's affair.

pub mod axis;
pub mod decimate;
mod draw;
mod figure;
mod frame;
mod ink;
mod path;
mod rows;
mod write;

pub use axis::Axis;
pub use decimate::Point;
pub use figure::{Figure, Layer, Marker, Panel, Span, Strip};
pub use ink::{Dash, Ink, STYLE};
pub use rows::{Mark, Rows, Series, Value};
