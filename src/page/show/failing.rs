//! Where and when the model fails: all of it, or within a brushed window.

use drivescope_discovery::compare::Comparison;
use drivescope_plant::drive::Motion;
use maud::html;

use super::offered;
use crate::answer::block::Block;
use crate::answer::compare::{curves, findings, part, spans, whiteness};
use crate::answer::html;
use crate::page::window::Window;
use crate::report::words::given;

/// The spans of a recording, each with its sentence.
pub(super) fn when(compared: &Comparison, recording: usize) -> Vec<Block> {
    let heading = Block::Heading("When it fails".to_owned());
    [heading].into_iter().chain(compared.recordings.get(recording).map(spans)).collect()
}

/// The variables over which it fails, and what is missing over each.
pub(super) fn over_what(compared: &Comparison, motion: Motion) -> Vec<Block> {
    let mut blocks = vec![Block::Heading("Where it fails".to_owned())];
    blocks.extend(findings(compared, motion));
    blocks.push(curves(compared, "where"));
    blocks
}

/// Whether the residual of a recording is white.
pub(super) fn white(compared: &Comparison, recording: usize) -> Vec<Block> {
    let of = compared.recordings.get(recording);
    of.map(|it| whiteness(it, recording)).into_iter().collect()
}

/// Where the model fails within a brushed window.
pub(in crate::page) fn within(window: &Window, (from, to): (f64, f64)) -> String {
    html! {
        section.within aria-labelledby="within-h" {
            h3 #within-h { "Within " (given(from)) " to " (given(to)) " s" }
            (html::page(&part(&window.compared, &window.errors), &offered))
        }
    }
    .into_string()
}
