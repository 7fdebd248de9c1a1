//! Tachometer and current sensor: gain and bias faults, noise, quantisation, freezing.

use super::{InputLanes, SignalLanes};
use crate::drive::SensorData;
use crate::effects::law::OutputLanes;
use crate::fault::{FaultLanes, sensed};

/// Sensors of `N` drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sensors<const N: usize> {
    /// T of 1 rad/s, and the speed of T = 1, rad/s: a product costs a sixth of a quotient.
    per_si: f64,
    si: f64,
    /// Resolution of T, in its unit.
    tacho_quantum: f64,
    /// Resolution of I_m, A.
    current_quantum: f64,
}

/// A fault input above this freezes a sensor.
pub(crate) const FROZEN: f64 = 0.5;

/// The nearest multiple of the quantum; the value itself if that is zero.
#[inline(always)]
fn quantised(value: f64, quantum: f64) -> f64 {
    if quantum > 0.0 { (value / quantum).round() * quantum } else { value }
}

impl<const N: usize> Sensors<N> {
    pub(super) fn new(data: SensorData) -> Self {
        let per_si = data.tacho_unit.per_si();
        Self {
            per_si,
            si: 1.0 / per_si,
            tacho_quantum: data.tacho_quantum * per_si,
            current_quantum: data.current_quantum,
        }
    }

    /// The speed in rad/s (m/s) that a T stands for.
    #[inline(always)]
    pub(super) fn speed(&self, t: f64) -> f64 {
        t * self.si
    }

    /// Reads T and I_m into the signals; a frozen sensor keeps its last value.
    #[inline(always)]
    pub(super) fn read(
        &self,
        shown: &OutputLanes<f64, N>,
        inputs: &InputLanes<f64, N>,
        faults: &FaultLanes<f64, N>,
        signals: &mut SignalLanes<f64, N>,
    ) {
        for l in 0..N {
            let speed = sensed(shown.omega[l], faults.tacho[l], faults.tacho_bias[l]);
            let noise = inputs.noise_t[l] * (1.0 + faults.tacho_noise[l]);
            let t = quantised(speed * self.per_si + noise, self.tacho_quantum);
            signals.t[l] = if faults.tacho_freeze[l] > FROZEN { signals.t[l] } else { t };
            let current = sensed(shown.i[l], faults.current_sensor[l], faults.current_bias[l]);
            let noise = inputs.noise_i_m[l] * (1.0 + faults.current_noise[l]);
            let i_m = quantised(current + noise, self.current_quantum);
            signals.i_m[l] = if faults.current_freeze[l] > FROZEN { signals.i_m[l] } else { i_m };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::TachoUnit;
    use crate::fault::Faults;
    use crate::sampled::{Inputs, Signals};

    fn read(faults: Faults<f64>, last: f64) -> Signals<f64> {
        let sensors = Sensors::<1>::new(SensorData {
            tacho_quantum: 2.0 / TachoUnit::Rpm.per_si(),
            current_quantum: 0.0,
            tacho_unit: TachoUnit::Rpm,
        });
        let shown =
            OutputLanes { i: [0.5], omega: [1000.7 / TachoUnit::Rpm.per_si()], theta: [0.0] };
        let zero = Signals { c_m: 0.0, t: last, i_m: 0.0, u: 0.0, i_g: 0.0, load: 0.0 };
        let mut signals = SignalLanes::splat(zero);
        let inputs = InputLanes::splat(Inputs { noise_t: 0.5, ..Inputs::NONE });
        sensors.read(&shown, &inputs, &FaultLanes::splat(faults), &mut signals);
        signals.lane(0)
    }

    #[test]
    fn gain_noise_and_grid_act_in_this_order() {
        assert!((read(Faults::NONE, 0.0).t - 1002.0).abs() < 1e-9);
        let gained = read(Faults { tacho: 0.05, ..Faults::NONE }, 0.0).t;
        assert!((gained - 1052.0).abs() < 1e-9, "{gained}");
        assert_eq!(read(Faults { tacho_freeze: 1.0, ..Faults::NONE }, 7.0).t, 7.0);
        let current = read(Faults { current_sensor: 0.1, current_bias: 0.2, ..Faults::NONE }, 0.0);
        assert!((current.i_m - 0.75).abs() < 1e-15);
    }
}
