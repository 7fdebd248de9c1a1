//! The inverse form: errors of the outputs turned back into the torque and the voltage that are
//! missing, a second opinion on what the errors themselves say.
//!
//! A feedback may cancel an effect in the outputs and leave it plain in what it took to do so. With
//! e the error of the model that runs along with its observer (gains g of the speed and of the
//! position, 0 in free run), and h the sampling time, the balances give, to first order,
//!
//! e_omega(k+1) = (e_omega(k) - g_omega e(k)) (1 - h B / J) + h / J (K e_i(k) + T(k)),
//! e_theta(k+1) = e_theta(k) - g_theta e(k) + h (e_omega(k) - g_omega e(k)),
//! V(k) = L (e_i(k+1) - e_i(k)) / h + R e_i(k) + K e_omega(k),
//!
//! which is solved for the missing torque T and voltage V: differences of the errors. They are
//! smoothed over as few samples as bring the sensors' noise below a tenth of what is left. Like the
//! innovations this is a linear filter of residuals and columns alike, so that what they explain of
//! each other remains comparable; only what counts much differs.

use drivescope_plant::drive::{Drive, Input};
use nalgebra::DMatrix;
use serde::Serialize;

use super::columns::{At, Place};
use super::projection::Projection;
use super::refit::squared;
use super::sight::Sight;
use crate::estimate::with_own;
use crate::measured::{Measured, Output};
use crate::observer::{Gains, Observer};

/// Greatest share of the sensors' noise in the variance of what is left.
const MOST_NOISE: f64 = 0.1;
/// Longest smoothing, s: what is faster than 50 Hz may be lost.
const LONGEST_S: f64 = 0.02;
/// Samples in which a sensor's noise has passed through the differences.
const PASSED: usize = 8;
const CURRENT: usize = Output::Current as usize;
const SPEED: usize = Output::Speed as usize;
const POSITION: usize = Output::Position as usize;

/// What the inverse form says beside the loop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SecondOpinion {
    /// Samples over which the missing torque and voltage were smoothed.
    pub smoothed_over: usize,
    /// Share of the sensors' noise in the variance of what is left.
    pub noise_share: f64,
    /// The effect that explains most of it by the same gates; none if none passes.
    pub best: Option<String>,
    /// Gain in BIC of that effect.
    pub delta_bic: Option<f64>,
    /// Whether that is what the loop says, or equal to it on these recordings.
    pub agrees: bool,
}

impl SecondOpinion {
    /// In words.
    pub fn words(&self) -> String {
        let says = match (&self.best, self.agrees) {
            (Some(best), true) => format!("agrees: {best} explains most there too"),
            (None, true) => "agrees: nothing passes there either".to_owned(),
            (Some(best), false) => format!("disagrees: there {best} explains most"),
            (None, false) => "disagrees: nothing passes there".to_owned(),
        };
        format!("the inverse form (measured u less what the model's dynamics need) {says}")
    }
}

/// What the inverse form says of one candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ByInverse {
    pub(crate) delta_bic: f64,
    pub(crate) p_value: f64,
}

/// The linear part of a drive, at one sampling time.
#[derive(Debug, Clone, Copy)]
struct Plant {
    period_s: f64,
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
    fn of(at: &At<'_>, recording: usize) -> Self {
        let drive = with_own(at.drive, &at.fits[recording]);
        let evidence = at.evidence;
        let (measured, noise) = (&evidence.recordings[recording], &evidence.noise[recording]);
        Self::new(&drive, measured, noise, at.setting.observer)
    }

