//! Reports: one HTML file that explains itself, offline, in any browser, on paper.
//!
//! A report is self-contained: styles and pictures are inline, nothing is loaded and no script
//! runs (its content security policy forbids both). [`plot`] draws.

pub(crate) mod campaign;
pub(crate) mod compare;
pub(crate) mod discover;
pub(crate) mod page;
pub mod plot;
mod recording;
pub(crate) mod speed;
pub(crate) mod study;
#[cfg(test)]
pub(crate) mod testing;
pub(crate) mod words;

pub use recording::recording_html;
