//! What enters the machine of a campaign, under the names that an exported drive has for it.

use drivescope_plant::fault::{Faults, MECHANISMS};
use drivescope_plant::sampled::InputLanes;

/// An input of the closed loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::campaign) enum Entering {
    Reference,
    NoiseReference,
    NoiseSpeed,
    NoiseCurrent,
    NoiseLoad,
    /// The fault of that number among [`MECHANISMS`].
    Fault(usize),
}

impl Entering {
    /// Its name.
    pub(in crate::campaign) fn name(self) -> String {
        match self {
            Self::Reference => "reference".to_owned(),
            Self::NoiseReference => "noise_reference".to_owned(),
            Self::NoiseSpeed => "noise_T".to_owned(),
            Self::NoiseCurrent => "noise_I_m".to_owned(),
            Self::NoiseLoad => "noise_T_l".to_owned(),
            Self::Fault(mechanism) => format!("fault_{}", MECHANISMS[mechanism].id),
        }
    }

    /// Its value under those inputs and faults.
    pub(in crate::campaign) fn value(
        self,
        inputs: &InputLanes<f64, 1>,
        mut faults: Faults<f64>,
    ) -> f64 {
        let [value] = match self {
            Self::Reference => inputs.reference,
            Self::NoiseReference => inputs.noise_reference,
            Self::NoiseSpeed => inputs.noise_t,
            Self::NoiseCurrent => inputs.noise_i_m,
            Self::NoiseLoad => inputs.load,
            Self::Fault(mechanism) => [faults.size_mut(mechanism).map_or(0.0, |size| *size)],
        };
        value
    }
}
