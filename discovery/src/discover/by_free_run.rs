//! Laws that the free run shows and the filter does not.
//!
//! A filter lets a random load take what a law would explain, and seeks the law from parameters that
//! were fitted beside that load: where they are far from the law's own, it does not find it. In free
//! run nothing takes the error, and a combination of the columns of base and law holds most of it.

use rayon::prelude::*;

use super::candidate::Candidate;
use super::columns::FittedDrive;
use super::ground::Ground;
use super::judged::Judged;
use super::round::Round;
use crate::likelihood::Weights;

/// Laws that are fitted.
const FITTED: usize = 2;

impl Round<'_> {
    /// Puts the laws of one mass that explain the error of the free run among the judged ones, where
    /// none of those convinces; whether there are any.
    pub(super) fn of_free_run(
        &self,
        ground: &Ground,
        weights: &Weights,
        judged: &mut Vec<Judged>,
    ) -> bool {
        let convinced = judged.iter().any(|one| one.refused.is_none());
        if convinced || ground.filtered().is_none() || self.is_at_floor() || self.watch.stopped() {
            return false;
        }
        let held = |(k, it): (usize, &Candidate)| {
            let own = it.is_linear() && !self.is_of_free_run(it);
            own.then(|| (k, self.held_in_free_run(it))).filter(|it| it.1 > self.rule.share)
        };
        let all = self.all.par_iter().enumerate();
        let mut shown: Vec<(usize, f64)> = all.filter_map(held).collect();
        shown.sort_by(|a, b| b.1.total_cmp(&a.1));
        shown.truncate(FITTED);
        let fitted = |(candidate, _): &(usize, f64)| {
            let found = self.fit_of_free_run(ground, &self.all[*candidate], &[0], None)?;
            // What leaves more may only resemble what is missing.
            self.explains_all(&found.model).then(|| found.judged(*candidate))
        };
        let fitted: Vec<Judged> = shown.par_iter().filter_map(fitted).collect();
        let some = !fitted.is_empty();
        self.judge(ground, weights, fitted, judged);
        some
    }

    /// Share of the squared error of the free run above its floor that columns of the base and of a law
    /// hold together.
    fn held_in_free_run(&self, it: &Candidate) -> f64 {
        let Some(variant) = it.variants.first() else { return 0.0 };
        let drive = it.added(&self.model.fitted.drive, variant);
        let setting = self.model.setting.of(&drive);
        let at = FittedDrive { drive: &drive, setting: &setting, ..self.model.at(self.estimation) };
        let own = it.coefficients.iter().map(|name| format!("{}.{name}", it.id));
        let names: Vec<String> = self.model.names().into_iter().chain(own).collect();
        let [was, remainder] = at.squares_left(&names);
        let excess = was - self.floor(self.estimation);
        if excess > 0.0 && remainder.is_finite() { (was - remainder) / excess } else { 0.0 }
    }
}
