//! What a study found: twelve faults under every detector, beside the paper's figures.
//!
//! The answer is [`StudyResults`], which study.json holds; here it is told. A section of the report
//! is an entry of [`SECTIONS`] with a function in a file beside this one.

mod detection;
mod figures;
mod fmu;
mod hidden;
mod identification;
mod isolation;
mod levels;
mod matrix;
mod models;
mod residual;
mod runs;
mod setting;
mod summary;
#[cfg(test)]
mod tests;
mod trace;
mod words;

use drivescope_scenarios::results::{Pictures, StudyResults};

use super::block::{Block, HTML, REPORT, TERMINAL};

/// A section.
struct Section {
    /// Its id, to which the contents lead.
    id: &'static str,
    /// Its name in the contents.
    name: &'static str,
    title: &'static str,
    /// What it says of a study and the traces of its runs; nothing, if it has nothing to say.
    blocks: fn(&StudyResults, &[Pictures]) -> Vec<Block>,
}

macro_rules! sections {
    ($($id:literal, $name:literal, $title:literal, $blocks:expr;)+) => {
        /// The sections in their order; the contents follow them.
        const SECTIONS: &[Section] =
            &[$(Section { id: $id, name: $name, title: $title, blocks: $blocks }),+];
    };
}

sections! {
    "setting", "Experiment", "Experiment", |study, _| setting::blocks(study);
    "detection", "Detection", "Detection of each fault (Table 1 of the paper)", detection::blocks;
    "figures", "Figures 3 and 4", "Figures 3 and 4 of the paper, from our runs", figures::blocks;
    "runs", "Runs", "Each run: residual and bands", runs::blocks;
    "residual", "Residual and false alarms", "Residual and false alarms",
        |study, _| residual::blocks(study);
    "models", "Models", "Structures of the models", |study, _| models::blocks(study);
    "isolation", "Isolation", "Isolation: symptoms (Fig. 5) and classes (Table 2 of the paper)",
        |study, _| isolation::blocks(study);
    "identification", "Sizes", "Size of the symptom (Table 3 of the paper)",
        |study, _| identification::blocks(study);
    "hidden-effect", "Hidden effect", "What a hidden effect costs", |study, _| hidden::blocks(study);
    "levels", "Levels", "Significance levels", |study, _| levels::blocks(study);
    "readings", "Other readings", "Other readings of the torque fault",
        |study, _| levels::readings(study);
    "fmu", "FMU", "The FMU against other runs", |study, _| fmu::blocks(study);
    "reading", "How to read this", "How to read these figures", |study, _| summary::reading(study);
}

/// The answer in blocks: the verdict first in a report, and last on a terminal, where the eye is when
/// the program ends.
pub(crate) fn blocks(study: &StudyResults, pictures: &[Pictures]) -> Vec<Block> {
    let all = SECTIONS.iter().map(|it| (it, (it.blocks)(study, pictures)));
    let sections: Vec<(&Section, Vec<Block>)> =
        all.filter(|(_, blocks)| !blocks.is_empty()).collect();
    let names = sections.iter().map(|(it, _)| (it.id.to_owned(), it.name.to_owned())).collect();
    let contents = Block::Contents(vec![names, runs::names(pictures)]);
    let mut blocks =
        vec![Block::In(HTML, summary::headline(study)), Block::In(REPORT, vec![contents])];
    let section = |(it, blocks): (&Section, Vec<Block>)| Block::Section {
        id: it.id,
        title: it.title,
        blocks,
    };
    blocks.extend(sections.into_iter().map(section));
    blocks.push(Block::In(TERMINAL, summary::verdicts(study)));
    blocks
}
