//! The experiment: set point, excitation, and the inputs of each run, noise included.

use std::f64::consts::PI;

use drivescope_plant::drive::{Drive, Motion, TachoUnit};
use drivescope_plant::noise::{Noise, NoiseStream};
use drivescope_plant::sampled::{input_limit, speed_bound};
use drivescope_plant::unit::{Unit, Variable};
use drivescope_recording::{Recording, Signal};
use thiserror::Error;

use crate::faults::Fault;

/// Why there is no experiment with a drive.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ExperimentError {
    /// The drive has no sampled speed control.
    #[error(
        "the study needs speed control that is sampled: give `{drive}` a [controller] with a period"
    )]
    NoController { drive: String },
}

/// Which run the noise is for: each has a stream of its own, apart from all others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stream {
    /// Open-loop training, by part.
    Training(u64),
    /// Healthy closed-loop design data, by run.
    Design(u64),
    /// Healthy closed-loop evaluation data, by run.
    Healthy(u64),
    /// Faulty evaluation runs, by fault.
    Faulty(u64),
    /// Faulty runs that a classifier is trained on, by run.
    Symptoms(u64),
}

impl Stream {
    /// Room for this many runs of a kind.
    const RUNS: u64 = 1 << 32;

    fn index(self) -> u64 {
        match self {
            Self::Training(k) => k,
            Self::Design(k) => Self::RUNS + k,
            Self::Healthy(k) => 2 * Self::RUNS + k,
            Self::Faulty(k) => 3 * Self::RUNS + k,
            Self::Symptoms(k) => 4 * Self::RUNS + k,
        }
    }
}

/// The set point of the paper, rpm.
const SET_POINT_RPM: f64 = 2000.0;
/// Share of the greatest speed that the set point may have at most; else it is half of it.
const REACHABLE: f64 = 0.75;
/// The excitation (25): (frequency in Hz, phase in rad) of three sines.
const EXCITATION: [(f64, f64); 3] = [(1.7, 0.0), (1.1, -PI / 7.0), (0.3, PI / 3.0)];
/// Amplitude of each sine: 3 V of the paper's 10 V.
const EXCITATION_SHARE: f64 = 0.3;
/// Slow reversals: amplitude as a share of the set point, and frequency, Hz.
const SLOW_SHARE: f64 = 0.02;
const SLOW_HZ: f64 = 0.2;
/// The paper's control range, V: taken where the drive names none.
const USUAL_LIMIT: f64 = 10.0;

/// The experiment with one drive.
#[derive(Debug, Clone)]
pub struct Experiment {
    pub drive: Drive,
    /// Sampling time, s.
    pub period_s: f64,
    /// Set point, rad/s (m/s).
    pub set_point: f64,
    /// Seed of all noise.
    pub seed: u64,
    /// Variables of the drive's FMUs, closed and open loop.
    variables: Vec<Variable>,
}

impl Experiment {
    /// The experiment with that drive: 2000 rpm, or half its greatest speed where that is
    /// out of reach or the drive is linear.
    ///
    /// # Errors
    /// A drive without sampled speed control.
    pub fn new(drive: Drive, seed: u64) -> Result<Self, ExperimentError> {
        let no_controller = || ExperimentError::NoController { drive: drive.name.clone() };
        let period_s = drive.controller.and_then(|c| c.period).ok_or_else(no_controller)?;
        let greatest = speed_bound(&drive);
        let usual = SET_POINT_RPM * PI / 30.0;
        let reachable = drive.motion == Motion::Rotary && usual <= REACHABLE * greatest;
        let set_point = if reachable { usual } else { 0.5 * greatest };
        let variables = [false, true]
            .into_iter()
            .flat_map(|open_loop| Unit::new(drive.clone(), open_loop).variables().to_vec())
            .collect();
        Ok(Self { drive, period_s, set_point, seed, variables })
    }

    /// The same with noise of another seed.
    pub fn with_seed(&self, seed: u64) -> Self {
        Self { seed, ..self.clone() }
    }

    /// The same with another drive of that kind.
    pub fn with_drive(&self, drive: Drive) -> Self {
        Self { drive, ..self.clone() }
    }

    /// Inputs of a closed-loop run at the set point, one row a sample; the fault's input is there
    /// if one acts.
    pub fn closed_loop(&self, samples: usize, stream: Stream, fault: Option<&Fault>) -> Recording {
        let faults = fault.map_or(&[][..], std::slice::from_ref);
        self.following(vec![self.set_point; samples], stream, faults)
    }

    /// Inputs of a closed-loop run that follows a reference, rad/s (m/s), one value a sample, with
    /// any number of faults: those of one mechanism add up.
    pub fn following(&self, reference: Vec<f64>, stream: Stream, faults: &[Fault]) -> Recording {
        let samples = reference.len();
        let noise: Vec<_> = self.noise(stream).take(samples).collect();
        let mut signals = vec![
            self.input("reference", reference),
            self.input("noise_reference", noise.iter().map(|n| n.reference).collect()),
        ];
        signals.extend(self.disturbances(&noise));
        let first = signals.len();
        for (number, fault) in faults.iter().enumerate() {
            let seed = self.seed ^ (stream.index() << 8) ^ number as u64;
            let span = fault.from..fault.until;
            let shares = fault.profile.shares(span, samples, self.period_s, seed);
            let sizes = shares.into_iter().map(|share| fault.name.size * share);
            let name = format!("fault_{}", fault.name.kind);
            match signals[first..].iter_mut().find(|signal| signal.name == name) {
                Some(same) => same.values.iter_mut().zip(sizes).for_each(|(sum, by)| *sum += by),
                None => signals.push(self.input(&name, sizes.collect())),
            }
        }
        self.recording(signals)
    }

