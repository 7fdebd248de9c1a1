//! A fitted drive at recordings: those it was fitted to, and those held out to judge by.

use std::ops::Range;
use std::sync::Arc;

use drivescope_plant::drive::{Drive, EffectData, Input};
use drivescope_plant::model::SPEED;
use rayon::prelude::*;

use super::averaged::averaged;
use super::direction::Direction;
use super::filter::track;
use super::gram::References;
use super::randomness::Randomness;
use super::state::SENSORS;
use super::track::Track;
use crate::case::Setting;
use crate::discover::Model;
use crate::estimate::{Evidence, Fit, with_own};
use crate::measured::{Measured, Output};
use crate::observer::Observer;
use crate::rms::rms;

/// One recording with the drive as it was there.
#[derive(Debug, Clone)]
pub(crate) struct Recorded {
    /// Its number among the recordings.
    pub(crate) place: usize,
    pub(crate) drive: Drive,
    /// Parameters that belong to this recording.
    pub(crate) own: Vec<String>,
    pub(crate) measured: Arc<Measured>,
    pub(crate) direction: Arc<Direction>,
    /// Standard deviation of each sensor's noise, in its unit.
    pub(crate) noise: [f64; SENSORS],
    /// Whether nothing was fitted to it.
    pub(crate) held_out: bool,
}

impl Recorded {
    pub(super) fn recording(&self) -> (&Measured, &Direction) {
        (&self.measured, &self.direction)
    }
}

/// A fitted drive at its recordings.
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    pub(crate) drive: Drive,
    /// Parameters of the machine that were estimated.
    pub(crate) names: Vec<String>,
    pub(crate) recordings: Vec<Recorded>,
    /// Greatest speed that sub-steps are made for, rad/s (m/s).
    pub(crate) speed: f64,
    /// Sub-steps are no longer than that, s.
    pub(crate) longest_s: f64,
}

/// Least noise of a sensor in a recording over that in the noisiest of its recordings.
const QUIET: f64 = 0.3;

/// Samples that are filtered at most: two recordings of 8 s at 1 kHz, some 100 MB of states, gains and
/// derivatives.
const MOST: usize = 16_000;
/// Stretches of a recording of which not all is taken.
const STRETCHES: usize = 2;

/// Factor on a first guess of the load that makes it whatever the sensors say.
const ANY: f64 = 20.0;

/// The longest sub-step that resolves a drive up to that speed, s.
pub(crate) fn longest(drive: &Drive, speed: f64) -> f64 {
    Setting::up_to(drive, Observer::NONE, speed).longest_s
}

impl Scene {
    /// Along means and stretches of long recordings, as the filter sees them.
    pub(crate) fn of(model: &Model, estimation: &Evidence, validation: &Evidence) -> Self {
        let (fitted, others) = (&model.fitted.recordings, &model.validation.recordings);
        let evidence = [(estimation, &fitted[..], false), (validation, &others[..], true)];
        Self::reduced(&model.fitted.drive, model.names(), model.setting.speed, &evidence)
    }

    /// The same of a drive as it is, at recordings with what belongs to each of them.
    pub(crate) fn at(drive: &Drive, setting: &Setting, evidence: (&Evidence, &[Fit])) -> Self {
        let (evidence, fits) = evidence;
        Self::reduced(drive, shared(drive), setting.speed, &[(evidence, fits, false)])
    }

    /// That along every sample.
    pub(crate) fn whole_at(
        drive: &Drive,
        setting: &Setting,
        evidence: (&Evidence, &[Fit]),
    ) -> Self {
        let (evidence, fits) = evidence;
        Self::seen(drive, shared(drive), setting.speed, &[(evidence, fits, false)], |_| None)
    }

    /// Along every sample.
    pub(crate) fn whole(model: &Model, estimation: &Evidence, validation: &Evidence) -> Self {
        let (fitted, others) = (&model.fitted.recordings, &model.validation.recordings);
        let evidence = [(estimation, &fitted[..], false), (validation, &others[..], true)];
        let (drive, speed) = (&model.fitted.drive, model.setting.speed);
        Self::seen(drive, model.names(), speed, &evidence, |_| None)
    }

    fn reduced(
        drive: &Drive,
        names: Vec<String>,
        speed: f64,
        evidence: &[(&Evidence, &[Fit], bool)],
    ) -> Self {
        let mean = |measured: &Measured| averaged(drive, measured);
        Self::seen(drive, names, speed, evidence, mean).shortened(MOST).looked_through()
    }

