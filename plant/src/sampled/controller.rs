//! Sampled PI speed control with saturation and anti-windup.
//!
//! C_m = sat(K_p e + I),  I += K_i period e, but not while C_m is saturated and e pushes it
//! further (conditional integration).

use super::sensors::Sensors;
use super::{InputLanes, SignalLanes, limited};
use crate::drive::ControllerData;

/// The integrators of `N` PI controllers, V.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pi<const N: usize> {
    pub(super) integral: [f64; N],
}

impl<const N: usize> Pi<N> {
    pub(super) fn at_rest() -> Self {
        Self { integral: [0.0; N] }
    }

    /// One sample: from the reference and T to C_m.
    #[inline(always)]
    pub(super) fn sample(
        &mut self,
        data: &ControllerData,
        sensors: &Sensors<N>,
        inputs: &InputLanes<f64, N>,
        signals: &mut SignalLanes<f64, N>,
    ) {
        let k_i_period = data.k_i * data.period.unwrap_or(0.0);
        for l in 0..N {
            let reference = inputs.reference[l] + inputs.noise_reference[l];
            let error = reference - sensors.speed(signals.t[l]);
            let wanted = data.k_p * error + self.integral[l];
            let given = limited(wanted, data.limit);
            let winds_up = (wanted - given) * error > 0.0;
            let step = if winds_up { 0.0 } else { k_i_period * error };
            self.integral[l] += step;
            signals.c_m[l] = given;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::{SensorData, TachoUnit};
    use crate::sampled::{Inputs, Signals};

    const DATA: ControllerData =
        ControllerData { k_p: 0.1, k_i: 2.0, period: Some(0.01), limit: Some(1.0) };

    fn run(reference: f64, samples: usize, pi: &mut Pi<1>) -> f64 {
        let sensors = Sensors::new(SensorData {
            tacho_quantum: 0.0,
            current_quantum: 0.0,
            tacho_unit: TachoUnit::Si,
        });
        let inputs = InputLanes::splat(Inputs { reference, ..Inputs::NONE });
        let zero = Signals { c_m: 0.0, t: 0.0, i_m: 0.0, u: 0.0, i_g: 0.0, load: 0.0 };
        let mut signals = SignalLanes::splat(zero);
        for _ in 0..samples {
            pi.sample(&DATA, &sensors, &inputs, &mut signals);
        }
        signals.c_m[0]
    }

    #[test]
    fn it_is_proportional_and_integral() {
        let mut pi = Pi::at_rest();
        let c_m = run(2.0, 3, &mut pi);
        assert!((c_m - (0.2 + 2.0 * 2.0 * 0.01 * 2.0)).abs() < 1e-15, "{c_m}");
    }

    #[test]
    fn it_does_not_wind_up() {
        let mut pi = Pi::at_rest();
        assert_eq!(run(100.0, 1000, &mut pi), 1.0);
        // The integrator has stopped: a small negative error brings it off the limit at once.
        assert!(run(-1.0, 1, &mut pi) < 0.5);
    }
}
