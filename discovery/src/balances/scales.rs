//! The speeds at which laws bend (of Stribeck, of tanh): least squares are not linear in them, so that
//! some are tried.

use drivescope_plant::parameters::NamedParameter;

use super::windows::SLOW;
use crate::estimate::{Evidence, recorded_speeds};

/// Speeds that are tried for a law's own scale.
const SPEEDS_TRIED: usize = 8;
/// The fastest of them as a share of the greatest speed: a law that bends over the whole range is
/// told from viscous and dry friction by little.
const FASTEST: f64 = 0.2;

/// Parameters that are speeds: the scale of a law.
pub(super) fn speeds(others: &[NamedParameter]) -> impl Iterator<Item = &NamedParameter> {
    others.iter().filter(|it| ["rad/s", "m/s"].contains(&it.unit.as_str()))
}

/// Values that are tried for a law's speed: those at which the recordings dwell, and the balances
/// look.
pub(super) fn tried(parameter: &NamedParameter, evidence: &Evidence) -> impl Iterator<Item = f64> {
    let (slow, fast) = recorded_speeds(&evidence.recordings, &evidence.noise);
    let (low, high) = parameter.range;
    let (slow, fast) = (slow.max(SLOW * fast).max(low), (FASTEST * fast).min(high));
    let span = (slow < fast).then_some((slow, fast));
    let at = move |k: usize| {
        let share = k as f64 / (SPEEDS_TRIED - 1) as f64;
        span.map(|(slow, fast)| slow * (fast / slow).powf(share))
    };
    (0..SPEEDS_TRIED).filter_map(at)
}
