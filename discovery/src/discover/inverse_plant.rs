//! The linear part of a drive, turned around: from the errors of its outputs to the torque and the
//! voltage that would make them.
//!
//! With e the error of the model that runs along with its observer (gains g of the speed and of the
//! position, 0 in free run), and h the sampling time, the balances give, to first order,
//!
//! e_omega(k+1) = (e_omega(k) - g_omega e(k)) (1 - h B / J) + h / J (K e_i(k) + T(k)),
//! e_theta(k+1) = e_theta(k) - g_theta e(k) + h (e_omega(k) - g_omega e(k)),
//! V(k) = L (e_i(k+1) - e_i(k)) / h + R e_i(k) + K e_omega(k),
//!
//! which is solved for T and V: differences of the errors.

use drivescope_plant::drive::{Drive, Input};

use crate::measured::{Measured, Output};
use crate::observer::{Gains, Observer};

/// Samples in which a sensor's noise has passed through the differences.
const PASSED: usize = 8;
pub(super) const CURRENT: usize = Output::Current as usize;
const SPEED: usize = Output::Speed as usize;
const POSITION: usize = Output::Position as usize;

/// The linear part of a drive, at one sampling time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plant {
    pub(super) period_s: f64,
    r: f64,
    l: f64,
    k: f64,
    j: f64,
    b: f64,
    gains: Option<Gains>,
    /// Of the current, the speed and the position, by output.
    noise: [f64; 3],
}

impl Plant {
    /// That drive at a recording; `sds` is the noise of its outputs.
    pub(super) fn new(drive: &Drive, measured: &Measured, sds: &[f64], observer: Observer) -> Self {
        let motor = &drive.motor;
        let by_voltage = motor.input == Input::Voltage;
        let [r, l, k] = [motor.r, motor.l, Some(motor.k_m)]
            .map(|value| if by_voltage { value.unwrap_or(0.0) } else { 0.0 });
        let mut noise = [0.0; 3];
        for (channel, sd) in measured.outputs.iter().zip(sds) {
            // A sensor beside those of the motor tells neither balance.
            if let Some(of) = noise.get_mut(channel.output as usize) {
                *of = *sd;
            }
        }
        // Without a current the back-EMF brakes through the armature.
        let braking = if measured.output(Output::Current).is_none() && r > 0.0 {
            k * motor.k_e.unwrap_or(k) / r
        } else {
            0.0
        };
        Self {
            period_s: measured.period_s,
            r,
            l,
            k,
            j: motor.j,
            b: motor.b_m + braking,
            gains: observer.gains(measured),
            noise,
        }
    }

    /// Missing torque and voltage from the errors of the outputs, in units of their noise; at the
    /// first samples, which have no past, nothing.
    pub(super) fn missing(&self, errors: &[[f64; 3]], has: [bool; 3]) -> Vec<[f64; 2]> {
        let Self { period_s: h, noise, .. } = *self;
        let n = errors.len();
        let of = |output: usize, k: usize| noise[output] * errors[k][output];
        let fed = |k: usize| match self.gains {
            Some(Gains { output, speed, position }) => {
                let e = of(output as usize, k);
                (speed * e, position * e)
            }
            None => (0.0, 0.0),
        };
        let speed_error = |k: usize| match has[SPEED] {
            true => of(SPEED, k),
            // One sample later: theta must have moved.
            false => {
                let (by_speed, by_position) = fed(k);
                (of(POSITION, k + 1) - of(POSITION, k) + by_position) / h + by_speed
            }
        };
        let last = if has[SPEED] { 1 } else { 2 };
        let mut missing = vec![[0.0; 2]; n];
        for k in 0..n.saturating_sub(last) {
            let (now, next) = (speed_error(k), speed_error(k + 1));
            let kept = (now - fed(k).0) * (1.0 - h * self.b / self.j);
            let current = if has[CURRENT] { of(CURRENT, k) } else { 0.0 };
            missing[k + last][0] = self.j / h * (next - kept) - self.k * current;
            if has[CURRENT] {
                let change = of(CURRENT, k + 1) - current;
                missing[k + last][1] = self.l / h * change + self.r * current + self.k * now;
            }
        }
        missing
    }

