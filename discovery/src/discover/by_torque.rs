//! What the balances say of a candidate, that of torques before all, in the recordings held out: where the
//! motion hides what drives it, that is the error that counts.

use drivescope_plant::drive::Drive;

use super::candidate::Candidate;
use super::learned::effect;
use super::refit::Model;
use super::round::Round;
use crate::balances::{acceleration_left, begin, unexplained};
use crate::likelihood::CurveWeight;

/// Share of the unexplained torque that may be left where that alone decides: an observer follows what
/// a slow drive does, and its error says little of it.
const MUCH: f64 = 0.5;

/// Share that a name takes at least of the squared torque that nothing explains along a known motion or
/// behind an observer, where what is left is no random load but what no model holds: on some forty
/// strange machines right names took 40 % and more of it, wrong ones up to 14 %.
const TAKEN: f64 = 0.2;

/// Share of the acceleration that is left at most where that is what tells.
const SWINGS: f64 = 0.5;

impl Round<'_> {
    /// Torque that a drive leaves unexplained in the recordings held out, as a share of the applied one, for
    /// a fit may make all torques small by a small K; none where they do not tell it.
    pub(super) fn torque_left(&self, drive: &Drive) -> Option<f64> {
        self.left(drive)[0]
    }

    /// The same of torque and voltage.
    pub(super) fn left(&self, drive: &Drive) -> [Option<f64>; 2] {
        unexplained(drive, self.validation).map(|left| left.map(|it| it.share))
    }

    /// The same of a drive of that structure at the values of the balances.
    pub(super) fn torque_left_at_balances(&self, drive: &Drive) -> Option<f64> {
        self.torque_left(&begin(drive, self.estimation).drive)
    }

    /// Why a drive with a candidate explains too little of the torque that the round's own leaves, where
    /// that is what tells: along a known motion, or behind an observer. Of a sensor that shows something
    /// else, the voltage tells as well.
    pub(super) fn takes_little(
        &self,
        is_known: bool,
        candidate: &Candidate,
        before: [Option<f64>; 2],
        with: &Drive,
    ) -> Option<String> {
        if !is_known && !self.model.setting.observer.follows() {
            return None;
        }
        // At its own values or at those of the balances, where it goes on from there.
        let each = [self.left(with), self.left(&begin(with, self.estimation).drive)];
        let taken = |balance: usize| {
            let after = each.iter().filter_map(|it| it[balance]).reduce(f64::min)?;
            before[balance].map(|before| 1.0 - (after / before).powi(2))
        };
        let by_voltage = if candidate.info.senses() { taken(1) } else { None };
        let taken = taken(0)?.max(by_voltage.unwrap_or(f64::NEG_INFINITY));
        let percent = 100.0 * taken.max(0.0);
        let little = taken < TAKEN && !self.explains_acceleration(with);
        little.then(|| {
            format!(
                "it takes {percent:.1} % of what is unexplained of the torque on the validation \
                 data away only"
            )
        })
    }

    /// Whether more torque stays unexplained with a law than without, in the recordings held out. What
    /// stands at a sensor is no part of that balance.
    pub(super) fn law_raises_torque(
        &self,
        candidate: &Candidate,
        before: Option<f64>,
        with: &Model,
    ) -> bool {
        candidate.acts_at_motor() && self.raises_torque(before, with)
    }

    /// Whether more torque stays unexplained than before, in the recordings held out: an observer follows
    /// what a model does not predict, and its error may fall by a wrong inertia.
    pub(super) fn raises_torque(&self, before: Option<f64>, with: &Model) -> bool {
        // Where no observer follows the motion, its error says what a drive leaves.
        if !self.model.setting.observer.follows() {
            return false;
        }
        let both = before.zip(self.torque_left(&with.fitted.drive));
        let raises = both.is_some_and(|(before, after)| after > (1.0 + self.rule.size) * before);
        raises && !self.explains_acceleration(&with.fitted.drive)
    }

    /// Whether a drive explains the acceleration where the round's own does not. The torque of a shaft that
    /// swings freely is small beside what moves it, and says little: a drive of hardly any inertia leaves
    /// less of it than the right one.
    fn explains_acceleration(&self, with: &Drive) -> bool {
        let left = |drive: &Drive| {
            let begun = begin(drive, self.estimation).drive;
            let each = [drive, &begun].map(|it| acceleration_left(it, self.validation));
            each.into_iter().flatten().reduce(f64::min)
        };
        let both = left(&self.model.fitted.drive).zip(left(with));
        both.is_some_and(|(before, after)| {
            after < SWINGS && 1.0 - (after / before).powi(2) >= TAKEN
        })
    }

    /// Whether a drive explains most of the torque that the round's own leaves.
    pub(super) fn explains_torque(&self, drive: &Drive) -> bool {
        let both = self.torque_left(&self.model.fitted.drive).zip(self.torque_left(drive));
        both.is_some_and(|(of_base, after)| after < MUCH * of_base)
    }

    /// Whether less torque stays unexplained with a curve than the base's, in the recordings held out, at
    /// the values of the balances.
    pub(super) fn lowers_torque(&self, before: Option<f64>, curve: &CurveWeight) -> bool {
        let mut with = self.model.fitted.drive.clone();
        with.effects.push(effect(&with, curve).0);
        let both = before.zip(self.torque_left_at_balances(&with));
        both.is_none_or(|(before, after)| after * after <= (1.0 - self.rule.size) * before * before)
    }
}