    /// `names` are the parameters of the machine that were estimated; recordings come with their fits
    /// and whether they are held out.
    fn seen(
        drive: &Drive,
        names: Vec<String>,
        speed: f64,
        evidence: &[(&Evidence, &[Fit], bool)],
        mean: impl Fn(&Measured) -> Option<Measured>,
    ) -> Self {
        // A sensor that hardly moves in one recording seems quieter there than it is.
        let mut sensors = [0.0_f64; SENSORS];
        for (evidence, ..) in evidence {
            for (measured, noise) in evidence.recordings.iter().zip(&evidence.noise) {
                let known = measured.outputs.iter().zip(noise);
                for (channel, sd) in known.filter(|(it, _)| (it.output as usize) < SENSORS) {
                    let known = &mut sensors[channel.output as usize];
                    *known = known.max(*sd);
                }
            }
        }
        let mut recordings = Vec::new();
        for (evidence, fits, held_out) in evidence {
            let each = evidence.recordings.iter().zip(&evidence.noise).zip(*fits);
            for ((measured, own), fit) in each {
                let mut noise = sensors.map(|sd| if sd > 0.0 { QUIET * sd } else { 1.0 });
                let known = measured.outputs.iter().zip(own);
                for (channel, sd) in known.filter(|(it, _)| (it.output as usize) < SENSORS) {
                    let known = &mut noise[channel.output as usize];
                    *known = known.max(*sd);
                }
                let measured = mean(measured).unwrap_or_else(|| measured.clone());
                recordings.push(Recorded {
                    place: recordings.len(),
                    drive: with_own(drive, fit),
                    own: fit.own.iter().map(|it| it.name.clone()).collect(),
                    direction: Arc::new(Direction::of(&measured, &noise)),
                    measured: Arc::new(measured),
                    noise,
                    held_out: *held_out,
                });
            }
        }
        let longest_s = longest(drive, speed);
        Self { drive: drive.clone(), names, recordings, speed, longest_s }
    }

    /// Whether it sees means or stretches of those recordings, and not every sample.
    pub(crate) fn is_reduced(&self, estimation: &Evidence, validation: &Evidence) -> bool {
        let own: usize = self.recordings.iter().map(|it| it.measured.len()).sum();
        own != estimation.samples() + validation.samples()
    }

    /// The recordings it was fitted to alone.
    pub(crate) fn fitted(&self) -> Self {
        let recordings = self.recordings.iter().filter(|it| !it.held_out).cloned().collect();
        Self { recordings, ..self.clone() }
    }

    /// The same along parts of its recordings, each with the number of its recording.
    fn along(&self, parts: impl Iterator<Item = (usize, Range<usize>)>) -> Self {
        let one = |(number, range): (usize, Range<usize>)| {
            let it = &self.recordings[number];
            let measured = Arc::new(it.measured.part(range.clone()).ok()?);
            let direction = Arc::new(it.direction.part(range));
            Some(Recorded { measured, direction, ..it.clone() })
        };
        Self { recordings: parts.filter_map(one).collect(), ..self.clone() }
    }

    /// Along stretches of its recordings that hold so many samples, the same share of each; itself
    /// where it has no more, or where no stretch is long enough.
    pub(super) fn shortened(self, most: usize) -> Self {
        let all: usize = self.recordings.iter().map(|it| it.measured.len()).sum();
        if all <= most {
            return self;
        }
        let share = most as f64 / all as f64;
        let each = self.recordings.iter().enumerate();
        let parts = each.flat_map(|(number, it)| {
            stretches(it.measured.len(), share).map(move |range| (number, range))
        });
        let short = self.along(parts);
        let kept = |held_out: bool| {
            let has = |scene: &Self| scene.recordings.iter().any(|it| it.held_out == held_out);
            has(&short) == has(&self)
        };
        if kept(false) && kept(true) { short } else { self }
    }

    /// With the directions of the speed itself, where a sensor shows it late.
    fn looked_through(mut self) -> Self {
        let own = |it: &Recorded| {
            it.drive.model().shows_state() || it.measured.output(Output::Speed).is_none()
        };
        if self.recordings.iter().all(own) {
            return self;
        }
        // So random that what was measured tells the speed, and not the friction that is not known.
        if let Some(tracks) = self.tracks(&Randomness::guess(&self).scaled(ANY)) {
            for (it, track) in self.recordings.iter_mut().zip(tracks) {
                let speeds = track.by_sample(it.measured.len(), |tick| tick.filtered[SPEED]);
                let sd = it.noise[Output::Speed as usize];
                it.direction = Arc::new(Direction::of_speeds(&it.measured, &speeds, sd));
            }
        }
        self
    }