    /// Variance of missing torque and voltage that the sensors' noise makes by itself.
    pub(super) fn by_noise(&self, has: [bool; 3], samples: usize) -> [f64; 2] {
        let length = 2 * (samples + PASSED);
        let mut variance = [0.0; 2];
        for output in (0..3).filter(|output| has[*output]) {
            let mut impulse = vec![[0.0; 3]; length];
            impulse[PASSED][output] = 1.0;
            for missing in smoothed(&self.missing(&impulse, has), samples) {
                (0..2).for_each(|it| variance[it] += missing[it] * missing[it]);
            }
        }
        variance
    }
}

/// Means over that many samples and those before; nothing until there are as many.
pub(super) fn smoothed(values: &[[f64; 2]], samples: usize) -> Vec<[f64; 2]> {
    let mut means = vec![[0.0; 2]; values.len()];
    for k in samples..=values.len() {
        let sum = |it: usize| values[k - samples..k].iter().map(|value| value[it]).sum::<f64>();
        means[k - 1] = [sum(0) / samples as f64, sum(1) / samples as f64];
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::{Forcing, responses};
    use crate::rig::Rig;
    use crate::testing::{bench, dr300, gaussian};

    /// The balances are taken to first order in the sampling time: a per cent at 1 kHz, and the
    /// shaft never sticks here.
    const FIRST_ORDER: f64 = 0.05;

    /// Missing torque that the inverse form makes of the response to a known torque.
    fn round_trip(names: &[&str], hz: f64) -> (Vec<f64>, Vec<f64>) {
        let mut drive = dr300();
        drive.effects.clear();
        let mut recording = bench(&drive, 1.0, 0.001);
        recording.signals.retain(|signal| names.contains(&signal.name.as_str()));
        let noise = vec![1.0; recording.signals.len() - 1];
        let rig = Rig::new(drive, &recording, &noise, hz);
        let (case, measured) = (rig.case(), &rig.measured);
        // Slow enough for the mean over a sample to be the value.
        let mut state = 0.0;
        let torque: Vec<f64> = gaussian(measured.len(), 1)
            .iter()
            .map(|draw| {
                state += 0.005 * (draw - state);
                state
            })
            .collect();
        let shown = responses(None, &case, &[Forcing::torque(torque.clone())]);
        let width = measured.outputs.len();
        let errors: Vec<[f64; 3]> = (0..measured.len())
            .map(|k| {
                let mut of = [0.0; 3];
                for (output, channel) in measured.outputs.iter().enumerate() {
                    of[channel.output as usize] = shown[(0, width * k + output)];
                }
                of
            })
            .collect();
        let mut has = [false; 3];
        measured.outputs.iter().for_each(|channel| has[channel.output as usize] = true);
        let plant = Plant::new(&rig.drive, measured, &noise, rig.setting.observer);
        let found = plant.missing(&errors, has).iter().map(|missing| missing[0]).collect();
        (torque, found)
    }

    #[test]
    fn a_known_torque_comes_back_with_any_outputs_and_observer() {
        for (names, late) in [(&["u", "i", "omega"][..], 1), (&["u", "i", "theta"], 2)] {
            for hz in [0.0, 10.0] {
                let (torque, found) = round_trip(names, hz);
                let off: f64 =
                    (late..torque.len()).map(|k| (found[k] - torque[k - late]).powi(2)).sum();
                let all: f64 = torque.iter().map(|t| t * t).sum();
                let share = (off / all).sqrt();
                assert!(share < FIRST_ORDER, "{names:?} at {hz} Hz: off by {share}");
            }
        }
    }

    #[test]
    fn noise_is_propagated_as_it_is() {
        let plant = Plant {
            period_s: 0.001,
            r: 1.0,
            l: 1e-3,
            k: 0.1,
            j: 1e-3,
            b: 1e-4,
            gains: None,
            noise: [0.01, 0.3, 0.0],
        };
        let has = [true, true, false];
        let draws = gaussian(40_000, 2);
        let errors: Vec<[f64; 3]> = draws.chunks_exact(2).map(|e| [e[0], e[1], 0.0]).collect();
        for samples in [1, 4] {
            let drawn = smoothed(&plant.missing(&errors, has), samples);
            let expected = plant.by_noise(has, samples);
            for it in 0..2 {
                let found = drawn.iter().map(|m| m[it] * m[it]).sum::<f64>() / drawn.len() as f64;
                let ratio = found / expected[it];
                assert!((ratio - 1.0).abs() < 0.05, "balance {it}, {samples}: {ratio}");
            }
        }
    }
}
