//! Which of the fitted candidates is named, by the numbers of [`super::decision`].

use drivescope_plant::effects::law::Variable;

use super::candidate::Candidate;
use super::ground::Ground;
use super::judged::Judged;
use super::round::{Outcome, Round};
use super::spans::are_possible;
use crate::likelihood::{CurveWeight, Law};
use crate::measured::Measured;

/// Why a law is not named whose values are impossible.
const IMPOSSIBLE: &str = "no machine has such values at what was recorded";
/// Standard errors by which a value differs from 0 at least, where it is told from it: its 95 % interval
/// does not hold 0.
const TOLD: f64 = 2.0;

impl Round<'_> {
    /// Whether its kind was named: a harmonic of what was named is no other effect.
    fn is_named(&self, candidate: &Candidate) -> bool {
        self.named.contains(&candidate.name)
    }

    /// Whether it is another formula for what was named: together they may hold a law that
    /// neither is. It is added, and it is no other cause.
    pub(crate) fn refines(&self, candidate: &Candidate) -> bool {
        !self.is_named(candidate)
            && self.named.iter().any(|named| candidate.info.aliases.contains(&named.as_str()))
    }

    /// Whether something was named before of another kind.
    pub(super) fn is_further(&self, one: &Judged) -> bool {
        let candidate = &self.all[one.candidate];
        !self.named.is_empty() && !self.is_named(candidate) && !self.refines(candidate)
    }

    /// Evidence, beside its odds, and size that are asked for.
    pub(super) fn asked(&self, further: bool) -> (f64, f64) {
        let rule = self.rule;
        if further {
            (rule.further_evidence, rule.further_size)
        } else {
            (rule.evidence, rule.size)
        }
    }

    /// Why the candidate is not named; `curve` is the best of those that repeat, with its evidence in
    /// the recordings of the fit.
    pub(super) fn unconvincing(
        &self,
        ground: &Ground,
        one: &mut Judged,
        curve: Option<(&CurveWeight, f64)>,
    ) -> Option<String> {
        let it = one.weighed;
        let (evidence, size) = self.asked(self.is_further(one));
        let share = curve.map_or(1.0, |(_, explains)| it.fitted / explains.max(f64::MIN_POSITIVE));
        let asked = evidence - self.rule.law_odds.ln();
        let own = |id: &str| id == self.all[one.candidate].id;
        if !are_possible(&one.model.fitted.drive, own, self.spans) {
            Some(IMPOSSIBLE.to_owned())
        } else if it.evidence <= asked {
            Some(format!("its evidence is {:.1} only, and {asked:.1} is asked for", it.evidence))
        } else if self.is_disturbance(one) {
            Some(
                "its phase changes from recording to recording: it does not belong to the machine"
                    .to_owned(),
            )
        } else if it.repeats <= 0.0 && !self.explains_torque(&one.model.fitted.drive) {
            // A slow random load explains what never changes in them, at the price of one value.
            Some("the validation data do not speak for it".to_owned())
        } else if share < self.rule.share
            && !curve.is_some_and(|(it, _)| self.is_apart(ground, one, it))
        {
            let share = 100.0 * share.max(0.0);
            Some(format!("it has {share:.0} % of the evidence of a free curve"))
        } else if it.size.is_nan() && !self.acts_beside(&self.all[one.candidate]) {
            Some("what it makes of the balance cannot be told".to_owned())
        } else if it.size < size && !self.acts_beside(&self.all[one.candidate]) {
            one.weighed.small = true;
            let (is, asked) = (100.0 * it.size, 100.0 * size);
            Some(format!("it makes {is:.1} % of the balance only, and {asked} % are asked for"))
        } else {
            None
        }
    }

    /// Refuses it where no machine has its fitted values; in free run, unless one of its coefficients is
    /// told from 0, or none of their errors is known. Whether it stands.
    pub(super) fn stands_apart(&self, one: &mut Judged) -> bool {
        let own = |id: &str| id == self.all[one.candidate].id;
        if !are_possible(&one.model.fitted.drive, own, self.spans) {
            one.refused = Some(IMPOSSIBLE.to_owned());
            return false;
        }
        let observed = self.model.setting.observer.follows();
        if observed {
            // Its motion tells little of the values, and so do their errors.
            return true;
        }
        let it = &self.all[one.candidate];
        let fitted = &one.model.fitted.parameters;
        let own = it.coefficients.iter().filter_map(|name| {
            let name = format!("{}.{name}", it.id);
            fitted.iter().find(|it| it.name == name && it.std_error.is_finite())
        });
        let told: Vec<bool> = own.map(|it| it.value.abs() > TOLD * it.std_error).collect();
        let stands = told.is_empty() || told.contains(&true);
        if !stands {
            one.refused = Some("its values are not told from 0".to_owned());
        }
        stands
    }

    /// Whether a curve explains something else, over other variables, so that the evidence of the law
    /// stays beside it: over the same ones the law takes what a curve of few values leaves.
    fn is_apart(&self, ground: &Ground, one: &Judged, curve: &CurveWeight) -> bool {
        let it = &self.all[one.candidate];
        if curve.curve.variables().iter().any(|variable| it.fails_over.contains(variable)) {
            return false;
        }
        let law = Law { id: &it.id, coefficients: &it.coefficients };
        let stays = ground.beside_curve(&one.model.fitted.drive, &law, &it.estimated(), curve);
        stays.is_some_and(|stays| stays >= self.rule.share * one.weighed.evidence)
    }

    /// Whether it is locked to the position in each recording and has no phase that they share: no
    /// part of the machine, and better known than left in the way of what is.
    pub(super) fn is_disturbance(&self, one: &Judged) -> bool {
        let it = one.weighed;
        let candidate = &self.all[one.candidate];
        let locked =
            candidate.is_linear() && candidate.fails_over.first() == Some(&Variable::Theta);
        let silent = it.fitted > self.rule.evidence && it.repeats <= 0.0;
        locked && silent && !self.is_one_recording()
    }

    /// Whether what was held out is the rest of a recording of the fit: positions then count from one
    /// zero, and no phase can change between them.
    fn is_one_recording(&self) -> bool {
        let fitted = &self.estimation.recordings;
        self.validation.recordings.iter().any(|next| fitted.iter().any(|it| continues(it, next)))
    }

    /// Whether a curve that repeats shows that something is missing.
    pub(super) fn stands(&self, curve: &CurveWeight) -> bool {
        let (evidence, size) = self.asked(!self.named.is_empty());
        curve.evidence + self.rule.curve_odds.ln() > evidence && curve.size >= size
    }

    /// Puts the simplest of those that pass and are not told from the best of them before it.
    pub(super) fn simplest_of_equal(&self, judged: &mut [Judged]) {
        let Some(best) = judged.iter().position(|one| one.refused.is_none()) else { return };
        let parameters = |one: &Judged| self.all[one.candidate].parameters().len();
        let info = |one: &Judged| self.all[one.candidate].info;
        let evidence = |one: &Judged| one.weighed.evidence;
        let close = |one: &Judged| {
            let less = evidence(&judged[best]) - evidence(one);
            let instead = info(&judged[best]).excludes.contains(&info(one).id);
            let nested = if instead { self.rule.nested * evidence(&judged[best]) } else { 0.0 };
            one.refused.is_none() && less < self.rule.confused.max(nested)
        };
        let simplest = (best..judged.len())
            .filter(|k| close(&judged[*k]))
            .min_by_key(|k| parameters(&judged[*k]));
        if let Some(simplest) = simplest {
            judged[best..=simplest].rotate_right(1);
        }
    }

    /// Puts what every machine has before all others that pass: what stands in its place is asked again
    /// beside it.
    pub(super) fn basic_first(&self, judged: &mut [Judged]) {
        judged.sort_by_key(|one| {
            let basic = self.all[one.candidate].info.basic && one.refused.is_none();
            u8::from(!basic)
        });
    }

    /// What the recordings do not tell from it: laws with as much evidence, and one that has more and
    /// excludes it, for only one of them can stand in the drive.
    pub(crate) fn confusion_set(&self, one: &Judged, outcome: &Outcome) -> Vec<String> {
        let Candidate { info, name, .. } = &self.all[one.candidate];
        let alike = |other: &&Judged| {
            let id = self.all[other.candidate].name.as_str();
            let more = other.weighed.evidence - one.weighed.evidence;
            let instead = info.excludes.contains(&id) && more > 0.0;
            let speaks = other.weighed.evidence > self.rule.confused;
            id != name && speaks && (more.abs() < self.rule.confused || instead)
        };
        let name = |other: &Judged| self.all[other.candidate].name.clone();
        let mut set: Vec<String> = outcome.judged.iter().filter(alike).map(name).collect();
        set.dedup();
        set
    }
}

/// Whether one is the part of a recording that comes after the other.
fn continues(first: &Measured, next: &Measured) -> bool {
    let end_s = first.clock.start_s + first.len() as f64 * first.period_s;
    first.name == next.name && next.clock.start_s > end_s - first.period_s
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{bench, dr300};

    #[test]
    fn the_rest_of_a_recording_is_known_from_another_one() {
        let drive = dr300();
        let measured = |recording| Measured::new(&drive, &recording).expect("usable");
        let whole = bench(&drive, 2.0, 0.001);
        let (mut first, mut rest) = (whole.clone(), whole.clone());
        for signal in &mut first.signals {
            signal.values.truncate(1400);
        }
        for signal in &mut rest.signals {
            signal.values.drain(..1400);
        }
        rest.start_s += 1.4;
        let [whole, first, rest] = [whole, first, rest].map(measured);
        assert!(continues(&first, &rest));
        assert!(!continues(&rest, &first) && !continues(&first, &whole));
    }
}
