//! A fitted drive at recordings: those it was fitted to, and those held out to judge by.

use drivescope_plant::drive::{Drive, Input};
use rayon::prelude::*;

use super::filter::{SENSORS, Track, track};
use super::gram::References;
use super::randomness::Randomness;
use crate::case::Setting;
use crate::discover::Model;
use crate::estimate::{Evidence, with_own};
use crate::measured::Measured;
use crate::observer::Observer;

/// One recording with the drive as it was there.
#[derive(Debug, Clone)]
pub(crate) struct Recorded<'a> {
    pub(crate) drive: Drive,
    /// Parameters that belong to this recording.
    pub(crate) own: Vec<String>,
    pub(crate) measured: &'a Measured,
    /// Standard deviation of each sensor's noise, in its unit.
    pub(crate) noise: [f64; SENSORS],
    /// Whether nothing was fitted to it.
    pub(crate) held_out: bool,
}

/// A fitted drive at its recordings.
#[derive(Debug, Clone)]
pub(crate) struct Scene<'a> {
    pub(crate) drive: &'a Drive,
    /// Parameters of the machine that were estimated.
    pub(crate) names: Vec<String>,
    pub(crate) recordings: Vec<Recorded<'a>>,
    /// Sub-steps are no longer than that, s.
    pub(crate) longest_s: f64,
}

/// The longest sub-step that resolves a drive, s.
pub(crate) fn longest(drive: &Drive) -> f64 {
    Setting::new(drive, Observer::NONE).longest_s
}

impl<'a> Scene<'a> {
    pub(crate) fn of(model: &'a Model, estimation: &'a Evidence, validation: &'a Evidence) -> Self {
        let drive = &model.fitted.drive;
        let recorded = |evidence: &'a Evidence, fits: &[crate::estimate::Fit], held_out: bool| {
            let each = evidence.recordings.iter().zip(&evidence.noise).zip(fits);
            let one =
                |((measured, noise), fit): ((&'a Measured, &Vec<f64>), &crate::estimate::Fit)| {
                    let mut sensors = [1.0; SENSORS];
                    let known = measured.outputs.iter().zip(noise);
                    for (channel, sd) in known.filter(|(it, _)| (it.output as usize) < SENSORS) {
                        sensors[channel.output as usize] = *sd;
                    }
                    Recorded {
                        drive: with_own(drive, fit),
                        own: fit.own.iter().map(|it| it.name.clone()).collect(),
                        measured,
                        noise: sensors,
                        held_out,
                    }
                };
            each.map(one).collect::<Vec<_>>()
        };
        let mut recordings = recorded(estimation, &model.fitted.recordings, false);
        recordings.extend(recorded(validation, &model.validation.recordings, true));
        Self { drive, names: model.names(), recordings, longest_s: longest(drive) }
    }

    /// The recordings it was fitted to alone.
    pub(crate) fn fitted(&self) -> Self {
        let fitted = self.recordings.iter().filter(|it| !it.held_out).cloned();
        Self { recordings: fitted.collect(), names: self.names.clone(), ..*self }
    }

    /// The same along parts of its recordings, each with the number of its recording.
    pub(crate) fn along<'b>(&self, parts: &'b [(usize, Measured)]) -> Scene<'b>
    where
        'a: 'b,
    {
        let one = |(number, measured): &'b (usize, Measured)| {
            let it = &self.recordings[*number];
            let (drive, own) = (it.drive.clone(), it.own.clone());
            Recorded { drive, own, measured, noise: it.noise, held_out: it.held_out }
        };
        let recordings = parts.iter().map(one).collect();
        Scene { drive: self.drive, names: self.names.clone(), recordings, ..*self }
    }

    /// Every recording filtered; nothing where the model overflows.
    pub(crate) fn tracks(&self, randomness: &Randomness) -> Option<Vec<Track>> {
        let one = |it: &Recorded<'_>| {
            track(&it.drive, it.measured, &randomness.at(&it.noise), self.longest_s)
        };
        self.recordings.par_iter().map(one).collect()
    }

    /// Sizes of the balances and of what the sensors show along those tracks: the torque that is
    /// left of the motor's once the inertia has its share, the voltage over the resistance.
    pub(crate) fn references(&self, tracks: &[Track]) -> References {
        let each = || self.recordings.iter().zip(tracks);
        let resisting = each().flat_map(|(it, track)| {
            let motor = &it.drive.motor;
            let force = motor.input == Input::Force;
            track.ticks.iter().map(move |tick| {
                let i = if force { it.measured.u[tick.sample] } else { tick.filtered[0] };
                motor.k_m * i - motor.j * tick.acceleration(it.measured.period_s)
            })
        });
        let dropped = each().flat_map(|(it, track)| {
            let r = it.drive.motor.r.unwrap_or(1.0);
            track.ticks.iter().map(move |tick| r * tick.filtered[0])
        });
        let shown = |sensor: usize| {
            let all = tracks.iter().flat_map(|track| &track.ticks);
            SENSOR * rms(all.map(|tick| tick.predicted[sensor]))
        };
        References {
            torque: rms(resisting),
            voltage: rms(dropped),
            shown: std::array::from_fn(shown),
        }
    }
}

/// Share of a signal that counts for its sensor as the whole of a balance does for a law in it.
const SENSOR: f64 = 0.1;

/// Root of the mean square, never 0: it divides.
pub(crate) fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for value in values.filter(|value| value.is_finite()) {
        sum += value * value;
        count += 1.0;
    }
    (sum / count.max(1.0)).sqrt().max(1e-300)
}
