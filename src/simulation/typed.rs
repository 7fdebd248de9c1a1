//! A run driven by typed signals: with its controller a drive follows a reference, else u is
//! given. Row k holds what is known at t_k = k x period: the sensors' readings, C_m and u that
//! follow from them and act until t_{k+1}.

use std::collections::BTreeMap;

use drivescope_plant::drive::Drive;
use drivescope_plant::noise::NoiseStream;
use drivescope_plant::unit::{Unit, UnitError};
use drivescope_plant::units::for_motion;
use drivescope_recording::{Recording, Signal};
use indicatif::ProgressBar;

use super::fault::FaultOverTime;
use super::{SAMPLES_A_LOOK, column, has_current, place, position, speed, tacho_unit};
use crate::interrupt;

/// What drives the run, one value a sample, SI.
#[derive(Debug, Clone)]
pub(crate) enum Driven {
    /// The controller follows this speed.
    Reference(Vec<f64>),
    /// u is this.
    Input(Vec<f64>),
}

/// A run to do.
#[derive(Debug)]
pub(crate) struct Run {
    /// The drive; its noise acts as the file has it.
    pub(crate) drive: Drive,
    /// What drives it; its length is that of the run.
    pub(crate) driven: Driven,
    /// Load torque, one value a sample.
    pub(crate) load: Option<Vec<f64>>,
    pub(crate) faults: Vec<FaultOverTime>,
    /// Sampling time, s.
    pub(crate) period_s: f64,
    /// Seed of the noise.
    pub(crate) seed: u64,
}

/// Columns of the recording; those that this run does not have stay away.
struct Columns {
    reference: Option<Signal>,
    c_m: Option<Signal>,
    u: Signal,
    i: Option<Signal>,
    omega: Signal,
    theta: Signal,
    t: Signal,
    i_m: Option<Signal>,
    load: Option<Signal>,
}

impl Columns {
    fn new(run: &Run, samples: usize) -> Self {
        let drive = &run.drive;
        let closed = matches!(run.driven, Driven::Reference(_));
        let ((speed, speed_unit), (position, position_unit)) = (speed(drive), position(drive));
        let when = |is: bool, name: &str, unit: &str| is.then(|| column(name, unit, samples));
        Self {
            reference: when(closed, "reference", &speed_unit),
            c_m: when(closed, "C_m", "V"),
            u: column("u", "V", samples),
            i: when(has_current(drive), "i", "A"),
            omega: column(speed, speed_unit, samples),
            theta: column(position, position_unit, samples),
            t: column("T", tacho_unit(drive), samples),
            i_m: when(has_current(drive), "I_m", "A"),
            load: when(run.load.is_some(), "T_l", &for_motion(drive.motion, "N m")),
        }
    }

    fn into_signals(self) -> Vec<Signal> {
        let Self { reference, c_m, u, i, omega, theta, t, i_m, load } = self;
        [reference, c_m, Some(u), i, Some(omega), Some(theta), Some(t), i_m, load]
            .into_iter()
            .flatten()
            .collect()
    }
}

fn push(column: &mut Option<Signal>, value: impl FnOnce() -> f64) {
    if let Some(column) = column {
        column.values.push(value());
    }
}

impl Run {
    /// Does the run.
    ///
    /// # Errors
    /// The user stopped it, a fault is not possible for this drive, or the state overflowed.
    pub(crate) fn simulate(&self, progress: &ProgressBar) -> miette::Result<Recording> {
        let (driven, closed) = match &self.driven {
            Driven::Reference(values) => (values, true),
            Driven::Input(values) => (values, false),
        };
        let samples = driven.len();
        let mut unit = Unit::new(self.drive.clone(), !closed);
        let names = Names::new(&unit, closed);
        // Several faults of one mechanism add up.
        let mut faults: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        for (fault, number) in self.faults.iter().zip(0..) {
            let at = place(&unit, &format!("fault_{}", fault.mechanism.id));
            let sizes = fault.sizes(samples, self.period_s, self.seed ^ (number << 32));
            let sums = faults.entry(at).or_insert_with(|| vec![0.0; samples]);
            sums.iter_mut().zip(sizes).for_each(|(sum, size)| *sum += size);
        }
        let per_si = self.drive.sensors.tacho_unit.per_si();
        let noise = NoiseStream::new(&self.drive.noise, self.period_s, self.seed, 0);
        let mut columns = Columns::new(self, samples);
        unit.initialize(0.0);
        for ((k, noise), wanted) in (0..samples).zip(noise).zip(driven) {
            if k % SAMPLES_A_LOOK == 0 {
                interrupt::check()?;
                progress.set_position(k as u64);
            }
            let mut set = |at: usize, value: f64| unit.set(at, value).map_err(impossible);
            set(names.driven, *wanted)?;
            if let Some(at) = names.noise_reference {
                set(at, noise.reference)?;
            }
            if let Some(load) = &self.load {
                set(names.load, load[k])?;
            }
            set(names.noise_t, noise.omega * per_si)?;
            set(names.noise_i_m, noise.i)?;
            set(names.noise_load, noise.torque)?;
            for (at, sizes) in &faults {
                set(*at, sizes[k])?;
            }
            // The sample is taken here, so that the row holds what follows from it.
            unit.set_time(k as f64 * self.period_s);
            unit.update_discrete();
            let shown = |at: usize| unit.get(at).unwrap_or(f64::NAN);
            let t = shown(names.t);
            push(&mut columns.reference, || wanted + noise.reference);
            if let Some(at) = names.c_m {
                push(&mut columns.c_m, || shown(at));
            }
            columns.u.values.push(shown(names.u));
            push(&mut columns.i, || shown(names.i_m));
            columns.omega.values.push(t / per_si);
            columns.theta.values.push(shown(names.theta) + noise.theta);
            columns.t.values.push(t);
            push(&mut columns.i_m, || shown(names.i_m));
            if let Some(load) = &self.load {
                push(&mut columns.load, || load[k]);
            }
            unit.step(self.period_s).map_err(impossible)?;
        }
        progress.finish_and_clear();
        Ok(Recording::new(self.drive.name.clone(), 0.0, self.period_s, columns.into_signals()))
    }
}

fn impossible(error: UnitError) -> miette::Report {
    miette::miette!(help = "check the parameters of the drive and the inputs of the run", "{error}")
}

/// The unit's references that a run needs.
struct Names {
    driven: usize,
    noise_reference: Option<usize>,
    load: usize,
    noise_t: usize,
    noise_i_m: usize,
    noise_load: usize,
    c_m: Option<usize>,
    u: usize,
    theta: usize,
    t: usize,
    i_m: usize,
}

impl Names {
    fn new(unit: &Unit, closed: bool) -> Self {
        let when_closed = |name: &str| closed.then(|| place(unit, name));
        Self {
            driven: place(unit, if closed { "reference" } else { "u" }),
            noise_reference: when_closed("noise_reference"),
            load: place(unit, "T_l"),
            noise_t: place(unit, "noise_T"),
            noise_i_m: place(unit, "noise_I_m"),
            noise_load: place(unit, "noise_T_l"),
            c_m: when_closed("C_m"),
            u: place(unit, "armature.u"),
            theta: place(unit, position(unit.drive()).0),
            t: place(unit, "T"),
            i_m: place(unit, "I_m"),
        }
    }
}
