//! A recording as an estimator sees it: what drove the drive, and what its sensors showed.
//!
//! u and the load act from one sample to the next, held. The outputs are the current, and the
//! speed or, where no speed was measured, the position. A position beside a speed is no output,
//! for it only integrates the speed's error: it is the known angle of laws that depend on it.
//! Sensors beside those of the motor are further outputs ([`crate::beside`]).
//! Samples that are not finite are left out; where a segment ends or u is missing the run ends and
//! begins anew.

use std::ops::Range;

use drivescope_plant::drive::{Drive, Input};
use drivescope_recording::{Clock, NoiseGain, Recording, Signal};

use crate::canonical::{position, speed, taken_for_motor, with_canonical_names};
use crate::driving::{Driving, driving, usable};
use crate::error::Error;

/// Missing samples of u over which its last value is held.
const HELD: usize = 2;
/// Samples that a stretch between two holes of u must have to be used.
pub(crate) const SHORTEST_PIECE: usize = 20;

/// What a sensor shows; the first numbers are those of the states in [`drivescope_plant::model`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Output {
    /// Armature current, A.
    Current = 0,
    /// Speed, rad/s or m/s.
    Speed = 1,
    /// Position, rad or m.
    Position = 2,
    /// Speed of the load, rad/s or m/s.
    LoadSpeed = 3,
    /// Position of the load, rad or m, from a zero of its own.
    LoadPosition = 4,
    /// Temperature of the winding, K, from a zero of its own.
    Temperature = 5,
}

/// How many outputs there are.
pub(crate) const OUTPUTS: usize = 6;

/// What a recording is read for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// To fit or to judge the drive as it is.
    Drive,
    /// To find what the drive lacks: a sensor of an effect that it may lack counts too.
    Search,
}

/// A measured output.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// What it shows.
    pub output: Output,
    /// Its name: `i`, `omega` or `v`, `theta` or `x`, `omega_load`, ...
    pub name: &'static str,
    /// Its unit, SI.
    pub unit: String,
    /// One value a sample, NaN where there is none.
    pub values: Vec<f64>,
}

/// A recording of a drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Where it comes from.
    pub name: String,
    /// When the samples were taken.
    pub clock: Clock,
    /// Sampling time, s.
    pub period_s: f64,
    /// What drives the model.
    pub driving: Driving,
    /// Its values: voltage, V, or what commands the force; finite within the pieces.
    pub u: Vec<f64>,
    /// Load torque, N m, or force, N; finite within the pieces.
    pub load: Option<Vec<f64>>,
    /// The outputs, at least one.
    pub outputs: Vec<Channel>,
    /// The angle (position) as far as it is known from outside the model, rad (m): measured
    /// beside a speed, or integrated from a measured speed from zero on.
    pub angle: Option<Vec<f64>>,
    /// Stretches of samples in which u is known; each begins in a state of its own.
    pub pieces: Vec<Range<usize>>,
    /// Whether the load's sensor stands for the motor's, behind what may be flexible.
    pub by_load: bool,
    /// What interpolation did to white noise before.
    pub noise_gain: NoiseGain,
    /// What a person should know of its columns (one that has no place in the model), a sentence
    /// each.
    pub remarks: Vec<String>,
}

impl Measured {
    /// The recording as that drive's.
    ///
    /// # Errors
    /// [`Error::MissingInput`], [`Error::NoVoltage`], [`Error::WrongInput`], [`Error::NoOutput`],
    /// [`Error::LoadAlone`] or [`Error::TooFewSamples`].
    pub fn new(drive: &Drive, recording: &Recording) -> Result<Self, Error> {
        Self::of(drive, recording, Purpose::Drive)
    }

