//! Laws of two masses: far from their nulls they are told only by their fits, which take long.

use super::at_best::is_evident;
use super::ground::Ground;
use super::judged::Judged;
use super::round::Round;
use crate::likelihood::{LawWeight, Weights};

/// Share of what the best fitted law explains that one of two masses must promise at its null; along a
/// known motion a column holds all that it would explain.
const PROMISED: f64 = 0.4;
/// Share of the error above its floor that must go with what convinces, lest a second mass be what is
/// missing.
const EXPLAINS: f64 = 0.5;

impl Round<'_> {
    /// Puts the laws of two masses, fitted, among the judged ones, where one promises a part of what those
    /// that convince have, or these leave most of the error; whether there are any.
    pub(super) fn of_two_masses(
        &self,
        ground: &Ground,
        weights: &Weights,
        judged: &mut Vec<Judged>,
    ) -> bool {
        let convince = || judged.iter().filter(|one| one.refused.is_none());
        let most = convince().fold(0.0_f64, |most, one| most.max(one.weighed.evidence));
        let part = if ground.filtered().is_some() { PROMISED } else { 1.0 };
        let of_two = |it: &&LawWeight| self.is_of_free_run(&self.all[it.candidate]);
        let two: Vec<&LawWeight> = weights.laws.iter().filter(of_two).collect();
        let promises = |it: &&LawWeight| {
            let evident = || is_evident(it) && it.evidence >= part * most;
            self.acts_beside(&self.all[it.candidate]) || evident()
        };
        let promised = two.iter().any(promises);
        let lowers = |one: &&Judged| one.lowers && !one.weighed.by_balance;
        let leaves = |one: &&Judged| self.removed_of_validation(&one.model) < EXPLAINS;
        let doubtful = convince().find(lowers).filter(leaves);
        if !promised && doubtful.is_none() {
            return false;
        }
        // What knocks is fitted last: its starts lead nowhere where the same without play leaves little, and
        // where that leaves more than what is doubted, play is not why.
        let (knocking, others): (Vec<&LawWeight>, Vec<&LawWeight>) =
            two.into_iter().partition(|it| self.all[it.candidate].info.knocks);
        let sum = |one: &Judged| one.model.fitted.squares.sum;
        let mut fitted = self.at_their_best(ground, &others);
        let least = fitted.iter().map(sum).min_by(f64::total_cmp);
        let lower = least.zip(doubtful.map(sum)).is_some_and(|(least, left)| least < left);
        if promised || lower {
            fitted.extend(self.fitted_beside(ground, &knocking, least));
        }
        // In the order that was decided where nothing joins.
        if fitted.is_empty() {
            return false;
        }
        self.judge(ground, weights, fitted, judged);
        true
    }
}