    /// With an effect in the drive, of which those parameters are estimated too.
    pub(crate) fn with(
        &self,
        effect: &EffectData,
        estimated: impl Iterator<Item = String>,
    ) -> Self {
        let mut with = self.clone();
        with.names.extend(estimated);
        with.drive.effects.push(effect.clone());
        for it in &mut with.recordings {
            it.drive.effects.push(effect.clone());
        }
        with.longest_s = longest(&with.drive, self.speed).min(self.longest_s);
        with.looked_through()
    }

    /// With a law in every recording whose coefficients belong to the recording: what does not repeat
    /// is no part of the machine, and is known all the same.
    pub(crate) fn disturbed(&self, law: &EffectData, coefficients: &[String]) -> Self {
        let mut disturbed = self.clone();
        for it in &mut disturbed.recordings {
            let id = format!("disturbance {}", it.own.len());
            let mut law = EffectData { id: id.clone(), ..law.clone() };
            for (_, value) in
                law.parameters.iter_mut().filter(|(name, _)| coefficients.contains(name))
            {
                *value = 0.0;
            }
            it.drive.effects.push(law);
            it.own.extend(coefficients.iter().map(|name| format!("{id}.{name}")));
        }
        disturbed
    }

    /// Sets a parameter of the machine; one that is not possible stays.
    pub(crate) fn set(&mut self, name: &str, value: f64) {
        if self.drive.set(name, value).is_ok() {
            for it in &mut self.recordings {
                // The same parameter of the same structure.
                let _ = it.drive.set(name, value);
            }
        }
    }

    /// With the values that another scene has of its parameters.
    pub(crate) fn with_values_of(self, other: &Self) -> Self {
        self.with_values_in(&other.drive)
    }

    /// With the values that a drive has of its parameters.
    pub(crate) fn with_values_in(mut self, drive: &Drive) -> Self {
        for it in drive.parameters() {
            if self.names.contains(&it.name) {
                self.set(&it.name, it.value);
            }
        }
        self
    }

    /// Every recording filtered; nothing where the model overflows.
    pub(crate) fn tracks(&self, randomness: &Randomness) -> Option<Vec<Track>> {
        let one = |it: &Recorded| track(&it.drive, it.recording(), &randomness.at(&it.noise));
        self.recordings.par_iter().map(one).collect()
    }

    /// The same where the plant was linearised along those tracks.
    pub(crate) fn retraced(&self, along: &[Track], randomness: &Randomness) -> Option<Vec<Track>> {
        let one = |(it, track): (&Recorded, &Track)| {
            track.with(&it.drive, it.recording(), &randomness.at(&it.noise))
        };
        self.recordings.par_iter().zip(along).map(one).collect()
    }

    /// Sizes of the balances and of what the sensors show along those tracks: the torque that is
    /// left of the motor's once the inertia has its share, the voltage over the resistance.
    pub(crate) fn references(&self, tracks: &[Track]) -> References {
        let each = || self.recordings.iter().zip(tracks);
        let resisting = each().flat_map(|(it, track)| {
            let motor = &it.drive.motor;
            let force = motor.input == Input::Force;
            // Where friction is whatever it takes, the balance says nothing of its size.
            let identified =
                track.ticks.iter().filter(|tick| it.direction.loose(tick.sample) == 0.0);
            identified.map(move |tick| {
                let i = if force { it.measured.u[tick.sample] } else { tick.mean[0] };
                motor.k_m * i - motor.j * tick.acceleration(it.measured.period_s)
            })
        });
        let dropped = each().flat_map(|(it, track)| {
            let r = it.drive.motor.r.unwrap_or(1.0);
            track.ticks.iter().map(move |tick| r * tick.mean[0])
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

/// Parameters of the machine that a fit of that drive would estimate.
fn shared(drive: &Drive) -> Vec<String> {
    let of_machine = |name: &String| !drive.per_recording.contains(name);
    drive.fitted().into_iter().map(|it| it.name).filter(of_machine).collect()
}

/// Share of a signal that counts for its sensor as the whole of a balance does for a law in it.
const SENSOR: f64 = 0.1;

/// Stretches of so many samples that hold that share of them.
fn stretches(n: usize, share: f64) -> impl Iterator<Item = Range<usize>> {
    let length = (share * n as f64 / STRETCHES as f64) as usize;
    (0..STRETCHES).map(move |k| {
        let from = (k as f64 / STRETCHES as f64 * n as f64) as usize;
        from..(from + length).min(n)
    })
}
