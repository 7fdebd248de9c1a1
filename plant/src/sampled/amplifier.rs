//! The power amplifier: u = sat(gain C_m), with actuator and supply faults.

use super::{SignalLanes, limited};
use crate::drive::AmplifierData;
use crate::fault::FaultLanes;

/// Armature voltage (force signal) that an amplifier makes of a control signal, with the sizes of
/// its own and of its supply's fault; without an amplifier u is the signal asked for.
#[inline(always)]
pub fn amplified(
    amplifier: Option<AmplifierData>,
    [actuator, supply]: [f64; 2],
    control: f64,
) -> f64 {
    let gain = amplifier.map_or(1.0, |data| data.gain);
    let limit = amplifier.and_then(|data| data.limit);
    let wanted = gain * (1.0 + actuator) * (1.0 + supply) * control;
    limited(wanted, limit.map(|limit| limit * (1.0 + supply)))
}

/// From C_m to u.
#[inline(always)]
pub(super) fn amplify<const N: usize>(
    amplifier: Option<AmplifierData>,
    faults: &FaultLanes<f64, N>,
    signals: &mut SignalLanes<f64, N>,
) {
    for l in 0..N {
        let sizes = [faults.actuator[l], faults.supply[l]];
        signals.u[l] = amplified(amplifier, sizes, signals.c_m[l]);
    }
}
