//! A law that was named alone, and only resembles what is missing, is taken back: the answer is then
//! "unknown", with the curve.

use super::gates;
use super::learned::LearnedCurve;
use super::left::Left;
use super::refit::Model;
use super::report::{Discovery, Step, Verdict, Watch};
use super::scales::Scales;
use crate::estimate::Evidence;

impl Discovery {
    /// The shape of the one law that was named, if something is left that nobody knows and that
    /// law is not nearly the whole of what it and a curve of its kind remove.
    pub(super) fn half_shape(&self) -> Option<f64> {
        let [only] = self.named.as_slice() else { return None };
        let left = self.remaining == Verdict::Unknown && self.ladder.len() == 2;
        let shape = self.ranking.iter().find(|it| it.effect == *only).and_then(|it| it.shape);
        shape.filter(|shape| left && *shape < gates::WHOLE)
    }

    /// Takes back the one law that was named: what is missing is something unknown that it
    /// resembles.
    pub(super) fn take_back(
        &mut self,
        base: &Model,
        shape: f64,
        floor: f64,
        estimation: &Evidence,
        validation: &Evidence,
        watch: &dyn Watch,
    ) {
        watch.step(&Step::Doing("taking a law back that only resembles what is missing"));
        let scales = Scales::of(&base.fitted.drive, estimation);
        let (sight, judge) = (base.sight(estimation), base.validation_sight(validation));
        let left = Left::of(&sight, &judge, &scales, &|| watch.stopped());
        self.learned = LearnedCurve::of_left(&left, true, floor, &base.fitted.drive);
        self.ladder.truncate(1);
        self.parameters = base.fitted.parameters.clone();
        self.next_experiment = None;
        let share = 100.0 * shape;
        let why = format!(
            "it has {share:.0} % of what it and a curve of its kind remove, and no known effect is \
             the rest"
        );
        let named = self.ranking.iter_mut().filter(|it| self.named.contains(&it.effect));
        named.for_each(|it| it.refused = Some(why.clone()));
        self.named.clear();
        if let Some(second) = &mut self.second_opinion {
            second.agrees = second.best.is_none();
        }
    }
}
