//! The power amplifier: u = sat(gain C_m), with actuator and supply faults.

use super::{SignalLanes, limited};
use crate::drive::AmplifierData;
use crate::fault::FaultLanes;

/// From C_m to u; without an amplifier u is the signal asked for.
#[inline(always)]
pub(super) fn amplify<const N: usize>(
    amplifier: Option<AmplifierData>,
    faults: &FaultLanes<f64, N>,
    signals: &mut SignalLanes<f64, N>,
) {
    let gain = amplifier.map_or(1.0, |data| data.gain);
    let limit = amplifier.and_then(|data| data.limit);
    for l in 0..N {
        let supply = 1.0 + faults.supply[l];
        let wanted = gain * (1.0 + faults.actuator[l]) * supply * signals.c_m[l];
        signals.u[l] = limited(wanted, limit.map(|limit| limit * supply));
    }
}