    /// The recording as that drive's, read for that purpose.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of(drive: &Drive, recording: &Recording, purpose: Purpose) -> Result<Self, Error> {
        let (driving, _) = driving(drive, recording)?;
        let by_load = taken_for_motor(drive, recording)?;
        let recording = with_canonical_names(drive, recording.clone());
        let columns = || {
            let all: Vec<String> = recording.signals.iter().map(Signal::header).collect();
            all.join(", ")
        };
        let file = || recording.name.clone();
        let find = |name: &str| usable(&recording, name);
        let u = find("u").expect("what drives is u");
        let load = find("T_l");
        let (speed, position) = (speed(drive), position(drive));
        let current = (drive.motor.input == Input::Voltage).then(|| ("i", "A".to_owned()));
        let mut outputs: Vec<Channel> = current
            .iter()
            .filter_map(|of| Some(channel(Output::Current, of.clone(), find(of.0)?)))
            .collect();
        outputs.extend(find(speed.0).map(|it| channel(Output::Speed, speed.clone(), it)));
        let has_speed = outputs.iter().any(|channel| channel.output == Output::Speed);
        if !has_speed {
            let shown = find(position.0);
            outputs.extend(shown.map(|it| channel(Output::Position, position.clone(), it)));
        }
        if outputs.is_empty() {
            let wanted = current.iter().map(|of| of.0).chain([speed.0, position.0]);
            let wanted = wanted.collect::<Vec<_>>().join(", ");
            return Err(Error::NoOutput { file: file(), wanted, columns: columns() });
        }
        let driven: Vec<&Signal> = [Some(u), load].into_iter().flatten().collect();
        let pieces = pieces(&driven, &recording.segments());
        if pieces.is_empty() {
            let samples = recording.len();
            return Err(Error::TooFewSamples { file: file(), samples, least: SHORTEST_PIECE });
        }
        let angle = has_speed.then(|| match find(position.0) {
            Some(angle) => bridged(&angle.values),
            None => integrated(&find(speed.0).expect("it was found").values, recording.period_s),
        });
        let motor = Self {
            name: recording.name.clone(),
            clock: recording.clock(),
            period_s: recording.period_s,
            driving,
            u: held(&u.values),
            load: load.map(|load| held(&load.values)),
            outputs,
            angle,
            pieces,
            by_load: !by_load.is_empty(),
            noise_gain: recording.noise_gain,
            remarks: by_load.iter().map(|it| it.remark()).collect(),
        };
        Ok(motor.with_beside(drive, &recording, purpose))
    }

    /// Samples of the recording, those between the pieces included.
    pub fn len(&self) -> usize {
        self.u.len()
    }

    /// Whether there is no sample; a [`Measured`] that was made has some.
    pub fn is_empty(&self) -> bool {
        self.u.is_empty()
    }

    /// Time of sample `k`, s.
    pub fn time(&self, k: usize) -> f64 {
        self.clock.time(k)
    }

    /// The output of that kind, if it was measured.
    pub fn output(&self, output: Output) -> Option<&Channel> {
        self.outputs.iter().find(|channel| channel.output == output)
    }

    /// Current of every sample; without a measured one, the most that u can drive, and of a
    /// force-driven drive the commanded signal.
    pub(crate) fn current<'a>(&'a self, drive: &Drive) -> impl Iterator<Item = f64> + use<'a> {
        let (values, factor) = match (drive.motor.input, self.output(Output::Current)) {
            (Input::Force, _) => (&self.u, 1.0),
            (Input::Voltage, Some(channel)) => (&channel.values, 1.0),
            (Input::Voltage, None) => (&self.u, 1.0 / drive.motor.r.unwrap_or(1.0)),
        };
        values.iter().map(move |value| factor * value).filter(|value| value.is_finite())
    }

    /// Measured values within the pieces, all outputs together.
    pub fn values(&self) -> usize {
        self.outputs.iter().map(|channel| self.values_of(channel)).sum()
    }

    /// Those of one of its channels.
    pub(crate) fn values_of(&self, channel: &Channel) -> usize {
        let pieces = self.pieces.iter().map(|piece| &channel.values[piece.clone()]);
        pieces.flatten().filter(|value| value.is_finite()).count()
    }

    /// The samples of a range as a recording of their own.
    ///
    /// # Errors
    /// [`Error::TooFewSamples`] if no piece of it is long enough.
    pub fn part(&self, range: Range<usize>) -> Result<Self, Error> {
        let cut = |piece: &Range<usize>| {
            let (from, to) = (piece.start.max(range.start), piece.end.min(range.end));
            (from + SHORTEST_PIECE <= to).then(|| from - range.start..to - range.start)
        };
        let pieces: Vec<_> = self.pieces.iter().filter_map(cut).collect();
        if pieces.is_empty() {
            let (file, samples) = (self.name.clone(), range.len());
            return Err(Error::TooFewSamples { file, samples, least: SHORTEST_PIECE });
        }
        let take = |values: &Vec<f64>| values[range.clone()].to_vec();
        Ok(Self {
            name: self.name.clone(),
            clock: self.clock.part(&range),
            period_s: self.period_s,
            driving: self.driving,
            u: take(&self.u),
            load: self.load.as_ref().map(take),
            outputs: self
                .outputs
                .iter()
                .map(|channel| Channel { values: take(&channel.values), ..channel.clone() })
                .collect(),
            angle: self.angle.as_ref().map(take),
            pieces,
            by_load: self.by_load,
            noise_gain: self.noise_gain,
            remarks: self.remarks.clone(),
        })
    }
}

