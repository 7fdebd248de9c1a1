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
        let item =
            |effects: String, note: String| Item { key: None, code: false, head: effects, note };
        let weighed = (!self.unfitted.is_empty()).then(|| {
            let names: Vec<&str> = self.unfitted.iter().map(|it| it.effect.as_str()).collect();
            item(names.join(", "), "weighed, and promised too little to be fitted".to_owned())
        });
        let not_shown = self
            .not_shown
            .iter()
            .map(|(effects, reason)| item(effects.clone(), format!("not judged: {reason}")));
        let items: Vec<Item> = weighed.into_iter().chain(not_shown).collect();
        if !items.is_empty() {
            blocks.push(Block::List(items));
        }
        blocks
    }
}
