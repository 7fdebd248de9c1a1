//! The inverse form: errors of the outputs turned back into the torque and the voltage that are
//! missing, a second opinion on what the errors themselves say.
//!
//! A feedback may cancel an effect in the outputs and leave it plain in what it took to do so. The
//! missing torque and voltage ([`Plant`]) are smoothed over as few samples as bring the sensors'
//! noise below a tenth of what is left. Like the innovations this is a linear filter of residuals
//! and columns alike, so that what they explain of each other remains comparable; only what counts
//! much differs.

use nalgebra::DMatrix;
use serde::Serialize;

use super::columns::{At, Place};
use super::inverse_plant::{CURRENT, Plant, smoothed};
use super::projection::Projection;
use super::sight::Sight;
use crate::estimate::with_own;

/// Greatest share of the sensors' noise in the variance of what is left.
const MOST_NOISE: f64 = 0.1;
/// Longest smoothing, s: what is faster than 50 Hz may be lost.
const LONGEST_S: f64 = 0.02;

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
        let has = std::array::from_fn(|it| base.places.iter().any(|place| place.output == it));
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
            let drive = with_own(at.drive, &at.fits[place.recording]);
            let measured = &at.evidence.recordings[place.recording];
            let noise = &at.evidence.noise[place.recording];
            let plant = Plant::new(&drive, measured, noise, at.setting.observer);
            stretches.push(Stretch { plant, values: Vec::new() });
        }
        let stretch = stretches.last_mut()?;
        if !follows || before.is_some_and(|last| last.sample != place.sample) {
            stretch.values.push([None; 3]);
        }
        // Neither balance is told by a sensor beside those of the motor.
        if let Some(seen) = stretch.values.last_mut()?.get_mut(place.output) {
            *seen = Some(value);
        }
        before = Some(*place);
    }
    let whole = |outputs: &[Option<usize>; 3]| (0..3).all(|it| outputs[it].is_some() == has[it]);
    stretches.iter().all(|one| one.values.iter().all(whole)).then_some(stretches)
}