    fn new(drive: &Drive, measured: &Measured, sds: &[f64], observer: Observer) -> Self {
        let motor = &drive.motor;
        let by_voltage = motor.input == Input::Voltage;
        let [r, l, k] = [motor.r, motor.l, Some(motor.k_m)]
            .map(|value| if by_voltage { value.unwrap_or(0.0) } else { 0.0 });
        let mut noise = [0.0; 3];
        for (channel, sd) in measured.outputs.iter().zip(sds) {
            noise[channel.output as usize] = *sd;
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
    fn missing(&self, errors: &[[f64; 3]], has: [bool; 3]) -> Vec<[f64; 2]> {
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
    fn by_noise(&self, has: [bool; 3], samples: usize) -> [f64; 2] {
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
fn smoothed(values: &[[f64; 2]], samples: usize) -> Vec<[f64; 2]> {
    let mut means = vec![[0.0; 2]; values.len()];
    for k in samples..=values.len() {
        let sum = |it: usize| values[k - samples..k].iter().map(|value| value[it]).sum::<f64>();
        means[k - 1] = [sum(0) / samples as f64, sum(1) / samples as f64];
    }
    means
}

/// Values of a stretch without a hole, by sample and output.
struct Stretch {
    plant: Plant,
    /// Numbers of the values of each sample, by output.
    values: Vec<[Option<usize>; 3]>,
}

/// A filter to the missing torque, in the place of the speed's or position's values, and the
/// missing voltage, in that of the current's; each in units of its standard deviation.
pub(crate) struct Inverse {
    stretches: Vec<Stretch>,
    has: [bool; 3],
    smoothed_over: usize,
    /// Of torque and voltage; 0 where noise covers it.
    weights: [f64; 2],
    noise_share: f64,
}

impl Inverse {
    /// At a model; nothing where noise covers what is left, or samples lack an output.
    pub(crate) fn of(sight: &Sight<'_>) -> Option<Self> {
        let base = sight.columns();
        let has = [CURRENT, SPEED, POSITION].map(|it| base.places.iter().any(|p| p.output == it));
        let stretches = stretches(&sight.at, &base.places, has)?;
        let plain = Projection::new(base.columns.clone(), &base.residual);
        let left = plain.residual().as_slice();
        let shortest_s =
            stretches.iter().map(|one| one.plant.period_s).fold(f64::INFINITY, f64::min);
        let mut filter =
            Self { stretches, has, smoothed_over: 1, weights: [1.0; 2], noise_share: 1.0 };
        while filter.smoothed_over as f64 * shortest_s <= LONGEST_S {
            if filter.sees(&base.places, left) {
                return Some(filter);
            }
            filter.smoothed_over *= 2;
        }
        None
    }

    /// Sets the weights; whether what is left stands out of the noise in any balance.
    fn sees(&mut self, places: &[Place], left: &[f64]) -> bool {
        self.weights = [1.0; 2];
        let values = self.applied(places, left);
        let mut by_noise = [0.0; 2];
        for one in &self.stretches {
            let own = one.plant.by_noise(self.has, self.smoothed_over);
            (0..2).for_each(|it| by_noise[it] += own[it] * one.values.len() as f64);
        }
        let mut sums = [0.0; 2];
        for (place, value) in places.iter().zip(&values) {
            sums[usize::from(place.output == CURRENT)] += value * value;
        }
        let count: f64 = self.stretches.iter().map(|one| one.values.len() as f64).sum();
        let mut shares = [f64::INFINITY; 2];
        for it in 0..2 {
            let stands_out = sums[it] > 0.0 && by_noise[it] <= MOST_NOISE * sums[it];
            self.weights[it] = if stands_out { (count / sums[it]).sqrt() } else { 0.0 };
            if stands_out {
                shares[it] = by_noise[it] / sums[it];
            }
        }
        self.noise_share = shares[0].min(shares[1]);
        self.noise_share.is_finite()
    }

    /// A residual in this form.
    fn applied(&self, places: &[Place], residual: &[f64]) -> Vec<f64> {
        let columns = DMatrix::from_row_slice(1, residual.len(), residual);
        self.filtered(places, &columns).as_slice().to_vec()
    }

    /// Columns in this form, one row a direction.
    fn filtered(&self, places: &[Place], columns: &DMatrix<f64>) -> DMatrix<f64> {
        let mut filtered = DMatrix::zeros(columns.nrows(), columns.ncols());
        for row in 0..columns.nrows() {
            for Stretch { plant, values } in &self.stretches {
                let seen = |value: &Option<usize>| value.map_or(0.0, |it| columns[(row, it)]);
                let errors: Vec<[f64; 3]> =
                    values.iter().map(|outputs| outputs.each_ref().map(seen)).collect();
                let missing = smoothed(&plant.missing(&errors, self.has), self.smoothed_over);
                for (outputs, missing) in values.iter().zip(missing) {
                    for value in outputs.iter().flatten() {
                        let balance = usize::from(places[*value].output == CURRENT);
                        filtered[(row, *value)] = self.weights[balance] * missing[balance];
                    }
                }
            }
        }
        filtered
    }

    /// What a model leaves in this form when its parameters have moved to suit it.
    pub(crate) fn left_by(&self, sight: &Sight<'_>) -> Vec<f64> {
        let base = sight.columns();
        let residual = self.applied(&base.places, &base.residual);
        let columns = self.filtered(&base.places, &base.columns);
        Projection::new(columns, &residual).residual().as_slice().to_vec()
    }

    /// Gain in BIC from what was left to what is, `counted` independent values and `k` parameters
    /// more.
    pub(crate) fn delta_bic(was: &[f64], is: &[f64], counted: f64, k: usize) -> f64 {
        counted * (squared(was) / squared(is)).ln() - k as f64 * counted.ln()
    }

    /// What it says, given the best effect by it and what the loop says.
    pub(crate) fn opinion(&self, best: Option<(String, f64)>, agrees: bool) -> SecondOpinion {
        SecondOpinion {
            smoothed_over: self.smoothed_over,
            noise_share: self.noise_share,
            delta_bic: best.as_ref().map(|(_, gain)| *gain),
            best: best.map(|(effect, _)| effect),
            agrees,
        }
    }
}

/// The values by stretches without a hole; nothing if a sample lacks an output.
fn stretches(at: &At<'_>, places: &[Place], has: [bool; 3]) -> Option<Vec<Stretch>> {
    let mut stretches: Vec<Stretch> = Vec::new();
    let mut before: Option<Place> = None;
    for (value, place) in places.iter().enumerate() {
        let follows = before.is_some_and(|last| {
            last.recording == place.recording && last.sample + 1 >= place.sample
        });
        if !follows {
            let plant = Plant::of(at, place.recording);
            stretches.push(Stretch { plant, values: Vec::new() });
        }
        let stretch = stretches.last_mut()?;
        if !follows || before.is_some_and(|last| last.sample != place.sample) {
            stretch.values.push([None; 3]);
        }
        stretch.values.last_mut()?[place.output] = Some(value);
        before = Some(*place);
    }
    let whole = |outputs: &[Option<usize>; 3]| (0..3).all(|it| outputs[it].is_some() == has[it]);
    stretches.iter().all(|one| one.values.iter().all(whole)).then_some(stretches)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Case;
    use crate::response::{Forcing, responses};
    use crate::testing::{bench, dr300, gaussian};
    use crate::{Setting, Start};

    /// The balances are taken to first order in the sampling time: a per cent at 1 kHz, and the
    /// shaft never sticks here.
    const FIRST_ORDER: f64 = 0.05;

    /// Missing torque that the inverse form makes of the response to a known torque.
    fn round_trip(names: &[&str], hz: f64) -> (Vec<f64>, Vec<f64>) {
        let mut drive = dr300();
        drive.effects.clear();
        let mut recording = bench(&drive, 1.0, 0.001);
        recording.signals.retain(|signal| names.contains(&signal.name.as_str()));
        let measured = Measured::new(&drive, &recording).expect("it can be used");
        let noise = vec![1.0; measured.outputs.len()];
        let starts = vec![Start::REST; measured.pieces.len()];
        let setting = Setting::new(&drive, Observer { hz });
        let case = Case {
            drive: &drive,
            measured: &measured,
            noise: &noise,
            starts: &starts,
            setting: &setting,
        };
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
        let plant = Plant::new(&drive, &measured, &noise, setting.observer);
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
