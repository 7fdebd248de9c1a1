//! The state of the filter: which numbers, and where each of them stands.

use drivescope_plant::drive::Drive;
use drivescope_plant::model::OWN;
use nalgebra::SVector;

/// States of the filter at most: current, speed, position, three own states, d_T, d_V.
pub(crate) const STATES: usize = 8;
/// Own states of effects that the filter corrects.
pub(crate) const OWN_STATES: usize = 3;
/// Place of d_T / J and of d_V / L in the state.
pub(crate) const LOAD: usize = OWN + OWN_STATES;
pub(crate) const VOLTAGE: usize = LOAD + 1;
/// Place of what oscillates of d_T / J, with its quadrature behind it: that of own states which few
/// drives have.
pub(crate) const CYCLE: usize = LOAD - 2;
/// Sensors: of current, speed and position; those beside the motor are not filtered.
pub(crate) const SENSORS: usize = 3;

pub(crate) type Vector = SVector<f64, STATES>;

/// Own states of a drive's effects.
pub(crate) fn own_states(drive: &Drive) -> usize {
    drive.model().states() - OWN
}

/// Whether a part of the load may oscillate: where own states stand nothing else does.
pub(super) fn holds_a_cycle(drive: &Drive) -> bool {
    OWN + own_states(drive) <= CYCLE
}
