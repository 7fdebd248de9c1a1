//! Whether the formula of a named law is the right one: another one in its place may explain far more,
//! and then the library has no law for what is missing, or only one of its kind.

use drivescope_plant::drive::Drive;

use super::ground::Ground;
use super::learned::LearnedCurve;
use super::needless::{Added, without};
use super::refit::{Model, fit_near};
use super::round::Round;
use super::spans::spans;
use crate::formula::Formula;

/// Formulas of which one must lower the error: a fit of the most probable may end beside its optimum.
const FITTED: usize = 3;

/// Formulas that explain more than a named law in its place.
pub(super) struct Instead {
    /// The number of the law among those that were added.
    pub(super) place: usize,
    /// The most probable first.
    pub(super) formulas: Vec<Formula>,
    /// Probability of the law beside that of the best formula.
    pub(super) probability: f64,
    /// What becomes of the name, where the law is not even of the right kind.
    pub(super) refused: Option<Refused>,
}

/// A name that is taken back.
pub(super) struct Refused {
    /// The drive without the law, fitted.
    pub(super) model: Model,
    /// What is missing of it as a curve, where one shows it.
    pub(super) learned: Option<LearnedCurve>,
    /// Why, for a person.
    pub(super) why: String,
}

impl Round<'_> {
    /// The last of the laws that were added, to the drive of the round, in whose place formulas have
    /// the evidence that a name needs over it and the error falls as far, and which has not that evidence
    /// itself beside the best of them. `beyond` are formulas for what the laws leave: where one of them and
    /// the law explain more together, the law stays. What was named by the torque alone has no error of a
    /// motion to compare.
    pub(super) fn formulas_instead(&self, added: &[Added], beyond: &[Formula]) -> Option<Instead> {
        let asked = added.iter().enumerate().rev().filter(|(_, it)| it.by_error);
        let beyond = beyond.first().map(Formula::worth);
        asked.filter(|_| !self.watch.stopped()).find_map(|it| self.formulas_instead_of(it, beyond))
    }

    fn formulas_instead_of(
        &self,
        (place, it): (usize, &Added),
        beyond: Option<f64>,
    ) -> Option<Instead> {
        let drive = &self.model.fitted.drive;
        let law = drive.effects.iter().find(|effect| effect.id == it.id)?;
        let model = self.fitted(&without(drive, &it.id))?;
        let spans = spans(&model.fitted.drive, self.estimation);
        let named: Vec<String> =
            self.named.iter().filter(|kind| **kind != it.kind).cloned().collect();
        let beside = Round { all: &[], spans: &spans, named: &named, formulas: &[], ..*self };
        let turn = Round { model: &model, ..beside };
        let ground = turn.ground()?;
        let of_law = |ground: &Ground| {
            let own = ground.with(std::slice::from_ref(law), &it.estimated, &it.coefficients);
            // Where the drive is more probable without it, nothing speaks for it.
            own.map_or(0.0, |(_, own)| own.over(ground.base())[1])
        };
        let evidence = of_law(&ground);
        // Both as probable beforehand as the rule of naming has it.
        let rule = self.rule;
        let ln_odds = rule.law_odds.ln() - rule.curve_odds.ln();
        let alone = evidence + ln_odds + rule.evidence;
        let together = beyond.map_or(alone, |beyond| evidence + rule.law_odds.ln() + beyond);
        let formulas = turn.formulas_beyond(&ground, alone.max(together));
        let best = formulas.first()?;
        let with = self.fitted(&best.added(&model.fitted.drive))?;
        let needed = Round { model: &with, ..beside }.ground().map(|it| of_law(&it))?;
        if needed + rule.law_odds.ln() > rule.evidence {
            return None;
        }
        let removed = [self.model, &with].map(|it| turn.removed_of_validation(it));
        // What a filter tells of two masses is little; the error tells more.
        let nearly = 1.0 - rule.formula;
        if removed[1] < nearly * removed[0] {
            return None;
        }
        let of_kind = removed[0] >= nearly * removed[1];
        let refused = (!of_kind).then(|| {
            let curve = turn.weights(&ground).and_then(|weights| turn.unknown(&ground, &weights));
            let learned = curve.map(|curve| turn.drawn(&curve, &formulas));
            let [own, more] = removed.map(|it| 100.0 * it.max(0.0));
            let why = format!(
                "a formula removes {more:.0} % of the excess error on the validation data where it \
                 removes {own:.0} %"
            );
            Refused { model: model.clone(), learned, why }
        });
        let probability = 1.0 / (1.0 + (best.worth() - evidence - ln_odds).exp());
        Some(Instead { place, formulas, probability, refused })
    }

    /// Formulas that show that something is missing where no curve does: a form with few values takes
    /// less evidence to see than a curve. As much evidence is asked as of a curve, and that
    /// the error on the validation data falls with it: by what counts, or to its floor where it is
    /// smaller than what counts.
    pub(super) fn formulas_alone(&self, ground: &Ground) -> Vec<Formula> {
        let rule = self.rule;
        let formulas = self.formulas_beyond(ground, rule.evidence - rule.curve_odds.ln());
        let shows = |it: &Formula| {
            let with = it.added(&self.model.fitted.drive);
            let asked = if it.size < rule.size { 1.0 - rule.formula } else { rule.size };
            self.fitted(&with).is_some_and(|with| self.removed_of_validation(&with) >= asked)
        };
        if formulas.iter().take(FITTED).any(shows) { formulas } else { Vec::new() }
    }

    /// That drive, fitted from the values of the round on.
    pub(super) fn fitted(&self, drive: &Drive) -> Option<Model> {
        let stopped = |_| self.watch.stopped();
        fit_near(self.model, drive, self.estimation, self.validation, &stopped).ok()
    }
}