    /// Inputs of a closed-loop run that reverses slowly through rest, without noise: the shaft
    /// sticks and breaks away at every reversal.
    pub fn slow_reversals(&self, samples: usize) -> Recording {
        let reference = (0..samples).map(|k| {
            let t = k as f64 * self.period_s;
            SLOW_SHARE * self.set_point * (2.0 * PI * SLOW_HZ * t).sin()
        });
        self.recording(vec![self.input("reference", reference.collect())])
    }

    /// Inputs of an open-loop run under the excitation (25), and the control signal C_m that
    /// stands behind its u. The argument of the sines is t = k x period, in s.
    pub fn excited(&self, samples: usize, stream: Stream) -> Excited {
        let limit = self.drive.controller.and_then(|c| c.limit).unwrap_or(USUAL_LIMIT);
        let gain = self.drive.amplifier.map_or(1.0, |amplifier| amplifier.gain);
        let most = input_limit(&self.drive).unwrap_or(f64::INFINITY);
        let c_m: Vec<f64> = (0..samples)
            .map(|k| {
                let t = k as f64 * self.period_s;
                let sum: f64 =
                    EXCITATION.iter().map(|(f, phase)| (2.0 * PI * f * t + phase).sin()).sum();
                EXCITATION_SHARE * limit * sum
            })
            .collect();
        let noise: Vec<_> = self.noise(stream).take(samples).collect();
        let u = c_m.iter().map(|c_m| (gain * c_m).clamp(-most, most)).collect();
        let mut signals = vec![self.input("u", u)];
        signals.extend(self.disturbances(&noise));
        Excited { inputs: self.recording(signals), c_m }
    }

    /// Unit of T.
    pub fn tacho_unit(&self) -> &'static str {
        match (self.drive.sensors.tacho_unit, self.drive.motion) {
            (TachoUnit::Rpm, _) => "rpm",
            (TachoUnit::Si, Motion::Rotary) => "rad/s",
            (TachoUnit::Si, Motion::Linear) => "m/s",
        }
    }

    /// Unit of a variable of the drive's FMUs; nothing if they have no such variable.
    pub(crate) fn unit_of(&self, name: &str) -> Option<&str> {
        unit_among(&self.variables, name)
    }

    fn noise(&self, stream: Stream) -> NoiseStream {
        NoiseStream::new(&self.drive.noise, self.period_s, self.seed, stream.index())
    }

    /// Noise of the sensors and of the load, which every run has.
    fn disturbances(&self, noise: &[Noise<f64>]) -> [Signal; 3] {
        let per_si = self.drive.sensors.tacho_unit.per_si();
        [
            self.input("noise_T", noise.iter().map(|n| n.omega * per_si).collect()),
            self.input("noise_I_m", noise.iter().map(|n| n.i).collect()),
            self.input("noise_T_l", noise.iter().map(|n| n.torque).collect()),
        ]
    }

    /// An input of the drive's FMU, in the unit that it has there.
    fn input(&self, name: &str, values: Vec<f64>) -> Signal {
        let unit = self.unit_of(name).unwrap_or_default().to_owned();
        Signal { name: name.to_owned(), unit, values }
    }

    fn recording(&self, signals: Vec<Signal>) -> Recording {
        Recording::new(self.drive.name.clone(), 0.0, self.period_s, signals)
    }
}

/// Unit of the variable of that name, if there is one.
pub(crate) fn unit_among<'a>(variables: &'a [Variable], name: &str) -> Option<&'a str> {
    let variable = variables.iter().find(|variable| variable.name == name);
    variable.map(|variable| variable.unit.as_str())
}

/// An open-loop run's inputs and the control signal behind them.
#[derive(Debug, Clone, PartialEq)]
pub struct Excited {
    /// What enters the drive.
    pub inputs: Recording,
    /// Control signal C_m, V.
    pub c_m: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drives::built_in;
    use crate::profile::Profile;
    use crate::results::FaultName;

    #[test]
    fn faults_of_one_mechanism_add_up_and_others_stand_beside() {
        let drive = built_in("dr300").expect("it is built in").expect("it is right");
        let experiment = Experiment::new(drive, 3).expect("it is controlled");
        let fault = |kind: &str, size, profile| {
            let name = FaultName { kind: kind.to_owned(), size, label: String::new() };
            Fault { name, from: 2, until: 6, profile }
        };
        let faults = [
            fault("tacho", 0.1, Profile::Step),
            fault("flux", 0.2, Profile::Step),
            fault("tacho", 0.1, Profile::Ramp { over_s: 0.01 }),
        ];
        let inputs = experiment.following(vec![100.0; 8], Stream::Faulty(0), &faults);
        let of = |name: &str| &inputs.signal(name).expect("it acts").values;
        let exact = [0.0, 0.0, 0.1, 0.15, 0.2, 0.2, 0.0, 0.0];
        assert!(of("fault_tacho").iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-12));
        assert_eq!(of("fault_flux")[..3], [0.0, 0.0, 0.2]);
        assert_eq!(of("reference")[0], 100.0);
        assert!(inputs.signal("fault_load").is_none());
    }
}
