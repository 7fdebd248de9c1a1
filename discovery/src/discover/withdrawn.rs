//! What takes names back once everything was named: they explain too little.

use drivescope_plant::drive::Drive;
use drivescope_plant::effects::registry::Entry;

use super::decision::Rule;
use super::other_machine;
use super::report::{Discovery, LadderStep, RandomLoad};
use crate::estimate::Evidence;
use crate::observer::Observer;

/// Why nothing is named where the validation recordings contradict the others more than that explains.
const OUTDONE: &str = "other values of the base explain more of the validation data";
/// The same where most of the torque stays unexplained.
const LEAVES_MOST: &str = "most of the torque stays unexplained with it";
/// The same where no model is left, but what is random.
const OVERWHELMED: &str = "beside it what is random must be greater than all that drives";
/// Share of the applied torque that is much to leave unexplained behind an observer.
const MUCH: f64 = 1.0 / 3.0;
/// Share of the squared torque that was unexplained which is most of it: right names took 40 % and more.
const MOST: f64 = 0.6;

/// Why everything that was named is taken back; nothing where it stands.
pub(super) fn withdrawn(
    rule: &Rule,
    found: &Discovery,
    at: (&Drive, &Evidence),
) -> Option<&'static str> {
    if other_machine::outdoes(found) {
        Some(OUTDONE)
    } else if is_overwhelmed(found, at) {
        Some(OVERWHELMED)
    } else {
        leaves_most(rule, found).then_some(LEAVES_MOST)
    }
}

/// Whether a step leaves so much of the applied torque unexplained, in the recordings held out, that it
/// cannot be said of it that nothing is missing: more than there was, and behind an observer, where the
/// torque is what tells, more than a third.
pub(super) fn explains_little(step: &LadderStep, observer: Observer) -> bool {
    let most = if observer.follows() { MUCH } else { 1.0 };
    step.validation_unexplained.torque.is_some_and(|it| it.share > most)
}

/// Whether the random load beside what was named is greater than all that drives at most, where an observer
/// follows the motion: that is no load, and the drive no model of the recordings. Of teeth that knock a filter
/// knows too little.
fn is_overwhelmed(found: &Discovery, (drive, evidence): (&Drive, &Evidence)) -> bool {
    let knocks = |name: &String| Entry::find(name).is_some_and(|entry| entry.info.knocks);
    let told = found.observer.follows() && !found.named.iter().any(knocks);
    let more = |load: RandomLoad| load.sd > evidence.driving(drive);
    told && !found.named.is_empty() && found.load.is_some_and(more)
}

/// Whether what was named leaves most of the torque unexplained that was, and much: whatever is missing, it
/// is something else. What every machine has is missing all the same; and where the motion in free run is
/// right with it, the balance is what errs (it knows little of teeth that knock).
fn leaves_most(rule: &Rule, found: &Discovery) -> bool {
    let (Some(first), Some(last)) = (found.ladder.first(), found.ladder.last()) else {
        return false;
    };
    let left = |step: &LadderStep| step.validation_unexplained.torque.map(|it| it.rms * it.rms);
    let most = left(first).zip(left(last)).is_some_and(|(was, is)| is > MOST * was);
    let basic = |name: &String| Entry::find(name).is_some_and(|entry| entry.info.basic);
    let special = !found.named.is_empty() && !found.named.iter().any(basic);
    let excess = |step: &LadderStep| step.validation_error.powi(2) - 1.0;
    let runs_right = !found.observer.follows() && excess(last) < rule.formula * excess(first);
    special && most && explains_little(last, found.observer) && !runs_right
}
