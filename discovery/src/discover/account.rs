//! What the loop writes down of its rounds: the ranking, the steps of the ladder, what is named, what is
//! not, and why.

use drivescope_plant::drive::Drive;

use super::experiment;
use super::form::{Instead, Refused};
use super::judged::Judged;
use super::needless::Added;
use super::refit::Model;
use super::report::{Discovery, LadderStep, Step, Verdict, Watch};
use super::round::{Outcome, Round};
use super::typed;
use crate::balances::unexplained;
use crate::estimate::{Evidence, output_fits};

impl Discovery {
    /// Notes the ranking of a round, and what to record to tell what it does not.
    pub(super) fn note(&mut self, turn: &Round<'_>, outcome: &Outcome, passed: Option<usize>) {
        let ranked = |one: &Judged| turn.ranked(one, outcome);
        let first = self.ladder.len() == 1;
        if first {
            self.ranking = outcome.judged.iter().map(ranked).collect();
        } else {
            self.ranking.extend(passed.map(|best| ranked(&outcome.judged[best])));
        }
        let Some(best) = passed else { return };
        let set = turn.confusion_set(&outcome.judged[best], outcome);
        if first {
            let named = &turn.all[outcome.judged[best].candidate].name;
            let rivals = self.ranking.iter_mut().filter(|it| it.effect != *named);
            for one in rivals.filter(|it| it.refused.is_none()) {
                one.refused = Some(if set.contains(&one.effect) {
                    format!("not told from {named} here")
                } else {
                    format!("{named} explains more")
                });
            }
        }
        if self.next_experiment.is_some() {
            return;
        }
        let id = |one: &Judged| turn.all[one.candidate].name.clone();
        let is_in = |one: &&Judged| set.contains(&id(one));
        let models: Vec<(String, &Model)> = std::iter::once(&outcome.judged[best])
            .chain(outcome.judged.iter().filter(is_in))
            .map(|one| (id(one), &one.model))
            .collect();
        self.next_experiment = experiment::next(turn.model, &models, turn.estimation, turn.spans);
    }

    /// The drive at the end, and its parameters beside the values of the user's file.
    pub(super) fn end(&mut self, drive: Drive, of_user: &Drive) {
        self.drive = typed::restored(drive, of_user);
        let given = of_user.parameters();
        for it in &mut self.parameters {
            let before = given.iter().find(|other| other.name == it.name);
            it.before = before.map_or(f64::NAN, |other| other.value);
        }
    }

    /// Tells of an effect no more, nor of the last one, which is told without it.
    pub(super) fn take_back(&mut self, kind: &str, remaining: &[Added]) {
        self.ladder.pop();
        let place = self.ladder.iter().rposition(|step| step.added.as_deref() == Some(kind));
        place.map(|place| self.ladder.remove(place));
        self.unname(remaining);
        let beside = self.named.join(" and ");
        self.refuse(kind, remaining, &format!("not needed beside {beside}"));
    }

    /// Tells of nothing that was added any more, and that what is missing is unknown; the ladder ends with
    /// the base.
    pub(super) fn take_all_back(&mut self, base: &Model, why: &str) {
        let named = std::mem::take(&mut self.named);
        named.iter().for_each(|kind| self.refuse(kind, &[], why));
        self.ladder.truncate(1);
        self.parameters.clone_from(&base.fitted.parameters);
        (self.remaining, self.learned, self.closer_than) = (Verdict::Unknown, None, None);
        self.formulas.clear();
    }

    /// Tells of formulas in the place of a law or, where that is of the right kind, of what is left as
    /// of its form; the drive that remains.
    pub(super) fn put(
        &mut self,
        it: Instead,
        added: &mut Vec<Added>,
        model: Model,
        evidence: (&Evidence, &Evidence),
        watch: &dyn Watch,
    ) -> Model {
        let Instead { place, formulas, probability, refused } = it;
        let kind = added[place].kind.clone();
        self.formulas = formulas;
        self.reconsider(&kind, probability);
        let Some(Refused { model: without, learned, why }) = refused else {
            (self.remaining, self.learned) = (Verdict::None, None);
            // One that refines what was named is not named itself.
            let named = self.named.iter().find(|it| **it == kind).or(self.named.last()).cloned();
            self.reconsider(named.as_deref().unwrap_or_default(), probability);
            self.closer_than = named;
            return model;
        };
        added.remove(place);
        self.refuse(&kind, added, &why);
        self.unname(added);
        self.ladder.pop();
        if place < added.len() {
            let of_it = self.ladder.iter().rposition(|it| it.added.as_deref() == Some(&*kind));
            of_it.map(|of_it| self.ladder.remove(of_it));
            self.climb(added.last().map(|it| it.kind.clone()), &without, evidence, watch);
        }
        (self.remaining, self.learned) = (Verdict::Unknown, learned);
        without
    }

    /// Tells of an effect that it is that probable, beside what was not ranked with it.
    fn reconsider(&mut self, kind: &str, probability: f64) {
        for one in self.ranking.iter_mut().filter(|it| it.effect == kind) {
            one.probability = probability;
        }
    }

    /// Names what is left alone.
    fn unname(&mut self, remaining: &[Added]) {
        self.named.retain(|name| remaining.iter().any(|it| it.kind == *name));
        // One that refined what was named stands for it now.
        let of_last = remaining.last().map(|it| &it.kind).filter(|it| !self.named.contains(it));
        self.named.extend(of_last.cloned());
    }

    /// Says why an effect is not named of which nothing is left.
    fn refuse(&mut self, kind: &str, remaining: &[Added], why: &str) {
        if remaining.iter().any(|it| it.kind == kind) {
            return;
        }
        for one in self.ranking.iter_mut().filter(|it| it.effect == kind && it.refused.is_none()) {
            one.refused = Some(why.to_owned());
        }
    }

    pub(super) fn climb(
        &mut self,
        added: Option<String>,
        model: &Model,
        (estimation, validation): (&Evidence, &Evidence),
        watch: &dyn Watch,
    ) {
        let drive = &model.fitted.drive;
        let (setting, validated) = (&model.setting, &model.validation.recordings);
        let step = LadderStep {
            fit_percent: output_fits(drive, estimation, setting, &model.fitted.recordings),
            validation_fit_percent: output_fits(drive, validation, setting, validated),
            added,
            unexplained: unexplained(drive, estimation).into(),
            validation_unexplained: unexplained(drive, validation).into(),
            error: model.fitted.squares.error(),
            validation_error: model.validation.squares.error(),
        };
        watch.step(&Step::Ladder(&step));
        self.ladder.push(step);
        self.parameters = model.fitted.parameters.clone();
    }
}