/// The greatest magnitude of those values that are finite; 0 if none is.
pub(crate) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.filter(|value| value.is_finite()).fold(0.0, |most, value| most.max(value.abs()))
}

/// A signal as an output of that name and unit.
pub(crate) fn channel(
    output: Output,
    (name, unit): (&'static str, String),
    signal: &Signal,
) -> Channel {
    let values = signal.values.iter().map(|y| if y.is_finite() { *y } else { f64::NAN });
    Channel { output, name, unit, values: values.collect() }
}

/// Stretches of the segments in which every one of these signals is known, holes of few samples
/// bridged.
fn pieces(signals: &[&Signal], segments: &[Range<usize>]) -> Vec<Range<usize>> {
    let known = |k: &usize| signals.iter().all(|signal| signal.values[*k].is_finite());
    let mut pieces: Vec<Range<usize>> = Vec::new();
    for segment in segments {
        let before = pieces.len();
        for k in segment.clone().filter(known) {
            match pieces[before..].last_mut() {
                Some(last) if k - last.end <= HELD => last.end = k + 1,
                _ => pieces.push(k..k + 1),
            }
        }
    }
    pieces.retain(|piece| piece.len() >= SHORTEST_PIECE);
    pieces
}

/// Each missing value replaced by the last one there was (zero at the beginning).
fn held(values: &[f64]) -> Vec<f64> {
    let mut last = 0.0;
    let hold = |value: &f64| {
        if value.is_finite() {
            last = *value;
        }
        last
    };
    values.iter().map(hold).collect()
}

/// Missing values on the straight line between their neighbours.
pub(crate) fn bridged(values: &[f64]) -> Vec<f64> {
    let mut bridged = values.to_vec();
    let mut last: Option<usize> = None;
    for k in 0..values.len() {
        if !values[k].is_finite() {
            continue;
        }
        let from = last.map_or(0, |last| last + 1);
        for hole in from..k {
            let share = last.map_or(1.0, |last| (hole - last) as f64 / (k - last) as f64);
            let before = last.map_or(values[k], |last| values[last]);
            bridged[hole] = before + share * (values[k] - before);
        }
        last = Some(k);
    }
    if let Some(last) = last {
        bridged[last + 1..].fill(values[last]);
    }
    bridged
}

/// The integral of a speed from zero on, by the trapezoidal rule.
fn integrated(speed: &[f64], period_s: f64) -> Vec<f64> {
    let speed = bridged(speed);
    let mut angle = 0.0;
    let steps = speed.windows(2).map(|pair| 0.5 * period_s * (pair[0] + pair[1]));
    let after = steps.map(|step| {
        angle += step;
        angle
    });
    std::iter::once(0.0).chain(after).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const DR300: &str = include_str!("../../scenarios/drives/dr300.toml");

    fn dr300() -> Drive {
        Drive::parse(DR300, "dr300.toml").expect("a right drive file")
    }

    fn recording(columns: &[(&str, &str)]) -> Recording {
        let signal = |(name, unit): &(&str, &str)| Signal {
            name: (*name).to_owned(),
            unit: (*unit).to_owned(),
            values: (0..100).map(|k| 1.0 + f64::from(k)).collect(),
        };
        let signals = columns.iter().map(signal).collect();
        Recording::new("bench.csv", 2.0, 0.01, signals)
    }

    fn outputs(columns: &[(&str, &str)]) -> Vec<&'static str> {
        let measured = Measured::new(&dr300(), &recording(columns)).expect("it can be used");
        measured.outputs.iter().map(|channel| channel.name).collect()
    }

    #[test]
    fn a_position_beside_a_speed_is_the_known_angle() {
        let u = ("u", "V");
        assert_eq!(outputs(&[u, ("omega", "rad/s"), ("i", "A"), ("theta", "rad")]), ["i", "omega"]);
        assert_eq!(outputs(&[u, ("theta", "rad")]), ["theta"]);
        assert_eq!(outputs(&[u, ("omega", "rad/s")]), ["omega"]);
        let both = recording(&[u, ("omega", "rad/s"), ("theta", "rad")]);
        let both = Measured::new(&dr300(), &both).expect("it can be used");
        assert_eq!(both.angle.expect("it is measured")[7], 8.0);
        let speed = recording(&[u, ("omega", "rad/s")]);
        let speed = Measured::new(&dr300(), &speed).expect("it can be used");
        // The trapezoidal rule is exact on a ramp: 1 t + 50 t^2 with t = 0.5 s.
        assert!((speed.angle.expect("from the speed")[50] - 13.0).abs() < 1e-12);
        let position = Measured::new(&dr300(), &recording(&[u, ("theta", "rad")]));
        assert_eq!(position.expect("it can be used").angle, None);
    }

    #[test]
    fn holes_of_the_input_part_the_recording_and_others_are_left_out() {
        let mut holed = recording(&[("u", "V"), ("omega", "rad/s")]);
        holed.signals[0].values[30] = f64::NAN;
        holed.signals[0].values[50..60].fill(f64::INFINITY);
        holed.signals[0].values[97..].fill(f64::NAN);
        holed.signals[1].values[5..8].fill(f64::NAN);
        let measured = Measured::new(&dr300(), &holed).expect("it can be used");
        assert_eq!(measured.pieces, [0..50, 60..97]);
        assert_eq!(measured.u[30], 30.0);
        assert_eq!(measured.values(), 50 + 37 - 3);
        let angle = measured.angle.clone().expect("from the speed");
        assert!(angle.iter().all(|angle| angle.is_finite()));
        let part = measured.part(40..90).expect("long enough");
        assert_eq!((part.pieces[0].clone(), part.clock.start_s), (20..50, 2.4));
        assert!(measured.part(45..55).is_err());
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        let refused = |columns: &[(&str, &str)]| {
            Measured::new(&dr300(), &recording(columns)).expect_err("unusable").to_string()
        };
        let text = refused(&[("omega", "rad/s")]);
        assert!(text.contains("bench.csv") && text.contains("omega [rad/s]"), "{text}");
        let text = refused(&[("i", "A"), ("omega", "rad/s")]);
        assert!(text.contains("torque balance") && text.contains("init"), "{text}");
        let text = refused(&[("u", "V"), ("v", "m/s")]);
        assert!(text.contains("i, omega, theta") && text.contains("v [m/s]"), "{text}");
        let text = refused(&[("u", "A"), ("omega", "rad/s")]);
        assert!(text.contains("A") && text.contains("force"), "{text}");
        let mut short = recording(&[("u", "V"), ("omega", "rad/s")]);
        short.signals[0].values[10..].fill(f64::NAN);
        let text = Measured::new(&dr300(), &short).expect_err("too short").to_string();
        assert!(text.contains("20"), "{text}");
    }
}
