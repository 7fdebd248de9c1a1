//! When which fault happens, and what came of it.
//!
//! [`results`] is what a study finds, as `study.json` holds it.

pub mod results;
