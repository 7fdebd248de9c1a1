//! The report of a discovery: what is missing, the ladder of errors, parameters, and what is left.

use drivescope_discovery::Estimate;
use drivescope_discovery::compare::Comparison;
use drivescope_plant::drive::Motion;
use maud::html;

use super::page::page;
use crate::answer::block::Block;
use crate::answer::compare::{self, Setting};
use crate::answer::discover::{Missing, Step, ladder};
use crate::answer::html::report;
use crate::answer::parameters;

/// What a report of a discovery holds beside what is missing.
pub(crate) struct Found<'a> {
    /// The drive at the end, compared.
    pub(crate) compared: &'a Comparison,
    /// What the comparison rests on.
    pub(crate) setting: &'a Setting,
    /// The drive that the cards speak of, compared: before anything was added.
    pub(crate) before: &'a Comparison,
    /// What was missing in it, if that was asked.
    pub(crate) missing: Option<&'a Missing>,
    /// Motion of the drive.
    pub(crate) motion: Motion,
    /// The ladder.
    pub(crate) steps: &'a [Step],
    /// Parameters of the drive at the end.
    pub(crate) parameters: &'a [Estimate],
}

/// One self-contained HTML page.
pub(crate) fn discover_html(found: &Found<'_>) -> String {
    let title = format!("What the model lacks: {}", found.setting.drive);
    let about =
        html! { "A drive's model compared with recordings of the drive, and what it lacks." };
    let section = |id, title, blocks| Block::Section { id, title, blocks };
    let missing = found
        .missing
        .map(|missing| section("missing", "What is missing", missing.blocks(&found.before.curves)));
    let known = found.parameters.iter().map(|it| (it, String::new()));
    let rest = [
        section("ladder", "The error, step by step", ladder(found.motion, found.steps)),
        section("parameters", "Parameters", vec![parameters(known)]),
        section("after", "The model at the end", compare::blocks(found.compared, found.setting)),
    ];
    let sections: Vec<Block> = missing.into_iter().chain(rest).collect();
    let made = html! {
        "drivescope discover, seed " (found.setting.seed) ". The same files and seed give the \
         same figures."
    };
    page(&title, &about, &report(&sections), &made)
}
