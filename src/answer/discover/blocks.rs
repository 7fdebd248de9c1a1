//! What was found to be missing, as blocks.

use drivescope_discovery::compare::Curve;

use super::cards::cards;
use super::missing::Missing;
use crate::answer::block::{Block, Item};

impl Missing {
    /// All of it, beside what was missing over each variable in the drive that it is missing in.
    pub(crate) fn blocks(&self, curves: &[Curve]) -> Vec<Block> {
        let mut blocks = vec![self.verdict_in_words("")];
        blocks.extend(self.unusable.iter().map(|why| Block::Alert(why.clone())));
        blocks.extend(self.candidates(curves));
        blocks.extend(self.what_is_left());
        blocks
    }

    /// What may be missing, and what could not be judged.
    pub(super) fn candidates(&self, curves: &[Curve]) -> Vec<Block> {
        let mut blocks = vec![Block::Cards(cards(self, curves))];
        if !self.not_shown.is_empty() {
            let item = |(effects, reason): &(String, String)| Item {
                key: None,
                code: false,
                head: effects.clone(),
                note: format!("not judged: {reason}"),
            };
            blocks.push(Block::List(self.not_shown.iter().map(item).collect()));
        }
        blocks
    }
}
